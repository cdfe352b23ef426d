// Direct light at a surface: lights × shadow rays.
#pragma once
#include <algorithm>
#include <limits>

#include "brdf/brdf_list.h"
#include "shade/clear_coat.h"
#include "shade/polygon_light.h"
#include "shade/shadow.h"
#include "shade/tracer.h"

namespace pocketray {

// A surface that receives light, and the direction to its viewer.
struct LitSurface {
  const Surface& surface;
  const Material& material;  // with the lobes evaluated at the point
  const Vec3& to_viewer;
  const Vec3& weight;  // the throughput of the path so far
  Vec3 diffuse;        // value of the diffuse lobe
  bool at_first_hit;
};

// The effects on which direct light depends.
constexpr EffectMask kDirectEffects =
    bit(Effect::shadow) | bit(Effect::specular) | bit(Effect::metallic_roughness) | kPassageEffects;
static_assert((kPassageEffects & bit(Effect::clear_coat)) != 0, "coats change lobes");

// Sum of all lobes for light from a direction.
template <EffectMask mask>
inline Vec3 lobe_value(const FrameData& frame, const LitSurface& to, const Vec3& direction) {
  const Material& m = to.material;
  if constexpr (has(mask, Effect::specular)) {
    if (!is_zero(m.specular)) {
      effect_entered<Effect::specular>();
      Vec3 specular = reflectance_at(to.surface, m.specular, m.specular_tinted);
      const BrdfInfo* lobe = kBrdfList[m.brdf];
      if constexpr (has(mask, Effect::metallic_roughness)) lobe = &lobe_at(frame, to.surface, m);
      if constexpr (has(mask, Effect::clear_coat))
        return value_under_coat(*lobe, m, specular, to.diffuse, to.surface, to.to_viewer, direction);
      return lobe->value(m, specular, to.diffuse, to.surface, to.to_viewer, direction);
    }
  }
  return to.diffuse;
}

// Reflected radiance for light of that irradiance (measured on a surface facing it).
template <EffectMask mask>
inline Vec3 reflected_light(const FrameData& frame, const LitSurface& to, const Vec3& direction, const Vec3& irradiance,
                            float cosine) {
  const Vec3 light_out = lobe_value<mask>(frame, to, direction) * irradiance * cosine;
  if constexpr (has(mask, Effect::clear_coat))
    return light_out + irradiance * coat_reflection(to.surface, to.to_viewer, direction);
  return light_out;
}

// Adds the light of frame.lights.points[i], which belongs to the run.
template <EffectMask mask>
[[gnu::always_inline]] inline void add_light_point(Tracer* tracer, const LitSurface& to, const LightRun& run,
                                                   std::uint32_t i, Vec3* sum) {
  const FrameData& frame = *tracer->frame;
  const Surface& s = to.surface;
  const LightPoint& light = frame.lights.points[i];
  LightSample sample;
  const TileSample* kept = nullptr;
  if (to.at_first_hit && is_sampled(*tracer, i, &kept)) {
    if (!kept) return;
    sample.direction = kept->direction, sample.irradiance = kept->irradiance;
  } else if (!lights_up(frame, s, run, light, &sample)) {
    return;
  }
  float cosine = dot(s.normal, sample.direction);
  if (!has(mask, Effect::shadow) && is_below(s, sample.direction)) return;
  Vec3 light_out = reflected_light<mask>(frame, to, sample.direction, sample.irradiance, cosine);
  float bound = max_component(light_out * to.weight);
  if (!(bound > 0)) return;
  if constexpr (has(mask, Effect::shadow)) {
    if (leave_out(tracer, bound)) return;
    light_out *= shadow<mask>(tracer, s, run, i, kept ? nullptr : &sample, to.at_first_hit);
  }
  *sum += light_out;
}

// A smaller sum of irradiances has no finite inverse.
constexpr float kShareMin = std::numeric_limits<float>::min();

// Light of a lamp's points, scaled so that without shadows it sums to the polygon's light.
template <EffectMask mask>
[[gnu::noinline]] Vec3 weighted_points(Tracer* tracer, const LitSurface& to, const LightRun& run, std::uint32_t first,
                                       const PolygonView& view, const Vec3& irradiance) {
  const FrameData& frame = *tracer->frame;
  const Surface& s = to.surface;
  const LightPolygon& polygon = run.polygons[(first - run.begin) / frame.settings.points_per_area_light];
  Vec3 seen = {0, 0, 0};
  float all = 0, highest = 0;
  for (std::uint32_t i = first; i < first + frame.settings.points_per_area_light; ++i) {
    LightSample sample;
    if (!lights_up(frame, s, run, frame.lights.points[i], &sample)) continue;
    const float share = max_component(sample.irradiance) * dot(s.normal, sample.direction);
    all += share;
    if (view.highest > 0) highest = std::max(highest, dot(s.normal, sample.to_light) * polygon.scale);
    Vec3 light_out = lobe_value<mask>(frame, to, sample.direction) * share;
    if constexpr (has(mask, Effect::clear_coat)) {
      const float coat = max_component(sample.irradiance) * coat_reflection(s, to.to_viewer, sample.direction);
      light_out += Vec3{coat, coat, coat};
    }
    if (!(max_component(light_out * to.weight) > 0)) continue;
    if constexpr (has(mask, Effect::shadow)) {
      light_out *= shadow<mask>(tracer, s, run, i, &sample, to.at_first_hit);
    } else if (is_below(s, sample.direction)) {
      continue;
    }
    seen += light_out;
  }
  if (!(all >= kShareMin)) return {0, 0, 0};
  seen = seen * (1 / all) * irradiance;
  // As the lamp sets, its light fades with the last of its points, the highest of which is at least a third as high as
  // its corners while none of them is below the horizon.
  return view.highest > 3 * highest ? seen * (3 * highest / view.highest) : seen;
}

// Visible fraction of a whole lamp at a matte surface: the visibility of its light points, weighted by what each
// contributes.
template <EffectMask mask>
[[gnu::noinline]] Vec3 polygon_visibility(Tracer* tracer, const LitSurface& to, const LightRun& run,
                                          std::uint32_t first, const TilePolygon* tile) {
  const FrameData& frame = *tracer->frame;
  const Surface& s = to.surface;
  const std::uint32_t count = frame.settings.points_per_area_light;
  constexpr bool kClear = has(mask, Effect::refraction) || has(mask, Effect::alpha_blend);
  if (tile) {
    const bool blocked = tile->blocked[tracer->tile_pixel];
    if (blocked || (!kClear && tile->open[tracer->tile_pixel])) {
      effect_entered<Effect::shadow>();
      if (!frame.lights.point_groups.groups.count) tracer->rays[static_cast<int>(RayKind::shadow)] += count;
      return blocked ? Vec3{0, 0, 0} : Vec3{1, 1, 1};
    }
  }
  auto visibility = [&](std::uint32_t i) { return shadow<mask>(tracer, s, run, i, nullptr, to.at_first_hit); };
  auto share = [&](std::uint32_t i) {
    LightSample sample;
    return lights_up(frame, s, run, frame.lights.points[i], &sample)
               ? max_component(sample.irradiance) * dot(s.normal, sample.direction)
               : 0;
  };
  const Vec3 common = visibility(first);
  Vec3 other = common;
  std::uint32_t next = first + 1;
  for (; next < first + count && other == common; ++next) other = visibility(next);
  if (other == common) return common;
  float all = 0;
  for (std::uint32_t i = first; i + 1 < next; ++i) all += share(i);
  Vec3 seen = common * all;
  for (std::uint32_t i = next - 1; i < first + count; ++i) {
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

// Sums over a lamp's points, weighted by their share of the highlight and of the matte light.
struct LobePoints {
  Vec3 seen_gloss = {0, 0, 0}, seen_rest = {0, 0, 0}, common = {1, 1, 1};
  float all_gloss = 0, all = 0, highest = 0;
  bool any = false, alike = true;  // alike: all points are equally visible
};

template <EffectMask mask>
[[gnu::always_inline]] inline LobePoints sum_lobe_points(Tracer* tracer, const LitSurface& to, const LightRun& run,
                                                         std::uint32_t first, const PolygonView& view,
                                                         const LinearForm& form, const LobeParts& parts,
                                                         bool all_seen) {
  const FrameData& frame = *tracer->frame;
  const Surface& s = to.surface;
  const std::uint32_t count = frame.settings.points_per_area_light;
  const LightPolygon& polygon = run.polygons[(first - run.begin) / count];
  LobePoints p;
  for (std::uint32_t i = first; i < first + count; ++i) {
    LightSample sample;
    if (!lights_up(frame, s, run, frame.lights.points[i], &sample)) continue;
    const Vec3& to_light = sample.direction;
    const float arriving = max_component(sample.irradiance), cosine = dot(s.normal, to_light);
    const float share = arriving * cosine;
    p.all += share;
    if (view.highest > 0) p.highest = std::max(p.highest, dot(s.normal, sample.to_light) * polygon.scale);
    Vec3 visibility = {1, 1, 1};
    if (!all_seen) {
      if constexpr (has(mask, Effect::shadow))
        visibility = shadow<mask>(tracer, s, run, i, &sample, to.at_first_hit);
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

// Adds a lamp's light at a glossy surface: the closed forms of the sharp part and of the rest, each times the
// visibility of the lamp's points, weighted by their contribution. The sharp part's weights have long tails: where the
// lobe hardly covers any of the points, the nearest one counts. Returns false if the lobe has no such division.
template <EffectMask mask>
[[gnu::noinline]] bool add_glossy_lamp(Tracer* tracer, const LitSurface& to, const LightRun& run, std::uint32_t first,
                                       const PolygonView& view, const Vec3& irradiance, const TilePolygon* tile,
                                       const LinearForm& form, Vec3* sum) {
  const FrameData& frame = *tracer->frame;
  const Surface& s = to.surface;
  const Material& m = to.material;
  const std::uint32_t count = frame.settings.points_per_area_light;
  const LightPolygon& polygon = run.polygons[(first - run.begin) / count];
  LobeParts parts;
  const Vec3 specular = reflectance_at(s, m.specular, m.specular_tinted);
  if (!form.divide(m, specular, to.diffuse, s, to.to_viewer, &parts)) return false;
  effect_entered<Effect::specular>();
  const Vec3 gloss = min(polygon.radiance * parts.albedo * lobe_share(polygon, s, form, parts),
                         {kRadianceMax, kRadianceMax, kRadianceMax});
  const Vec3 matte = parts.diffuse * irradiance;  // without `rest`
  constexpr bool kShadow = has(mask, Effect::shadow);
  if (!form.rest) {
    const float bound = max_component((gloss + matte) * to.weight);
    if (!(bound > 0)) return true;
    if (kShadow && leave_out(tracer, bound)) return true;
  }
  bool all_seen = !kShadow && view.is_whole;
  if (kShadow && view.is_whole && tile) {
    constexpr bool kClear = has(mask, Effect::refraction) || has(mask, Effect::alpha_blend);
    const bool blocked = tile->blocked[tracer->tile_pixel];
    all_seen = !kClear && tile->open[tracer->tile_pixel];
    if (blocked || all_seen) {
      effect_entered<Effect::shadow>();
      if (!frame.lights.point_groups.groups.count) tracer->rays[static_cast<int>(RayKind::shadow)] += count;
    }
    if (blocked) return true;
  }
  if (all_seen && !form.rest) {
    *sum += gloss + matte;
    return true;
  }
  const LobePoints p = sum_lobe_points<mask>(tracer, to, run, first, view, form, parts, all_seen);
  if (!p.any || (!(p.all >= kShareMin) && (form.rest || !p.alike))) return true;
  Vec3 light_out = gloss * p.common;
  if (!p.alike) light_out = p.all_gloss >= kShareMin ? gloss * (p.seen_gloss * (1 / p.all_gloss)) : Vec3{0, 0, 0};
  if (form.rest)
    light_out += p.seen_rest * (1 / p.all) * irradiance;
  else
    light_out += matte * (p.alike ? p.common : p.seen_rest * (1 / p.all));
  *sum += view.highest > 3 * p.highest ? light_out * (3 * p.highest / view.highest) : light_out;
  return true;
}

// Adds the lamps of a run, some of which are polygons, to `sum`.
template <EffectMask mask>
[[gnu::noinline]] Vec3 add_area_lights(Tracer* tracer, const LitSurface& to, const LightRun& run, Vec3 sum) {
  const FrameData& frame = *tracer->frame;
  const Surface& s = to.surface;
  const std::uint32_t count = frame.settings.points_per_area_light;
  for (std::uint32_t lamp = 0, first = run.begin; first < run.end; ++lamp, first += count) {
    const LightPolygon& polygon = run.polygons[lamp];
    const LightPoint& point = frame.lights.points[first];
    if (polygon.corner_count && is_own(frame, s, point) && is_unlit_by_own(frame, s, point)) continue;
    const TilePolygon* tile = to.at_first_hit ? tile_polygon(*tracer, lamp) : nullptr;
    PolygonView view = {false, false, 0, 0};
    if (tile)
      view = tile->view[tracer->tile_pixel];
    else if (polygon.corner_count)
      view = view_polygon(polygon, s);
    if (!view.is_near) {
      for (std::uint32_t i = first; i < first + count; ++i) add_light_point<mask>(tracer, to, run, i, &sum);
      continue;
    }
    const Vec3 irradiance = polygon_irradiance(polygon, view);
    if (!(max_component(irradiance) > 0)) continue;
    if (!(has(mask, Effect::specular) && !is_zero(to.material.specular)) &&
        !(has(mask, Effect::clear_coat) && s.coat.lobe > 0)) {
      const Vec3 light_out = to.diffuse * irradiance;
      const float bound = max_component(light_out * to.weight);
      if (!(bound > 0)) continue;
      if constexpr (has(mask, Effect::shadow))
        if (leave_out(tracer, bound)) continue;
      if (view.is_whole) {
        if constexpr (has(mask, Effect::shadow))
          sum += light_out * polygon_visibility<mask>(tracer, to, run, first, tile);
        else
          sum += light_out;
        continue;
      }
    }
    const LinearForm* form = linear_form<mask>(frame, to);
    if (form && add_glossy_lamp<mask>(tracer, to, run, first, view, irradiance, tile, *form, &sum)) continue;
    sum += weighted_points<mask>(tracer, to, run, first, view, irradiance);
  }
  return sum;
}

// Radiance towards the viewer from light that arrives directly from the lights; `m` has the lobes at the point.
// `weight` is the throughput of the path so far.
template <EffectMask mask>
Vec3 direct_light(Tracer* tracer, const Surface& s, const Material& m, const Vec3& to_viewer, const Vec3& weight) {
  const FrameData& frame = *tracer->frame;
  Vec3 sum = {0, 0, 0};
  const bool at_first_hit = tracer->first_surface && same_surface(*tracer->first_surface, s);
  const LitSurface to = {s, m, to_viewer, weight, s.diffuse * (1 / kPiF), at_first_hit};
  for (int r = 0; r < frame.lights.run_count; ++r) {
    const LightRun& run = frame.lights.runs[r];
    if (run.polygons) {
      const LitSurface copy = to;  // arguments passed by reference must live in memory
      sum = add_area_lights<mask & kDirectEffects>(tracer, copy, run, sum);
      continue;
    }
    for (std::uint32_t i = run.begin; i < run.end; ++i) add_light_point<mask>(tracer, to, run, i, &sum);
  }
  return sum;
}

}  // namespace pocketray
