#include "desktop/import/webp.h"

#include <algorithm>
#include <cstring>

#include "base/limits.h"
#include "desktop/import/import_error.h"
#ifdef POCKETRAY_HAVE_WEBP
#include <webp/decode.h>
#endif

namespace pocketray {

bool is_webp(const Bytes& bytes) {
  return bytes.size() >= 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
         std::memcmp(bytes.data() + 8, "WEBP", 4) == 0;
}

#ifdef POCKETRAY_HAVE_WEBP

Image decode_webp(const Bytes& bytes, const std::string& name, std::uint64_t texel_count_max) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(bytes.data(), bytes.size(), &features) != VP8_STATUS_OK || features.width < 1 ||
      features.height < 1)
    fail_import("%s is damaged; export it again", name.c_str());
  if (features.has_animation) fail_import("%s is an animated WebP; convert one of its pictures", name.c_str());
  Image image;
  image.width = static_cast<std::uint32_t>(features.width), image.height = static_cast<std::uint32_t>(features.height);
  const std::uint64_t count = std::uint64_t(image.width) * image.height;
  if (image.width > kTextureSideMax || image.height > kTextureSideMax || count > texel_count_max)
    fail_import("%s is too large; scale it down", name.c_str());
  // A picture of a single colour takes a few bytes at any size: small ones are accepted.
  constexpr std::uint64_t kAnyFileMax = 1u << 20, kBytePixelsMax = 1u << 13;
  if (count > std::max(kAnyFileMax, kBytePixelsMax * bytes.size()))
    fail_import("%s has %d × %d pixels, more than its %zu bytes are worth; export it as PNG", name.c_str(),
                features.width, features.height, bytes.size());
  image.texels.resize(static_cast<std::size_t>(count));
  if (!WebPDecodeRGBAInto(bytes.data(), bytes.size(), reinterpret_cast<std::uint8_t*>(image.texels.data()),
                          image.texels.size() * 4, features.width * 4))
    fail_import("%s cannot be decoded; export it again", name.c_str());
  return image;
}

#else

Image decode_webp(const Bytes&, const std::string& name, std::uint64_t) {
  fail_import("%s is WebP, which this build does not read; convert it to PNG, or build with libwebp", name.c_str());
}

#endif

}  // namespace pocketray
