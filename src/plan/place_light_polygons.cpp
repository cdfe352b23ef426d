#include "plan/place_light_polygons.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "plan/area_light.h"
#include "shade/frame_data.h"
#include "shade/lights.h"
#include "shade/sample_points.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kTrianglesMax = 16;  // of one polygon
constexpr double kUnevenMax = 0x1p-12;       // maximum deviation from its plane, relative to its size

struct Edge {
  Vec3 from, to;
};
struct Outline {
  Edge edges[3 * kTrianglesMax];
  std::uint32_t count = 0;
  Vec3d area_vector = {0, 0, 0};  // twice the area, along the normal
};

Vec3d area_vector_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  return cross(to_double(b) - to_double(a), to_double(c) - to_double(a));
}

// Adds an edge, or removes its opposite, which a neighbour shares.
void add_edge(const Vec3& from, const Vec3& to, Outline* outline) {
  for (std::uint32_t i = 0; i < outline->count; ++i) {
    if (!(outline->edges[i].from == to && outline->edges[i].to == from)) continue;
    outline->edges[i] = outline->edges[--outline->count];
    return;
  }
  CHECK_LT(outline->count, 3 * kTrianglesMax);
  outline->edges[outline->count++] = {from, to};
}

// Finds the lamp's boundary: edges that no two triangles share. Returns false if there are too many.
bool find_outline(const FrameData& frame, const Lamp& lamp, Outline* outline) {
  std::uint32_t triangles = 0;
  for (std::uint32_t triangle = lamp.begin; triangle < lamp.end; ++triangle) {
    if (!is_part_of(*frame.scene, lamp, triangle)) continue;
    const Triangle& t = frame.scene->triangles[triangle];
    const Vec3 &a = frame.geometry.positions[t.vertex(0)], &b = frame.geometry.positions[t.vertex(1)],
               &c = frame.geometry.positions[t.vertex(2)];
    const Vec3d area = area_vector_of(a, b, c);
    if (is_zero(area)) continue;
    if (++triangles > kTrianglesMax) return false;
    outline->area_vector += area;
    add_edge(a, b, outline), add_edge(b, c, outline), add_edge(c, a, outline);
  }
  return outline->count <= kLightCornerMax;
}

// Joins the edges into a polygon. Returns false if they do not form a single one.
bool join(Outline* outline, LightPolygon* polygon) {
  CHECK_LE(outline->count, kLightCornerMax);
  polygon->corner_count = outline->count;
  for (std::uint32_t i = 0; i < outline->count; ++i) {
    Edge* edges = outline->edges;
    polygon->corners[i] = edges[i].from;
    if (i + 1 == outline->count) break;
    std::uint32_t next = i + 1;
    while (next < outline->count && !(edges[next].from == edges[i].to)) ++next;
    if (next == outline->count) return false;
    std::swap(edges[i + 1], edges[next]);
  }
  return outline->count >= 3 && outline->edges[outline->count - 1].to == outline->edges[0].from;
}

double height_over(const LightPolygon& polygon, const Vec3& point) {
  return dot(to_double(point) - to_double(polygon.corners[0]), to_double(polygon.normal));
}

bool is_flat(const FrameData& frame, const Lamp& lamp, const LightPolygon& polygon, double size) {
  for (std::uint32_t triangle = lamp.begin; triangle < lamp.end; ++triangle) {
    if (!is_part_of(*frame.scene, lamp, triangle)) continue;
    const Triangle& t = frame.scene->triangles[triangle];
    const Vec3 &a = frame.geometry.positions[t.vertex(0)], &b = frame.geometry.positions[t.vertex(1)],
               &c = frame.geometry.positions[t.vertex(2)];
    const Vec3d area = area_vector_of(a, b, c);
    if (is_zero(area)) continue;
    if (!(dot(area, to_double(polygon.normal)) > 0)) return false;  // folded
    for (const Vec3& p : {a, b, c})
      if (!(std::fabs(height_over(polygon, p)) <= size * kUnevenMax)) return false;
  }
  return true;
}

