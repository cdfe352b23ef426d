// Radiosity: light between diffuse surfaces, solved when the scene is baked and stored with it [Shirley 1990]. It
// excludes direct light, which is traced for each pixel [Jansen92]. Phong's lobe, which mirrors no surroundings,
// reflects it like a diffuse surface of equal mean albedo.
#pragma once
#include "effect/effect_probe.h"
#include "indirect/indirect.h"
#include "indirect/reconstruct/smooth.h"
#include "indirect/surroundings.h"

namespace pocketray {

// Value stored on a grid, at a point in the pose at time 0.
inline Vec3 radiosity_of_grid(const Scene& scene, const RadiosityGrid& grid, const Vec3& point, Reconstruction how) {
  auto place = [](float at, std::uint32_t count, std::uint32_t* cell) {  // in [0, 1] of the cell
    const float last = static_cast<float>(count - 1);
    at = at > 0 ? at < last ? at : last : 0;
    *cell = static_cast<std::uint32_t>(at);
    if (*cell == count - 1) --*cell;
    return at - static_cast<float>(*cell);
  };
  const Vec3 way = point - grid.origin;
  std::uint32_t column, row;
  const float s = place(dot(way, grid.along_s), grid.columns, &column);
  const float t = place(dot(way, grid.along_t), grid.rows, &row);
  const RadiosityNode* node = &scene.radiosity_nodes[grid.node_begin + row * grid.columns + column];
  const PatchCorners corners = {node, node + 1, node + grid.columns, node + grid.columns + 1};
  if (how == Reconstruction::bicubic) return bicubic_patch(corners, s, t);
  if (how == Reconstruction::bilinear) return bilinear_patch(corners, s, t);
  return how == Reconstruction::constant ? constant_patch(corners) : smooth_cell(corners, s, t, how);
}

// Returns the grid around a point of a flat part whose triangle side refers to `place`.
inline const RadiosityGrid& grid_around(const Scene& scene, std::uint32_t place, const Vec3& point) {
  while (is_cut(place)) {
    const RadiosityCut& cut = scene.radiosity_cuts[place & ~kRadiosityCutBits];
    place = cut.part[dot(point - cut.origin, cut.across) > 0];
  }
  return scene.radiosity_grids[place & ~kRadiosityGridBit];
}

// Returns the corners of the part of a triangle around a point; the weights become barycentric within the part.
inline const RadiosityCorners& corners_around(const Scene& scene, std::uint32_t place, float* weight) {
  if (!is_split(place)) return scene.radiosity_corners[place];
  while (place & kRadiositySplitBit) {
    const RadiositySplit& split = scene.radiosity_splits[place & kRadiosityPartMax];
    const std::uint32_t turn = turn_of(place);
    const float a = weight[turn], b = weight[turn < 2 ? turn + 1 : 0], c = weight[turn ? turn - 1 : 2];
    const bool second = a < b;  // beyond the middle of AB
    weight[0] = second ? 2 * a : a - b, weight[1] = second ? b - a : 2 * b, weight[2] = c;
    place = split.part[second];
  }
  return scene.radiosity_corners[place & kRadiosityPartMax];
}

struct RadiosityIndirect {
  static constexpr const char* kName = "radiosity";
  static constexpr EffectMask kEffects = bit(Effect::radiosity);
  static constexpr IndirectReference kReference = IndirectReference::nothing;  // its paths carry this light
  static constexpr const char *kPresent = "a stored solution", *kAbsent = "no stored solution";
  static IndirectUse use(const Scene& scene) {
    return scene.radiosity_triangles.count ? IndirectUse::automatic : IndirectUse::nothing;
  }
  static IndirectNeed need(const Scene& scene, const Quality& how) {
    if (!is_smooth_on_triangles(how.reconstruction)) return {};
    return {gradients_need(scene), gradients_scratch_need(scene)};
  }
  static const void* prepare(const Scene& scene, const Quality& how, Arena* keep, Arena* scratch) {
    return is_smooth_on_triangles(how.reconstruction) ? set_gradients(scene, keep, scratch) : nullptr;
  }
  static Vec3 radiance(const IndirectPoint& at) {
    const Scene& scene = at.scene;
    if (scene.radiosity_triangles.empty()) return {0, 0, 0};  // --effects all
    const Vec3 albedo = at.diffuse + at.glossy * kPhongAlbedo;
    if (is_zero(albedo)) return {0, 0, 0};
    effect_entered<Effect::radiosity>();
    const std::uint32_t side = at.front ? at.triangle : at.triangle + scene.triangles.count;
    if (side >= scene.radiosity_triangles.count) return {0, 0, 0};
    const std::uint32_t place = scene.radiosity_triangles[side];
    if (place == kNone) return {0, 0, 0};
    const float w = 1 - at.u - at.v;
    const Triangle& t = scene.triangles[at.triangle];
    if (place & kRadiosityGridBit) {
      const Vec3 point =
          scene.positions[t.vertex(0)] * w + scene.positions[t.vertex(1)] * at.u + scene.positions[t.vertex(2)] * at.v;
      const RadiosityGrid& grid = grid_around(scene, place, point);
      const Vec3 value = radiosity_of_grid(scene, grid, point, at.reconstruction);
      // Rounding may exceed the range of the limited patches.
      return albedo * min(max(value, Vec3{0, 0, 0}), scene.radiosity_info[0].value_max);
    }
    const Vec3& most = scene.radiosity_info[0].value_max;
    if (is_smooth_on_triangles(at.reconstruction)) {
      const auto* gradients = static_cast<const RadiosityGradient*>(at.prepared);
      const Vec3 value = smooth_part(scene, gradients, t, place, at.u, at.v, at.reconstruction);
      return albedo * min(max(value, Vec3{0, 0, 0}), most);
    }
    float weight[3] = {w, at.u, at.v};
    const RadiosityCorners corners = place == kRadiosityAtVertices
                                         ? RadiosityCorners{t.vertex(0), t.vertex(1), t.vertex(2)}
                                         : corners_around(scene, place, weight);
    const Vec3 &a = scene.radiosity_values[corners.value[0]], &b = scene.radiosity_values[corners.value[1]],
               &c = scene.radiosity_values[corners.value[2]];
    const bool constant = at.reconstruction == Reconstruction::constant;
    const Vec3 value = constant ? (a + b + c) * (1.0f / 3) : a * weight[0] + b * weight[1] + c * weight[2];
    return albedo * min(max(value, Vec3{0, 0, 0}), most);
  }
  static Vec3d exact(const Scene&, const Vec3d&) { return {0, 0, 0}; }
  static float bound(const Scene& scene, const Material& material) {
    if (scene.radiosity_info.empty()) return 0;
    Vec3 albedo = material.diffuse;
    if (!reflects_surroundings(material)) albedo += material.specular * kPhongAlbedo;
    return max_component(albedo * scene.radiosity_info[0].value_max);
  }
};

}  // namespace pocketray
