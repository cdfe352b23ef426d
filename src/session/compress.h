// Textures of a scene on the heap in blocks (scene/texel_blocks.h), for baking.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.h"

namespace pocketray {

struct CompressedTexture {
  std::uint32_t texture;  // the first that uses these texels
  std::uint32_t width, height;
  TexelFormat format;
  double psnr;  // of the channels that are used, in dB, over all levels; infinite without any error
};

struct CompressedTextures {
  std::vector<Texture> textures;
  std::vector<std::uint32_t> texels;
  std::vector<CompressedTexture> report;
};

// Puts every texture that a material uses into the smallest blocks that hold what it is used for: colours in 4 bits a
// texel, with alpha in 8; occlusion in 4; metallic and roughness, or normals that face outwards, in 8; any other mix of
// numbers in 12. A texture that blocks would not make smaller stays exact. The scene then views `result`.
void compress_textures(Scene* scene, CompressedTextures* result);

// "colour, 4 bits"
const char* describe_format(TexelFormat format);

}  // namespace pocketray