// Sine of the margin around the polygon's plane, or above a horizon, beyond which neither its corners nor the lamp's
// rounded points lie on the other side.
double margin_of(const LightPolygon& polygon, const FrameData& frame, std::uint32_t first_point, double size) {
  CHECK_GT(size, 0.0);
  double off = 0, largest = 0;
  auto include = [&](const LightPoint* points) {
    for (std::uint32_t i = 0; i < frame.settings.points_per_area_light; ++i) {
      off = std::max(off, std::fabs(height_over(polygon, points[i].position)) / size +
                              length(to_double(points[i].direction) - to_double(polygon.normal)));
      largest = std::max(largest, static_cast<double>(max_component(abs(points[i].position))));
    }
  };
  const Lights& lights = frame.lights;
  include(&lights.points[first_point]);
  for (std::uint32_t set = 0; set < lights.sample_points.count; set += lights.points.count)
    include(&lights.sample_points[set + first_point]);
  constexpr double kEpsilon = std::numeric_limits<float>::epsilon();
  return 0x1p-9 + off + 16 * kEpsilon * (1 + largest / size);
}

bool make_polygon(const FrameData& frame, const Lamp& lamp, std::uint32_t first_point, LightPolygon* polygon) {
  const Material& m = frame.scene->materials[lamp.material];
  if (m.emission_texture.texture != kNone && frame.scene->uvs.count) return false;
  Outline outline;
  if (!find_outline(frame, lamp, &outline) || !join(&outline, polygon)) return false;
  double size = 0;
  for (std::uint32_t i = 1; i < polygon->corner_count; ++i)
    size = std::max(size, length(to_double(polygon->corners[i]) - to_double(polygon->corners[0])));
  const double area = length(outline.area_vector);
  if (!(size > 0x1p-100 && area > 0)) return false;
  polygon->normal = to_float(outline.area_vector / area);
  if (!is_flat(frame, lamp, *polygon, size)) return false;
  int exponent;
  std::frexp(size, &exponent);
  polygon->scale = static_cast<float>(std::ldexp(1.0, -exponent));
  CHECK(polygon->scale > 0 && std::isfinite(polygon->scale));
  polygon->margin = static_cast<float>(margin_of(*polygon, frame, first_point, size));
  polygon->radiance = m.emission;
  polygon->two_sided = m.double_sided;
  return true;
}

}  // namespace

std::uint32_t light_polygon_count(const Scene& scene, EffectMask mask) {
  if (!has(mask, Effect::area_light)) return 0;
  std::uint32_t count = 0;
  each_lamp(scene, scene.materials, [&](const Lamp&) { ++count; });
  return count;
}

void place_light_polygons(Array<const Material> lamps, Array<LightPolygon> polygons, FrameData* frame) {
  CHECK(frame != nullptr);
  frame->lights.polygons = {};
  if (!takes_lamps_whole(frame->settings, frame->mask) || frame->lights.run_count == 0) return;
  LightRun& run = frame->lights.runs[frame->lights.run_count - 1];
  if (run.sample != find_light_sampler(Effect::area_light)) return;
  const std::uint32_t n = frame->settings.points_per_area_light;
  CHECK(n >= 1 && (run.end - run.begin) % n == 0);
  const std::uint32_t count = (run.end - run.begin) / n;
  CHECK_LE(count, polygons.count);
  bool any = false;
  std::uint32_t i = 0;
  each_lamp(*frame->scene, lamps, [&](const Lamp& lamp) {
    if (!(lamp_area(*frame, lamp) > 0)) return;  // it has no points
    CHECK_LT(i, count);
    LightPolygon polygon = {};
    const bool is_polygon = make_polygon(*frame, lamp, run.begin + i * n, &polygon);
    polygons[i++] = is_polygon ? polygon : LightPolygon{};
    any = any || is_polygon;
  });
  CHECK_EQ(i, count);
  if (!any && !sees_few_points(frame->settings, frame->mask)) return;
  run.polygons = polygons.data;
  frame->lights.polygons = {polygons.data, count};
}

}  // namespace pocketray
