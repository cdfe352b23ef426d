#include "plan/front.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <string>

#include "base/rng.h"
#include "plan/plan_effects.h"

using namespace pocketray;

namespace {

const std::string kHead = "pocketray-front 2\n";
const std::string kLine =
    "samples=4 depth=8 area-lights=16 cut-off=0.5 "
    "texture-filter=scene normals=scene indirect=auto "
    "reconstruction=bicubic virtual-lights=64 selective=0 resolution=full light-tolerance=0.0625 "
    "environment-shadows=32 flip=0.0123 "
    "ns=812\n";

std::string text_of(const Front& front) {
  std::string text(kFrontTextMax, 0);
  text.resize(format_front(front, &text[0], text.size()));
  return text;
}

Status parse(const std::string& text, Front* front) {
  std::unique_ptr<char[]> exact(new char[text.size()]);  // lets a sanitizer see any read beyond it
  std::memcpy(exact.get(), text.data(), text.size());
  return parse_front(exact.get(), text.size(), front);
}

Candidate random_candidate(Rng* rng) {
  Candidate c;
  c.samples_per_pixel = 1 + next_u32(rng) % kSampleCountMax;
  c.ray_depth = next_u32(rng) % (kRayDepthMax + 1);
  c.points_per_area_light = 1 + next_u32(rng) % kPointsPerAreaLightMax;
  c.cut_off_levels = next_float(rng) * kCutOffLevelsMax;
  c.texture_filter = static_cast<TextureFilter>(next_u32(rng) % 5);
  c.normals = static_cast<NormalMode>(next_u32(rng) % 2);
  c.indirect = static_cast<IndirectChoice>(next_u32(rng) % kIndirectChoiceCount);
  c.virtual_lights = 1 + next_u32(rng) % kVirtualLightMax;
  c.reconstruction = static_cast<Reconstruction>(next_u32(rng) % 5);
  c.flip = next_u32(rng) % 4 ? next_float(rng) : kErrorUnknown;
  c.ns_per_pixel = kPriceNsMin + next_float(rng) * std::ldexp(1.0f, static_cast<int>(next_u32(rng) % 28));
  return c;
}

bool is_sorted(const Front& front) {
  for (std::uint32_t i = 1; i < front.count; ++i)
    if (front.candidates[i].ns_per_pixel < front.candidates[i - 1].ns_per_pixel) return false;
  return true;
}

}  // namespace

// Goal: a front comes back from its file with the same bits, including dominated candidates. Method: random fronts of
// every size, half of them with all errors known, written, read and written again.
TEST_CASE("front_text_round_trips") {
  Rng rng = make_rng(7);
  for (std::uint32_t count = 1; count <= kFrontCandidateMax; ++count) {
    Front front;
    while (front.count < count) {
      Candidate& c = front.candidates[front.count++] = random_candidate(&rng);
      if (count % 2) c.flip = next_float(&rng);
    }
    std::string text = text_of(front);
    Front back;
    Status status = parse(text, &back);
    INFO(status.message);
    REQUIRE(status.ok);
    REQUIRE(back.count == front.count);
    for (std::uint32_t i = 0; i < front.count; ++i) {
      CHECK(same_quality(front.candidates[i], back.candidates[i]));
      CHECK(std::memcmp(&front.candidates[i].ns_per_pixel, &back.candidates[i].ns_per_pixel, 4) == 0);
      CHECK(std::isnan(front.candidates[i].flip) == std::isnan(back.candidates[i].flip));
      if (!std::isnan(front.candidates[i].flip)) CHECK(front.candidates[i].flip == back.candidates[i].flip);
    }
    CHECK(text_of(back) == text);
  }
}

// Goal: the format matches its documentation. Method: the documented line, field by field; names in any order,
// comments, empty lines and the line endings of another system change nothing.
TEST_CASE("front_text_is_as_documented") {
  Front front;
  REQUIRE(parse(kHead + kLine, &front).ok);
  REQUIRE(front.count == 1);
  const Candidate& c = front.candidates[0];
  CHECK(c.samples_per_pixel == 4);
  CHECK(c.ray_depth == 8);
  CHECK(c.points_per_area_light == 16);
  CHECK(c.cut_off_levels == 0.5f);
  CHECK(c.texture_filter == TextureFilter::as_scene);
  CHECK(c.normals == NormalMode::as_scene);
  CHECK(c.flip == 0.0123f);
  CHECK(c.ns_per_pixel == 812);
  Front other;
  REQUIRE(parse(kHead + "# as measured\r\n\r\nns=812  flip=0.0123 samples=4 normals=scene indirect=auto "
                        "reconstruction=bicubic virtual-lights=64 selective=0 resolution=full light-tolerance=0.0625 "
                        "environment-shadows=32 "
                        "depth=8 area-lights=16 "
                        "texture-filter=scene cut-off=5e-1\r\n",
                &other)
              .ok);
  CHECK(text_of(other) == text_of(front));
}

