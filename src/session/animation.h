// A sequence of frames as one file: GIF, animated PNG or, through ffmpeg, a video.
#pragma once
#include <string>

#include "platform/process.h"
#include "present/gif_file.h"
#include "present/png_file.h"
#include "session/output.h"
#include "session/picture.h"

namespace pocketray {

enum class AnimationKind { none, gif, png, video };
// Chosen by the path's suffix: .gif, .apng, .mp4.
AnimationKind animation_kind(const std::string& path);

// Chosen: from a slide every ten seconds to the fastest screens. GIF counts delays in hundredths of a second [GIF89a,
// sec. 23], and browsers slow down delays of less than two.
constexpr double kAnimationRateMin = 0.1, kAnimationRateMax = 240, kGifRateMax = 50;
// Fails if the kind of file cannot play that frame rate, if ffmpeg is missing, or if it cannot encode pictures of that
// size.
Status check_animation(AnimationKind kind, double frames_per_second, std::uint32_t width, std::uint32_t height);

// Bytes of the frame arena, in addition to picture_bytes().
std::size_t animation_bytes(AnimationKind kind, const Settings& settings);

// The file being written; it appears when end_animation() succeeds. Only beginning and ending allocate memory.
struct AnimationFile {
  AnimationKind kind = AnimationKind::none;
  std::string path;
  double frames_per_second = 0;
  std::uint32_t frame_count = 0;  // announced
  std::uint32_t written = 0;
  int width = 0, height = 0;
  Array<std::uint8_t> pixels;  // R, G, B of a frame, with room for the uncropped frame
  platform::FileWriter writer;
  GifWriter gif;
  AnimatedPng png;
  platform::Process encoder;
  std::string folder;  // for the encoder's files

  AnimationFile() = default;
  AnimationFile(const AnimationFile&) = delete;
  AnimationFile& operator=(const AnimationFile&) = delete;
  ~AnimationFile();  // discards an unfinished file
};

// `picture` applies to every frame.
Status begin_animation(const std::string& path, AnimationKind kind, double frames_per_second, std::uint32_t frame_count,
                       const PictureOptions& picture, Renderer* renderer, AnimationFile* animation);
// Adds the picture that write_picture() would write.
Status add_frame(const PictureOptions& picture, Renderer* renderer, AnimationFile* animation);
// Completes the file with the frames added so far, at least one.
Status end_animation(AnimationFile* animation);

}  // namespace pocketray
