// Lobes as linearly transformed powers of a cosine, against the lobes' own values.
#include "brdf/linear_lobe.h"

#include <doctest/doctest.h>

#include <string>

#include "base/rng.h"
#include "brdf/linear_lobe_fit.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

const LobeFrameD kExactFrame = {{0, 0, 1}, {0, 0, 0}};

Vec3d viewer_at(double cosine) { return {-std::sqrt(1 - cosine * cosine), 0, cosine}; }

LobePartsD parts_of(const Material& m, const Vec3d& to_viewer, double diffuse = 0) {
  LobePartsD parts;
  REQUIRE(kBrdfList[m.brdf]->linear->divide_exactly(m, to_double(m.specular), {diffuse, diffuse, diffuse}, kExactFrame,
                                                    to_viewer, &parts));
  return parts;
}

}  // namespace

// Goal: the form in the tables puts little of a lobe's light in the wrong place, between their entries and at their
// ends, too; that bounds the error of any lamp. Method: half of ∫ |p − D| over samples of the lobe, over roughness and
// angle.
TEST_CASE("linear_lobe_misplaces_little_light") {
  for (std::uint32_t brdf : {kGgx, kPhong}) {
    const std::string name = kBrdfList[brdf]->name;
    CAPTURE(name);
    double worst[3] = {}, sum[3] = {};  // from 60°, 75°, up to 88° off the normal
    int count[3] = {};
    Rng rng = make_rng(brdf + 11);
    for (int i = 0; i < effort(600); ++i) {
      const double root = 0.1 + 0.9 * next_double(&rng), alpha = root * root,
                   cosine = 0.035 + 0.965 * next_double(&rng);
      if (brdf == kPhong && alpha >= kPhongLinearAlphaMax) continue;
      const Material m = white_lobe(brdf, alpha);
      const Vec3d viewer = viewer_at(cosine);
      const double off =
          misplaced_light(sample_lobe(m, viewer, 48), parts_of(m, viewer), kBrdfList[brdf]->linear->power);
      const int place = cosine > 0.5 ? 0 : cosine > 0.26 ? 1 : 2;
      worst[place] = std::max(worst[place], off), sum[place] += off, ++count[place];
    }
    for (int i = 0; i < 3; ++i)
      MESSAGE(name, ": at most ", worst[i], ", in the mean ", sum[i] / std::max(count[i], 1), " of ", count[i]);
    CHECK(worst[0] < (brdf == kGgx ? 0.065 : 0.045));
    CHECK(worst[1] < (brdf == kGgx ? 0.13 : 0.045));
    CHECK(worst[2] < (brdf == kGgx ? 0.25 : 0.055));
  }
}

// Goal: a lamp that fills the hemisphere gives the lobe's albedo. Method: the form's, less what is below the horizon,
// against the sum over samples of the lobe.
TEST_CASE("linear_lobe_reflects_the_albedo") {
  for (std::uint32_t brdf : {kGgx, kPhong}) {
    double worst = 0;
    for (double alpha : {0.0012, 0.01, 0.05, 0.2, 0.5, 0.9})
      for (double cosine : {1.0, 0.8, 0.5, 0.2, 0.05}) {
        if (brdf == kPhong && alpha >= kPhongLinearAlphaMax) continue;
        const Material m = white_lobe(brdf, alpha);
        const LobePartsD parts = parts_of(m, viewer_at(cosine));
        const double above = share_above_horizon(parts, kBrdfList[brdf]->linear->power);
        worst = std::max(worst, std::fabs(parts.albedo.x * above - sample_lobe(m, viewer_at(cosine), 96).albedo));
      }
    CAPTURE(kBrdfList[brdf]->name);
    CAPTURE(worst);
    CHECK(worst < (brdf == kGgx ? 0.035 : 0.004));
  }
}

// Goal: the two parts are the whole lobe. Method: the value less the rest is the sharp part in closed form, D·V·F as in
// ggx.cpp, for random directions, viewers below the horizon included; of Phong's lobe, the rest is the diffuse one.
TEST_CASE("linear_lobe_leaves_the_rest") {
  Rng rng = make_rng(8);
  double worst = 0;
  for (int i = 0; i < effort(20000); ++i) {
    Material m = white_lobe(kGgx, 0.05 + 0.95 * next_double(&rng));
    const double alpha = static_cast<double>(m.roughness), square = alpha * alpha, v = 0.02 + 0.98 * next_double(&rng);
    const double c = 0.02 + 0.98 * next_double(&rng), s = std::sqrt(1 - c * c), turn = 7 * next_double(&rng);
    const Vec3d light = {s * std::cos(turn), s * std::sin(turn), c}, viewer = viewer_at(v);
    const Vec3d below = {viewer.x, viewer.y, -viewer.z}, half = normalize(viewer + light);
    const double slope = half.z * half.z * (square - 1) + 1;
    const double sharp = square / (kPi * slope * slope) * 0.5 /
                         (c * std::sqrt(v * v * (1 - square) + square) + v * std::sqrt(c * c * (1 - square) + square));
    for (const Vec3d& from : {viewer, below}) {
      const double all = kGgxBrdf.exact_value(m, {1, 1, 1}, {0.2, 0.2, 0.2}, kExactFrame, from, light).x;
      const double rest = kGgxBrdf.linear->exact_rest(parts_of(m, from, 0.2), c).x;
      worst = std::max(worst, std::fabs(all - rest - sharp) / sharp);
    }
  }
  CHECK(worst < 1e-9);
  CHECK(!kPhongBrdf.linear->rest);
  CHECK(parts_of(white_lobe(kPhong, 0.2), viewer_at(0.5), 0.3).diffuse == Vec3d{0.3, 0.3, 0.3});
}

