// The scene: plain arrays of structs, fields used together stored together [Aranha07] sec. 3.1.
// A Scene owns nothing: its arrays lie in a loaded .pray file or in the scene arena. Everything in it has been checked:
// indices are in range, floats are finite, nodes come after their parents.
// Units: distances in scene units, angles in radians, colours linear with sRGB primaries, +Y up, right-handed.
#pragma once
#include <array>
#include <cstdint>

#include "base/array.h"
#include "base/box.h"
#include "base/limits.h"
#include "base/transform.h"
#include "base/vec3.h"
#include "scene/environment.h"
#include "scene/radiosity.h"

namespace pocketray {

constexpr std::uint32_t kNone = 0xFFFFFFFFu;  // "no such index"

// Three vertices, counter-clockwise seen from the front, and a material, in 12 bytes: each word holds a vertex in its
// low bits and a third of the material above them.
class Triangle {
 public:
  Triangle() = default;
  Triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material);
  std::uint32_t vertex(std::uint32_t corner) const { return word_[corner] & kVertexMask; }
  std::array<std::uint32_t, 3> vertices() const { return {{vertex(0), vertex(1), vertex(2)}}; }
  std::uint32_t material() const {
    return word_[0] >> kVertexIndexBits | word_[1] >> kVertexIndexBits << kShareBits |
           word_[2] >> kVertexIndexBits << 2 * kShareBits;
  }
  // Aborts if the value does not fit its bits; values below kVertexCountMax or kMaterialCountMax always fit.
  void set_vertex(std::uint32_t corner, std::uint32_t value);
  void set_material(std::uint32_t value);

 private:
  static constexpr std::uint32_t kVertexMask = (1u << kVertexIndexBits) - 1, kShareBits = 32 - kVertexIndexBits;
  static_assert(kVertexCountMax <= 1u << kVertexIndexBits, "a word holds any vertex");
  static_assert(kMaterialCountMax <= 1u << 3 * kShareBits, "three shares hold any material");
  std::uint32_t word_[3] = {0, 0, 0};
};

// A linear vertex colour: 16 bits per channel, 65535 = 1.
struct Rgba16 {
  std::uint16_t r, g, b, a;
};

enum class Wrap : std::uint8_t { repeat, mirror, clamp };

// Texel storage: every texel, or blocks of 4 × 4 with 4, 8 or 12 bits per texel (texel_blocks.h).
enum class TexelFormat : std::uint8_t { exact, color4, color_alpha8, red4, green_blue8, normal8, numbers12 };
constexpr int kTexelFormatCount = 7;

struct Texture {
  std::uint32_t texel_begin;    // first texel or block in Scene::texels; rows from the top
  std::uint16_t width, height;  // texels, ≥ 1
  Wrap wrap_u, wrap_v;
  std::uint8_t nearest;      // 1: nearest texel, 0: bilinear; between levels always bilinear
  std::uint8_t level_count;  // 1: level 0 only; more: smaller levels follow it, see texture_levels.h
  TexelFormat format = TexelFormat::exact;
  std::uint8_t uv_set = 0;  // 0: uses Scene::uvs, 1: second_uvs
  std::uint8_t reserved[2] = {0, 0};
};

// A use of a texture by a material: uv' = m · (u, v, 1) (KHR_texture_transform).
struct TextureUse {
  std::uint32_t texture = kNone;
  float m[2][3] = {{1, 0, 0}, {0, 1, 0}};
};

enum class AlphaMode : std::uint8_t { opaque, mask, blend };

