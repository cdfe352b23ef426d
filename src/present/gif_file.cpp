// GIF89a [CompuServe 1990, "Graphics Interchange Format, version 89a"], with the loop that Netscape added. Section
// numbers are those of the specification.
#include "present/gif_file.h"

#include <cstring>

#include "base/check.h"

namespace pocketray {

constexpr std::uint32_t kCodeBitsMax = 12, kCodesMax = 1u << kCodeBitsMax;
constexpr std::uint32_t kSlots = 2 * kCodesMax;  // of the hash table

// Dictionary of index sequences; each extends another by one index.
struct LzwTable {
  std::uint32_t keys[kSlots];  // code << 8 | index, + 1; 0: free
  std::uint16_t codes[kSlots];
};

namespace {

constexpr std::size_t kKnownColors = 1u << 12;
constexpr std::size_t kBlockBytes = 255;  // data bytes per block, sec. 15

struct CodeWriter {
  ByteSink sink;
  LzwTable* table;
  std::uint32_t clear, next, bits;  // the clear code; the next free code; bits per code
  std::uint32_t prefix;             // code of the indices not yet written
  bool has_prefix;
  std::uint32_t held = 0, held_bits = 0;
  std::uint8_t block[1 + kBlockBytes];
};

void write_block(CodeWriter* w) {
  if (w->block[0] > 0) w->sink.write(w->sink.user, w->block, 1u + w->block[0]);
  w->block[0] = 0;
}

void put_byte(CodeWriter* w, std::uint32_t byte) {
  w->block[++w->block[0]] = static_cast<std::uint8_t>(byte);
  if (w->block[0] == kBlockBytes) write_block(w);
}

void put_code(CodeWriter* w, std::uint32_t code) {
  CHECK_LT(code, 1u << w->bits);
  w->held |= code << w->held_bits;
  for (w->held_bits += w->bits; w->held_bits >= 8; w->held_bits -= 8) put_byte(w, w->held & 255), w->held >>= 8;
}

void clear_table(CodeWriter* w, std::uint32_t index_bits) {
  std::memset(w->table->keys, 0, sizeof w->table->keys);
  w->bits = index_bits + 1;
  w->next = w->clear + 2;
}

// Appendix F: variable-length codes, least significant bit first.
void put_index(CodeWriter* w, std::uint32_t index, std::uint32_t index_bits) {
  if (!w->has_prefix) {
    w->prefix = index, w->has_prefix = true;
    return;
  }
  const std::uint32_t key = (w->prefix << 8 | index) + 1;
  std::uint32_t slot =
      key * 2654435761u >> (32 - kCodeBitsMax - 1);  // multiplicative hashing [Knuth, TAOCP vol. 3, 6.4]
  while (w->table->keys[slot] != 0 && w->table->keys[slot] != key) slot = (slot + 1) % kSlots;
  if (w->table->keys[slot] == key) {
    w->prefix = w->table->codes[slot];
    return;
  }
  put_code(w, w->prefix);
  w->prefix = index;
  if (w->next == kCodesMax) {
    put_code(w, w->clear);
    clear_table(w, index_bits);
    return;
  }
  // A reader learns the new code one code later.
  if (w->next == 1u << w->bits) ++w->bits;
  w->table->keys[slot] = key;
  w->table->codes[slot] = static_cast<std::uint16_t>(w->next++);
}

void put_word(std::uint32_t value, std::uint8_t* bytes) {
  bytes[0] = static_cast<std::uint8_t>(value);
  bytes[1] = static_cast<std::uint8_t>(value >> 8);
}

// Returns whether the pixel is drawn: it changed, or this is the first frame.
bool is_shown(const GifWriter& gif, const std::uint8_t* rgb, std::size_t at) {
  return !gif.has_frame || !is_same_pixel(rgb + at, gif.last.data + at);
}

// Clears the cache. An empty slot reads as black, which belongs in slot 0 alone.
void forget_colors(GifWriter* gif, const Palette& palette) {
  std::memset(gif->known_colors.data, 0, gif->known_colors.bytes());
  gif->known_colors[0] = nearest_color(palette, {});
}

Rgb color_at(const std::uint8_t* rgb, std::size_t at) { return {{rgb[at], rgb[at + 1], rgb[at + 2]}}; }

void choose_palette(GifWriter* gif, const std::uint8_t* rgb, std::uint32_t color_max, Palette* palette) {
  const std::size_t bytes = gif->last.count;
  std::size_t shown = 0, taken = 0;
  for (std::size_t at = 0; at < bytes; at += 3) shown += is_shown(*gif, rgb, at);
  const std::size_t step = (shown + kPaletteSampleMax - 1) / kPaletteSampleMax;
  for (std::size_t at = 0, n = 0; at < bytes; at += 3)
    if (is_shown(*gif, rgb, at) && n++ % step == 0)
      gif->samples[static_cast<std::uint32_t>(taken++)] = color_at(rgb, at);
  if (taken == 0) gif->samples[static_cast<std::uint32_t>(taken++)] = {};
  make_palette({gif->samples.data, static_cast<std::uint32_t>(taken)}, color_max, palette);
}

std::uint32_t index_of(GifWriter* gif, const Palette& palette, const Rgb& color) {
  const std::uint32_t key =
      std::uint32_t(color.channel[0]) << 16 | std::uint32_t(color.channel[1]) << 8 | color.channel[2];
  std::uint32_t* known = &gif->known_colors[key * 2654435761u >> 20];
  if (*known >> 8 != key) *known = key << 8 | nearest_color(palette, color);
  return *known & 255;
}

// Secs. 23, 20 and 21: the frame's disposal and time, its position, and its palette of 2^index_bits colours.
void write_frame_head(const GifWriter& gif, const PixelBox& box, const Palette& palette, std::uint32_t index_bits,
                      std::uint32_t centiseconds) {
  std::uint8_t control[8] = {0x21, 0xf9, 4, 1 << 2, 0, 0, 0, 0};                              // keep what was shown
  if (gif.has_frame) control[3] |= 1, control[6] = static_cast<std::uint8_t>(palette.count);  // the transparent index
  put_word(centiseconds, control + 4);
  gif.sink.write(gif.sink.user, control, sizeof control);
  std::uint8_t image[10] = {0x2c};
  put_word(static_cast<std::uint32_t>(box.left), image + 1), put_word(static_cast<std::uint32_t>(box.top), image + 3);
  put_word(static_cast<std::uint32_t>(box.width), image + 5),
      put_word(static_cast<std::uint32_t>(box.height), image + 7);
  image[9] = static_cast<std::uint8_t>(0x80 | (index_bits - 1));
  gif.sink.write(gif.sink.user, image, sizeof image);
  std::uint8_t colors[3 * kPaletteMax] = {};
  for (std::uint32_t i = 0; i < palette.count; ++i) std::memcpy(colors + 3 * i, palette.colors[i].channel, 3);
  gif.sink.write(gif.sink.user, colors, std::size_t(3) << index_bits);
}

}  // namespace

std::size_t gif_need(int width, int height) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  return size_sum(arena_need(3 * pixels), arena_need<Rgb>(kPaletteSampleMax) + arena_need<std::uint32_t>(kKnownColors) +
                                              arena_need(sizeof(LzwTable)));
}

