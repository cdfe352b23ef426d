// The elements on triangles by themselves: HARDCASES rows 54 to 57.
#include "indirect/reconstruct/triangle.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/rng.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

using Element = Vec3 (*)(const TriangleLight&, const float (&)[3]);
constexpr Element kElements[] = {quadratic_triangle, cubic_triangle};

struct Corner {
  Vec3 place;
  float value;
  Vec3 gradient;
};

// Light in three channels, of which each is a multiple of the first.
struct Patch {
  Corner corners[3];
  TriangleLight light;
  explicit Patch(const Corner& a, const Corner& b, const Corner& c) : corners{a, b, c} {
    const Vec3 grey = {1, .5f, .25f};
    for (int i = 0; i < 3; ++i) {
      const Corner &at = corners[i], &next = corners[next_corner(i)], &previous = corners[previous_corner(i)];
      light.value[i] = grey * at.value;
      light.to_next[i] = grey * dot(at.gradient, next.place - at.place);
      light.to_previous[i] = grey * dot(at.gradient, previous.place - at.place);
      light.slant[i] = slant_of(next.place, previous.place, at.place);
    }
  }
  Vec3 place(const float (&w)[3]) const {
    return corners[0].place * w[0] + corners[1].place * w[1] + corners[2].place * w[2];
  }
  float at(Element element, const float (&w)[3]) const { return element(light, w).x; }
  // At a point of its plane.
  float at(Element element, const Vec3& p) const {
    const Vec3 normal = cross(corners[1].place - corners[0].place, corners[2].place - corners[0].place);
    float w[3];
    for (int i = 0; i < 3; ++i) {
      const Vec3 &b = corners[next_corner(i)].place, &c = corners[previous_corner(i)].place;
      w[i] = dot(cross(b - p, c - p), normal) / dot(normal, normal);
    }
    return at(element, w);
  }
};

// At a point, from the values at it and up to three steps beyond: exact for cubics.
float slope(const Patch& patch, Element element, const Vec3& p, const Vec3& step) {
  auto at = [&](float steps) { return patch.at(element, p + step * steps); };
  return (18 * at(1) - 9 * at(2) + 2 * at(3) - 11 * at(0)) * (1.f / 6);
}

Vec3 random_place(Rng* rng) { return {next_float(rng), next_float(rng), 0}; }
Vec3 random_gradient(Rng* rng) { return {2 * next_float(rng) - 1, 2 * next_float(rng) - 1, 0}; }
Corner random_corner(Rng* rng, const Vec3& place) { return {place, next_float(rng), random_gradient(rng)}; }

// Weights that add up to 1.
template <class Visit>
void each_place(int steps, const Visit& visit) {
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; i + j <= steps; ++j) {
      const float s = static_cast<float>(steps);
      const float w[3] = {static_cast<float>(i) / s, static_cast<float>(j) / s, static_cast<float>(steps - i - j) / s};
      visit(w);
    }
}

}  // namespace

