// A lobe around the direction to the viewer, as of retroreflective paint: f = specular · (n + 2)/2π · max(0, v·l)^n.
// Reciprocal; reflects what kPhongBrdf does, turned back. For trial.sh.
#include "base/fmath.h"
#include "brdf/brdf_list.h"
#include "brdf/directions.h"

namespace pocketray {
namespace {

float scale(const Material& material) { return (material.exponent + 2) * (0.5f / kPiF); }

Vec3 value(const Material& material, const Vec3& specular, const Vec3& diffuse, const LobeFrame&, const Vec3& to_viewer,
           const Vec3& to_light) {
  float cosine = dot(to_viewer, to_light);
  if (!(cosine > 0)) return diffuse;
  if (cosine > 1) cosine = 1;
  return diffuse + specular * (scale(material) * det_pow(cosine, material.exponent));
}

Vec3 peak(const Material& material) { return material.specular * scale(material); }

double exact_cosine(const Vec3d& to_viewer, const Vec3d& to_light) {
  double cosine = dot(to_viewer, to_light);
  return cosine < 1 ? cosine : 1;
}

Vec3d exact_value(const Material& material, const Vec3d& specular, const Vec3d& diffuse, const LobeFrameD&,
                  const Vec3d& to_viewer, const Vec3d& to_light) {
  double cosine = exact_cosine(to_viewer, to_light), n = static_cast<double>(material.exponent);
  if (!(cosine > 0)) return diffuse;
  return diffuse + specular * ((n + 2) / (2 * kPi) * unit_power(cosine, n));
}

Vec3d sample(const Material& material, const LobeFrameD&, const Vec3d& to_viewer, double u, double v) {
  return power_cosine_direction(to_viewer, static_cast<double>(material.exponent), u, v);
}

double density(const Material& material, const LobeFrameD&, const Vec3d& to_viewer, const Vec3d& to_light) {
  double cosine = exact_cosine(to_viewer, to_light), n = static_cast<double>(material.exponent);
  return cosine > 0 ? (n + 1) / (2 * kPi) * unit_power(cosine, n) : 0;
}

}  // namespace

const BrdfInfo kRetroBrdf = {"retro", value, peak, exact_value, sample, density, nullptr, 1, nullptr};

}  // namespace pocketray
