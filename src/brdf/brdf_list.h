// One line per glossy lobe. Their order is part of the .pray format: append only.
#pragma once
#include "base/limits.h"
#include "brdf/brdf.h"

namespace pocketray {

extern const BrdfInfo kPhongBrdf;
extern const BrdfInfo kGgxBrdf, kGrainedGgxBrdf;
extern const BrdfInfo kWardBrdf, kGrainedWardBrdf;

enum : std::uint32_t { kPhong, kGgx, kWard };  // values of Material::brdf
inline const BrdfInfo* const kBrdfList[] = {&kPhongBrdf, &kGgxBrdf, &kWardBrdf};
constexpr std::uint32_t kBrdfCount = sizeof kBrdfList / sizeof kBrdfList[0];
static_assert(kBrdfCount <= kBrdfCountMax, "raise it in base/limits.h");

// Mean albedo of Phong's lobe as a share of `specular`: a sharp lobe reflects specular · cos θ to a viewer at θ,
// because the light comes from that angle; over a convex body, seen from anywhere, the mean of cos θ is 2/3.
constexpr float kPhongAlbedo = 2.0f / 3;

// Returns whether the material's lobe has a grain, which needs texture coordinates or tangents.
inline bool has_grain(const Scene& scene, std::uint32_t material) {
  if (scene.grains.empty() || (scene.uvs.empty() && scene.tangents.empty())) return false;
  if (!kBrdfList[scene.materials[material].brdf]->with_grain) return false;
  const Vec2& direction = scene.grains[material].direction;
  return direction.x != 0 || direction.y != 0;
}

}  // namespace pocketray
