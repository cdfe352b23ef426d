#include "desktop/import/image.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <new>

#include "base/arena.h"
#include "base/color.h"
#include "base/limits.h"
#include "desktop/import/import_error.h"
#include "desktop/import/webp.h"
#include "scene/texture_side.h"

// Largest block that the decoder may allocate, and whether it asked for more: a PNG may inflate to a thousand times its
// bytes, whatever its size in pixels.
static thread_local std::size_t block_bytes_max = 0;
static thread_local bool wants_more = false;

static void* resize_block(void* block, std::size_t byte_count) {
  if (byte_count <= block_bytes_max) return std::realloc(block, byte_count);
  wants_more = true;
  return nullptr;
}

#define STBI_MALLOC(bytes) resize_block(nullptr, bytes)
#define STBI_REALLOC(block, bytes) resize_block(block, bytes)
#define STBI_FREE(block) std::free(block)
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 16384
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#include <stb_image.h>

namespace pocketray {

static_assert(STBI_MAX_DIMENSIONS == kTextureSideMax, "one limit");

// Upper bound of pixels per byte: deflate expands a byte to at most 1032 [RFC 1951], and a byte holds eight one-bit
// pixels.
constexpr std::uint64_t kBytePixelsMax = 8 * 1032;

// Peak block of decoding: the inflated samples, with a byte per row and room for interlaced passes, or the pixels
// padded to the blocks of a JPEG; and twice what has been read of the file.
static std::size_t decoder_block_max(std::uint64_t width, std::uint64_t height, bool is_16_bit,
                                     std::size_t file_bytes) {
  const std::uint64_t padded = (width + 64) * (height + 64), samples = 4 * (is_16_bit ? 2 : 1) * padded;
  return to_size(std::max<std::uint64_t>(2 * samples, 2 * std::uint64_t(file_bytes) + 4096));
}

static Image decode(const Bytes& bytes, const std::string& name, std::uint64_t texel_count_max) {
  if (is_webp(bytes)) return decode_webp(bytes, name, texel_count_max);
  int width = 0, height = 0, channels = 0, size = static_cast<int>(bytes.size());
  block_bytes_max = 1u << 20;  // for headers
  if (bytes.size() > 1u << 30 || !stbi_info_from_memory(bytes.data(), size, &width, &height, &channels))
    fail_import("%s is not a PNG, JPEG, TGA or BMP image; convert it", name.c_str());
  if (width < 1 || height < 1 || width > STBI_MAX_DIMENSIONS || height > STBI_MAX_DIMENSIONS)
    fail_import("%s has %d × %d pixels, more than %d per side; scale it down", name.c_str(), width, height,
                STBI_MAX_DIMENSIONS);
  std::uint64_t texel_count = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  if (texel_count > texel_count_max) fail_import("%s is too large; scale it down", name.c_str());
  if (texel_count > kBytePixelsMax * bytes.size())
    fail_import("%s has %d × %d pixels, more than its %zu bytes can hold; copy it again", name.c_str(), width, height,
                bytes.size());
  const bool is_16_bit = stbi_is_16_bit_from_memory(bytes.data(), size) != 0;
  block_bytes_max =
      decoder_block_max(static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height), is_16_bit, bytes.size());
  wants_more = false;
  stbi_uc* pixels = stbi_load_from_memory(bytes.data(), size, &width, &height, &channels, 4);
  if (!pixels && wants_more)
    fail_import("%s has %d × %d pixels, but holds more data than these need; export it again", name.c_str(), width,
                height);
  if (!pixels) fail_import("%s cannot be decoded (%s); export it again", name.c_str(), stbi_failure_reason());
  Image image;
  image.width = static_cast<std::uint32_t>(width), image.height = static_cast<std::uint32_t>(height);
  try {
    image.texels.resize(texel_count);
  } catch (...) {
    stbi_image_free(pixels);
    throw;
  }
  std::memcpy(image.texels.data(), pixels, texel_count * 4);
  stbi_image_free(pixels);
  return image;
}

Image decode_image(SceneBuilder* builder, const Bytes& bytes, const std::string& name) {
  // Decoding holds the filtered and the final image at once.
  return decode(bytes, name, builder->options.byte_count_max / 12);
}

Status read_image(const Bytes& bytes, const std::string& name, std::size_t pixel_count_max, Image* image) {
  try {
    *image = decode(bytes, name, pixel_count_max);
    return success();
  } catch (const std::bad_alloc&) {
    return failure("%.300s: not enough memory to read it; scale it down", name.c_str());
  } catch (const ImportError& error) {
    return failure("%s", error.what());
  }
}

// Mean of up to 2 × 2 texels: colour in linear light, weighted by alpha so that invisible texels do not bleed in.
static std::uint32_t mean_texel(const std::uint32_t* texels, int count) {
  float sum[3] = {0, 0, 0}, plain[3] = {0, 0, 0}, alpha = 0;
  for (int i = 0; i < count; ++i) {
    std::uint8_t rgba[4];
    std::memcpy(rgba, &texels[i], 4);
    float a = static_cast<float>(rgba[3]);
    for (int c = 0; c < 3; ++c) sum[c] += srgb_to_linear(rgba[c]) * a, plain[c] += srgb_to_linear(rgba[c]);
    alpha += a;
  }
  std::uint8_t mean[4];
  for (int c = 0; c < 3; ++c) mean[c] = srgb_level(alpha > 0 ? sum[c] / alpha : plain[c] / static_cast<float>(count));
  mean[3] = static_cast<std::uint8_t>(alpha / static_cast<float>(count) + 0.5f);
  std::uint32_t packed;
  std::memcpy(&packed, mean, 4);
  return packed;
}

