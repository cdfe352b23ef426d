#include "shade/reference_world.h"

#include <limits>

#include "base/check.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUlps = 1 + 8 * std::numeric_limits<double>::epsilon();  // what box distances may err by
constexpr std::uint32_t kLeafCountMax = 4, kBinCount = 16, kDepthMax = 60, kHalveDepth = 30;

Vec3d lower(const Vec3d& a, const Vec3d& b) {
  return {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}
Vec3d upper(const Vec3d& a, const Vec3d& b) {
  return {a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}

struct Bounds {
  Vec3d low = {kInfinity, kInfinity, kInfinity}, high = {-kInfinity, -kInfinity, -kInfinity};
  void add(const Bounds& b) { low = lower(low, b.low), high = upper(high, b.high); }
  double half_area() const {
    Vec3d d = high - low;
    return d.x >= 0 ? d.x * d.y + d.y * d.z + d.z * d.x : 0;
  }
};

Vec3d corner(const FrameData& frame, std::uint32_t triangle, std::uint32_t i) {
  return to_double(frame.positions[frame.scene->triangles[triangle].vertex(i)]);
}
Bounds triangle_bounds(const FrameData& frame, std::uint32_t triangle) {
  Bounds b;
  for (std::uint32_t i = 0; i < 3; ++i) {
    Vec3d p = corner(frame, triangle, i);
    b.add({p, p});
  }
  return b;
}
double middle(const Bounds& b, int axis) { return 0.5 * (b.low[axis] + b.high[axis]); }

// Where to part `count` triangles by the least sum of area × count over kBinCount slices of their middles
// [Wald 2007, "On fast Construction of SAH-based Bounding Volume Hierarchies", sec. 3]; `count` / 2 where that parts
// none.
std::uint32_t part(const FrameData& frame, std::uint32_t* ids, std::uint32_t count, bool halve) {
  Bounds middles;
  for (std::uint32_t i = 0; i < count; ++i) {
    Bounds b = triangle_bounds(frame, ids[i]);
    Vec3d m = {middle(b, 0), middle(b, 1), middle(b, 2)};
    middles.add({m, m});
  }
  double best = kInfinity, best_at = 0;
  int best_axis = 0;
  for (int axis = 0; axis < 3 && !halve; ++axis) {
    double low = middles.low[axis], extent = middles.high[axis] - low;
    if (!(extent > 0)) continue;
    Bounds bins[kBinCount];
    std::uint32_t counts[kBinCount] = {};
    for (std::uint32_t i = 0; i < count; ++i) {
      Bounds b = triangle_bounds(frame, ids[i]);
      std::uint32_t bin = static_cast<std::uint32_t>((middle(b, axis) - low) / extent * (kBinCount * 0.999999));
      bins[bin].add(b);
      ++counts[bin];
    }
    double right_cost[kBinCount] = {};
    Bounds right;
    std::uint32_t right_count = 0;
    for (std::uint32_t bin = kBinCount - 1; bin > 0; --bin) {
      right.add(bins[bin]);
      right_count += counts[bin];
      right_cost[bin] = right.half_area() * right_count;
    }
    Bounds left;
    std::uint32_t left_count = 0;
    for (std::uint32_t bin = 0; bin + 1 < kBinCount; ++bin) {
      left.add(bins[bin]);
      left_count += counts[bin];
      double cost = left.half_area() * left_count + right_cost[bin + 1];
      if (left_count == 0 || left_count == count || !(cost < best)) continue;
      best = cost, best_axis = axis, best_at = low + extent * (bin + 1) / (kBinCount * 0.999999);
    }
  }
  if (!(best < kInfinity)) return count / 2;
  std::uint32_t left = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!(middle(triangle_bounds(frame, ids[i]), best_axis) < best_at)) continue;
    std::uint32_t id = ids[i];
    ids[i] = ids[left], ids[left++] = id;
  }
  return left == 0 || left == count ? count / 2 : left;
}

bool is_hole(const FrameData& frame, std::uint32_t triangle, double u, double v) {
  const Material& m = frame.scene->materials[frame.scene->triangles[triangle].material()];
  return m.alpha_mode == AlphaMode::mask &&
         hit_alpha(*frame.scene, m, triangle, static_cast<float>(u), static_cast<float>(v),
                   frame.settings.texture_filter) < m.alpha_cutoff;
}

// Axes permuted and sheared so that the ray runs along the third [Woop, Benthin, Wald 2013, sec. 3]: what lies on an
// edge lies on it for both of its triangles.
struct Shear {
  int x, y, z;
  double sx, sy, sz;
};
Shear make_shear(const Vec3d& d) {
  Vec3d size = {std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)};
  Shear s;
  s.z = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  s.x = (s.z + 1) % 3, s.y = (s.z + 2) % 3;
  s.sx = d[s.x] / d[s.z], s.sy = d[s.y] / d[s.z], s.sz = 1 / d[s.z];
  return s;
}