// Goal: faults in a file are reported with their line. Method: one fault each; every message names line and cause, and
// nothing of the file is kept.
TEST_CASE("front_text_faults_are_named") {
  const struct {
    std::string text;
    const char* says;
  } kFaults[] = {
      {"", "begins with"},
      {"hello\n", "begins with"},
      {"pocketray-front 1\n" + kLine, "version 2"},
      {kHead, "no candidate"},
      {kHead + "samples=4\n", "line 2: depth= is missing"},
      {kHead + "# one\n" + kLine + kLine, "line 4: these settings"},
      {kHead + "samples=99" + kLine.substr(9), "line 2: the number of samples per pixel is 99: it must lie in 1"},
      {kHead + "samples=0x4" + kLine.substr(9), "line 2: 'samples=0x4'"},
      {kHead + "samples=-4" + kLine.substr(9), "line 2: 'samples=-4'"},
      {kHead + "samples=" + kLine.substr(9), "line 2: 'samples='"},
      {kHead + "samples=4294967300" + kLine.substr(9), "line 2: 'samples=4294967300'"},
      {kHead + "sparkle=4 " + kLine, "line 2: 'sparkle=4'"},
      {kHead + "samples=4 " + kLine, "repeated setting"},
      {kHead + kLine.substr(0, kLine.find("ns=")) + "ns=0\n", "'ns=0'"},
      {kHead + kLine.substr(0, kLine.find("ns=")) + "ns=inf\n", "'ns=inf'"},
      {kHead + kLine.substr(0, kLine.find("ns=")) + "ns=1e39\n", "'ns=1e39'"},
      {kHead + kLine.substr(0, kLine.find("flip=")) + "flip=1.5 ns=1\n", "'flip=1.5'"},
      {kHead + kLine.substr(0, kLine.find("flip=")) + "flip=nan ns=1\n", "'flip=nan'"},
      {kHead + "cut-off=65 " +
           "samples=4 depth=8 area-lights=16 texture-filter=scene "
           "normals=scene indirect=auto "
           "reconstruction=bicubic "
           "virtual-lights=64 selective=0 resolution=full light-tolerance=0.0625 environment-shadows=32 "
           "ns=812\n",
       "line 2: the cut-off in display levels is 65"},
      {kHead + kLine.substr(0, kLine.find("ns=")) + "ns=" + std::string(60, '0') + "8\n", "line 2: 'ns=000"},
      {kHead + std::string(kFrontLineMax + 1, 'x') + "\n", "longer than"},
  };
  for (const auto& fault : kFaults) {
    Front front;
    front.count = 1;
    Status status = parse(fault.text, &front);
    CAPTURE(fault.text);
    CAPTURE(status.message);
    CHECK(!status.ok);
    CHECK(std::strstr(status.message, fault.says) != nullptr);
    CHECK(front.count == 0);
  }
  std::string many = kHead;
  for (std::uint32_t i = 1; i <= kFrontCandidateMax + 1; ++i)
    many += "samples=1 depth=8 area-lights=" + std::to_string(i) +
            " cut-off=0 texture-filter=scene normals=flat indirect=auto "
            "reconstruction=bicubic "
            "virtual-lights=64 "
            "selective=0 resolution=full light-tolerance=0.0625 environment-shadows=32 ns=" +
            std::to_string(i) + "\n";
  Front front;
  CHECK(!parse(many, &front).ok);
}

// Goal: no file makes the reader read beyond it, and accepted files hold no number out of range. Method: every prefix,
// and every flipped bit of a file of a few lines, in memory of exactly their size.
TEST_CASE("front_text_takes_hostile_bytes") {
  Rng rng = make_rng(11);
  Front front;
  for (int i = 0; i < 4; ++i) front.candidates[front.count++] = random_candidate(&rng);
  std::string text = text_of(front);
  int taken = 0;
  auto check = [&](const std::string& bytes) {
    Front read;
    Status status = parse(bytes, &read);
    taken += status.ok;
    REQUIRE(read.count <= kFrontCandidateMax);
    REQUIRE((read.count > 0) == status.ok);
    for (std::uint32_t i = 0; i < read.count; ++i) {
      const Candidate& c = read.candidates[i];
      REQUIRE(validate_settings(with_candidate(Settings(), c)).ok);
      REQUIRE((c.ns_per_pixel >= kPriceNsMin && c.ns_per_pixel <= kPriceNsMax));
      REQUIRE((std::isnan(c.flip) || (c.flip >= 0 && c.flip <= 1)));
    }
  };
  for (std::size_t size = 0; size <= text.size(); ++size) check(text.substr(0, size));
  for (std::size_t at = 0; at < text.size(); ++at)
    for (int flipped = 0; flipped < 8; ++flipped) {
      std::string bytes = text;
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << flipped));
      check(bytes);
    }
  CHECK(taken > 0);  // a flipped digit is as good as any
}

