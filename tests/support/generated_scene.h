// Small scenes made from a seed and a set of features, and a renderer for them, for the suites that verify the
// renderer.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "accel/accel_list.h"
#include "base/rng.h"
#include "engine/frame.h"

namespace pocketray {

// Features of a generated scene, one bit each; what a feature requires (a light for shadows, …) is always included.
enum class Feature : int {
  specular,
  mirror,
  refraction,
  absorption,
  thin,
  alpha_mask,
  alpha_blend,
  emission,
  texture,
  vertex_color,
  smooth_normal,
  ambient,
  point_light,
  spot_light,
  directional_light,
  animation,
  supersampling,
  one_sided,
  metallic_roughness,
  normal_map,
  occlusion,  // shows under ambient light only
  mip_map,    // of whatever textures there are
  anisotropy,
  second_uv,  // of whatever textures there are
  clear_coat,
  sheen,
  transmission_map,
  rough_refraction,
  iridescence,
  diffuse_transmission,
};
constexpr int kFeatureCount = 30;
constexpr std::uint32_t bit(Feature feature) { return 1u << static_cast<int>(feature); }
constexpr std::uint32_t kAllFeatures = (1u << kFeatureCount) - 1;
constexpr bool has(std::uint32_t features, Feature feature) { return (features & bit(feature)) != 0; }

// A scene in its own memory. Shapes are added with the current material; bind() points `scene` at the vectors.
struct GeneratedScene {
  Scene scene;
  std::vector<Vec3> positions, normals, rest_positions, rest_normals;
  std::vector<Vec2> uvs, second_uvs;
  std::vector<Rgba16> colors;
  std::vector<Triangle> triangles;
  std::vector<Material> materials;
  std::vector<MaterialMaps> material_maps;
  std::vector<Grain> grains;
  std::vector<ClearCoat> clear_coats;
  std::vector<Sheen> sheens;
  std::vector<GlassMap> glass_maps;
  std::vector<Iridescence> iridescences;
  std::vector<DiffuseTransmission> diffuse_transmissions;
  std::vector<PackedTangent> tangents;  // of the first vertices; the rest have none
  std::vector<Texture> textures;
  std::vector<std::uint32_t> texels;
  std::vector<Light> lights;
  std::vector<Camera> cameras;
  std::vector<Node> nodes;
  std::vector<Animation> animations;
  std::vector<Channel> channels;
  std::vector<float> key_times, key_values;
  std::vector<MovingMesh> moving_meshes;
  bool with_normals = false, with_uvs = false, with_second_uvs = false, with_colors = false;

  GeneratedScene() = default;
  GeneratedScene(const GeneratedScene&) = delete;  // `scene` points into the vectors
  void bind();
};

std::uint32_t add_material(GeneratedScene* s, const Material& material);
std::uint32_t add_vertex(GeneratedScene* s, const Vec3& position, const Vec3& normal = {0, 0, 0}, Vec2 uv = {0, 0});
void add_triangle(GeneratedScene* s, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t material);
// a, b, c, d counter-clockwise seen from the front; uv (0,0), (1,0), (1,1), (0,1).
void add_quad(GeneratedScene* s, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, std::uint32_t material);
// Closed; fronts outside, or inside for a room.
void add_box(GeneratedScene* s, const Vec3& low, const Vec3& high, std::uint32_t material, bool room = false);
// Closed sphere of columns × rows patches with its normals as vertex normals.
void add_sphere(GeneratedScene* s, const Vec3& center, float radius, int columns, int rows, std::uint32_t material);
// width × height texels, 4 bytes each as R, G, B, A; returns the texture's index.
std::uint32_t add_texture(GeneratedScene* s, int width, int height, const std::vector<std::array<int, 4>>& rgba,
                          Wrap wrap_u = Wrap::repeat, Wrap wrap_v = Wrap::repeat, bool nearest = false);
// Gives a texture all its levels.
void add_levels(GeneratedScene* s, std::uint32_t texture);
void aim(GeneratedScene* s, const Vec3& eye, const Vec3& target, double vertical_fov_degrees);

// Gives a material a metallic-roughness map of that texture; its own lobes become those of middling values.
void add_map(GeneratedScene* s, std::uint32_t material, const MetallicRoughness& model, std::uint32_t texture);

// At most 300 triangles: a floor, a wall, boxes, spheres and panes, each of which shows one feature if the set has it.
std::unique_ptr<GeneratedScene> generate_scene(std::uint32_t features, std::uint64_t seed);
// Matching settings: 2 samples per pixel with supersampling.
Settings settings_for(std::uint32_t features, std::uint32_t width, std::uint32_t height);

// A renderer in its own block, built and ready for render_frame(). Null, with *status set, if a step fails.
struct TestRenderer {
  std::unique_ptr<std::uint8_t[]> block;
  Renderer renderer;
  TestRenderer() = default;
  TestRenderer(const TestRenderer&) = delete;
  ~TestRenderer() { stop_workers(renderer.workers); }
};
std::unique_ptr<TestRenderer> make_renderer(const Scene& scene, const Settings& settings,
                                            const AccelInfo* accel = nullptr, Status* status = nullptr,
                                            bool recolorable = false);

// The picture of one frame.
using Picture = std::vector<Vec3>;
Picture render_picture(const Scene& scene, const Settings& settings, double seconds = 0,
                       const AccelInfo* accel = nullptr);
bool same_picture(const Picture& a, const Picture& b);  // bit for bit
std::uint32_t picture_hash(const Vec3* image, std::size_t pixel_count);

// The radiance along one ray, by the frame's kernels, without skipping anything.
Vec3 trace_ray(const Renderer& renderer, const Vec3& origin, const Vec3& direction, Tracer* tracer = nullptr);

}  // namespace pocketray
