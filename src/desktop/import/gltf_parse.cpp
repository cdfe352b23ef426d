// Container, JSON and buffers of a glTF file (secs. 3.6.1, 4).
#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

using Json = nlohmann::json;

// Extensions implemented here, or harmless to ignore.
const char* const kKnownExtensions[] = {
    "KHR_texture_transform",
    "KHR_materials_transmission",
    "KHR_materials_ior",
    "KHR_materials_specular",
    "KHR_materials_volume",
    "KHR_materials_unlit",
    "KHR_materials_emissive_strength",
    "KHR_lights_punctual",
    "EXT_mesh_gpu_instancing",
    "KHR_mesh_quantization",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_sheen",
    "KHR_materials_iridescence",
    "KHR_materials_diffuse_transmission",
    "KHR_node_visibility",
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_animation_pointer",
};
bool is_known_extension(const std::string& name) {
  return std::any_of(std::begin(kKnownExtensions), std::end(kKnownExtensions),
                     [&](const char* known) { return name == known; });
}
// Returns whether a file without the extension is complete, though it looks different.
bool affects_looks_alone(const std::string& name) {
  constexpr const char* kPrefixes[] = {
      "KHR_materials_", "EXT_materials_",    "ADOBE_materials_", "EXT_lights_",   "KHR_environment_map",
      "KHR_texture_",   "EXT_texture_",      "MSFT_texture_dds", "MSFT_packing_", "MSFT_lod",
      "KHR_xmp",        "KHR_interactivity", "KHR_node_",
  };
  return std::any_of(std::begin(kPrefixes), std::end(kPrefixes),
                     [&](const char* prefix) { return name.compare(0, std::strlen(prefix), prefix) == 0; });
}

std::uint32_t little_endian_32(const std::uint8_t* p) {
  return static_cast<std::uint32_t>(p[0]) | static_cast<std::uint32_t>(p[1]) << 8 |
         static_cast<std::uint32_t>(p[2]) << 16 | static_cast<std::uint32_t>(p[3]) << 24;
}

// Splits a .glb into its JSON text and its binary chunk (sec. 4.4).
std::string read_glb_chunks(GltfFile* file, const Bytes& bytes) {
  constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
  if (bytes.size() < 20) fail_import("the .glb ends within its header; copy the file again");
  std::uint32_t version = little_endian_32(&bytes[4]), total = little_endian_32(&bytes[8]);
  if (version != 2) fail_import("the .glb has version %u, not 2; convert it to glTF 2.0", version);
  if (total > bytes.size() || total < 20)
    fail_import("the .glb states %u bytes but has %zu; copy the file again", total, bytes.size());
  std::string text;
  for (std::size_t at = 12, index = 0; at < total; ++index) {
    if (total - at < 8) fail_import("the .glb ends within a chunk header; copy the file again");
    std::uint32_t size = little_endian_32(&bytes[at]), kind = little_endian_32(&bytes[at + 4]);
    at += 8;
    if (size > total - at)
      fail_import("a chunk of the .glb has %u bytes, but only %zu are left; copy the file again", size, total - at);
    if (index == 0 && kind != kJsonChunk) fail_import("the first chunk of the .glb is not JSON; export it again");
    if (index == 0)
      text.assign(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                  bytes.begin() + static_cast<std::ptrdiff_t>(at + size));
    if (index == 1 && kind == kBinaryChunk) {
      file->binary_chunk.assign(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                                bytes.begin() + static_cast<std::ptrdiff_t>(at + size));
      file->has_binary_chunk = true;
    }
    at += size;
  }
  return text;
}

const Json* member(const Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  auto it = object.find(key);
  return it == object.end() ? nullptr : &*it;
}

std::string string_member(const Json& object, const char* key) {
  const Json* value = member(object, key);
  return value && value->is_string() ? value->get<std::string>() : std::string();
}

void check_version_and_extensions(GltfFile* file, const Json& root) {
  const Json* asset = member(root, "asset");
  std::string version = asset ? string_member(*asset, "version") : "";
  if (version.compare(0, 2, "2.") != 0)
    fail_import("glTF version '%.20s' instead of 2.0; convert the file to glTF 2.0", version.c_str());
  if (const Json* required = member(root, "extensionsRequired"))
    for (const Json& name : *required)
      if (name.is_string() && !is_known_extension(name.get<std::string>()) &&
          !affects_looks_alone(name.get<std::string>()))
        fail_import("the file requires the glTF extension %.100s; export it without", name.get<std::string>().c_str());
  if (const Json* used = member(root, "extensionsUsed"))
    for (const Json& name : *used)
      if (name.is_string() && !is_known_extension(name.get<std::string>()))
        note_unused(file->builder, name.get<std::string>().substr(0, 100));
}

