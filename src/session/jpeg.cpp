#include "session/jpeg.h"

#include "base/check.h"

#ifdef POCKETRAY_HAVE_JPEG
#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>
#endif

namespace pocketray {

#ifdef POCKETRAY_HAVE_JPEG
bool has_jpeg() { return true; }

void encode_jpeg(const std::uint8_t* rgb, int width, int height, const ByteSink& sink) {
  constexpr int kQuality =
      95;  // chosen: above 90, stb_image_write keeps the full colour resolution; 100 gives larger files
  CHECK(rgb != nullptr && sink.write != nullptr);
  CHECK(width > 0 && height > 0);
  auto write = [](void* context, void* bytes, int count) {
    const ByteSink& to = *static_cast<const ByteSink*>(context);
    to.write(to.user, bytes, static_cast<std::size_t>(count));
  };
  ByteSink to = sink;
  CHECK(stbi_write_jpg_to_func(write, &to, width, height, 3, rgb, kQuality) != 0);
}
#else
bool has_jpeg() { return false; }
void encode_jpeg(const std::uint8_t*, int, int, const ByteSink&) { CHECK(has_jpeg()); }
#endif

}  // namespace pocketray
