// Runs a sequence with the image-space methods, and measures their cost and errors against whole frames.
#pragma once
#include <string>
#include <vector>

#include "desktop/coherence_report/image_space.h"
#include "desktop/coherence_report/render_cost.h"
#include "session/progress.h"
#include "session/sequence.h"

namespace pocketray {

enum class ImageSpaceMethod { badt, chapman };

// Badt's fraction of the pixels, 1 / parameter, or Chapman's distance in frames between traced frames.
struct ImageSpaceWay {
  ImageSpaceMethod method;
  std::uint32_t parameter;
};
constexpr ImageSpaceWay kImageSpaceWays[] = {
    {ImageSpaceMethod::badt, 4},    {ImageSpaceMethod::badt, 8},    {ImageSpaceMethod::badt, 16},
    {ImageSpaceMethod::badt, 32},   {ImageSpaceMethod::badt, 64},   {ImageSpaceMethod::chapman, 2},
    {ImageSpaceMethod::chapman, 4}, {ImageSpaceMethod::chapman, 8}, {ImageSpaceMethod::chapman, 16}};

// Differences of pictures from whole frames.
struct ImageSpaceErrors {
  std::uint64_t wrong = 0;        // pixels that differ in any bit of radiance ...
  std::uint64_t wrong_shown = 0;  // ... and in the bytes that a screen of RGB888 shows
  std::uint64_t wrong_most = 0;   // of `wrong`, in one frame
  double flip_sum = 0;            // of each frame's mean
  double flip_max = 0;            // maximum of any pixel
};

struct ImageSpaceFigures {
  ImageSpaceWay way;
  RenderCost cost;
  std::uint64_t traced = 0;  // pixels
  ImageSpaceErrors errors;
};

// Sums over the frames.
struct ImageSpaceRun {
  std::uint32_t width = 0, height = 0;
  std::size_t frame_count = 0;  // finished ones; 0: not run
  RenderCost whole;
  std::vector<ImageSpaceFigures> ways;
};

// Frames are rendered in groups. Every variant traces the first frame whole, Chapman also the last one.
constexpr std::uint32_t kGroupFrames = 16;

// Compares a frame with the whole frame, as displayed, and adds to the errors.
void add_errors(const FrameImage& whole, const FrameImage& image, std::uint32_t width, std::uint32_t height,
                const Display& display, ImageSpaceErrors* errors);

// Number of steps of progress.
std::uint64_t image_space_step_count(const FrameRange& range);

// The renderer must be built without coherence and trace each pixel on its own. Keeps finished groups of frames after
// an interrupt.
Status run_image_space(Renderer* renderer, const FrameRange& range, Progress* progress, ImageSpaceRun* run);

// "Badt 1988, 1/64 of the pixels sampled", "Chapman 1990, frames 4 apart"
std::string name_of(const ImageSpaceWay& way);

}  // namespace pocketray
