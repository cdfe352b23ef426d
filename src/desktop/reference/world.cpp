#include "desktop/reference/world.h"

#include <cstring>
#include <limits>

#include "accel/triangle.h"
#include "base/simd.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool is_hole(const FrameData& frame, std::uint32_t triangle, double u, double v) {
  const Material& m = material_of(frame, triangle);
  return m.alpha_mode == AlphaMode::mask && alpha_at(frame, triangle, u, v) < static_cast<double>(m.alpha_cutoff);
}

// A ray prepared for box tests in float. Boxes are enlarged by its rounding error: near faces move towards the ray's
// origin and far ones away, by a fraction of the coordinates for the origin and of the distance for the rest.
struct BoxRay {
  static constexpr float kSlack = 0x1p-21f;
  Float4 near_origin[3], far_origin[3], inverse[3];
  int near_side[3];
  float t_min;
};
float round_up(double t) { return static_cast<float>(t) * (1 + BoxRay::kSlack); }

BoxRay make_box_ray(const ReferenceWorld& world, const ReferenceRay& ray, double t_min) {
  BoxRay b;
  for (int axis = 0; axis < 3; ++axis) {
    float origin = static_cast<float>(ray.origin[axis]);
    float slack = (std::fabs(origin) + world.magnitude[axis]) * BoxRay::kSlack;
    bool backwards = std::signbit(ray.direction[axis]);
    b.inverse[axis] = Float4::splat(static_cast<float>(1 / ray.direction[axis]));
    b.near_origin[axis] = Float4::splat(backwards ? origin - slack : origin + slack);
    b.far_origin[axis] = Float4::splat(backwards ? origin + slack : origin - slack);
    b.near_side[axis] = backwards;
  }
  b.t_min = static_cast<float>(t_min) * (1 - BoxRay::kSlack);
  return b;
}

// Bits of the children whose boxes the ray enters before t_max; *entry receives where.
unsigned enter(const ReferenceNode& n, const BoxRay& ray, float t_max, Float4* entry) {
  Float4 near = Float4::splat(ray.t_min), far = Float4::splat(t_max);
  for (int axis = 0; axis < 3; ++axis) {
    int side = ray.near_side[axis];
    near = max((Float4::load(n.bounds[side][axis]) - ray.near_origin[axis]) * ray.inverse[axis], near);
    far = min((Float4::load(n.bounds[1 - side][axis]) - ray.far_origin[axis]) * ray.inverse[axis], far);
  }
  *entry = near;
  return bits(near <= far * Float4::splat(1 + BoxRay::kSlack));
}

// Axes permuted and sheared so that the ray runs along the third [Woop, Benthin, Wald 2013, sec. 3]: a ray that hits an
// edge hits it for both of its triangles.
struct Shear {
  int x, y, z;
  Double4 sx, sy, sz, origin_x, origin_y, origin_z;
};
Shear make_shear(const ReferenceRay& ray) {
  const Vec3d& d = ray.direction;
  Vec3d size = {std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)};
  Shear s;
  s.z = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  s.x = (s.z + 1) % 3, s.y = (s.z + 2) % 3;
  s.sx = Double4::splat(d[s.x] / d[s.z]), s.sy = Double4::splat(d[s.y] / d[s.z]), s.sz = Double4::splat(1 / d[s.z]);
  s.origin_x = Double4::splat(ray.origin[s.x]), s.origin_y = Double4::splat(ray.origin[s.y]);
  s.origin_z = Double4::splat(ray.origin[s.z]);
  return s;
}

struct LeafHits {
  alignas(32) double t[4], u[4], v[4];
};
void spill(const Double4& a, double* values) { std::memcpy(values, &a, sizeof(a)); }

// Returns whether a ray that hits a nearby triangle begins on its plane, as in accel/triangle.h.
bool is_on_plane(const ReferenceLeaf& leaf, int lane, const Shear& s) {
  alignas(32) double origin[3][4], inverse[4];
  spill(s.origin_x, origin[0]), spill(s.origin_y, origin[1]), spill(s.origin_z, origin[2]), spill(s.sz, inverse);
  Vec3d corner[3];
  for (int i = 0; i < 3; ++i)
    corner[i] = {static_cast<double>(leaf.corner[i][s.x][lane]) - origin[0][0],
                 static_cast<double>(leaf.corner[i][s.y][lane]) - origin[1][0],
                 static_cast<double>(leaf.corner[i][s.z][lane]) - origin[2][0]};
  return begins_on_plane(static_cast<float>(inverse[0]), corner[0], corner[1], corner[2]);
}

// Bits of the triangles of a leaf that the ray's line meets within (t_min, t_max].
unsigned meet(const ReferenceLeaf& leaf, const Shear& s, double t_min, double t_max, LeafHits* hits) {
  Double4 x[3], y[3], z[3];
  for (int i = 0; i < 3; ++i) {
    z[i] = widen(Float4::load(leaf.corner[i][s.z])) - s.origin_z;
    x[i] = widen(Float4::load(leaf.corner[i][s.x])) - s.origin_x - s.sx * z[i];
    y[i] = widen(Float4::load(leaf.corner[i][s.y])) - s.origin_y - s.sy * z[i];
  }
  Double4 zero = Double4::splat(0);
  Double4 a = x[2] * y[1] - y[2] * x[1], b = x[0] * y[2] - y[0] * x[2], c = x[1] * y[0] - y[1] * x[0];
  auto inside = ((zero <= a) & (zero <= b) & (zero <= c)) | ((a <= zero) & (b <= zero) & (c <= zero));
  if (!bits(inside)) return 0;
  Double4 sum = a + b + c;
  Double4 t = (a * z[0] + b * z[1] + c * z[2]) * s.sz / sum;  // NaN if the sum is zero: no hit
  unsigned met = bits(inside & (Double4::splat(t_min) < t) & (t <= Double4::splat(t_max)));
  if (!met) return 0;
  spill(t, hits->t), spill(b / sum, hits->u), spill(c / sum, hits->v);
  Double4 reach = max(max(max(z[0], zero - z[0]), max(z[1], zero - z[1])), max(z[2], zero - z[2]));
  Double4 close = reach * max(s.sz, zero - s.sz) * Double4::splat(kCloseHit);
  for (unsigned left = met & bits(t < close); left; left &= left - 1) {
    const int i = __builtin_ctz(left);
    if (is_on_plane(leaf, i, s)) met &= ~(1u << i);
  }
  return met;
}

