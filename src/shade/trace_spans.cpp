#include "shade/trace_spans.h"

#include "base/check.h"
#include "effect/effect_probe.h"
#include "shade/camera.h"
#include "shade/contact.h"
#include "shade/surface.h"

namespace pocketray {
namespace {

Vec3 same(float value) { return {value, value, value}; }

Ray pixel_ray(const FrameData& frame, std::uint32_t column, std::uint32_t row, std::uint32_t sample) {
  Vec2 offset = sample_offset(sample, frame.settings.samples_per_pixel);
  return camera_ray(frame.camera, static_cast<float>(column) + offset.x, static_cast<float>(row) + offset.y);
}

Vec3 pixel_radiance(Tracer* tracer, std::uint32_t column, std::uint32_t row) {
  const FrameData& frame = *tracer->frame;
  std::uint32_t sample_count = frame.settings.samples_per_pixel;
  if (sample_count > 1) effect_entered<Effect::supersampling>();
  Vec3 sum = {0, 0, 0};
  for (std::uint32_t sample = 0; sample < sample_count; ++sample) {
    tracer->budget = frame.left_out_max;
    ++tracer->rays[static_cast<int>(RayKind::primary)];
    sum += frame.radiance(tracer, pixel_ray(frame, column, row, sample), frame.eye_media);
    float left_out = frame.left_out_max - tracer->budget;
    if (left_out > tracer->left_out_max) tracer->left_out_max = left_out;
  }
  return sum * (1.0f / static_cast<float>(sample_count));
}

Vec3 pixel_aov(Tracer* tracer, std::uint32_t column, std::uint32_t row, Aov aov) {
  const FrameData& frame = *tracer->frame;
  if (aov == Aov::cost) {
    TraceStats before = tracer->stats;
    pixel_radiance(tracer, column, row);
    return same(static_cast<float>(tracer->stats.nodes - before.nodes + tracer->stats.triangles - before.triangles));
  }
  Ray ray = camera_ray(frame.camera, static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f);
  ++tracer->rays[static_cast<int>(RayKind::primary)];
  float passed = 0;  // in front of culled surfaces
  for (std::uint32_t layer = 0; layer < kTransparentLayerMax; ++layer) {
    Hit hit;
    frame.accel_info->closest(frame.accel, ray, frame.visible_filter.accept ? &frame.visible_filter : nullptr, &hit,
                              &tracer->stats);
    if (hit.triangle == kNoTriangle) break;
    Surface s;
    frame.surface(frame, ray, hit, &s);
    if (culls(*s.material, s.front, frame.mask)) {  // what lies on its back may be seen
      Contact contact;
      gather_contact(frame, s, hit, frame.visible_filter.accept ? &frame.visible_filter : nullptr, &contact,
                     &tracer->stats);
      for (std::uint32_t i = 1; i < contact.count; ++i) {
        const Face& face = contact.face[i];
        if (culls(frame.scene->materials[face.material], face.front, frame.mask)) continue;
        float t = hit.t;
        hit = face.hit;
        hit.t = t;
        frame.surface(frame, ray, hit, &s);
        break;
      }
    }
    if (!culls(*s.material, s.front, frame.mask)) {
      if (aov == Aov::depth) return same(passed + hit.t);
      return aov == Aov::triangle ? same(static_cast<float>(hit.triangle + 1)) : s.normal;
    }
    passed += hit.t;
    ray.origin = safe_origin(s, -1);
  }
  return {0, 0, 0};
}

}  // namespace

Vec2 sample_offset(std::uint32_t sample, std::uint32_t sample_count) {
  if (sample_count == 1) return {0.5f, 0.5f};
  // Hammersley points: (i + ½)/n and the bits of i mirrored at the binary point.
  std::uint32_t bits = ((sample & 1) << 3) | ((sample & 2) << 1) | ((sample & 4) >> 1) | ((sample & 8) >> 3);
  float x = (static_cast<float>(sample) + 0.5f) / static_cast<float>(sample_count);
  return {x, (static_cast<float>(bits) + 0.5f) / 16.0f};
}

Tracer make_tracer(const FrameData& frame) {
  Tracer tracer;
  tracer.frame = &frame;
  return tracer;
}

void trace_spans(Tracer* tracer, const Span* spans, std::uint32_t span_count, Aov aov, Vec3* image) {
  const Settings& settings = tracer->frame->settings;
  for (std::uint32_t i = 0; i < span_count; ++i) {
    Span span = spans[i];
    CHECK_LT(span.row, settings.height);
    CHECK_LE(span.column_end, settings.width);
    Vec3* row = image + static_cast<std::size_t>(span.row) * settings.width;
    for (std::uint32_t column = span.column_begin; column < span.column_end; ++column)
      row[column] =
          aov == Aov::none ? pixel_radiance(tracer, column, span.row) : pixel_aov(tracer, column, span.row, aov);
  }
}

}  // namespace pocketray
