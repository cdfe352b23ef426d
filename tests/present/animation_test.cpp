// Animated files: GIF and PNG, read back by small readers written from the specifications.
#include <doctest/doctest.h>
#include <zlib.h>

#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "present/gif_file.h"
#include "present/png_file.h"

using namespace pocketray;

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes written;
const ByteSink kSink = {[](void*, const void* bytes, std::size_t count) {
                          const auto* from = static_cast<const std::uint8_t*>(bytes);
                          written.insert(written.end(), from, from + count);
                        },
                        nullptr};

struct Shown {
  std::vector<Bytes> frames;  // R, G, B
  std::vector<int> delays;
};

std::uint32_t word_at(const Bytes& b, std::size_t at) { return b.at(at) | std::uint32_t(b.at(at + 1)) << 8; }
std::uint32_t long_at(const Bytes& b, std::size_t at) {
  return std::uint32_t(b.at(at)) << 24 | std::uint32_t(b.at(at + 1)) << 16 | std::uint32_t(b.at(at + 2)) << 8 |
         b.at(at + 3);
}

// The indices that LZW data stand for [GIF89a, appendix F].
Bytes decode_lzw(const Bytes& data, std::uint32_t index_bits) {
  std::vector<Bytes> entries;
  const std::uint32_t clear = 1u << index_bits;
  std::uint32_t bits = index_bits + 1;
  Bytes out, before;
  auto reset = [&] {
    entries.clear();
    for (std::uint32_t i = 0; i < clear + 2; ++i) entries.push_back({static_cast<std::uint8_t>(i)});
    bits = index_bits + 1, before.clear();
  };
  reset();
  for (std::size_t at = 0; at + bits <= 8 * data.size();) {
    std::uint32_t code = 0;
    for (std::uint32_t i = 0; i < bits; ++i, ++at) code |= (data[at / 8] >> at % 8 & 1u) << i;
    if (code == clear) {
      reset();
      continue;
    }
    if (code == clear + 1) {
      CHECK(8 * data.size() - at < 8);
      return out;
    }
    REQUIRE(code <= entries.size());
    Bytes now = code < entries.size() ? entries[code] : before;
    if (code == entries.size()) now.push_back(before.at(0));
    out.insert(out.end(), now.begin(), now.end());
    if (!before.empty() && entries.size() < 4096) {
      before.push_back(now[0]);
      entries.push_back(before);
      if (entries.size() == 1u << bits && bits < 12) ++bits;
    }
    before = now;
  }
  FAIL("the data have no end");
  return out;
}

Shown read_gif(const Bytes& b) {
  Shown shown;
  REQUIRE(std::memcmp(b.data(), "GIF89a", 6) == 0);
  const std::size_t width = word_at(b, 6), height = word_at(b, 8);
  Bytes screen(3 * width * height);
  std::size_t at = 13;
  int transparent = -1;
  for (; b.at(at) != 0x3b;) {
    if (b[at] == 0x21) {  // an extension
      if (b[at + 1] == 0xf9) {
        shown.delays.push_back(static_cast<int>(word_at(b, at + 4)));
        transparent = b[at + 3] & 1 ? b[at + 6] : -1;
      }
      for (at += 2; b.at(at) != 0;) at += 1u + b[at];
      ++at;
      continue;
    }
    REQUIRE(b[at] == 0x2c);
    const std::size_t left = word_at(b, at + 1), top = word_at(b, at + 3), w = word_at(b, at + 5),
                      h = word_at(b, at + 7);
    const std::size_t palette = at + 10;
    at = palette + (std::size_t(6) << (b[at + 9] & 7));
    const std::uint32_t index_bits = b.at(at++);
    Bytes data;
    for (; b.at(at) != 0; at += 1u + b[at])
      data.insert(data.end(), b.begin() + static_cast<long>(at) + 1, b.begin() + static_cast<long>(at) + 1 + b[at]);
    ++at;
    const Bytes indices = decode_lzw(data, index_bits);
    REQUIRE(indices.size() == w * h);
    for (std::size_t i = 0; i < indices.size(); ++i)
      if (indices[i] != transparent)
        std::memcpy(&screen.at(3 * ((top + i / w) * width + left + i % w)), &b.at(palette + 3u * indices[i]), 3);
    shown.frames.push_back(screen);
  }
  CHECK(at + 1 == b.size());
  return shown;
}

// Filtered rows → pixels; only the filter that the program writes, Paeth's.
Bytes unfilter(const Bytes& rows, std::size_t width, std::size_t height) {
  Bytes pixels;
  const std::size_t row_bytes = 3 * width;
  REQUIRE(rows.size() == (row_bytes + 1) * height);
  for (std::size_t y = 0; y < height; ++y) {
    CHECK(rows[y * (row_bytes + 1)] == 4);
    for (std::size_t x = 0; x < row_bytes; ++x) {
      const int a = x >= 3 ? pixels[y * row_bytes + x - 3] : 0, up = y > 0 ? pixels[(y - 1) * row_bytes + x] : 0;
      const int c = x >= 3 && y > 0 ? pixels[(y - 1) * row_bytes + x - 3] : 0, p = a + up - c;
      const int da = std::abs(p - a), du = std::abs(p - up), dc = std::abs(p - c);
      const int estimate = da <= du && da <= dc ? a : du <= dc ? up : c;
      pixels.push_back(static_cast<std::uint8_t>(rows[y * (row_bytes + 1) + 1 + x] + estimate));
    }
  }
  return pixels;
}

