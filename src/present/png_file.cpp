#include "present/png_file.h"

#include "base/check.h"
#include "present/png_stream.h"

namespace pocketray {

std::size_t encode_png_need(int width) { return png_pixels_need(width); }

Status encode_png(const std::uint8_t* rgb, int width, int height, Arena* arena, const ByteSink& sink) {
  CHECK(rgb != nullptr && arena != nullptr && sink.write != nullptr);
  CHECK(width > 0 && height > 0);
  write_png_head(sink, width, height);
  RETURN_IF_ERROR(
      write_png_pixels(sink, rgb, 3 * static_cast<std::size_t>(width), {0, 0, width, height}, nullptr, arena));
  write_png_chunk(sink, "IEND", nullptr, 0);
  return success();
}

std::size_t animated_png_need(int width, int height) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  return size_sum(arena_need(3 * pixels), png_pixels_need(width));
}

void write_png_frame_count(const ByteSink& sink, std::uint32_t frame_count) {
  CHECK_GT(frame_count, 0u);
  std::uint8_t control[8] = {};  // loops forever
  put_big_endian(frame_count, control);
  write_png_chunk(sink, "acTL", control, sizeof control);
}

AnimatedPng begin_animated_png(const ByteSink& sink, int width, int height, std::uint32_t frame_count, Arena* arena) {
  CHECK(sink.write != nullptr && arena != nullptr);
  CHECK(width > 0 && height > 0 && frame_count > 0);
  AnimatedPng png;
  png.sink = sink, png.arena = arena, png.width = width, png.height = height, png.frames_left = frame_count;
  png.last = arena_array<std::uint8_t>(arena, 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  write_png_head(sink, width, height);
  write_png_frame_count(sink, frame_count);
  return png;
}

Status add_png_frame(AnimatedPng* png, const std::uint8_t* rgb, std::uint16_t delay, std::uint16_t delay_unit) {
  CHECK(png->last.data != nullptr && rgb != nullptr);
  CHECK(png->frames_left > 0 && delay_unit > 0);
  PixelBox box = {0, 0, png->width, png->height};
  if (png->has_frame) box = find_changed(png->last.data, rgb, png->width, png->height);
  if (box.width == 0) box.width = box.height = 1;
  std::uint8_t control[26] = {};  // keep the frame, and replace what it covers
  put_big_endian(png->sequence++, control);
  put_big_endian(static_cast<std::uint32_t>(box.width), control + 4);
  put_big_endian(static_cast<std::uint32_t>(box.height), control + 8);
  put_big_endian(static_cast<std::uint32_t>(box.left), control + 12);
  put_big_endian(static_cast<std::uint32_t>(box.top), control + 16);
  put_big_endian(std::uint32_t(delay) << 16 | delay_unit, control + 20);
  write_png_chunk(png->sink, "fcTL", control, sizeof control);
  RETURN_IF_ERROR(write_png_pixels(png->sink, rgb, 3 * static_cast<std::size_t>(png->width), box,
                                   png->has_frame ? &png->sequence : nullptr, png->arena));
  __builtin_memcpy(png->last.data, rgb, png->last.count);
  png->has_frame = true;
  --png->frames_left;
  return success();
}

void end_animated_png(AnimatedPng* png) {
  CHECK(png->has_frame);
  write_png_chunk(png->sink, "IEND", nullptr, 0);
}

}  // namespace pocketray
