// One row per way of using frames that some other way rules out or requires, and the rules between them. plan/resolve.h
// derives the command line's refusals: a new way is a row and its rules.
#pragma once
#include <cstdint>

namespace pocketray {

enum class Use : std::uint8_t {
  servers,
  budget,
  front,
  ranks,
  frames,
  turntable,
  sequence,   // frames or a turntable
  numbered,   // a sequence of numbered pictures
  animation,  // a sequence in one file
  still,      // numbered pictures of a turntable, at a fixed time
  output,     // one picture, on standard output
  orbit,
  frame_rate,
  resume,
  values,  // pictures that store radiance
  raw,
  aov,
  crop,
  rotate,
  dither,
  coherence,
  side_by_side,
};
constexpr int kUseCount = 22;
using UseMask = std::uint32_t;
constexpr UseMask bit(Use use) { return UseMask(1) << static_cast<int>(use); }

struct UseRow {
  Use use;
  const char* name;            // as a subject: "--fps"
  const char* drop = nullptr;  // null: "drop --fps"
  const char* give = nullptr;  // where other uses need it
};

inline constexpr UseRow kUseList[kUseCount] = {
    {Use::servers, "--server"},
    {Use::budget, "--budget-ms", nullptr, "add --budget-ms or --flip-max"},
    {Use::front, "--front"},
    {Use::ranks, "mpirun", "start without mpirun"},
    {Use::frames, "--frames", nullptr, "add --frames 0:99"},
    {Use::turntable, "--turntable"},
    {Use::sequence, "a sequence", "drop --frames and --turntable", "add --frames 0:99 or --turntable 36"},
    {Use::numbered, "numbered pictures", "write one file", "add --frames 0:99 or --turntable 36 and write .png"},
    {Use::animation, "an animation", "write .png"},
    {Use::still, "pictures of a turntable", "write .gif, .apng or .mp4"},
    {Use::output, "-o -", "add --format gif or apng"},
    {Use::orbit, "--orbit"},
    {Use::frame_rate, "--fps"},
    {Use::resume, "--resume"},
    {Use::values, "a picture of radiance", "write .png or .ppm"},
    {Use::raw, "a .raw picture", "write .png or .ppm", "write .raw"},
    {Use::aov, "--aov"},
    {Use::crop, "--crop"},
    {Use::rotate, "--rotate"},
    {Use::dither, "--dither"},
    {Use::coherence, "--coherence on", "drop --coherence"},
    {Use::side_by_side, "--side-by-side"},
};

struct UseRule {
  Use use;
  bool needs;  // the other use, or excludes it
  Use other;
  const char* because;  // completes a sentence that the use's name begins
};
constexpr bool kNeeds = true, kExcludes = false;

// The first rule that is broken explains the refusal.
inline constexpr UseRule kUseRules[] = {
    {Use::animation, kNeeds, Use::sequence, "is an animation"},
    {Use::output, kExcludes, Use::sequence, "is one file"},
    {Use::ranks, kExcludes, Use::animation, "starts programs that write a file each, and an animation is one file"},
    {Use::ranks, kNeeds, Use::sequence, "starts several programs and one picture is rendered by one"},
    {Use::ranks, kExcludes, Use::servers, "starts ranks, which share frames by themselves"},
    {Use::ranks, kExcludes, Use::budget, "starts ranks, which share frames by themselves"},
    {Use::rotate, kNeeds, Use::raw, "is for .raw pictures"},
    {Use::dither, kNeeds, Use::raw, "is for .raw pictures"},
    {Use::rotate, kExcludes, Use::crop, "turns whole pictures"},
    {Use::resume, kExcludes, Use::servers, "cannot tell that pictures match"},
    {Use::resume, kExcludes, Use::budget, "cannot tell that pictures match"},
    {Use::resume, kNeeds, Use::numbered, "is for sequences of numbered pictures"},
    {Use::frame_rate, kNeeds, Use::sequence, "is for sequences"},
    {Use::frame_rate, kExcludes, Use::still, "has no effect on numbered pictures at a fixed time"},
    {Use::orbit, kNeeds, Use::frames, "turns the camera from frame to frame"},
    {Use::front, kNeeds, Use::budget, "is the file that --budget-ms and --flip-max choose from"},
    {Use::servers, kExcludes, Use::aov, "sends only colours"},
    {Use::servers, kExcludes, Use::values, "sends display levels but .pfm and .exr store radiance"},
    {Use::servers, kExcludes, Use::crop, "sends whole rows"},
    {Use::budget, kExcludes, Use::servers, "changes settings per frame and servers cannot"},
    {Use::budget, kExcludes, Use::aov, "renders only colours"},
    {Use::budget, kExcludes, Use::crop, "measures whole frames"},
    {Use::coherence, kExcludes, Use::turntable, "has no effect where the camera moves"},
    {Use::crop, kExcludes, Use::coherence, "leaves the rest of the last frame unknown"},
    {Use::coherence, kNeeds, Use::frames, "has no effect on a single frame"},
    {Use::coherence, kExcludes, Use::aov, "has no effect on false colours"},
    {Use::side_by_side, kExcludes, Use::servers, "works only without render servers"},
};

constexpr bool uses_in_order() {
  for (int i = 0; i < kUseCount; ++i)
    if (static_cast<int>(kUseList[i].use) != i) return false;
  for (const UseRule& rule : kUseRules)
    if (rule.needs && !kUseList[static_cast<int>(rule.other)].give) return false;
  return true;
}
static_assert(uses_in_order(), "one row for each use, in their order, which says how to give what others need");

}  // namespace pocketray
