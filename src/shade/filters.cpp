#include "shade/filters.h"

#include "base/check.h"
#include "effect/effect_probe.h"
#include "shade/lights.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

// Returns whether the point lies in a hole of an alpha-masked surface.
bool is_hole(const FrameData& frame, const Material& m, std::uint32_t triangle, float u, float v) {
  return hit_alpha<Effect::alpha_mask>(frame, m, triangle, u, v) < m.alpha_cutoff;
}

bool lets_light_through(const FrameData& frame, const Material& m) {
  return !is_zero(m.transmission) || (m.alpha_mode == AlphaMode::blend && has(frame.mask, Effect::alpha_blend));
}

const Material& material_of(const FrameData& frame, std::uint32_t triangle) {
  return frame.scene->materials[frame.scene->triangles[triangle].material()];
}

template <bool masked>
bool is_visible(const FrameData& frame, std::uint32_t triangle, float u, float v) {
  const Material& m = material_of(frame, triangle);
  return !(masked && m.alpha_mode == AlphaMode::mask && is_hole(frame, m, triangle, u, v));
}
bool accept_visible(const void* context, std::uint32_t triangle, float u, float v) {
  return is_visible<true>(*static_cast<const FrameData*>(context), triangle, u, v);
}
template <bool masked, bool clear>
bool accept_opaque(const void* context, std::uint32_t triangle, float u, float v) {
  const auto& shadow = *static_cast<const ShadowContext*>(context);
  const FrameData& frame = *shadow.frame;
  if (shadow.emitter && is_beside(frame, *shadow.emitter, triangle)) return false;
  return !(clear && lets_light_through(frame, material_of(frame, triangle))) &&
         is_visible<masked>(frame, triangle, u, v);
}
template <bool masked>
bool accept_clear(const void* context, std::uint32_t triangle, float u, float v) {
  const auto& shadow = *static_cast<const ShadowContext*>(context);
  const FrameData& frame = *shadow.frame;
  if (shadow.emitter && is_beside(frame, *shadow.emitter, triangle)) return false;
  return lets_light_through(frame, material_of(frame, triangle)) && is_visible<masked>(frame, triangle, u, v);
}

}  // namespace

void make_filters(FrameData* frame) {
  CHECK(frame != nullptr && frame->scene != nullptr);
  bool masked = has(frame->mask, Effect::alpha_mask);
  bool clear = has(frame->mask, Effect::refraction) || has(frame->mask, Effect::alpha_blend);
  frame->filters.visible = {masked ? accept_visible : nullptr, frame, masked};
  frame->filters.read_point = masked;
  frame->filters.accept_opaque = masked ? (clear ? accept_opaque<true, true> : accept_opaque<true, false>)
                                        : (clear ? accept_opaque<false, true> : accept_opaque<false, false>);
  frame->filters.accept_clear = !clear ? nullptr : masked ? accept_clear<true> : accept_clear<false>;
  frame->filters.every_shadow = masked || clear;
}

}  // namespace pocketray
