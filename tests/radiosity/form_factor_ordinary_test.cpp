// Form factors by ordinary formulas beside ours: HARDCASES rows 44 and 45.
#include <doctest/doctest.h>

#include <cmath>

#include "base/rng.h"
#include "desktop/radiosity/form_factor.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

constexpr double kPi = 3.14159265358979323846;

double relative_error(double found, double known) { return std::fabs(found / known - 1); }

// Parallel unit squares at a distance in floats, as tables of form factors have it [Howell, C-11].
double parallel_squares(float distance) {
  const float x = 1 / distance, root = std::sqrt(1 + x * x);
  const float sum = std::log(std::sqrt((1 + x * x) * (1 + x * x) / (1 + 2 * x * x))) +
                    2 * x * root * std::atan(x / root) - 2 * x * std::atan(x);
  return static_cast<double>(2 / (3.14159265f * x * x) * sum);
}

struct Disks {
  double from, to, distance;
};

}  // namespace

// Goal: distant squares keep their digits. Method: against 1/(π d²) with its next term, which is exact to 1e-3 there.
TEST_CASE("hard_44_distant_squares_by_an_ordinary_formula") {
  Rng rng = make_rng(144);
  std::vector<float> distances;
  for (int i = 0; i < gate_share(200, 5000); ++i) distances.push_back(10 + 90 * next_float(&rng));
  auto by_ours = [](float d) {
    const double z = static_cast<double>(d);
    return polygon_form_factor({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                               {{0, 1, z}, {1, 1, z}, {1, 0, z}, {0, 0, z}});
  };
  auto is_wrong = [](float d, double factor) {
    const double z = static_cast<double>(d);
    return !(relative_error(factor, (1 - 2 / (3 * z * z)) / (kPi * z * z)) < 1e-3);
  };
  const Answers ours = time_answers(distances, by_ours, is_wrong),
                table = time_answers(distances, parallel_squares, is_wrong);
  CHECK(ours.wrong == 0);
  CHECK(table.wrong > 0);
  count_beside("table's formula in float", "pair of squares", distances.size(), table, ours);
  count_hard(distances.size(), ours.wrong, "1e-3 relative");
}

// Goal: coaxial disks keep their digits at every distance. Method: the formula without cancellation in long double.
TEST_CASE("hard_45_coaxial_disks_by_an_ordinary_formula") {
  Rng rng = make_rng(145);
  std::vector<Disks> list;
  for (int i = 0; i < gate_share(10000, 500000); ++i)
    list.push_back({1, std::exp2(4.0 * static_cast<double>(next_float(&rng)) - 2),
                    std::pow(10.0, 6.0 * static_cast<double>(next_float(&rng)))});
  auto by_ours = [](const Disks& d) { return coaxial_disk_form_factor(d.from, d.to, d.distance); };
  auto by_textbook = [](const Disks& d) {
    const double h = d.distance / d.from, ratio = d.to / d.from, sum = 1 + h * h + ratio * ratio;
    return (sum - std::sqrt(sum * sum - 4 * ratio * ratio)) / 2;
  };
  auto is_wrong = [](const Disks& d, double factor) {
    const long double h = d.distance, ratio = d.to, sum = 1 + h * h + ratio * ratio;
    const long double known = 2 * ratio * ratio / (sum + std::sqrt(sum * sum - 4 * ratio * ratio));
    return !(relative_error(factor, static_cast<double>(known)) < 1e-6);
  };
  const Answers ours = time_answers(list, by_ours, is_wrong), textbook = time_answers(list, by_textbook, is_wrong);
  CHECK(ours.wrong == 0);
  CHECK(textbook.wrong > 0);
  count_beside("(S − √(S² − 4ρ²)) / 2", "pair of disks", list.size(), textbook, ours);
  count_hard(list.size(), ours.wrong, "1e-6 relative");
}
