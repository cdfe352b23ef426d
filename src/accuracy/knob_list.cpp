#include "accuracy/knob_list.h"

#include <algorithm>
#include <cstdio>

#include "effect/effect_list.h"

namespace pocketray {
namespace {

double itself(double value) { return value; }
double with_the_rest(double points) {
  return points + 1;
}  // what a pixel takes without lights is about a point's worth

std::uint32_t whole(double value) { return static_cast<std::uint32_t>(value); }

std::vector<Knob> make_knobs() {
  constexpr EffectMask spawning = bit(Effect::mirror) | bit(Effect::refraction),
                       left_out = spawning | bit(Effect::alpha_blend);
  return {
      {"samples",
       "rays through each pixel",
       "supersampling",
       0,
       nullptr,
       "between -1/2, random points on an edge, and -1, a regular grid on straight edges",
       {1, 2, 4, 6, 9, 12, 16},
       {},
       [](const Configuration& c) { return static_cast<double>(c.settings.samples_per_pixel); },
       [](Configuration* c, double v) { c->settings.samples_per_pixel = whole(v); },
       itself},
      {"depth",
       "reflections and refractions along a path",
       "mirror, refraction",
       spawning,
       nullptr,
       "error falls as reflectance to the power of depth, faster than any power of time",
       {0, 1, 2, 3, 4, 5, 6, 7, 8},
       {},
       [](const Configuration& c) { return static_cast<double>(c.settings.ray_depth); },
       [](Configuration* c, double v) { c->settings.ray_depth = whole(v); },
       nullptr},
      {"cut-off",
       "displayed levels that left-out rays may be worth",
       "mirror, refraction, alpha-blend",
       left_out,
       nullptr,
       "",
       {16, 8, 4, 2, 1, 0.5, 0.25, 0},
       {},
       [](const Configuration& c) { return static_cast<double>(c.settings.cut_off_levels); },
       [](Configuration* c, double v) { c->settings.cut_off_levels = static_cast<float>(v); },
       nullptr},
      {"area-lights",
       "points that each area light is taken as",
       "area-light",
       bit(Effect::area_light),
       nullptr,
       "-1/2 for random points; a grid of n points errs by one shadow edge of n, down to -1",
       {1, 4, 9, 16, 36, 64, 144, 256},
       {},
       [](const Configuration& c) { return static_cast<double>(c.settings.points_per_area_light); },
       [](Configuration* c, double v) { c->settings.points_per_area_light = whole(v); },
       with_the_rest},
      {"texture-filter",
       "how textures are read between texels",
       "texture",
       bit(Effect::texture),
       nullptr,
       "",
       {0, 1, 2},
       {"nearest", "scene", "bilinear"},
       [](const Configuration& c) {
         return c.settings.texture_filter == TextureFilter::nearest    ? 0.0
                : c.settings.texture_filter == TextureFilter::as_scene ? 1.0
                                                                       : 2.0;
       },
       [](Configuration* c, double v) {
         c->settings.texture_filter = v == 0   ? TextureFilter::nearest
                                      : v == 1 ? TextureFilter::as_scene
                                               : TextureFilter::bilinear;
       },
       nullptr},
      {"normals",
       "normals across a triangle",
       "smooth-normal",
       bit(Effect::smooth_normal),
       nullptr,
       "",
       {0, 1},
       {"flat", "scene"},
       [](const Configuration& c) { return c.settings.normals == NormalMode::flat ? 0.0 : 1.0; },
       [](Configuration* c, double v) { c->settings.normals = v == 0 ? NormalMode::flat : NormalMode::as_scene; },
       nullptr},
      {"tessellation",
       "columns of triangles around the sphere",
       "geometry",
       0,
       "cornell",
       "facets err by the square of their width, rays take its logarithm: faster than any power of time",
       {8, 16, 32, 64, 128},
       {},
       [](const Configuration& c) { return static_cast<double>(c.sphere_columns); },
       [](Configuration* c, double v) { c->sphere_columns = whole(v); },
       nullptr,
       false,
       false},
      {"arithmetic",
       "numbers the picture is computed in; double by the reference's own tracer",
       "all",
       0,
       nullptr,
       "",
       {0, 1},
       {"float", "double"},
       [](const Configuration& c) { return c.double_precision ? 1.0 : 0.0; },
       [](Configuration* c, double v) { c->double_precision = v != 0; },
       [](double v) { return v == 0 ? 1.0 : 5.0; },  // `pocketray accuracy cornell`
       true,
       false},
      {"output",
       "what the screen shows of a pixel",
       "display",
       0,
       nullptr,
       "",
       {0, 1, 2},
       {kOutputFormats[0].name, kOutputFormats[1].name, kOutputFormats[2].name},
       [](const Configuration& c) { return static_cast<double>(c.output); },
       [](Configuration* c, double v) { c->output = static_cast<int>(v); },
       nullptr,
       false,
       false},
  };
}

}  // namespace

int find_output_format(const std::string& name) {
  for (int i = 0; i < kOutputFormatCount; ++i)
    if (name == kOutputFormats[i].name) return i;
  return -1;
}

const std::vector<Knob>& knob_list() {
  static const std::vector<Knob> knobs = make_knobs();
  return knobs;
}

std::string value_label(const Knob& knob, double value) {
  for (std::size_t i = 0; i < knob.labels.size(); ++i)
    if (knob.values[i] == value) return knob.labels[i];
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

std::vector<double> knob_values(const Knob& knob, const Configuration& baseline) {
  std::vector<double> values = knob.values;
  double own = knob.get(baseline);
  if (std::find(values.begin(), values.end(), own) != values.end()) return values;
  bool falls = values.front() > values.back();
  auto place = std::find_if(values.begin(), values.end(), [&](double v) { return falls ? v < own : v > own; });
  values.insert(place, own);
  return values;
}

bool knob_applies(const Knob& knob, const std::string& scene, const EffectPlan& plan, std::string* why) {
  if (knob.scene && scene != knob.scene) {
    *why = std::string("of the built-in scene ") + knob.scene + " alone";
    return false;
  }
  if (knob.needs == 0 || (knob.needs & plan.mask) != 0) return true;
  why->clear();
  for (const EffectRow& row : kEffectList)
    if (has(knob.needs, row.effect))
      *why += (why->empty() ? "" : ", ") + std::string(plan.decisions[static_cast<int>(row.effect)].reason);
  return false;
}

double relative_price(const Knob& knob, const Configuration& baseline, double value) {
  return knob.price ? knob.price(value) / knob.price(knob.get(baseline)) : 1;
}

}  // namespace pocketray
