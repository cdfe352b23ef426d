#include "desktop/coherence_report/image_space.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "base/check.h"

namespace pocketray {
namespace {

PixelList all_pixels(std::size_t count) {
  PixelList pixels(count);
  std::iota(pixels.begin(), pixels.end(), 0u);
  return pixels;
}

PixelList union_of(const PixelList& one, const PixelList& other) {
  PixelList both;
  both.reserve(one.size() + other.size());
  std::set_union(one.begin(), one.end(), other.begin(), other.end(), std::back_inserter(both));
  return both;
}

// Adds the neighbours that are not yet listed.
void add_neighbours(std::uint32_t pixel, std::uint32_t width, std::uint32_t height, std::vector<bool>* listed,
                    PixelList* pixels) {
  const std::uint32_t column = pixel % width, row = pixel / width;
  for (std::uint32_t y = row > 0 ? row - 1 : 0; y <= std::min(row + 1, height - 1); ++y)
    for (std::uint32_t x = column > 0 ? column - 1 : 0; x <= std::min(column + 1, width - 1); ++x) {
      const std::uint32_t neighbour = y * width + x;
      if ((*listed)[neighbour]) continue;
      (*listed)[neighbour] = true;
      pixels->push_back(neighbour);
    }
}

// A time interval, and the pixels that can differ at its ends.
struct Interval {
  std::size_t begin, end;
  PixelList pixels;
};

}  // namespace

bool differs(const Vec3& one, const Vec3& other) { return std::memcmp(&one, &other, sizeof one) != 0; }

PixelList sample_pixels(std::uint32_t pixel_count, std::uint32_t count, Rng* rng) {
  CHECK_LE(count, pixel_count);
  PixelList sample;
  sample.reserve(count);
  for (std::uint32_t pixel = 0; sample.size() < count; ++pixel) {
    const double left = pixel_count - pixel, wanted = static_cast<double>(count - sample.size());
    if (left * next_double(rng) < wanted) sample.push_back(pixel);
  }
  return sample;
}

Status flood_changes(const TracePixels& trace, std::uint32_t frame, const PixelList& first, BadtState* state,
                     std::uint64_t* traced) {
  CHECK_EQ(state->image.size(), std::size_t(state->width) * state->height);
  const FrameImage last = state->image;
  std::vector<bool> listed(last.size());
  for (std::uint32_t pixel : first) listed[pixel] = true;
  state->changed.clear();
  *traced = 0;
  for (PixelList pixels = first, next; !pixels.empty(); pixels.swap(next)) {
    RETURN_IF_ERROR(trace(frame, pixels, &state->image));
    *traced += pixels.size();
    next.clear();
    for (std::uint32_t pixel : pixels) {
      if (!differs(state->image[pixel], last[pixel])) continue;
      state->changed.push_back(pixel);
      add_neighbours(pixel, state->width, state->height, &listed, &next);
    }
    std::sort(next.begin(), next.end());
  }
  std::sort(state->changed.begin(), state->changed.end());
  return success();
}

Status badt_frame(const TracePixels& trace, std::uint32_t frame, double share, BadtState* state,
                  std::uint64_t* traced) {
  CHECK(share >= 0 && share <= 1);
  const std::uint32_t pixels = state->width * state->height;
  const std::uint32_t count = static_cast<std::uint32_t>(std::lround(share * pixels));
  return flood_changes(trace, frame, union_of(sample_pixels(pixels, count, &state->rng), state->changed), state,
                       traced);
}

Status chapman_frames(const TracePixels& trace, std::uint32_t first, std::size_t count, FrameImage* images,
                      std::uint64_t* traced) {
  CHECK_LE(std::size_t(2), count);
  const std::size_t last = count - 1;
  std::vector<Interval> open = {{0, last, all_pixels(images[0].size())}};
  images[last].resize(images[0].size());
  RETURN_IF_ERROR(trace(first + static_cast<std::uint32_t>(last), open[0].pixels, &images[last]));
  traced[last] = open[0].pixels.size();
  while (!open.empty()) {
    const Interval interval = std::move(open.back());
    open.pop_back();
    if (interval.end - interval.begin < 2) continue;
    const FrameImage &begin = images[interval.begin], &end = images[interval.end];
    PixelList differing;
    for (std::uint32_t pixel : interval.pixels)
      if (differs(begin[pixel], end[pixel])) differing.push_back(pixel);
    const std::size_t middle = (interval.begin + interval.end) / 2;
    images[middle] = begin;
    if (!differing.empty())
      RETURN_IF_ERROR(trace(first + static_cast<std::uint32_t>(middle), differing, &images[middle]));
    traced[middle] = differing.size();
    open.push_back({middle, interval.end, differing});
    open.push_back({interval.begin, middle, std::move(differing)});
  }
  return success();
}

}  // namespace pocketray
