// Light that passes a rough boundary, refracted by microfacets [Walter et al. 2007, "Microfacet Models for Refraction
// through Rough Surfaces"] of the GGX distribution; through a thin sheet, the mirrored lobe of a reflection, as glTF's
// sample renderer has it. Widths are those of the GGX lobe whose reflection spreads over as large an angle.
#pragma once
#include "brdf/brdf_list.h"
#include "brdf/microfacet.h"

namespace pocketray {

// Returns whether light that passes the material is scattered.
inline bool is_rough_glass(const Material& m) {
  return m.brdf == kGgx && m.roughness > kAlphaMin && !is_zero(m.specular) && !is_zero(m.transmission);
}

// α of the facets; of a thin sheet less if its index is close to 1, as glTF's sample renderer has it.
template <class T>
T facet_alpha(const Material& m) {
  const T ior = static_cast<T>(m.ior), alpha = static_cast<T>(m.roughness);
  return m.thin && ior < T(1.5) ? alpha * (2 * ior - 2) : alpha;
}

// Width that a boundary of relative index eta = n_from / n_to adds to a beam; that of the beam before is × eta in a
// body.
template <class T>
T scattered_width(const Material& m, T eta) {
  const T alpha = facet_alpha<T>(m);
  return m.thin ? alpha : alpha * std::fabs(1 - eta) / 2;
}

// Direction of a unit vector beyond a facet of unit normal h, on the side from which it comes. Zero: total internal
// reflection, or none on the other side of the surface, whose unit normal is n.
template <class T>
Vec3T<T> passed_direction(const Material& m, const Vec3T<T>& d, const Vec3T<T>& n, const Vec3T<T>& h, T eta) {
  const T cosine = -dot(d, h);
  if (!(cosine > 0)) return {0, 0, 0};
  Vec3T<T> passed;
  if (m.thin) {
    passed = d + h * (2 * cosine);
    passed = passed - n * (2 * dot(passed, n));
  } else {
    const T square = 1 - eta * eta * (1 - cosine * cosine);
    if (!(square > 0)) return {0, 0, 0};
    passed = d * eta + h * (eta * cosine - std::sqrt(square));
  }
  return dot(passed, n) < 0 ? normalize(passed) : Vec3T<T>{0, 0, 0};
}

// Share of light in a direction that other facets do not hide [Walter et al. 2007, eq. 34].
template <class T>
T unmasked_share(T cosine, T alpha) {
  const T c = std::fabs(cosine);
  return c > 0 ? 2 * c / (c + std::sqrt(alpha * alpha + (1 - alpha * alpha) * c * c)) : T(0);
}

// Light through the middle of the lobe: its direction, and the share of the light that facets do not hide. Zero: none
// passes. `d` and the normal n are unit vectors, n on the side from which d comes.
template <class T>
struct FacetPassage {
  Vec3T<T> direction;
  T share;
};
template <class T>
FacetPassage<T> through_facets(const Material& m, const Vec3T<T>& d, const Vec3T<T>& n, T eta) {
  constexpr int kSteps = 16;  // facets at the middles of equal shares of the distribution, along a spiral
  constexpr T r = T(0.70710678118654752);
  constexpr T kCosine[] = {1, -r, 0, r, -1, r, 0, -r}, kSine[] = {0, r, -1, r, 0, -r, 1, -r};
  const T alpha = facet_alpha<T>(m);
  Vec3d tangent, bitangent;
  make_basis({static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)}, &tangent, &bitangent);
  auto at = [](const Vec3d& v) { return Vec3T<T>{static_cast<T>(v.x), static_cast<T>(v.y), static_cast<T>(v.z)}; };
  T passed = 0, all = 0;
  for (int i = 0; i < kSteps; ++i) {
    const T u = (static_cast<T>(i) + T(0.5)) / kSteps, slope = alpha * std::sqrt(u / (1 - u));
    const Vec3T<T> facet =
        normalize(n + at(tangent) * (slope * kCosine[i % 8]) + at(bitangent) * (slope * kSine[i % 8]));
    const T visible = -dot(d, facet), seen = visible > 0 ? visible / dot(n, facet) : T(0);
    const Vec3T<T> direction = passed_direction(m, d, n, facet, eta);
    if (!is_zero(direction)) passed += seen * unmasked_share(dot(direction, n), alpha);
    all += seen;
  }
  const Vec3T<T> middle = passed_direction(m, d, n, n, eta);
  return {middle, all > 0 && !is_zero(middle) ? passed / all : T(0)};
}

// A facet visible from a direction, sampled in proportion to what is seen of it [Dupuy & Benyoub 2023, "Sampling
// visible GGX normals with spherical caps", listing 1].
inline Vec3d visible_facet(const Vec3d& n, const Vec3d& to_viewer, double alpha, double u, double v) {
  Vec3d tangent, bitangent;
  make_basis(n, &tangent, &bitangent);
  const Vec3d stretched = normalize(
      Vec3d{alpha * dot(tangent, to_viewer), alpha * dot(bitangent, to_viewer), std::fmax(dot(n, to_viewer), 0)});
  const double z = (1 - u) * (1 + stretched.z) - stretched.z, phi = 2 * kPi * v;
  const double sine = std::sqrt(std::fmax((1 - z) * (1 + z), 0));
  const Vec3d cap = Vec3d{sine * det_cos(phi), sine * det_sin(phi), z} + stretched;
  return normalize(tangent * (alpha * cap.x) + bitangent * (alpha * cap.y) + n * std::fmax(cap.z, 0));
}

}  // namespace pocketray
