// Reflectance by an ordinary approximation beside ours: HARDCASES row 33.
#include <doctest/doctest.h>

#include <cmath>

#include "shade/dielectric.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

struct Incidence {
  float cosine, eta;  // eta: refractive index outside over that inside
};

// Unpolarised reflectance by the Fresnel equations, in double.
double exact_reflectance(const Incidence& i) {
  const double cosine = static_cast<double>(i.cosine), eta = static_cast<double>(i.eta);
  const double inner = std::sqrt(1 - eta * eta * (1 - cosine * cosine));
  const double s = (eta * cosine - inner) / (eta * cosine + inner), p = (cosine - eta * inner) / (cosine + eta * inner);
  return (s * s + p * p) / 2;
}

}  // namespace

// Goal: reflectance at any angle to 1e-5. Method: glass, water and diamond from outside; Schlick's approximation, which
// most renderers use.
TEST_CASE("hard_33_reflectance_by_an_ordinary_approximation") {
  Rng rng = make_rng(133);
  std::vector<Incidence> list;
  for (int i = 0; i < gate_share(10000, 1000000); ++i) {
    const float iors[] = {1.33f, 1.5f, 2.42f};
    list.push_back({next_float(&rng), 1 / iors[i % 3]});
  }
  auto by_ours = [](const Incidence& i) {
    float inner;
    return static_cast<double>(fresnel(i.cosine, i.eta, &inner));
  };
  auto by_schlick = [](const Incidence& i) {
    const float normal = (1 - i.eta) / (1 + i.eta), f0 = normal * normal, rest = 1 - i.cosine;
    return static_cast<double>(f0 + (1 - f0) * rest * rest * rest * rest * rest);
  };
  auto is_wrong = [](const Incidence& i, double r) { return !(std::fabs(r - exact_reflectance(i)) <= 1e-5); };
  const Answers ours = time_answers(list, by_ours, is_wrong), schlick = time_answers(list, by_schlick, is_wrong);
  CHECK(ours.wrong == 0);
  CHECK(schlick.wrong > 0);
  count_beside("Schlick's approximation", "reflectance", list.size(), schlick, ours);
  count_hard(list.size(), ours.wrong, "within 1e-5");
}
