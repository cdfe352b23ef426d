#include "desktop/reference/surface.h"

#include "base/fmath.h"
#include "brdf/clear_coat.h"
#include "brdf/directions.h"
#include "brdf/iridescence.h"
#include "brdf/microfacet.h"
#include "brdf/rough_refraction.h"
#include "brdf/sheen.h"
#include "indirect/environment.h"
#include "scene/diffuse_transmission.h"
#include "scene/metallic_roughness.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

// Relative to coordinates: nearer hits may be the surface itself, by rounding.
constexpr double kOwnSurface = 0x1p-40;

// Coordinates of a texture at the surface.
Vec2 uv_of(const FrameData& frame, const TextureUse& use, const ReferenceSurface& s) {
  const float u = static_cast<float>(s.u), v = static_cast<float>(s.v);
  return has(frame.mask, Effect::second_uv) ? texture_uv(*frame.scene, use, s.triangle, u, v)
                                            : hit_uv(*frame.scene, s.triangle, u, v);
}
Rgba color_at(const FrameData& frame, const TextureUse& use, const ReferenceSurface& s) {
  return sample_texture(*frame.scene, use, uv_of(frame, use, s), frame.settings.texture_filter);
}
Vec3d numbers_at(const FrameData& frame, const TextureUse& use, const ReferenceSurface& s) {
  return to_double(sample_numbers(*frame.scene, use, uv_of(frame, use, s), frame.settings.texture_filter));
}

// Applies textures of metallic, roughness and transmission by the formulas of the glTF specification, secs. 3.9.2 and
// B.2.2, KHR_materials_transmission and the mirror's share of src/desktop/import/README.md. `glass` may be null.
void apply_maps(const FrameData& frame, const MaterialMaps& maps, const GlassMap* glass, const Vec3d& tint,
                ReferenceSurface* s) {
  Vec3d numbers = {255, 255, 255}, dielectric = to_double(maps.model.dielectric);
  double grazing = static_cast<double>(maps.model.grazing), passes = 0;
  const bool varies = has(frame.mask, Effect::metallic_roughness);
  if (varies && maps.metallic_roughness.texture != kNone) numbers = numbers_at(frame, maps.metallic_roughness, *s);
  if (varies && maps.specular.texture != kNone) {  // KHR_materials_specular
    const double share = static_cast<double>(color_at(frame, maps.specular, *s).alpha);
    dielectric = dielectric * share, grazing *= share;
  }
  if (varies && maps.specular_color.texture != kNone)
    dielectric *= to_double(color_at(frame, maps.specular_color, *s).rgb);
  auto within = [](double x, float low, float high) {
    return std::fmin(std::fmax(x, static_cast<double>(low)), static_cast<double>(high));
  };
  const double metallic =
      within(numbers.z / 255 * static_cast<double>(maps.metallic), maps.metallic_low, maps.metallic_high);
  const double roughness =
      within(numbers.y / 255 * static_cast<double>(maps.roughness), maps.roughness_low, maps.roughness_high);
  const Vec3d color = to_double(maps.model.base) * tint;
  const double smooth = std::fmax(0, 1 - roughness / 0.3), mirrored = smooth * smooth;
  if (glass) {
    passes = static_cast<double>(glass->transmission);
    if (glass->transmission_texture.texture != kNone)
      passes *= numbers_at(frame, glass->transmission_texture, *s).x / 255;
    s->transmission = color * (passes * (1 - metallic));
    double thickness = s->material->thin ? static_cast<double>(glass->thickness) : 0;
    if (glass->thickness_texture.texture != kNone) thickness *= numbers_at(frame, glass->thickness_texture, *s).y / 255;
    for (int c = 0; c < 3; ++c)
      s->transmission[c] *= det_exp(-static_cast<double>(s->material->absorption[c]) * thickness);
  }
  s->diffuse = color * ((1 - metallic) * (1 - passes));
  const Vec3d reflectance = dielectric * (1 - metallic) + color * metallic;
  s->mirror = reflectance * (mirrored * (1 - passes * (1 - metallic))), s->specular = reflectance * (1 - mirrored);
  s->mapped = *s->material, s->is_mapped = true;
  s->mapped.roughness = static_cast<float>(roughness * roughness);
  s->mapped.grazing = static_cast<float>((grazing * (1 - metallic) + metallic) * (1 - mirrored));
  s->mapped.specular = to_float(s->specular);
  s->mapped.mirror = to_float(s->mirror);
}