// Goal: quadratics are reproduced by both elements, in triangles of any shape and position; along edges, cubics by the
// cubic one. Method: exact values and gradients at the corners.
TEST_CASE("hard_54_polynomials_are_reproduced_on_triangles") {
  Rng rng = make_rng(54);
  for (int i = 0; i < 200; ++i) {
    const Vec3 a = random_place(&rng), b = random_place(&rng), c = random_place(&rng);
    if (std::fabs(cross(b - a, c - a).z) < .2f) continue;
    float k[6];
    for (float& x : k) x = 2 * next_float(&rng) - 1;
    auto value = [&](const Vec3& p) {
      return 2 + k[0] * p.x + k[1] * p.y + k[2] * p.x * p.x + k[3] * p.x * p.y + k[4] * p.y * p.y;
    };
    auto corner = [&](const Vec3& p) {
      return Corner{p, value(p), {k[0] + 2 * k[2] * p.x + k[3] * p.y, k[1] + k[3] * p.x + 2 * k[4] * p.y, 0}};
    };
    const Patch patch(corner(a), corner(b), corner(c));
    for (const float slant : patch.light.slant) REQUIRE(std::fabs(slant) < kSlantMax);
    for (Element element : kElements)
      each_place(12,
                 [&](const float(&w)[3]) { CHECK(std::fabs(patch.at(element, w) - value(patch.place(w))) < 4e-6f); });
    auto cubic = [&](const Vec3& p) {
      return Corner{p, p.x * p.x * p.x - p.x * p.y * p.y, {3 * p.x * p.x - p.y * p.y, -2 * p.x * p.y, 0}};
    };
    const Patch bent(cubic(a), cubic(b), cubic(c));
    for (float s = 0; s <= 1; s += .125f) {
      const float w[3] = {1 - s, 0, s};
      CHECK(std::fabs(bent.at(cubic_triangle, w) - cubic(bent.place(w)).value) < 2e-6f);
    }
  }
  count_assertions("4e-6 of values about 2");
}

// Goal: neither element leaves the range of the values and of the planes at the corners, half an edge away; so light
// that is limited accordingly is never negative. Method: values of 0 and 1 and between, the steepest planes, corners
// that lie as far as the ends of the opposite edge.
TEST_CASE("hard_55_triangles_stay_in_the_range_of_the_data") {
  Rng rng = make_rng(55);
  const int count = gate_share(4000, 100000);
  std::uint64_t wrong = 0;
  for (int i = 0; i < count; ++i) {
    TriangleLight t;
    for (int k = 0; k < 3; ++k) {
      const float value = next_u32(&rng) % 3 ? next_float(&rng) : static_cast<float>(next_u32(&rng) % 2);
      auto steep = [&] { return Vec3{1, 1, 1} * (next_u32(&rng) % 2 ? -2 * value : 2 * (1 - value)); };
      t.value[k] = {value, value, value}, t.to_next[k] = steep(), t.to_previous[k] = steep();
      t.slant[k] = static_cast<float>(next_u32(&rng) % 3) * .5f - .5f;
    }
    for (Element element : kElements)
      each_place(12, [&](const float(&w)[3]) {
        const float x = element(t, w).x;
        wrong += !(x >= -2e-6f && x <= 1 + 2e-6f);
      });
  }
  CHECK(wrong == 0);
  count_hard(static_cast<std::uint64_t>(count), wrong, "inside the data");
}

