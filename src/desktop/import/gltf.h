// glTF 2.0 internals: the parsed file and the steps that turn it into a scene, each in the file gltf_<step>.cpp.
// tinygltf parses the structure; buffers and images are loaded here, so that file access stays beside the scene file
// and sizes are known before memory is taken. Section numbers cite the Khronos specification of glTF 2.0.
#pragma once
#include <tiny_gltf.h>

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/limits.h"
#include "desktop/import/files.h"
#include "desktop/import/image.h"
#include "desktop/import/origin.h"
#include "desktop/import/scene_builder.h"

namespace pocketray {

// A node of the default scene or above a joint.
struct GltfNode {
  bool visited = false;
  int parent = -1;
  Transform local, world;  // at rest
  ExactTransform local_exactly, world_exactly;
  bool visible = true;            // by its own KHR_node_visibility
  bool scale_moves = false;       // an animation sets its scale,
  bool visibility_moves = false;  // or its visibility or the visibility of a node above it
  bool unseen = false;            // it or a node above it is not visible, and never will be
  bool hidden = false;            // unseen, or permanently without volume: its scale or that of a node above it is 0
  bool flat = false;              // without volume at rest
  bool moves = false;             // an animation moves it or a node above it
  bool weights_move = false;      // an animation sets its morph weights
  int mover = -1;                 // the nearest node at or above it with an animation channel
  bool exported = false;          // becomes a Node of the scene
  std::uint32_t out_node = kNone;
};

// TEXCOORD sets of a material that become its first and second texture coordinates; -1: none.
struct GltfUvSets {
  int first = -1, second = -1;
};

// Target of an animation channel.
struct GltfTarget {
  ChannelPath path = ChannelPath::translation;
  int index = -1;  // index of a node, light, camera or material in the file
};
// Key times and values of a sampler, in scene units.
struct GltfKeys {
  std::vector<float> times, values;
  Interpolation interpolation = Interpolation::linear;
};
// A channel that can be used.
struct GltfDrive {
  std::size_t animation;  // index in the file
  GltfTarget target;
  GltfKeys keys;
};

struct GltfFile {
  std::string path;
  SceneBuilder* builder = nullptr;
  tinygltf::Model model;
  Bytes binary_chunk;  // from a .glb
  bool has_binary_chunk = false;
  std::vector<GltfNode> nodes;                              // parallel to model.nodes
  std::vector<GltfDrive> drives;                            // in the file's order
  std::vector<std::vector<std::uint32_t>> lights, cameras;  // scene indices for each of the file's
  std::vector<int> order;              // visited nodes, parents first; those of the default scene lead
  std::size_t visible_count = 0;       // nodes of the default scene in `order`; the others belong to joints outside it
  std::map<int, std::uint32_t> skins;  // glTF skin → scene skin
  std::vector<std::uint32_t> materials;  // glTF index → scene index, made on first use
  std::vector<GltfUvSets> uv_sets;       // by material; parallel to model.materials
  GltfUvSets current_uv_sets;            // sets of the material being made
  std::uint32_t default_material = kNone;
  using ImageUse = std::pair<int, TexelKind>;
  std::map<ImageUse, Image> images;                // decoded, for reading channels
  using TexelUse = std::pair<ImageUse, bool>;      // bool: with levels
  std::map<TexelUse, TexelRun> texels;             // glTF image → its texels in the scene
  using TextureOfSet = std::pair<ImageUse, int>;   // bool: second texture coordinates
  std::map<TextureOfSet, std::uint32_t> textures;  // glTF texture → scene texture
  std::set<int> lost_images;                       // missing or not decodable
};

// gltf.cpp: reads a .gltf or .glb into the builder.
void import_gltf(const std::string& path, Bytes bytes, SceneBuilder* builder);

// gltf_parse.cpp: container, JSON, buffers; refuses unknown required extensions.
void gltf_parse(GltfFile* file, Bytes bytes);
// Bytes of a buffer view, checked. Throws for a view that leaves its buffer.
const std::uint8_t* gltf_view(const GltfFile& file, int view_index, std::size_t* byte_count);

// gltf_compressed.cpp: turns compressed buffer views and compressed primitives into plain buffer views.
void gltf_decompress(GltfFile* file);

// gltf_json.cpp: refuses invalid JSON, excessive nesting, or a number beyond float, saying where.
void gltf_check_json(const std::string& text);

// gltf_accessor.cpp: elements as floats (normalised integers expanded, sparse values applied), `components` each; fewer
// components in the file are an error, and so is a value that is not finite or larger than `limit`. `what` names the
// use in errors.
std::vector<float> gltf_floats(GltfFile* file, int accessor, int components, const char* what,
                               float limit = kCoordinateMax);
// gltf_floats() for a vertex attribute: invalid values become NaN instead, unless `strict` is set.
std::vector<float> gltf_attribute(GltfFile* file, int accessor, int components, const char* what,
                                  float limit = kCoordinateMax);
std::vector<std::uint32_t> gltf_uints(GltfFile* file, int accessor, int components, const char* what);
// Bytes of all buffers. Bounds accessors without a buffer view: each vertex that they belong to takes a byte.
std::uint64_t gltf_bytes(const GltfFile& file);
int gltf_component_count(const GltfFile& file, int accessor);
std::vector<Vec3> gltf_vec3s(GltfFile* file, int accessor, const char* what, float limit = kCoordinateMax);

// gltf_texture.cpp. An image that is missing or cannot be decoded is named once and throws LostImage: the material must
// be read again without its textures in file->lost_images.
struct LostImage {};
const Image& gltf_image(GltfFile* file, int texture_index, TexelKind kind);
// Scene texture and transform of a texture reference of the material being made.
TextureUse gltf_texture_use(GltfFile* file, const tinygltf::TextureInfo& info, TexelKind kind = TexelKind::colors);
// TEXCOORD set of the reference, after KHR_texture_transform.
int gltf_uv_set(const tinygltf::TextureInfo& info);

// gltf_lost.cpp: the material without textures whose images are lost.
tinygltf::Material gltf_without_lost_textures(const GltfFile& file, const tinygltf::Material& source);

// gltf_material.cpp: scene material of a glTF material (-1: the default one).
std::uint32_t gltf_material(GltfFile* file, int material);

// gltf_maps.cpp: mean of a texture's colours, linear.
Vec3 gltf_color_mean(GltfFile* file, int texture);

// gltf_specular_glossiness.cpp: tells whether a material uses the older model, and converts it.
bool gltf_has_specular_glossiness(const tinygltf::Material& source);
tinygltf::Material gltf_without_specular_glossiness(GltfFile* file, const tinygltf::Material& source);

// gltf_maps.cpp: maps of a material.
void gltf_read_maps(GltfFile* file, const tinygltf::Material& source, MaterialMaps* maps);
// Mean of a channel of a texture of numbers, 1 without one; above zero if any texel is, so that the mean lobe
// has every part that some texel's lobe has.
float gltf_map_mean(GltfFile* file, int texture, int channel);
// The model scaled by the means of specular textures.
MetallicRoughness gltf_mean_model(GltfFile* file, const tinygltf::Material& source, MetallicRoughness model);
// The scene keeps two sets of texture coordinates per vertex: the set of the normal texture, whose frame tangents use,
// or of the first other texture, and one more. A remark names textures that use further sets; these use the first.
GltfUvSets gltf_choose_uv_sets(GltfFile* file, const tinygltf::Material& source);

// gltf_coat.cpp: clear coat of a material, and its textures if it has one.
struct GltfCoatTextures {
  tinygltf::TextureInfo strength, roughness, normal;
};
GltfCoatTextures gltf_coat_textures(const tinygltf::Material& source);
ClearCoat gltf_read_coat(GltfFile* file, const tinygltf::Material& source);

// gltf_sheen.cpp: sheen of a material, and its textures if it has one.
struct GltfSheenTextures {
  tinygltf::TextureInfo color, roughness;
};
GltfSheenTextures gltf_sheen_textures(const tinygltf::Material& source);
Sheen gltf_read_sheen(GltfFile* file, const tinygltf::Material& source);

// gltf_glass.cpp: transmission, volume and thin film of a material, and their textures.
struct GltfGlassTextures {
  tinygltf::TextureInfo transmission, thickness;
};
GltfGlassTextures gltf_glass_textures(const tinygltf::Material& source);
// Transmission: its factor, and the mean of its texture.
struct GltfTransmission {
  float factor = 0, mean = 0;
};
GltfTransmission gltf_read_transmission(GltfFile* file, const tinygltf::Material& source);
// Sets thin and absorption; the thickness and its texture, of a material that transmits, if it has one.
void gltf_read_volume(GltfFile* file, const tinygltf::Material& source, Material* material, GlassMap* glass);
struct GltfFilmTextures {
  tinygltf::TextureInfo strength, thickness;
};
GltfFilmTextures gltf_film_textures(const tinygltf::Material& source);
Iridescence gltf_read_film(GltfFile* file, const tinygltf::Material& source);

// gltf_passing.cpp: diffuse transmission of a material, and its textures if it has one.
struct GltfPassingTextures {
  tinygltf::TextureInfo strength, color;
};
GltfPassingTextures gltf_passing_textures(const tinygltf::Material& source);
DiffuseTransmission gltf_read_passing(GltfFile* file, const tinygltf::Material& source);

// gltf_mesh.cpp: the primitives of a mesh that make triangles.
std::vector<MeshData> gltf_mesh(GltfFile* file, int mesh);

// gltf_count.cpp: refuses a scene whose geometry, with all instances, exceeds a limit. Builds nothing.
void gltf_count_geometry(const GltfFile& file);

// gltf_node.cpp: visits the default scene; fills file->nodes and file->order.
void gltf_visit_nodes(GltfFile* file);
// Chooses the scene's origin, and moves the nodes' transforms to it.
void gltf_recentre(GltfFile* file);
// Transforms of EXT_mesh_gpu_instancing; one identity without it.
std::vector<Transform> gltf_instances(GltfFile* file, int node);
// Translation, rotation and scale of a node without a matrix.
Node gltf_node_trs(const GltfFile& file, int node);
std::string gltf_node_name(const GltfFile& file, int node);

// Transform from the node to the node that moves it (its index in the scene to *out_node), or to the world (kNone).
Transform gltf_fixed_part(const GltfFile& file, int node, std::uint32_t* out_node);

// gltf_target.cpp: target of a channel, by its path or KHR_animation_pointer. False, with a note, if unsupported.
bool gltf_target(GltfFile* file, const tinygltf::AnimationChannel& channel, GltfTarget* target);
// "node 3 'Wheel'", "light 0"; "rotation", "colour".
std::string gltf_target_name(const GltfFile& file, const GltfTarget& target);
const char* gltf_path_name(ChannelPath path);

// gltf_keys.cpp: fills file->drives with the usable channels; notes name the others.
void gltf_read_animations(GltfFile* file);

// gltf_mover.cpp: finds the nodes that move or are hidden; turns those that move, and their ancestors, into nodes of
// the scene.
void gltf_mark_movers(GltfFile* file);
void gltf_export_nodes(GltfFile* file);
std::uint32_t gltf_morph_target_count(const GltfFile& file, int node);

// gltf_animation.cpp: adds the animations, once all their targets are in the scene.
void gltf_export_animations(GltfFile* file);
// Morph weights of the node at rest, else of its mesh, else zeros.
std::vector<float> gltf_morph_weights(const GltfFile& file, int node, std::size_t count);

// gltf_skin.cpp: turns joints of moving skins into nodes of the scene; checks the nodes of a skin's joints.
void gltf_mark_joints(GltfFile* file);
const std::vector<int>& gltf_joints(const GltfFile& file, int skin);
bool gltf_skin_moves(const GltfFile& file, int skin);
// Scene skin of a glTF skin whose joints are nodes of the scene.
std::uint32_t gltf_export_skin(GltfFile* file, int skin);
// Rest pose → world for each joint, at rest.
std::vector<Transform> gltf_skin_transforms(GltfFile* file, int skin);
// Throws if a vertex is bound to a joint that the skin does not have.
void gltf_check_joints(const MeshData& mesh, std::size_t joint_count);
// Applies morph targets or skin once and removes them.
void gltf_apply_morph(MeshData* mesh, const std::vector<float>& weights);
void gltf_apply_skin(MeshData* mesh, const std::vector<Transform>& joints);

// gltf_light.cpp
void gltf_lights_and_cameras(GltfFile* file);

// Clamps a value to 0 to 1; 0 for NaN.
inline float gltf_unit(double value) { return value > 0 ? static_cast<float>(value < 1 ? value : 1) : 0.0f; }

// Reads numbers from tinygltf's generic values, with defaults; an extension object or null.
const tinygltf::Value* gltf_extension(const tinygltf::ExtensionMap& extensions, const char* name);
double gltf_number(const tinygltf::Value& object, const char* key, double fallback);
Vec3 gltf_color(const tinygltf::Value& object, const char* key, const Vec3& fallback);
tinygltf::TextureInfo gltf_texture_info(const tinygltf::Value& object, const char* key);

}  // namespace pocketray
