// What a command line says of a scene and how to render it, as text, and what it means.
#pragma once
#include <string>

#include "accel/accel_list.h"
#include "base/isa.h"
#include "effect/setting_list.h"
#include "platform/devices/device_list.h"
#include "scene/scene.h"

namespace pocketray {

// What an option of setting_list.h says, in the member of the setting's kind.
struct SettingOption {
  std::uint32_t count = 0;
  float real = 0;
  std::string choice;
};
// One for each row, the defaults at first.
struct SettingOptions {
  SettingOption options[kSettingCount];
  SettingOptions();
  SettingOption& operator[](const char* name);  // of the row of that name, which there must be
};

struct CommonOptions {
  std::string scene;
  std::string size, memory, effects = "auto", camera, exposure, json, device, emulate, isa, accel = "auto";
  std::uint32_t threads = 0, camera_index = 0;
  SettingOptions settings;
};

// The settings that the options ask for.
Status read_settings(const CommonOptions& options, Settings* settings);
// The picture's size: what --size says, else the screen of the emulated device as one holds it, else 320 × 240.
Status picture_size(const CommonOptions& options, std::uint32_t* width, std::uint32_t* height);
// The profile --device or --emulate names; null with success() where none was named.
Status find_device(const CommonOptions& options, const platform::Device** device);

// Threads to trace with: as many as are asked for, 0: one for each of so many cores.
std::uint32_t choose_thread_count(std::uint32_t asked, unsigned core_count);

// The instruction set --isa names, the best of this CPU where it names none.
Status parse_isa(const std::string& text, Isa* isa);
// The accelerator of that name; null for "auto".
const AccelInfo* find_accel(const std::string& name);
// "WIDTHxHEIGHT"; "24M", "512K", "1G" or bytes; "ex,ey,ez tx,ty,tz ux,uy,uz VFOV" (degrees).
Status parse_size(const std::string& text, std::uint32_t* width, std::uint32_t* height);
Status parse_bytes(const std::string& text, std::size_t* bytes, const char* option = "--memory");
Status parse_camera(const std::string& text, Camera* camera);
// What --exposure says: whether it is to be measured, and by what factor it differs from the scene's or measured one.
Status parse_exposure(const std::string& text, bool* measured, float* factor);
}  // namespace pocketray
