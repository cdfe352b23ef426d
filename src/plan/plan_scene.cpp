#include "plan/plan_scene.h"

#include <algorithm>

#include "accel/triangle.h"
#include "base/check.h"
#include "base/scan.h"
#include "plan/interior.h"
#include "plan/room.h"
#include "scene/triangle_scan.h"

namespace pocketray {

// Returns whether a triangle uses the vertex. Looks first where it would be if vertices came in order of first use.
static bool is_used(const Scene& scene, std::uint32_t vertex) {
  CHECK_LT(vertex, scene.positions.count);
  constexpr std::uint32_t kBefore = 64;
  const std::uint64_t likely = std::uint64_t(vertex) * scene.triangles.count / scene.positions.count;
  const std::uint32_t begin = likely > kBefore ? static_cast<std::uint32_t>(likely) - kBefore : 0;
  return any_uses_vertex({scene.triangles.data + begin, scene.triangles.count - begin}, vertex) ||
         any_uses_vertex({scene.triangles.data, begin}, vertex);
}

// Bounds of all vertices, and a vertex on each side: those of low x, y and z, then of high.
struct VertexBounds {
  Box box;
  std::uint32_t on_side[6];
};

static VertexBounds vertex_bounds(const Scene& scene) {
  constexpr std::uint32_t kPartSize = 256;  // chosen: vertices among which to search for those on a side
  const Array<const Vec3> positions = scene.positions;
  auto part_at = [&](std::uint32_t begin) {
    return Array<const Vec3>{positions.data + begin, std::min(kPartSize, positions.count - begin)};
  };
  VertexBounds bounds = {empty_box(), {}};
  for (std::uint32_t begin = 0; begin < positions.count; begin += kPartSize) {
    const Box part = bounds_of(part_at(begin)), all = bounds.box;
    for (int axis = 0; axis < 3; ++axis) {
      if (part.low[axis] < all.low[axis]) bounds.on_side[axis] = begin;
      if (part.high[axis] > all.high[axis]) bounds.on_side[3 + axis] = begin;
    }
    bounds.box = merge(all, part);
  }
  for (int side = 0; side < 6; ++side) {
    const float plane = side < 3 ? bounds.box.low[side] : bounds.box.high[side - 3];
    std::uint32_t* vertex = &bounds.on_side[side];
    const std::uint32_t end = *vertex + part_at(*vertex).count;
    while (*vertex + 1 < end && positions[*vertex][side % 3] != plane) ++*vertex;
  }
  return bounds;
}

Box scene_bounds(const Scene& scene) {
  if (scene.triangles.empty()) return empty_box();
  const VertexBounds all = vertex_bounds(scene);
  if (std::all_of(all.on_side, all.on_side + 6, [&](std::uint32_t vertex) { return is_used(scene, vertex); }))
    return all.box;
  Box box = empty_box();
  for (const Triangle& t : scene.triangles)
    for (std::uint32_t v : t.vertices()) box = merge(box, scene.positions[v]);
  return box;
}

Camera inside_camera(const Box& bounds, double vertical_fov) {
  CHECK(!is_empty(bounds));
  Camera camera;
  Vec3 middle = center(bounds), half = extent(bounds) * 0.5f;
  // Chosen: from near a corner, a little above the middle, so that two walls and the floor are in view.
  camera.eye = middle + half * Vec3{0.6f, 0.15f, 0.85f};
  camera.target = middle - half * Vec3{0.25f, 0.2f, 0.35f};
  camera.vertical_fov = static_cast<float>(vertical_fov);
  return camera;
}

namespace {

// Fraction of inside_camera()'s distance from the middle that keeps walls out of the way, with a fifth of it to spare.
float share_inside(const Scene& scene, const Box& bounds) {
  const Vec3 middle = center(bounds), way = inside_camera(bounds).eye - middle;
  const float distance = length(way);
  if (!(distance > 0)) return 1;
  const float room = 0.8f * free_distance(scene, middle, way * (1 / distance));
  return room < distance ? room / distance : 1;
}

// Returns whether any light is on.
bool shines(Array<const Light> lights) {
  return std::any_of(lights.begin(), lights.end(), [](const Light& light) { return !is_zero(light.intensity); });
}

constexpr Vec3 kSides[kDefaultViewSides] = {
    {0.45f, 0.35f, 1.0f}, {1.0f, 0.35f, -0.45f}, {-0.45f, 0.35f, -1.0f}, {-1.0f, 0.35f, 0.45f}};

// Chooses among four directions around the scene, 24° to the right and 18° above: the front, unless another shows much
// more of open surfaces' fronts. Much is 0.3 of a side of the box, as in find_room().
std::uint32_t side_to_look_from(const Scene& scene, const Box& bounds) {
  const Vec3d area = shown_area(scene, bounds);
  const double box_side = static_cast<double>(half_area(bounds)) / 3;
  double shown = dot(area, to_double(normalize(kSides[0]))) + 0.3 * box_side;
  std::uint32_t best = 0;
  for (std::uint32_t side = 0; side < kDefaultViewSides; ++side) {
    const double here = dot(area, to_double(normalize(kSides[side])));
    if (here > shown) shown = here, best = side;
  }
  return best;
}

// Returns whether the scene is seen from within, rather than framed.
bool is_seen_from_inside(const DefaultView& view) {
  const bool looks_in = !is_zero(view.opening) && std::fabs(view.opening.y) < 0.5f;  // but not through a missing roof
  return view.is_room && !looks_in;
}

// Unit direction from which a scene is seen from outside.
Vec3 framing_direction(const DefaultView& view) {
  CHECK_LT(view.side, kDefaultViewSides);
  return view.is_room && !is_zero(view.opening) ? view.opening : normalize(kSides[view.side]);
}

}  // namespace

DefaultView find_default_view(const Scene& scene, const Box& bounds) {
  if (scene.default_view.count) return scene.default_view[0];
  DefaultView view;
  if (is_empty(bounds)) return view;
  const Room room = find_room(scene, bounds);
  view.is_room = room.is_room, view.opening = room.opening;
  if (!room.is_room) view.side = side_to_look_from(scene, bounds);
  if (room.has_thick_walls) view.inside_share = share_inside(scene, bounds);
  return view;
}

void add_reach(const Scene& scene, Array<const Vec3> positions, ReachMeter* meter) {
  CHECK(meter != nullptr);
  for (const Triangle& t : scene.triangles)
    if (is_hittable(positions, t))
      for (std::uint32_t v : t.vertices()) meter->add(positions[v]);
}

Framing measure_framing(const Scene& scene, const DefaultView& view, const Box& bounds) {
  Framing framing;
  if (is_empty(bounds)) return framing;
  if (is_seen_from_inside(view)) {
    find_place_to_stand(scene, bounds, &framing.eye, &framing.target);
    return framing;
  }
  // Centring the picture moves the eye aside: turns the view axis until the eye is where it should be.
  const Vec3 towards_eye = framing_direction(view);
  Vec3 axis = towards_eye;
  constexpr int kPasses = 3;  // measured: to within 1°, on the models of tests/session/measured_view_test.cpp
  for (int pass = 0; pass < kPasses; ++pass) {
    if (pass > 0) {
      const Camera camera = framing_camera(framing, bounds, 4.0f / 3);
      axis = normalize(axis + towards_eye - normalize(camera.eye - center(bounds)));
    }
    ReachMeter meter(center(bounds), axis);
    add_reach(scene, scene.positions, &meter);
    framing = meter.framing();
  }
  return framing;
}

Framing find_framing(const Scene& scene, const DefaultView& view, const Box& bounds, std::uint32_t animation) {
  if (scene.framings.count) return scene.framings[std::min(animation, scene.framings.count - 1)];
  return measure_framing(scene, view, bounds);
}

Camera default_camera(const DefaultView& view, const Framing& framing, const Box& bounds, float aspect,
                      double vertical_fov) {
  if (is_empty(bounds) || !is_seen_from_inside(view)) {
    const double fov = vertical_fov > 0 ? vertical_fov : kFramingFieldOfView;
    return is_zero(framing.backward) ? framing_camera(bounds, aspect, framing_direction(view), fov)
                                     : framing_camera(framing, bounds, aspect, fov);
  }
  Camera camera = inside_camera(bounds, vertical_fov > 0 ? vertical_fov : kInsideFieldOfView);
  const Vec3 middle = center(bounds);
  if (view.inside_share < 1) camera.eye = middle + (camera.eye - middle) * view.inside_share;
  if (framing.eye != framing.target) camera.eye = framing.eye, camera.target = framing.target;
  return camera;
}

bool lights_itself(const Scene& scene) {
  if (shines(scene.lights)) return true;
  for (const Material& m : scene.materials)
    if (max_component(m.emission) > 1) return true;
  return lamps_light_up(scene);
}

void default_lights(const DefaultView& view, const Box& bounds, const Camera& camera, Light* lights) {
  CHECK(lights != nullptr);
  // Chosen: the key alone lights a white surface that faces it to 0.83 of display white, which leaves room for the
  // fill's 0.2. In a room, intensities grow with its size squared, so that rooms of any size are equally bright.
  lights[0] = lights[1] = Light();
  if (view.is_room && !is_empty(bounds)) {  // the sun cannot get in
    Vec3 half = extent(bounds) * 0.5f;
    float square = dot(half, half);
    lights[0].position = center(bounds) + Vec3{0, half.y * 0.6f, 0};
    lights[0].intensity = Vec3{0.62f, 0.6f, 0.56f} * square;
    lights[1].position = camera.eye;
    lights[1].intensity = Vec3{0.16f, 0.18f, 0.21f} * (is_zero(view.opening) ? square : 4 * square);
    return;
  }
  Vec3 backward = normalize(camera.eye - camera.target);
  Vec3 right = normalize(cross(camera.up, backward));
  if (is_zero(right)) make_basis(backward, &right, &right);
  Vec3 up = cross(backward, right);
  lights[0].kind = lights[1].kind = LightKind::directional;
  lights[0].direction = -normalize(backward * 0.8f + up * 0.9f - right * 0.7f);
  lights[0].intensity = {2.6f, 2.5f, 2.35f};
  lights[1].direction = -normalize(backward * 0.7f + up * 0.2f + right * 0.9f);
  lights[1].intensity = {0.55f, 0.62f, 0.75f};
}

Light default_sun() {
  Light sun;
  sun.kind = LightKind::directional;
  sun.direction = -normalize(Vec3{-0.5f, 1, 0.6f});
  sun.intensity = {3.0f, 2.9f, 2.7f};  // chosen: it alone lights a white surface that faces it to 0.95 of display white
  return sun;
}

// Chosen: a tenth of the key, so that shadows are not black; the background is darker than white under ambient light
// alone.
Vec3 default_ambient() { return {0.09f, 0.09f, 0.1f}; }
Vec3 default_background() { return {0.045f, 0.05f, 0.06f}; }

bool has_light(const Scene& scene) {
  if (scene.lights.count || !is_zero(scene.info.ambient) || scene.environment_info.count) return true;
  auto needs_no_light = [](const Material& m) { return m.unlit != 0 || !is_zero(m.emission); };
  if (std::none_of(scene.materials.begin(), scene.materials.end(), needs_no_light)) return scene.triangles.empty();
  bool needs_light = false;
  for (std::uint32_t i = 0; i < scene.triangles.count; i = next_material(scene.triangles, i)) {
    const Material& m = scene.materials[scene.triangles[i].material()];  // unused ones emit no light
    if (!is_zero(m.emission)) return true;
    needs_light |= !m.unlit;
  }
  return !needs_light;
}

void leave_out_environment(Scene* scene) {
  CHECK(scene != nullptr);
  if (scene->environment_info.empty()) return;
  const Vec3 mean = max(scene->environment_info[0].irradiance[0], Vec3{0, 0, 0});
  scene->environment_info = {}, scene->environment_texels = {}, scene->environment_suns = {};
  if (scene->info.default_lights != 0)
    scene->info.background = {0, 0, 0};
  else if (has_light(*scene))
    scene->info.ambient = mean;
}

}  // namespace pocketray
