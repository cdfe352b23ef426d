#include "shade/reference_light.h"

#include <limits>

#include "base/fmath.h"
#include "shade/lights.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTogether = 0x1p-40;  // of coordinates: faces so near lie on one another

const Material& material_of(const FrameData& frame, std::uint32_t triangle) {
  return frame.scene->materials[frame.scene->triangles[triangle].material()];
}

Vec3d corner(const FrameData& frame, std::uint32_t triangle, std::uint32_t i) {
  return to_double(frame.positions[frame.scene->triangles[triangle].vertex(i)]);
}
Vec3d area_vector(const FrameData& frame, std::uint32_t triangle) {
  Vec3d a = corner(frame, triangle, 0);
  return cross(corner(frame, triangle, 1) - a, corner(frame, triangle, 2) - a) * 0.5;
}

struct Visibility {
  const Reference* reference;
  bool bent;               // transparent bodies block: light through them is found by the paths that are bent
  std::uint32_t material;  // that casts no shadow: the light's own; or kNone
  std::uint32_t triangle;  // likewise
};

// What one contact lets through, unbent, at a distance; adds what it begins or ends to the absorption.
Vec3d contact_transmittance(const FrameData& frame, const ReferenceContact& contact, const ReferenceRay& ray,
                            double distance, Vec3d* absorbed, Vec3d* open) {
  Vec3d result = {1, 1, 1};
  double from = 1, to = 1;
  bool any = false;
  for (std::uint32_t i = 0; i < contact.count; ++i) {
    const ReferenceHit& face = contact.face[i];
    const Material& m = material_of(frame, face.triangle);
    if (m.alpha_mode == AlphaMode::blend)
      result = result * (1 - static_cast<double>(hit_alpha(*frame.scene, m, face.triangle, static_cast<float>(face.u),
                                                           static_cast<float>(face.v), frame.settings.texture_filter)));
    if (is_zero(m.transmission)) continue;
    any = true;
    bool enters = contact.front[i];
    if (enters || m.thin) result *= to_double(m.transmission);
    (enters || m.thin ? to : from) = static_cast<double>(m.ior);
    if (m.thin) continue;
    Vec3d absorption = to_double(m.absorption);
    *absorbed += absorption * (enters ? -distance : distance);
    *open += absorption * (enters ? 1.0 : -1.0);
  }
  if (!any) return result;
  ReferenceSurface s = reference_surface(frame, contact.face[0], ray.direction);
  double cosine = std::fabs(dot(s.normal, ray.direction)) / length(ray.direction);
  double cos_t;
  return result * (1 - boundary_reflectance(cosine, from / to, &cos_t));
}

Vec3d transmittance(const Visibility& v, const ReferenceRay& ray) {
  const FrameData& frame = *v.reference->world.frame;
  Vec3d result = {1, 1, 1}, absorbed = {0, 0, 0}, open = {0, 0, 0};
  ReferenceHit after;
  const ReferenceHit* behind = nullptr;
  for (;;) {
    ReferenceHit hit = next_hit(v.reference->world, ray, behind);
    if (hit.triangle == kNone) break;
    after = hit, behind = &after;
    const Material& m = material_of(frame, hit.triangle);
    if (hit.triangle == v.triangle || frame.scene->triangles[hit.triangle].material() == v.material) continue;
    bool blends = m.alpha_mode == AlphaMode::blend, transmits = !is_zero(m.transmission);
    if ((!blends && !transmits) || (transmits && v.bent)) return {0, 0, 0};
    ReferenceContact contact = gather_contact(v.reference->world, ray, hit);
    for (std::uint32_t i = 0; i < contact.count; ++i) {
      const Material& face = material_of(frame, contact.face[i].triangle);
      bool is_light = contact.face[i].triangle == v.triangle ||
                      frame.scene->triangles[contact.face[i].triangle].material() == v.material;
      if (!is_light && face.alpha_mode != AlphaMode::blend && (is_zero(face.transmission) || v.bent)) return {0, 0, 0};
    }
    result *= contact_transmittance(frame, contact, ray, hit.t * length(ray.direction), &absorbed, &open);
    if (is_zero(result)) return result;
    after = contact.last;
  }
  for (int c = 0; c < 3; ++c) {
    double depth = absorbed[c] + (open[c] > 0 ? open[c] * ray.t_max * length(ray.direction) : 0);
    if (depth > 0) result[c] *= det_exp(-depth);
  }
  return result;
}