// How a surface interacts with light. Any lobe may be absent (zero); an absent lobe costs nothing.
struct Material {
  Vec3 diffuse = {0.8f, 0.8f, 0.8f};  // Lambertian albedo; × texture × vertex colour
  Vec3 specular = {0, 0, 0};          // reflectance of the glossy lobe at normal incidence, see brdf/
  Vec3 mirror = {0, 0, 0};            // reflectance of the perfect mirror
  // Parts of specular and mirror that texture and vertex colour tint like the diffuse albedo: those of metals.
  Vec3 specular_tinted = {0, 0, 0}, mirror_tinted = {0, 0, 0};
  float exponent = 0;             // of the Phong lobe, 0 to kPhongExponentMax
  float roughness = 1;            // of the GGX lobe: α, 0 to 1
  float grazing = 0;              // of the GGX lobe: reflectance at grazing incidence, F₉₀
  Vec3 transmission = {0, 0, 0};  // of the dielectric; zero: opaque. Reflects by Fresnel and transmits the rest × this
  float ior = 1.5f;               // index of refraction, 1 to kIorMax
  Vec3 absorption = {0, 0, 0};    // per scene unit inside the body (Beer–Lambert)
  Vec3 emission = {0, 0, 0};      // radiance; × emission texture
  float opacity = 1;              // alpha; × texture alpha × vertex alpha
  float alpha_cutoff = 0.5f;      // alpha mode mask: lower alpha is a hole
  TextureUse diffuse_texture, emission_texture;
  std::uint32_t brdf = 0;  // index into kBrdfList: the glossy lobe
  AlphaMode alpha_mode = AlphaMode::opaque;
  std::uint8_t double_sided = 1;
  std::uint8_t unlit = 0;  // shows its diffuse colour unchanged and nothing else (KHR_materials_unlit)
  std::uint8_t thin = 0;   // transmits without refraction and encloses nothing (glTF without KHR_materials_volume)
};

// The metallic-roughness model of glTF, except for maps; metallic_roughness.h turns it into lobes.
struct MetallicRoughness {
  Vec3 base = {0, 0, 0};        // colour of the diffuse lobe and of metals; × texture × vertex colour
  Vec3 dielectric = {0, 0, 0};  // reflectance of a non-metal at normal incidence
  float grazing = 0;            // reflectance of a non-metal at grazing incidence
};

// Textures that vary a material. Most have numbers for texels, not colours: 0 to 255, linear.
struct MaterialMaps {
  // Lobes with a metallic_roughness or specular texture: metallic × B, roughness × G. The material's own lobes are
  // those of the means.
  MetallicRoughness model;
  TextureUse metallic_roughness;
  float metallic = 0, roughness = 0;
  // Range of texture × factor. Other values are clamped to it, so that bounds hold.
  float metallic_low = 0, metallic_high = 0, roughness_low = 0, roughness_high = 0;
  // Colour textures: a dielectric's reflectance × alpha; at normal incidence × colour as well.
  TextureUse specular, specular_color;
  // Normal in the frame of the tangent, which uses the first texture coordinates: R along u, G against v, B along the
  // vertex normal, each −1 at 1 (and 0), 0 at 128, 1 at 255. R and G × normal_scale.
  TextureUse normal;
  float normal_scale = 1;
  // Ambient light × lerp(1, R, occlusion_strength).
  TextureUse occlusion;
  float occlusion_strength = 1;
};

// The grain of a glossy material such as brushed metal: the lobe is wider along it.
struct Grain {
  // Along the tangent and the bitangent, the frame of MaterialMaps::normal; its length is the strength, 0 to 1.
  Vec2 direction = {0, 0};
  // Numbers that turn and weaken it: R and G, −1 at 0 and 1 at 255, turn it to that direction; × B.
  TextureUse texture;
};

// A clear varnish over a material, see brdf/clear_coat.h. Textures have numbers for texels.
struct ClearCoat {
  float strength = 0;       // × R; 0: none
  float roughness = 0;      // × G
  float roughness_low = 0;  // lower bound of the result; lower values are clamped to it, so that bounds hold
  TextureUse strength_texture, roughness_texture;
  TextureUse normal;  // like MaterialMaps::normal, which the coat does not use; none: the normal at the vertices
  float normal_scale = 1;
};

// Sheen of cloth over a material, see brdf/sheen.h.
struct Sheen {
  Vec3 color = {0, 0, 0};   // × colour texture; 0: none
  float roughness = 0;      // × alpha
  float roughness_low = 0;  // lower bound of the result, as for ClearCoat
  TextureUse color_texture, roughness_texture;
};

