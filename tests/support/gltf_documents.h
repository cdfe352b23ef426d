// Small glTF documents that together use what the importer reads: the beginnings of mutated ones.
#pragma once
#include <string>
#include <vector>

#include "import/gltf_writer.h"

namespace pocketray {

constexpr char kDotPng[] =
    "data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNoaPj/HwAGggL/bOBDIwAAAABJRU5ErkJggg==";

// Indices, morph targets, an empty primitive, a sparse accessor, a node that several things move.
inline std::string moving_gltf() {
  GltfWriter w;
  const int corners = w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}), order = w.indices({0, 1, 2, 2, 1, 3}),
            times = w.floats({0, 0.5f, 1}), places = w.vec3s({0, 0, 0, 1, 2, 3, 0, 0, 0}),
            weights = w.floats({0, 1, 0}), sparse_index = w.indices({1, 2}), sparse_value = w.vec3s({2, 0, 0, 0, 2, 0});
  auto n = [](int index) { return std::to_string(index); };
  w.accessors +=
      ",{\"count\":4,\"type\":\"VEC3\",\"componentType\":5126,\"sparse\":{\"count\":2,\"indices\":{"
      "\"bufferView\":" +
      n(sparse_index) +
      ",\"byteOffset\":0,\"componentType\":5123},\"values\":{"
      "\"bufferView\":" +
      n(sparse_value) +
      ",\"byteOffset\":0}}},{\"count\":0,\"type\":\"VEC3\","
      "\"componentType\":5126,\"bufferView\":0,\"byteOffset\":0}";
  const int sparse = w.count, empty = w.count + 1;
  return w.gltf(
      "\"meshes\":[{\"weights\":[0.5],\"primitives\":[{\"attributes\":{\"POSITION\":" + n(corners) +
      "},\"indices\":" + n(order) + ",\"mode\":4,\"targets\":[{\"POSITION\":" + n(sparse) +
      "}]},{\"attributes\":{\"POSITION\":" + n(empty) + "},\"targets\":[{\"POSITION\":" + n(empty) +
      "}]},{\"attributes\":{\"POSITION\":" + n(sparse) +
      "},\"mode\":5}]}],\"nodes\":[{\"children\":[1,2],\"scale\":[1,2,1]},{\"mesh\":0,\"translation\":[0,0,-1]},{"
      "\"camera\":0,\"rotation\":[0,0,0,1],\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}],\"scenes\":[{"
      "\"nodes\":[0]}],\"scene\":0,\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.7,\"znear\":0.1}"
      "}],\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"spot\",\"intensity\":5,\"range\":9,\"spot\":"
      "{\"innerConeAngle\":0.1,\"outerConeAngle\":0.5}}]}},\"animations\":[{\"samplers\":[{\"input\":" +
      n(times) + ",\"output\":" + n(places) + "},{\"input\":" + n(times) + ",\"output\":" + n(weights) +
      "}],\"channels\":[{\"sampler\":0,\"target\":{\"node\":1,\"path\":\"translation\"}},{\"sampler\":0,\"target\":{"
      "\"node\":0,\"path\":\"scale\"}},{\"sampler\":1,\"target\":{\"node\":1,\"path\":\"weights\"}}]}]");
}

// A skin of two joints, one of which turns.
inline std::string skinned_gltf() {
  GltfWriter w;
  std::vector<float> binds;
  for (int joint = 0; joint < 2; ++joint)
    for (int i = 0; i < 16; ++i) binds.push_back(i % 5 == 0 ? 1.0f : 0.0f);
  const int corners = w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0}),
            weights = w.add<float>({1, 0, 0, 0, .5f, .5f, 0, 0, 0, 1, 0, 0}, "VEC4", 4, 5126),
            joints = w.add<std::uint16_t>({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, "VEC4", 4, 5123),
            matrices = w.add(binds, "MAT4", 16, 5126), times = w.floats({0, 1}),
            turns = w.add<float>({0, 0, 0, 1, 0, 0, 1, 0}, "VEC4", 4, 5126);
  auto n = [](int index) { return std::to_string(index); };
  return w.gltf(
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":" + n(corners) + ",\"WEIGHTS_0\":" + n(weights) +
      ",\"JOINTS_0\":" + n(joints) + "}}]}],\"skins\":[{\"joints\":[1,2],\"inverseBindMatrices\":" + n(matrices) +
      ",\"skeleton\":1}],\"nodes\":[{\"mesh\":0,\"skin\":0},{\"children\":[2]},{\"translation\":"
      "[0,1,0]}],\"scenes\":[{\"nodes\":[0,1]}],\"animations\":[{\"name\":\"bend\",\"samplers\":[{\"input\":" +
      n(times) + ",\"output\":" + n(turns) +
      ",\"interpolation\":\"LINEAR\"}],\"channels\":[{\"sampler\":0,"
      "\"target\":{\"node\":2,\"path\":\"rotation\"}}]}]");
}

// Instances, vertex colours, and a material with textures, transforms of these and extensions.
inline std::string furnished_gltf() {
  GltfWriter w;
  const int corners = w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0}), uvs = w.vec2s({0, 0, 1, 0, 0, 1}),
            colors = w.add<std::uint8_t>({255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 128}, "VEC4", 4, 5121,
                                         ",\"normalized\":true"),
            places = w.vec3s({0, 0, 0, 2, 0, 0}), sizes = w.vec3s({1, 1, 1, 2, 2, 2});
  auto n = [](int index) { return std::to_string(index); };
  return w.gltf(
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":" + n(corners) + ",\"TEXCOORD_0\":" + n(uvs) +
      ",\"COLOR_0\":" + n(colors) +
      "},\"material\":0}]}],\"nodes\":[{\"mesh\":0,\"extensions\":{"
      "\"EXT_mesh_gpu_instancing\":{\"attributes\":{\"TRANSLATION\":" +
      n(places) + ",\"SCALE\":" + n(sizes) +
      "}}}}],\"scenes\":[{\"nodes\":[0]}],\"samplers\":[{\"wrapS\":33071,\"magFilter\":9728}],\"textures\":[{"
      "\"source\":0,\"sampler\":0}],\"images\":[{\"uri\":\"" +
      std::string(kDotPng) +
      "\"}],\"materials\":[{\"alphaMode\":\"MASK\",\"alphaCutoff\":0.4,\"emissiveFactor\":[0.1,0,0],"
      "\"normalTexture\":{\"index\":0,\"scale\":2},\"occlusionTexture\":{\"index\":0,\"strength\":0.5},"
      "\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0.5,0.5,0.9],\"metallicFactor\":0.5,\"baseColorTexture\":"
      "{\"index\":0,\"texCoord\":0,\"extensions\":{\"KHR_texture_transform\":{\"offset\":[0.5,0],\"rotation\":1,"
      "\"scale\":[2,2]}}},\"metallicRoughnessTexture\":{\"index\":0}},\"extensions\":{\"KHR_materials_clearcoat\":"
      "{\"clearcoatFactor\":0.5,\"clearcoatTexture\":{\"index\":0}},\"KHR_materials_ior\":{\"ior\":1.4},"
      "\"KHR_materials_anisotropy\":{\"anisotropyStrength\":0.5,\"anisotropyTexture\":{\"index\":0}},"
      "\"KHR_materials_specular\":{\"specularFactor\":0.5,\"specularTexture\":{\"index\":0}}}}]");
}

inline std::vector<std::string> gltf_documents() { return {moving_gltf(), skinned_gltf(), furnished_gltf()}; }

}  // namespace pocketray