GifWriter begin_gif(const ByteSink& sink, int width, int height, Arena* arena) {
  CHECK(sink.write != nullptr && arena != nullptr);
  CHECK(width > 0 && width < 65536 && height > 0 && height < 65536);
  GifWriter gif;
  gif.sink = sink, gif.width = width, gif.height = height;
  gif.last = arena_array<std::uint8_t>(arena, 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  gif.samples = arena_array<Rgb>(arena, kPaletteSampleMax);
  gif.known_colors = arena_array<std::uint32_t>(arena, kKnownColors);
  gif.table = arena_array<LzwTable>(arena, 1).data;
  std::uint8_t head[13] = {'G', 'I', 'F', '8', '9', 'a', 0, 0, 0, 0, 0x70, 0, 0};  // secs. 17, 18: no common palette
  put_word(static_cast<std::uint32_t>(width), head + 6), put_word(static_cast<std::uint32_t>(height), head + 8);
  sink.write(sink.user, head, sizeof head);
  static const std::uint8_t kLoop[] = {0x21, 0xff, 11,  'N', 'E', 'T', 'S', 'C', 'A', 'P',
                                       'E',  '2',  '.', '0', 3,   1,   0,   0,   0};
  sink.write(sink.user, kLoop, sizeof kLoop);
  return gif;
}

void add_gif_frame(GifWriter* gif, const std::uint8_t* rgb, std::uint32_t centiseconds) {
  CHECK(gif->table != nullptr && rgb != nullptr);
  CHECK_LT(centiseconds, 65536u);
  PixelBox box = {0, 0, gif->width, gif->height};
  if (gif->has_frame) box = find_changed(gif->last.data, rgb, gif->width, gif->height);
  if (box.width == 0) box.width = box.height = 1;  // one transparent pixel
  Palette palette;
  choose_palette(gif, rgb, gif->has_frame ? kPaletteMax - 1 : kPaletteMax, &palette);
  const std::uint32_t color_count = palette.count + gif->has_frame;
  std::uint32_t index_bits = 2;  // appendix F: minimum
  while (1u << index_bits < color_count) ++index_bits;
  write_frame_head(*gif, box, palette, index_bits, centiseconds);

  forget_colors(gif, palette);
  CodeWriter w = {};
  w.sink = gif->sink, w.table = gif->table, w.clear = 1u << index_bits;
  const auto code_size = static_cast<std::uint8_t>(index_bits);
  w.sink.write(w.sink.user, &code_size, 1);
  clear_table(&w, index_bits);
  put_code(&w, w.clear);
  for (int y = box.top; y < box.top + box.height; ++y)
    for (int x = box.left; x < box.left + box.width; ++x) {
      const std::size_t at =
          3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(gif->width) + static_cast<std::size_t>(x));
      put_index(&w, is_shown(*gif, rgb, at) ? index_of(gif, palette, color_at(rgb, at)) : palette.count, index_bits);
    }
  put_code(&w, w.prefix);
  if (w.next == 1u << w.bits && w.bits < kCodeBitsMax) ++w.bits;
  put_code(&w, w.clear + 1);  // end of information
  if (w.held_bits > 0) put_byte(&w, w.held);
  write_block(&w);
  const std::uint8_t end = 0;
  w.sink.write(w.sink.user, &end, 1);
  std::memcpy(gif->last.data, rgb, gif->last.count);
  gif->has_frame = true;
}

void end_gif(GifWriter* gif) {
  CHECK(gif->has_frame);
  const std::uint8_t trailer = 0x3b;
  gif->sink.write(gif->sink.user, &trailer, 1);
}

}  // namespace pocketray
