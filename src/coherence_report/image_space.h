// The image-space methods that [Jevans92] sec. 2.1 argues against, for comparison only: unlike the program's own, they
// miss changes. They see pixels alone, so here they are functions of whoever traces pixels.
#pragma once
#include <functional>
#include <vector>

#include "base/rng.h"
#include "base/status.h"
#include "base/vec3.h"

namespace pocketray {

// Pixels of a picture by index, row by row, in ascending order; none twice.
using PixelList = std::vector<std::uint32_t>;
using FrameImage = std::vector<Vec3>;  // linear radiance, row 0 on top

// Traces those pixels of the frame into the picture.
using TracePixels = std::function<Status(std::uint32_t frame, const PixelList& pixels, FrameImage* image)>;

// Whether two pixels differ in any bit.
bool differs(const Vec3& one, const Vec3& other);

// [Badt 1988, "Two algorithms for taking advantage of temporal coherence in ray tracing"]: a random sample of a frame's
// pixels is traced again, and around each pixel that differs from the last frame the change is flooded.
struct BadtState {
  std::uint32_t width = 0, height = 0;
  FrameImage image;   // the last frame
  PixelList changed;  // in it
  Rng rng;
};

// `count` (at most `pixel_count`) random pixels, each set equally likely [Knuth 1997, The Art of Computer Programming,
// vol. 2, sec. 3.4.2, algorithm S].
PixelList sample_pixels(std::uint32_t pixel_count, std::uint32_t count, Rng* rng);

// Traces the frame's first pixels, then all neighbours of pixels that changed, until no further pixel changes. *traced
// receives how many pixels were traced.
Status flood_changes(const TracePixels& trace, std::uint32_t frame, const PixelList& first, BadtState* state,
                     std::uint64_t* traced);

// The frame after the last one, from a sample of that share of the pixels. Badt floods in time as well; here a frame is
// shown before the next one is traced, so the flood goes forwards alone: what changed in the last frame is traced
// again.
Status badt_frame(const TracePixels& trace, std::uint32_t frame, double share, BadtState* state, std::uint64_t* traced);

// [Chapman et al. 1990, "Exploiting temporal coherence in ray tracing"]: images[0] is frame `first`, traced. Traces the
// last of the `count` (at least 2) frames, then the pixels that differ at both ends of an interval of time, which is
// halved; a pixel that is equal at both ends counts as unchanged within. traced[i] receives how many pixels of
// images[i] were traced, i ≥ 1.
Status chapman_frames(const TracePixels& trace, std::uint32_t first, std::size_t count, FrameImage* images,
                      std::uint64_t* traced);

}  // namespace pocketray
