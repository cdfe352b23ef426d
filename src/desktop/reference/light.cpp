#include "desktop/reference/light.h"

#include <algorithm>
#include <limits>

#include "base/check.h"
#include "base/fmath.h"
#include "desktop/reference/environment.h"
#include "desktop/reference/guide.h"
#include "shade/form_factor.h"
#include "shade/lights.h"
#include "shade/polygon_light.h"
#include "shade/polygon_share.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Transmittance of one contact at a distance, without refraction; adds bodies that begin or end to the absorption.
Vec3d contact_transmittance(const FrameData& frame, const ReferenceContact& contact, const ReferenceRay& ray,
                            double distance, Vec3d* absorbed, Vec3d* open) {
  Vec3d result = {1, 1, 1};
  double from = 1, to = 1;
  bool any = false;
  for (std::uint32_t i = 0; i < contact.count; ++i) {
    const ReferenceHit& face = contact.face[i];
    const Material& m = material_of(frame, face.triangle);
    if (m.alpha_mode == AlphaMode::blend) result = result * (1 - alpha_of(frame, face));
    if (is_zero(m.transmission)) continue;
    any = true;
    bool enters = contact.front[i];
    if (enters || m.thin) result *= transmission_of(frame, face, ray.direction);
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

// Samples a light of the frame at a point: direction, distance, and irradiance on a surface facing it.
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
  if (light.material != kNone) {
    double cosine = -dot(*direction, to_double(light.direction));
    if (light.two_sided) cosine = std::fabs(cosine);
    if (!(cosine > 0)) return false;
    factor *= cosine;
  }
  *irradiance = to_double(light.intensity) * factor;
  return true;
}

Vec3d area_light(const Reference& reference, const ReferenceOptions& options, const ReferenceSurface& s,
                 const Vec3d& to_viewer, bool goes_on, ReferenceSamples* samples) {
  const FrameData& frame = *reference.world.frame;
  if (reference.emitters.empty()) return {0, 0, 0};
  ReferencePlace place = pick_place(frame, reference.emitters, samples->light());
  std::uint32_t triangle = place.triangle;
  bool model = options.transport == Transport::model;
  const bool own = &material_of(frame, triangle) == s.material;
  if (model && own && has_stored_light(frame)) return {0, 0, 0};  // stored light includes it
  Vec3d to_light = place.point - s.point;
  double distance = length(to_light);
  if (!(distance > 0) || triangle == s.triangle) return {0, 0, 0};
  Vec3d direction = to_light / distance;
  double cosine = dot(s.normal, direction);
  ReferenceSurface light = reference_surface(frame, {distance, place.u, place.v, triangle}, direction);
  double cos_light = -dot(light.geometric, direction);
  if (!(cosine > 0) || !(cos_light > 0) || is_zero(light.emission)) return {0, 0, 0};
  double density = emitter_density(reference, triangle) * distance * distance / cos_light;
  double weight = model || !goes_on ? 1 : power_heuristic(density, guided_density(s, to_viewer, direction));
  // In the model, a coat over a lamp does not dim its light on other surfaces.
  const Vec3d sent = model && light.passes > 0 ? light.emission / light.passes : light.emission;
  Vec3d sum = lobe_value(s, to_viewer, direction) * sent * (cosine * weight / density);
  if (is_zero(sum)) return sum;
  ReferenceRay ray = leave(frame, s, direction, distance * (1 - 0x1p-40));
  return sum * transmittance(reference.world, ray, {triangle, nullptr, !model});
}

}  // namespace