// Returns whether a buffer without bytes stands for compressed views (EXT_meshopt_compression).
bool is_fallback(const Json& buffer) {
  const Json* extensions = member(buffer, "extensions");
  const Json* extension = extensions ? member(*extensions, "EXT_meshopt_compression") : nullptr;
  const Json* fallback = extension ? member(*extension, "fallback") : nullptr;
  return fallback && fallback->is_boolean() && fallback->get<bool>();
}

// Loads the buffers; afterwards every buffer has at least its stated bytes (sec. 3.6.1.1).
void fetch_buffers(GltfFile* file, const Json& root) {
  const Json* buffers = member(root, "buffers");
  if (!buffers) return;
  if (!buffers->is_array()) fail_import("\"buffers\" is not an array; export the file again");
  for (std::size_t i = 0; i < buffers->size(); ++i) {
    const Json& entry = (*buffers)[i];
    const Json* length = member(entry, "byteLength");
    if (!length || !length->is_number_unsigned())
      fail_import("buffer %zu has no valid byteLength; export the file again", i);
    std::uint64_t promised = length->get<std::uint64_t>();
    std::string uri = string_member(entry, "uri");
    tinygltf::Buffer buffer;
    if (!uri.empty()) {
      buffer.data = read_uri(file->path, uri, file->builder->options.byte_count_max, &file->builder->files);
    } else if (is_fallback(entry)) {
      promised = 0;
    } else if (i == 0 && file->has_binary_chunk) {
      buffer.data.swap(file->binary_chunk);
    } else {
      fail_import("buffer %zu has no data; export the file again", i);
    }
    if (buffer.data.size() < promised)
      fail_import("buffer %zu has %zu bytes instead of %llu; copy the file again", i, buffer.data.size(),
                  static_cast<unsigned long long>(promised));
    charge_bytes(file->builder, buffer.data.size(), "the buffers");
    file->model.buffers.push_back(std::move(buffer));
  }
}

// Lists images without their bytes, which are loaded when a material needs them.
void list_images(GltfFile* file, const Json& root) {
  const Json* images = member(root, "images");
  if (!images || !images->is_array()) return;
  for (const Json& entry : *images) {
    tinygltf::Image image;
    image.uri = string_member(entry, "uri");
    const Json* view = member(entry, "bufferView");
    if (view && view->is_number_integer()) {
      std::int64_t index = view->get<std::int64_t>();
      image.bufferView = index >= 0 && index < 1 << 30 ? static_cast<int>(index) : 1 << 30;
    }
    file->model.images.push_back(std::move(image));
  }
}

// Removes uses of textures without an image: an extension that is not read has it in another format.
void drop_textures(const std::vector<bool>& has_image, Json* value, bool* dropped) {
  for (auto item = value->begin(); item != value->end();) {
    const Json* index = member(*item, "index");
    const bool is_texture =
        value->is_object() && index && index->is_number_unsigned() && item.key().find("Texture") != std::string::npos;
    if (is_texture && index->get<std::uint64_t>() < has_image.size() && !has_image[index->get<std::size_t>()]) {
      item = value->erase(item), *dropped = true;
    } else {
      if (item->is_structured()) drop_textures(has_image, &*item, dropped);
      ++item;
    }
  }
}
// Makes an image named only by EXT_texture_webp the texture's own.
void use_webp_images(Json* textures) {
  for (Json& texture : *textures) {
    const Json* extensions = member(texture, "extensions");
    const Json* webp = extensions ? member(*extensions, "EXT_texture_webp") : nullptr;
    const Json* source = webp ? member(*webp, "source") : nullptr;
    if (source && texture.is_object() && !texture.contains("source")) texture["source"] = *source;
  }
}
void drop_textures_without_image(GltfFile* file, Json* root) {
  auto listed = root->find("textures");
  if (listed != root->end() && listed->is_array()) use_webp_images(&*listed);
  const Json* textures = member(*root, "textures");
  auto materials = root->find("materials");
  if (!textures || !textures->is_array() || materials == root->end() || !materials->is_structured()) return;
  std::vector<bool> has_image;
  for (const Json& texture : *textures) has_image.push_back(member(texture, "source") != nullptr);
  bool dropped = false;
  drop_textures(has_image, &*materials, &dropped);
  if (dropped) note_unused(file->builder, "textures in formats other than PNG, JPEG and WebP");
}

