// Everything trace_spans() reads. Filled by plan/ and engine/, constant while threads run.
#pragma once
#include <algorithm>
#include <iterator>

#include "accel/accel.h"
#include "base/box.h"
#include "base/limits.h"
#include "effect/effect.h"
#include "effect/settings.h"
#include "indirect/environment_lights.h"
#include "indirect/indirect_list.h"
#include "scene/scene.h"

namespace pocketray {

// A light as shading uses it: a point, spot or directional light, or one of the points that represent an area light.
struct LightPoint {
  Vec3 position;
  Vec3 direction;  // spot, directional: direction of travel of the light; area: normal of the emitter
  Vec3 intensity;  // radiant intensity along `direction` (area) or everywhere (point, spot); directional: irradiance
  float range;     // 0: no limit
  float cos_inner, cos_outer;
  std::uint32_t material;   // lamp's material, see shade/lights.h for its own surfaces; other lights kNone
  std::uint32_t triangle;   // area: first of the triangles on which it lies, ...
  std::uint16_t count;      // ... one, or the two of a parallelogram
  std::uint16_t two_sided;  // area: emits on both sides
};

// A group of lights of one kind.
struct LightNode {
  Box box;                   // bounds of their positions
  float intensity;           // sum over the brightest channel of each
  std::uint32_t begin, end;  // range in LightTree::order
  std::uint32_t right;       // second half; the first half is the next node; kNone: a leaf
  LightPoint mean;           // a light that stands for all of them
};
struct LightTree {
  Array<const LightNode> nodes;
  Array<const std::uint32_t> order;  // indices of lights
  std::uint32_t roots[4];            // by index in FrameData::light_runs; kNone: the run has no tree
};

// Points of an area light whose shadows are tested together, see point_groups.h.
struct PointGroup {
  std::uint8_t probes[5];    // points at the corners and in the middle, by index in the light
  std::uint16_t begin, end;  // in PointGroups::order
  std::uint16_t second;      // second half; the first half is the next group; 0: not divided
};
// Groups of all area lights, at most one per point of a light. The first group holds all points.
struct PointGroups {
  Array<const PointGroup> groups;          // one slot per point; empty: each point is tested
  Array<const std::uint8_t> order, place;  // the light's points in the order of the groups, and the inverse
  std::uint32_t first_point;               // index in FrameData::lights of the first area light
  std::uint32_t points_of_light;
};

// A flat lamp of uniform radiance, see polygon_light.h.
struct LightPolygon {
  Vec3 corners[kLightCornerMax];  // counter-clockwise seen from its front
  std::uint32_t corner_count;     // 0: the lamp is not such a polygon, nothing else is set
  std::uint32_t two_sided;
  Vec3 normal, radiance;
  float scale;   // a power of two; the polygon's size times it is 1/2 to 1
  float margin;  // sine of a margin that covers the rounding of its corners and of the lamp's points
};

struct LightSample {
  Vec3 to_light;    // towards the light; a shadow ray runs along it, 0 < t < t_max
  Vec3 direction;   // unit vector of to_light
  Vec3 irradiance;  // on a surface facing the light
  float t_max;
};
// False if the light contributes nothing.
using LightSampler = bool (*)(const LightPoint& light, const Vec3& point, LightSample* sample);

struct LightRun {
  std::uint32_t begin, end;
  LightSampler sample;
  const LightPolygon* polygons;  // one per area light; null: light comes from their points
};

// Rays of a camera: origin(s) and a plane of directions; see camera.h.
struct CameraRays {
  Vec3 eye, forward, right, up;  // right and up span half the image at distance 1 (perspective) or in scene units
  float width, height;           // pixels
  bool orthographic;
};

// Width of a pixel's cone at the eye, and its growth per distance; see footprint.h.
struct PixelCone {
  float width, spread;
};

// Texture area that a pixel covers, in texture coordinates; see footprint.h.
struct Footprint {
  float area;
  Vec2 axis;  // set for TextureFilter::anisotropic
};
constexpr Footprint kNoFootprint = {0, {0, 0}};
// Footprints in the first and second texture coordinates.
struct Footprints : Footprint {
  Footprint second;  // set with Effect::second_uv where the scene has them
};
constexpr Footprints kNoFootprints = {kNoFootprint, kNoFootprint};

// Bodies that contain the ray, as material indices, innermost last.
struct MediumStack {
  std::uint32_t material[kMediumDepthMax];
  std::uint32_t depth = 0;
};

// Consecutive rows of pixels, the first of which is row `first_row` of the picture.
struct PixelRows {
  Vec3* pixels;
  std::uint32_t width, first_row;