// A point, spot or directional light at a point: the way to it, its distance and its irradiance on what faces it.
bool reach(const LightPoint& light, LightSampler kind, const Vec3d& point, Vec3d* direction, double* distance,
           Vec3d* irradiance) {
  if (kind == find_light_sampler(Effect::directional_light)) {
    *direction = -normalize(to_double(light.direction));
    *distance = kInfinity, *irradiance = to_double(light.intensity);
    return true;
  }
  Vec3d to_light = to_double(light.position) - point;
  double square = dot(to_light, to_light), factor = 1 / square, range = static_cast<double>(light.range);
  if (!(square > 0)) return false;
  *distance = std::sqrt(square), *direction = to_light / *distance;
  if (range > 0) {
    double q = square / (range * range), window = 1 - q * q;
    if (!(window > 0)) return false;
    factor *= window;
  }
  if (kind == find_light_sampler(Effect::spot_light)) {
    double cosine = -dot(*direction, to_double(light.direction));
    double inner = static_cast<double>(light.cos_inner), outer = static_cast<double>(light.cos_outer);
    if (cosine <= outer) return false;
    double f = cosine >= inner ? 1 : (cosine - outer) / (inner - outer);
    factor *= f * f;
  }
  *irradiance = to_double(light.intensity) * factor;
  return true;
}

Vec3d punctual_light(const Reference& reference, const ReferenceSurface& s, const Vec3d& to_viewer) {
  const FrameData& frame = *reference.world.frame;
  Vec3d sum = {0, 0, 0};
  for (int r = 0; r < frame.light_run_count; ++r)
    for (std::uint32_t i = frame.light_runs[r].begin; i < frame.light_runs[r].end; ++i) {
      Vec3d direction, irradiance;
      double distance;
      if (frame.lights[i].material != kNone) continue;  // a point of an area light
      if (!reach(frame.lights[i], frame.light_runs[r].sample, s.point, &direction, &distance, &irradiance)) continue;
      double cosine = dot(s.normal, direction);
      if (!(cosine > 0)) continue;
      Vec3d light = lobe_value(s, to_viewer, direction) * irradiance * cosine;
      if (is_zero(light)) continue;
      sum += light * transmittance({&reference, false, kNone, kNone}, leave(frame, s, direction, distance));
    }
  return sum;
}

Vec3d area_light(const Reference& reference, const ReferenceOptions& options, const ReferenceSurface& s,
                 const Vec3d& to_viewer, Rng* rng) {
  const FrameData& frame = *reference.world.frame;
  if (reference.emitters.empty()) return {0, 0, 0};
  double pick = next_double(rng), root = std::sqrt(next_double(rng)), v = next_double(rng) * root, u = root - v;
  std::uint32_t low = 0, high = reference.emitters.count - 1;
  while (low < high) {
    std::uint32_t middle = low + (high - low) / 2;
    if (pick < reference.emitters[middle].share_end)
      high = middle;
    else
      low = middle + 1;
  }
  std::uint32_t triangle = reference.emitters[low].triangle;
  bool model = options.transport == Transport::model;
  std::uint32_t material = frame.scene->triangles[triangle].material();
  if (model && &frame.scene->materials[material] == s.material) return {0, 0, 0};  // an emitter does not light itself
  Vec3d point =
      corner(frame, triangle, 0) * (1 - u - v) + corner(frame, triangle, 1) * u + corner(frame, triangle, 2) * v;
  Vec3d to_light = point - s.point;
  double distance = length(to_light);
  if (!(distance > 0) || triangle == s.triangle) return {0, 0, 0};
  Vec3d direction = to_light / distance;
  double cosine = dot(s.normal, direction);
  ReferenceSurface light = reference_surface(frame, {distance, u, v, triangle}, direction);
  double cos_light = -dot(light.geometric, direction);
  if (!(cosine > 0) || !(cos_light > 0) || is_zero(light.emission)) return {0, 0, 0};
  double density = emitter_density(reference, triangle) * distance * distance / cos_light;
  double weight = model ? 1 : power_heuristic(density, lobe_density(s, to_viewer, direction));
  Vec3d sum = lobe_value(s, to_viewer, direction) * light.emission * (cosine * weight / density);
  if (is_zero(sum)) return sum;
  Visibility visibility = {&reference, !model, model ? material : kNone, triangle};
  return sum * transmittance(visibility, leave(frame, s, direction, distance * (1 - 0x1p-40)));
}

}  // namespace