// Goal: a front holds no candidate that costs more without being better. Method: random candidates with errors; each
// one dropped is dominated by one that stays, and none that stays is dominated.
TEST_CASE("front_keeps_what_nothing_dominates") {
  Rng rng = make_rng(3);
  for (int round = 0; round < 50; ++round) {
    Front all, front;
    while (all.count < 20) {
      Candidate c = random_candidate(&rng);
      c.flip = static_cast<float>(next_u32(&rng) % 8) / 8;
      c.ns_per_pixel = static_cast<float>(1 + next_u32(&rng) % 8);
      all.candidates[all.count++] = c;
    }
    front = all;
    sort_front(&front);
    REQUIRE(is_sorted(front));
    for (std::uint32_t i = 1; i < front.count; ++i) {
      CHECK(front.candidates[i].ns_per_pixel > front.candidates[i - 1].ns_per_pixel);
      CHECK(front.candidates[i].flip < front.candidates[i - 1].flip);
    }
    for (std::uint32_t i = 0; i < all.count; ++i) {
      bool covered = false;
      for (std::uint32_t k = 0; k < front.count; ++k)
        covered = covered || (front.candidates[k].ns_per_pixel <= all.candidates[i].ns_per_pixel &&
                              front.candidates[k].flip <= all.candidates[i].flip);
      CHECK(covered);
    }
    Front unknown = all;
    unknown.candidates[5].flip = kErrorUnknown;
    sort_front(&unknown);
    CHECK(unknown.count == all.count);
  }
}

// Goal: measured prices replace others, and unmeasured ones are scaled accordingly. Method: closed form.
TEST_CASE("front_adopts_prices") {
  Front front = builtin_front(0), measured;
  CHECK(!adopt_prices(&front, measured));
  measured.candidates[0] = front.candidates[2];
  measured.candidates[1] = front.candidates[4];
  measured.candidates[0].ns_per_pixel *= 2;
  measured.candidates[1].ns_per_pixel *= 8;
  measured.count = 2;
  float before = front.candidates[9].ns_per_pixel;
  Candidate untouched = front.candidates[9];
  REQUIRE(adopt_prices(&front, measured));
  CHECK(!is_sorted(front));  // it is ordered by accuracy, which no price changes
  for (std::uint32_t i = 1; i < front.count; ++i)
    CHECK(front.candidates[i].samples_per_pixel >= front.candidates[i - 1].samples_per_pixel);
  for (std::uint32_t i = 0; i < front.count; ++i) {
    const Candidate& c = front.candidates[i];
    if (same_quality(c, measured.candidates[0])) CHECK(c.ns_per_pixel == measured.candidates[0].ns_per_pixel);
    if (same_quality(c, measured.candidates[1])) CHECK(c.ns_per_pixel == measured.candidates[1].ns_per_pixel);
    if (same_quality(c, untouched)) CHECK(c.ns_per_pixel == doctest::Approx(before * 4));  // √(2 · 8)
  }
}

// Goal: a computed price is valid in a file. Method: closed form beyond both ends; measured prices at the extremes,
// which push the scaled ones out of range.
TEST_CASE("front_prices_stay_in_range") {
  CHECK(clamped_price(1e300) == kPriceNsMax);
  CHECK(clamped_price(0) == kPriceNsMin);
  CHECK(clamped_price(std::nan("")) == kPriceNsMin);
  CHECK(clamped_price(812) == 812);
  for (float extreme : {kPriceNsMin, kPriceNsMax}) {
    Front front = builtin_front(0), measured, back;
    std::uint32_t end = extreme == kPriceNsMin ? front.count - 1 : 0;
    measured.candidates[measured.count++] = front.candidates[end];
    measured.candidates[0].ns_per_pixel = extreme;
    REQUIRE(adopt_prices(&front, measured));
    Status status = parse(text_of(front), &back);
    INFO(status.message);
    CHECK(status.ok);
  }
}