  Vec3& at(std::uint32_t column, std::uint32_t row) const {
    return pixels[static_cast<std::size_t>(row - first_row) * width + column];
  }
};

struct FrameData;
struct KeptPath;
struct Rgba;
struct Surface;
struct TileShadows;
struct TileStrip;
struct Tracer;

// Instantiations of the kernel's parts, selected once per frame for the plan. Hit::t is the distance from the eye along
// the whole path.
using SurfaceFunction = void (*)(const FrameData& frame, const Ray& ray, const Hit& hit, Surface* surface);
using GlowFunction = void (*)(const FrameData& frame, Surface* surface);
// Radiance of the surroundings that the material's lobes reflect back along the ray.
using SurroundingsFunction = Vec3 (*)(const FrameData& frame, const Ray& ray, const Material& m, const Surface& s);
// Value of a texture at the surface (colour or numbers), and the material's alpha at a hit; texture.h.
using ColorFunction = Rgba (*)(const FrameData& frame, const TextureUse& use, const Surface& s);
using NumbersFunction = Vec3 (*)(const FrameData& frame, const TextureUse& use, const Surface& s);
using AlphaFunction = float (*)(const Scene& scene, const Material& material, std::uint32_t triangle, float u, float v,
                                TextureFilter filter, const Footprints& footprints);
// Radiance along a ray, given its first hit and, if already known, the surface there (otherwise null).
using RadianceFunction = Vec3 (*)(Tracer* tracer, const Ray& ray, const Hit& hit, const Surface* surface);
// Adds tile lighting to a secondary hit. `weight` is the throughput of the path to the surface.
using LaterLightFunction = void (*)(Tracer* tracer, const Vec3& weight, Surface* surface);
using ShadowsFunction = void (*)(Tracer* tracer, const RayPacket& rays, const Hit* hits, TileShadows* shadows);
using StripFunction = void (*)(Tracer* tracer, const TileStrip& strip, const PixelRows& image);

// Upper bounds of the radiance along a ray, by the number of reflections and refractions still allowed.
struct RadianceBounds {
  float after[kRayDepthMax + 1] = {};

