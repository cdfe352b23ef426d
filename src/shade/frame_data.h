// Everything trace_spans reads while a frame is traced. Filled by plan/ and engine/, constant while threads run.
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

// A light as shading uses it: point, spot, directional, or one of the points that represent an area light.
struct LightPoint {
  Vec3 position;
  Vec3 direction;  // spot, directional: direction of travel of the light; area: normal of the emitter
  Vec3 intensity;  // radiant intensity along `direction` (area) or everywhere (point, spot); directional: irradiance
  float range;     // 0: no limit
  float cos_inner, cos_outer;
  std::uint32_t material;   // of the lamp, see shade/lights.h for its own surfaces; of other lights kNone
  std::uint32_t two_sided;  // area: emits on both sides
};

// A group of lights of one kind.
struct LightNode {
  Box box;                   // of their positions
  float intensity;           // sum of their brightest channels
  std::uint32_t begin, end;  // in LightTree::order
  std::uint32_t right;       // its second half, the first being the next node; kNone: not divided
  LightPoint mean;           // a light that stands for all of them
};
struct LightTree {
  Array<const LightNode> nodes;
  Array<const std::uint32_t> order;  // indices of lights
  std::uint32_t roots[4];            // of FrameData::light_runs; kNone: the run has no tree
};

// Points of an area light that are tested for shadows together, see point_groups.h.
struct PointGroup {
  std::uint8_t probes[5];    // its points at the corners and in the middle, by their numbers in the light
  std::uint16_t begin, end;  // in PointGroups::order
  std::uint16_t second;      // its second half, the first being the next group; 0: not divided
};
// The groups of all area lights, at most as many as its points of each: the first has all of them.
struct PointGroups {
  Array<const PointGroup> groups;          // one place for each point; empty: each point is tested
  Array<const std::uint8_t> order, place;  // of each light, its points in the order of its groups, and the inverse
  std::uint32_t first_point;               // of the first area light, in FrameData::lights
  std::uint32_t points_of_light;
};

// A flat lamp that shines alike everywhere, see polygon_light.h.
struct LightPolygon {
  Vec3 corners[kLightCornerMax];  // counter-clockwise seen from its front
  std::uint32_t corner_count;     // 0: the lamp has no such form, nothing else is set
  std::uint32_t two_sided;
  Vec3 normal, radiance;
  float scale;   // a power of two; the polygon's size times it is 1/2 to 1
  float margin;  // the sine of a margin wide enough for the rounding of its corners and of the lamp's points
};

struct LightSample {
  Vec3 to_light;    // from the point; a shadow ray runs along it, 0 < t < t_max
  Vec3 direction;   // the same, unit
  Vec3 irradiance;  // on a surface that faces the light
  float t_max;
};
// False if the light contributes nothing.
using LightSampler = bool (*)(const LightPoint& light, const Vec3& point, LightSample* sample);

struct LightRun {
  std::uint32_t begin, end;
  LightSampler sample;
  const LightPolygon* polygons;  // of its area lights, one for each, or null: light comes from their points
};

// Rays of a camera: origin(s) and a plane of directions; see camera.h.
struct CameraRays {
  Vec3 eye, forward, right, up;  // right and up span half the image at distance 1 (perspective) or in scene units
  float width, height;           // pixels
  bool orthographic;
};

// Width of a pixel's cone: at the eye, and by how much it grows with the distance; see footprint.h.
struct PixelCone {
  float width, spread;
};

// What a pixel covers of a texture, in texture coordinates; see footprint.h.
struct Footprint {
  float area;
  Vec2 axis;  // set for TextureFilter::anisotropic
};
constexpr Footprint kNoFootprint = {0, {0, 0}};
// The same of the first texture coordinates and of the second.
struct Footprints : Footprint {
  Footprint second;  // set with Effect::second_uv where the scene has them
};
constexpr Footprints kNoFootprints = {kNoFootprint, kNoFootprint};

// Bodies that contain the ray, innermost last, as material indices.
struct MediumStack {
  std::uint32_t material[kMediumDepthMax];
  std::uint32_t depth = 0;
};

// Rows of pixels one after the other, the first of which is the picture's row `first_row`.
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

