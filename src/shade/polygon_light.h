// The light of a flat lamp in closed form: Lambert's formula for a polygon that shines alike everywhere, as if nothing
// were in the way. Shadow rays to the lamp's points then tell which share of it is seen [Heitz et al. 2018, "Combining
// Analytic Direct Illumination and Stochastic Shadows"]. Lamps as far away as kPolygonNear times their size are the sum
// of their points, which errs by less than a thousandth there; the formula's terms would cancel.
#pragma once
#include "shade/surface.h"

namespace pocketray {

constexpr float kPolygonNear = 16;

// A polygon as a surface sees it.
struct PolygonView {
  bool is_near;       // false: nothing else is set
  bool is_whole;      // it is above the horizons of both normals, and so are the lamp's points, rounding included
  float form_factor;  // the share of the hemisphere, weighted by the cosine, that its front fills above the horizon
  float highest;      // of its corners above the horizon, in units of 1 / LightPolygon::scale; 0: the polygon is whole
};
PolygonView view_polygon(const LightPolygon& polygon, const Surface& s);

// Irradiance on a surface with that view of the polygon, at most kRadianceMax.
Vec3 polygon_irradiance(const LightPolygon& polygon, const PolygonView& view);

// The share of a lobe's distribution that the polygon fills above the horizon; the surface has a near view of it.
float lobe_share(const LightPolygon& polygon, const Surface& s, const LinearForm& form, const LobeParts& lobe);

}  // namespace pocketray
