// The Phong lobe, normalised so that it reflects at most `specular` of what arrives and is reciprocal:
// f = specular · (n + 2)/2π · max(0, r·v)^n, r the mirror direction of the light [Lafortune & Willems 1994, eq. 4].
#include "base/fmath.h"
#include "brdf/brdf_list.h"

namespace pocketray {
namespace {

float scale(const Material& material) { return (material.exponent + 2) * (0.5f / kPiF); }

Vec3 value(const Material& material, const Vec3& normal, const Vec3& to_viewer, const Vec3& to_light) {
  float cos_lobe = 2 * dot(normal, to_light) * dot(normal, to_viewer) - dot(to_light, to_viewer);
  if (!(cos_lobe > 0)) return {0, 0, 0};
  if (cos_lobe > 1) cos_lobe = 1;  // unit vectors round (HARDCASES row 30)
  return material.specular * (scale(material) * det_pow(cos_lobe, material.exponent));
}

Vec3 peak(const Material& material) { return material.specular * scale(material); }

}  // namespace

const BrdfInfo kPhongBrdf = {"phong", value, peak};

}  // namespace pocketray
