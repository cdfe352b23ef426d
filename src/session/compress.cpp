#include "session/compress.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "base/check.h"
#include "scene/texel_blocks.h"

namespace pocketray {
namespace {

// Channels of a run of texels that materials read.
struct Uses {
  bool color = false, alpha = false, normal = false, green_blue = false, red = false, grain = false;
};

struct Channels {
  std::uint8_t c[4];
};
Channels channels_of(std::uint32_t texel) {
  Channels channels;
  std::memcpy(channels.c, &texel, sizeof texel);
  return channels;
}

// Keyed by the first texel of each run: textures may share one.
std::map<std::uint32_t, Uses> find_uses(const Scene& scene) {
  std::map<std::uint32_t, Uses> uses;
  auto note = [&](const TextureUse& use, bool Uses::*what) {
    if (use.texture != kNone) uses[scene.textures[use.texture].texel_begin].*what = true;
  };
  for (const Material& m : scene.materials) {
    note(m.diffuse_texture, &Uses::color), note(m.diffuse_texture, &Uses::alpha);
    note(m.emission_texture, &Uses::color);
  }
  for (const MaterialMaps& maps : scene.material_maps) {
    note(maps.specular, &Uses::color), note(maps.specular, &Uses::alpha), note(maps.specular_color, &Uses::color);
    note(maps.normal, &Uses::normal), note(maps.metallic_roughness, &Uses::green_blue);
    note(maps.occlusion, &Uses::red);
  }
  for (const Grain& grain : scene.grains) note(grain.texture, &Uses::grain);
  for (const ClearCoat& coat : scene.clear_coats) {
    note(coat.strength_texture, &Uses::red), note(coat.roughness_texture, &Uses::green_blue);
    note(coat.normal, &Uses::normal);
  }
  for (const Sheen& sheen : scene.sheens) {
    note(sheen.color_texture, &Uses::color);
    note(sheen.roughness_texture, &Uses::color), note(sheen.roughness_texture, &Uses::alpha);
  }
  for (const GlassMap& glass : scene.glass_maps) {
    note(glass.transmission_texture, &Uses::red), note(glass.thickness_texture, &Uses::green_blue);
  }
  for (const Iridescence& film : scene.iridescences) {
    note(film.strength_texture, &Uses::red), note(film.thickness_texture, &Uses::green_blue);
  }
  for (const DiffuseTransmission& passing : scene.diffuse_transmissions) {
    note(passing.strength_texture, &Uses::color), note(passing.strength_texture, &Uses::alpha);
    note(passing.color_texture, &Uses::color);
  }
  return uses;
}

TexelFormat choose_format(const Uses& uses, const std::uint32_t* texels, std::uint32_t count) {
  bool has_alpha = false, faces_outwards = true;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Channels texel = channels_of(texels[i]);
    has_alpha |= texel.c[3] != 255, faces_outwards &= texel.c[2] >= 128;
  }
  const bool numbers = uses.normal || uses.green_blue || uses.red || uses.grain;
  if (uses.color) {
    if (numbers) return TexelFormat::exact;
    return uses.alpha && has_alpha ? TexelFormat::color_alpha8 : TexelFormat::color4;
  }
  if (uses.grain) return TexelFormat::numbers12;
  if (uses.normal)
    return uses.green_blue || uses.red || !faces_outwards ? TexelFormat::numbers12 : TexelFormat::normal8;
  if (uses.green_blue) return uses.red ? TexelFormat::numbers12 : TexelFormat::green_blue8;
  return uses.red ? TexelFormat::red4 : TexelFormat::exact;
}

// Returns whether a format stores a channel; a normal's blue follows from the others.
bool stores(TexelFormat format, int channel) {
  switch (format) {
    case TexelFormat::exact:
    case TexelFormat::color_alpha8:
      return true;
    case TexelFormat::red4:
      return channel == 0;
    case TexelFormat::green_blue8:
      return channel == 1 || channel == 2;
    case TexelFormat::color4:
    case TexelFormat::normal8:
    case TexelFormat::numbers12:
      return channel < 3;
  }
  return false;
}

// Returns the sum of squared errors over a level's stored channels; adds their number to *count.
double level_error(TexelFormat format, const std::uint32_t* texels, std::uint32_t width, std::uint32_t height,
                   const std::uint32_t* blocks, std::uint64_t* count) {
  CHECK(format != TexelFormat::exact);
  const std::uint32_t across = block_count(format, width);
  double sum = 0;
  for (std::uint32_t y = 0; y < height; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      const std::size_t block = std::size_t(y / kBlockSide) * across + x / kBlockSide;
      const Channels is = channels_of(
          block_texel(format, blocks + block * block_words(format), y % kBlockSide * kBlockSide + x % kBlockSide));
      const Channels was = channels_of(texels[std::size_t(y) * width + x]);
      for (int c = 0; c < 4; ++c) {
        if (!stores(format, c)) continue;
        const double off = static_cast<double>(is.c[c]) - was.c[c];
        sum += off * off, ++*count;
      }
    }
  return sum;
}

// Appends the texture's levels as blocks, and its row of the report.
void append_blocks(const Scene& scene, std::uint32_t index, TexelFormat format, CompressedTextures* result) {
  const Texture& t = scene.textures[index];
  const std::uint32_t* texels = scene.texels.data + t.texel_begin;
  std::size_t at = result->texels.size();
  result->texels.resize(at + level_words(format, t.width, t.height, t.level_count));
  double error = 0;
  std::uint64_t count = 0;
  for (std::uint32_t level = 0; level < t.level_count; ++level) {
    const std::uint32_t width = level_side(t.width, level), height = level_side(t.height, level);
    encode_blocks(format, texels, width, height, result->texels.data() + at);
    error += level_error(format, texels, width, height, result->texels.data() + at, &count);
    texels += std::size_t(width) * height;
    at += std::size_t(block_count(format, width)) * block_count(format, height) * block_words(format);
  }
  CHECK_EQ(at, result->texels.size());
  const double psnr = error > 0 ? 10 * std::log10(255.0 * 255.0 * static_cast<double>(count) / error)
                                : std::numeric_limits<double>::infinity();
  result->report.push_back({index, t.width, t.height, format, psnr});
}

}  // namespace