  bool operator==(const RadianceBounds& other) const { return std::equal(after, std::end(after), other.after); }
  bool operator!=(const RadianceBounds& other) const { return !(*this == other); }
};

// Thresholds for the pixels that selective rendering interpolates; selective.h.
struct Selection {
  float contrast = 0;          // Michelson, as displayed; lower contrast is invisible. 0: every pixel is traced
  float white = 0, flare = 0;  // radiances: the largest displayed, and twice what the display reflects
};

struct FrameData {
  const Scene* scene = nullptr;
  Array<const Vec3> positions, normals;  // posed
  const AccelInfo* accel_info = nullptr;
  const AccelTraversal* first_rays = nullptr;  // for camera rays and shadow rays from first hits
  Accel accel;
  CameraRays camera;
  PixelCone cone = {0, 0};  // set with Effect::mip_map
  MediumStack eye_media;    // bodies that contain the camera
  Array<const LightPoint> lights;
  LightRun light_runs[4];
  int light_run_count = 0;
  LightTree light_tree = {};  // set with Effect::source_selection
  PointGroups point_groups = {};
  Array<const LightPolygon> light_polygons;  // the polygons that LightRun::polygons points into
  Settings settings;
  EffectMask mask = 0;
  SurfaceFunction surface = nullptr;
  SurfaceFunction first_surface = nullptr;  // for first hits: leaves out the light that trace_strip adds
  SurfaceFunction plain_surface = nullptr, plain_first_surface = nullptr;  // see ambient_gloss.h
  // Null: there is only the ambient term. first_surroundings leaves out the light that trace_strip adds.
  SurroundingsFunction surroundings = nullptr, first_surroundings = nullptr;
  GlowFunction glow = nullptr;  // see material_maps.h
  ColorFunction color = nullptr;
  NumbersFunction numbers = nullptr;
  AlphaFunction alpha = nullptr;
  RadianceFunction radiance = nullptr;
  LaterLightFunction add_later_light = nullptr;  // null: tiles add no light
  ShadowsFunction find_shadows = nullptr;        // null if nothing casts a shadow
  StripFunction trace_strip = nullptr;           // traces pixels in blocks; null: pixel by pixel
  StripFunction trace_lattice_strip = nullptr;   // for the pixels that undersampling traces
  HitFilter visible_filter;                      // accept is null without cutouts; see filters.h
  decltype(HitFilter::accept) accept_opaque = nullptr, accept_clear = nullptr;  // with a ShadowContext
  bool filters_read_point = false;                                              // HitFilter::reads_point
  bool filter_every_shadow = false;  // false: only shadow rays to area lights need the filter
  RadianceBounds radiance_bounds;
  Vec3 beyond_depth = {0, 0, 0};  // radiance assumed for rays beyond Settings::ray_depth
  Selection selection;
  float left_out_max = 0;    // error allowed for a dark sample, as radiance
  float left_out_slope = 0;  // growth of left_out_max per radiance of the darkest channel above dark_radiance
  float dark_radiance = 0;   // see branches.h
  IndirectData indirect;
  const EnvironmentLights* environment_lights = nullptr;  // set with Effect::environment_shadow
  Hit* first_hits = nullptr;               // receives the first hits, width × height per sample; null: not kept
  KeptPath* compensation_paths = nullptr;  // receives compensation's rays likewise, see compensation.h
  bool ray_by_ray = false;                 // no packets
};

// Filter for camera and secondary rays; null without cutouts.
inline const HitFilter* visible_filter(const FrameData& frame) {
  return frame.visible_filter.accept ? &frame.visible_filter : nullptr;
}

enum class RayKind : int { primary, shadow, mirror, refraction, blend };
constexpr int kRayKindCount = 5;
constexpr const char* kRayKindNames[kRayKindCount] = {"primary", "shadow", "mirror", "refraction", "blend"};

struct CellCorner;
struct InterleavedPixel;
struct CornerRow {
  Array<CellCorner> corners;
  std::uint32_t row = ~0u;  // row in the picture; ~0: none
};

// Pixels of kWindowRows rows with their states; lattice.h.
struct LatticeWindow {
  Array<Vec3> pixels;
  Array<std::uint8_t> states;
  std::uint32_t row = ~0u;  // first row of the row of tiles that it surrounds; ~0: none
};

// A light or a group of lights in a search of source selection; the other index is kNone.
struct LightEntry {
  Vec3 radiance;  // unblocked contribution of a light; not set for groups
  float most;     // upper bound of the contribution's brightest channel
  std::uint32_t light, node;
  std::uint16_t run;
  std::uint16_t next;  // next entry of about equal strength
};

// A bit for each point of an area light.
using PointBits = std::uint64_t[kPointsPerAreaLightMax / 64];

// Shadow tests of the last area light tested ray by ray: the points whose rays were traced and which of these were
// blocked; the points settled, by their group or by their own ray, and which of these are blocked.
struct TestedPoints {
  Vec3 point, normal;             // surface that is lit
  std::uint32_t triangle, first;  // first: index of the light's first point; ~0: none
  bool front;
  PointBits traced, met, settled, blocked;
};

// State of the sample being traced where its path branches; branches.h.
struct Branching {
  float allowed = 0;  // total error allowed, as radiance
  float certain = 0;  // darkest channel of the certain light, less FrameData::dark_radiance
  float share = 1;    // largest fraction of `allowed` for one ray
  float ended = 0;    // upper bound of the effect of rays that ended
  float slope = 0;    // growth of `allowed` per `certain`
};

// One thread's state; counters accumulate. Aligned so that threads do not share a cache line.
struct alignas(64) Tracer {
  const FrameData* frame = nullptr;
  std::uint64_t rays[kRayKindCount] = {};
  std::uint64_t rays_left_out = 0, rays_ended = 0;
  TraceStats stats;
  const Surface* first_surface = nullptr;     // of the sample being shaded; null: not known
  const TileShadows* tile_shadows = nullptr;  // of the current tile, or null
  std::uint32_t tile_pixel = 0;               // index in the tile of the pixel being shaded
  float budget = 0;                           // error still allowed for the current sample, as radiance
  float skip_max = 0;                         // error allowed for a single ray
  Branching branching;
  CornerRow corner_rows[4];                    // kept by selective rendering
  std::uint32_t corner_row_count = 0;          // rows in use: 0, 2 or 4
  Array<InterleavedPixel> interleaved_pixels;  // from the row of tiles above; empty: not planned
  LatticeWindow window;                        // empty: not planned
  Array<LightEntry> light_entries;             // scratch of source selection; empty: not planned
  float left_out_max = 0;                      // largest total error of a sample so far
  float left_out_share_max = 0;                // the same error relative to what was allowed
  float ended_weight_max = 0;                  // largest throughput of a ray ended by the maximum depth
  float ended_bound_max = 0;                   // upper bound of the effect of such rays on a sample
  TestedPoints tested_points = {{0, 0, 0}, {0, 0, 0}, 0, ~0u, false, {}, {}, {}, {}};
};

}  // namespace pocketray
