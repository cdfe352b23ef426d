// Writes a finished frame as a file: PNG, PPM (displayed levels), PFM or OpenEXR (linear radiance) or the bytes of a
// framebuffer.
#pragma once
#include <string>

#include "engine/renderer.h"
#include "present/changed_pixels.h"
#include "present/false_color.h"
#include "present/pack.h"

namespace pocketray {

struct PictureOptions {
  const char* kind = nullptr;        // ".png": the kind to write, whatever the path's suffix; null: by the suffix
  PixelFormat raw_format = kRgb565;  // for .raw files
  Rotation rotation = Rotation::none;
  bool dither = false;
  PixelBox crop;                   // the pixels to write, unless they are rotated; width 0: all
  const Legend* legend = nullptr;  // drawn at the bottom left, except where stores_values(); null or empty: none
  const Vec3* radiance = nullptr;  // null: renderer->image
  // Rows already packed, packed_line_bytes apart, unless stores_values(). Null: packs renderer->image.
  const std::uint8_t* packed = nullptr;
  int packed_line_bytes = 0;
  PixelFormat packed_format;
};

// Returns the pixels to write of a picture of the settings' size.
PixelBox box_to_write(const PictureOptions& options, const Settings& settings);

// Bytes needed in the frame arena to write any format.
std::size_t picture_bytes(const Settings& settings);

// Fails unless the path ends in .png, .ppm, .pfm, .raw or, if this build has JPEG, .jpg or .jpeg, or is such a suffix.
Status check_picture_path(const std::string& path);
// Returns whether pictures with that name hold linear radiance, or values, instead of displayed levels.
bool stores_values(const std::string& path);

// Returns the options' picture as rows of R, G and B, without padding. `rgb` has room for the whole picture, even if it
// is cropped.
void picture_levels(const PictureOptions& options, const Renderer& renderer, std::uint8_t* rgb);

// Writes the options' picture, otherwise renderer->image. Replaces the file atomically.
Status write_picture(const char* path, const PictureOptions& options, Renderer* renderer);

}  // namespace pocketray