// The instantiated parts of the kernel, selected once per frame for the plan.
// Hit::t is the distance from the eye along the whole path.
using SurfaceFunction = void (*)(const FrameData& frame, const Ray& ray, const Hit& hit, Surface* surface);
using GlowFunction = void (*)(const FrameData& frame, Surface* surface);
// Radiance from the surroundings that leaves a surface back along the ray, for the material's lobes there.
using SurroundingsFunction = Vec3 (*)(const FrameData& frame, const Ray& ray, const Material& m, const Surface& s);
// What a texture of the surface's material has there, colours or numbers, and the material's alpha at a hit; texture.h.
using ColorFunction = Rgba (*)(const FrameData& frame, const TextureUse& use, const Surface& s);
using NumbersFunction = Vec3 (*)(const FrameData& frame, const TextureUse& use, const Surface& s);
using AlphaFunction = float (*)(const Scene& scene, const Material& material, std::uint32_t triangle, float u, float v,
                                TextureFilter filter, const Footprints& footprints);
// Radiance along a ray, given its first hit and the surface there if already known (otherwise null).
using RadianceFunction = Vec3 (*)(Tracer* tracer, const Ray& ray, const Hit& hit, const Surface* surface);
// Adds to a surface that is no first hit what first hits take with their tile. `weight` is the path's, to the surface.
using LaterLightFunction = void (*)(Tracer* tracer, const Vec3& weight, Surface* surface);
using ShadowsFunction = void (*)(Tracer* tracer, const RayPacket& rays, const Hit* hits, TileShadows* shadows);
using StripFunction = void (*)(Tracer* tracer, const TileStrip& strip, const PixelRows& image);

// Upper bounds of the radiance along a ray, by the number of reflections and refractions that it may still meet.
struct RadianceBounds {
  float after[kRayDepthMax + 1] = {};

  bool operator==(const RadianceBounds& other) const { return std::equal(after, std::end(after), other.after); }
  bool operator!=(const RadianceBounds& other) const { return !(*this == other); }
};

// What selective rendering interpolates; selective.h.
struct Selection {
  float contrast = 0;          // Michelson, as displayed; none reaches it unseen. 0: every pixel is traced
  float white = 0, flare = 0;  // radiances: the most that is displayed, and twice what the display reflects
};

struct FrameData {
  const Scene* scene = nullptr;
  Array<const Vec3> positions, normals;  // posed
  const AccelInfo* accel_info = nullptr;
  const AccelTraversal* first_rays = nullptr;  // for camera rays, and shadow rays from their first hits
  Accel accel;
  CameraRays camera;
  PixelCone cone = {0, 0};  // set with Effect::mip_map
  MediumStack eye_media;    // bodies that contain the camera
  Array<const LightPoint> lights;
  LightRun light_runs[4];
  int light_run_count = 0;
  LightTree light_tree = {};  // set with Effect::source_selection
  PointGroups point_groups = {};
  Array<const LightPolygon> light_polygons;  // of LightRun::polygons
  Settings settings;
  EffectMask mask = 0;
  SurfaceFunction surface = nullptr;
  SurfaceFunction first_surface = nullptr;  // at first hits: the same, but without light that trace_strip adds there
  SurfaceFunction plain_surface = nullptr, plain_first_surface = nullptr;  // see ambient_gloss.h
  // Null: none but ambient light. At first hits: without light that trace_strip adds there.
  SurroundingsFunction surroundings = nullptr, first_surroundings = nullptr;
  GlowFunction glow = nullptr;  // see material_maps.h
  ColorFunction color = nullptr;
  NumbersFunction numbers = nullptr;
  AlphaFunction alpha = nullptr;
  RadianceFunction radiance = nullptr;
  LaterLightFunction add_later_light = nullptr;  // null: no light comes with the tiles
  ShadowsFunction find_shadows = nullptr;        // null if nothing casts a shadow
  StripFunction trace_strip = nullptr;           // traces pixels in blocks; null: each by itself
  StripFunction trace_lattice_strip = nullptr;   // the same, of those that undersampling traces
  HitFilter visible_filter;                      // accept is null if nothing is cut out; see filters.h
  decltype(HitFilter::accept) accept_opaque = nullptr, accept_clear = nullptr;  // with a ShadowContext
  bool filters_read_point = false;                                              // HitFilter::reads_point
  bool filter_every_shadow = false;  // false: only shadow rays to area lights need the filter
  RadianceBounds radiance_bounds;
  Vec3 beyond_depth = {0, 0, 0};  // radiance that stands in for rays beyond Settings::ray_depth
  Selection selection;
  float left_out_max = 0;    // radiance that may be skipped of a dark sample
  float left_out_slope = 0;  // the same grows by this times the radiance of the darkest channel that exceeds
  float dark_radiance = 0;   // this; see branches.h
  IndirectData indirect;
  const EnvironmentLights* environment_lights = nullptr;  // set with Effect::environment_shadow
  Hit* first_hits = nullptr;  // receives the first hits, width × height for each sample in turn; null: not kept
  KeptPath* compensation_paths = nullptr;  // the same of compensation's rays, see compensation.h
  bool ray_by_ray = false;                 // no packets
};

