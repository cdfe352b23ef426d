// Images: PNG, JPEG, TGA, BMP → texels, halved until they fit.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "import/files.h"
#include "import/scene_builder.h"

namespace pocketray {

struct Image {
  std::uint32_t width = 0, height = 0;  // texels
  std::vector<std::uint32_t> texels;    // bytes R, G, B, A in memory; rows from the top
};

// Decodes an image; refuses one too large by its header. `name` is for the error line.
Image decode_image(SceneBuilder* builder, const Bytes& bytes, const std::string& name);

// Box-halves width and height, in linear light, weighted by alpha, until neither exceeds `side_max`. Odd sides round
// up.
void shrink_image(Image* image, std::uint32_t side_max);

// Texels of an image in the scene; several textures may sample them differently.
struct TexelRun {
  std::uint32_t begin = 0, width = 0, height = 0;
};
// Appends the image, shrunk to options.texture_side_max.
TexelRun add_texels(SceneBuilder* builder, Image image);
// Appends a texture of these texels; returns its index.
std::uint32_t add_texture(SceneBuilder* builder, const TexelRun& texels, Wrap wrap_u, Wrap wrap_v, bool nearest);

// Mean of a channel (0 = R … 3 = A) as stored, 0–1.
float channel_mean(const Image& image, int channel);

}  // namespace pocketray
