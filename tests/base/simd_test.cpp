#include "base/simd.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>
#include <memory>

using namespace pocketray;

namespace {

// A vector type as an array, as it lies in memory.
template <class Vector, class T, int kLanes>
struct Kind {
  using Lane = T;
  static constexpr int kCount = kLanes;
  static_assert(sizeof(Vector) == kLanes * sizeof(T), "lanes side by side and nothing else");
  static Vector pack(const T* lanes) {
    Vector v;
    std::memcpy(&v, lanes, sizeof v);
    return v;
  }
  static void unpack(const Vector& v, T* lanes) { std::memcpy(lanes, &v, sizeof v); }
};

template <class T>
bool same(T a, T b) {
  return (a != a && b != b) || std::memcmp(&a, &b, sizeof a) == 0;
}

template <class T>
constexpr T kAwkward[] = {T(0),
                          T(-0.0),
                          T(1),
                          T(-1.5),
                          std::numeric_limits<T>::denorm_min(),
                          -std::numeric_limits<T>::min() / 3,
                          std::numeric_limits<T>::max(),
                          std::numeric_limits<T>::lowest(),
                          T(1) / 3,
                          T(1e-20),
                          std::numeric_limits<T>::infinity(),
                          -std::numeric_limits<T>::infinity(),
                          std::numeric_limits<T>::quiet_NaN()};

// Calls check(a, b) with arrays that hold every pair of awkward values in every lane.
template <class T, int kLanes, class Check>
void for_each_pair(Check check) {
  for (T x : kAwkward<T>)
    for (T y : kAwkward<T>)
      for (int lane = 0; lane < kLanes; ++lane) {
        T a[kLanes], b[kLanes];
        for (int i = 0; i < kLanes; ++i) a[i] = static_cast<T>(i + 1), b[i] = 2;
        a[lane] = x, b[lane] = y;
        check(a, b);
      }
}

template <class K, class Vector, class Expected>
int wrong_lanes(const Vector& v, Expected expected) {
  typename K::Lane lanes[K::kCount];
  K::unpack(v, lanes);
  int wrong = 0;
  for (int i = 0; i < K::kCount; ++i) wrong += !same(lanes[i], expected(i));
  return wrong;
}
template <class Mask, class Expected>
bool wrong_bits(const Mask& mask, int count, Expected expected) {
  unsigned wanted = 0;
  for (int i = 0; i < count; ++i) wanted |= static_cast<unsigned>(expected(i)) << i;
  return bits(mask) != wanted;
}

template <class Vector, class T, int kLanes>
int wrong_operations() {
  using K = Kind<Vector, T, kLanes>;
  int wrong = 0;
  for_each_pair<T, kLanes>([&](const T* a, const T* b) {
    Vector x = K::pack(a), y = K::pack(b), two = Vector::splat(2);
    wrong += wrong_lanes<K>(x + y, [=](int i) { return a[i] + b[i]; });
    wrong += wrong_lanes<K>(x - y, [=](int i) { return a[i] - b[i]; });
    wrong += wrong_lanes<K>(x * y, [=](int i) { return a[i] * b[i]; });
    wrong += wrong_lanes<K>(x / y, [=](int i) { return a[i] / b[i]; });
    T low[kLanes], high[kLanes];
    K::unpack(min(x, y), low), K::unpack(max(x, y), high);
    for (int i = 0; i < kLanes; ++i)
      if (a[i] == a[i] && b[i] == b[i])
        wrong += low[i] != (a[i] < b[i] ? a[i] : b[i]) || high[i] != (a[i] > b[i] ? a[i] : b[i]);
    wrong += wrong_lanes<K>(select(x <= y, x, y), [=](int i) { return a[i] <= b[i] ? a[i] : b[i]; });
    wrong += wrong_lanes<K>(Vector::splat(a[0]), [=](int) { return a[0]; });
    wrong += wrong_bits(x <= y, kLanes, [=](int i) { return a[i] <= b[i]; });
    wrong += wrong_bits(x < y, kLanes, [=](int i) { return a[i] < b[i]; });
    wrong += wrong_bits((x <= y) & (two <= x), kLanes, [=](int i) { return a[i] <= b[i] && 2 <= a[i]; });
    wrong += wrong_bits((x < y) | (two < x), kLanes, [=](int i) { return a[i] < b[i] || 2 < a[i]; });
  });
  return wrong;
}

}  // namespace

// Goal: each lane of each operation is the scalar operation, bit for bit, with NaN, infinities, denormals and both
// zeros; min and max without NaN, and any zero will do. Method: all pairs of awkward values, in every lane.
TEST_CASE("simd_lanes_are_the_scalar_operations") {
  CHECK(wrong_operations<Float4, float, 4>() == 0);
  CHECK(wrong_operations<Double4, double, 4>() == 0);
}