// KHR_materials_iridescence, under the mirror's share.
void put_film_on(const FrameData& frame, const Vec3d& direction, ReferenceSurface* s) {
  const Iridescence* film = iridescence_of(*frame.scene, frame.scene->triangles[s->triangle].material());
  if (!film || !has(frame.mask, Effect::iridescence)) return;
  s->film_strength = static_cast<double>(film->strength), s->film_ior = static_cast<double>(film->ior);
  if (film->strength_texture.texture != kNone)
    s->film_strength *= numbers_at(frame, film->strength_texture, *s).x / 255;
  const double green =
      film->thickness_texture.texture == kNone ? 1 : numbers_at(frame, film->thickness_texture, *s).y / 255;
  s->film_thickness =
      static_cast<double>(film->thickness_low) * (1 - green) + static_cast<double>(film->thickness_high) * green;
  if (!(s->film_strength > 0)) return;
  const Material& lobes = lobes_of(*s);
  const double smooth = std::fmax(0, 1 - std::sqrt(static_cast<double>(lobes.roughness)) / 0.3), k = smooth * smooth;
  Vec3d f0 = s->specular + s->mirror;
  if (!is_zero(s->transmission)) {
    const double root = (static_cast<double>(lobes.ior) - 1) / (static_cast<double>(lobes.ior) + 1);
    f0 = k < 1 ? s->specular / (1 - k) : Vec3d{1, 1, 1} * (root * root);
  }
  if (!(max_component(f0) > 0)) return;
  const double cosine = std::fabs(dot(s->normal, normalize(direction)));
  const Vec3d seen = film_reflectance(s->film_ior, s->film_thickness, f0, cosine);
  const double lobe = max_component(s->specular) / max_component(f0),
               mirror = max_component(s->mirror) / max_component(f0);
  auto mixed = [&](const Vec3d& with, double share) {
    Vec3d sum = (f0 * (1 - s->film_strength) + with * s->film_strength) * share;
    for (int c = 0; c < 3; ++c) sum[c] = std::fmin(sum[c], 1);
    return sum;
  };
  s->specular = mixed(film_f0(seen, cosine), lobe), s->mirror = mixed(seen, mirror);
  if (!s->is_mapped) s->mapped = *s->material, s->is_mapped = true;
  s->mapped.specular = to_float(s->specular), s->mapped.mirror = to_float(s->mirror);
}

// Probabilities of sampling the glossy lobe and the coat's lobe instead of the diffuse one.
struct LobeShares {
  double glossy = 0, coat = 0;
};
double glossy_weight(const ReferenceSurface& s) { return static_cast<double>(max_component(lobes_of(s).specular)); }
double coat_weight(const ReferenceSurface& s, const Vec3d& to_viewer) {
  return s.coat_lobe * coat_fresnel(dot(s.coat_normal, to_viewer));
}
LobeShares lobe_shares(const ReferenceSurface& s, const Vec3d& to_viewer) {
  const double total = lobe_weight(s, to_viewer);
  if (!(total > 0)) return {};
  return {glossy_weight(s) / total, coat_weight(s, to_viewer) / total};
}
LobeFrameD coat_frame(const ReferenceSurface& s) { return {s.coat_normal, {0, 0, 0}}; }

