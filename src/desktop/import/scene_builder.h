// Collects a scene on the heap while reading a file; shared by all formats. Throws ImportError.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "desktop/import/files.h"
#include "scene/scene.h"
#include "session/model_import.h"

namespace pocketray {

// A tangent from a file, perpendicular to the vertex normal; zero: none. The bitangent is normal × direction if
// handedness is 1, its opposite if it is −1.
struct GivenTangent {
  Vec3 direction;
  int handedness;
};

// One mesh with one material, in object space.
struct MeshData {
  std::string name;  // for error lines
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  // unit, one per vertex, or empty: the geometric normal
  std::vector<Vec2> uvs;      // one per vertex, or empty
  std::vector<Vec2> second_uvs;
  std::vector<GivenTangent> tangents;  // one per vertex, or empty; not read if the mesh moves
  std::vector<Rgba16> colors;
  std::vector<std::uint32_t> indices;  // three per triangle, counter-clockwise from the front
  std::uint32_t material = 0;
  std::vector<std::uint32_t> triangle_materials;     // one per triangle instead of `material`, or empty
  std::vector<SkinWeight> skin_weights;              // one per vertex, or empty
  std::uint32_t morph_count = 0;                     // targets
  std::vector<Vec3> morph_positions, morph_normals;  // morph_count × vertices; normals may be empty
};

// The arrays of a Scene, owned.
struct SceneArrays {
  SceneInfo info;
  std::vector<Vec3> positions, normals;
  std::vector<Vec2> uvs, second_uvs;
  std::vector<Rgba16> colors;
  std::vector<Triangle> triangles;
  std::vector<Material> materials;
  std::vector<MaterialMaps> material_maps;                 // of the first materials; the rest have none
  std::vector<Grain> grains;                               // likewise
  std::vector<ClearCoat> clear_coats;                      // likewise
  std::vector<Sheen> sheens;                               // likewise
  std::vector<GlassMap> glass_maps;                        // likewise
  std::vector<Iridescence> iridescences;                   // likewise
  std::vector<DiffuseTransmission> diffuse_transmissions;  // likewise
  std::vector<PackedTangent> tangents;                     // of the first vertices; see tangents.h
  std::vector<Texture> textures;
  std::vector<std::uint32_t> texels;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  std::vector<float> camera_near;  // of the first cameras
  std::vector<Node> nodes;
  std::vector<Animation> animations;
  std::vector<Channel> channels;
  std::vector<float> key_times, key_values, weights;
  std::vector<Skin> skins;
  std::vector<Joint> joints;
  std::vector<MovingMesh> moving_meshes;
  std::vector<Vec3> rest_positions, rest_normals;
  std::vector<SkinWeight> skin_weights;
  std::vector<Vec3> morph_positions, morph_normals;
  std::vector<AnimationLabel> animation_labels;
  std::vector<std::uint8_t> node_visible;
  std::vector<SceneOrigin> origin;  // one, or none; see exact.h
  std::vector<Reduction> reductions;
};

// A part of the model; meshes appended until the next part begins belong to it.
struct PartSource {
  std::string name;  // may be empty
  std::uint32_t parent;
  std::size_t vertex_begin;
};

struct SceneBuilder {
  ImportOptions options;
  std::shared_ptr<SceneArrays> out = std::make_shared<SceneArrays>();
  std::vector<std::string> material_names;  // of the first materials
  std::vector<std::uint32_t> glass;         // materials that transmit, of which the file has no volume
  std::vector<std::uint32_t> volumes;       // materials that transmit and have a texture of their thickness
  std::vector<PartSource> parts;
  std::uint64_t bytes_charged = 0;
  FilesRead files;
  std::uint64_t broken_face_count = 0;  // faces left out
  std::uint32_t halved_count = 0;       // textures with more texels than options.texture_side_max
  std::vector<std::string> unused;      // contents of the file that are not used
  std::vector<std::string> remarks;     // simplifications and repairs
};

// Counts bytes about to be allocated for `what`; throws beyond options.byte_count_max.
void charge_bytes(SceneBuilder* builder, std::uint64_t bytes, const char* what);
// Checks `count` temporary elements likewise, without counting them.
void require_bytes(const SceneBuilder& builder, std::uint64_t count, std::uint64_t element_bytes, const char* what);
// Adds a text to the warning line, once each.
void note_unused(SceneBuilder* builder, const std::string& what);
void note_remark(SceneBuilder* builder, const std::string& what);

// Adds a material; returns its index. Throws beyond kMaterialCountMax.
std::uint32_t add_material(SceneBuilder* builder, const Material& material, const std::string& name);

// Begins a part below `parent`, an earlier one or kNone; returns its index.
std::uint32_t begin_part(SceneBuilder* builder, const std::string& name, std::uint32_t parent = kNone);

// Checks indices and array lengths; removes unused vertices.
void tidy_mesh(MeshData* mesh);

// Appends the tidied mesh in world space. A mirroring transform flips the winding. Faces with a vertex that is not
// finite or beyond kCoordinateMax in world space are left out, or refused (broken_faces.h). `exactly`: the transform
// before rounding and before the scene's origin is subtracted, if there is one; null: `to_world` is exact.
struct ExactTransform;
void append_mesh(SceneBuilder* builder, const MeshData& mesh, const Transform& to_world,
                 const ExactTransform* exactly = nullptr);

// Appends the tidied mesh as a moving one: world-space vertices by `to_world` (its transform at time 0), and the rest
// pose. Fills the array ranges of `moving`; the caller sets node, skin and instance.
void append_moving_mesh(SceneBuilder* builder, const MeshData& mesh, const Transform& to_world, MovingMesh moving);

// Sets the views of `result` and its warning line. Refuses a scene without triangles.
void finish_scene(SceneBuilder* builder, const std::string& name, ImportedScene* result);

// Throws, naming `name`, unless the transform is finite and can be inverted: its determinant is a normal float
// (HARDCASES row 27).
void require_invertible(const Transform& t, const std::string& name);

inline bool has_strength(const Grain& grain) { return grain.direction.x != 0 || grain.direction.y != 0; }
inline bool is_textured(const GlassMap& glass) {
  return glass.transmission_texture.texture != kNone || glass.thickness_texture.texture != kNone;
}
inline bool is_textured(const Iridescence& film) {
  return film.strength_texture.texture != kNone || film.thickness_texture.texture != kNone;
}
inline bool is_textured(const DiffuseTransmission& passing) {
  return passing.strength_texture.texture != kNone || passing.color_texture.texture != kNone;
}
inline bool is_textured(const Sheen& sheen) {
  return sheen.color_texture.texture != kNone || sheen.roughness_texture.texture != kNone;
}
inline bool is_textured(const ClearCoat& coat) {
  return coat.strength_texture.texture != kNone || coat.roughness_texture.texture != kNone ||
         coat.normal.texture != kNone;
}

}  // namespace pocketray
