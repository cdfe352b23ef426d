// Options whose help is generated from a list.
#include "app/options.h"

#include <doctest/doctest.h>

#include "support/help_entry.h"

using namespace pocketray;

// Goal: help lists every valid name. Method: every device, and every accelerator with its description, in the help of
// its option; the automatic ones in order, the default first.
TEST_CASE("options_list_devices_and_accelerators") {
  CommandLine line("program", "");
  CommonOptions options;
  add_scene_options(line.program(), &options);
  const std::string devices = help_entry(&line, "--device");
  for (const platform::Device& device : platform::kDevices) {
    CAPTURE(device.name);
    CHECK(devices.find(device.name) != std::string::npos);
  }
  const std::string accels = help_entry(&line, "--accel");
  std::size_t place = accels.find("auto: the one");
  REQUIRE(place != std::string::npos);
  for (const AccelInfo* info : kAccelList) {
    CAPTURE(info->name);
    CHECK(accels.find(std::string(" ") + info->name) != std::string::npos);
    CHECK(accels.find(info->help) < place);
    if (!info->is_automatic) continue;
    std::size_t next = accels.find(info->name, place);
    CHECK(next != std::string::npos);
    place = next;
  }
  CHECK(kAccelList[0]->is_automatic);
}