bool meets(const FrameData& frame, std::uint32_t triangle, const ReferenceRay& ray, const Shear& s, ReferenceHit* hit) {
  double x[3], y[3], z[3];
  for (std::uint32_t i = 0; i < 3; ++i) {
    Vec3d p = corner(frame, triangle, i) - ray.origin;
    x[i] = p[s.x] - s.sx * p[s.z], y[i] = p[s.y] - s.sy * p[s.z], z[i] = s.sz * p[s.z];
  }
  double a = x[2] * y[1] - y[2] * x[1], b = x[0] * y[2] - y[0] * x[2], c = x[1] * y[0] - y[1] * x[0];
  if ((a < 0 || b < 0 || c < 0) && (a > 0 || b > 0 || c > 0)) return false;
  double sum = a + b + c;
  if (sum == 0) return false;
  *hit = {(a * z[0] + b * z[1] + c * z[2]) / sum, b / sum, c / sum, triangle};
  return hit->t > ray.t_min && hit->t < ray.t_max;
}

// Distance at which the ray enters the box; infinity where it does not before `t_max`. Not-a-numbers of rays within a
// face's plane leave the bounds as they are.
double enter(const ReferenceNode& n, const ReferenceRay& ray, const Vec3d& inverse, double t_max) {
  double near = ray.t_min, far = t_max;
  for (int axis = 0; axis < 3; ++axis) {
    double a = (n.low[axis] - ray.origin[axis]) * inverse[axis], b = (n.high[axis] - ray.origin[axis]) * inverse[axis];
    double first = a < b ? a : b, last = (a < b ? b : a) * kUlps;
    if (first > near) near = first;
    if (last < far) far = last;
  }
  return near <= far ? near : kInfinity;
}

bool is_before(const ReferenceHit& a, const ReferenceHit& b) {
  return a.t < b.t || (a.t == b.t && a.triangle < b.triangle);
}

}  // namespace

std::size_t reference_world_need(std::uint32_t triangle_count) {
  return arena_need<ReferenceNode>(2 * std::size_t(triangle_count) + 1) + arena_need<std::uint32_t>(triangle_count);
}

ReferenceWorld make_reference_world(const FrameData& frame, Arena* arena) {
  ReferenceWorld world;
  world.frame = &frame;
  std::uint32_t triangle_count = frame.scene->triangles.count, used = 1;
  world.nodes = arena_array<ReferenceNode>(arena, 2 * std::size_t(triangle_count) + 1);
  world.order = arena_array<std::uint32_t>(arena, triangle_count);
  for (std::uint32_t i = 0; i < triangle_count; ++i) world.order[i] = i;
  struct Task {
    std::uint32_t node, depth;
  } tasks[kDepthMax + 2];
  std::uint32_t task_count = 1;
  tasks[0] = {0, 0};
  world.nodes[0].first = 0, world.nodes[0].count = triangle_count;
  while (task_count > 0) {
    Task task = tasks[--task_count];
    ReferenceNode* n = &world.nodes[task.node];
    Bounds bounds;
    for (std::uint32_t i = 0; i < n->count; ++i) bounds.add(triangle_bounds(frame, world.order[n->first + i]));
    n->low = bounds.low, n->high = bounds.high;
    if (n->count <= kLeafCountMax || task.depth >= kDepthMax) continue;
    std::uint32_t begin = n->first, count = n->count;
    std::uint32_t left = part(frame, world.order.data + begin, count, task.depth >= kHalveDepth);
    n->first = used, n->count = 0;
    world.nodes[used].first = begin, world.nodes[used].count = left;
    world.nodes[used + 1].first = begin + left, world.nodes[used + 1].count = count - left;
    tasks[task_count++] = {used, task.depth + 1};
    tasks[task_count++] = {used + 1, task.depth + 1};
    used += 2;
  }
  world.nodes.count = used;
  return world;
}

ReferenceHit next_hit(const ReferenceWorld& world, const ReferenceRay& ray, const ReferenceHit* after) {
  ReferenceHit best = {kInfinity, 0, 0, kNone};
  Vec3d inverse = {1 / ray.direction.x, 1 / ray.direction.y, 1 / ray.direction.z};
  Shear shear = make_shear(ray.direction);
  struct Entry {
    std::uint32_t node;
    double t;  // at which the ray enters it
  } stack[kDepthMax + 2];
  std::uint32_t stack_count = 0;
  if (!world.order.empty()) stack[stack_count++] = {0, enter(world.nodes[0], ray, inverse, ray.t_max)};
  while (stack_count > 0) {
    Entry entry = stack[--stack_count];
    double t_max = (best.t < ray.t_max ? best.t : ray.t_max) * kUlps;
    if (!(entry.t <= t_max) || entry.t == kInfinity) continue;
    const ReferenceNode& n = world.nodes[entry.node];
    for (std::uint32_t i = 0; i < n.count; ++i) {
      ReferenceHit hit;
      if (!meets(*world.frame, world.order[n.first + i], ray, shear, &hit)) continue;
      if (!is_before(hit, best) || (after && !is_before(*after, hit))) continue;
      if (!is_hole(*world.frame, hit.triangle, hit.u, hit.v)) best = hit;
    }
    if (n.count > 0) continue;
    Entry left = {n.first, enter(world.nodes[n.first], ray, inverse, t_max)};
    Entry right = {n.first + 1, enter(world.nodes[n.first + 1], ray, inverse, t_max)};
    bool left_first = left.t < right.t;
    stack[stack_count++] = left_first ? right : left;
    stack[stack_count++] = left_first ? left : right;
  }
  return best;
}

}  // namespace pocketray