Vec3d transmittance(const ReferenceWorld& world, const ReferenceRay& ray, const ShadowRules& rules) {
  Obstacle obstacle = find_obstacle(world, ray, rules);
  if (obstacle == Obstacle::opaque) return {0, 0, 0};
  if (obstacle == Obstacle::none) return {1, 1, 1};
  const FrameData& frame = *world.frame;
  Vec3d result = {1, 1, 1}, absorbed = {0, 0, 0}, open = {0, 0, 0};
  ReferenceHit hit = next_hit(world, ray, nullptr), after;
  for (; hit.triangle != kNone; hit = next_hit(world, ray, &after)) {
    after = hit;
    if (!casts_shadow(frame, hit.triangle, rules)) continue;
    ReferenceContact contact = gather_contact(world, ray, hit);
    for (std::uint32_t i = 0; i < contact.count; ++i) {  // including faces within rounding behind the light
      std::uint32_t triangle = contact.face[i].triangle;
      if (casts_shadow(frame, triangle, rules) && blocks(material_of(frame, triangle), rules)) return {0, 0, 0};
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

namespace {

bool is_own(const FrameData& frame, const ReferenceSurface& s, const LightPoint& light) {
  return light.material != kNone && &frame.scene->materials[light.material] == s.material;
}

// One light's radiance towards the viewer; returns false if it contributes nothing. `weight` is the irradiance times
// the cosine.
struct ReferenceLight {
  Vec3d direction, sent;  // unblocked
  double distance, weight;
};
bool find_light(const FrameData& frame, const LightRun& run, std::uint32_t i, const ReferenceSurface& s,
                const Vec3d& to_viewer, ReferenceLight* found) {
  Vec3d irradiance;
  if (!reach(frame.lights.points[i], run.sample, s.point, &found->direction, &found->distance, &irradiance))
    return false;
  const double cosine = dot(s.normal, found->direction);
  if (!(cosine > 0)) return false;
  if (is_own(frame, s, frame.lights.points[i]))
    for (int c = 0; c < 3; ++c)
      irradiance[c] = std::min(irradiance[c], kPi * static_cast<double>(s.material->emission[c]));
  found->weight = max_component(irradiance) * cosine;
  found->sent = lobe_value(s, to_viewer, found->direction) * irradiance * cosine;
  return true;
}
Vec3d arriving(const Reference& reference, const ReferenceSurface& s, std::uint32_t i, const ReferenceLight& light) {
  const FrameData& frame = *reference.world.frame;
  if (is_zero(light.sent)) return light.sent;
  return light.sent *
         transmittance(reference.world, leave(frame, s, light.direction, light.distance),
                       {kNone, frame.lights.points[i].material != kNone ? &frame.lights.points[i] : nullptr, false});
}

// A flat lamp as in polygon_light.h, and the fraction of its light that a surface gets as it sets.
struct ReferenceLamp {
  double irradiance = 0;  // brightest channel
  double highest = 0;     // highest corner; 0: none is below the horizon
};
// Returns false if it is too far away.
bool view_lamp(const LightPolygon& polygon, const ReferenceSurface& s, ReferenceLamp* lamp) {
  Vec3d corners[kLightCornerMax], clipped[2 * kLightCornerMax];
  double lowest = kInfinity, highest = -kInfinity;
  for (std::uint32_t i = 0; i < polygon.corner_count; ++i) {
    corners[i] = to_double(polygon.corners[i]) - s.point;
    const double height = dot(corners[i], s.normal);
    lowest = std::min(lowest, height), highest = std::max(highest, height);
  }
  if (!(length(corners[0]) * static_cast<double>(polygon.scale) <= static_cast<double>(kPolygonNear))) return false;
  double front = -dot(corners[0], to_double(polygon.normal)), side = 1;
  if (front < 0 && polygon.two_sided) front = -front, side = -1;
  if (!(front > 0 && highest > 0)) return true;
  const std::uint32_t count = clip_to_horizon(corners, polygon.corner_count, s.normal, clipped);
  const double factor = side * form_factor_above_horizon(clipped, count, s.normal);
  lamp->irradiance = factor > 0 ? static_cast<double>(max_component(polygon.radiance)) * kPi * factor : 0;
  if (lowest < 0) lamp->highest = highest;
  return true;
}

// The glossy lobe of a surface in two parts, and the light reflected by the sharp one.
struct ReferenceGloss {
  const LinearForm* form = nullptr;  // null: it is not divided
  LobePartsD parts = {};
  Vec3d sent = {0, 0, 0};  // unblocked
};
ReferenceGloss find_gloss(const LightPolygon& polygon, const ReferenceSurface& s, const Vec3d& to_viewer) {
  ReferenceGloss gloss;
  if (is_zero(lobes_of(s).specular) || s.passes < 1) return gloss;
  const LinearForm* form = glossy_lobe(s).linear;
  const Vec3d diffuse = s.diffuse * (1 / kPi);
  if (!form || !form->divide_exactly(lobes_of(s), s.specular, diffuse, s, to_viewer, &gloss.parts)) return gloss;
  Vec3d corners[kLightCornerMax];
  for (std::uint32_t i = 0; i < polygon.corner_count; ++i)
    corners[i] = (to_double(polygon.corners[i]) - s.point) * static_cast<double>(polygon.scale);
  gloss.form = form;
  gloss.sent = gloss.parts.albedo * to_double(polygon.radiance) *
               linear_share(gloss.parts, form->power, corners, polygon.corner_count, s.normal);
  return gloss;
}

// Light of a lamp's points, weighted so that without shadows they sum to the polygon's light.
Vec3d sum_lamp(const Reference& reference, const ReferenceSurface& s, const Vec3d& to_viewer, const LightRun& run,
               std::uint32_t first, const ReferenceLamp& lamp) {
  const FrameData& frame = *reference.world.frame;
  const LightPolygon& polygon = run.polygons[(first - run.begin) / frame.settings.points_per_area_light];
  const ReferenceGloss gloss = find_gloss(polygon, s, to_viewer);
  const Vec3d radiance = to_double(polygon.radiance), color = radiance / max_component(radiance);
  Vec3d sum = {0, 0, 0}, glossy = {0, 0, 0};
  double all = 0, all_glossy = 0, highest = 0;
  for (std::uint32_t i = first; i < first + frame.settings.points_per_area_light; ++i) {
    ReferenceLight light;
    if (!find_light(frame, run, i, s, to_viewer, &light)) continue;
    all += light.weight;
    highest = std::max(highest, dot(s.normal, light.direction) * light.distance);
    if (!gloss.form) {
      sum += arriving(reference, s, i, light);
      continue;
    }
    const Vec3d& d = light.direction;
    const double cosine = dot(s.normal, d);
    const Vec3d rest = gloss.form->exact_rest ? gloss.form->exact_rest(gloss.parts, cosine) : gloss.parts.diffuse;
    const Vec3d local = {dot(gloss.parts.x, d), dot(gloss.parts.y, d), dot(gloss.parts.z, d)};
    const double square = dot(local, local), fourth = square * square;
    const double share = light.weight / (cosine * (gloss.form->power > 1 ? fourth * fourth * fourth : fourth));
    light.sent = {1, 1, 1};
    const Vec3d visibility = arriving(reference, s, i, light);
    all_glossy += share, glossy += visibility * share;
    sum += rest * visibility * light.weight;
  }
  if (!(all > 0)) return {0, 0, 0};
  sum = sum * (lamp.irradiance / all);
  if (gloss.form) sum = sum * color + glossy * gloss.sent * (1 / all_glossy);
  return sum * (lamp.highest > 3 * highest ? 3 * highest / lamp.highest : 1);
}

}  // namespace

Vec3d sum_light_points(const Reference& reference, const ReferenceSurface& s, const Vec3d& to_viewer,
                       bool with_area_lights, bool with_shown_sun) {
  const FrameData& frame = *reference.world.frame;
  Vec3d sum = {0, 0, 0};
  for (int r = 0; r < frame.lights.run_count; ++r) {
    const LightRun& run = frame.lights.runs[r];
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      const LightPoint& light = frame.lights.points[i];
      const bool is_area = light.material != kNone;
      if (is_area && !with_area_lights) continue;
      if (!with_shown_sun && i >= frame.lights.sun_begin && i < frame.lights.sun_end) continue;
      // A piece of an emitter does not light itself; stored light includes that of its own material.
      if (is_area && is_own(frame, s, light) && (has_stored_light(frame) || is_of_piece(frame, s.triangle, light)))
        continue;
      if (run.polygons) {
        const std::uint32_t points = frame.settings.points_per_area_light;
        const LightPolygon& polygon = run.polygons[(i - run.begin) / points];
        ReferenceLamp lamp;
        if (polygon.corner_count && view_lamp(polygon, s, &lamp)) {
          if (lamp.irradiance > 0) sum += sum_lamp(reference, s, to_viewer, run, i, lamp);
          i += points - 1;
          continue;
        }
      }
      ReferenceLight found;
      if (find_light(frame, run, i, s, to_viewer, &found)) sum += arriving(reference, s, i, found);
    }
  }
  return sum;
}

double emitted_power(const Material& m) { return m.unlit ? 0 : static_cast<double>(max_component(m.emission)); }

std::uint32_t find_parts(const FrameData& frame, double (*power)(const Material& material), ReferenceEmitter* parts) {
  std::uint32_t count = 0;
  double total = 0;
  for (std::uint32_t i = 0; i < frame.scene->triangles.count; ++i) {
    double density = power(material_of(frame, i));
    if (!(density > 0)) continue;
    double area = 0.5 * length(area_vector(frame, i));
    if (!(area * density > 0)) continue;
    total += area * density;
    parts[count++] = {i, total, area};
  }
  for (std::uint32_t i = 0; i < count; ++i) parts[i].share_end /= total;
  CHECK(count == 0 || parts[count - 1].share_end == 1);
  return count;
}

ReferencePlace pick_place(const FrameData& frame, const Array<ReferenceEmitter>& parts, const Pair& pair) {
  std::uint32_t low = 0, high = parts.count - 1;
  while (low < high) {
    std::uint32_t middle = low + (high - low) / 2;
    if (pair.u < parts[middle].share_end)
      high = middle;
    else
      low = middle + 1;
  }
  ReferencePlace place;
  place.triangle = parts[low].triangle;
  double before = low > 0 ? parts[low - 1].share_end : 0;  // position within the picked triangle
  double root = std::sqrt((pair.u - before) / (parts[low].share_end - before));
  place.v = pair.v * root, place.u = root - place.v;
  place.point = corner_of(frame, place.triangle, 0) * (1 - place.u - place.v) +
                corner_of(frame, place.triangle, 1) * place.u + corner_of(frame, place.triangle, 2) * place.v;
  return place;
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
                          const Vec3d& to_viewer, bool goes_on, ReferenceSamples* samples) {
  const bool samples_sun = options.transport == Transport::physical && !reference.environment_shares.empty();
  return sum_light_points(reference, s, to_viewer, false, !samples_sun) +
         area_light(reference, options, s, to_viewer, goes_on, samples) +
         environment_light(reference, options, s, to_viewer, goes_on, samples);
}

}  // namespace pocketray
