#include "radiosity/refine.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace pocketray {
namespace {

struct Reflected {
  double power = 0, deviation = 0;  // radiosity times area, summed over the channels; its mean absolute deviation
};

Reflected reflected_light(const SceneRays& rays, const Patch& patch) {
  std::vector<double> light;
  Reflected result;
  for (const PatchSample& s : patch.light_samples) {
    const Vec3d reflected = light_irradiance(rays, {s.point, s.normal, patch.lift}) * patch.albedo;
    light.push_back((reflected.x + reflected.y + reflected.z) * patch.area / kLightSamples);
    result.power += light.back();
  }
  for (double x : light) result.deviation += std::fabs(x - result.power / kLightSamples);
  return result;
}

constexpr std::uint32_t kCoverRays = 16;
constexpr double kCovered = 0.9;        // of back faces around a point inside a body
constexpr double kPartlyCovered = 0.1;  // of back faces around the samples of a patch that may be partly inside

void uncover(const SceneRays& rays, std::uint32_t seed, Patch* patch) {
  auto backs = [&](const PatchSample& s, std::uint32_t of) {
    return look_around(rays, {s.point, s.normal, patch->lift}, kCoverRays, seed * kLightSamples + of).back;
  };
  double mean = 0;
  for (std::uint32_t k = 0; k < kPatchSamples; ++k) mean += backs(patch->samples[k], k) / kPatchSamples;
  if (mean < kPartlyCovered) return;
  std::vector<PatchSample> open;
  for (std::uint32_t k = 0; k < kLightSamples; ++k)
    if (backs(patch->light_samples[k], k) <= kCovered) open.push_back(patch->light_samples[k]);
  patch->uncovered = static_cast<double>(open.size()) / kLightSamples;
  if (open.empty() || open.size() == kLightSamples) return;
  patch->area *= patch->uncovered;
  for (std::size_t k = 0; k < kPatchSamples; ++k)
    patch->samples[k] = open[(2 * k + 1) * open.size() / (2 * kPatchSamples)];
  patch->light_samples = open;
}

}  // namespace

Vec3d mean_light(const SceneRays& rays, const Patch& patch) {
  Vec3d sum = {0, 0, 0};
  for (const PatchSample& s : patch.light_samples) sum += light_irradiance(rays, {s.point, s.normal, patch.lift});
  return sum * (1.0 / static_cast<double>(patch.light_samples.size()));
}

void refine_patches(const SceneRays& rays, const Surfaces& surfaces, std::uint32_t count_max, std::uint32_t threads,
                    std::vector<Patch>* patches) {
  CHECK(patches != nullptr);
  std::vector<char> is_new(patches->size(), 1);
  double total = 0;
  for (int round = 0; round < kRefinements; ++round) {
    std::vector<Reflected> light(patches->size());
    parallel_for(static_cast<std::uint32_t>(patches->size()), threads, [&](std::uint32_t i) {
      if (is_new[i]) light[i] = reflected_light(rays, (*patches)[i]);
    });
    if (round == 0)
      for (const Reflected& of : light) total += of.power;
    std::vector<Patch> next;
    std::vector<char> next_is_new;
    for (std::size_t i = 0; i < patches->size(); ++i) {
      const Patch& patch = (*patches)[i];
      const bool full = next.size() + (patches->size() - i) + 3 > count_max;
      std::vector<Patch> parts;
      if (patch.is_flat && !full && light[i].deviation > kUneven * total)
        parts = quarters_of(*rays.frame.scene, surfaces, patch);
      next_is_new.insert(next_is_new.end(), parts.empty() ? 1 : parts.size(), !parts.empty());
      if (parts.empty()) parts.push_back(patch);
      next.insert(next.end(), parts.begin(), parts.end());
    }
    *patches = std::move(next), is_new = std::move(next_is_new);
  }
}

void uncover_patches(const SceneRays& rays, std::uint32_t threads, std::vector<Patch>* patches) {
  CHECK(patches != nullptr);
  parallel_for(static_cast<std::uint32_t>(patches->size()), threads,
               [&](std::uint32_t i) { uncover(rays, i, &(*patches)[i]); });
  patches->erase(
      std::remove_if(patches->begin(), patches->end(), [](const Patch& patch) { return patch.uncovered == 0; }),
      patches->end());
}

}  // namespace pocketray
