#include "plan/quality_level.h"

#include <doctest/doctest.h>

#include <cmath>

#include "base/rng.h"

using namespace pocketray;

namespace {

Candidate candidate(std::uint32_t samples, float ns, float flip) {
  Candidate c;
  c.samples_per_pixel = samples, c.ns_per_pixel = ns, c.flip = flip;
  return c;
}

}  // namespace

TEST_CASE("quality levels have names") {
  QualityLevel level;
  for (int i = 0; i < kQualityLevelCount; ++i) {
    REQUIRE(find_quality_level(kQualityLevelNames[i], &level));
    CHECK(static_cast<int>(level) == i);
  }
  for (const char* name : {"", "Best", "highest", "med"}) CHECK(!find_quality_level(name, &level));
}

// Goal: levels divide a front's range of times evenly, by ratio. Method: a front of powers of two, given out of order
// and with a dominated point; then random fronts, where time never falls and error never rises with the level.
TEST_CASE("quality levels are points of the front") {
  Front front;
  for (std::uint32_t i : {4u, 1u, 8u, 2u, 16u}) {
    front.candidates[front.count++] = candidate(i, 100.0f * static_cast<float>(i), 0.4f / static_cast<float>(i));
  }
  front.candidates[front.count++] = candidate(64, 300, 0.9f);
  for (int i = 0; i < kQualityLevelCount; ++i)
    CHECK(level_of(front, static_cast<QualityLevel>(i)).samples_per_pixel == 1u << i);
  Front alone;
  alone.candidates[alone.count++] = candidate(3, 1, 0.5f);
  for (int i = 0; i < kQualityLevelCount; ++i)
    CHECK(level_of(alone, static_cast<QualityLevel>(i)).samples_per_pixel == 3);
  Rng rng = make_rng(8);
  for (int round = 0; round < 200; ++round) {
    Front random;
    const std::uint32_t count = 1 + next_u32(&rng) % kFrontCandidateMax;
    for (std::uint32_t i = 0; i < count; ++i)
      random.candidates[random.count++] =
          candidate(i, static_cast<float>(std::exp(8 * next_double(&rng))), static_cast<float>(next_double(&rng)));
    Candidate before = level_of(random, QualityLevel::draft);
    for (int i = 1; i < kQualityLevelCount; ++i) {
      const Candidate next = level_of(random, static_cast<QualityLevel>(i));
      CHECK(next.ns_per_pixel >= before.ns_per_pixel);
      CHECK(next.flip <= before.flip);
      before = next;
    }
    for (std::uint32_t i = 0; i < count; ++i) CHECK(before.flip <= random.candidates[i].flip);
  }
}

TEST_CASE("medium is the default, and each built-in level is at least as accurate as the one before") {
  CHECK(same_quality(builtin_level(QualityLevel::medium, kAllEffects), Quality()));
  Quality before = builtin_level(QualityLevel::draft, 0);
  for (int i = 1; i < kQualityLevelCount; ++i) {
    const Quality next = builtin_level(static_cast<QualityLevel>(i), 0);
    CHECK(next.samples_per_pixel >= before.samples_per_pixel);
    CHECK(next.ray_depth >= before.ray_depth);
    CHECK(next.samples_per_pixel * next.points_per_area_light >=
          before.samples_per_pixel * before.points_per_area_light);  // samples have points of their own
    CHECK(next.cut_off_levels <= before.cut_off_levels);
    CHECK(next.selective_contrast <= before.selective_contrast);
    CHECK(next.light_tolerance <= before.light_tolerance);
    CHECK(!same_quality(next, before));
    before = next;
  }
}

// Goal: the upper levels find light from wall to wall where lights cause it, whether a constant stands for it or
// nothing.
TEST_CASE("high quality finds the indirect light of lit scenes") {
  const EffectMask lit = bit(Effect::ambient) | bit(Effect::area_light);
  CHECK(builtin_level(QualityLevel::high, bit(Effect::point_light)).indirect ==
        indirect_choice(Effect::instant_radiosity));
  for (QualityLevel level : {QualityLevel::high, QualityLevel::best}) {
    CHECK(builtin_level(level, lit).indirect == indirect_choice(Effect::instant_radiosity));
    CHECK(builtin_level(level, bit(Effect::ambient)).indirect == IndirectChoice::automatic);
    CHECK(builtin_level(level, bit(Effect::radiosity) | bit(Effect::area_light)).indirect == IndirectChoice::automatic);
  }
  CHECK(builtin_level(QualityLevel::medium, lit).indirect == IndirectChoice::automatic);
}
