#include "base/simd.h"

#include <doctest/doctest.h>

#include <cstring>
#include <limits>

using namespace pocketray;

// Goal: each lane of each operation is the scalar operation, bit for bit, with NaN, infinities, denormals and both
// zeros. Method: all pairs of awkward values, in every lane; min and max give the second operand where < and > are
// false.
TEST_CASE("simd_lanes_are_the_scalar_operations") {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const float values[] = {0.0f, -0.0f, 1.0f, -1.5f, 1e-45f, -1e-40f, 3e38f, -3e38f, 1.0f / 3, 1e-20f, inf, -inf, nan};
  auto same = [](float a, float b) { return (a != a && b != b) || std::memcmp(&a, &b, sizeof a) == 0; };
  for (float x : values)
    for (float y : values)
      for (unsigned lane = 0; lane < 4; ++lane) {
        alignas(16) float a[4] = {1, 2, 3, 4}, b[4] = {2, 2, 2, 2}, sum[4], difference[4], product[4], least[4],
                          most[4];
        a[lane] = x, b[lane] = y;
        store(sum, Float4::load(a) + Float4::load(b)), store(difference, Float4::load(a) - Float4::load(b)),
            store(product, Float4::load(a) * Float4::load(b));
        store(least, min(Float4::load(a), Float4::load(b))), store(most, max(Float4::load(a), Float4::load(b)));
        unsigned mask = bits(Float4::load(a) <= Float4::load(b)), expected = 0;
        for (unsigned i = 0; i < 4; ++i) {
          CHECK(same(sum[i], a[i] + b[i]));
          CHECK(same(difference[i], a[i] - b[i]));
          CHECK(same(product[i], a[i] * b[i]));
          CHECK(same(least[i], a[i] < b[i] ? a[i] : b[i]));
          CHECK(same(most[i], a[i] > b[i] ? a[i] : b[i]));
          expected |= static_cast<unsigned>(a[i] <= b[i]) << i;
        }
        CHECK(mask == expected);
        store(sum, Float4::splat(x));
        CHECK(same(sum[lane], x));
      }
}
