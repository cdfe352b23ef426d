// The unshadowed light of a flat lamp in closed form: Lambert's formula for a polygon of uniform radiance. Shadow rays
// to the lamp's points then tell which fraction of it is visible [Heitz et al. 2018, "Combining Analytic Direct
// Illumination and Stochastic Shadows"]. Lamps beyond kPolygonNear times their size are the sum of their points, which
// errs by less than a thousandth at that distance; the formula's terms would cancel.
#pragma once
#include "shade/surface.h"

namespace pocketray {

constexpr float kPolygonNear = 16;

// Returns whether the light of each lamp is calculated by itself: in closed form or over the points that a sample sees.
// Otherwise, each point is a light of its own.
constexpr bool takes_lamps_whole(const Settings& settings, EffectMask mask) {
  return settings.area_irradiance != AreaIrradiance::points && !has(mask, Effect::source_selection);
}

// A polygon as a surface sees it.
struct PolygonView {
  bool is_near;       // false: nothing else is set
  bool is_whole;      // it is above the horizons of both normals, and so are the lamp's points, rounding included
  float form_factor;  // cosine-weighted share of the hemisphere that its front fills above the horizon
  float highest;      // highest corner above the horizon, in units of 1 / LightPolygon::scale; 0: the polygon is whole
};
PolygonView view_polygon(const LightPolygon& polygon, const Surface& s);

// Irradiance from the polygon on a surface with this view of it, at most kRadianceMax.
Vec3 polygon_irradiance(const LightPolygon& polygon, const PolygonView& view);

// Share of a lobe's distribution that the polygon fills above the horizon; the surface has a near view of it.
float lobe_share(const LightPolygon& polygon, const Surface& s, const LinearForm& form, const LobeParts& lobe);

}  // namespace pocketray
