#include "session/animation.h"

#include <cmath>
#include <cstdio>
#include <vector>

#include "base/check.h"
#include "base/seal.h"
#include "platform/standard_streams.h"

namespace pocketray {
namespace {

ByteSink sink_of(AnimationFile* a) {
  return {[](void* user, const void* bytes, std::size_t count) {
            platform::write_bytes(static_cast<platform::FileWriter*>(user), bytes, count);
          },
          &a->writer};
}

// Frames last whole hundredths of a second, so durations alternate: 3, 3, 4 for 30 per second.
std::uint32_t centiseconds_of(std::uint32_t frame, double frames_per_second) {
  auto end = [=](std::uint32_t count) { return std::floor(100.0 * count / frames_per_second + 0.5); };
  return static_cast<std::uint32_t>(end(frame + 1) - end(frame));
}

std::string encoder_file(const AnimationFile& a, const char* name) { return a.folder + "/" + name; }

Status start_encoder(AnimationFile* a) {
  char program[1024], folder[1024], size[32], rate[32];
  platform::FileError error;
  if (!platform::find_program("ffmpeg", program, sizeof program))
    return failure("%.300s needs ffmpeg, which is not in the path: install it, or write .gif or .apng",
                   a->path.c_str());
  if (!platform::make_temporary_folder(folder, sizeof folder, &error)) return failure("%s", error.text);
  a->folder = folder;
  std::snprintf(size, sizeof size, "%dx%d", a->width, a->height);
  std::snprintf(rate, sizeof rate, "%.9g", a->frames_per_second);
  const std::string video = encoder_file(*a, "video.mp4"), errors = encoder_file(*a, "errors");
  // Plays in browsers and on phones: H.264 with halved colour resolution, in HDTV's colours.
  const char* words[] = {"ffmpeg",
                         "-y",
                         "-loglevel",
                         "error",
                         "-f",
                         "rawvideo",
                         "-pixel_format",
                         "rgb24",
                         "-video_size",
                         size,
                         "-framerate",
                         rate,
                         "-i",
                         "-",
                         "-c:v",
                         "libx264",
                         "-crf",
                         "18",
                         "-vf",
                         "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p",
                         "-colorspace",
                         "bt709",
                         "-color_primaries",
                         "bt709",
                         "-color_trc",
                         "iec61966-2-1",
                         "-color_range",
                         "tv",
                         "-movflags",
                         "+faststart",
                         video.c_str(),
                         nullptr};
  platform::survive_closed_pipes();
  if (platform::start_fed_program(program, words, errors.c_str(), &a->encoder, &error)) return success();
  return failure("%.300s %s", program, error.text);
}

// Returns the last line that the encoder wrote.
std::string last_words(const AnimationFile& a) {
  platform::LoadedFile file;
  platform::FileError error;
  if (!platform::load_file(encoder_file(a, "errors").c_str(), &file, &error)) return "without an error message";
  std::string text(reinterpret_cast<const char*>(file.bytes), file.byte_count);
  platform::unload_file(&file);
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
  return text.substr(text.find_last_of("\r\n") + 1);
}

Status encoder_failure(AnimationFile* a) {
  SealPause pause;  // nothing follows it
  platform::end_feed(&a->encoder);
  (void)platform::wait_for(&a->encoder);
  return failure("ffmpeg could not write %.200s: %.250s", a->path.c_str(), last_words(*a).c_str());
}

// Copies the finished video to its place, so that it never appears there incomplete.
Status fetch_video(AnimationFile* a) {
  platform::end_feed(&a->encoder);
  if (!platform::wait_for(&a->encoder)) return encoder_failure(a);
  platform::FileReader video;
  platform::FileError error;
  if (!platform::open_reader(encoder_file(*a, "video.mp4").c_str(), &video, &error)) return encoder_failure(a);
  std::vector<std::uint8_t> part(1u << 16);
  bool ok = true;
  for (std::uint64_t left = video.byte_count; ok && left > 0;) {
    const std::size_t count = left < part.size() ? static_cast<std::size_t>(left) : part.size();
    ok = platform::read_bytes(&video, part.data(), count, &error);
    if (ok) platform::write_bytes(&a->writer, part.data(), count);
    left -= count;
  }
  platform::close_reader(&video);
  return ok ? success() : failure("the video %s", error.text);
}

}  // namespace

AnimationKind animation_kind(const std::string& path) {
  if (has_suffix(path.c_str(), ".gif")) return AnimationKind::gif;
  if (has_suffix(path.c_str(), ".apng")) return AnimationKind::png;
  return has_suffix(path.c_str(), ".mp4") ? AnimationKind::video : AnimationKind::none;
}

Status check_animation(AnimationKind kind, double frames_per_second, std::uint32_t width, std::uint32_t height) {
  if (kind == AnimationKind::none) return success();
  if (kind == AnimationKind::gif && frames_per_second > kGifRateMax)
    return failure("GIF plays at most %g frames per second and the sequence has %g: add --fps %g, or write .apng",
                   kGifRateMax, frames_per_second, kGifRateMax);
  if (kind != AnimationKind::video) return success();
  if (width % 2 != 0 || height % 2 != 0)
    return failure("an .mp4 needs an even width and height: try %ux%u", width + width % 2, height + height % 2);
  char program[1024];
  if (platform::find_program("ffmpeg", program, sizeof program)) return success();
  return failure("an .mp4 is encoded by ffmpeg, which is not in the path: install it, or write .gif or .apng");
}

std::size_t animation_bytes(AnimationKind kind, const Settings& settings) {
  const int width = static_cast<int>(settings.width), height = static_cast<int>(settings.height);
  if (kind == AnimationKind::none) return 0;
  std::size_t bytes = arena_need(3 * std::uint64_t(settings.width) * settings.height);
  if (kind == AnimationKind::gif) bytes = size_sum(bytes, gif_need(width, height));
  if (kind == AnimationKind::png) bytes = size_sum(bytes, animated_png_need(width, height));
  return bytes;
}

AnimationFile::~AnimationFile() {
  platform::kill_process(&encoder);
  platform::discard_writer(&writer);
  if (!folder.empty()) platform::remove_folder(folder.c_str());
}

Status begin_animation(const std::string& path, AnimationKind kind, double frames_per_second, std::uint32_t frame_count,
                       const PictureOptions& picture, Renderer* renderer, AnimationFile* a) {
  CHECK(a->kind == AnimationKind::none && kind != AnimationKind::none);
  CHECK_GT(frames_per_second, 0);
  const Settings& settings = renderer->settings;
  const PixelBox box = box_to_write(picture, settings);
  a->path = path, a->kind = kind, a->width = box.width, a->height = box.height;
  a->frames_per_second = frames_per_second, a->frame_count = frame_count;
  platform::FileError error;
  if (!platform::open_writer(path.c_str(), &a->writer, &error)) return failure("%.300s %s", path.c_str(), error.text);
  Arena* arena = &renderer->memory.frame;
  a->pixels = arena_array<std::uint8_t>(arena, 3 * static_cast<std::size_t>(settings.width) * settings.height);
  if (a->kind == AnimationKind::gif) a->gif = begin_gif(sink_of(a), a->width, a->height, arena);
  if (a->kind == AnimationKind::png) a->png = begin_animated_png(sink_of(a), a->width, a->height, frame_count, arena);
  return a->kind == AnimationKind::video ? start_encoder(a) : success();
}

Status add_frame(const PictureOptions& picture, Renderer* renderer, AnimationFile* a) {
  CHECK(a->pixels.data != nullptr);
  CHECK_LT(a->written, a->frame_count);
  picture_levels(picture, *renderer, a->pixels.data);
  const std::uint32_t frame = a->written++;
  if (a->kind == AnimationKind::gif)
    add_gif_frame(&a->gif, a->pixels.data, centiseconds_of(frame, a->frames_per_second));
  // In hundredths of a frame per second: exact for 29.97.
  const auto rate = static_cast<std::uint16_t>(std::floor(a->frames_per_second * 100 + 0.5));
  if (a->kind == AnimationKind::png) RETURN_IF_ERROR(add_png_frame(&a->png, a->pixels.data, 100, rate));
  if (a->kind == AnimationKind::video &&
      !platform::feed(&a->encoder, a->pixels.data,
                      3 * static_cast<std::size_t>(a->width) * static_cast<std::size_t>(a->height)))
    return encoder_failure(a);
  return success();
}

Status end_animation(AnimationFile* a) {
  CHECK_GT(a->written, 0u);
  if (a->kind == AnimationKind::gif) end_gif(&a->gif);
  if (a->kind == AnimationKind::png) {
    end_animated_png(&a->png);
    std::vector<std::uint8_t> chunk;
    auto append = [](void* user, const void* bytes, std::size_t count) {
      auto* to = static_cast<std::vector<std::uint8_t>*>(user);
      to->insert(to->end(), static_cast<const std::uint8_t*>(bytes), static_cast<const std::uint8_t*>(bytes) + count);
    };
    write_png_frame_count({append, &chunk}, a->written);
    if (a->written < a->frame_count &&
        !platform::rewrite_bytes(&a->writer, kPngFrameCountOffset, chunk.data(), chunk.size()))
      return failure("%.300s got %u of %u frames: only a file can be shortened", a->path.c_str(), a->written,
                     a->frame_count);
  }
  if (a->kind == AnimationKind::video) RETURN_IF_ERROR(fetch_video(a));
  platform::FileError error;
  return platform::close_writer(&a->writer, &error) ? success() : failure("%.300s %s", a->path.c_str(), error.text);
}

}  // namespace pocketray
