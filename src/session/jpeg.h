// JPEG, in builds with the importers, whose library encodes it.
#pragma once
#include "present/image_file.h"

namespace pocketray {

bool has_jpeg();
// width × height pixels of bytes R, G, B, row 0 on top, in a quality that hides the loss, without reduced colour
// resolution. Takes no memory. Only if has_jpeg().
void encode_jpeg(const std::uint8_t* rgb, int width, int height, const ByteSink& sink);

}  // namespace pocketray
