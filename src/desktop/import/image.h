// Images: PNG, JPEG, TGA, BMP → texels, halved until they fit.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "desktop/import/files.h"
#include "desktop/import/scene_builder.h"
#include "scene/texture_levels.h"

namespace pocketray {

struct Image {
  std::uint32_t width = 0, height = 0;  // texels
  std::vector<std::uint32_t> texels;    // bytes R, G, B, A in memory; rows from the top
  bool is_halved = false;               // it had more texels than kept
};

// Decodes an image; refuses by its header one that is too large. `name` is for the error line.
Image decode_image(SceneBuilder* builder, const Bytes& bytes, const std::string& name);

// decode_image() without a scene, for pictures of at most `pixel_count_max` pixels.
Status read_image(const Bytes& bytes, const std::string& name, std::size_t pixel_count_max, Image* image);

// Box-halves width and height until neither exceeds `side_max`: colours in linear light, weighted by alpha. Odd sides
// round up.
void shrink_image(Image* image, std::uint32_t side_max, TexelKind kind = TexelKind::colors);
// Longest side of images. Not less than usual: of textures with levels, larger levels are left out at the end, so that
// all else is as it would be with them.
std::uint32_t image_side_max(const SceneBuilder& builder);
// Shrinks an image to it.
void fit_image(const SceneBuilder& builder, Image* image, TexelKind kind = TexelKind::colors);

// Texels of an image in the scene; several textures may sample them differently.
struct TexelRun {
  std::uint32_t begin = 0, width = 0, height = 0, level_count = 1;
};
// Appends the image with its levels, if the options have them; without levels, shrunk to options.texture_side_max.
TexelRun add_texels(SceneBuilder* builder, Image image, TexelKind kind = TexelKind::colors, bool has_levels = true);
// Appends a texture of these texels; returns its index.
std::uint32_t add_texture(SceneBuilder* builder, const TexelRun& texels, Wrap wrap_u, Wrap wrap_v, bool nearest);

// Leaves out levels of textures beyond a side (scene/texture_side.h).
void leave_out_levels(std::uint32_t side_max, SceneArrays* arrays);

// Mean of a channel (0 = R … 3 = A) as stored, 0–1.
float channel_mean(const Image& image, int channel);

// The smallest and largest value of a channel, as stored.
struct ChannelRange {
  std::uint8_t low = 255, high = 0;
};
ChannelRange channel_range(const Image& image, int channel);

}  // namespace pocketray
