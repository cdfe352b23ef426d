// Light maps: what is decoded is what was encoded, to a known error, and nothing worse comes of hostile bytes.
#include "wire/light_coder.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "base/rng.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

// A smooth map with an edge, and noise of that ratio.
std::vector<Vec3> smooth_map(std::uint32_t columns, std::uint32_t rows, float noise, Rng* rng) {
  std::vector<Vec3> light(columns * rows);
  for (std::uint32_t i = 0; i < light.size(); ++i) {
    const float x = static_cast<float>(i % columns) / static_cast<float>(columns),
                y = static_cast<float>(i / columns) / static_cast<float>(rows);
    const float level = (0.2f + x * y) * (x > 0.6f ? 3.0f : 1.0f) * (1 + noise * next_float(rng));
    light[i] = {level, level * 0.8f, level * (0.5f + 0.2f * x)};
  }
  return light;
}

std::vector<std::uint8_t> encoded(std::vector<Vec3>* light, std::uint32_t columns, float faintest = 0) {
  std::vector<std::uint8_t> bytes(light_bytes_max(light->size()));
  const auto rows = static_cast<std::uint32_t>(light->size()) / columns;
  bytes.resize(encode_light(light->data(), columns, rows, faintest, bytes.data()));
  return bytes;
}

bool decoded(const std::vector<std::uint8_t>& bytes, std::uint32_t columns, std::vector<Vec3>* light) {
  return decode_light(bytes.data(), bytes.size(), columns, static_cast<std::uint32_t>(light->size()) / columns,
                      light->data());
}

}  // namespace

// Goal: levels are even in ratio, in order, and finite. Method: every level; values about each.
TEST_CASE("light_level_errs_by_a_64th_at_most") {
  float before = -1;
  for (std::uint32_t level = 0; level <= kLightLevelMax; ++level) {
    const float value = light_of_level(level);
    REQUIRE(std::isfinite(value));
    REQUIRE(value > before);
    REQUIRE(light_level(value) == level);
    before = value;
  }
  for (float value = 1e-6f; value < 1e6f; value *= 1.0013f)
    CHECK(std::fabs(light_of_level(light_level(value)) / value - 1) <= 1.0f / 64);
  CHECK(light_level(0) == 0);
  CHECK(light_level(-1) == 0);
  CHECK(light_level(std::numeric_limits<float>::infinity()) == kLightLevelMax);
  CHECK(light_level(std::nanf("")) == kLightLevelMax);
}

// Goal: the receiver gets what the encoder leaves in the map, which is within a level of what was there.
TEST_CASE("light_map_round_trip") {
  Rng rng = make_rng(1);
  for (std::uint32_t columns : {1u, 2u, 7u, 54u}) {
    for (std::uint32_t rows : {1u, 3u, 40u})
      for (float noise : {0.0f, 0.05f, 100.0f}) {
        const std::vector<Vec3> wanted = smooth_map(columns, rows, noise, &rng);
        std::vector<Vec3> sent = wanted, got(wanted.size(), Vec3{7, 7, 7});
        const std::vector<std::uint8_t> bytes = encoded(&sent, columns);
        REQUIRE(decoded(bytes, columns, &got));
        for (std::size_t i = 0; i < wanted.size(); ++i) {
          REQUIRE(got[i] == sent[i]);
          for (int c = 0; c < 3; ++c) REQUIRE(std::fabs(got[i][c] - wanted[i][c]) <= wanted[i][c] / 64);
        }
      }
  }
}

// Goal: smooth light takes little, free lights next to nothing, and what no code makes shorter its plain size.
TEST_CASE("light_map_takes_few_bytes") {
  Rng rng = make_rng(2);
  std::vector<Vec3> smooth = smooth_map(54, 40, 0, &rng), free = smooth, wild(54 * 40);
  CHECK(encoded(&smooth, 54).size() < 54 * 40 * 5 / 8);
  for (Vec3& light : free) light = {-1, -1, -1};
  CHECK(encoded(&free, 54).size() < 54 * 40 / 50);
  for (const Vec3& light : free) CHECK(light == Vec3{0, 0, 0});
  // A single light of three levels far apart.
  wild.assign(1, Vec3{light_of_level(kLightLevelMax), 0, light_of_level(2801)});
  const std::vector<std::uint8_t> bytes = encoded(&wild, 1);
  CHECK(bytes == std::vector<std::uint8_t>{0xE0, 0x17, 0, 0, 0xF1, 0x0A});
  std::vector<Vec3> got(1);
  REQUIRE(decoded(bytes, 1, &got));
  CHECK(got[0] == wild[0]);
}

// Goal: light too faint to be seen costs nothing.
TEST_CASE("light_map_has_nothing_below_the_faintest") {
  Rng rng = make_rng(3);
  std::vector<Vec3> light(100);
  for (Vec3& l : light) l = Vec3{1, 1, 1} * (1e-9f * next_float(&rng));
  const std::size_t byte_count = encoded(&light, 10, 0.25f).size();
  CHECK(byte_count < 12);
  for (const Vec3& l : light) CHECK(l == Vec3{0.25f, 0.25f, 0.25f});
}

// Goal: any bytes are either refused or decoded to light that is finite and not negative. Method: random bytes, and
// those of maps with bytes changed, cut off or added.
TEST_CASE("light_map_hostile_bytes_are_refused_or_harmless") {
  Rng rng = make_rng(4);
  int refused = 0;
  for (int i = 0; i < effort(2000); ++i) {
    std::vector<Vec3> light = smooth_map(13, 9, 0.1f, &rng), got(light.size());
    std::vector<std::uint8_t> bytes = encoded(&light, 13);
    if (i % 4 == 0) bytes.resize(next_u32(&rng) % (light_bytes_max(light.size()) + 9));
    if (i % 4 == 1) bytes.resize(bytes.size() - 1 - next_u32(&rng) % 4), bytes.back() |= 1;
    if (i % 4 == 2) bytes.push_back(static_cast<std::uint8_t>(next_u32(&rng)));
    for (std::uint32_t k = 0; k < (i % 4 == 0 ? bytes.size() : i % 4 == 3 ? 3 : 0); ++k)
      bytes[next_u32(&rng) % bytes.size()] = static_cast<std::uint8_t>(next_u32(&rng));
    if (!decoded(bytes, 13, &got)) {
      ++refused;
      continue;
    }
    for (const Vec3& l : got)
      for (int c = 0; c < 3; ++c) REQUIRE((l[c] >= 0 && l[c] <= light_of_level(kLightLevelMax)));
  }
  CHECK(refused > 0);
  std::vector<Vec3> got(4);
  std::vector<std::uint8_t> plain(24, 0);
  CHECK(decoded(plain, 2, &got));
  plain[1] = static_cast<std::uint8_t>((kLightLevelMax + 1) >> 8),
  plain[0] = static_cast<std::uint8_t>(kLightLevelMax + 1);
  CHECK(!decoded(plain, 2, &got));
  CHECK(!decoded(std::vector<std::uint8_t>(25, 1), 2, &got));
  std::vector<std::uint8_t> code = encoded(&got, 2);
  CHECK(decoded(code, 2, &got));
  code.push_back(0);
  CHECK(!decoded(code, 2, &got));
}
