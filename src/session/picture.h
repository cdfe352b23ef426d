// A finished frame as a file: PNG, PPM (displayed levels), PFM (linear radiance) or the bytes a framebuffer would hold.
#pragma once
#include <string>

#include "engine/renderer.h"
#include "present/pack.h"

namespace pocketray {

struct PictureOptions {
  PixelFormat raw_format = kRgb565;  // of .raw files
  Rotation rotation = Rotation::none;
  bool dither = false;
  const Vec3* radiance = nullptr;  // null: renderer->image
  // Rows already packed, packed_line_bytes apart, for all kinds but .pfm. Null: packs renderer->image.
  const std::uint8_t* packed = nullptr;
  int packed_line_bytes = 0;
  PixelFormat packed_format;
};

// Bytes needed in the frame arena to write any format.
std::size_t picture_bytes(const Settings& settings);

// Fails unless the path ends in .png, .ppm, .pfm or .raw.
Status check_picture_path(const std::string& path);

// Writes the picture in the options, else renderer->image. Replaces the file atomically.
Status write_picture(const char* path, const PictureOptions& options, Renderer* renderer);

}  // namespace pocketray
