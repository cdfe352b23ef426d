// Writes small glTF files: accessors go into one buffer, kept in the JSON as a data URI or in the binary chunk of a
// .glb.
#pragma once
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace pocketray {

inline std::string base64(const std::vector<std::uint8_t>& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t n = 0, have = 0;
    for (std::size_t k = 0; k < 3; ++k) n = n << 8 | (i + k < bytes.size() ? (++have, bytes[i + k]) : 0u);
    for (std::uint32_t k = 0; k < 4; ++k) text += k <= have ? digits[n >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

struct GltfWriter {
  std::vector<std::uint8_t> bytes;
  std::string views, accessors;
  int count = 0;

  // Appends an accessor with a buffer view of its own; its index. `extra` is further JSON of the accessor.
  template <class T>
  int add(const std::vector<T>& values, const char* type, int components, int component_type,
          const std::string& extra = "") {
    while (bytes.size() % 4) bytes.push_back(0);
    std::size_t offset = bytes.size(), size = values.size() * sizeof(T);
    bytes.resize(offset + size);
    if (size > 0) std::memcpy(bytes.data() + offset, values.data(), size);
    if (count) views += ",", accessors += ",";
    views += "{\"buffer\":0,\"byteOffset\":" + std::to_string(offset) + ",\"byteLength\":" + std::to_string(size) + "}";
    accessors += "{\"bufferView\":" + std::to_string(count) +
                 ",\"count\":" + std::to_string(values.size() / static_cast<std::size_t>(components)) + ",\"type\":\"" +
                 type + "\",\"componentType\":" + std::to_string(component_type) + extra + "}";
    return count++;
  }
  int vec3s(const std::vector<float>& v) { return add(v, "VEC3", 3, 5126); }
  int vec2s(const std::vector<float>& v) { return add(v, "VEC2", 2, 5126); }
  int floats(const std::vector<float>& v) { return add(v, "SCALAR", 1, 5126); }
  int indices(const std::vector<std::uint16_t>& v) { return add(v, "SCALAR", 1, 5123); }

  std::string json(const std::string& rest, bool with_uri) const {
    std::string buffer = "{\"byteLength\":" + std::to_string(bytes.size());
    if (with_uri) buffer += ",\"uri\":\"data:application/octet-stream;base64," + base64(bytes) + "\"";
    return "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[" + buffer + "}],\"bufferViews\":[" + views +
           "],\"accessors\":[" + accessors + "]," + rest + "}";
  }
  std::string gltf(const std::string& rest) const { return json(rest, true); }
  std::string glb(const std::string& rest) const {
    std::string text = json(rest, false);
    while (text.size() % 4) text += ' ';
    std::string file = "glTF";
    auto put = [&](std::size_t n) {
      std::uint32_t value = static_cast<std::uint32_t>(n);
      file.append(reinterpret_cast<const char*>(&value), 4);
    };
    put(2), put(12 + 8 + text.size() + 8 + bytes.size());
    put(text.size()), put(0x4E4F534A), file += text;
    put(bytes.size()), put(0x004E4942), file.append(bytes.begin(), bytes.end());
    return file;
  }
};

// A right triangle in z = 0, its front towards +z, as mesh 0 of node 0; accessor 0. `material` is JSON, `rest`
// continues the document.
inline std::string triangle_gltf(const std::string& material, const std::string& rest = "",
                                 const std::string& node = "") {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  w.vec2s({0, 0, 1, 0, 0, 1});
  w.vec2s({0.5f, 0.5f, 0.75f, 0.5f, 0.5f, 0.75f});
  return w.gltf("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1,\"TEXCOORD_1\":2}" +
                std::string(material.empty() ? "" : ",\"material\":0") + "}]}],\"nodes\":[{\"mesh\":0" + node +
                "}],\"scenes\":[{\"nodes\":[0]}],\"scene\":0" +
                (material.empty() ? "" : ",\"materials\":[" + material + "]") + rest);
}

}  // namespace pocketray