static std::uint32_t mean_number(const std::uint32_t* texels, int count) {
  int sum[4] = {0, 0, 0, 0};
  for (int i = 0; i < count; ++i) {
    std::uint8_t bytes[4];
    std::memcpy(bytes, &texels[i], 4);
    for (int c = 0; c < 4; ++c) sum[c] += bytes[c];
  }
  std::uint8_t mean[4];
  for (int c = 0; c < 4; ++c) mean[c] = static_cast<std::uint8_t>((sum[c] + count / 2) / count);
  std::uint32_t packed;
  std::memcpy(&packed, mean, 4);
  return packed;
}

static Image halved(const Image& image, TexelKind kind) {
  Image half;
  half.width = (image.width + 1) / 2, half.height = (image.height + 1) / 2;
  half.texels.resize(static_cast<std::size_t>(half.width) * half.height);
  for (std::uint32_t y = 0; y < half.height; ++y)
    for (std::uint32_t x = 0; x < half.width; ++x) {
      std::uint32_t box[4];
      int count = 0;
      for (std::uint32_t v = 2 * y; v < 2 * y + 2 && v < image.height; ++v)
        for (std::uint32_t u = 2 * x; u < 2 * x + 2 && u < image.width; ++u)
          box[count++] = image.texels[static_cast<std::size_t>(v) * image.width + u];
      half.texels[static_cast<std::size_t>(y) * half.width + x] =
          kind == TexelKind::colors ? mean_texel(box, count) : mean_number(box, count);
    }
  return half;
}

void shrink_image(Image* image, std::uint32_t side_max, TexelKind kind) {
  if (side_max < 1) side_max = 1;
  while (image->width > side_max || image->height > side_max) *image = halved(*image, kind);
}

std::uint32_t image_side_max(const SceneBuilder& builder) {
  return std::max(builder.options.texture_side_max, kTextureSideUsual);
}

void fit_image(const SceneBuilder& builder, Image* image, TexelKind kind) {
  const std::uint32_t width = image->width;
  shrink_image(image, image_side_max(builder), kind);
  image->is_halved |= image->width < width;
}

TexelRun add_texels(SceneBuilder* builder, Image image, TexelKind kind, bool has_levels) {
  SceneArrays& out = *builder->out;
  const std::uint32_t side_max = builder->options.texture_side_max;
  fit_image(*builder, &image, kind);
  builder->halved_count += image.is_halved || image.width > side_max || image.height > side_max;
  const bool makes_levels = builder->options.mip_maps && has_levels;
  if (!makes_levels) shrink_image(&image, side_max, kind);
  const std::uint32_t level_count = makes_levels ? level_count_max(image.width, image.height) : 1;
  const std::uint64_t begin = out.texels.size(), count = level_texels(image.width, image.height, level_count);
  charge_bytes(builder, count * 4, "the textures");
  out.texels.insert(out.texels.end(), image.texels.begin(), image.texels.end());
  out.texels.resize(begin + count);
  if (level_count > 1) {
    std::vector<float> scratch(level_scratch_need(image.width, image.height));
    make_levels(image.texels.data(), image.width, image.height, kind, scratch.data(),
                out.texels.data() + begin + image.texels.size());
  }
  return {static_cast<std::uint32_t>(begin), image.width, image.height, level_count};
}

std::uint32_t add_texture(SceneBuilder* builder, const TexelRun& texels, Wrap wrap_u, Wrap wrap_v, bool nearest) {
  SceneArrays& out = *builder->out;
  if (out.textures.size() >= kTextureCountMax) fail_import("more than %u textures; merge some", kTextureCountMax);
  Texture texture = {};
  texture.texel_begin = texels.begin;
  texture.width = static_cast<std::uint16_t>(texels.width), texture.height = static_cast<std::uint16_t>(texels.height);
  texture.wrap_u = wrap_u, texture.wrap_v = wrap_v, texture.nearest = nearest ? 1 : 0;
  texture.level_count = static_cast<std::uint8_t>(texels.level_count);
  out.textures.push_back(texture);
  return static_cast<std::uint32_t>(out.textures.size() - 1);
}

void leave_out_levels(std::uint32_t side_max, SceneArrays* arrays) {
  if (!any_levels_beyond({arrays->textures.data(), static_cast<std::uint32_t>(arrays->textures.size())}, side_max))
    return;
  std::map<std::uint32_t, std::uint32_t> moved;  // first texels, which textures may share
  std::vector<std::uint32_t> texels;
  for (Texture& t : arrays->textures) {
    t = without_levels_beyond(t, side_max);
    const auto place = moved.emplace(t.texel_begin, static_cast<std::uint32_t>(texels.size()));
    const std::uint32_t* from = arrays->texels.data() + t.texel_begin;
    if (place.second) texels.insert(texels.end(), from, from + level_texels(t.width, t.height, t.level_count));
    t.texel_begin = place.first->second;
  }
  arrays->texels.swap(texels);
}

float channel_mean(const Image& image, int channel) {
  double sum = 0;
  for (std::uint32_t texel : image.texels) {
    std::uint8_t rgba[4];
    std::memcpy(rgba, &texel, 4);
    sum += rgba[channel];
  }
  return image.texels.empty() ? 1.0f : static_cast<float>(sum / (255.0 * static_cast<double>(image.texels.size())));
}

ChannelRange channel_range(const Image& image, int channel) {
  ChannelRange range;
  for (std::uint32_t texel : image.texels) {
    std::uint8_t rgba[4];
    std::memcpy(rgba, &texel, 4);
    range.low = std::min(range.low, rgba[channel]), range.high = std::max(range.high, rgba[channel]);
  }
  return range;
}

}  // namespace pocketray
