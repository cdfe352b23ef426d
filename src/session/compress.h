// Compresses a scene's textures into blocks (scene/texel_blocks.h), on the heap, for baking.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.h"

namespace pocketray {

struct CompressedTexture {
  std::uint32_t texture;  // the first that uses these texels
  std::uint32_t width, height;
  TexelFormat format;
  double psnr;  // over the used channels of all levels, in dB; infinite without error
};

struct CompressedTextures {
  std::vector<Texture> textures;
  std::vector<std::uint32_t> texels;
  std::vector<CompressedTexture> report;
};

// Puts every texture that a material uses into the smallest blocks that suffice for its use: colours in 4 bits per
// texel, with alpha in 8; occlusion in 4; metallic and roughness, or outward normals, in 8; any other mix of numbers in
// 12. A texture that blocks would not make smaller stays exact. The scene then views `result`.
void compress_textures(Scene* scene, CompressedTextures* result);

// "colour, 4 bits"
const char* describe_format(TexelFormat format);

}  // namespace pocketray
