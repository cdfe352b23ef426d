#include "scene/builtin/figure.h"

#include "base/check.h"
#include "base/fmath.h"
#include "scene/builtin/figure_field.h"

namespace pocketray {
namespace {

// Rays that sample a tube: row `at` (0 first, 1 last) starts at `height` along the axis and rises by `elevation`
// degrees.
struct RayFan {
  float at, height, elevation;
};
// Where the centre of the rays jumps, two entries have almost the same `at`.
constexpr RayFan kBodyFan[] = {
    {0.f, -.02f, 0},    {.44f, 4.0f, 0},  {.48f, 4.45f, 0},    {.56f, 5.55f, 0},  {.60f, 5.85f, 8}, {.66f, 5.9f, 62},
    {.6601f, 6.36f, 0}, {.69f, 6.63f, 0}, {.6901f, 7.1f, -58}, {.71f, 7.1f, -55}, {.91f, 7.1f, 25}, {1.f, 7.1f, 87},
};
constexpr RayFan kArmFan[] = {{0.f, .0f, -60}, {.15f, .0f, 0}, {.85f, .97f, 0}, {.9f, .9f, 30}, {1.f, .9f, 86}};

template <std::size_t n>
RayFan fan_at(const RayFan (&fan)[n], float at) {
  CHECK(at >= 0 && at <= 1);
  std::size_t i = 0;
  while (i + 2 < n && at > fan[i + 1].at) ++i;
  float t = (at - fan[i].at) / (fan[i + 1].at - fan[i].at);
  return {at, fan[i].height + t * (fan[i + 1].height - fan[i].height),
          fan[i].elevation + t * (fan[i + 1].elevation - fan[i].elevation)};
}

// Distance along the ray to the surface, searched from `start`: outward until outside, then inward by the distance
// estimate.
template <class Distance>
float cross_surface(const Vec3& origin, const Vec3& direction, float start, const Distance& distance) {
  float t = start;
  float d = distance(origin + direction * t);
  for (int i = 0; i < 20 && d < 0; ++i) {
    t += .1f;
    d = distance(origin + direction * t);
  }
  for (int i = 0; i < 24 && std::fabs(d) > 5e-4f && t > 0; ++i) {
    t -= .8f * d;
    d = distance(origin + direction * t);
  }
  return t > .01f ? t : .01f;
}

struct Placement {
  Vec3 base;
  float scale, sine, cosine;
};
Vec3 place(const Placement& at, const Vec3& p) {
  Vec3 q = bend_figure(p) * at.scale;
  return at.base + Vec3{at.cosine * q.x + at.sine * q.z, q.y, at.cosine * q.z - at.sine * q.x};
}

struct Frame {
  Vec3 origin, axis, front, side;  // azimuth 0 is the front, azimuth π/2 the side; side × front = -axis
  float length;                    // of the axis; scales the fan's heights
};

template <std::size_t n, class Distance>
void add_tube(MeshWriter* mesh, const Placement& placement, const Frame& frame, const RayFan (&fan)[n],
              std::uint32_t columns, std::uint32_t rows, float first_reach, const Distance& distance) {
  std::uint32_t first_vertex = mesh->vertex_count, first_triangle = mesh->triangle_count;
  CHECK_GE(rows, 2u);
  Vec3 bottom = frame.origin + frame.axis * (fan[0].height * frame.length);
  RayFan end = fan_at(fan, 1);
  Vec3 top = frame.origin + frame.axis * (end.height * frame.length);
  // The poles, where the axis leaves the surface.
  if (fan[0].elevation < 0)
    bottom += frame.axis * -cross_surface(bottom, -frame.axis, .1f, [&](const Vec3& p) { return distance(p, 0); });
  add_vertex(mesh, place(placement, bottom), {0, 0, 0});
  for (std::uint32_t row = 0; row < rows; ++row) {
    RayFan ray = fan_at(fan, static_cast<float>(row) / static_cast<float>(rows - 1));
    Vec3 origin = frame.origin + frame.axis * (ray.height * frame.length);
    double elevation = radians(static_cast<double>(ray.elevation));
    float rise = static_cast<float>(det_sin(elevation)), flat = static_cast<float>(det_cos(elevation));
    for (std::uint32_t column = 0; column < columns; ++column) {
      double azimuth = kPi * (2.0 * column / columns - 1);
      float s = static_cast<float>(det_sin(azimuth)), c = static_cast<float>(det_cos(azimuth));
      Vec3 direction = (frame.front * c + frame.side * s) * flat + frame.axis * rise;
      float start = row > 0 ? mesh->normals[mesh->vertex_count - columns].x + .06f : first_reach;
      float angle = static_cast<float>(azimuth);
      float t = cross_surface(origin, direction, start, [&](const Vec3& p) { return distance(p, angle); });
      // The normal temporarily stores the distance, until normals are computed.
      add_vertex(mesh, place(placement, origin + direction * t), {t, 0, 0});
    }
  }
  float t = cross_surface(top, frame.axis, .5f, [&](const Vec3& p) { return distance(p, 0); });
  add_vertex(mesh, place(placement, top + frame.axis * t), {0, 0, 0});
  CHECK_EQ(mesh->vertex_count - first_vertex, tube_size(columns, rows).vertices);
  add_tube_triangles(mesh, first_vertex, columns, rows);
  smooth_normals(mesh, first_vertex, first_triangle);
}

}  // namespace

void add_figure(MeshWriter* mesh, FigureDetail detail, const Vec3& base, float scale, float turn) {
  Placement placement = {base, scale, static_cast<float>(det_sin(static_cast<double>(turn))),
                         static_cast<float>(det_cos(static_cast<double>(turn)))};
  Frame upright = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}, 1};
  add_tube(mesh, placement, upright, kBodyFan, detail.columns, detail.rows, 1.2f, body_distance);
  for (int side = 0; side < 2; ++side) {
    Frame arm;
    Vec3 end;
    arm_axis(side, &arm.origin, &end);
    arm.length = length(end - arm.origin);
    arm.axis = (end - arm.origin) / arm.length;
    arm.side = normalize(cross(arm.axis, Vec3{0, 0, 1}));
    arm.front = cross(arm.side, arm.axis);
    add_tube(mesh, placement, arm, kArmFan, detail.arm_columns, side ? detail.left_rows : detail.right_rows, .25f,
             [side](const Vec3& p, float) { return arm_distance(side, p); });
  }
}

}  // namespace pocketray
