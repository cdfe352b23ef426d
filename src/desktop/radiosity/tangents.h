// Tangents of a grid of values, for bicubic patches.
#pragma once
#include "scene/radiosity.h"

namespace pocketray {

// Sets ds, dt and dst of columns × rows nodes from their values.
// The tangent plane at a node is the mean of the variations along its edges ([Bastos92] fig. 5; the vectors are not
// normalised before they are averaged, so that the result does not depend on the unit of light). At a border it is that
// of the parabola through the three nearest values. Planes and monotone parabolas are reproduced.
// `limited`: tangents are shortened until the Bézier points of the patches around a node lie between the least and the
// largest value at the node and its eight neighbours, so that no patch leaves the range of its data, in particular
// below zero.
void set_tangents(RadiosityNode* nodes, std::uint32_t columns, std::uint32_t rows, bool limited);

}  // namespace pocketray
