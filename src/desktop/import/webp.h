// WebP images, by libwebp where the build has it.
#pragma once
#include "desktop/import/image.h"

namespace pocketray {

bool is_webp(const Bytes& bytes);
// Throws ImportError if the image is damaged, has more than `texel_count_max` texels, or cannot be read by this
// build.
Image decode_webp(const Bytes& bytes, const std::string& name, std::uint64_t texel_count_max);

}  // namespace pocketray