namespace {

// Checks that each knob of a step is at least that of the step before, and that no two candidates are the same for any
// set of effects.
void check_ascent(EffectMask plan) {
  Front front = builtin_front(plan);
  CHECK(!errors_known(front));
  for (std::uint32_t i = 1; i < front.count; ++i) {
    const Candidate &a = front.candidates[i - 1], &b = front.candidates[i];
    CAPTURE(i);
    CHECK(b.ns_per_pixel > a.ns_per_pixel);
    CHECK(b.samples_per_pixel >= a.samples_per_pixel);
    CHECK(b.ray_depth >= a.ray_depth);
    CHECK(b.points_per_area_light >= a.points_per_area_light);
    CHECK(b.cut_off_levels <= a.cut_off_levels);
    CHECK(b.selective_contrast <= a.selective_contrast);
    CHECK(b.resolution <= a.resolution);
    CHECK((b.indirect >= a.indirect && b.virtual_lights >= a.virtual_lights && b.compensation >= a.compensation));
    CHECK(validate_settings(with_candidate(Settings(), b)).ok);
  }
  for (std::uint64_t effects = 0; effects <= kAllEffects; effects += 3000017) {
    Front fit = front;
    drop_what_scene_ignores(&fit, static_cast<EffectMask>(effects));
    CHECK(is_sorted(fit));
    for (std::uint32_t i = 0; i < fit.count; ++i)
      for (std::uint32_t k = 0; k < i; ++k) CHECK(!same_quality(fit.candidates[i], fit.candidates[k]));
  }
  Front all = front, plain = front;
  drop_what_scene_ignores(&all, kAllEffects);
  CHECK(all.count == front.count);
  drop_what_scene_ignores(&plain, 0);
  // 1, 2, 4, 8 and 16 samples; of 1, some pixels interpolated at three contrasts, or a quarter. Virtual lights add 128 of
  // them with one sample, and the tolerance 0 at the end.
  CHECK(plain.count == (lacks_indirect_light(plan) ? 11 : 9));
}

}  // namespace

// Goal: the built-in ladder only ever adds accuracy, and a scene is offered no two settings with the same picture.
// Method: each knob of a step is at least that of the step before; for every set of effects, no two candidates are the
// same, and those that matter to it stay.
TEST_CASE("front_builtin_ascends") {
  constexpr EffectMask kLit = bit(Effect::ambient) | bit(Effect::area_light);
  for (EffectMask effects : {EffectMask(0), kLit, kLit | bit(Effect::radiosity), bit(Effect::ambient)})
    check_ascent(effects);
  const Front lit = builtin_front(kLit), unlit = builtin_front(bit(Effect::ambient));
  CHECK(lit.count == unlit.count + 1);
  CHECK(lit.candidates[0].indirect == IndirectChoice::automatic);
  CHECK(lit.candidates[lit.count - 1].indirect == indirect_choice(Effect::instant_radiosity));
  CHECK(unlit.candidates[unlit.count - 1].indirect == IndirectChoice::automatic);
}

// Goal: candidates keep the settings of the method of indirect light that they choose, whatever method the renderer has
// now. Method: instant radiosity and the ambient term, each with two numbers of virtual lights, where the ambient term
// is on.
TEST_CASE("front_keeps_the_settings_of_other_methods") {
  Front front;
  for (Effect method : {Effect::instant_radiosity, Effect::ambient})
    for (std::uint32_t lights : {64u, 256u}) {
      Candidate* c = &front.candidates[front.count++];
      c->indirect = indirect_choice(method), c->virtual_lights = lights;
    }
  drop_what_scene_ignores(&front, bit(Effect::ambient));
  REQUIRE(front.count == 3);
  CHECK((front.candidates[0].virtual_lights == 64 && front.candidates[1].virtual_lights == 256));
  CHECK((front.candidates[2].indirect == indirect_choice(Effect::ambient) && front.candidates[2].virtual_lights == 64));
}

// Goal: changes are described in words. Method: examples.
TEST_CASE("front_describes_changes") {
  char text[256];
  Candidate a, b;
  describe_change(a, b, text, sizeof text);
  CHECK(std::string(text) == "nothing");
  b.samples_per_pixel = 4, b.ray_depth = 2, b.normals = NormalMode::flat, b.cut_off_levels = 2;
  describe_change(b, a, text, sizeof text);
  CHECK(std::string(text) == "samples 4 to 1, depth 2 to 8, cut-off 2 to 0.5, normals flat to scene");
  char few[8];
  describe_change(b, a, few, sizeof few);
  CHECK(std::string(few) == "samples");
}

// Goal: pictures that are written are judged with their 24 bits, where that error is known.
TEST_CASE("front_is_judged_with_24_bits") {
  Front front;
  front.count = 3;
  for (std::uint32_t i = 0; i < 3; ++i) front.candidates[i].samples_per_pixel = i + 1, front.candidates[i].flip = 0.25f;
  front.candidates[0].flip888 = 0.125f, front.candidates[1].flip888 = 0.5f;
  Front read;
  REQUIRE(parse(text_of(front), &read).ok);
  show_24_bits(&read);
  CHECK(read.candidates[0].flip == 0.125f);
  CHECK(read.candidates[1].flip == 0.5f);
  CHECK(read.candidates[2].flip == 0.25f);
}