// Textures of a material that transmits light, see shade/transmission.h. The material's lobes at a point are those of
// its MaterialMaps there; the colours of its texture and vertices tint what it transmits.
struct GlassMap {
  float transmission = 0;  // t of metallic_roughness.h, × R; 0: the material has no such textures
  float thickness = 0;     // of a thin material, × G: it absorbs like a body of that thickness
  TextureUse transmission_texture, thickness_texture;
};

// A thin film over a material, see brdf/iridescence.h. Textures have numbers for texels.
struct Iridescence {
  float strength = 0;                               // × R; 0: none
  float ior = 1.3f;                                 // 1 to kIorMax
  float thickness_low = 100, thickness_high = 400;  // nanometres where G is 0 and 255; without the texture, the latter
  TextureUse strength_texture, thickness_texture;
};

// Light that passes a thin surface diffusely, as through a leaf, see shade/diffuse_transmission.h.
struct DiffuseTransmission {
  float strength = 0;      // × alpha; 0: none. Of the diffuse lobe, the rest remains
  Vec3 color = {1, 1, 1};  // × colour texture, not × texture and vertex colour of the material
  TextureUse strength_texture, color_texture;
};

// A unit vector in 127ths; zero: none. Handedness: above 0, the bitangent is normal × tangent, below 0 its opposite; 0:
// by the first texture coordinates, against ∂P/∂v.
struct PackedTangent {
  std::int8_t x = 0, y = 0, z = 0, handedness = 0;
};
inline Vec3 unpacked(const PackedTangent& t) {
  return {static_cast<float>(t.x), static_cast<float>(t.y), static_cast<float>(t.z)};  // × 127
}

enum class LightKind : std::uint32_t { point, spot, directional };

// Lights other than surfaces. Emissive materials are the area lights; the plan finds them.
struct Light {
  LightKind kind = LightKind::point;
  Vec3 position = {0, 0, 0};           // point, spot
  Vec3 direction = {0, -1, 0};         // unit, the way the light travels; spot, directional
  Vec3 intensity = {1, 1, 1};          // point, spot: radiant intensity; directional: irradiance on a surface facing it
  float range = 0;                     // no light beyond this distance (KHR_lights_punctual); 0: no limit
  float cos_inner = 1, cos_outer = 0;  // spot: full intensity within inner, none beyond outer
  std::uint32_t node = kNone;          // moves with this node: position and direction are in its space
};

enum class Projection : std::uint32_t { perspective, orthographic };

struct Camera {
  Vec3 eye = {0, 0, 0}, target = {0, 0, -1}, up = {0, 1, 0};
  float vertical_fov = 0.8f;  // radians, perspective
  float vertical_extent = 1;  // scene units from bottom to top, orthographic
  Projection projection = Projection::perspective;
  std::uint32_t node = kNone;  // moves with this node: eye, target and up are in its space
};

struct Node {
  std::uint32_t parent = kNone;  // index lower than the node's own
  Vec3 translation = {0, 0, 0};
  Quaternion rotation;
  Vec3 scale = {1, 1, 1};
  std::uint32_t weight_begin = 0, weight_count = 0;  // morph weights in Scene::weights
};

// Paths up to `visibility` belong to a node. light_intensity sets a light's intensity, light_scale multiplies it;
// camera_size is the vertical field of view, or the vertical extent of an orthographic camera.
enum class ChannelPath : std::uint8_t {
  translation,
  rotation,
  scale,
  weights,
  visibility,
  light_intensity,
  light_scale,
  camera_size,
  material_diffuse,
  material_emission
};
constexpr int kChannelPathCount = 10;
enum class Interpolation : std::uint8_t { step, linear, cubic };  // cubic: in-tangent, value, out-tangent for each key

struct Channel {
  std::uint32_t node;                  // or the light, camera or material, depending on `path`
  std::uint32_t key_begin, key_count;  // in Scene::key_times; seconds, strictly increasing
  std::uint32_t value_begin;           // in Scene::key_values; 1, 3, 4 or weight_count floats per key, × 3 if cubic
  ChannelPath path;
  Interpolation interpolation;
  std::uint16_t reserved = 0;
};

struct Animation {
  std::uint32_t channel_begin, channel_count;
  float duration;  // seconds; time wraps here
};

