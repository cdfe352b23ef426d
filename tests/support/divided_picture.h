// A picture traced in parts, which must not change it.
#pragma once
#include <algorithm>
#include <cstring>
#include <vector>

#include "shade/trace_spans.h"
#include "support/generated_scene.h"

namespace pocketray {

// Rows, pieces of rows, and single pixels of a picture 40 pixels wide.
struct Divisions {
  std::vector<Span> rows, odd, pixels;

  explicit Divisions(std::uint32_t height) {
    for (std::uint16_t y = 0; y < height; ++y) {
      rows.push_back({y, 0, 40});
      odd.push_back({y, static_cast<std::uint16_t>(y % 7), static_cast<std::uint16_t>(23 + y % 5)});
      for (std::uint16_t x = static_cast<std::uint16_t>(y % 3); x < 40; x = static_cast<std::uint16_t>(x + 5))
        pixels.push_back({y, x, static_cast<std::uint16_t>(x + 1)});
    }
  }
};

inline bool same_pixel(const Vec3& a, const Vec3& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// How many pixels of the spans differ from those of the whole picture, if they are traced `group` spans at a time.
inline std::size_t different_pixels(const Renderer& renderer, const std::vector<Vec3>& whole,
                                    const std::vector<Span>& spans, std::size_t group) {
  std::vector<Vec3> again(whole.size(), Vec3{-1, -1, -1});
  Tracer tracer = make_tracer(renderer.frame);
  for (std::size_t i = 0; i < spans.size(); i += group)
    trace_spans(&tracer, spans.data() + i, static_cast<std::uint32_t>(std::min(group, spans.size() - i)), Aov::none,
                again.data());
  std::size_t different = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) different += again[i].x >= 0 && !same_pixel(again[i], whole[i]);
  return different;
}

}  // namespace pocketray
