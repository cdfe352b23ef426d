#include "platform/platform.h"

#include <cstring>

#include "platform/check.h"
#include "platform/null/null.h"
#if defined(POCKETRAY_HAVE_SDL2)
#include "platform/sdl2/sdl2.h"
#endif
#if defined(__linux__)
#include "platform/linux/linux.h"
#endif

namespace platform {

const Backend* const kBackends[] = {
#if defined(POCKETRAY_HAVE_SDL2)
    &kSdl2Backend,
#endif
#if defined(__linux__)
    &kLinuxBackend,
#endif
    &kNullBackend,
};
const int kBackendCount = sizeof kBackends / sizeof kBackends[0];

const Backend* platform_find(const char* name) {
  PLATFORM_CHECK(name != nullptr);
  for (const Backend* backend : kBackends)
    if (std::strcmp(backend->name, name) == 0) return backend;
  return nullptr;
}

ScreenFormat screen_format(int width, int height, int bits_per_pixel, bool blue_first) {
  PLATFORM_CHECK(width > 0 && height > 0);
  ScreenFormat format = {width, height, 32, {16, 8}, {8, 8}, {0, 8}, {}};
  if (bits_per_pixel == 16) format = {width, height, 16, {11, 5}, {5, 6}, {0, 5}, {}};
  if (!blue_first) return format;
  Channel red = format.red;
  format.red = format.blue;
  format.blue = red;
  return format;
}

}  // namespace platform
