#include "plan/front.h"

#include <cmath>
#include <utility>

#include "base/check.h"
#include "base/fmath.h"

namespace pocketray {
namespace {

bool dominates(const Candidate& a, const Candidate& b) { return a.ns_per_pixel <= b.ns_per_pixel && a.flip <= b.flip; }

void drop(Front* front, std::uint32_t index) {
  CHECK_LT(index, front->count);
  for (std::uint32_t i = index + 1; i < front->count; ++i) front->candidates[i - 1] = front->candidates[i];
  --front->count;
}

// Returns the effect that a choice asks for; 0 for auto and none.
EffectMask effect_of(IndirectChoice choice) {
  for (const EffectRow& row : kEffectList)
    if (has(kIndirectEffects, row.effect) && indirect_choice(row.effect) == choice) return bit(row.effect);
  return 0;
}

}  // namespace

const Candidate* find_candidate(const Front& front, const Quality& quality) {
  CHECK_LE(front.count, kFrontCandidateMax);
  for (std::uint32_t i = 0; i < front.count; ++i)
    if (same_quality(front.candidates[i], quality)) return &front.candidates[i];
  return nullptr;
}

float clamped_price(double ns) {
  constexpr double kMin = static_cast<double>(kPriceNsMin), kMax = static_cast<double>(kPriceNsMax);
  return static_cast<float>(ns > kMin ? ns < kMax ? ns : kMax : kMin);  // NaN: the minimum
}

Candidate candidate_of(const Quality& quality) {
  Candidate c;
  static_cast<Quality&>(c) = quality;
  return c;
}

Settings with_candidate(const Settings& settings, const Quality& quality) {
  Settings s = settings;
  static_cast<Quality&>(s) = quality;
  return s;
}

bool errors_known(const Front& front) {
  CHECK_LE(front.count, kFrontCandidateMax);
  for (std::uint32_t i = 0; i < front.count; ++i)
    if (std::isnan(front.candidates[i].flip)) return false;
  return true;
}

void show_24_bits(Front* front) {
  CHECK_LE(front->count, kFrontCandidateMax);
  for (std::uint32_t i = 0; i < front->count; ++i)
    if (!std::isnan(front->candidates[i].flip888)) front->candidates[i].flip = front->candidates[i].flip888;
}

void sort_by_price(Front* front) {
  CHECK_LE(front->count, kFrontCandidateMax);
  for (std::uint32_t i = 1; i < front->count; ++i)
    for (std::uint32_t k = i; k > 0 && front->candidates[k].ns_per_pixel < front->candidates[k - 1].ns_per_pixel; --k)
      std::swap(front->candidates[k], front->candidates[k - 1]);
}

void sort_front(Front* front) {
  if (!errors_known(*front)) return;
  sort_by_price(front);
  for (std::uint32_t i = 0; i < front->count;) {
    bool worse = false;
    for (std::uint32_t k = 0; k < front->count; ++k) {
      const Candidate &a = front->candidates[k], &b = front->candidates[i];
      worse = worse || (k != i && dominates(a, b) && (k < i || !dominates(b, a)));
    }
    if (worse)
      drop(front, i);
    else
      ++i;
  }
}

bool adopt_prices(Front* front, const Front& measured) {
  double log_sum = 0;
  int found = 0;
  for (std::uint32_t i = 0; i < front->count; ++i)
    if (const Candidate* same = find_candidate(measured, front->candidates[i])) {
      log_sum +=
          det_log(static_cast<double>(same->ns_per_pixel) / static_cast<double>(front->candidates[i].ns_per_pixel));
      ++found;
    }
  if (found == 0) return false;
  CHECK(std::isfinite(log_sum));  // prices are positive
  double ratio = det_exp(log_sum / found);
  for (std::uint32_t i = 0; i < front->count; ++i) {
    Candidate& c = front->candidates[i];
    const Candidate* same = find_candidate(measured, c);
    c.ns_per_pixel = same ? same->ns_per_pixel : clamped_price(static_cast<double>(c.ns_per_pixel) * ratio);
  }
  return true;
}

Front prices_alone(const Front& front) {
  Front prices = front;
  for (std::uint32_t i = 0; i < prices.count; ++i)
    prices.candidates[i].flip = prices.candidates[i].flip888 = kErrorUnknown;
  return prices;
}

bool lacks_indirect_light(EffectMask effects) {
  constexpr EffectMask kLights =
      bit(Effect::point_light) | bit(Effect::spot_light) | bit(Effect::directional_light) | bit(Effect::area_light);
  return !has(effects, Effect::radiosity) && (effects & kLights) != 0;
}

Front builtin_front(EffectMask effects) {
  constexpr struct {
    std::uint32_t samples, depth, area_lights;
    float cut_off, contrast;
    Resolution resolution = Resolution::full;
    float light_tolerance = 0.0625f;
    std::uint32_t environment_shadows = 32;
    std::uint32_t virtual_lights = 256;  // where the scene lacks indirect light: with compensation; 0: none
  } kLadder[] = {{1, 0, 1, 4, 0.5f, Resolution::half, 0.5f, 32, 0},
                 {1, 0, 1, 4, 0.5f, Resolution::full, 0.5f, 32, 0},
                 {1, 1, 1, 4, 0.25f, Resolution::full, 0.25f, 32, 0},
                 {1, 2, 2, 0.5f, 0.25f, Resolution::full, 0.125f, 32, 0},
                 {1, 8, 4, 0.5f, 0.25f, Resolution::full, 0.0625f, 32, 0},
                 {1, 8, 4, 0.5f, 0.125f, Resolution::full, 0.0625f, 32, 0},
                 {1, 8, 4, 0.5f, 0, Resolution::full, 0.0625f, 32, 0},
                 {1, 8, 4, 0.5f, 0, Resolution::full, 0.0625f, 32, 128},
                 {2, 8, 4, 0.5f, 0},
                 {4, 8, 4, 0.5f, 0},
                 {4, 8, 8, 0.5f, 0, Resolution::full, 0.0625f, 64},
                 {8, 8, 8, 0.5f, 0, Resolution::full, 0.0625f, 64},
                 {8, 8, 16, 0.5f, 0, Resolution::full, 0.0625f, 128},
                 {16, 8, 16, 0.5f, 0, Resolution::full, 0.0625f, 128, 512},
                 {16, 8, 64, 0.5f, 0, Resolution::full, 0.0625f, 256, 512},
                 {16, 16, 64, 0, 0, Resolution::full, 0, 256, 512}};
  static_assert(sizeof kLadder / sizeof kLadder[0] <= kFrontCandidateMax, "a front holds them");
  Front front;
  Candidate c;
  c.texture_filter = TextureFilter::nearest;
  const bool takes_virtual_lights = lacks_indirect_light(effects);
  for (const auto& row : kLadder) {
    if (takes_virtual_lights && row.virtual_lights) {
      c.indirect = indirect_choice(Effect::instant_radiosity);
      c.virtual_lights = row.virtual_lights, c.compensation = Compensation::rays;
    }
    c.samples_per_pixel = row.samples;
    c.ray_depth = row.depth;
    c.points_per_area_light = row.area_lights;
    c.cut_off_levels = row.cut_off;
    c.selective_contrast = row.contrast;
    c.resolution = row.resolution;
    c.light_tolerance = row.light_tolerance;
    c.environment_shadows = row.environment_shadows;
    // Guesses within a factor of two of `pocketray bench` on the built-in scenes.
    double reach = row.depth < 4 ? row.depth : 4, points = row.area_lights;
    double exact = row.cut_off == 0 ? 1.2 : row.cut_off > 1 ? 0.95 : 1.0;
    double sample_ns = exact * (200 + 40 * reach + (c.texture_filter == TextureFilter::nearest ? 0 : 10) +
                                60 * points * (1 + 0.1 * reach));
    if (c.compensation == Compensation::rays) sample_ns += 300 + 1.6 * c.virtual_lights;
    double traced = row.contrast == 0 ? 1 : row.contrast < 0.25f ? 0.5 : row.contrast < 0.5f ? 0.42 : 0.36;
    if (row.resolution == Resolution::half) traced *= 0.6;
    c.ns_per_pixel = static_cast<float>(sample_ns * traced * row.samples);
    // Without virtual lights, the first row that has them repeats the one before.
    if (front.count == 0 || !same_quality(c, front.candidates[front.count - 1])) front.candidates[front.count++] = c;
    c.texture_filter = TextureFilter::as_scene;
  }
  return front;
}

void drop_what_scene_ignores(Front* front, EffectMask effects) {
  const Quality usual;
  for (std::uint32_t i = 0; i < front->count; ++i) {
    const EffectMask seen = effects | effect_of(front->candidates[i].indirect);
    for (const SettingRow& row : kSettingList)
      if (row.seen_with != kAlways && !(row.seen_with & seen))
        row.field.set(&front->candidates[i], row.field.get(usual));
  }
  for (std::uint32_t i = 1; i < front->count;) {  // the first of equal qualities is the cheapest
    std::uint32_t k = 0;
    while (k < i && !same_quality(front->candidates[k], front->candidates[i])) ++k;
    if (k < i)
      drop(front, i);
    else
      ++i;
  }
}

}  // namespace pocketray