// Readable description of an animation: its name and targets. Not terminated if full.
struct AnimationLabel {
  char name[64], drives[188];
  std::uint32_t combines;  // 1: it plays others of the scene together and has no number
};

// Position of the scene's origin in the model's own coordinates.
struct SceneOrigin {
  double x, y, z;
};

struct Joint {
  std::uint32_t node;
  Transform inverse_bind;
};

struct Skin {
  std::uint32_t joint_begin, joint_count;
};

// Four joints of a skin and their weights, which sum to 1.
struct SkinWeight {
  std::uint16_t joint[4];
  float weight[4];
};

// A run of vertices that moves; runs are in ascending order and do not overlap. The rest pose is in object space;
// Scene::positions holds the pose at time 0.
struct MovingMesh {
  std::uint32_t vertex_begin, vertex_count;  // in Scene::positions (and normals)
  std::uint32_t rest_begin;                  // in Scene::rest_positions (and rest_normals)
  std::uint32_t node;                        // ignored if there is a skin
  std::uint32_t skin = kNone;
  std::uint32_t skin_weight_begin = 0;  // in Scene::skin_weights, vertex_count of them
  std::uint32_t morph_begin = 0,
                morph_count = 0;  // first delta in Scene::morph_positions; one target after another
  Transform instance;             // between the node and the mesh (instancing); ignored if there is a skin
};

struct SceneInfo {
  char name[64] = {0};
  Vec3 background = {0, 0, 0};  // radiance where nothing is hit; with an environment, its mean
  Vec3 ambient = {0, 0, 0};     // constant indirect light: radiance from everywhere
  float exposure = 1;           // displayed = exposure × radiance
  std::uint32_t frame_count = 1;
  float frames_per_second = 30;
  std::uint32_t default_lights =
      0;  // 1: the scene asks for the default lights (plan/plan_scene.h), or already has them
  std::uint32_t default_camera = 0;  // 1: framed by its bounds
  float auto_exposure = 0;           // 1: measure exposure before the first frame; 2: of surfaces alone
};

// View of a scene without a camera, and lighting of one without lights (plan/plan_scene.h). Measuring it takes several
// passes over all triangles, so `bake` stores it.
struct DefaultView {
  std::uint32_t is_room = 0;  // 1: seen from inside, or through the open side
  std::uint32_t side = 0;     // otherwise: which of four sides it is seen from
  Vec3 opening = {0, 0, 0};   // unit vector out through a room's open side; zero if it is closed
  float inside_share = 1;     // how far from the middle to the camera one is inside: the part without walls
};
constexpr std::uint32_t kDefaultViewSides = 4;

// Where the camera of a scene without one stands (plan/framing.h, plan/interior.h).
constexpr std::uint32_t kReachSides = 4, kReachAngles = 16;
struct Framing {
  Vec3 eye = {0, 0, 0}, target = {0, 0, 0};  // in a room that has a place to stand; otherwise equal
  Vec3 backward = {0, 0, 0};                 // unit vector from the scene to the camera, along the view axis; or zero
  // How far vertices reach from the middle of the bounds in all poses of an animation: to the right, left, top and
  // bottom as the camera sees them, at angles from 0 to 90° towards it.
  float reach[kReachSides][kReachAngles] = {};
};

// Contents that no picture of a scene shows (invisible.h).
enum class Invisible : std::uint32_t {
  black_emission,      // materials whose emission texture is black
  opaque_blend,        // materials that blend with alpha 1
  mask_without_holes,  // materials whose alpha is never below the cut-off
  flat_normal_map,     // materials; so are the following three
  white_occlusion,
  even_metallic_roughness,  // by textures of one value, also of reflectance
  even_color,
  flat_vertex_normals,  // vertices
  still_animation,
  // Lights of intensity 0, and lights out of range of every triangle, in the order of LightKind.
  dark_point,
  dark_spot,
  dark_directional,
  distant_point,
  distant_spot,
  clear_glass,          // materials that light passes as if they were not there
  white_vertex_colors,  // vertices
  black_coat,           // materials; so are the next
  black_grain,
  black_sheen,
  black_film,
  opaque_leaf,
};
constexpr int kInvisibleCount = 21;
inline Invisible dark_light(LightKind kind) { return static_cast<Invisible>(9 + static_cast<int>(kind)); }
inline Invisible distant_light(LightKind kind) { return static_cast<Invisible>(12 + static_cast<int>(kind)); }
static_assert(static_cast<int>(Invisible::dark_point) == 9 && static_cast<int>(Invisible::distant_point) == 12,
              "as above");

