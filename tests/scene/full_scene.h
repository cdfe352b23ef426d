// A small valid scene that uses every array and every kind of element, with numbers drawn from a seed.
#pragma once
#include <vector>

#include "base/rng.h"
#include "scene/scene.h"

struct FullScene {
  pocketray::Scene scene;
  std::vector<pocketray::Vec3> positions, normals, rest_positions, rest_normals, morph_positions, morph_normals;
  std::vector<pocketray::Vec2> uvs, second_uvs;
  std::vector<pocketray::Rgba16> colors;
  std::vector<pocketray::Triangle> triangles;
  std::vector<pocketray::Material> materials;
  std::vector<pocketray::MaterialMaps> material_maps;
  std::vector<pocketray::Texture> textures;
  std::vector<std::uint32_t> texels;
  std::vector<pocketray::Light> lights;
  std::vector<pocketray::Camera> cameras;
  std::vector<pocketray::Node> nodes;
  std::vector<pocketray::Animation> animations;
  std::vector<pocketray::Channel> channels;
  std::vector<float> key_times, key_values, weights;
  std::vector<pocketray::Skin> skins;
  std::vector<pocketray::Joint> joints;
  std::vector<pocketray::MovingMesh> moving_meshes;
  std::vector<pocketray::SkinWeight> skin_weights;
  std::vector<std::uint8_t> accel;
  std::vector<pocketray::RadiosityInfo> radiosity_info;
  std::vector<std::uint32_t> radiosity_triangles;
  std::vector<pocketray::RadiosityGrid> radiosity_grids;
  std::vector<pocketray::RadiosityNode> radiosity_nodes;
  std::vector<pocketray::RadiosityCorners> radiosity_corners;
  std::vector<pocketray::Vec3> radiosity_values;
  std::vector<pocketray::RadiositySplit> radiosity_splits;
  std::vector<pocketray::RadiosityCut> radiosity_cuts;
  std::vector<pocketray::Reduction> reductions;
  std::vector<pocketray::EnvironmentInfo> environment_info;
  std::vector<std::uint32_t> environment_texels;
  std::vector<pocketray::Grain> grains;
  std::vector<pocketray::ClearCoat> clear_coats;
  std::vector<pocketray::Sheen> sheens;
  std::vector<pocketray::GlassMap> glass_maps;
  std::vector<pocketray::Iridescence> iridescences;
  std::vector<pocketray::DefaultView> default_view;
  std::vector<pocketray::Framing> framings;
  std::vector<pocketray::DiffuseTransmission> diffuse_transmissions;
  std::vector<float> camera_near;
  std::vector<pocketray::EnvironmentSun> environment_suns;
  std::vector<pocketray::AnimationLabel> animation_labels;
  std::vector<std::uint8_t> node_visible;
  std::vector<pocketray::SceneOrigin> origin;
  std::vector<pocketray::PackedTangent> tangents;

  FullScene() = default;
  FullScene(const FullScene&) = delete;  // `scene` points into the vectors
  // Points `scene` at the vectors; call after changing their sizes.
  void bind();
};

// `vertex_count` ≥ 12 vertices, the last eight of which move: four by skin and morph, four as an instance.
void make_full_scene(std::uint64_t seed, std::uint32_t vertex_count, std::uint32_t triangle_count, FullScene* full);