// The filter for camera and secondary rays: null if nothing is cut out.
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
  std::uint32_t row = ~0u;  // of the picture; ~0: none
};

// Pixels of kWindowRows rows, and whether they are known; lattice.h.
struct LatticeWindow {
  Array<Vec3> pixels;
  Array<std::uint8_t> states;
  std::uint32_t row = ~0u;  // of the row of tiles that it is about; ~0: none
};

// A light that source selection looks at, or a group of lights: the other is kNone.
struct LightEntry {
  Vec3 radiance;  // of a light: what it contributes unblocked
  float most;     // upper bound of the contribution's brightest channel
  std::uint32_t light, node;
  std::uint16_t run;
  std::uint16_t next;  // in the list of entries about as strong
};

// A bit for each point of an area light.
using PointBits = std::uint64_t[kPointsPerAreaLightMax / 64];

// Of the area light last tested for shadows ray by ray, the points whose rays were traced, and what was found; and the
// points that are settled, by their group or by their own ray.
struct TestedPoints {
  Vec3 point, normal;             // of the surface
  std::uint32_t triangle, first;  // the light's first point; ~0: none
  bool front;
  PointBits traced, met, settled, blocked;
};

// What is known of the sample being traced where paths branch; branches.h.
struct Branching {
  float allowed = 0;  // radiance that may be skipped of it
  float certain = 0;  // of what it has for certain, the darkest channel; less FrameData::dark_radiance
  float share = 1;    // of `allowed` that one ray may take
  float ended = 0;    // by how much rays that ended could change it, at most
  float slope = 0;    // of `allowed` by `certain`
};

// One thread's state; counters accumulate. Aligned so that threads do not share a cache line.
struct alignas(64) Tracer {
  const FrameData* frame = nullptr;
  std::uint64_t rays[kRayKindCount] = {};
  std::uint64_t rays_left_out = 0, rays_ended = 0;
  TraceStats stats;
  const Surface* first_surface = nullptr;     // of the sample being shaded, or null: not known
  const TileShadows* tile_shadows = nullptr;  // of the current tile, or null
  std::uint32_t tile_pixel = 0;               // index in the tile of the pixel being shaded
  float budget = 0;                           // radiance that may still be skipped of the current sample
  float skip_max = 0;                         // the same of one ray
  Branching branching;
  CornerRow corner_rows[4];                    // of selective rendering
  std::uint32_t corner_row_count = 0;          // that are kept: 0, 2 or 4
  Array<InterleavedPixel> interleaved_pixels;  // of the row of tiles above; empty: not planned
  LatticeWindow window;                        // empty: not planned
  Array<LightEntry> light_entries;             // scratch of source selection; empty: not planned
  float left_out_max = 0;                      // largest sum skipped of one sample so far
  float left_out_share_max = 0;                // the same as a share of what may be skipped of it
  float ended_weight_max = 0;                  // largest throughput of a ray that ended by the maximum depth
  float ended_bound_max = 0;                   // by how much such rays could change a sample, at most
  TestedPoints tested_points = {{0, 0, 0}, {0, 0, 0}, 0, ~0u, false, {}, {}, {}, {}};
};

}  // namespace pocketray
