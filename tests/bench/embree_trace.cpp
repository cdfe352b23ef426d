#ifdef __SSE2__
#include <pmmintrin.h>
#endif

#include "bench/embree_side.h"

namespace pocketray {
namespace {

// Embree recommends flushing denormals to zero for speed; our code must not.
struct DenormalsAreZero {
#ifdef __SSE2__
  unsigned saved = _mm_getcsr();
  DenormalsAreZero() { _mm_setcsr(saved | _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON); }
  ~DenormalsAreZero() { _mm_setcsr(saved); }
#endif
};

constexpr std::uint32_t kAllRays = ~0u;

RTCIntersectContext make_context(RayKindOfBench kind) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags =
      kind == RayKindOfBench::primary ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

void trace_singles(EmbreeTask* task) {
  RTCIntersectContext context = make_context(task->kind);
  RTCRayHit one;
  for (std::size_t i = 0; i < task->singles.size(); ++i) {
    one.ray = task->singles[i];
    one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(task->scene, &context, &one);
    bool hit = one.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    task->hits[i] = {one.ray.tfar, one.hit.u, one.hit.v, hit ? one.hit.primID : kNoTriangle};
  }
}

void trace_occlusion(EmbreeTask* task) {
  RTCIntersectContext context = make_context(task->kind);
  for (std::size_t i = 0; i < task->singles.size(); ++i) {
    RTCRay ray = task->singles[i];
    rtcOccluded1(task->scene, &context, &ray);
    task->occluded[i] = ray.tfar < 0;  // -infinity if occluded
  }
}

inline void intersect(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit4* packet) {
  rtcIntersect4(valid, scene, context, packet);
}
inline void intersect(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit8* packet) {
  rtcIntersect8(valid, scene, context, packet);
}
inline void intersect(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit16* packet) {
  rtcIntersect16(valid, scene, context, packet);
}

template <class Packet, std::size_t lanes>
void trace_packets(EmbreeTask* task) {
  RTCIntersectContext context = make_context(task->kind);
  alignas(64) int valid[lanes];
  alignas(64) Packet packet;
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    valid[lane] = -1;
    packet.ray.org_x[lane] = task->eye.x, packet.ray.org_y[lane] = task->eye.y, packet.ray.org_z[lane] = task->eye.z;
    packet.ray.tnear[lane] = packet.ray.time[lane] = 0;
    packet.ray.mask[lane] = kAllRays, packet.ray.id[lane] = packet.ray.flags[lane] = 0;
  }
  const float* direction = task->directions.data();
  for (std::size_t first = 0; first < task->packet_t.size(); first += lanes, direction += 3 * lanes) {
    __builtin_memcpy(packet.ray.dir_x, direction, sizeof packet.ray.dir_x);
    __builtin_memcpy(packet.ray.dir_y, direction + lanes, sizeof packet.ray.dir_y);
    __builtin_memcpy(packet.ray.dir_z, direction + 2 * lanes, sizeof packet.ray.dir_z);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      packet.ray.tfar[lane] = __builtin_inff();
      packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.primID[lane] = kNoTriangle;
    }
    intersect(valid, task->scene, &context, &packet);
    __builtin_memcpy(&task->packet_t[first], packet.ray.tfar, sizeof packet.ray.tfar);
    __builtin_memcpy(&task->packet_u[first], packet.hit.u, sizeof packet.hit.u);
    __builtin_memcpy(&task->packet_v[first], packet.hit.v, sizeof packet.hit.v);
    __builtin_memcpy(&task->packet_triangle[first], packet.hit.primID, sizeof packet.hit.primID);
  }
}

RTCRay embree_ray(const Ray& ray) {
  RTCRay result = {};
  result.org_x = ray.origin.x, result.org_y = ray.origin.y, result.org_z = ray.origin.z;
  result.dir_x = ray.direction.x, result.dir_y = ray.direction.y, result.dir_z = ray.direction.z;
  result.tfar = ray.t_max;
  result.mask = kAllRays;
  return result;
}

void lay_out_packets(const RaySet& set, EmbreeTask* task) {
  std::uint32_t lanes = static_cast<std::uint32_t>(task->mode.lanes);
  std::uint32_t count = static_cast<std::uint32_t>(set.rays.size());
  task->directions.resize(std::size_t(3) * count);
  for (std::uint32_t i = 0; i < count; ++i)
    for (std::uint32_t axis = 0; axis < 3; ++axis)
      task->directions[std::size_t(i / lanes) * 3 * lanes + axis * lanes + i % lanes] =
          set.rays[i].direction[static_cast<int>(axis)];
  task->packet_t.resize(count), task->packet_u.resize(count), task->packet_v.resize(count);
  task->packet_triangle.resize(count);
}

}  // namespace

EmbreeTask make_embree_task(EmbreeSide* side, const EmbreeMode& mode, const RaySet& set) {
  EmbreeTask task;
  task.scene = side->scene_for(mode);
  task.mode = mode;
  task.kind = set.kind;
  task.eye = set.rays.empty() ? Vec3{0, 0, 0} : set.rays[0].origin;
  if (mode.lanes > 1) {
    lay_out_packets(set, &task);
    return task;
  }
  for (const Ray& ray : set.rays) task.singles.push_back(embree_ray(ray));
  if (set.kind == RayKindOfBench::shadow)
    task.occluded.resize(set.rays.size());
  else
    task.hits.resize(set.rays.size());
  return task;
}

void trace_embree(EmbreeTask* task) {
  DenormalsAreZero denormals;
  switch (task->mode.lanes) {
    case 4:
      return trace_packets<RTCRayHit4, 4>(task);
    case 8:
      return trace_packets<RTCRayHit8, 8>(task);
    case 16:
      return trace_packets<RTCRayHit16, 16>(task);
    default:
      return task->kind == RayKindOfBench::shadow ? trace_occlusion(task) : trace_singles(task);
  }
}

std::vector<Hit> embree_hits(const EmbreeTask& task) {
  if (task.mode.lanes == 1) return task.hits;
  std::vector<Hit> hits(task.packet_t.size());
  for (std::size_t i = 0; i < hits.size(); ++i)
    hits[i] = {task.packet_t[i], task.packet_u[i], task.packet_v[i], task.packet_triangle[i]};
  return hits;
}

}  // namespace pocketray
