// All devices. A new one is a file in this folder and a line here.
#pragma once
#include "platform/devices/desktop.h"
#include "platform/devices/gp2x.h"
#include "platform/devices/miyoo.h"
#include "platform/devices/miyoo_mini.h"
#include "platform/devices/pi_zero.h"
#include "platform/devices/rg350.h"
#include "platform/devices/tablet.h"

namespace platform {

constexpr Device kDevices[] = {kGp2x, kMiyoo, kMiyooMini, kPiZero, kRg350, kTablet, kDesktop};
constexpr int kDeviceCount = sizeof kDevices / sizeof kDevices[0];

// Returns the device of that name, or null.
inline const Device* find_device(const char* name) {
  for (const Device& device : kDevices) {
    const char *a = device.name, *b = name;
    while (*a && *a == *b) ++a, ++b;
    if (*a == *b) return &device;
  }
  return nullptr;
}

}  // namespace platform