// Frame of maps from ∂P/∂u and ∂P/∂v, which solve e = u ∂P/∂u + v ∂P/∂v for both edges, or from the vertices;
// shade/normal_map.h has the rules. Returns false if there is none.
bool map_frame(const FrameData& frame, const Vec3d* corner, const ReferenceSurface& s, Vec3d* tangent,
               Vec3d* bitangent) {
  const Scene& scene = *frame.scene;
  const Triangle& t = scene.triangles[s.triangle];
  const Vec3d n = s.normal * (s.front ? 1.0 : -1.0);
  Vec3d at_vertex[3], along = {0, 0, 0};
  int handedness = 0;
  bool at_vertices = scene.tangents.count > 0;
  for (std::uint32_t i = 0; i < 3 && at_vertices; ++i) {
    at_vertex[i] = to_double(unpacked(scene.tangents[t.vertex(i)]));
    handedness += scene.tangents[t.vertex(i)].handedness;
    at_vertices = !is_zero(at_vertex[i]);
  }
  if (at_vertices) along = at_vertex[0] * (1 - s.u - s.v) + at_vertex[1] * s.u + at_vertex[2] * s.v;
  if (at_vertices && handedness != 0) {
    *tangent = normalize(along - n * dot(n, along)), *bitangent = cross(n, *tangent);
    if (handedness < 0) *bitangent = -*bitangent;
    return !is_zero(*tangent);
  }
  if (scene.uvs.empty()) return false;
  Vec2 at[3];
  for (std::uint32_t i = 0; i < 3; ++i) at[i] = scene.uvs[t.vertex(i)];
  const double u1 = static_cast<double>(at[1].x - at[0].x), v1 = static_cast<double>(at[1].y - at[0].y);
  const double u2 = static_cast<double>(at[2].x - at[0].x), v2 = static_cast<double>(at[2].y - at[0].y);
  const double determinant = u1 * v2 - u2 * v1;
  if (determinant == 0) return false;
  const Vec3d e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
  const Vec3d by_u = (e1 * v2 - e2 * v1) * (1 / determinant), by_v = (e2 * u1 - e1 * u2) * (1 / determinant);
  if (!at_vertices) along = by_u;
  const Vec3d own = normalize(by_u - n * dot(n, by_u)), other = cross(n, own);
  *tangent = normalize(along - n * dot(n, along)), *bitangent = cross(n, *tangent);
  if (dot(other, by_v) > 0) *bitangent = -*bitangent;
  return !is_zero(*tangent);
}

// Normal from a normal texture (sec. 3.9.3).
Vec3d normal_of_map(const FrameData& frame, const TextureUse& map, float scale, const Vec3d* corner,
                    const Vec3d& direction, const ReferenceSurface& s) {
  Vec3d numbers = numbers_at(frame, map, s);
  for (int c = 0; c < 3; ++c) numbers[c] = std::fmax((numbers[c] - 128) / 127, -1);
  numbers.x *= static_cast<double>(scale), numbers.y *= static_cast<double>(scale);
  Vec3d tangent, bitangent;
  if ((numbers.x == 0 && numbers.y == 0) || !map_frame(frame, corner, s, &tangent, &bitangent)) return s.normal;
  const double side = s.front ? 1 : -1;
  Vec3d mapped = normalize(tangent * numbers.x + bitangent * numbers.y + s.normal * (side * numbers.z)) * side;
  const Vec3d way = normalize(direction);
  if (dot(mapped, way) > 0) mapped = normalize(mapped - way * dot(mapped, way));
  return is_zero(mapped) ? s.normal : mapped;
}

// KHR_materials_diffuse_transmission. What enters is attenuated by the Fresnel term at the viewer.
void put_passing_on(const FrameData& frame, const Vec3d& direction, ReferenceSurface* s) {
  const DiffuseTransmission* passing =
      diffuse_transmission_of(*frame.scene, frame.scene->triangles[s->triangle].material());
  if (!passing || !has(frame.mask, Effect::diffuse_transmission)) return;
  double strength = static_cast<double>(passing->strength);
  if (passing->strength_texture.texture != kNone)
    strength *= static_cast<double>(color_at(frame, passing->strength_texture, *s).alpha);
  s->passing = to_double(passing->color) * strength;
  if (passing->color_texture.texture != kNone) s->passing *= to_double(color_at(frame, passing->color_texture, *s).rgb);
  s->diffuse = s->diffuse * (1 - strength);
  const double normal = max_component(s->specular + s->mirror);
  if (!(normal > 0)) return;
  const double away = 1 - std::fmax(0, -dot(s->normal, normalize(direction)));
  s->passing = s->passing * std::fmax(0, (1 - normal) * (1 - away * away * away * away * away));
}

