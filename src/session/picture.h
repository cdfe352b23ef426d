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
  // Packed already, for all kinds but .pfm: rows of so many bytes. Null: packed from renderer->image.
  const std::uint8_t* packed = nullptr;
  int packed_line_bytes = 0;
  PixelFormat packed_format;
};

// What the frame arena must hold to write any of them.
std::size_t picture_bytes(const Settings& settings);

// Fails unless the path ends in .png, .ppm, .pfm or .raw.
Status check_picture_path(const std::string& path);

// Writes what the options name, else renderer->image. The file is replaced as a whole or not at all.
Status write_picture(const char* path, const PictureOptions& options, Renderer* renderer);

}  // namespace pocketray
