// JPEG, in builds with the importers, whose library encodes it.
#pragma once
#include "present/image_file.h"

namespace pocketray {

bool has_jpeg();
// Encodes width × height pixels of bytes R, G, B, row 0 on top, visually lossless and with full colour resolution.
// Allocates nothing. Only if has_jpeg().
void encode_jpeg(const std::uint8_t* rgb, int width, int height, const ByteSink& sink);

}  // namespace pocketray
