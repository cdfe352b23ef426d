// Form factors in closed form, in double precision.
#pragma once
#include <cstdint>
#include <vector>

#include "base/vec3.h"

namespace pocketray {

using Polygon = std::vector<Vec3d>;  // convex and flat, counter-clockwise seen from the front

// The share of the hemisphere over a point, weighted by the cosine, that the front of a polygon fills, seen without
// obstacles; `normal` is unit. Lambert's formula on the part above the horizon [Baum, Rushmeier, Winget 1989, eq. 7].
// 0 for a point behind the polygon or in its plane.
double point_form_factor(const Vec3d& point, const Vec3d& normal, const Polygon& polygon);

// The share of the light leaving the front of one polygon that reaches the front of the other, without obstacles: the
// double contour integral [Cohen and Wallace 1993, eq. 4.26], the inner one in closed form, the outer one by adaptive
// Gauss quadrature to about 1e-9. They may touch. Each must lie in front of the other.
double polygon_form_factor(const Polygon& from, const Polygon& to);

// From the disk of radius `from` to the coaxial one of radius `to` at a distance, without cancellation (HARDCASES row
// 45).
double coaxial_disk_form_factor(double from, double to, double distance);

double polygon_area(const Polygon& polygon);

}  // namespace pocketray