// Invisible contents that `bake` or import has left out.
struct Reduction {
  Invisible what;
  std::uint32_t count;
};

struct BvhNode;  // accel/bvh.h
struct BvhLeaf;  // accel/bvh.h

struct Scene {
  SceneInfo info;
  Array<const Vec3> positions;  // world space, at time 0
  Array<const Vec3> normals;    // unit, one per vertex, or empty; the zero vector means the geometric normal
  Array<const Vec2> uvs;        // one per vertex, or empty
  Array<const Rgba16> colors;   // one per vertex, or empty
  Array<const Triangle> triangles;
  Array<const Material> materials;
  Array<const Texture> textures;
  Array<const std::uint32_t> texels;  // bytes R, G, B, A in memory, RGB of colours in sRGB; or blocks
  Array<const Light> lights;
  Array<const Camera> cameras;
  Array<const Node> nodes;
  Array<const Animation> animations;
  Array<const Channel> channels;
  Array<const float> key_times, key_values, weights;
  Array<const Skin> skins;
  Array<const Joint> joints;
  Array<const MovingMesh> moving_meshes;
  Array<const Vec3> rest_positions, rest_normals;
  Array<const SkinWeight> skin_weights;
  Array<const Vec3> morph_positions, morph_normals;
  Array<const RadiosityInfo> radiosity_info;       // one, or empty like all that follow: no solution is stored
  Array<const std::uint32_t> radiosity_triangles;  // for each triangle's front, then, if stored, for each one's back
  Array<const RadiosityGrid> radiosity_grids;
  Array<const RadiosityNode> radiosity_nodes;
  Array<const RadiosityCorners> radiosity_corners;
  Array<const Vec3> radiosity_values;
  Array<const RadiositySplit> radiosity_splits;
  Array<const RadiosityCut> radiosity_cuts;
  Array<const std::uint8_t> accel;                // baked accelerator in the layout of accel/; may be empty
  Array<const MaterialMaps> material_maps;        // one per material, or empty
  Array<const EnvironmentInfo> environment_info;  // one, or none
  Array<const std::uint32_t> environment_texels;  // of its maps
  Array<const Grain> grains;                      // one per material, or empty
  // One per vertex, or empty: tangents of the frame of maps; none: the triangle's own, see shade/normal_map.h.
  Array<const PackedTangent> tangents;
  Array<const Vec2> second_uvs;                  // one per vertex, or empty: second texture coordinates
  Array<const ClearCoat> clear_coats;            // one per material, or empty
  Array<const DefaultView> default_view;         // one, or none: measured at the start if needed
  Array<const AnimationLabel> animation_labels;  // one per animation, or empty
  Array<const std::uint8_t> node_visible;        // one per node, or empty: all are, except as channels say
  Array<const SceneOrigin> origin;               // one, or none: 0
  Array<const Reduction> reductions;             // one per kind, or none
  Array<const Sheen> sheens;                     // one per material, or empty
  // One for each animation and one at time 0; or one; or none: measured at the start if needed.
  Array<const Framing> framings;
  Array<const GlassMap> glass_maps;                        // one per material, or empty
  Array<const Iridescence> iridescences;                   // likewise
  Array<const float> camera_near;                          // near planes' distances, one per camera; or none: all 0
  Array<const EnvironmentSun> environment_suns;            // of the environment, or none
  Array<const DiffuseTransmission> diffuse_transmissions;  // one per material, or empty
};

inline bool is_animated(const Scene& scene) {
  return scene.animations.count > 0 && scene.moving_meshes.count + scene.nodes.count + scene.channels.count > 0;
}

}  // namespace pocketray
