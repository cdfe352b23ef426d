#include "shade/cell.h"

#include <algorithm>

#include "base/check.h"
#include "brdf/clear_coat.h"
#include "brdf/iridescence.h"
#include "brdf/sheen.h"
#include "scene/diffuse_transmission.h"
#include "shade/contact.h"

namespace pocketray {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Chosen: light on a much darker texel says little about light on a bright one.
constexpr float kRecolorMax = 4;

// The range of several radiances.
struct ColorRange {
  Vec3 low = {kInfinity, kInfinity, kInfinity}, high = {0, 0, 0};

  void add(const Vec3& radiance) { low = min(low, radiance), high = max(high, radiance); }
};

// A channel's radiance as displayed, in proportion to the radiance that is shown as white. Shoulders are taken channel
// by channel.
float displayed(float radiance, const FrameData& frame) {
  const float white = frame.selection.white;
  if (frame.settings.tone == Tone::clip) return std::min(radiance, white);
  const float exposed = radiance / white;
  return with_shoulder({exposed, exposed, exposed}).x * white;
}

// Returns whether the Michelson contrast as displayed, including the display's own reflection, is below `contrast`.
// False for non-finite radiances.
bool is_low_contrast(const ColorRange& range, const FrameData& frame, float contrast) {
  const Selection& selection = frame.selection;
  for (int c = 0; c < 3; ++c) {
    const float high = displayed(range.high[c], frame), low = displayed(range.low[c], frame);
    if (!(high - low < contrast * (high + low + selection.flare))) return false;
  }
  return true;
}

// Returns whether two normals are so close that light from 45 degrees changes by no more than the contrast, which is
// about the angle between them.
bool is_same_side(float contrast, const Vec3& a, const Vec3& b) {
  const float angle = contrast;
  return dot(a, b) > 1 - angle * angle * 0.5f;
}

bool has_texture(const Scene& scene, const Material& m) {
  if (m.diffuse_texture.texture != kNone || m.emission_texture.texture != kNone) return true;
  const auto index = static_cast<std::uint32_t>(&m - scene.materials.data);
  if (const ClearCoat* coat = coat_of(scene, index))
    for (const TextureUse* use : {&coat->strength_texture, &coat->roughness_texture, &coat->normal})
      if (use->texture != kNone) return true;
  if (const Sheen* sheen = sheen_of(scene, index))
    for (const TextureUse* use : {&sheen->color_texture, &sheen->roughness_texture})
      if (use->texture != kNone) return true;
  if (const Iridescence* film = iridescence_of(scene, index))
    for (const TextureUse* use : {&film->strength_texture, &film->thickness_texture})
      if (use->texture != kNone) return true;
  if (const DiffuseTransmission* passing = diffuse_transmission_of(scene, index))
    for (const TextureUse* use : {&passing->strength_texture, &passing->color_texture})
      if (use->texture != kNone) return true;
  if (scene.material_maps.empty()) return false;
  CHECK_LT(index, scene.material_maps.count);
  const MaterialMaps& maps = scene.material_maps[index];
  for (const TextureUse* use :
       {&maps.metallic_roughness, &maps.specular, &maps.specular_color, &maps.normal, &maps.occlusion})
    if (use->texture != kNone) return true;
  return false;
}

// Returns whether a texture turns the grain of a glossy lobe, so that its light changes from texel to texel.
bool has_grain_texture(const Scene& scene, const Material& m) {
  if (scene.grains.empty()) return false;
  const auto index = static_cast<std::uint32_t>(&m - scene.materials.data);
  return has_grain(scene, index) && scene.grains[index].texture.texture != kNone;
}

// Rescales the corner's light to the surface's diffuse colour. Returns false if the corner is too dark for that.
bool recolor(const CellCorner& corner, const Surface& s, Vec3* radiance) {
  Vec3 light = corner.radiance - corner.glow;
  for (int c = 0; c < 3; ++c) {
    if (s.diffuse[c] == corner.diffuse[c]) continue;
    if (!(s.diffuse[c] < kRecolorMax * corner.diffuse[c])) return false;
    light[c] *= s.diffuse[c] / corner.diffuse[c];
  }
  *radiance = light + s.glow;
  return true;
}

}  // namespace

bool has_smooth_light(const FrameData& frame, const Surface& s) {
  const Material& m = *s.material;
  if (!is_zero(m.mirror) || !is_zero(m.transmission) || m.alpha_mode != AlphaMode::opaque) return false;
  if (has_grain_texture(*frame.scene, m)) return false;
  if (has(frame.mask, Effect::clear_coat) && s.coat.mirror > 0) return false;
  return !culls(m, s.front, frame.mask) && frame.view.eye_media.depth == 0;
}

bool is_flat(const FrameData& frame, const PixelCell& cell, float contrast) {
  const CellCorner& first = *cell.corner[0];
  ColorRange range;
  for (const CellCorner* corner : cell.corner) {
    CHECK(corner->known);
    if (corner->material != first.material || !corner->is_smooth) return false;
    if (first.material && !is_same_side(contrast, corner->normal, first.normal)) return false;
    range.add(corner->radiance);
  }
  if (first.material && has_texture(*frame.scene, *first.material)) return false;
  return is_low_contrast(range, frame, contrast);
}

bool predict(const FrameData& frame, const PixelCell& cell, float contrast, const Surface& s, std::uint32_t column,
             std::uint32_t row, Vec3* radiance) {
  CHECK(column < kCellSide && row < kCellSide);
  if (!has_smooth_light(frame, s)) return false;
  const float x = static_cast<float>(column) * cell.across, y = static_cast<float>(row) * cell.down;
  const float weight[4] = {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y};
  Vec3 sum = {0, 0, 0};
  float sum_weight = 0;
  int count = 0;
  ColorRange range;
  for (int c = 0; c < 4; ++c) {
    const CellCorner& corner = *cell.corner[c];
    Vec3 predicted;
    if (corner.material != s.material || !corner.is_smooth || !is_same_side(contrast, corner.normal, s.normal))
      continue;
    if (!recolor(corner, s, &predicted)) continue;
    range.add(predicted);
    sum += predicted * weight[c];
    sum_weight += weight[c];
    ++count;
  }
  // Fewer corners must agree more closely.
  if (count < 2 || !(sum_weight > 0)) return false;
  if (!is_low_contrast(range, frame, 0.25f * static_cast<float>(count) * contrast)) return false;
  *radiance = sum * (1 / sum_weight);
  return true;
}

}  // namespace pocketray