void compress_textures(Scene* scene, CompressedTextures* result) {
  CHECK(scene != nullptr && result != nullptr);
  CHECK(result->textures.empty() && result->texels.empty());
  const std::map<std::uint32_t, Uses> uses = find_uses(*scene);
  std::map<std::uint32_t, std::pair<std::uint32_t, TexelFormat>> places;  // of the runs written so far
  for (std::uint32_t i = 0; i < scene->textures.count; ++i) {
    Texture t = scene->textures[i];
    CHECK(t.format == TexelFormat::exact);
    auto place = places.find(t.texel_begin);
    if (place == places.end()) {
      const std::uint32_t count = level_texels(t.width, t.height, t.level_count);
      const auto used = uses.find(t.texel_begin);
      TexelFormat format = used == uses.end() ? TexelFormat::exact
                                              : choose_format(used->second, scene->texels.data + t.texel_begin, count);
      if (level_words(format, t.width, t.height, t.level_count) >= count) format = TexelFormat::exact;
      place = places.emplace(t.texel_begin, std::make_pair(static_cast<std::uint32_t>(result->texels.size()), format))
                  .first;
      if (format == TexelFormat::exact)
        result->texels.insert(result->texels.end(), scene->texels.data + t.texel_begin,
                              scene->texels.data + t.texel_begin + count);
      else
        append_blocks(*scene, i, format, result);
    }
    t.texel_begin = place->second.first, t.format = place->second.second;
    result->textures.push_back(t);
  }
  scene->textures = {result->textures.data(), static_cast<std::uint32_t>(result->textures.size())};
  scene->texels = {result->texels.data(), static_cast<std::uint32_t>(result->texels.size())};
}

const char* describe_format(TexelFormat format) {
  switch (format) {
    case TexelFormat::exact:
      return "exact, 32 bits";
    case TexelFormat::color4:
      return "colour, 4 bits";
    case TexelFormat::color_alpha8:
      return "colour and alpha, 8 bits";
    case TexelFormat::red4:
      return "occlusion, 4 bits";
    case TexelFormat::green_blue8:
      return "metallic and roughness, 8 bits";
    case TexelFormat::normal8:
      return "normals, 8 bits";
    case TexelFormat::numbers12:
      return "numbers, 12 bits";
  }
  return "";
}

}  // namespace pocketray