double boundary_reflectance(double cos_i, double eta, double* cos_t) {
  *cos_t = 0;
  if (cos_i > 1) cos_i = 1;
  double sin2_t = eta * eta * ((1 - cos_i) * (1 + cos_i));
  if (!(sin2_t < 1)) return 1;
  *cos_t = std::sqrt(1 - sin2_t);
  if (eta == 1) return 0;
  double s = (eta * cos_i - *cos_t) / (eta * cos_i + *cos_t), p = (cos_i - eta * *cos_t) / (cos_i + eta * *cos_t);
  return 0.5 * (s * s + p * p);
}

ReferenceContact gather_contact(const ReferenceWorld& world, const ReferenceRay& ray, const ReferenceHit& first) {
  const FrameData& frame = *world.frame;
  ReferenceContact contact;
  contact.count = 0;
  double magnitude = 0;
  for (std::uint32_t i = 0; i < 3; ++i) {
    Vec3d p = corner(frame, first.triangle, i);
    for (int axis = 0; axis < 3; ++axis) magnitude = std::fmax(magnitude, std::fabs(p[axis]));
  }
  double end = first.t + kTogether * magnitude / length(ray.direction);
  for (ReferenceHit hit = first; hit.t <= end; hit = next_hit(world, ray, &contact.last)) {
    bool front = dot(area_vector(frame, hit.triangle), ray.direction) <= 0, known = false;
    std::uint32_t material = frame.scene->triangles[hit.triangle].material();
    for (std::uint32_t i = 0; i < contact.count; ++i)
      known = known ||
              (contact.front[i] == front && frame.scene->triangles[contact.face[i].triangle].material() == material);
    if (!known && contact.count < kMediumDepthMax) {
      contact.face[contact.count] = hit;
      contact.front[contact.count++] = front;
    }
    contact.last = hit;
  }
  return contact;
}

std::uint32_t find_emitters(const FrameData& frame, ReferenceEmitter* emitters) {
  std::uint32_t count = 0;
  double total = 0;
  for (std::uint32_t i = 0; i < frame.scene->triangles.count; ++i) {
    const Material& m = material_of(frame, i);
    double area = length(area_vector(frame, i)), power = area * static_cast<double>(max_component(m.emission));
    if (!(power > 0) || m.unlit) continue;
    total += power;
    emitters[count++] = {i, total, area};
  }
  for (std::uint32_t i = 0; i < count; ++i) emitters[i].share_end /= total;
  return count;
}

double emitter_density(const Reference& reference, std::uint32_t triangle) {
  std::uint32_t low = 0, high = reference.emitters.count;
  while (low < high) {
    std::uint32_t middle = low + (high - low) / 2;
    if (reference.emitters[middle].triangle < triangle)
      low = middle + 1;
    else
      high = middle;
  }
  if (low == reference.emitters.count || reference.emitters[low].triangle != triangle) return 0;
  double before = low > 0 ? reference.emitters[low - 1].share_end : 0;
  return (reference.emitters[low].share_end - before) / reference.emitters[low].area;
}

Vec3d sample_direct_light(const Reference& reference, const ReferenceOptions& options, const ReferenceSurface& s,
                          const Vec3d& to_viewer, Rng* rng) {
  return punctual_light(reference, s, to_viewer) + area_light(reference, options, s, to_viewer, rng);
}

}  // namespace pocketray
