// The GGX microfacet lobe of glTF 2.0, appendix B.3: f = D·V·F with the distribution of Trowbridge and Reitz, the
// height-correlated masking and shadowing of Smith, and Schlick's Fresnel term, from `specular` to `grazing`.
//   D = α² / (π ((n·h)² (α² − 1) + 1)²)
//   V = 1/2 / (n·l √((n·v)² (1 − α²) + α²) + n·v √((n·l)² (1 − α²) + α²))
//   F = specular + (grazing − specular) (1 − v·h)⁵
// Below it lies the diffuse lobe × 21/20 (1 − R)(1 − (1 − n·l)⁵)(1 − (1 − n·v)⁵), where R is a dielectric's reflectance
// at normal incidence: what remains of uniform light is 1 − F(n·v) [Shirley et al. 1997, "A practitioner's assessment
// of light reflection models"]. With glTF's 1 − F(v·h), a white plastic of α = 0.1 would reflect 121 % of it at 80°.
// At α = 1 and F = 1 the lobe reflects 1 − n·v ln(1 + 1/n·v) of uniform light, 31 % at normal incidence; the light
// scattered more than once between microfacets is a second lobe, see ggx_albedo.h.
// With a grain, along which α is αx and across which it is αy [Burley 2012; KHR_materials_anisotropy]:
//   D = 1 / (π αx αy ((t·h/αx)² + (b·h/αy)² + (n·h)²)²)
//   V = 1/2 / (n·l √((αx t·v)² + (αy b·v)² + (n·v)²) + n·v √((αx t·l)² + (αy b·l)² + (n·l)²))
// and for light scattered more than once, α = √(αx αy).
#include "base/fmath.h"
#include "brdf/brdf_list.h"
#include "brdf/directions.h"
#include "brdf/ggx_albedo.h"
#include "brdf/linear_lobe.h"
#include "brdf/microfacet.h"

namespace pocketray {
namespace {

constexpr float kDiffuseMax = 1.05f;
constexpr float kCosineMin = 1e-6f;  // in V, which is infinite where both cosines are 0

// The distribution: D = square / (π slope²), where slope is at least `square`; and the root in V and G₁ of a direction.
template <class T>
struct Even {
  T square, roughness;

  Even(const Material& material, const LobeFrameT<T>&)
      : square(alpha_of<T>(material) * alpha_of<T>(material)), roughness(static_cast<T>(material.roughness)) {}
  // sin² + α² cos² for the angle between normal and half vector, since |n × h|² does not cancel near the peak.
  T slope(const Vec3T<T>& normal, const Vec3T<T>& sum, T sum_square) const {
    const Vec3T<T> across = cross(normal, sum);
    const T sine_square = dot(across, across) / sum_square, term = sine_square + square * (1 - sine_square);
    return term > square ? term : square;
  }
  T root(const Vec3T<T>&, T cosine) const { return std::sqrt(cosine * cosine * (1 - square) + square); }
};

template <class T>
struct Grained {
  GrainAxes<T> axes;
  T square, roughness;

