#include "reference/surface.h"

#include "base/fmath.h"
#include "brdf/brdf_list.h"
#include "brdf/directions.h"
#include "indirect/surroundings.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

// Relative to coordinates: nearer hits may be the surface itself, by rounding.
constexpr double kOwnSurface = 0x1p-40;

const BrdfInfo& glossy_lobe(const ReferenceSurface& s) { return *kBrdfList[s.material->brdf]; }

// Probability of sampling the glossy lobe rather than the diffuse one.
double glossy_share(const ReferenceSurface& s) {
  double glossy = static_cast<double>(max_component(s.material->specular)), diffuse = max_component(s.diffuse);
  return glossy > 0 ? glossy / (glossy + diffuse) : 0;
}

}  // namespace

ReferenceSurface reference_surface(const FrameData& frame, const ReferenceHit& hit, const Vec3d& direction) {
  const Scene& scene = *frame.scene;
  const Triangle& t = scene.triangles[hit.triangle];
  double weight[3] = {1 - hit.u - hit.v, hit.u, hit.v};
  Vec3d corner[3], normal = {0, 0, 0}, tint = {1, 1, 1};
  ReferenceSurface s;
  s.triangle = hit.triangle, s.u = hit.u, s.v = hit.v;
  s.material = &scene.materials[t.material()];
  s.point = {0, 0, 0}, s.magnitude = 0;
  for (std::uint32_t i = 0; i < 3; ++i) {
    corner[i] = to_double(frame.positions[t.vertex(i)]);
    s.point += corner[i] * weight[i];
    for (int axis = 0; axis < 3; ++axis) s.magnitude = std::fmax(s.magnitude, std::fabs(corner[i][axis]));
    if (frame.normals.count) normal += to_double(frame.normals[t.vertex(i)]) * weight[i];
  }
  Vec3d outward = normalize(cross(corner[1] - corner[0], corner[2] - corner[0]));
  s.front = dot(outward, direction) <= 0;
  s.geometric = s.front ? outward : -outward;
  normal = frame.settings.normals == NormalMode::flat ? Vec3d{0, 0, 0} : normalize(normal);
  s.normal = is_zero(normal) ? s.geometric : dot(normal, s.geometric) < 0 ? -normal : normal;
  Vec2 uv = {0, 0};
  if (scene.uvs.count) uv = hit_uv(scene, hit.triangle, static_cast<float>(hit.u), static_cast<float>(hit.v));
  const Material& m = *s.material;
  auto texel = [&](const TextureUse& use) {
    return use.texture == kNone ? Vec3d{1, 1, 1}
                                : to_double(sample_texture(scene, use, uv, frame.settings.texture_filter).rgb);
  };
  if (scene.colors.count) {
    tint = {0, 0, 0};
    for (std::uint32_t i = 0; i < 3; ++i) {
      const Rgba16& c = scene.colors[t.vertex(i)];
      tint += Vec3d{c.r / 65535.0, c.g / 65535.0, c.b / 65535.0} * weight[i];
    }
  }
  tint *= texel(m.diffuse_texture);
  auto tinted = [&](const Vec3& reflectance, const Vec3& part) {
    return to_double(reflectance) - to_double(part) * (Vec3d{1, 1, 1} - tint);
  };
  s.diffuse = to_double(m.diffuse) * tint;
  s.specular = tinted(m.specular, m.specular_tinted), s.mirror = tinted(m.mirror, m.mirror_tinted);
  s.emission = {0, 0, 0};
  if (!is_zero(m.emission) && (s.front || m.double_sided))
    s.emission = to_double(m.emission) * texel(m.emission_texture);
  return s;
}

ReferenceRay leave(const FrameData& frame, const ReferenceSurface& s, const Vec3d& direction, double t_max) {
  Vec3d origin = s.point;
  if (frame.normals.count && !(dot(direction, s.geometric) > 0) && dot(direction, s.normal) > 0) {
    const Triangle& t = frame.scene->triangles[s.triangle];
    double weight[3] = {1 - s.u - s.v, s.u, s.v};
    for (std::uint32_t i = 0; i < 3; ++i) {
      Vec3d n = to_double(frame.normals[t.vertex(i)]);
      if (dot(n, s.normal) < 0) n = -n;
      double below = dot(s.point - to_double(frame.positions[t.vertex(i)]), n);
      if (below < 0) origin += n * (-below * weight[i]);
    }
  }
  return {origin, direction, kOwnSurface * s.magnitude / length(direction), t_max};
}

Vec3d reflected_surroundings(const FrameData& frame, const ReferenceSurface& s, const Vec3d& to_viewer) {
  if (!has(frame.mask, Effect::ambient_gloss) || !reflects_surroundings(*s.material)) return {0, 0, 0};
  const Vec3 specular = {static_cast<float>(s.specular.x), static_cast<float>(s.specular.y),
                         static_cast<float>(s.specular.z)};
  const float cosine = static_cast<float>(dot(s.normal, to_viewer));
  return to_double(reflected_surroundings(frame.scene->info, *s.material, specular, cosine));
}

Vec3d lobe_value(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light) {
  Vec3d value = s.diffuse * (1 / kPi);
  if (!is_zero(s.material->specular))
    value = glossy_lobe(s).exact_value(*s.material, s.specular, value, s.normal, to_viewer, to_light);
  return value;
}

double lobe_density(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light) {
  double cosine = dot(s.normal, to_light), share = glossy_share(s);
  if (!(cosine > 0) || (is_zero(s.diffuse) && share == 0)) return 0;
  double glossy = share > 0 ? glossy_lobe(s).density(*s.material, s.normal, to_viewer, to_light) : 0;
  return (1 - share) * cosine / kPi + share * glossy;
}

bool sample_lobes(const ReferenceSurface& s, const Vec3d& to_viewer, double choice, const Pair& pair,
                  Vec3d* direction) {
  double share = glossy_share(s);
  if (is_zero(s.diffuse) && share == 0) return false;
  *direction = choice < share ? glossy_lobe(s).sample(*s.material, s.normal, to_viewer, pair.u, pair.v)
                              : power_cosine_direction(s.normal, 1, pair.u, pair.v);
  return dot(*direction, s.normal) > 0;
}

}  // namespace pocketray