// KHR_materials_sheen. The base's specular part is not attenuated here, but by ReferenceSurface::passes.
void put_sheen_on(const FrameData& frame, const Vec3d& direction, ReferenceSurface* s) {
  s->sheen = {0, 0, 0}, s->even = s->diffuse, s->passes = 1;
  const Sheen* sheen = sheen_of(*frame.scene, frame.scene->triangles[s->triangle].material());
  if (!sheen || !has(frame.mask, Effect::sheen)) return;
  s->sheen = to_double(sheen->color), s->sheen_roughness = static_cast<double>(sheen->roughness);
  if (sheen->color_texture.texture != kNone) s->sheen *= to_double(color_at(frame, sheen->color_texture, *s).rgb);
  if (sheen->roughness_texture.texture != kNone)
    s->sheen_roughness *= static_cast<double>(color_at(frame, sheen->roughness_texture, *s).alpha);
  s->sheen_roughness = std::fmax(s->sheen_roughness, static_cast<double>(sheen->roughness_low));
  const double albedo = sheen_albedo(s->sheen_roughness, dot(s->normal, normalize(direction)));
  s->passes = 1 - max_component(s->sheen) * albedo;
  s->diffuse = s->diffuse * s->passes, s->mirror = s->mirror * s->passes, s->emission = s->emission * s->passes;
  s->even = s->diffuse + s->sheen * albedo;
  s->passing = s->passing * s->passes;
}

// KHR_materials_clearcoat; `unmapped` is the normal at the vertices.
void put_coat_on(const FrameData& frame, const Vec3d* corner, const Vec3d& direction, const Vec3d& unmapped,
                 ReferenceSurface* s) {
  s->coat_lobe = s->coat_mirror = 0, s->coat_normal = unmapped;
  const ClearCoat* coat = coat_of(*frame.scene, frame.scene->triangles[s->triangle].material());
  if (!coat || !has(frame.mask, Effect::clear_coat)) return;
  auto texel = [&](const TextureUse& use, int channel) {
    return use.texture == kNone ? 1 : numbers_at(frame, use, *s)[channel] / 255;
  };
  const double strength = static_cast<double>(coat->strength) * texel(coat->strength_texture, 0);
  const double roughness = std::fmax(static_cast<double>(coat->roughness) * texel(coat->roughness_texture, 1),
                                     static_cast<double>(coat->roughness_low));
  if (coat->normal.texture != kNone && has(frame.mask, Effect::normal_map)) {
    ReferenceSurface bare = *s;
    bare.normal = unmapped;
    s->coat_normal = normal_of_map(frame, coat->normal, coat->normal_scale, corner, direction, bare);
  }
  const double fresnel = coat_fresnel(dot(s->coat_normal, normalize(direction)));
  const double passes = 1 - strength * fresnel;
  s->coat = coat_lobe(static_cast<float>(roughness));
  if (has(frame.mask, Effect::specular) && !is_zero(s->coat.specular)) s->coat_lobe = strength;
  if (has(frame.mask, Effect::mirror)) s->coat_mirror = strength * fresnel * coat_mirror_share(roughness);
  s->diffuse = s->diffuse * passes, s->mirror = s->mirror * passes, s->emission = s->emission * passes;
  s->sheen = s->sheen * passes, s->even = s->even * passes, s->passing = s->passing * passes;
  s->passes *= passes;
}