// Goal: no jump in value or slope across an edge whose ends agree, nor across the lines inside a triangle; a jump in
// slope where gradients differ, and in value where values do. Method: pairs of triangles of random shape and light,
// one-sided slopes at points of the lines.
TEST_CASE("hard_56_triangles_meet_smoothly_where_corners_agree") {
  Rng rng = make_rng(56);
  constexpr float kStep = 1.f / 256;
  int pairs = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 places[4] = {random_place(&rng), random_place(&rng), random_place(&rng), random_place(&rng)};
    Corner c[4];
    for (int k = 0; k < 4; ++k) c[k] = random_corner(&rng, places[k]);
    if (cross(places[1] - places[0], places[2] - places[0]).z < .2f ||
        cross(places[3] - places[0], places[1] - places[0]).z < .2f)
      continue;
    const Patch left(c[0], c[1], c[2]), right(c[1], c[0], c[3]);
    float slant_max = 0;
    for (const Patch* p : {&left, &right})
      for (float s : p->light.slant) slant_max = std::max(slant_max, std::fabs(s));
    if (slant_max >= kSlantMax) continue;
    ++pairs;
    Corner kinked[2] = {c[0], c[1]}, off[2] = {c[0], c[1]};
    for (Corner& k : kinked) k.gradient = k.gradient + Vec3{1, 1, 0};
    for (Corner& k : off) k.value += .25f;
    const Patch other_slope(kinked[1], kinked[0], c[3]), other_value(off[1], off[0], c[3]);
    const Vec3 along = normalize(places[1] - places[0]), step = Vec3{-along.y, along.x, 0} * kStep;
    const float kink = std::fabs(dot(Vec3{1, 1, 0}, step));
    for (Element element : kElements)
      for (float s = .2f; s < .9f; s += .15f) {
        const Vec3 p = places[0] * (1 - s) + places[1] * s;
        const float slope_left = slope(left, element, p, step), slope_right = -slope(right, element, p, -step);
        CHECK(std::fabs(left.at(element, p) - right.at(element, p)) < 1e-5f);
        CHECK(std::fabs(slope_left - slope_right) < .02f * kStep);
        CHECK(std::fabs(left.at(element, p) - other_value.at(element, p)) > .2f);
        if (kink > .25f * kStep) CHECK(std::fabs(slope_left + slope(other_slope, element, p, -step)) > .5f * kink);
      }
    // The medians, which hold the lines from the centre to the corners, and those between the middles of edges.
    const float ends[6][2][3] = {{{1, 0, 0}, {0, .5f, .5f}},     {{0, 1, 0}, {.5f, 0, .5f}},
                                 {{0, 0, 1}, {.5f, .5f, 0}},     {{.5f, .5f, 0}, {.5f, 0, .5f}},
                                 {{.5f, .5f, 0}, {0, .5f, .5f}}, {{.5f, 0, .5f}, {0, .5f, .5f}}};
    for (Element element : kElements)
      for (int line = 0; line < 6; ++line)
        for (float s : {.2f, .3f, .8f}) {  // away from where they cross
          const Vec3 a = left.place(ends[line][0]), b = left.place(ends[line][1]), p = a * (1 - s) + b * s;
          const Vec3 way = normalize(b - a), across = Vec3{-way.y, way.x, 0} * kStep;
          CHECK(std::fabs(slope(left, element, p, across) + slope(left, element, p, -across)) < .02f * kStep);
        }
  }
  CHECK(pairs > 10);
  count_assertions("2 % of slopes about 1");
}

// Goal: slivers, points and huge ratios give finite light within the range of moderate data, and which corner comes
// first does not matter.
TEST_CASE("hard_57_slivers_are_finite") {
  const Vec3 places[][3] = {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}},         {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}},
                            {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}},         {{0, 0, 0}, {1e6f, 0, 0}, {0, 1, 0}},
                            {{0, 0, 0}, {1e-6f, 0, 0}, {1, 1e-6f, 0}}, {{0, 0, 0}, {1e-30f, 0, 0}, {1e18f, 1e18f, 0}}};
  for (const auto& p : places) {
    Patch patch({p[0], 0, {0, 0, 0}}, {p[1], 1, {0, 0, 0}}, {p[2], 0, {0, 0, 0}});
    for (Element element : kElements)
      each_place(8, [&](const float(&w)[3]) {
        const float x = patch.at(element, w);
        CHECK((x > -1 && x < 2));  // NaN fails, too
      });
    for (float slant : patch.light.slant) CHECK(std::fabs(slant) <= kSlantMax);
  }
  Rng rng = make_rng(57);
  for (int i = 0; i < 50; ++i) {
    const Corner a = random_corner(&rng, random_place(&rng)), b = random_corner(&rng, random_place(&rng)),
                 c = random_corner(&rng, random_place(&rng));
    const Patch patch(a, b, c), turned(b, c, a), mirrored(b, a, c);
    for (Element element : kElements)
      each_place(7, [&](const float(&w)[3]) {
        CHECK(std::fabs(turned.at(element, {w[1], w[2], w[0]}) - patch.at(element, w)) < 1e-5f);
        CHECK(std::fabs(mirrored.at(element, {w[1], w[0], w[2]}) - patch.at(element, w)) < 1e-5f);
      });
  }
  count_assertions("1e-5");
}