// Goal: operations that only floats have: load and store, ==, abs, smallest and largest lane, masks from bits. Method:
// as above; lowest and highest without NaN, which would expose the order of comparisons.
TEST_CASE("simd_floats_load_compare_and_reduce_by_lane") {
  using K = Kind<Float4, float, 4>;
  int wrong = 0;
  for_each_pair<float, 4>([&](const float* a, const float* b) {
    alignas(16) float aligned[4], stored[4];
    std::memcpy(aligned, a, sizeof aligned);
    Float4 x = Float4::load(aligned), y = K::pack(b);
    store(stored, x);
    for (int i = 0; i < 4; ++i) wrong += !same(stored[i], a[i]);
    wrong += wrong_bits(x == y, 4, [=](int i) { return a[i] == b[i]; });
    wrong += wrong_lanes<K>(abs(x), [=](int i) { return a[i] != a[i] ? a[i] : std::signbit(a[i]) ? -a[i] : a[i]; });
    wrong += wrong_lanes<K>(copy_sign(x, y), [=](int i) { return std::copysign(a[i], b[i]); });
    wrong += wrong_lanes<K>(Float4::load3(a), [=](int i) { return i < 3 ? a[i] : 0.0f; });
    wrong +=
        wrong_lanes<K>(lane<0>(x), [=](int) { return a[0]; }) + wrong_lanes<K>(lane<1>(x), [=](int) { return a[1]; });
    wrong +=
        wrong_lanes<K>(lane<2>(x), [=](int) { return a[2]; }) + wrong_lanes<K>(lane<3>(x), [=](int) { return a[3]; });
    wrong += !same(first(x), a[0]);
    wrong += wrong_lanes<K>(product_less(x, x, y), [=](int i) {
      float once = std::fma(a[i], a[i], -b[i]), twice = a[i] * a[i] - b[i];
      float lanes[4];
      K::unpack(product_less(x, x, y), lanes);
      return same(lanes[i], once) ? once : twice;
    });
    for (int i = 0; i < 4; ++i) wrong += (signs(x) >> i & 1) != std::signbit(a[i]);
    float least = a[0], most = a[0];
    bool ordered = a[0] == a[0];
    for (int i = 1; i < 4; ++i) {
      ordered &= a[i] == a[i];
      least = a[i] < least ? a[i] : least, most = a[i] > most ? a[i] : most;
    }
    if (ordered) wrong += lowest(x) != least, wrong += highest(x) != most;
  });
  CHECK(wrong == 0);
  for (unsigned mask = 0; mask < 16; ++mask) CHECK(bits(Float4::mask_of(mask)) == mask);
}

// Goal: the coordinates of four points, by axis, without reading anything else. Method: distinct numbers in arrays of
// exactly their size, so that a sanitizer sees an overrun.
TEST_CASE("simd_points_are_loaded_by_axis") {
  std::unique_ptr<float[]> point[4];
  const float* pointers[4];
  for (int i = 0; i < 4; ++i) {
    point[i].reset(new float[3]{static_cast<float>(i), static_cast<float>(10 + i), static_cast<float>(20 + i)});
    pointers[i] = point[i].get();
  }
  Float4 rows[3];
  load_points(pointers, rows);
  for (int axis = 0; axis < 3; ++axis)
    CHECK(wrong_lanes<Kind<Float4, float, 4>>(rows[axis], [=](int i) { return static_cast<float>(10 * axis + i); }) ==
          0);
}

// Goal: later, sooner and is_later are max, min and > of distances: exact unless the result is negative, which may then
// be either negative operand. word_outside is the one word that the mask leaves. Method: all pairs of awkward values
// but −0 and NaN, in every lane; every mask of three lanes.
TEST_CASE("simd_distances_are_ordered_and_the_word_outside_a_mask_is_found") {
  int wrong = 0;
  for_each_pair<float, 4>([&](const float* a, const float* b) {
    for (int i = 0; i < 4; ++i)
      for (float x : {a[i], b[i]})
        if (x != x || (x == 0 && std::signbit(x))) return;
    Float4 x = Kind<Float4, float, 4>::pack(a), y = Kind<Float4, float, 4>::pack(b);
    float late[4], soon[4];
    Kind<Float4, float, 4>::unpack(later(x, y), late), Kind<Float4, float, 4>::unpack(sooner(x, y), soon);
    unsigned is_late = bits(is_later(x, y));
    for (int i = 0; i < 4; ++i) {
      float most = a[i] > b[i] ? a[i] : b[i], least = a[i] > b[i] ? b[i] : a[i];
      wrong += most < 0 ? late[i] != a[i] && late[i] != b[i] : late[i] != most;
      wrong += least < 0 ? !(soon[i] < 0 && (soon[i] == a[i] || soon[i] == b[i])) : soon[i] != least;
      if (most >= 0) wrong += (is_late >> i & 1) != (a[i] > b[i]);
    }
  });
  CHECK(wrong == 0);
  alignas(16) const std::uint32_t words[4] = {0x80000001u, 2, 0xFFFFFFFFu, 0};
  for (unsigned i = 0; i < 4; ++i) CHECK(word_outside(Float4::mask_of(15 ^ 1u << i), words) == words[i]);
}

// Goal: floats widen exactly, and doubles round to the nearest float. Method: awkward values and values half-way
// between two floats, in every lane.
TEST_CASE("simd_widens_and_narrows_as_the_language_does") {
  int wrong = 0;
  for_each_pair<float, 4>([&](const float* a, const float*) {
    wrong += wrong_lanes<Kind<Double4, double, 4>>(widen(Kind<Float4, float, 4>::pack(a)),
                                                   [=](int i) { return double(a[i]); });
  });
  for_each_pair<double, 4>([&](const double* a, const double* b) {
    double c[4];
    for (int i = 0; i < 4; ++i) c[i] = a[i] * (1 + b[i] * 0x1p-24);
    wrong += wrong_lanes<Kind<Float4, float, 4>>(narrow(Kind<Double4, double, 4>::pack(c)),
                                                 [&](int i) { return static_cast<float>(c[i]); });
  });
  CHECK(wrong == 0);
}
