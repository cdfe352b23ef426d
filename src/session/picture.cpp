#include "session/picture.h"

#include <algorithm>
#include <cstring>

#include "base/check.h"
#include "present/image_file.h"
#include "present/png_file.h"
#include "present/repack.h"
#include "session/output.h"

namespace pocketray {
namespace {

enum class Kind { png, ppm, pfm, raw, unknown };

Kind kind_of(const char* path) {
  constexpr struct {
    const char* suffix;
    Kind kind;
  } kSuffixes[] = {{".png", Kind::png}, {".ppm", Kind::ppm}, {".pfm", Kind::pfm}, {".raw", Kind::raw}};
  for (const auto& row : kSuffixes)
    if (has_suffix(path, row.suffix)) return row.kind;
  return Kind::unknown;
}

Status encode(Kind kind, const PictureOptions& o, Renderer* renderer, const ByteSink& sink) {
  CHECK(kind != Kind::unknown);  // check_picture_path() has been asked
  int width = static_cast<int>(renderer->settings.width), height = static_cast<int>(renderer->settings.height);
  const Vec3* radiance = o.radiance ? o.radiance : renderer->image.data;
  CHECK(radiance != nullptr || o.packed != nullptr);
  if (kind == Kind::pfm) {
    encode_pfm(&radiance->x, 3, width, height, sink);
    return success();
  }
  bool raw = kind == Kind::raw,
       turned = raw && (o.rotation == Rotation::quarter || o.rotation == Rotation::three_quarters);
  const PixelFormat& format = raw ? o.raw_format : kRgb888;
  int row_bytes = (turned ? height : width) * format.bits_per_pixel / 8, rows = turned ? width : height;
  auto pixels = arena_array<std::uint8_t>(&renderer->frame_arena,
                                          static_cast<std::size_t>(row_bytes) * static_cast<std::size_t>(rows));
  Rotation rotation = raw ? o.rotation : Rotation::none;
  if (o.packed)
    repack_rows(o.packed_format, o.packed, o.packed_line_bytes, width, height, 0, height, format, rotation, pixels.data,
                row_bytes);
  else
    pack_rows(radiance, width, height, 0, height, renderer->exposure, format, rotation, raw && o.dither, pixels.data,
              row_bytes);
  if (raw) encode_raw(pixels.data, row_bytes, row_bytes, rows, sink);
  if (kind == Kind::ppm) encode_ppm(pixels.data, width, height, sink);
  return kind == Kind::png ? encode_png(pixels.data, width, height, &renderer->frame_arena, sink) : success();
}

}  // namespace

std::size_t picture_bytes(const Settings& settings) {
  std::size_t pixels = static_cast<std::size_t>(settings.width) * settings.height;
  return arena_need(pixels * 4) + encode_png_need(static_cast<int>(settings.width));
}

Status check_picture_path(const std::string& path) {
  if (kind_of(path.c_str()) == Kind::unknown)
    return failure("-o is '%s': the name must end in .png, .ppm, .pfm or .raw", path.c_str());
  return success();
}

Status write_picture(const char* path, const PictureOptions& options, Renderer* renderer) {
  std::size_t mark = arena_mark(renderer->frame_arena);
  Status status =
      write_encoded(path, [&](const ByteSink& sink) { return encode(kind_of(path), options, renderer, sink); });
  arena_release(&renderer->frame_arena, mark);
  return status;
}

}  // namespace pocketray