// KHR_materials_anisotropy.
Vec3d grain_of(const FrameData& frame, const Grain& grain, const Vec3d* corner, const ReferenceSurface& s) {
  double x = static_cast<double>(grain.direction.x), y = static_cast<double>(grain.direction.y);
  Vec3d tangent, bitangent;
  if ((x == 0 && y == 0) || !map_frame(frame, corner, s, &tangent, &bitangent)) return {0, 0, 0};
  if (grain.texture.texture != kNone) {
    const Vec3d numbers = numbers_at(frame, grain.texture, s);
    const double cosine = numbers.x / 127.5 - 1, sine = numbers.y / 127.5 - 1,
                 size = std::sqrt(cosine * cosine + sine * sine);
    const double weight = size > 0 ? numbers.z / 255 / size : 0, turned = (x * cosine - y * sine) * weight;
    y = (x * sine + y * cosine) * weight, x = turned;
  }
  return tangent * x + bitangent * y;
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
    corner[i] = to_double(frame.geometry.positions[t.vertex(i)]);
    s.point += corner[i] * weight[i];
    for (int axis = 0; axis < 3; ++axis) s.magnitude = std::fmax(s.magnitude, std::fabs(corner[i][axis]));
    if (frame.geometry.normals.count) normal += to_double(frame.geometry.normals[t.vertex(i)]) * weight[i];
  }
  Vec3d outward = normalize(cross(corner[1] - corner[0], corner[2] - corner[0]));
  s.front = dot(outward, direction) <= 0;
  s.geometric = s.front ? outward : -outward;
  normal = frame.settings.normals == NormalMode::flat ? Vec3d{0, 0, 0} : normalize(normal);
  s.normal = is_zero(normal) ? s.geometric : dot(normal, s.geometric) < 0 ? -normal : normal;
  const Material& m = *s.material;
  auto texel = [&](const TextureUse& use) {
    return use.texture == kNone ? Vec3d{1, 1, 1} : to_double(color_at(frame, use, s).rgb);
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
  s.transmission = has(frame.mask, Effect::refraction) ? to_double(m.transmission) : Vec3d{0, 0, 0};
  s.is_mapped = false, s.open = 1;
  const Vec3d unmapped = s.normal;
  if (scene.material_maps.count) {
    const MaterialMaps& maps = scene.material_maps[t.material()];
    if (has(frame.mask, Effect::normal_map) && maps.normal.texture != kNone)
      s.normal = normal_of_map(frame, maps.normal, maps.normal_scale, corner, direction, s);
    if (has(frame.mask, Effect::occlusion) && maps.occlusion.texture != kNone) {
      const double red = numbers_at(frame, maps.occlusion, s).x;
      s.open = 1 - static_cast<double>(maps.occlusion_strength) * (1 - red / 255);
    }
    const GlassMap* glass = has(frame.mask, Effect::transmission_map) ? glass_map_of(scene, t.material()) : nullptr;
    if (glass || (has(frame.mask, Effect::metallic_roughness) && has_lobe_map(maps)))
      apply_maps(frame, maps, glass, tint, &s);
  }
  if (leaves_body(s) && has(frame.mask, Effect::rough_refraction) && is_rough_glass(m)) {
    if (!s.is_mapped) s.mapped = m, s.is_mapped = true;
    s.specular = {0, 0, 0}, s.mapped.specular = {0, 0, 0}, s.mapped.grazing = 0;
  }
  put_film_on(frame, direction, &s);
  s.grain = {0, 0, 0};
  if (has(frame.mask, Effect::anisotropy) && scene.grains.count)
    s.grain = grain_of(frame, scene.grains[t.material()], corner, s);
  s.emission = {0, 0, 0};
  if (!is_zero(m.emission) && (s.front || m.double_sided))
    s.emission = to_double(m.emission) * texel(m.emission_texture);
  put_passing_on(frame, direction, &s);
  put_sheen_on(frame, direction, &s);
  put_coat_on(frame, corner, direction, unmapped, &s);
  return s;
}

ReferenceSurface other_side(const ReferenceSurface& s) {
  ReferenceSurface other = s;
  other.front = !s.front, other.normal = -s.normal, other.geometric = -s.geometric;
  other.diffuse = other.even = s.passing;
  other.passing = other.specular = other.mirror = other.emission = other.transmission = other.sheen = {0, 0, 0};
  other.mapped = Material(), other.is_mapped = true, other.mapped.specular = {0, 0, 0};
  other.film_strength = other.coat_lobe = other.coat_mirror = 0, other.passes = other.open = 1;
  return other;
}

bool scatters_passing_light(const FrameData& frame, const ReferenceSurface& s) {
  return has(frame.mask, Effect::rough_refraction) && is_rough_glass(*s.material) && lobes_of(s).roughness > kAlphaMin;
}

ReferenceRay leave(const FrameData& frame, const ReferenceSurface& s, const Vec3d& direction, double t_max) {
  Vec3d origin = s.point;
  if (frame.geometry.normals.count && !(dot(direction, s.geometric) > 0) && dot(direction, s.normal) > 0) {
    const Triangle& t = frame.scene->triangles[s.triangle];
    double weight[3] = {1 - s.u - s.v, s.u, s.v};
    for (std::uint32_t i = 0; i < 3; ++i) {
      Vec3d n = to_double(frame.geometry.normals[t.vertex(i)]);
      if (dot(n, s.normal) < 0) n = -n;
      double below = dot(s.point - to_double(frame.geometry.positions[t.vertex(i)]), n);
      if (below < 0) origin += n * (-below * weight[i]);
    }
    // Where the curved surface does not rise above the triangle, the ray meets the triangle itself.
    if (origin == s.point) origin += s.geometric * (4 * kOwnSurface * s.magnitude);
  }
  return {origin, direction, kOwnSurface * s.magnitude / length(direction), t_max};
}