Shown read_png(const Bytes& b, std::uint32_t* announced) {
  Shown shown;
  std::size_t width = 0, height = 0;
  Bytes screen, data;
  std::uint32_t sequence = 0, box[4] = {};
  auto show = [&] {
    if (shown.delays.size() == shown.frames.size()) return;
    Bytes rows((3 * box[0] + 1) * box[1]);
    uLongf count = rows.size();
    REQUIRE(uncompress(rows.data(), &count, data.data(), data.size()) == Z_OK);
    const Bytes pixels = unfilter(rows, box[0], box[1]);
    for (std::size_t y = 0; y < box[1]; ++y)
      std::memcpy(&screen.at(3 * ((box[3] + y) * width + box[2])), &pixels[3 * y * box[0]], 3 * box[0]);
    shown.frames.push_back(screen);
    data.clear();
  };
  for (std::size_t at = 8; at < b.size();) {
    const std::uint32_t count = long_at(b, at);
    const std::string type(reinterpret_cast<const char*>(&b.at(at + 4)), 4);
    const std::size_t content = at + 8;
    CHECK(crc32(0, &b[at + 4], count + 4) == long_at(b, content + count));
    if (type == "IHDR")
      width = long_at(b, content), height = long_at(b, content + 4), screen.resize(3 * width * height);
    if (type == "acTL") {
      CHECK(at == kPngFrameCountOffset);
      *announced = long_at(b, content);
    }
    if (type == "fcTL") {
      show();
      CHECK(long_at(b, content) == sequence++);
      for (std::size_t i = 0; i < 4; ++i) box[i] = long_at(b, content + 4 + 4 * i);
      shown.delays.push_back(static_cast<int>(long_at(b, content + 20)));
    }
    if (type == "IDAT") data.insert(data.end(), &b[content], &b[content] + count);
    if (type == "fdAT") {
      CHECK(long_at(b, content) == sequence++);
      data.insert(data.end(), &b[content + 4], &b[content] + count);
    }
    if (type == "IEND") show();
    at = content + count + 4;
  }
  return shown;
}

struct Maker {
  std::uint32_t state = 1;
  std::uint8_t operator()() { return static_cast<std::uint8_t>((state = state * 1664525 + 1013904223) >> 24); }
};

Bytes filled(int width, int height, std::uint8_t r, std::uint8_t g, std::uint8_t b) {
  Bytes rgb;
  for (int i = 0; i < width * height; ++i) rgb.insert(rgb.end(), {r, g, b});
  return rgb;
}

// Four frames: noise of so many colours (0: any), some pixels changed, the same again, another noise.
std::vector<Bytes> frames_of(int width, int height, int color_count, std::uint32_t seed) {
  Maker random = {seed};
  Bytes palette;
  for (int i = 0; i < 3 * color_count; ++i) palette.push_back(random());
  auto pixel = [&](std::uint8_t* to) {
    const int i = color_count ? (random() << 8 | random()) % color_count : 0;
    for (int c = 0; c < 3; ++c) to[c] = color_count ? palette[static_cast<std::size_t>(3 * i + c)] : random();
  };
  std::vector<Bytes> frames(4, filled(width, height, 0, 0, 0));
  for (std::size_t at = 0; at < frames[0].size(); at += 3) pixel(&frames[0][at]), pixel(&frames[3][at]);
  frames[1] = frames[0];
  for (std::size_t at = frames[0].size() / 2 / 3 * 3; at < frames[0].size(); at += 9) pixel(&frames[1][at]);
  frames[2] = frames[1];
  return frames;
}

Shown through_gif(const std::vector<Bytes>& frames, int width, int height) {
  std::vector<std::uint8_t> block(gif_need(width, height) + kArenaAlignment);
  Arena arena = make_arena("frame", block.data(), block.size());
  written.clear();
  GifWriter gif = begin_gif(kSink, width, height, &arena);
  CHECK(arena.used == gif_need(width, height));
  for (std::size_t i = 0; i < frames.size(); ++i)
    add_gif_frame(&gif, frames[i].data(), static_cast<std::uint32_t>(3 + i));
  end_gif(&gif);
  return read_gif(written);
}

double error_of(const Bytes& a, const Bytes& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

}  // namespace

// Goal: a GIF shows every frame exactly if its changes have at most 255 colours, for its delay. Method: noise of few
// colours, in which codes grow to 12 bits and the dictionary fills many times; one pixel; black, which a cache might
// take for an empty place, and white.
TEST_CASE("gif_of_few_colors_is_exact") {
  for (int color_count : {1, 2, 4, 5, 100, 255}) {
    CAPTURE(color_count);
    const auto frames = frames_of(160, 120, color_count, static_cast<std::uint32_t>(color_count));
    const Shown shown = through_gif(frames, 160, 120);
    CHECK(shown.frames == frames);
    CHECK(shown.delays == std::vector<int>{3, 4, 5, 6});
  }
  const std::vector<Bytes> pixel = {{0, 0, 0}, {255, 255, 255}, {255, 255, 255}, {0, 0, 0}};
  CHECK(through_gif(pixel, 1, 1).frames == pixel);
}

