#include "desktop/radiosity/refine.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/fmath.h"

namespace pocketray {
namespace {

constexpr double kLampReach = 4;  // of the sum of radii: beyond, light varies little over a patch

struct Reflected {
  double power = 0, deviation = 0;  // radiosity times area, summed over the channels; its mean absolute deviation
};

// Light of lamps that lie close to a patch. Those farther away light it evenly.
Vec3d lamp_irradiance(const SceneRays& rays, const std::vector<const Patch*>& lamps, const Receiver& at) {
  Vec3d sum = {0, 0, 0};
  for (const Patch* lamp : lamps) {
    const double factor = patch_form_factor(at.point, at.normal, *lamp);
    if (factor > 0)
      sum += lamp->emission * (kPi * factor * visible_share(rays, at, *lamp, factor, 0, Backs::hide).here);
  }
  return sum;
}

Reflected reflected_on(const SceneRays& rays, const std::vector<const Patch*>& lamps, const Patch& patch, bool back) {
  std::vector<double> light;
  Reflected result;
  for (const PatchSample& s : patch.light_samples) {
    const Receiver at = {s.point, back ? -s.normal : s.normal, patch.lift};
    Vec3d reflected = lamp_irradiance(rays, lamps, at) * patch.albedo;
    if (!back) reflected += light_irradiance(rays, at) * patch.albedo;
    light.push_back((reflected.x + reflected.y + reflected.z) * patch.area / kLightSamples);
    result.power += light.back();
  }
  for (double x : light) result.deviation += std::fabs(x - result.power / kLightSamples);
  return result;
}

Reflected reflected_light(const SceneRays& rays, const std::vector<Patch>& lamps, const Patch& patch) {
  std::vector<const Patch*> close;
  for (const Patch& lamp : lamps)
    if (length(lamp.centre - patch.centre) < kLampReach * (lamp.radius + patch.radius)) close.push_back(&lamp);
  Reflected result = reflected_on(rays, close, patch, false);
  if (!patch.double_sided || close.empty()) return result;
  const Reflected back = reflected_on(rays, close, patch, true);
  result.power += back.power, result.deviation = std::max(result.deviation, back.deviation);
  return result;
}

// Patches that emit, with their backs.
std::vector<Patch> find_lamps(const std::vector<Patch>& patches) {
  std::vector<Patch> lamps;
  for (const Patch& patch : patches) {
    if (is_zero(patch.emission)) continue;
    lamps.push_back(patch);
    if (patch.double_sided) lamps.push_back(back_of(patch));
  }
  return lamps;
}

// The patches to be divided: those where light deviates by more than `least`, the worst if there is no room for all.
std::vector<char> most_uneven(const std::vector<Patch>& patches, const std::vector<Reflected>& light, double least,
                              std::uint32_t count_max) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < patches.size(); ++i)
    if (patches[i].is_flat && light[i].deviation > least) order.push_back(i);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return light[a].deviation > light[b].deviation; });
  std::vector<char> chosen(patches.size(), 0);
  std::size_t count = patches.size();
  for (std::size_t i : order) {
    if (count + 3 > count_max) break;
    chosen[i] = 1, count += 3;
  }
  return chosen;
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
  const std::vector<Patch> lamps = find_lamps(*patches);
  std::vector<Reflected> light(patches->size());
  std::vector<char> is_new(patches->size(), 1);
  double total = 0;
  for (const Patch& lamp : lamps) total += (lamp.emission.x + lamp.emission.y + lamp.emission.z) * kPi * lamp.area;
  for (int round = 0; round < kRefinements; ++round) {
    parallel_for(static_cast<std::uint32_t>(patches->size()), threads, [&](std::uint32_t i) {
      if (is_new[i]) light[i] = reflected_light(rays, lamps, (*patches)[i]);
    });
    if (round == 0 && lamps.empty())
      for (const Reflected& of : light) total += of.power;
    const std::vector<char> chosen = most_uneven(*patches, light, kUneven * total, count_max);
    std::vector<Patch> next;
    std::vector<Reflected> next_light;
    std::vector<char> next_is_new;
    for (std::size_t i = 0; i < patches->size(); ++i) {
      const Patch& patch = (*patches)[i];
      std::vector<Patch> parts;
      if (chosen[i]) parts = quarters_of(*rays.frame.scene, surfaces, patch);
      next_is_new.insert(next_is_new.end(), parts.empty() ? 1 : parts.size(), !parts.empty());
      next_light.insert(next_light.end(), parts.empty() ? 1 : parts.size(), light[i]);
      if (parts.empty()) parts.push_back(patch);
      next.insert(next.end(), parts.begin(), parts.end());
    }
    *patches = std::move(next), light = std::move(next_light), is_new = std::move(next_is_new);
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
