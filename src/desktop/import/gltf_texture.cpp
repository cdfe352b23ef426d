// Images, samplers and KHR_texture_transform (secs. 3.8, KHR_texture_transform).
#include <cmath>

#include "base/fmath.h"
#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

const tinygltf::Texture& texture_at(const GltfFile& file, int index) {
  if (index < 0 || static_cast<std::size_t>(index) >= file.model.textures.size())
    fail_import("texture %d does not exist; export the file again", index);
  return file.model.textures[static_cast<std::size_t>(index)];
}

Image load_image(GltfFile* file, int index, TexelKind kind) {
  if (index < 0 || static_cast<std::size_t>(index) >= file->model.images.size())
    fail_import("image %d does not exist; export the file again", index);
  const tinygltf::Image& image = file->model.images[static_cast<std::size_t>(index)];
  std::string name = "image " + std::to_string(index);
  Bytes bytes;
  if (!image.uri.empty()) {
    bytes = read_uri(file->path, image.uri, file->builder->options.byte_count_max, &file->builder->files);
  } else {
    std::size_t count = 0;
    const std::uint8_t* data = gltf_view(*file, image.bufferView, &count);
    bytes.assign(data, data + count);
  }
  Image decoded = decode_image(file->builder, bytes, name);
  fit_image(*file->builder, &decoded, kind);
  return decoded;
}

Wrap wrap_of(int mode) {
  if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::clamp;
  return mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::mirror : Wrap::repeat;
}

std::uint32_t scene_texture(GltfFile* file, int index, TexelKind kind, int uv_set) {
  const GltfFile::TextureOfSet key = {{index, kind}, uv_set};
  auto known = file->textures.find(key);
  if (known != file->textures.end()) return known->second;
  const tinygltf::Texture& texture = texture_at(*file, index);
  tinygltf::Sampler sampler;
  if (texture.sampler >= 0) {
    if (static_cast<std::size_t>(texture.sampler) >= file->model.samplers.size())
      fail_import("sampler %d does not exist; export the file again", texture.sampler);
    sampler = file->model.samplers[static_cast<std::size_t>(texture.sampler)];
  }
  // A sampler that names a filter without mip maps gets none; without a filter, the choice is ours.
  const bool has_levels =
      sampler.minFilter != TINYGLTF_TEXTURE_FILTER_NEAREST && sampler.minFilter != TINYGLTF_TEXTURE_FILTER_LINEAR;
  const GltfFile::TexelUse use = {{texture.source, kind}, has_levels};
  auto texels = file->texels.find(use);
  if (texels == file->texels.end())
    texels =
        file->texels.emplace(use, add_texels(file->builder, gltf_image(file, index, kind), kind, has_levels)).first;
  std::uint32_t result = add_texture(file->builder, texels->second, wrap_of(sampler.wrapS), wrap_of(sampler.wrapT),
                                     sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST);
  file->builder->out->textures[result].uv_set = static_cast<std::uint8_t>(uv_set);
  file->textures[key] = result;
  return result;
}

void pair_of(const tinygltf::Value& object, const char* key, double* x, double* y) {
  if (!object.Has(key)) return;
  const tinygltf::Value& value = object.Get(key);
  if (!value.IsArray() || value.ArrayLen() < 2 || !value.Get(0).IsNumber() || !value.Get(1).IsNumber()) return;
  *x = value.Get(0).GetNumberAsDouble(), *y = value.Get(1).GetNumberAsDouble();
}

}  // namespace

const Image& gltf_image(GltfFile* file, int texture_index, TexelKind kind) {
  const GltfFile::ImageUse use = {texture_at(*file, texture_index).source, kind};
  auto known = file->images.find(use);
  if (known != file->images.end()) return known->second;
  try {
    return file->images.emplace(use, load_image(file, use.first, kind)).first->second;
  } catch (const ImportError& error) {
    if (!file->lost_images.insert(use.first).second) throw;
    note_remark(file->builder, std::string("a texture is missing: ") + error.what());
    throw LostImage();
  }
}

int gltf_uv_set(const tinygltf::TextureInfo& info) {
  const tinygltf::Value* transform = gltf_extension(info.extensions, "KHR_texture_transform");
  double set = transform ? gltf_number(*transform, "texCoord", info.texCoord) : info.texCoord;
  return set >= 0 && set < 64 ? static_cast<int>(set) : 0;
}

TextureUse gltf_texture_use(GltfFile* file, const tinygltf::TextureInfo& info, TexelKind kind) {
  TextureUse use;
  if (info.index < 0) return use;
  const GltfUvSets& sets = file->current_uv_sets;
  use.texture = scene_texture(file, info.index, kind, sets.second >= 0 && gltf_uv_set(info) == sets.second ? 1 : 0);
  const tinygltf::Value* transform = gltf_extension(info.extensions, "KHR_texture_transform");
  if (!transform) return use;
  double offset_u = 0, offset_v = 0, scale_u = 1, scale_v = 1, rotation = gltf_number(*transform, "rotation", 0);
  pair_of(*transform, "offset", &offset_u, &offset_v);
  pair_of(*transform, "scale", &scale_u, &scale_v);
  double c = det_cos(rotation), s = det_sin(rotation);
  // translation × rotation × scale, as the extension's vertex shader writes it.
  const double m[2][3] = {{c * scale_u, s * scale_v, offset_u}, {-s * scale_u, c * scale_v, offset_v}};
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 3; ++column) {
      if (!(std::fabs(m[row][column]) < 1e18))
        fail_import("a KHR_texture_transform is not finite; export the file again");
      use.m[row][column] = static_cast<float>(m[row][column]);
    }
  return use;
}

}  // namespace pocketray
