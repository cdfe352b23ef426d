// Light of flat lamps: in closed form where nothing is in the way, times the visible fraction of their points.
#pragma once
#include <algorithm>
#include <limits>

#include "shade/light_points.h"
#include "shade/polygon_light.h"

namespace pocketray {

// A lamp as a surface sees it.
struct SeenLamp {
  const LightRun& run;
  const LightPolygon& polygon;
  std::uint32_t first, end;  // the light points that the sample sees
  const TilePolygon* tile;   // null: its tile knows nothing of it
  PolygonView view;
  Vec3 irradiance;  // of the whole lamp; set if the view is near
};

inline SeenLamp see_lamp(const Tracer& tracer, const LitSurface& to, const LightRun& run, std::uint32_t lamp) {
  const std::uint32_t count = tracer.frame->settings.points_per_area_light, first = run.begin + lamp * count;
  const LightPolygon& polygon = run.polygons[lamp];
  const TilePolygon* tile = to.at_first_hit ? tile_polygon(tracer, lamp) : nullptr;
  SeenLamp seen = {run, polygon, first, first + tracer.points_of_lamp, tile, {false, false, 0, 0}, {0, 0, 0}};
  if (tile)
    seen.view = tile->view[tracer.tile_pixel];
  else if (polygon.corner_count)
    seen.view = view_polygon(polygon, to.surface);
  if (seen.view.is_near) seen.irradiance = polygon_irradiance(polygon, seen.view);
  return seen;
}

// A smaller sum of irradiances has no finite inverse.
constexpr float kShareMin = std::numeric_limits<float>::min();

// Fades the light of a lamp that sets with the last of its points, the highest of which is at least a third as high as
// its corners while none of them is below the horizon. `highest`: in units of 1 / LightPolygon::scale.
inline Vec3 fade_setting_lamp(const SeenLamp& lamp, float highest, const Vec3& light_out) {
  return lamp.view.highest > 3 * highest ? light_out * (3 * highest / lamp.view.highest) : light_out;
}

// Light of a lamp's points, scaled so that without shadows it sums to the polygon's light.
template <EffectMask mask>
[[gnu::noinline]] Vec3 weighted_points(Tracer* tracer, const LitSurface& to, const SeenLamp& lamp) {
  const FrameData& frame = *tracer->frame;
  const Surface& s = to.surface;
  Vec3 seen = {0, 0, 0};
  float all = 0, highest = 0;
  for (std::uint32_t i = lamp.first; i < lamp.end; ++i) {
    LightSample sample;
    if (!lights_up(frame, s, lamp.run, tracer->light_points[i], &sample)) continue;
    const float share = max_component(sample.irradiance) * dot(s.normal, sample.direction);
    all += share;
    if (lamp.view.highest > 0) highest = std::max(highest, dot(s.normal, sample.to_light) * lamp.polygon.scale);
    Vec3 light_out = lobe_value<mask>(frame, to, sample.direction) * share;
    if constexpr (has(mask, Effect::clear_coat))
      light_out += layer_reflection(s, to.to_viewer, sample.direction) * max_component(sample.irradiance);
    if (!(max_component(light_out * to.weight) > 0)) continue;
    if constexpr (has(mask, Effect::shadow)) {
      light_out *= shadow<mask>(tracer, s, lamp.run, i, &sample, to.at_first_hit);
    } else if (is_below(s, sample.direction)) {
      continue;
    }
    seen += light_out;
  }
  if (!(all >= kShareMin)) return {0, 0, 0};
  return fade_setting_lamp(lamp, highest, seen * (1 / all) * lamp.irradiance);
}

enum class Visibility { unknown, none, full };

// Visibility of a whole lamp as far as the surface's tile knows it.
template <EffectMask mask>
inline Visibility known_visibility(Tracer* tracer, const SeenLamp& lamp) {
  if (!lamp.tile) return Visibility::unknown;
  constexpr bool kClear = has(mask, Effect::refraction) || has(mask, Effect::alpha_blend);
  const bool blocked = lamp.tile->blocked[tracer->tile_pixel];
  if (!blocked && (kClear || !lamp.tile->open[tracer->tile_pixel])) return Visibility::unknown;
  effect_entered<Effect::shadow>();
  if (!is_grouped(*tracer)) tracer->rays[static_cast<int>(RayKind::shadow)] += lamp.end - lamp.first;
  return blocked ? Visibility::none : Visibility::full;
}

// Visible fraction of a whole lamp at a matte surface: the visibility of its light points, weighted by what each
// contributes.
template <EffectMask mask>
[[gnu::noinline]] Vec3 lamp_visibility(Tracer* tracer, const LitSurface& to, const SeenLamp& lamp) {
  const Visibility known = known_visibility<mask>(tracer, lamp);
  if (known == Visibility::none) return {0, 0, 0};
  if (known == Visibility::full) return {1, 1, 1};
  const FrameData& frame = *tracer->frame;
  const Surface& s = to.surface;
  auto visibility = [&](std::uint32_t i) { return shadow<mask>(tracer, s, lamp.run, i, nullptr, to.at_first_hit); };
  auto share = [&](std::uint32_t i) {
    LightSample sample;
    return lights_up(frame, s, lamp.run, tracer->light_points[i], &sample)
               ? max_component(sample.irradiance) * dot(s.normal, sample.direction)
               : 0;
  };
  const Vec3 common = visibility(lamp.first);
  Vec3 other = common;
  std::uint32_t next = lamp.first + 1;
  for (; next < lamp.end && other == common; ++next) other = visibility(next);
  if (other == common) return common;
  float all = 0;
  for (std::uint32_t i = lamp.first; i + 1 < next; ++i) all += share(i);
  Vec3 seen = common * all;
  for (std::uint32_t i = next - 1; i < lamp.end; ++i) {
    const float own = share(i);
    all += own;
    seen += (i + 1 == next ? other : visibility(i)) * own;
  }
  return all >= kShareMin ? seen * (1 / all) : Vec3{0, 0, 0};
}

// The linear form of the material's glossy lobe, from which a polygon's share follows; null if it has none.
template <EffectMask mask>
inline const LinearForm* linear_form(const FrameData& frame, const LitSurface& to) {
  if constexpr (!has(mask, Effect::specular)) return nullptr;
  if (is_zero(to.material.specular)) return nullptr;
  if constexpr (has(mask, Effect::clear_coat))
    if (to.surface.coat.passes < 1) return nullptr;
  if constexpr (has(mask, Effect::metallic_roughness)) return lobe_at(frame, to.surface, to.material).linear;
  return kBrdfList[to.material.brdf]->linear;
}

// A glossy lobe at a surface, divided into a sharp part in linear form and the rest.
struct DividedLobe {
  const LinearForm& form;
  LobeParts parts;
};

// Sums over a lamp's points, weighted by their share of the highlight and of the matte light.
struct LobePoints {
  Vec3 seen_gloss = {0, 0, 0}, seen_rest = {0, 0, 0}, common = {1, 1, 1};
  float all_gloss = 0, all = 0, highest = 0;
  bool any = false, alike = true;  // alike: all points are equally visible
};

template <EffectMask mask>
[[gnu::always_inline]] inline LobePoints sum_lobe_points(Tracer* tracer, const LitSurface& to, const SeenLamp& lamp,
                                                         const DividedLobe& lobe, bool all_seen) {
  const FrameData& frame = *tracer->frame;
  const Surface& s = to.surface;
  const LinearForm& form = lobe.form;
  const LobeParts& parts = lobe.parts;
  LobePoints p;
  for (std::uint32_t i = lamp.first; i < lamp.end; ++i) {
    LightSample sample;
    if (!lights_up(frame, s, lamp.run, tracer->light_points[i], &sample)) continue;
    const Vec3& to_light = sample.direction;
    const float arriving = max_component(sample.irradiance), cosine = dot(s.normal, to_light);
    const float share = arriving * cosine;
    p.all += share;
    if (lamp.view.highest > 0) p.highest = std::max(p.highest, dot(s.normal, sample.to_light) * lamp.polygon.scale);
    Vec3 visibility = {1, 1, 1};
    if (!all_seen) {
      if constexpr (has(mask, Effect::shadow))
        visibility = shadow<mask>(tracer, s, lamp.run, i, &sample, to.at_first_hit);
      else if (is_below(s, to_light))
        visibility = {0, 0, 0};
      const Vec3 local = {dot(parts.x, to_light), dot(parts.y, to_light), dot(parts.z, to_light)};
      const float square = dot(local, local), fourth = square * square;
      const float weight = arriving / (form.power > 1 ? fourth * fourth * fourth : fourth);
      p.all_gloss += weight, p.seen_gloss += visibility * weight;
    }
    p.seen_rest += (form.rest ? form.rest(parts, cosine) * visibility : visibility) * share;
    if (!p.any) p.common = visibility;
    p.any = true, p.alike = p.alike && visibility == p.common;
  }
  return p;
}

// Light of a lamp whose points have these sums. The sharp part's weights have long tails: where the lobe hardly covers
// any of the points, the nearest one counts.
inline Vec3 light_of_lobe_points(const LobePoints& p, const DividedLobe& lobe, const SeenLamp& lamp, const Vec3& gloss,
                                 const Vec3& matte) {
  const bool has_rest = lobe.form.rest != nullptr;
  if (!p.any || (!(p.all >= kShareMin) && (has_rest || !p.alike))) return {0, 0, 0};
  Vec3 light_out = gloss * p.common;
  if (!p.alike) light_out = p.all_gloss >= kShareMin ? gloss * (p.seen_gloss * (1 / p.all_gloss)) : Vec3{0, 0, 0};
  if (has_rest)
    light_out += p.seen_rest * (1 / p.all) * lamp.irradiance;
  else
    light_out += matte * (p.alike ? p.common : p.seen_rest * (1 / p.all));
  return fade_setting_lamp(lamp, p.highest, light_out);
}

// Adds a lamp's light at a glossy surface: the closed forms of the sharp part and of the rest, each times the
// visibility of the lamp's points, weighted by their contribution. Returns false if the lobe has no such division.
template <EffectMask mask>
[[gnu::noinline]] bool add_glossy_lamp(Tracer* tracer, const LitSurface& to, const SeenLamp& lamp,
                                       const LinearForm& form, Vec3* sum) {
  const Surface& s = to.surface;
  const Material& m = to.material;
  DividedLobe lobe = {form, {}};
  const Vec3 specular = reflectance_at(s, m.specular, m.specular_tinted);
  if (!form.divide(m, specular, to.diffuse, s, to.to_viewer, &lobe.parts)) return false;
  effect_entered<Effect::specular>();
  const Vec3 gloss = min(lamp.polygon.radiance * lobe.parts.albedo * lobe_share(lamp.polygon, s, form, lobe.parts),
                         {kRadianceMax, kRadianceMax, kRadianceMax});
  const Vec3 matte = lobe.parts.diffuse * lamp.irradiance;  // without `rest`
  if (!form.rest && is_negligible<mask>(tracer, to, gloss + matte)) return true;
  constexpr bool kShadow = has(mask, Effect::shadow);
  bool all_seen = !kShadow && lamp.view.is_whole;
  if (kShadow && lamp.view.is_whole) {
    const Visibility known = known_visibility<mask>(tracer, lamp);
    if (known == Visibility::none) return true;
    all_seen = known == Visibility::full;
  }
  if (all_seen && !form.rest)
    *sum += gloss + matte;
  else
    *sum += light_of_lobe_points(sum_lobe_points<mask>(tracer, to, lamp, lobe, all_seen), lobe, lamp, gloss, matte);
  return true;
}

// Adds the light of a lamp, near enough for its closed form.
template <EffectMask mask>
[[gnu::always_inline]] inline void add_lamp(Tracer* tracer, const LitSurface& to, const SeenLamp& lamp, Vec3* sum) {
  if (!(max_component(lamp.irradiance) > 0)) return;
  if (is_matte<mask>(to)) {
    const Vec3 light_out = to.diffuse * lamp.irradiance;
    if (is_negligible<mask>(tracer, to, light_out)) return;
    if (lamp.view.is_whole) {
      if constexpr (has(mask, Effect::shadow))
        *sum += light_out * lamp_visibility<mask>(tracer, to, lamp);
      else
        *sum += light_out;
      return;
    }
  }
  const LinearForm* form = linear_form<mask>(*tracer->frame, to);
  if (form && add_glossy_lamp<mask>(tracer, to, lamp, *form, sum)) return;
  *sum += weighted_points<mask>(tracer, to, lamp);
}

// Adds the lamps of a run, some of which are polygons, to `sum`.
template <EffectMask mask>
[[gnu::noinline]] Vec3 add_area_lights(Tracer* tracer, const LitSurface& to, const LightRun& run, Vec3 sum) {
  const FrameData& frame = *tracer->frame;
  const std::uint32_t count = frame.settings.points_per_area_light;
  for (std::uint32_t lamp = 0, first = run.begin; first < run.end; ++lamp, first += count) {
    const LightPoint& point = tracer->light_points[first];
    if (run.polygons[lamp].corner_count && is_own(frame, to.surface, point) &&
        is_unlit_by_own(frame, to.surface, point))
      continue;
    const SeenLamp seen = see_lamp(*tracer, to, run, lamp);
    if (seen.view.is_near) {
      add_lamp<mask>(tracer, to, seen, &sum);
      continue;
    }
    for (std::uint32_t i = seen.first; i < seen.end; ++i) add_light_point<mask>(tracer, to, run, i, &sum);
  }
  return sum;
}

}  // namespace pocketray
