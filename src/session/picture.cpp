#include "session/picture.h"

#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "present/image_file.h"
#include "present/png_file.h"
#include "present/repack.h"
#include "session/exr.h"
#include "session/jpeg.h"
#include "session/output.h"

namespace pocketray {
namespace {

enum class Kind { png, ppm, pfm, exr, raw, jpeg, unknown };

Kind kind_of(const char* path) {
  constexpr struct {
    const char* suffix;
    Kind kind;
  } kSuffixes[] = {{".png", Kind::png}, {".ppm", Kind::ppm},  {".pfm", Kind::pfm},  {".exr", Kind::exr},
                   {".raw", Kind::raw}, {".jpg", Kind::jpeg}, {".jpeg", Kind::jpeg}};
  for (const auto& row : kSuffixes)
    if (has_suffix(path, row.suffix) || std::strcmp(path, row.suffix) == 0) return row.kind;
  return Kind::unknown;
}

const Vec3* radiance_of(const PictureOptions& o, const Renderer& renderer) {
  return o.radiance ? o.radiance : renderer.image.data;
}

// Moves the pixels of the box to the front, without padding.
void crop_rows(const PixelBox& box, std::size_t pixel_bytes, std::size_t row_bytes, std::uint8_t* pixels) {
  const std::size_t count = pixel_bytes * static_cast<std::size_t>(box.width);
  const std::uint8_t* from =
      pixels + static_cast<std::size_t>(box.top) * row_bytes + pixel_bytes * static_cast<std::size_t>(box.left);
  CHECK_LE(count, row_bytes);
  for (int y = 0; y < box.height; ++y)
    std::memmove(pixels + static_cast<std::size_t>(y) * count, from + static_cast<std::size_t>(y) * row_bytes, count);
}

// Packs rows of the whole picture, skips those outside the box, then crops to the box.
void pack(const PictureOptions& o, const Renderer& renderer, const PixelFormat& format, Rotation rotation, bool dither,
          std::uint8_t* pixels, int row_bytes) {
  const int width = static_cast<int>(renderer.settings.width), height = static_cast<int>(renderer.settings.height);
  const PixelBox box = box_to_write(o, renderer.settings);
  const int end = box.top + box.height;
  CHECK(rotation == Rotation::none || o.crop.width == 0);
  CHECK(o.packed != nullptr || radiance_of(o, renderer) != nullptr);
  if (o.packed)
    repack_rows(o.packed_format, o.packed, o.packed_line_bytes, width, height, box.top, end, format, rotation, pixels,
                row_bytes);
  else
    pack_rows(radiance_of(o, renderer), width, height, box.top, end, display_of(renderer), format, rotation, dither,
              pixels, row_bytes);
  if (o.legend && o.legend->text[0])
    draw_legend({pixels, row_bytes, format, width, height, rotation}, box.left, end - kLegendHeight, *o.legend);
  if (o.crop.width > 0)
    crop_rows(box, static_cast<std::size_t>(format.bits_per_pixel / 8), static_cast<std::size_t>(row_bytes), pixels);
}

Status encode(Kind kind, const PictureOptions& o, Renderer* renderer, const ByteSink& sink) {
  CHECK(kind != Kind::unknown);  // check_picture_path() was called
  int width = static_cast<int>(renderer->settings.width), height = static_cast<int>(renderer->settings.height);
  const PixelBox box = box_to_write(o, renderer->settings);
  if (kind == Kind::pfm || kind == Kind::exr) {
    const Vec3* radiance = radiance_of(o, *renderer);
    CHECK(radiance != nullptr);
    const std::size_t line_values = 3 * std::size_t(renderer->settings.width);
    const float* first =
        &radiance[static_cast<std::size_t>(box.top) * renderer->settings.width + static_cast<std::size_t>(box.left)].x;
    if (kind == Kind::exr) return encode_exr(first, box.width, box.height, line_values, sink);
    encode_pfm(first, 3, box.width, box.height, sink, line_values);
    return success();
  }
  bool raw = kind == Kind::raw,
       turned = raw && (o.rotation == Rotation::quarter || o.rotation == Rotation::three_quarters);
  const PixelFormat& format = raw ? o.raw_format : kRgb888;
  int row_bytes = (turned ? height : width) * format.bits_per_pixel / 8, rows = turned ? width : height;
  auto pixels = arena_array<std::uint8_t>(&renderer->memory.frame,
                                          static_cast<std::size_t>(row_bytes) * static_cast<std::size_t>(rows));
  Rotation rotation = raw ? o.rotation : Rotation::none;
  pack(o, *renderer, format, rotation, raw && o.dither, pixels.data, row_bytes);
  if (o.crop.width > 0) row_bytes = box.width * format.bits_per_pixel / 8, rows = box.height;
  if (raw) encode_raw(pixels.data, row_bytes, row_bytes, rows, sink);
  if (kind == Kind::ppm) encode_ppm(pixels.data, box.width, box.height, sink);
  if (kind == Kind::jpeg) encode_jpeg(pixels.data, box.width, box.height, sink);
  return kind == Kind::png ? encode_png(pixels.data, box.width, box.height, &renderer->memory.frame, sink) : success();
}

}  // namespace

PixelBox box_to_write(const PictureOptions& o, const Settings& settings) {
  const int width = static_cast<int>(settings.width), height = static_cast<int>(settings.height);
  if (o.crop.width == 0) return {0, 0, width, height};
  CHECK(o.crop.left >= 0 && o.crop.top >= 0 && o.crop.height > 0);
  CHECK(o.crop.left + o.crop.width <= width && o.crop.top + o.crop.height <= height);
  return o.crop;
}

std::size_t picture_bytes(const Settings& settings) {
  std::size_t pixels = static_cast<std::size_t>(settings.width) * settings.height;
  return arena_need(pixels * 4) + encode_png_need(static_cast<int>(settings.width));
}

void picture_levels(const PictureOptions& options, const Renderer& renderer, std::uint8_t* rgb) {
  pack(options, renderer, kRgb888, Rotation::none, false, rgb, static_cast<int>(3 * renderer.settings.width));
}

Status check_picture_path(const std::string& path) {
  const Kind kind = kind_of(path.c_str());
  if (kind == Kind::unknown)
    return failure(
        "-o is '%.200s': the name must end in .png, %s.ppm, .pfm, %s.raw, or .gif, .apng or .mp4 for animations",
        path.c_str(), has_jpeg() ? ".jpg, " : "", has_exr() ? ".exr or " : "or ");
  if (kind == Kind::jpeg && !has_jpeg())
    return failure(
        "-o is '%.200s', but this build has no JPEG support: write .png, or build with stb and the importers",
        path.c_str());
  if (kind == Kind::exr && !has_exr())
    return failure(
        "-o is '%.200s', but this build has no OpenEXR support: write .pfm, or build with OpenEXR 3.1 or later",
        path.c_str());
  return success();
}

bool stores_values(const std::string& path) {
  const Kind kind = kind_of(path.c_str());
  return kind == Kind::pfm || kind == Kind::exr;
}

Status write_picture(const char* path, const PictureOptions& options, Renderer* renderer) {
  std::size_t mark = arena_mark(renderer->memory.frame);
  Status status = write_encoded(path, [&](const ByteSink& sink) {
    return encode(kind_of(options.kind ? options.kind : path), options, renderer, sink);
  });
  arena_release(&renderer->memory.frame, mark);
  return status;
}

}  // namespace pocketray
