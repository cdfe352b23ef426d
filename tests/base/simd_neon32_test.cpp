#include "base/isa.h"

#if defined(POCKETRAY_HAVE_NEON32)
#undef POCKETRAY_ISA
#define POCKETRAY_ISA neon
#define POCKETRAY_NEON32
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "base/rng.h"
#include "base/simd.h"

using namespace pocketray;

namespace {

constexpr float kMin = std::numeric_limits<float>::min();

bool same(float a, float b) { return std::memcmp(&a, &b, sizeof a) == 0; }
float random_float(Rng* rng) {
  float x = std::ldexp(next_float(rng) + 1, static_cast<int>(next_u32(rng) % 60) - 30);
  return next_u32(rng) % 2 ? -x : x;
}

}  // namespace

TEST_CASE("neon32_rounds_like_the_vfp") {
  Rng rng = make_rng(1);
  int wrong = 0;
  for (int n = 0; n < 20000; ++n) {
    alignas(16) float a[4], b[4], r[4];
    for (int i = 0; i < 4; ++i) a[i] = random_float(&rng), b[i] = next_u32(&rng) % 4 ? random_float(&rng) : a[i];
    Float4 x = Float4::load(a), y = Float4::load(b);
    auto count = [&](Float4 result, auto expected) {
      store(r, result);
      for (int i = 0; i < 4; ++i) wrong += !same(r[i], expected(a[i], b[i]));
    };
    count(x + y, [](float p, float q) { return p + q; });
    count(x - y, [](float p, float q) { return p - q; });
    count(x * y, [](float p, float q) { return p * q; });
    count(x / y, [](float p, float q) { return p / q; });
    count(min(x, y), [](float p, float q) { return p < q ? p : q; });
    count(max(x, y), [](float p, float q) { return p > q ? p : q; });
    count(abs(x), [](float p, float) { return std::fabs(p); });
    count(copy_sign(x, y), [](float p, float q) { return std::copysign(p, q); });
    count(select(x < y, x, y), [](float p, float q) { return p < q ? p : q; });
    count(narrow(widen(x)), [](float p, float) { return p; });
    unsigned less = 0, up_to = 0, equal = 0, negative = 0;
    for (unsigned i = 0; i < 4; ++i) {
      less |= unsigned(a[i] < b[i]) << i, up_to |= unsigned(a[i] <= b[i]) << i, equal |= unsigned(a[i] == b[i]) << i;
      negative |= unsigned(a[i] < 0) << i;
    }
    wrong += bits(x < y) != less || bits(x <= y) != up_to || bits(x == y) != equal || signs(x) != negative;
    wrong += lowest(x) != std::fmin(std::fmin(a[0], a[1]), std::fmin(a[2], a[3]));
    wrong += highest(x) != std::fmax(std::fmax(a[0], a[1]), std::fmax(a[2], a[3]));
    wrong += first(lane<0>(x)) != a[0] || first(lane<1>(x)) != a[1] || first(lane<2>(x)) != a[2] ||
             first(lane<3>(x)) != a[3];
    store(r, reciprocal(x));
    for (int i = 0; i < 4; ++i) wrong += std::fabs(static_cast<double>(r[i]) * a[i] - 1) > 3 * 0x1p-24;
  }
  CHECK(wrong == 0);
}

TEST_CASE("neon32_finds_lanes_and_words") {
  for (unsigned set = 0; set < 16; ++set) {
    CHECK(bits(Float4::mask_of(set)) == set);
    if (set == 15 || (~set & 15 & ((~set & 15) - 1))) continue;
    alignas(16) const std::uint32_t words[4] = {5, 0x80000001u, 7, 0xFFFFFFFFu};
    CHECK(word_outside(Float4::mask_of(set), words) == words[__builtin_ctz(~set)]);
  }
  const float points[4][3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}};
  const float* const rows[4] = {points[0], points[1], points[2], points[3]};
  Float4 r[3];
  load_points(rows, r);
  alignas(16) float lanes[4];
  for (int axis = 0; axis < 3; ++axis) {
    store(lanes, r[axis]);
    for (int i = 0; i < 4; ++i) CHECK(lanes[i] == points[i][axis]);
  }
}

// If this fails, the unit does not flush, and accel/denormals.h guards against nothing.
TEST_CASE("neon32_flushes_denormals") {
  volatile float denormal = kMin / 2;
  CHECK(first(Float4::splat(denormal) + Float4::splat(0)) == 0);
  CHECK(first(Float4::splat(kMin) * Float4::splat(0.5f)) == 0);
  CHECK(first(Float4::splat(denormal) / Float4::splat(2)) == kMin / 4);  // the VFP divides
  CHECK(kFlushesDenormals);
}
#endif
