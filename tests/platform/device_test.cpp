#include "platform/devices/device_list.h"

#include <doctest/doctest.h>

#include <cstring>
#include <set>
#include <string>

using namespace platform;

// Goal: the device files are plausible. Method: every entry of the list within bounds for its fields.
TEST_CASE("device_list_has_plausible_and_distinct_entries") {
  std::set<std::string> names;
  for (const Device& device : kDevices) {
    CAPTURE(std::string(device.name));
    names.insert(device.name);
    CHECK(find_device(device.name) == &device);
    CHECK(std::strlen(device.description) > 10);
    bool class_known = false;
    for (const char* cpu_class : {"armv4t", "armel", "armv6", "armv7", "armhf", "aarch64", "mips32", "x86-64"})
      class_known |= !std::strcmp(device.cpu_class, cpu_class);
    CHECK(class_known);
    CHECK(device.screen_width >= 320);
    CHECK(device.screen_height >= 240);
    CHECK((device.bits_per_pixel == 16 || device.bits_per_pixel == 24 || device.bits_per_pixel == 32));
    CHECK((!std::strcmp(device.channel_order, "rgb") || !std::strcmp(device.channel_order, "bgr")));
    CHECK((device.rotation >= 0 && device.rotation < 360 && device.rotation % 90 == 0));
    CHECK((device.memory_bytes >= mebibytes(12) && device.memory_bytes <= mebibytes(512)));
    CHECK((device.core_count >= 0 && device.core_count <= 8));
    CHECK((device.slowdown >= 1 && device.slowdown < 10'000));
    CHECK((device.link_bytes_per_second >= 100'000 && device.link_bytes_per_second <= 125'000'000));
    CHECK((device.link_latency_ns >= 50'000 && device.link_latency_ns <= 50'000'000));
    CHECK(device.link_jitter_ns <= 2 * device.link_latency_ns);
    CHECK((device.decode_pixel_ns >= 1 && device.decode_pixel_ns <= 1000));
    CHECK((device.decode_byte_ns >= 10 * device.decode_pixel_ns && device.decode_byte_ns <= 100'000));
    CHECK((device.prepare_triangle_ns >= 10 && device.prepare_triangle_ns <= 100'000));
    CHECK((device.prepare_vertex_ns >= 10 && device.prepare_vertex_ns <= 100'000));
    CHECK((device.core_watts >= 0.01 && device.core_watts <= 50));
    CHECK((device.byte_nanojoules >= 1 && device.byte_nanojoules <= 10'000));
    std::set<int> keys;
    for (int i = 0; device.keys && i < 12; ++i) keys.insert(device.keys[i]);
    CHECK((!device.keys || keys.size() == 12));
  }
  CHECK(names.size() == kDeviceCount);
  CHECK(find_device("desktop")->slowdown <= 1);  // the others are relative to it
  CHECK(find_device("miyoo-") == nullptr);
  CHECK(find_device("miyoo-mini-plus") == nullptr);
  CHECK(find_device("") == nullptr);
}
