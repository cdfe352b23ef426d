// Virtual lights at the first hits of blocks, with shadows.
#include "base/check.h"
#include "base/fmath.h"
#include "effect/effect_probe.h"
#include "shade/filters.h"
#include "shade/interleaved.h"

namespace pocketray {
namespace {

// A shadow ray ends a little before its light, which lies on a surface: by a fraction of its length.
constexpr float kRayEnd = 1 - 0x1p-10f;
// Pixels show the same surface if their normals differ by less than this cosine, and neither lies off the other's plane
// by more than this slope.
constexpr float kSameNormal = 0.9f, kSamePlane = 0.15f;
// With fewer pixels on the same surface, their lights would stand for too many.
constexpr std::uint32_t kSharersMin = 4;

struct Gathered {
  Vec3 lit = {0, 0, 0}, open = {0, 0, 0};  // with and without shadows
};

bool is_same(const Surface& a, const Surface& b) {
  if (!(dot(a.normal, b.normal) > kSameNormal)) return false;
  Vec3 way = b.point - a.point;
  float height = dot(a.geometric, way);
  return height * height <= kSamePlane * kSamePlane * dot(way, way);
}

// Traces the packet's rays and adds what arrives.
void add_packet(const FrameData& frame, const SegmentPacket& packet, const std::uint8_t* pixel, const Vec3* sent,
                TraceStats* stats, Gathered* gathered) {
  if (packet.count == 0) return;
  std::uint64_t blocked = 0;
  if (has(frame.mask, Effect::shadow)) {
    ShadowContext context = {&frame, kNone};
    HitFilter opaque = {frame.accept_opaque, &context, frame.filters_read_point};
    blocked =
        frame.first_rays->occluded_packet(frame.accel, packet, frame.filter_every_shadow ? &opaque : nullptr, stats);
  }
  for (std::uint32_t k = 0; k < packet.count; ++k)
    if (!(blocked >> k & 1)) gathered[pixel[k]].lit += sent[k];
}

// What a pixel takes from the pixels of its block, those of [begin, end), that show the same surface.
Vec3 share(const VirtualLights& lights, const BlockHits& pixels, const Gathered* gathered, std::uint32_t begin,
           std::uint32_t end, std::uint32_t i) {
  const Surface& s = pixels.surface[i];
  Gathered sum;
  std::uint32_t sharers = 0;
  for (std::uint32_t k = begin; k < end; ++k) {
    if (pixels.hits[k].triangle == kNoTriangle || (k != i && !is_same(s, pixels.surface[k]))) continue;
    sum.lit += gathered[k].lit, sum.open += gathered[k].open;
    ++sharers;
  }
  Vec3 result = sum.lit * (static_cast<float>(kBlockPixels) / static_cast<float>(sharers));
  if (sharers < kSharersMin) {  // all lights, by the mean visibility of those traced
    result = virtual_irradiance(lights, s.point, s.normal);
    for (int c = 0; c < 3; ++c) result[c] *= sum.open[c] > 0 ? sum.lit[c] / sum.open[c] : 1;
  }
  return min(result, Vec3{lights.irradiance_max, lights.irradiance_max, lights.irradiance_max});
}

}  // namespace

void gather_virtual_light(const FrameData& frame, const BlockHits& pixels, TraceStats* stats, std::uint64_t* rays,
                          Vec3* irradiance) {
  effect_entered<Effect::instant_radiosity>();
  CHECK_LE(pixels.count, kPacketMax);
  const VirtualLights& lights = *virtual_lights_of(frame.indirect);
  Gathered gathered[kPacketMax];
  Vec3 origin[kPacketMax], sent[kPacketMax];
  std::uint8_t pixel[kPacketMax];
  for (std::uint32_t i = 0; i < pixels.count; ++i)
    if (pixels.hits[i].triangle != kNoTriangle) origin[i] = safe_origin(pixels.surface[i], 1);
  SegmentPacket packet;
  for (std::uint32_t first = 0; first < lights.count; first += kBlockPixels) {  // lights close to each other
    packet.count = 0;
    for (std::uint32_t i = 0; i < pixels.count; ++i) {
      std::uint32_t index = first + pixels.place[i] % kBlockPixels;
      if (pixels.hits[i].triangle == kNoTriangle || index >= lights.count) continue;
      const Surface& s = pixels.surface[i];
      if (is_zero(s.diffuse)) continue;
      Vec3 to_light, light = virtual_irradiance(lights, lights.light[index], s.point, s.normal, &to_light);
      if (!(max_component(light) > 0) || !(dot(s.geometric, to_light) > 0)) continue;
      gathered[i].open += light;
      pixel[packet.count] = static_cast<std::uint8_t>(i), sent[packet.count] = light;
      set_ray(&packet, packet.count++, {origin[i], lights.light[index].position - origin[i], kRayEnd});
    }
    *rays += packet.count;
    add_packet(frame, packet, pixel, sent, stats, gathered);
  }
  for (std::uint32_t begin = 0, end; begin < pixels.count; begin = end) {
    for (end = begin; end < pixels.count && pixels.place[end] / kBlockPixels == pixels.place[begin] / kBlockPixels;)
      ++end;
    for (std::uint32_t i = begin; i < end; ++i) {
      bool lit = pixels.hits[i].triangle != kNoTriangle && !is_zero(pixels.surface[i].diffuse);
      irradiance[i] = lit ? share(lights, pixels, gathered, begin, end, i) : Vec3{0, 0, 0};
    }
  }
}

}  // namespace pocketray
