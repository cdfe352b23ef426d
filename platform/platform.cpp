#include "platform/platform.h"

#include <cstring>

#include "platform/null/null.h"

namespace platform {

const Backend* const kBackends[] = {
    &kNullBackend,
};
const int kBackendCount = sizeof kBackends / sizeof kBackends[0];

const Backend* platform_find(const char* name) {
  for (const Backend* backend : kBackends)
    if (std::strcmp(backend->name, name) == 0) return backend;
  return nullptr;
}

const Backend* platform_default() {
  for (const Backend* backend : kBackends)
    if (backend->usable()) return backend;
  return &kNullBackend;
}

const char* button_name(Button button) {
  static const char* const kNames[kButtonCount] = {"up", "down", "left",  "right",  "a",   "b",          "x",     "y",
                                                   "l",  "r",    "start", "select", "hud", "screenshot", "reload"};
  return kNames[static_cast<int>(button)];
}

}  // namespace platform