// tinygltf requires indices to lie in a view, even for compressed primitives; gltf_decompress() replaces it.
void complete_compressed_indices(Json* root) {
  auto meshes = root->find("meshes"), accessors = root->find("accessors");
  if (meshes == root->end() || accessors == root->end() || !meshes->is_array() || !accessors->is_array()) return;
  for (const Json& mesh : *meshes) {
    const Json* primitives = member(mesh, "primitives");
    if (!primitives || !primitives->is_array()) continue;
    for (const Json& primitive : *primitives) {
      const Json *extensions = member(primitive, "extensions"), *indices = member(primitive, "indices");
      const Json* extension = extensions ? member(*extensions, "KHR_draco_mesh_compression") : nullptr;
      const Json* view = extension ? member(*extension, "bufferView") : nullptr;
      if (!view || !indices || !indices->is_number_unsigned() || indices->get<std::uint64_t>() >= accessors->size())
        continue;
      Json& accessor = (*accessors)[indices->get<std::size_t>()];
      if (accessor.is_object() && !accessor.contains("bufferView")) accessor["bufferView"] = *view;
    }
  }
}

// tinygltf requires every channel to name a node; channels of KHR_animation_pointer have none, and others are to be
// ignored (sec. 3.11).
void complete_channels(Json* root) {
  auto animations = root->find("animations");
  if (animations == root->end() || !animations->is_array()) return;
  for (Json& animation : *animations) {
    auto channels = animation.is_object() ? animation.find("channels") : animation.end();
    if (!animation.is_object() || channels == animation.end() || !channels->is_array()) continue;
    for (Json& channel : *channels) {
      auto target = channel.is_object() ? channel.find("target") : channel.end();
      if (!channel.is_object() || target == channel.end() || !target->is_object() || target->contains("node")) continue;
      if (string_member(*target, "path") != "pointer") (*target)["path"] = "none";
      (*target)["node"] = 0;
    }
  }
}

}  // namespace

const std::uint8_t* gltf_view(const GltfFile& file, int view_index, std::size_t* byte_count) {
  const auto& views = file.model.bufferViews;
  if (view_index < 0 || static_cast<std::size_t>(view_index) >= views.size())
    fail_import("buffer view %d does not exist; export the file again", view_index);
  const tinygltf::BufferView& view = views[static_cast<std::size_t>(view_index)];
  if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= file.model.buffers.size())
    fail_import("buffer view %d lies in buffer %d, which does not exist; export the file again", view_index,
                view.buffer);
  const auto& data = file.model.buffers[static_cast<std::size_t>(view.buffer)].data;
  if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
    fail_import("buffer view %d reaches beyond its buffer; export the file again", view_index);
  *byte_count = view.byteLength;
  return data.data() + view.byteOffset;
}

void gltf_parse(GltfFile* file, Bytes bytes) {
  bool binary = bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
  std::string text = binary ? read_glb_chunks(file, bytes) : std::string(bytes.begin(), bytes.end());
  Bytes().swap(bytes);
  require_bytes(*file->builder, text.size(), 16, "the JSON");
  gltf_check_json(text);
  Json root = Json::parse(text, nullptr, false);
  if (!root.is_object()) fail_import("not a valid JSON object, so not glTF; export the file again");
  check_version_and_extensions(file, root);
  fetch_buffers(file, root);
  list_images(file, root);
  drop_textures_without_image(file, &root);
  complete_channels(&root);
  complete_compressed_indices(&root);

  std::vector<tinygltf::Buffer> buffers;
  std::vector<tinygltf::Image> images;
  buffers.swap(file->model.buffers);
  images.swap(file->model.images);
  for (const char* key : {"buffers", "images", "extras"}) root.erase(key);
  text = root.dump(-1, ' ', false, Json::error_handler_t::replace);
  root = nullptr;
  tinygltf::TinyGLTF parser;
  std::string error, warning;
  if (!parser.LoadASCIIFromString(&file->model, &error, &warning, text.c_str(), static_cast<unsigned>(text.size()), "",
                                  tinygltf::REQUIRE_VERSION))
    fail_import("%.300s (as tinygltf reports); export the file again",
                error.empty() ? "its structure is not valid" : error.c_str());
  file->model.buffers.swap(buffers);
  file->model.images.swap(images);
}

}  // namespace pocketray
