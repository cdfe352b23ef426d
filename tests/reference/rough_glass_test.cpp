// The reference's rough glass and thin films.
#include "brdf/rough_refraction.h"

#include "desktop/reference/optics.h"
#include "reference/reference_helpers.h"
#include "scene/metallic_roughness.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

Material frosted(float roughness, bool thin) {
  Material m;
  m.brdf = kGgx, m.ior = 1.5f, m.thin = thin;
  set_lobes({{1, 1, 1}, {0.04f, 0.04f, 0.04f}, 1}, 0, roughness, 1, &m);
  return m;
}

double ggx(double cosine, double alpha) {
  const double square = alpha * alpha, d = cosine * cosine * (square - 1) + 1;
  return square / (kPi * d * d);
}

}  // namespace

// Goal: light through sampled facets is distributed as the rough boundary's value. Method: means of the new direction's
// z and x², against the integral of [Walter et al. 2007, eq. 21] over directions, from outside and inside.
TEST_CASE("reference_rough_glass_samples_walters_lobe") {
  const Vec3d n = {0, 0, 1};
  for (double alpha : {0.1, 0.4})
    for (double eta : {1 / 1.5, 1.5})
      for (double tilt : {0.1, 0.5}) {
        Material m = frosted(0.5f, false);
        m.roughness = static_cast<float>(alpha);
        const double width = facet_alpha<double>(m);
        const Vec3d v = normalize(Vec3d{tilt, 0.05, 1});
        double expected[3] = {0, 0, 0}, found[3] = {0, 0, 0};
        constexpr int kRings = 600, kSectors = 300;
        for (int i = 0; i < kRings; ++i)
          for (int k = 0; k < kSectors; ++k) {
            const double z = -(i + 0.5) / kRings, turn = 2 * kPi * (k + 0.5) / kSectors, r = std::sqrt(1 - z * z);
            const Vec3d o = {r * std::cos(turn), r * std::sin(turn), z};
            // The half vector −(η_i i + η_o o) with η_i/η_o = eta, towards the denser side's other face.
            Vec3d h = normalize(v * eta + o) * (eta < 1 ? -1.0 : 1.0);
            if (dot(h, n) <= 0) continue;
            const double ih = dot(v, h), oh = dot(o, h);
            if (ih <= 0 || oh >= 0) continue;
            double cos_t;
            const double passes = 1 - boundary_reflectance(ih, eta, &cos_t);
            const double jacobian = -oh / ((eta * ih + oh) * (eta * ih + oh));
            const double value = ih / v.z * passes * ggx(h.z, width) * jacobian * unmasked_share(v.z, width) *
                                 unmasked_share(z, width) * (2 * kPi / kRings / kSectors);
            expected[0] += value, expected[1] += value * z, expected[2] += value * o.x * o.x;
          }
        Rng rng = make_rng(4);
        const int count = effort(200000);
        for (int i = 0; i < count; ++i) {
          const double a = next_double(&rng), b = next_double(&rng);
          const Vec3d h = visible_facet(n, v, width, a, b), o = passed_direction(m, -v, n, h, eta);
          if (is_zero(o)) continue;
          double cos_t;
          const double weight = (1 - boundary_reflectance(dot(v, h), eta, &cos_t)) * unmasked_share(o.z, width) / count;
          found[0] += weight, found[1] += weight * o.z, found[2] += weight * o.x * o.x;
        }
        CAPTURE(alpha);
        CAPTURE(eta);
        CAPTURE(tilt);
        for (int k = 0; k < 3; ++k) CHECK(found[k] == doctest::Approx(expected[k]).epsilon(0.03));
      }
}

// Goal: the renderer's few rays carry what the lobe does: paths through rough panes and bodies. Method: uniform
// surroundings, from smooth to rough; the model and paths that sample facets.
TEST_CASE("reference_rough_glass_passes_what_the_renderer_shows") {
  for (bool thin : {true, false})
    for (float roughness : {0.1f, 0.4f, 0.7f}) {
      GeneratedScene s;
      s.materials = {frosted(roughness, thin)};
      add_quad(&s, {-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}, 0);
      if (!thin) add_quad(&s, {-9, 9, -0.5f}, {9, 9, -0.5f}, {9, -9, -0.5f}, {-9, -9, -0.5f}, 0);
      s.scene.info.background = s.scene.info.ambient = {1, 1, 1};
      s.lights.resize(1);
      s.lights[0].intensity = {0, 0, 0};
      aim(&s, {0, 0, 5}, {0, 0.1f, 0}, 40);
      s.bind();
      const TestReference t(s.scene);
      const Vec3d from = {0.3, 0.4, 3}, way = normalize(Vec3d{-0.1, -0.15, -1});
      const float shown = trace_ray(t.renderer->renderer, to_float(from), to_float(way)).y;
      const Estimate paths = estimate(t, Transport::physical, from, way, effort(20000));
      CAPTURE(thin);
      CAPTURE(roughness);
      CAPTURE(paths.mean);
      CHECK(paths.mean < 1.02);
      CHECK(static_cast<double>(shown) == doctest::Approx(paths.mean).epsilon(0.06));
    }
}
