#include "desktop/import/obj_mask.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pocketray {
namespace {

struct Rgba {
  std::uint8_t c[4];
};
Rgba unpack(std::uint32_t texel) {
  Rgba rgba;
  std::memcpy(rgba.c, &texel, 4);
  return rgba;
}
std::uint32_t pack(const Rgba& rgba) {
  std::uint32_t texel;
  std::memcpy(&texel, rgba.c, 4);
  return texel;
}

std::uint8_t in_range(const MtlMap& map, std::uint8_t value) {
  const float scaled = map.base * 255 + map.gain * static_cast<float>(value);
  return static_cast<std::uint8_t>(scaled > 0 ? std::min(scaled, 255.0f) + 0.5f : 0.0f);
}

char channel_of(const MtlMap& map, const Image& mask) {
  if (map.channel != 0) return map.channel;
  return channel_range(mask, 3).low < 255 ? 'm' : 'r';
}
std::uint8_t value_of(const Rgba& t, char channel) {
  if (channel == 'm') return t.c[3];
  if (channel == 'l') return static_cast<std::uint8_t>((2126 * t.c[0] + 7152 * t.c[1] + 722 * t.c[2] + 5000) / 10000);
  return t.c[channel == 'g' ? 1 : channel == 'b' ? 2 : 0];
}

// Returns the texel at (u, v), from 0 to 1 downward.
std::uint32_t texel(const Image& image, double u, double v, bool clamps) {
  auto place = [clamps](double at, std::uint32_t size) {
    const double whole = (clamps ? std::min(std::max(at, 0.0), 1.0) : at - std::floor(at)) * size;
    return whole >= 0 ? std::min(static_cast<std::uint32_t>(whole), size - 1) : 0;
  };
  return image.texels[static_cast<std::size_t>(place(v, image.height)) * image.width + place(u, image.width)];
}

bool is_same(const MtlMap& a, const MtlMap& b) {
  return std::equal(a.scale, a.scale + 2, b.scale) && std::equal(a.offset, a.offset + 2, b.offset);
}

// Whole number of times, from 1 to 64, that b repeats within a; 0: none.
std::uint32_t repetitions(float a, float b) {
  const double ratio = static_cast<double>(b) / static_cast<double>(a);
  return ratio >= 1 && ratio <= 64 && ratio == std::floor(ratio) ? static_cast<std::uint32_t>(ratio) : 0;
}

// Coordinate in `inner` that corresponds to `at` in `outer`, downward.
double place_in(const MtlMap& outer, const MtlMap& inner, int axis, double at) {
  if (outer.scale[axis] == inner.scale[axis] && outer.offset[axis] == inner.offset[axis]) return at;
  const double upward = axis == 0 ? at : 1 - at;
  const double coordinate = (upward - static_cast<double>(outer.offset[axis])) / static_cast<double>(outer.scale[axis]);
  const double inside = coordinate * static_cast<double>(inner.scale[axis]) + static_cast<double>(inner.offset[axis]);
  return axis == 0 ? inside : 1 - inside;
}

}  // namespace

void make_opaque(Image* image) {
  for (std::uint32_t& t : image->texels) {
    Rgba rgba = unpack(t);
    rgba.c[3] = 255;
    t = pack(rgba);
  }
}

void apply_range(const MtlMap& map, Image* image) {
  if (map.base == 0 && map.gain == 1) return;
  for (std::uint32_t& t : image->texels) {
    Rgba rgba = unpack(t);
    for (int c = 0; c < 3; ++c) rgba.c[c] = in_range(map, rgba.c[c]);
    t = pack(rgba);
  }
}

bool put_mask(const Image& mask, const MtlMap& mask_map, bool has_color, Image* image, MtlMap* map,
              SceneBuilder* builder) {
  Image color;
  MtlMap outer = has_color ? *map : mask_map, color_map = *map, inner = mask_map;
  if (has_color) color = std::move(*image);
  Image& made = *image;
  made.width = has_color ? color.width : mask.width, made.height = has_color ? color.height : mask.height;
  if (has_color && !is_same(*map, mask_map)) {
    std::uint32_t times[2] = {0, 0};
    const bool color_repeats = (times[0] = repetitions(mask_map.scale[0], map->scale[0])) &&
                               (times[1] = repetitions(mask_map.scale[1], map->scale[1]));
    const bool mask_repeats = !color_repeats && (times[0] = repetitions(map->scale[0], mask_map.scale[0])) &&
                              (times[1] = repetitions(map->scale[1], mask_map.scale[1]));
    if (color_repeats) outer = mask_map;
    if (color_repeats || mask_repeats) {
      const std::uint32_t side_max = image_side_max(*builder);
      const Image& repeated = color_repeats ? color : mask;
      made.width = std::min(std::max(made.width, repeated.width * times[0]), side_max);
      made.height = std::min(std::max(made.height, repeated.height * times[1]), side_max);
    } else {
      note_remark(builder, "a map_d is placed like its map_Kd, since neither repeats within the other");
      inner = *map;
    }
  }
  const char channel = channel_of(mask_map, mask);
  bool binary = true;
  made.texels.assign(static_cast<std::size_t>(made.width) * made.height, 0xFFFFFFFFu);
  for (std::uint32_t y = 0; y < made.height; ++y)
    for (std::uint32_t x = 0; x < made.width; ++x) {
      const double u = (x + 0.5) / made.width, v = (y + 0.5) / made.height;
      Rgba rgba = {{255, 255, 255, 255}};
      if (has_color)
        rgba =
            unpack(texel(color, place_in(outer, color_map, 0, u), place_in(outer, color_map, 1, v), color_map.clamp));
      const std::uint32_t covering =
          texel(mask, place_in(outer, inner, 0, u), place_in(outer, inner, 1, v), mask_map.clamp);
      rgba.c[3] = in_range(mask_map, value_of(unpack(covering), channel));
      binary &= rgba.c[3] == 0 || rgba.c[3] == 255;
      made.texels[static_cast<std::size_t>(y) * made.width + x] = pack(rgba);
    }
  const bool clamp = map->clamp || mask_map.clamp;
  *map = outer;
  map->clamp = clamp;
  return binary;
}

}  // namespace pocketray
