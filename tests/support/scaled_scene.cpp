#include "support/scaled_scene.h"

namespace pocketray {
namespace {

template <class T>
std::vector<T> copy(Array<const T> array) {
  return std::vector<T>(array.begin(), array.end());
}
template <class T>
Array<const T> view(const std::vector<T>& v) {
  return {v.data(), static_cast<std::uint32_t>(v.size())};
}

void scale(std::vector<Vec3>* points, float k) {
  for (Vec3& p : *points) p = p * k;
}
void scale(Transform* t, float k) {
  for (auto& row : t->m) row[3] *= k;
}

void scale_translations(const Scene& source, float k, std::vector<float>* key_values) {
  for (const Channel& channel : source.channels) {
    if (channel.path != ChannelPath::translation) continue;
    std::uint32_t count = 3 * channel.key_count * (channel.interpolation == Interpolation::cubic ? 3 : 1);
    for (std::uint32_t i = 0; i < count; ++i) {
      float value = source.key_values[channel.value_begin + i];
      (*key_values)[channel.value_begin + i] = value * k;  // channels may share values
    }
  }
}

}  // namespace

void ScaledScene::bind() {
  scene.positions = view(positions), scene.rest_positions = view(rest_positions);
  scene.morph_positions = view(morph_positions), scene.triangles = view(triangles);
  scene.materials = view(materials), scene.glass_maps = view(glass_maps);
  scene.lights = view(lights), scene.cameras = view(cameras);
  scene.nodes = view(nodes), scene.key_values = view(key_values), scene.joints = view(joints);
  scene.moving_meshes = view(moving_meshes);
  scene.accel = {};
}

std::unique_ptr<ScaledScene> scale_scene(const Scene& source, float k) {
  auto s = std::make_unique<ScaledScene>();
  s->scene = source;
  s->positions = copy(source.positions), s->rest_positions = copy(source.rest_positions);
  s->morph_positions = copy(source.morph_positions), s->triangles = copy(source.triangles);
  scale(&s->positions, k), scale(&s->rest_positions, k), scale(&s->morph_positions, k);
  s->materials = copy(source.materials);
  for (Material& m : s->materials) m.absorption = m.absorption * (1 / k);
  s->glass_maps = copy(source.glass_maps);
  for (GlassMap& glass : s->glass_maps) glass.thickness *= k;
  s->lights = copy(source.lights);
  for (Light& light : s->lights) {
    light.position = light.position * k;
    light.range *= k;
    if (light.kind != LightKind::directional) light.intensity = light.intensity * (k * k);
  }
  s->cameras = copy(source.cameras);
  for (Camera& c : s->cameras) c.eye = c.eye * k, c.target = c.target * k, c.vertical_extent *= k;
  s->nodes = copy(source.nodes);
  for (Node& node : s->nodes) node.translation = node.translation * k;
  s->key_values = copy(source.key_values);
  scale_translations(source, k, &s->key_values);
  s->joints = copy(source.joints);
  for (Joint& joint : s->joints) scale(&joint.inverse_bind, k);
  s->moving_meshes = copy(source.moving_meshes);
  for (MovingMesh& mesh : s->moving_meshes) scale(&mesh.instance, k);
  s->bind();
  return s;
}

}  // namespace pocketray
