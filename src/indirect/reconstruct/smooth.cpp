#include "indirect/reconstruct/smooth.h"

#include "base/check.h"
#include "indirect/reconstruct/triangle.h"

namespace pocketray {
namespace {

Vec3 light_at(const TriangleLight& light, const float (&weight)[3], Reconstruction how) {
  return how == Reconstruction::quadratic ? quadratic_triangle(light, weight) : cubic_triangle(light, weight);
}

}  // namespace

Vec3 smooth_cell(const PatchCorners& corners, float s, float t, Reconstruction how) {
  const bool below = s >= t;  // the half with (1, 0); corners of both halves follow the cell's border
  const RadiosityNode* const nodes[3] = {corners.b00, below ? corners.b10 : corners.b11,
                                         below ? corners.b11 : corners.b01};
  constexpr float kPlaces[2][3][2] = {{{0, 0}, {1, 1}, {0, 1}}, {{0, 0}, {1, 0}, {1, 1}}};
  const auto& places = kPlaces[below];
  TriangleLight light;
  for (int i = 0; i < 3; ++i) {
    auto towards = [&](int k) {
      return nodes[i]->ds * (places[k][0] - places[i][0]) + nodes[i]->dt * (places[k][1] - places[i][1]);
    };
    light.value[i] = nodes[i]->value;
    light.to_next[i] = towards(next_corner(i)), light.to_previous[i] = towards(previous_corner(i));
  }
  // Slants for a square: an affine map preserves smoothness.
  constexpr float kSlants[2][3] = {{0.5f, -0.5f, 0}, {-0.5f, 0, 0.5f}};
  for (int i = 0; i < 3; ++i) light.slant[i] = kSlants[below][i];
  const float weight[3] = {1 - (below ? s : t), below ? s - t : s, below ? t : t - s};
  return light_at(light, weight, how);
}

Vec3 smooth_part(const Scene& scene, const RadiosityGradient* gradients, const Triangle& triangle, std::uint32_t place,
                 float u, float v, Reconstruction how) {
  CHECK(gradients != nullptr);
  float weight[3] = {1 - u - v, u, v};
  Vec3 corner[3];
  for (std::uint32_t i = 0; i < 3; ++i) corner[i] = scene.positions[triangle.vertex(i)];
  RadiosityCorners corners = {{triangle.vertex(0), triangle.vertex(1), triangle.vertex(2)}};
  if (place != kRadiosityAtVertices) {
    while (place & kRadiositySplitBit) {
      const HalvedCorners h = halved_corners(place);
      const float a = weight[h.a], b = weight[h.b], c = weight[h.c];
      const Vec3 ends[2] = {corner[h.a], corner[h.b]}, middle = (ends[0] + ends[1]) * 0.5f, apex = corner[h.c];
      const bool second = a < b;  // beyond the middle of AB
      weight[0] = second ? 2 * a : a - b, weight[1] = second ? b - a : 2 * b, weight[2] = c;
      corner[0] = second ? middle : ends[0], corner[1] = second ? ends[1] : middle, corner[2] = apex;
      place = scene.radiosity_splits[place & kRadiosityPartMax].part[second];
    }
    corners = scene.radiosity_corners[place & kRadiosityPartMax];
  }
  TriangleLight light;
  for (int i = 0; i < 3; ++i) {
    const int next = next_corner(i), previous = previous_corner(i);
    const RadiosityGradient& gradient = gradients[corners.value[i]];
    light.value[i] = scene.radiosity_values[corners.value[i]];
    light.to_next[i] = gradient.along(corner[next] - corner[i]);
    light.to_previous[i] = gradient.along(corner[previous] - corner[i]);
    light.slant[i] = slant_of(corner[next], corner[previous], corner[i]);
  }
  return light_at(light, weight, how);
}

}  // namespace pocketray
