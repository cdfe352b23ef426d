// The choices of `bake`: what they save and what they cost.
#include <algorithm>

#include "desktop/accuracy/knob_list.h"

namespace pocketray {
namespace {

std::string texture_unfit(const BakeableScene& scene) {
  return scene.texture_side > 0 ? "" : "the scene has no textures";
}

std::string texture_max_unfit(const BakeableScene& scene, double value) {
  if (!scene.is_model) return "only models are imported with other textures";
  const std::uint32_t usual = BakeChoices().texture_side_max, side = static_cast<std::uint32_t>(value);
  if (side == usual || std::min(side, scene.texture_side) != std::min(usual, scene.texture_side))
    return texture_unfit(scene);
  return "no texture has more than " + std::to_string(scene.texture_side) + " texels a side";
}

}  // namespace

std::vector<Knob> bake_knobs() {
  std::vector<Knob> knobs(4);
  for (Knob& knob : knobs) knob.theory = "", knob.alone = true, knob.is_setting = false;
  Knob &side = knobs[0], &mip_maps = knobs[1], &blocks = knobs[2], &radiosity = knobs[3];
  side.name = "texture-max", side.what = "longest side of textures, as `bake --texture-max` stores them";
  side.effect = "texture";
  side.values = {64, 128, 256, 512, 1024, kTextureSideSwept};
  side.labels = {"64 texels", "128 texels", "256 texels", "512 texels", "1024 texels", "2048 texels"};
  side.get = [](const Configuration& c) { return static_cast<double>(c.bake.texture_side_max); };
  side.set = [](Configuration* c, double v) { c->bake.texture_side_max = static_cast<std::uint32_t>(v); };
  side.bake_unfit = texture_max_unfit;

  mip_maps.name = "mip-maps", mip_maps.what = "smaller copies of textures, without which `bake --no-mip-maps` does";
  mip_maps.effect = "texture";
  mip_maps.values = {0, 1}, mip_maps.labels = {"none", "stored"};
  mip_maps.get = [](const Configuration& c) { return c.bake.has_mip_maps ? 1.0 : 0.0; };
  mip_maps.set = [](Configuration* c, double v) { c->bake.has_mip_maps = v != 0; };
  mip_maps.bake_unfit = [](const BakeableScene& scene, double) -> std::string {
    return scene.is_model ? texture_unfit(scene) : "only models are imported with other textures";
  };

  blocks.name = "textures", blocks.what = "how `bake --textures` stores texels";
  blocks.effect = "texture";
  blocks.values = {0, 1}, blocks.labels = {"compressed", "exact"};
  blocks.get = [](const Configuration& c) { return c.bake.is_compressed ? 0.0 : 1.0; };
  blocks.set = [](Configuration* c, double v) { c->bake.is_compressed = v == 0; };
  blocks.bake_unfit = [](const BakeableScene& scene, double) { return texture_unfit(scene); };

  radiosity.name = "radiosity", radiosity.what = "patches between which `bake --radiosity` solves light";
  radiosity.effect = kRadiosityEffect;
  radiosity.values = {0, 75, 300, 1200, 2400};
  radiosity.labels = {"as opened", "75 patches", "300 patches", "1200 patches", "2400 patches"};
  radiosity.get = [](const Configuration& c) { return static_cast<double>(c.bake.patch_count); };
  radiosity.set = [](Configuration* c, double v) { c->bake.patch_count = static_cast<std::uint32_t>(v); };
  radiosity.bake_unfit = [](const BakeableScene& scene, double) -> std::string {
    return scene.is_lit ? "" : "the scene stores it, or has no light of its own";
  };
  return knobs;
}

}  // namespace pocketray
