// KHR_lights_punctual and cameras (sec. 3.10).
#include <algorithm>
#include <cmath>

#include "base/fmath.h"
#include "base/limit_list.h"
#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

Vec3 column(const Transform& t, int c) { return {t.m[0][c], t.m[1][c], t.m[2][c]}; }

void add_light(GltfFile* file, std::size_t light_index, int node_index) {
  const tinygltf::Light& source = file->model.lights[light_index];
  SceneArrays& out = *file->builder->out;
  if (out.lights.size() >= kLightCountMax) fail_import("more than %u lights; remove some", kLightCountMax);
  Light light;
  if (source.type == "point") {
    light.kind = LightKind::point;
  } else if (source.type == "spot") {
    light.kind = LightKind::spot;
  } else if (source.type == "directional") {
    light.kind = LightKind::directional;
  } else {
    note_unused(file->builder, "lights of unknown kind");
    return;
  }
  Transform t = gltf_fixed_part(*file, node_index, &light.node);
  light.position = column(t, 3);
  light.direction = normalize(-column(t, 2));  // along −z
  if (is_zero(light.direction)) light.direction = {0, 0, -1};
  double intensity = std::isfinite(source.intensity) ? std::min(std::max(source.intensity, 0.0), 1e18) : 0;
  for (std::size_t c = 0; c < 3; ++c) {
    double color = source.color.size() >= 3 ? source.color[c] : 1;
    light.intensity[static_cast<int>(c)] = static_cast<float>(intensity * (color > 0 ? std::min(color, 1e6) : 0));
  }
  light.range = source.range > 0 && source.range < 1e18 ? static_cast<float>(source.range) : 0;
  if (light.kind == LightKind::spot) {
    double outer = std::min(std::max(source.spot.outerConeAngle, 0.0), kPi / 2);
    double inner = std::min(std::max(source.spot.innerConeAngle, 0.0), outer);
    light.cos_outer = static_cast<float>(det_cos(outer));
    // Between the cones, the cosine falls by at least 0.001 (KHR_lights_punctual, "Inner and Outer Cone Angles").
    light.cos_inner = static_cast<float>(std::min(std::max(det_cos(inner), det_cos(outer) + 0.001), 1.0));
  }
  file->lights[light_index].push_back(static_cast<std::uint32_t>(out.lights.size()));
  out.lights.push_back(light);
  out.info.auto_exposure = 1;  // candela and lux: the raw numbers are too bright for any display
}

void add_camera(GltfFile* file, int camera_index, int node_index) {
  SceneArrays& out = *file->builder->out;
  if (camera_index < 0 || static_cast<std::size_t>(camera_index) >= file->model.cameras.size())
    fail_import("camera %d does not exist; export the file again", camera_index);
  if (out.cameras.size() >= kCameraCountMax) fail_import("more than %u cameras; remove some", kCameraCountMax);
  const tinygltf::Camera& source = file->model.cameras[static_cast<std::size_t>(camera_index)];
  Camera camera;
  Transform t = gltf_fixed_part(*file, node_index, &camera.node);
  camera.eye = column(t, 3);
  Vec3 forward = normalize(-column(t, 2)), up = normalize(column(t, 1));
  camera.target = camera.eye + forward;
  camera.up = up;
  double size = source.type == "orthographic" ? 2 * source.orthographic.ymag : source.perspective.yfov;
  Quantity quantity = source.type == "orthographic" ? Quantity::vertical_extent : Quantity::field_of_view;
  bool valid = within(quantity, static_cast<float>(size)) && !is_zero(forward) && camera.target != camera.eye &&
               !is_zero(cross(forward, up));
  if (!valid) {
    note_unused(file->builder, "cameras without a valid view");
    return;
  }
  if (source.type == "orthographic") {
    camera.projection = Projection::orthographic;
    camera.vertical_extent = static_cast<float>(size);
  } else {
    camera.vertical_fov = static_cast<float>(size);
  }
  file->cameras[static_cast<std::size_t>(camera_index)].push_back(static_cast<std::uint32_t>(out.cameras.size()));
  out.cameras.push_back(camera);
  const double near_distance = source.type == "orthographic" ? source.orthographic.znear : source.perspective.znear;
  out.camera_near.resize(out.cameras.size());
  if (near_distance > 0 && near_distance <= static_cast<double>(kCoordinateMax))
    out.camera_near.back() = static_cast<float>(near_distance);
}

}  // namespace

void gltf_lights_and_cameras(GltfFile* file) {
  file->lights.resize(file->model.lights.size());
  file->cameras.resize(file->model.cameras.size());
  for (std::size_t i = 0; i < file->visible_count; ++i) {
    int index = file->order[i];
    const tinygltf::Node& node = file->model.nodes[static_cast<std::size_t>(index)];
    if (node.camera >= 0) add_camera(file, node.camera, index);
    const tinygltf::Value* extension = gltf_extension(node.extensions, "KHR_lights_punctual");
    if (!extension) continue;
    double light = gltf_number(*extension, "light", -1);
    if (!(light >= 0) || light >= static_cast<double>(file->model.lights.size()))
      fail_import("%s: its light does not exist; export the file again", gltf_node_name(*file, index).c_str());
    if (!file->nodes[static_cast<std::size_t>(index)].unseen) add_light(file, static_cast<std::size_t>(light), index);
  }
}

}  // namespace pocketray
