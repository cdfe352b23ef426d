// The Phong lobe, normalised to be reciprocal and to reflect at most `specular` of the incoming light:
// f = specular · (n + 2)/2π · max(0, r·v)^n, r the mirror direction of the light [Lafortune & Willems 1994, eq. 4].
#include "base/fmath.h"
#include "brdf/brdf_list.h"
#include "brdf/directions.h"
#include "brdf/linear_lobe.h"

namespace pocketray {
namespace {

float scale(const Material& material) { return (material.exponent + 2) * (0.5f / kPiF); }

Vec3 value(const Material& material, const Vec3& specular, const Vec3& diffuse, const LobeFrame& frame,
           const Vec3& to_viewer, const Vec3& to_light) {
  const Vec3& normal = frame.normal;
  float cos_lobe = 2 * dot(normal, to_light) * dot(normal, to_viewer) - dot(to_light, to_viewer);
  if (!(cos_lobe > 0)) return diffuse;
  if (cos_lobe > 1) cos_lobe = 1;  // rounded unit vectors (HARDCASES row 30)
  return diffuse + specular * (scale(material) * det_pow(cos_lobe, material.exponent));
}

Vec3 peak(const Material& material) { return material.specular * scale(material); }

double exact_cosine(const Vec3d& normal, const Vec3d& to_viewer, const Vec3d& to_light) {
  double c = 2 * dot(normal, to_light) * dot(normal, to_viewer) - dot(to_light, to_viewer);
  return c < 1 ? c : 1;
}

Vec3d exact_value(const Material& material, const Vec3d& specular, const Vec3d& diffuse, const LobeFrameD& frame,
                  const Vec3d& to_viewer, const Vec3d& to_light) {
  double cosine = exact_cosine(frame.normal, to_viewer, to_light), n = static_cast<double>(material.exponent);
  if (!(cosine > 0)) return diffuse;
  return diffuse + specular * ((n + 2) / (2 * kPi) * unit_power(cosine, n));
}

Vec3d sample(const Material& material, const LobeFrameD& frame, const Vec3d& to_viewer, double u, double v) {
  const Vec3d& normal = frame.normal;
  Vec3d mirrored = normalize(normal * (2 * dot(normal, to_viewer)) - to_viewer);
  return power_cosine_direction(mirrored, static_cast<double>(material.exponent), u, v);
}

double density(const Material& material, const LobeFrameD& frame, const Vec3d& to_viewer, const Vec3d& to_light) {
  double cosine = exact_cosine(frame.normal, to_viewer, to_light), n = static_cast<double>(material.exponent);
  return cosine > 0 ? (n + 1) / (2 * kPi) * unit_power(cosine, n) : 0;
}

template <class T>
bool divide(const Material& material, const Vec3T<T>& specular, const Vec3T<T>& diffuse, const LobeFrameT<T>& frame,
            const Vec3T<T>& to_viewer, LobePartsT<T>* parts) {
  const T alpha = std::sqrt(2 / (static_cast<T>(material.exponent) + 2));
  if (!(alpha < T(kPhongLinearAlphaMax))) return false;
  const ViewerPlane<T> plane(frame.normal, to_viewer);
  if (!(plane.cosine > 0)) return false;
  T parameters[4];
  find_linear_parameters(kPhongLinear, T(kPhongLinearStep), alpha, plane.cosine, parameters);
  set_phong_lobe(frame.normal, plane, alpha, parameters, parts);
  parts->albedo = specular * parameters[3];
  parts->diffuse = diffuse, parts->scattered = {0, 0, 0};
  return true;
}

constexpr LinearForm kLinear = {kPhongLinearPower, divide<float>, divide<double>, nullptr, nullptr};

}  // namespace

const BrdfInfo kPhongBrdf = {"phong", value, peak, exact_value, sample, density, nullptr, 1, nullptr, &kLinear};

}  // namespace pocketray