  Grained(const Material& material, const LobeFrameT<T>& frame)
      : axes(grain_axes(frame, alpha_of<T>(material))),
        square(axes.along * axes.across),
        roughness(std::sqrt(square)) {}
  T slope(const Vec3T<T>& normal, const Vec3T<T>& sum, T sum_square) const {
    const T x = dot(sum, axes.tangent), y = dot(sum, axes.bitangent), z = dot(sum, normal);
    const T term =
        (x * x * (axes.across / axes.along) + y * y * (axes.along / axes.across) + z * z * square) / sum_square;
    return term > square ? term : square;
  }
  T root(const Vec3T<T>& direction, T cosine) const {
    const T x = axes.along * dot(direction, axes.tangent), y = axes.across * dot(direction, axes.bitangent);
    return std::sqrt(x * x + y * y + cosine * cosine);
  }
};

template <class T>
T fifth_power(T x) {
  T square = x * x;
  return square * square * x;
}

// The lobe of light scattered more than once.
template <class T>
Vec3T<T> scattered(T roughness, T grazing, const Vec3T<T>& specular, T cos_viewer, T cos_light) {
  const GgxCell<T> row = ggx_row(roughness);
  const T loss = (1 - ggx_energy(row, ggx_column(cos_viewer))) * (1 - ggx_energy(row, ggx_column(cos_light)));
  return ggx_scattered_color(row, specular, grazing) *
         (loss * static_cast<T>(1 / kPi) / ggx_between_rows(row, kGgxRows.lost));
}

// Factor of the diffuse lobe.
template <class T>
T diffuse_passes(const Material& material, T l, T v) {
  const T ior = static_cast<T>(material.ior), root = (ior - 1) / (ior + 1), normal_reflectance = root * root;
  return static_cast<T>(kDiffuseMax) * (1 - normal_reflectance) * (1 - fifth_power(1 - l)) * (1 - fifth_power(1 - v));
}

template <template <class> class Distribution, class T>
Vec3T<T> value_of(const Material& material, const Vec3T<T>& specular, const Vec3T<T>& diffuse,
                  const LobeFrameT<T>& frame, const Vec3T<T>& viewer, const Vec3T<T>& to_light) {
  const Vec3T<T>& normal = frame.normal;
  const T cos_light = dot(normal, to_light);
  if (!(cos_light > 0)) return diffuse;
  const Distribution<T> d(material, frame);
  const Vec3T<T> to_viewer = above_horizon(normal, viewer), sum = to_viewer + to_light;
  const T cos_viewer = dot(normal, to_viewer), sum_square = dot(sum, sum), least = static_cast<T>(kCosineMin);
  if (!(sum_square > 0)) return diffuse;
  const T l = cos_light > least ? cos_light : least, v = cos_viewer > least ? cos_viewer : least;
  const T slope = d.slope(normal, sum, sum_square);
  const T masking = l * d.root(to_viewer, v) + v * d.root(to_light, l);
  const T x = 1 - std::sqrt(sum_square) / 2;  // |v + l| = 2 v·h
  const T grazing = static_cast<T>(material.grazing), rise = x > 0 ? fifth_power(x) : 0;
  const Vec3T<T> fresnel = specular + (Vec3T<T>{grazing, grazing, grazing} - specular) * rise;
  return diffuse * diffuse_passes(material, l, v) +
         fresnel * (d.square * static_cast<T>(0.5 / kPi) / (slope * slope * masking)) +
         scattered(d.roughness, grazing, specular, v, l);
}

template <template <class> class Distribution>
Vec3 value(const Material& material, const Vec3& specular, const Vec3& diffuse, const LobeFrame& frame,
           const Vec3& to_viewer, const Vec3& to_light) {
  return value_of<Distribution>(material, specular, diffuse, frame, to_viewer, to_light);
}

// D ≤ 1/π αx αy ≤ 1/πα², and n·l V < 1/2α, which it approaches where n·v ≪ n·l ≪ α. Light scattered more than once is
// bounded by the largest loss of the lobe in any direction.
Vec3 peak_of(const Material& material, float roughness) {
  const float alpha = alpha_of<float>(material), square = alpha * alpha, f = material.grazing;
  const Vec3 most = max(material.specular, {f, f, f});
  const GgxCell<float> row = ggx_row(roughness);
  const float loss = ggx_between_rows(row, kGgxRows.most_lost);
  const Vec3 rest = ggx_scattered_color(row, most, f) * (loss * loss / (kPiF * ggx_between_rows(row, kGgxRows.lost)));
  return (most * (0.5f / kPiF / (square * std::sqrt(square))) + rest) * 1.00001f;  // covers rounding
}
Vec3 peak(const Material& material) { return peak_of(material, material.roughness); }
// Light scattered more than once grows or falls with the grain's strength: takes the larger of both ends.
Vec3 grained_peak(const Material& material) { return max(peak_of(material, material.roughness), peak_of(material, 1)); }

template <template <class> class Distribution>
Vec3d exact_value(const Material& material, const Vec3d& specular, const Vec3d& diffuse, const LobeFrameD& frame,
                  const Vec3d& to_viewer, const Vec3d& to_light) {
  return value_of<Distribution>(material, specular, diffuse, frame, to_viewer, to_light);
}

// Share of samples for light scattered more than once, in proportion to that light.
double scattered_share(double roughness, double cos_viewer) {
  const GgxCell<double> row = ggx_row(roughness);
  return 1 - ggx_energy(row, ggx_column(cos_viewer));
}

GrainAxes<double> axes_of(const Even<double>& d, const LobeFrameD& frame) {
  GrainAxes<double> axes;
  make_basis(frame.normal, &axes.tangent, &axes.bitangent);
  axes.along = axes.across = std::sqrt(d.square);
  return axes;
}
const GrainAxes<double>& axes_of(const Grained<double>& d, const LobeFrameD&) { return d.axes; }

// Samples that share by the cosine. The rest mirrors the viewer in a normal visible to it [Dupuy & Benyoub 2023,
// "Sampling visible GGX normals with spherical caps", listing 1].
template <template <class> class Distribution>
Vec3d sample(const Material& material, const LobeFrameD& frame, const Vec3d& viewer, double u, double v) {
  const Vec3d& normal = frame.normal;
  const Distribution<double> d(material, frame);
  const Vec3d to_viewer = above_horizon(normal, viewer);
  const GrainAxes<double> axes = axes_of(d, frame);
  const Vec3d &tangent = axes.tangent, &bitangent = axes.bitangent;
  const double once = 1 - scattered_share(d.roughness, dot(normal, to_viewer));
  if (u >= once) {
    const double square = (u - once) / (1 - once), radius = std::sqrt(square), turn = 2 * kPi * v;
    return tangent * (radius * det_cos(turn)) + bitangent * (radius * det_sin(turn)) + normal * std::sqrt(1 - square);
  }
  u /= once;
  const Vec3d stretched = normalize(Vec3d{axes.along * dot(tangent, to_viewer), axes.across * dot(bitangent, to_viewer),
                                          std::fmax(dot(normal, to_viewer), 0)});
  const double z = (1 - u) * (1 + stretched.z) - stretched.z, phi = 2 * kPi * v;
  const double sine = std::sqrt(std::fmax((1 - z) * (1 + z), 0));
  const Vec3d cap = Vec3d{sine * det_cos(phi), sine * det_sin(phi), z} + stretched;
  const Vec3d half =
      normalize(tangent * (axes.along * cap.x) + bitangent * (axes.across * cap.y) + normal * std::fmax(cap.z, 0));
  return half * (2 * dot(half, to_viewer)) - to_viewer;
}

// Mixes the cosine's density and that of visible normals, D G₁(v) v·h / n·v, over 4 v·h [Heitz 2018, eq. 17].
template <template <class> class Distribution>
double density(const Material& material, const LobeFrameD& frame, const Vec3d& viewer, const Vec3d& to_light) {
  const Vec3d& normal = frame.normal;
  const Distribution<double> d(material, frame);
  const Vec3d to_viewer = above_horizon(normal, viewer), sum = to_viewer + to_light;
  const double cosine = dot(normal, to_viewer), sum_square = dot(sum, sum);
  const double share = scattered_share(d.roughness, cosine), cos_light = dot(normal, to_light);
  const double scattered = cos_light > 0 ? share * cos_light / kPi : 0;
  if (!(dot(normal, sum) > 0)) return scattered;
  const double slope = d.slope(normal, sum, sum_square);
  return scattered + (1 - share) * d.square / (kPi * slope * slope) / (2 * (cosine + d.root(to_viewer, cosine)));
}

template <class T>
bool divide(const Material& material, const Vec3T<T>& specular, const Vec3T<T>& diffuse, const LobeFrameT<T>& frame,
            const Vec3T<T>& to_viewer, LobePartsT<T>* parts) {
  const T alpha = alpha_of<T>(material), grazing = static_cast<T>(material.grazing), least = static_cast<T>(kCosineMin);
  const ViewerPlane<T> plane(frame.normal, above_horizon(frame.normal, to_viewer));
  T parameters[4], above;
  find_linear_parameters(kGgxLinear, T(kGgxLinearStep), alpha, plane.cosine, parameters);
  set_ggx_lobe(frame.normal, plane, alpha, parameters, parts, &above);
  parts->albedo = ggx_albedo_once(ggx_shares(alpha, plane.cosine), specular, grazing) / above;
  const T v = plane.cosine > least ? plane.cosine : least;
  parts->roughness = static_cast<T>(material.roughness);
  parts->diffuse = diffuse * diffuse_passes(material, T(1), v);
  const GgxCell<T> row = ggx_row(parts->roughness);
  const T loss = (1 - ggx_energy(row, ggx_column(v))) * static_cast<T>(1 / kPi);
  parts->scattered = ggx_scattered_color(row, specular, grazing) * (loss / ggx_between_rows(row, kGgxRows.lost));
  return true;
}

// The diffuse lobe, and light scattered more than once.
template <class T>
Vec3T<T> rest_of(const LobePartsT<T>& parts, T l) {
  return parts.diffuse * (1 - fifth_power(1 - l)) +
         parts.scattered * (1 - ggx_energy(ggx_row(parts.roughness), ggx_column(l)));
}

constexpr LinearForm kLinear = {1, divide<float>, divide<double>, rest_of<float>, rest_of<double>};

BrdfAlbedo albedo(const Material& material, const Vec3& specular, float cos_viewer) {
  return ggx_albedo(material.roughness, specular, material.grazing, std::fabs(cos_viewer));
}

}  // namespace

const BrdfInfo kGrainedGgxBrdf = {"ggx with grain", value<Grained>,   grained_peak, exact_value<Grained>,
                                  sample<Grained>,  density<Grained>, albedo,       kDiffuseMax,
                                  nullptr};
const BrdfInfo kGgxBrdf = {"ggx",         value<Even>, peak,        exact_value<Even>, sample<Even>,
                           density<Even>, albedo,      kDiffuseMax, &kGrainedGgxBrdf,  &kLinear};

}  // namespace pocketray