// Goal: light in closed form stays below the bounds that the cut-off assumes. Method: D times the albedo, against the
// lobe's peak, in directions about that of the viewer's reflection.
TEST_CASE("linear_lobe_has_a_bounded_peak") {
  for (std::uint32_t brdf : {kGgx, kPhong})
    for (double alpha : {0.0012, 0.01, 0.03, 0.1, 0.25, 0.4, 0.56, 0.8, 1.0})
      for (double cosine : {1.0, 0.95, 0.8, 0.6, 0.4, 0.2, 0.1, 0.05, 0.02, 0.001}) {
        if (brdf == kPhong && alpha >= kPhongLinearAlphaMax) continue;
        const Material m = white_lobe(brdf, alpha);
        const LobePartsD parts = parts_of(m, viewer_at(cosine));
        double peak = 0;
        for (int i = 1; i < 4000; ++i) {  // in the viewer's plane, where the peak is
          const double angle = kPi * i / 4000;
          peak = std::max(peak,
                          linear_density(parts, kBrdfList[brdf]->linear->power, {std::cos(angle), 0, std::sin(angle)}));
        }
        CAPTURE(brdf);
        CAPTURE(alpha);
        CAPTURE(cosine);
        CHECK(peak * parts.albedo.x <= kLinearPeakMax * static_cast<double>(kBrdfList[brdf]->peak(m).x));
      }
}

// Goal: the tables are what their program writes. Method: some entries of each, fitted again.
TEST_CASE("linear_lobe_tables_are_fitted_to_the_lobes") {
  auto check = [](std::uint32_t brdf, double step, int i, int j, const std::uint16_t(&entry)[4]) {
    const double row = root_at(i, step), column = root_at(j, 0.06);
    const LinearFit fit = fit_linear_lobe(brdf, row * row, column * column, kLinearFitSide);
    CAPTURE(brdf);
    CAPTURE(i);
    CAPTURE(j);
    for (int k = 0; k < 4; ++k) CHECK(static_cast<int>(fit.parameters[k] / kLinearUnit + 0.5) == entry[k]);
  };
  for (int i = 0; i < effort(4); ++i) {
    check(kGgx, kGgxLinearStep, 3 * i, 4 + 3 * i, kGgxLinear[3 * i][4 + 3 * i]);
    check(kPhong, kPhongLinearStep, 2 * i, 13 - 3 * i, kPhongLinear[2 * i][13 - 3 * i]);
  }
}

// Goal: what has no form comes from points, and floats give what doubles do. Method: each case.
TEST_CASE("linear_lobe_of_other_lobes") {
  CHECK(!kWardBrdf.linear);
  CHECK(!kGrainedWardBrdf.linear);
  CHECK(!kGrainedGgxBrdf.linear);
  const LobeFrame frame = {{0, 0, 1}, {0, 0, 0}};
  LobeParts parts;
  Material m = white_lobe(kPhong, 0.2);
  auto divides = [&](const Vec3& viewer) {
    return kBrdfList[m.brdf]->linear->divide(m, m.specular, {0, 0, 0}, frame, viewer, &parts);
  };
  CHECK(divides({0.6f, 0, 0.8f}));
  CHECK(!divides({0.8f, 0, -0.6f}));
  m.exponent = 4;
  CHECK(!divides({0.6f, 0, 0.8f}));
  for (std::uint32_t brdf : {kGgx, kPhong})
    for (double alpha : {0.001, 0.02, 0.3})
      for (double cosine : {1.0, 0.999, 0.7, 0.1, 1e-3}) {
        m = white_lobe(brdf, alpha);
        const Vec3d viewer = viewer_at(cosine);
        const LobePartsD exact = parts_of(m, viewer);
        REQUIRE(divides(to_float(viewer)));
        CAPTURE(brdf);
        CAPTURE(alpha);
        CAPTURE(cosine);
        CHECK(length(to_double(parts.x) - exact.x) <= 1e-4 * length(exact.x));
        CHECK(length(to_double(parts.y) - exact.y) <= 1e-4 * length(exact.y));
        CHECK(length(to_double(parts.z) - exact.z) <= 1e-4);
        CHECK(static_cast<double>(parts.albedo.x) == doctest::Approx(exact.albedo.x).epsilon(1e-3));
      }
}
