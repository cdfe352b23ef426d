// The oracle: tests every triangle for every ray. The other accelerators must return the same bits.
#include "accel/accel_list.h"
#include "accel/all_triangles.h"
#include "accel/by_rays.h"
#include "accel/triangle.h"
#include "base/check.h"

namespace pocketray {
namespace {

std::size_t brute_need(std::uint32_t) { return 0; }
std::size_t brute_scratch_need(std::uint32_t) { return 0; }

void update_bounds(Accel* accel) {
  accel->bounds = empty_box();
  for (const Triangle& triangle : accel->triangles) {
    if (!has_valid_vertices(accel->positions, triangle)) continue;
    for (std::uint32_t vertex : triangle.vertices()) accel->bounds = merge(accel->bounds, accel->positions[vertex]);
  }
}

void brute_build(Accel* accel, Arena*, Arena*) {
  CHECK_LE(accel->triangles.count, kTriangleCountMax);
  accel->data = {};
  update_bounds(accel);
}
void brute_refit(Accel* accel, Array<std::uint8_t>) { update_bounds(accel); }

Status brute_adopt(Accel* accel, Array<const std::uint8_t> data, const ParallelLoop&) {
  if (!data.empty()) return failure("baked data of %u bytes where brute force keeps none", data.count);
  brute_build(accel, nullptr, nullptr);
  return success();
}

// Calls visit(triangle index, crossing) for each crossing in (0, t_max) that the filter accepts; stops when it returns
// false.
template <class Visit>
void for_each_hit(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats, Visit visit) {
  ShearedRay sheared;
  if (!make_sheared_ray(ray, &sheared)) return;
  for (std::uint32_t i = 0; i < accel.triangles.count; ++i) {
    const Triangle& triangle = accel.triangles[i];
    if (!is_hittable(accel.positions, triangle)) continue;
    if (stats) ++stats->triangles;
    Hit hit;
    if (!intersect_triangle(sheared, accel.positions[triangle.vertex(0)], accel.positions[triangle.vertex(1)],
                            accel.positions[triangle.vertex(2)], &hit))
      continue;
    if (!(hit.t > 0 && hit.t < ray.t_max)) continue;
    if (filter && filter->accept && !filter->accept(filter->context, i, hit.u, hit.v)) continue;
    if (!visit(i, hit)) return;
  }
}

void brute_closest(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats) {
  hit->triangle = kNoTriangle;
  for_each_hit(accel, ray, filter, stats, [&](std::uint32_t triangle, const Hit& found) {
    if (hit->triangle == kNoTriangle || found.t < hit->t) {
      *hit = found;
      hit->triangle = triangle;
    }
    return true;
  });
}

bool brute_occluded(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
  bool any = false;
  for_each_hit(accel, ray, filter, stats, [&](std::uint32_t triangle, const Hit&) {
    any = !joins(ray, triangle);
    return !any;
  });
  return any;
}

}  // namespace

const AccelInfo kBruteAccel = {
    {brute_closest, closest_by_rays<brute_closest>, brute_occluded, occluded_by_rays<brute_occluded>},
    "brute",
    "for comparisons",
    false,
    0,
    brute_need,
    brute_scratch_need,
    brute_build,
    nullptr,
    brute_refit,
    brute_adopt,
    largest_of_all,
    true,
};

}  // namespace pocketray
