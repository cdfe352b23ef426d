#include "desktop/import/scene_builder.h"

#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "base/limits.h"
#include "desktop/import/broken_faces.h"
#include "desktop/import/glass.h"
#include "desktop/import/image.h"
#include "desktop/import/import_error.h"
#include "desktop/import/origin.h"
#include "desktop/import/reduce.h"
#include "desktop/import/tangents.h"
#include "scene/animate.h"
#include "scene/baked.h"
#include "scene/metallic_roughness.h"

namespace pocketray {

static void add_once(std::vector<std::string>* list, const std::string& text) {
  if (std::find(list->begin(), list->end(), text) == list->end()) list->push_back(text);
}
void note_unused(SceneBuilder* builder, const std::string& what) { add_once(&builder->unused, what); }
void note_remark(SceneBuilder* builder, const std::string& what) { add_once(&builder->remarks, what); }

void require_bytes(const SceneBuilder& builder, std::uint64_t count, std::uint64_t element_bytes, const char* what) {
  std::uint64_t max = builder.options.byte_count_max, left = max - std::min(builder.bytes_charged, max);
  if (element_bytes > 0 && count > left / element_bytes)
    fail_import("%s would take the scene beyond %llu MiB; use a smaller model", what,
                static_cast<unsigned long long>(max >> 20));
}
void charge_bytes(SceneBuilder* builder, std::uint64_t bytes, const char* what) {
  require_bytes(*builder, bytes, 1, what);
  builder->bytes_charged += bytes;
}

void require_invertible(const Transform& t, const std::string& name) {
  for (const auto& row : t.m)
    for (float value : row)
      if (!(std::fabs(value) <= kCoordinateMax))
        fail_import("%.100s: its transform is not finite; export the file again", name.c_str());
  if (!is_invertible(t))
    fail_import("%.100s: its transform cannot be inverted (determinant %g); give it a scale other than 0", name.c_str(),
                determinant(t));
}

// Keeps only the elements `kept` of each run of `stride` elements.
template <class T>
static void gather(std::vector<T>* array, const std::vector<std::uint32_t>& kept, std::size_t stride) {
  if (array->empty()) return;
  std::vector<T> result;
  result.reserve(array->size() / stride * kept.size());
  for (std::size_t begin = 0; begin < array->size(); begin += stride)
    for (std::uint32_t index : kept) result.push_back((*array)[begin + index]);
  array->swap(result);
}

void tidy_mesh(MeshData* mesh) {
  std::size_t count = mesh->positions.size();
  CHECK(mesh->normals.empty() || mesh->normals.size() == count);
  CHECK(mesh->uvs.empty() || mesh->uvs.size() == count);
  CHECK(mesh->second_uvs.empty() || mesh->second_uvs.size() == count);
  CHECK(mesh->tangents.empty() || mesh->tangents.size() == count);
  CHECK(mesh->colors.empty() || mesh->colors.size() == count);
  CHECK(mesh->skin_weights.empty() || mesh->skin_weights.size() == count);
  CHECK_EQ(mesh->morph_positions.size(), mesh->morph_count * count);
  CHECK(mesh->morph_normals.empty() || mesh->morph_normals.size() == mesh->morph_count * count);
  CHECK_EQ(mesh->indices.size() % 3, 0u);
  CHECK(mesh->triangle_materials.empty() || mesh->triangle_materials.size() == mesh->indices.size() / 3);
  std::vector<std::uint32_t> renumbered(count, kNone), kept;
  for (std::uint32_t& index : mesh->indices) {
    if (index >= count)
      fail_import("%s: index %u, but there are only %zu vertices; export the file again", mesh->name.c_str(), index,
                  count);
    if (renumbered[index] == kNone) {
      renumbered[index] = static_cast<std::uint32_t>(kept.size());
      kept.push_back(index);
    }
  }
  if (kept.size() == count) return;
  std::sort(kept.begin(), kept.end());
  for (std::size_t i = 0; i < kept.size(); ++i) renumbered[kept[i]] = static_cast<std::uint32_t>(i);
  for (std::uint32_t& index : mesh->indices) index = renumbered[index];
  gather(&mesh->morph_positions, kept, count);
  gather(&mesh->morph_normals, kept, count);
  gather(&mesh->positions, kept, count);
  gather(&mesh->normals, kept, count);
  gather(&mesh->uvs, kept, count);
  gather(&mesh->second_uvs, kept, count);
  gather(&mesh->tangents, kept, count);
  gather(&mesh->colors, kept, count);
  gather(&mesh->skin_weights, kept, count);
}

// Extends an array that only some meshes have to `count` elements, unless no mesh has had it so far.
template <class T>
static void append_optional(std::vector<T>* all, const std::vector<T>& more, std::size_t begin, std::size_t count,
                            T filler) {
  if (all->empty() && more.empty()) return;
  all->resize(begin, filler);
  all->insert(all->end(), more.begin(), more.end());
  all->resize(begin + count, filler);
}

// Bytes by which append_optional() extends an array.
template <class T>
static std::uint64_t optional_bytes(const std::vector<T>& all, const std::vector<T>& more, std::size_t end) {
  return all.empty() && more.empty() ? 0 : (end - all.size()) * sizeof(T);
}

static std::uint64_t vertex_bytes(const SceneArrays& out, const MeshData& mesh) {
  const std::size_t count = mesh.positions.size(), end = out.positions.size() + count;
  const bool has_tangents = !mesh.tangents.empty() || !out.tangents.empty();
  return count * sizeof(Vec3) + optional_bytes(out.normals, mesh.normals, end) +
         optional_bytes(out.uvs, mesh.uvs, end) + optional_bytes(out.second_uvs, mesh.second_uvs, end) +
         optional_bytes(out.colors, mesh.colors, end) +
         (has_tangents ? (end - out.tangents.size()) * sizeof(PackedTangent) : 0);
}

static std::vector<Vec3> placed_vertices(const SceneBuilder& builder, const MeshData& mesh, const Transform& to_world,
                                         const ExactTransform* exactly) {
  const bool is_recentred = exactly && !builder.out->origin.empty();
  const Vec3d origin = origin_of(builder);
  std::vector<Vec3> placed;
  placed.reserve(mesh.positions.size());
  for (const Vec3& p : mesh.positions)
    placed.push_back(is_recentred ? to_float(transform_point(*exactly, to_double(p)) - origin)
                                  : transform_point(to_world, p));
  return placed;
}

void append_mesh(SceneBuilder* builder, const MeshData& mesh, const Transform& to_world,
                 const ExactTransform* exactly) {
  SceneArrays& out = *builder->out;
  const std::vector<Vec3> placed = placed_vertices(*builder, mesh, to_world, exactly);
  MeshData kept;
  const MeshData& usable = without_broken_faces(mesh, placed, builder, &kept);
  if (&usable != &mesh) return append_mesh(builder, usable, to_world, exactly);
  std::size_t begin = out.positions.size(), count = mesh.positions.size(), triangle_count = mesh.indices.size() / 3;
  if (count == 0) return;
  charge_bytes(builder, vertex_bytes(out, mesh) + triangle_count * sizeof(Triangle), "the geometry");
  if (begin + count > kVertexCountMax) fail_import("more than %u vertices; simplify the model", kVertexCountMax);
  if (out.triangles.size() + triangle_count > kTriangleCountMax)
    fail_import("more than %u triangles; simplify the model", kTriangleCountMax);

  out.positions.reserve(begin + count > out.positions.capacity() ? std::max(begin + count, begin * 3 / 2) : 0);
  out.positions.insert(out.positions.end(), placed.begin(), placed.end());
  std::vector<Vec3> normals(mesh.normals.size());
  NormalTransform normal_to_world = normal_transform(to_world);
  for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = transform_normal(normal_to_world, mesh.normals[i]);
  append_optional(&out.normals, normals, begin, count, Vec3{0, 0, 0});
  append_optional(&out.uvs, mesh.uvs, begin, count, Vec2{0, 0});
  append_optional(&out.second_uvs, mesh.second_uvs, begin, count, Vec2{0, 0});
  append_optional(&out.colors, mesh.colors, begin, count, Rgba16{65535, 65535, 65535, 65535});
  append_optional(&out.tangents, pack_tangents(mesh.tangents, to_world), begin, count, PackedTangent());

  bool mirrored = determinant(to_world) < 0;
  std::uint32_t base = static_cast<std::uint32_t>(begin);
  for (std::size_t t = 0; t < triangle_count; ++t) {
    const std::uint32_t* v = &mesh.indices[3 * t];
    std::uint32_t material = mesh.triangle_materials.empty() ? mesh.material : mesh.triangle_materials[t];
    out.triangles.emplace_back(base + v[0], base + v[mirrored ? 2 : 1], base + v[mirrored ? 1 : 2], material);
  }
}

void append_moving_mesh(SceneBuilder* builder, const MeshData& whole, const Transform& to_world, MovingMesh moving) {
  SceneArrays& out = *builder->out;
  MeshData kept_at_rest, kept;
  const MeshData& at_rest = without_broken_faces(whole, whole.positions, builder, &kept_at_rest);
  const MeshData& mesh =
      without_broken_faces(at_rest, placed_vertices(*builder, at_rest, to_world, nullptr), builder, &kept);
  std::size_t count = mesh.positions.size();
  if (count == 0) return;
  charge_bytes(builder,
               count * (2 * sizeof(Vec3) + sizeof(SkinWeight)) +
                   (mesh.morph_positions.size() + mesh.morph_normals.size()) * sizeof(Vec3),
               "the moving meshes");
  moving.vertex_begin = static_cast<std::uint32_t>(out.positions.size());
  moving.vertex_count = static_cast<std::uint32_t>(count);
  moving.rest_begin = static_cast<std::uint32_t>(out.rest_positions.size());
  append_mesh(builder, mesh, to_world);
  append_optional(&out.rest_normals, mesh.normals, out.rest_positions.size(), count, Vec3{0, 0, 0});
  out.rest_positions.insert(out.rest_positions.end(), mesh.positions.begin(), mesh.positions.end());
  moving.skin_weight_begin = static_cast<std::uint32_t>(out.skin_weights.size());
  out.skin_weights.insert(out.skin_weights.end(), mesh.skin_weights.begin(), mesh.skin_weights.end());
  moving.morph_begin = static_cast<std::uint32_t>(out.morph_positions.size());
  moving.morph_count = mesh.morph_count;
  append_optional(&out.morph_normals, mesh.morph_normals, out.morph_positions.size(), mesh.morph_positions.size(),
                  Vec3{0, 0, 0});
  out.morph_positions.insert(out.morph_positions.end(), mesh.morph_positions.begin(), mesh.morph_positions.end());
  out.moving_meshes.push_back(moving);
}

static std::string warning_line(const SceneBuilder& builder) {
  std::string line;
  for (const std::string& item : builder.unused) line += (line.empty() ? "not used: " : ", ") + item;
  if (builder.broken_face_count > 0)
    line += (line.empty() ? "" : "; ") + std::to_string(builder.broken_face_count) +
            (builder.broken_face_count == 1 ? " face is left out, as a vertex is"
                                            : " faces are left out, as vertices are") +
            " not finite or beyond 1e18 (--strict names the first)";
  for (const std::string& item : builder.remarks) line += (line.empty() ? "" : "; ") + item;
  return line;
}

template <class T>
static Array<const T> view(const std::vector<T>& v) {
  return {v.empty() ? nullptr : v.data(), static_cast<std::uint32_t>(v.size())};
}

Scene view_of(const SceneArrays& arrays) {
  Scene scene;
  scene.info = arrays.info;
  scene.positions = view(arrays.positions), scene.normals = view(arrays.normals);
  scene.uvs = view(arrays.uvs), scene.second_uvs = view(arrays.second_uvs), scene.colors = view(arrays.colors);
  scene.triangles = view(arrays.triangles), scene.materials = view(arrays.materials),
  scene.material_maps = view(arrays.material_maps), scene.grains = view(arrays.grains);
  scene.clear_coats = view(arrays.clear_coats), scene.sheens = view(arrays.sheens);
  scene.glass_maps = view(arrays.glass_maps), scene.iridescences = view(arrays.iridescences);
  scene.diffuse_transmissions = view(arrays.diffuse_transmissions);
  scene.tangents = view(arrays.tangents);
  scene.textures = view(arrays.textures), scene.texels = view(arrays.texels);
  scene.lights = view(arrays.lights), scene.cameras = view(arrays.cameras);
  scene.camera_near = view(arrays.camera_near);
  scene.nodes = view(arrays.nodes), scene.animations = view(arrays.animations), scene.channels = view(arrays.channels);
  scene.key_times = view(arrays.key_times), scene.key_values = view(arrays.key_values),
  scene.weights = view(arrays.weights);
  scene.skins = view(arrays.skins), scene.joints = view(arrays.joints),
  scene.moving_meshes = view(arrays.moving_meshes);
  scene.rest_positions = view(arrays.rest_positions), scene.rest_normals = view(arrays.rest_normals);
  scene.skin_weights = view(arrays.skin_weights);
  scene.morph_positions = view(arrays.morph_positions), scene.morph_normals = view(arrays.morph_normals);
  scene.animation_labels = view(arrays.animation_labels), scene.node_visible = view(arrays.node_visible);
  scene.origin = view(arrays.origin), scene.reductions = view(arrays.reductions);
  return scene;
}

// Poses moving vertices by animation 0 at time 0.
static void pose_at_start(const Scene& scene, const SceneBuilder& builder) {
  SceneArrays* out = builder.out.get();
  if (scene.moving_meshes.empty()) return;
  std::size_t bytes = pose_need(scene) + kArenaAlignment;
  require_bytes(builder, bytes, 1, "the pose");
  std::vector<std::uint8_t> block(bytes);
  Arena arena = make_arena("pose", block.data(), bytes);
  Pose pose = make_pose(scene, &arena);
  std::copy(pose.positions.begin(), pose.positions.end(), out->positions.begin());
  std::copy(pose.normals.begin(), pose.normals.end(), out->normals.begin());
}

std::uint32_t add_material(SceneBuilder* builder, const Material& material, const std::string& name) {
  std::vector<Material>& materials = builder->out->materials;
  if (materials.size() >= kMaterialCountMax) fail_import("more than %u materials; merge some", kMaterialCountMax);
  builder->material_names.resize(materials.size());
  builder->material_names.push_back(name);
  materials.push_back(material);
  return static_cast<std::uint32_t>(materials.size() - 1);
}

std::uint32_t begin_part(SceneBuilder* builder, const std::string& name, std::uint32_t parent) {
  builder->parts.push_back({name, parent, builder->out->positions.size()});
  return static_cast<std::uint32_t>(builder->parts.size() - 1);
}

// Parts come after their ancestors.
static NamedBoxes named_parts(const SceneBuilder& builder) {
  const std::vector<Vec3>& positions = builder.out->positions;
  std::vector<Box> boxes(builder.parts.size(), empty_box());
  std::size_t end = positions.size();
  for (std::size_t i = boxes.size(); i-- > 0;) {
    const PartSource& part = builder.parts[i];
    for (std::size_t v = part.vertex_begin; v < end; ++v) boxes[i] = merge(boxes[i], positions[v]);
    end = part.vertex_begin;
    if (part.parent != kNone) boxes[part.parent] = merge(boxes[part.parent], boxes[i]);
  }
  NamedBoxes named;
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (!builder.parts[i].name.empty() && !is_empty(boxes[i])) named.emplace_back(builder.parts[i].name, boxes[i]);
  return named;
}

static bool has_texture(const Material& material) {
  return material.diffuse_texture.texture != kNone || material.emission_texture.texture != kNone;
}

void finish_scene(SceneBuilder* builder, const std::string& name, ImportedScene* result) {
  SceneArrays& out = *builder->out;
  if (out.triangles.empty()) {
    const std::string why = warning_line(*builder);
    fail_import("no triangles to render; export meshes with faces%s%s%s", why.empty() ? "" : " (", why.c_str(),
                why.empty() ? "" : ")");
  }
  if (out.materials.empty()) out.materials.emplace_back();
  decide_glass(builder);
  if (builder->options.tells_halved && builder->halved_count > 0)
    note_remark(builder, std::to_string(builder->halved_count) +
                             (builder->halved_count == 1 ? " texture" : " textures") + " halved to at most " +
                             std::to_string(builder->options.texture_side_max) + " texels a side (--texture-max)");
  std::size_t count = out.positions.size();
  if (!out.normals.empty()) out.normals.resize(count, Vec3{0, 0, 0});
  auto any_textured = [](const auto& entries) {
    return std::any_of(entries.begin(), entries.end(), [](const auto& entry) { return is_textured(entry); });
  };
  bool textured = std::any_of(out.materials.begin(), out.materials.end(), has_texture) ||
                  any_textured(out.clear_coats) || any_textured(out.sheens) || any_textured(out.glass_maps) ||
                  any_textured(out.iridescences) || any_textured(out.diffuse_transmissions) ||
                  std::any_of(out.material_maps.begin(), out.material_maps.end(), has_map) ||
                  std::any_of(out.grains.begin(), out.grains.end(),
                              [](const Grain& grain) { return grain.texture.texture != kNone; });
  if (textured || !out.uvs.empty()) out.uvs.resize(count, Vec2{0, 0});
  const bool reads_second =
      std::any_of(out.textures.begin(), out.textures.end(), [](const Texture& texture) { return texture.uv_set > 0; });
  reads_second ? out.second_uvs.resize(count, Vec2{0, 0}) : out.second_uvs.clear();
  if (!out.material_maps.empty()) out.material_maps.resize(out.materials.size());
  if (!out.grains.empty()) out.grains.resize(out.materials.size());
  if (!out.clear_coats.empty()) out.clear_coats.resize(out.materials.size());
  if (!out.sheens.empty()) out.sheens.resize(out.materials.size());
  if (!out.glass_maps.empty()) out.glass_maps.resize(out.materials.size());
  if (!out.iridescences.empty()) out.iridescences.resize(out.materials.size());
  if (!out.diffuse_transmissions.empty()) out.diffuse_transmissions.resize(out.materials.size());
  if (!out.camera_near.empty()) out.camera_near.resize(out.cameras.size());
  make_tangents(builder);
  if (!out.colors.empty()) out.colors.resize(count, Rgba16{65535, 65535, 65535, 65535});
  if (!out.normals.empty() && !out.rest_positions.empty())
    out.rest_normals.resize(out.rest_positions.size(), Vec3{0, 0, 0});
  if (!out.morph_normals.empty()) out.morph_normals.resize(out.morph_positions.size(), Vec3{0, 0, 0});
  std::snprintf(out.info.name, sizeof out.info.name, "%s", name.c_str());

  Scene& scene = result->scene;
  scene = view_of(out);
  Status status = validate_scene(scene);
  if (!status.ok) fail_import("%s", status.message);
  pose_at_start(scene, *builder);
  if (builder->options.reduce) reduce(&out);
  leave_out_levels(builder->options.texture_side_max, &out);
  scene = view_of(out);
  result->storage = builder->out;
  result->warning = warning_line(*builder);
  result->parts = named_parts(*builder);
  result->files.assign(builder->files.paths.begin(), builder->files.paths.end());
  result->material_names = std::move(builder->material_names);
}

}  // namespace pocketray