// Visits the leaves whose boxes the ray enters before *t_max, nearest first; at_leaf() may lower *t_max.
template <class AtLeaf>
void walk(const ReferenceWorld& world, const BoxRay& ray, const double* t_max, AtLeaf at_leaf) {
  struct Entry {
    std::uint32_t child;
    float t;  // where the ray enters it
  } stack[3 * kReferenceDepthMax + 4];
  std::uint32_t stack_count = 1;
  stack[0] = {0, ray.t_min};
  while (stack_count > 0) {
    Entry entry = stack[--stack_count];
    float end = round_up(*t_max);
    if (entry.t > end) continue;
    if (entry.child & kReferenceLeafBit) {
      at_leaf(world.leaves[entry.child & ~kReferenceLeafBit]);
      continue;
    }
    const ReferenceNode& node = world.nodes[entry.child];
    Float4 entries;
    unsigned entered = enter(node, ray, end, &entries);
    if (!entered) continue;
    alignas(16) float t[4];
    store(t, entries);
    std::uint32_t first = stack_count;
    for (; entered; entered &= entered - 1) {
      int i = __builtin_ctz(entered);
      std::uint32_t at = stack_count++;
      for (; at > first && stack[at - 1].t < t[i]; --at) stack[at] = stack[at - 1];
      stack[at] = {node.child[i], t[i]};
    }
  }
}

bool is_before(const ReferenceHit& a, const ReferenceHit& b) {
  return a.t < b.t || (a.t == b.t && a.triangle < b.triangle);
}

}  // namespace

ReferenceHit next_hit(const ReferenceWorld& world, const ReferenceRay& ray, const ReferenceHit* after) {
  ReferenceHit best = {kInfinity, 0, 0, kNone};
  Shear shear = make_shear(ray);
  double t_max = ray.t_max;
  BoxRay box_ray = make_box_ray(world, ray, after ? after->t : ray.t_min);
  walk(world, box_ray, &t_max, [&](const ReferenceLeaf& leaf) {
    LeafHits hits;
    unsigned met = meet(leaf, shear, ray.t_min, t_max, &hits);
    for (; met; met &= met - 1) {
      int i = __builtin_ctz(met);
      ReferenceHit hit = {hits.t[i], hits.u[i], hits.v[i], leaf.triangle[i]};
      if (!(hit.t < ray.t_max) || !is_before(hit, best) || (after && !is_before(*after, hit))) continue;
      if (is_hole(*world.frame, hit.triangle, hit.u, hit.v)) continue;
      best = hit, t_max = hit.t;
    }
  });
  return best;
}

bool is_of_piece(const FrameData& frame, std::uint32_t triangle, const LightPoint& point) {
  if (material_index(frame, triangle) != point.material) return false;
  const Vec3d position = to_double(point.position), normal = to_double(point.direction);
  auto largest = [](const Vec3d& v) { return std::fmax(std::fmax(std::fabs(v.x), std::fabs(v.y)), std::fabs(v.z)); };
  bool is_in_plane = true;
  for (std::uint32_t i = 0; i < 3; ++i) {
    const Vec3d corner = corner_of(frame, triangle, i), offset = corner - position;
    const double rounding = 0x1p-20 * std::fmax(largest(corner), largest(position));
    is_in_plane = is_in_plane && std::fabs(dot(offset, normal)) <= 0x1p-9 * largest(offset) + rounding;
  }
  return is_in_plane;
}

Obstacle find_obstacle(const ReferenceWorld& world, const ReferenceRay& ray, const ShadowRules& rules) {
  const FrameData& frame = *world.frame;
  Obstacle worst = Obstacle::none;
  Shear shear = make_shear(ray);
  double t_max = ray.t_max;
  walk(world, make_box_ray(world, ray, ray.t_min), &t_max, [&](const ReferenceLeaf& leaf) {
    LeafHits hits;
    unsigned met = meet(leaf, shear, ray.t_min, ray.t_max, &hits);
    for (; met && worst != Obstacle::opaque; met &= met - 1) {
      int i = __builtin_ctz(met);
      std::uint32_t triangle = leaf.triangle[i];
      if (!(hits.t[i] < ray.t_max) || !casts_shadow(frame, triangle, rules) ||
          is_hole(frame, triangle, hits.u[i], hits.v[i]))
        continue;
      worst = blocks(material_of(frame, triangle), rules) ? Obstacle::opaque : Obstacle::clear;
      if (worst == Obstacle::opaque) t_max = -1;  // enters no further box
    }
  });
  return worst;
}

double alpha_at(const FrameData& frame, std::uint32_t triangle, double u, double v) {
  const AlphaFunction alpha = find_alpha_function(frame.mask);
  return static_cast<double>(alpha(*frame.scene, material_of(frame, triangle), triangle, static_cast<float>(u),
                                   static_cast<float>(v), frame.settings.texture_filter, kNoFootprints));
}

}  // namespace pocketray
