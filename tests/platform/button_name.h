// Names of buttons, for scripts of events as text.
#pragma once
#include "platform/platform.h"

namespace platform {

inline const char* button_name(Button button) {
  static const char* const kNames[kButtonCount] = {"up",    "down",       "left",   "right", "a",      "b",
                                                   "x",     "y",          "l",      "r",     "start",  "select",
                                                   "hud",   "screenshot", "reload", "finer", "faster", "side_by_side",
                                                   "traced"};
  return kNames[static_cast<int>(button)];
}

}  // namespace platform