Vec3d reflected_surroundings(const FrameData& frame, const ReferenceSurface& s, const Vec3d& to_viewer) {
  if (environment_lights(*frame.scene, frame.mask, frame.settings.indirect)) return {0, 0, 0};
  if (!has(frame.mask, Effect::ambient_gloss) || has(frame.mask, Effect::radiosity)) return {0, 0, 0};
  const Vec3 radiance = radiance_of_surroundings(frame.scene->info);
  Vec3d by_coat = {0, 0, 0};
  if (s.coat_lobe > 0) {
    const float cosine = static_cast<float>(dot(s.coat_normal, to_viewer));
    const Vec3 light = reflected_surroundings(radiance, s.coat, s.coat.specular, cosine);
    by_coat = to_double(light) * (s.coat_lobe * s.open);
  }
  if (!reflects_surroundings(lobes_of(s))) return by_coat;
  const Vec3 specular = to_float(s.specular);
  const float cosine = static_cast<float>(dot(s.normal, to_viewer));
  const Material m = is_zero(s.grain) ? lobes_of(s) : evened(lobes_of(s), {to_float(s.normal), to_float(s.grain)});
  return by_coat + s.open * s.passes * to_double(reflected_surroundings(radiance, m, specular, cosine));
}

Vec3d coat_value(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light) {
  const double cosine = dot(s.normal, to_light), at_coat = dot(s.coat_normal, to_light);
  if (!(s.coat_lobe > 0) || !(cosine > 0) || !(at_coat > 0)) return {0, 0, 0};
  return kBrdfList[s.coat.brdf]->exact_value(s.coat, to_double(s.coat.specular), {0, 0, 0}, coat_frame(s), to_viewer,
                                             to_light) *
         (s.coat_lobe * at_coat / cosine);
}

Vec3d sheen_value(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light) {
  if (is_zero(s.sheen)) return {0, 0, 0};
  return s.sheen * sheen_value(s.sheen_roughness, s.normal, to_viewer, to_light);
}

double lobe_weight(const ReferenceSurface& s, const Vec3d& to_viewer) {
  return max_component(s.diffuse) + max_component(s.sheen) + glossy_weight(s) + coat_weight(s, to_viewer);
}

Vec3d lobe_value(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light) {
  Vec3d value = s.diffuse * (1 / kPi);
  if (!is_zero(lobes_of(s).specular) && s.passes > 0)
    value = glossy_lobe(s).exact_value(lobes_of(s), s.specular, value / s.passes, s, to_viewer, to_light) * s.passes;
  return value + sheen_value(s, to_viewer, to_light) + coat_value(s, to_viewer, to_light);
}

double lobe_density(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light) {
  const double cosine = dot(s.normal, to_light);
  const LobeShares share = lobe_shares(s, to_viewer);
  if (!(cosine > 0) || !(lobe_weight(s, to_viewer) > 0)) return 0;
  double density = (1 - share.glossy - share.coat) * cosine / kPi;
  if (share.glossy > 0) density += share.glossy * glossy_lobe(s).density(lobes_of(s), s, to_viewer, to_light);
  if (share.coat > 0)
    density += share.coat * kBrdfList[s.coat.brdf]->density(s.coat, coat_frame(s), to_viewer, to_light);
  return density;
}

bool sample_lobes(const ReferenceSurface& s, const Vec3d& to_viewer, double choice, const Pair& pair,
                  Vec3d* direction) {
  const LobeShares share = lobe_shares(s, to_viewer);
  if (!(lobe_weight(s, to_viewer) > 0)) return false;
  if (choice < share.glossy)
    *direction = glossy_lobe(s).sample(lobes_of(s), s, to_viewer, pair.u, pair.v);
  else if (choice < share.glossy + share.coat)
    *direction = kBrdfList[s.coat.brdf]->sample(s.coat, coat_frame(s), to_viewer, pair.u, pair.v);
  else
    *direction = power_cosine_direction(s.normal, 1, pair.u, pair.v);
  return dot(*direction, s.normal) > 0;
}

}  // namespace pocketray