// Goal: with more colours, frames are near and pixels that did not change stay as they were, bit for bit. Method: noise
// and a smooth picture of 65,536 colours, the mean squared error of each.
TEST_CASE("gif_of_many_colors_is_near") {
  const auto frames = frames_of(200, 150, 0, 5);
  const Shown shown = through_gif(frames, 200, 150);
  for (std::size_t i = 0; i < frames.size(); ++i)
    CHECK(error_of(shown.frames[i], frames[i]) < 400);  // noise: 5461 from grey
  for (std::size_t at = 0; at < frames[0].size(); ++at)
    if (at < frames[0].size() / 2 / 3 * 3) CHECK(shown.frames[1][at] == shown.frames[0][at]);
  CHECK(shown.frames[2] == shown.frames[1]);
  Bytes smooth;
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 256; ++x)
      smooth.insert(smooth.end(), {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 128});
  CHECK(error_of(through_gif({smooth}, 256, 256).frames[0], smooth) < 25);
}

// Goal: a frame is stored as the box that changed. Method: a pixel of a large picture, and nothing.
TEST_CASE("animations_store_what_changed") {
  auto first = frames_of(300, 200, 200, 1)[0], second = first;
  second[3 * (100 * 300 + 7)] ^= 255;
  through_gif({first}, 300, 200);
  const std::size_t one = written.size();
  through_gif({first, second, second}, 300, 200);
  CHECK(written.size() - one < 120);
  PixelBox box = find_changed(first.data(), second.data(), 300, 200);
  CHECK((box.left == 7 && box.top == 100 && box.width == 1 && box.height == 1));
  second[3 * (199 * 300 + 299) + 2] ^= 1, second[1] ^= 1;
  box = find_changed(first.data(), second.data(), 300, 200);
  CHECK((box.left == 0 && box.top == 0 && box.width == 300 && box.height == 200));
  CHECK(find_changed(first.data(), first.data(), 300, 200).width == 0);
}

// Goal: an animated PNG shows every frame exactly, within the memory announced. Method: noise; frames larger than a
// chunk; a first frame alone; fewer frames than announced.
TEST_CASE("animated_png_is_exact") {
  for (int width : {1, 160}) {
    CAPTURE(width);
    const int height = width == 1 ? 1 : 120;
    const auto frames = frames_of(width, height, 0, 9);
    std::vector<std::uint8_t> block(animated_png_need(width, height) + kArenaAlignment);
    Arena arena = make_arena("frame", block.data(), block.size());
    written.clear();
    AnimatedPng png = begin_animated_png(kSink, width, height, 9, &arena);
    for (const Bytes& frame : frames) REQUIRE(add_png_frame(&png, frame.data(), 100, 2997).ok);
    end_animated_png(&png);
    CHECK(arena.used_max <= animated_png_need(width, height));
    std::uint32_t announced = 0;
    Shown shown = read_png(written, &announced);
    CHECK(announced == 9);
    CHECK(shown.frames == frames);
    CHECK(shown.delays == std::vector<int>(4, 100 << 16 | 2997));

    const Bytes whole = written;
    written.clear();
    write_png_frame_count(kSink, 4);
    REQUIRE(written.size() == 20);
    Bytes shortened = whole;
    std::memcpy(&shortened[kPngFrameCountOffset], written.data(), written.size());
    CHECK(read_png(shortened, &announced).frames == frames);
    CHECK(announced == 4);
  }
}

// Goal: a palette has the colours there are, or the best for them, whatever their order. Method: few colours; one rare
// colour among shades of another; samples backwards.
TEST_CASE("palette_stands_for_the_colors") {
  std::vector<Rgb> samples(1000, Rgb{{10, 20, 30}});
  samples[500] = {{200, 0, 0}};
  Palette palette;
  make_palette({samples.data(), 1000}, 256, &palette);
  CHECK(palette.count == 2);
  CHECK(palette.colors[nearest_color(palette, {{200, 0, 0}})] == Rgb{{200, 0, 0}});
  CHECK(palette.colors[nearest_color(palette, {{0, 0, 0}})] == Rgb{{10, 20, 30}});
  for (std::uint32_t i = 0; i < 1000; ++i)
    samples[i] = {{static_cast<std::uint8_t>(i / 4), static_cast<std::uint8_t>(i % 50), 9}};
  std::vector<Rgb> backwards(samples.rbegin(), samples.rend());
  Palette other;
  make_palette({samples.data(), 1000}, 16, &palette);
  make_palette({backwards.data(), 1000}, 16, &other);
  REQUIRE(palette.count == 16);
  for (std::uint32_t i = 0; i < 16; ++i) CHECK(palette.colors[i] == other.colors[i]);
}
