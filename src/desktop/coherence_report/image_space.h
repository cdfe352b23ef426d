// The image-space methods that [Jevans92] sec. 2.1 argues against, for comparison only: unlike the program's own, they
// miss changes. They see only pixels, so here they are functions of a pixel tracer.
#pragma once
#include <functional>
#include <vector>

#include "base/rng.h"
#include "base/status.h"
#include "base/vec3.h"

namespace pocketray {

// Pixels of a picture by index, row by row, ascending; none twice.
using PixelList = std::vector<std::uint32_t>;
using FrameImage = std::vector<Vec3>;  // linear radiance, row 0 on top

// Traces these pixels of the frame into the picture.
using TracePixels = std::function<Status(std::uint32_t frame, const PixelList& pixels, FrameImage* image)>;

// Returns whether two pixels differ in any bit.
bool differs(const Vec3& one, const Vec3& other);

// [Badt 1988, "Two algorithms for taking advantage of temporal coherence in ray tracing"]: retraces a random sample of
// a frame's pixels, and flood-fills the change around each pixel that differs from the last frame.
struct BadtState {
  std::uint32_t width = 0, height = 0;
  FrameImage image;   // the last frame
  PixelList changed;  // pixels that changed in it
  Rng rng;
};

// Returns `count` (at most `pixel_count`) random pixels, each set equally likely [Knuth 1997, The Art of Computer
// Programming, vol. 2, sec. 3.4.2, algorithm S].
PixelList sample_pixels(std::uint32_t pixel_count, std::uint32_t count, Rng* rng);

// Traces the frame's first pixels, then all neighbours of pixels that changed, until no further pixel changes. *traced
// receives the number of traced pixels.
Status flood_changes(const TracePixels& trace, std::uint32_t frame, const PixelList& first, BadtState* state,
                     std::uint64_t* traced);

// Traces the next frame from a sample of that share of the pixels. Badt also floods in time; here a frame is shown
// before the next one is traced, so the flood only goes forwards: pixels that changed in the last frame are traced
// again.
Status badt_frame(const TracePixels& trace, std::uint32_t frame, double share, BadtState* state, std::uint64_t* traced);

// [Chapman et al. 1990, "Exploiting temporal coherence in ray tracing"]: images[0] is frame `first`, already traced.
// Traces the last of the `count` (at least 2) frames, then halves time intervals and traces the pixels that differ at
// their ends; a pixel that is equal at both ends counts as unchanged within. traced[i] receives the number of pixels
// traced in images[i], i ≥ 1.
Status chapman_frames(const TracePixels& trace, std::uint32_t first, std::size_t count, FrameImage* images,
                      std::uint64_t* traced);

}  // namespace pocketray
