// The adaptive voxel grid as an entry of the list.
#include "accel/grid.h"

#include "accel/accel_list.h"
#include "accel/all_triangles.h"
#include "accel/by_rays.h"
#include "accel/grid_pool.h"
#include "accel/grid_walk.h"

namespace pocketray {
namespace {

constexpr std::uint64_t pool_words_for(std::uint32_t triangle_count) {
  return std::uint64_t(triangle_count) * kPoolWordsPerTriangle + kPoolWordsMin;
}
std::size_t need(std::uint32_t triangle_count) { return grid_need(triangle_count, pool_words_for(triangle_count)); }
std::size_t scratch_need(std::uint32_t triangle_count) { return arena_need<std::uint32_t>(triangle_count); }
void build(Accel* accel, Arena* keep, Arena* scratch) {
  grid_build(accel, keep, scratch, pool_words_for(accel->triangles.count));
}

Status adopt(Accel*, Array<const std::uint8_t>, const ParallelLoop&) {
  return failure("accelerator: a grid changes while it is used, so it is not read from a file; bake another");
}

// Called during a visit.
void closest_of(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats) {
  GridWalk walk = {accel, Grid(accel)};
  if (start_walk(ray, filter, stats, &walk)) walk_to_closest(&walk);
  hit->triangle = kNoTriangle;
  if (walk.hit.triangle != kNoTriangle) *hit = walk.hit;
}
bool occluded_of(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
  GridWalk walk = {accel, Grid(accel)};
  return start_walk(ray, filter, stats, &walk) && walk_to_any(&walk);
}

void closest(const Accel& accel, const Ray& ray, const HitFilter* filter, Hit* hit, TraceStats* stats) {
  GridVisit visit(&Grid(accel).header());
  closest_of(accel, ray, filter, hit, stats);
}
void closest_packet(const Accel& accel, const RayPacket& rays, const HitFilter* filter, Hit* hits, TraceStats* stats) {
  GridVisit visit(&Grid(accel).header());
  closest_by_rays<closest_of>(accel, rays, filter, hits, stats);
}
bool occluded(const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
  GridVisit visit(&Grid(accel).header());
  return occluded_of(accel, ray, filter, stats);
}
std::uint64_t occluded_packet(const Accel& accel, const SegmentPacket& rays, const HitFilter* filter,
                              TraceStats* stats) {
  GridVisit visit(&Grid(accel).header());
  return occluded_by_rays<occluded_of>(accel, rays, filter, stats);
}

}  // namespace

// No refit(): moved vertices touch other voxels, and rebuilding the root costs less than finding out which (sec. 3.3).
// Resubdivision (sec. 3.3.2) is left to the rays. No magic: there is nothing to bake.
const AccelInfo kGridAccel = {
    {closest, closest_packet, occluded, occluded_packet},
    "grid",
    "voxels divided where rays pass, at about a sixth of the speed",
    false,
    0,
    need,
    scratch_need,
    build,
    nullptr,
    nullptr,
    adopt,
    largest_of_all,
    true,
};

}  // namespace pocketray
