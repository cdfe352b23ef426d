#include <cmath>
#include <cstring>

#include "base/fmath.h"
#include "brdf/brdf_list.h"
#include "scene/metallic_roughness.h"
#include "scene/texture_levels.h"
#include "support/generated_scene.h"

namespace pocketray {

namespace {

template <class T>
Array<const T> view(const std::vector<T>& v) {
  return {v.data(), static_cast<std::uint32_t>(v.size())};
}
template <class T>
Array<const T> view(const std::vector<T>& v, bool wanted) {
  return wanted ? view(v) : Array<const T>();
}

}  // namespace

void GeneratedScene::bind() {
  scene.positions = view(positions), scene.normals = view(normals, with_normals), scene.uvs = view(uvs, with_uvs);
  scene.second_uvs = view(second_uvs, with_second_uvs);
  scene.colors = view(colors, with_colors), scene.triangles = view(triangles), scene.materials = view(materials),
  scene.material_maps = view(material_maps), scene.grains = view(grains);
  scene.clear_coats = view(clear_coats), scene.sheens = view(sheens);
  scene.glass_maps = view(glass_maps), scene.iridescences = view(iridescences);
  scene.diffuse_transmissions = view(diffuse_transmissions);
  if (!tangents.empty()) tangents.resize(positions.size());
  scene.tangents = view(tangents);
  scene.textures = view(textures), scene.texels = view(texels), scene.lights = view(lights);
  scene.cameras = view(cameras), scene.nodes = view(nodes), scene.animations = view(animations);
  scene.channels = view(channels), scene.key_times = view(key_times), scene.key_values = view(key_values);
  scene.moving_meshes = view(moving_meshes), scene.rest_positions = view(rest_positions);
  scene.rest_normals = view(rest_normals, with_normals);
}

std::uint32_t add_material(GeneratedScene* s, const Material& material) {
  s->materials.push_back(material);
  return static_cast<std::uint32_t>(s->materials.size() - 1);
}

std::uint32_t add_vertex(GeneratedScene* s, const Vec3& position, const Vec3& normal, Vec2 uv) {
  s->positions.push_back(position);
  s->normals.push_back(normal);
  s->uvs.push_back(uv);
  s->second_uvs.push_back({0.9f - 0.7f * uv.y, 0.3f + 1.3f * uv.x});
  auto channel = [&](float x) { return static_cast<std::uint16_t>(32768 + 32767 * std::sin(3 * x)); };
  s->colors.push_back({channel(position.x), channel(position.y), channel(position.z), 65535});
  return static_cast<std::uint32_t>(s->positions.size() - 1);
}

void add_map(GeneratedScene* s, std::uint32_t material, const MetallicRoughness& model, std::uint32_t texture) {
  s->material_maps.resize(s->materials.size());
  MaterialMaps& maps = s->material_maps[material];
  maps.model = model, maps.metallic = maps.roughness = 1;
  maps.metallic_high = maps.roughness_high = 1;
  maps.metallic_roughness.texture = texture;
  set_lobes(model, 0.5f, 0.5f, 0, &s->materials[material]);
  s->materials[material].brdf = kGgx;
}

void add_triangle(GeneratedScene* s, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material) {
  s->triangles.emplace_back(a, b, c, material);
}

void add_quad(GeneratedScene* s, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::uint32_t material) {
  std::uint32_t first = add_vertex(s, a, {0, 0, 0}, {0, 0});
  add_vertex(s, b, {0, 0, 0}, {1, 0});
  add_vertex(s, c, {0, 0, 0}, {1, 1});
  add_vertex(s, d, {0, 0, 0}, {0, 1});
  add_triangle(s, first, first + 1, first + 2, material);
  add_triangle(s, first, first + 2, first + 3, material);
}

void add_box(GeneratedScene* s, const Vec3& low, const Vec3& high, std::uint32_t material, bool room) {
  auto corner = [&](int i) { return Vec3{i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z}; };
  constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (const auto& f : kFaces)
    add_quad(s, corner(f[0]), corner(f[room ? 3 : 1]), corner(f[2]), corner(f[room ? 1 : 3]), material);
}

void add_sphere(GeneratedScene* s, const Vec3& center, float radius, int columns, int rows, std::uint32_t material) {
  std::uint32_t first = static_cast<std::uint32_t>(s->positions.size());
  auto add = [&](int row, int column) {
    double polar = kPi * row / rows, around = 2 * kPi * column / columns;
    Vec3 n = {static_cast<float>(det_sin(polar) * det_cos(around)), static_cast<float>(det_cos(polar)),
              static_cast<float>(-det_sin(polar) * det_sin(around))};
    if (row == 0) n = {0, 1, 0};
    if (row == rows) n = {0, -1, 0};
    add_vertex(
        s, center + n * radius, n,
        {static_cast<float>(column) / static_cast<float>(columns), static_cast<float>(row) / static_cast<float>(rows)});
  };
  add(0, 0);
  for (int row = 1; row < rows; ++row)
    for (int column = 0; column < columns; ++column) add(row, column);
  add(rows, 0);
  auto at = [&](int row, int column) {
    if (row == 0) return first;
    if (row == rows) return first + static_cast<std::uint32_t>(columns * (rows - 1) + 1);
    return first + 1 + static_cast<std::uint32_t>((row - 1) * columns + column % columns);
  };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      if (row + 1 < rows) add_triangle(s, at(row, column), at(row + 1, column), at(row + 1, column + 1), material);
      if (row > 0) add_triangle(s, at(row, column), at(row + 1, column + 1), at(row, column + 1), material);
    }
}

std::uint32_t add_texture(GeneratedScene* s, int width, int height, const std::vector<std::array<int, 4>>& rgba,
                          Wrap wrap_u, Wrap wrap_v, bool nearest) {
  Texture t = {};
  t.level_count = 1;
  t.texel_begin = static_cast<std::uint32_t>(s->texels.size());
  t.width = static_cast<std::uint16_t>(width);
  t.height = static_cast<std::uint16_t>(height);
  t.wrap_u = wrap_u, t.wrap_v = wrap_v, t.nearest = nearest;
  for (const auto& texel : rgba) {
    std::uint8_t bytes[4];
    for (int i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(texel[static_cast<std::size_t>(i)]);
    std::uint32_t word;
    std::memcpy(&word, bytes, sizeof word);
    s->texels.push_back(word);
  }
  s->textures.push_back(t);
  return static_cast<std::uint32_t>(s->textures.size() - 1);
}

void add_levels(GeneratedScene* s, std::uint32_t texture) {
  Texture& t = s->textures[texture];
  const std::size_t count = std::size_t(t.width) * t.height, begin = s->texels.size();
  const std::vector<std::uint32_t> texels(s->texels.begin() + t.texel_begin, s->texels.begin() + t.texel_begin + count);
  t.texel_begin = static_cast<std::uint32_t>(begin);
  t.level_count = static_cast<std::uint8_t>(level_count_max(t.width, t.height));
  s->texels.insert(s->texels.end(), texels.begin(), texels.end());
  s->texels.resize(begin + level_texels(t.width, t.height, t.level_count));
  std::vector<float> scratch(level_scratch_need(t.width, t.height));
  make_levels(texels.data(), t.width, t.height, TexelKind::colors, scratch.data(), s->texels.data() + begin + count);
}

void aim(GeneratedScene* s, const Vec3& eye, const Vec3& target, double vertical_fov_degrees) {
  Camera camera;
  camera.eye = eye;
  camera.target = target;
  camera.vertical_fov = static_cast<float>(radians(vertical_fov_degrees));
  s->cameras.assign(1, camera);
}

}  // namespace pocketray
