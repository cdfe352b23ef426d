// Command-line options for a scene and its rendering, as text, and their parsing.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "accel/accel_list.h"
#include "base/isa.h"
#include "effect/setting_list.h"
#include "engine/renderer.h"
#include "platform/devices/device_list.h"
#include "scene/scene.h"
#include "session/output.h"
#include "session/source.h"

namespace pocketray {

// Value of a setting's option, in the member for the setting's kind.
struct SettingOption {
  std::uint32_t count = 0;
  float real = 0;
  std::string choice;
  std::function<bool()> given;  // on the command line; null: if it differs from the default
};
// One per row of setting_list.h, initially the defaults.
struct SettingOptions {
  SettingOption options[kSettingCount];
  SettingOptions();
  SettingOption& operator[](const char* name);  // by name, which must exist
};

// For --environment: removes the scene's environment.
constexpr const char* kNoEnvironment = "none";

// Size of the memory block unless it is given. Desktops, which read models, have room for their textures.
#ifdef POCKETRAY_HAVE_IMPORT
constexpr std::size_t kMemoryUsual = std::size_t(256) << 20;
#else
constexpr std::size_t kMemoryUsual = std::size_t(64) << 20;
#endif

struct CommonOptions {
  std::string scene;
  std::string size, memory, effects = "auto", camera, exposure, tone = "clip", json, device, emulate, isa,
                            accel = "auto";
  std::string background, light = "key", fov;  // empty: the scene's
  std::string environment;                     // import/environment.h; empty: the scene's
  std::string focus;                           // a part of the model; empty: all of it
  std::string animation;                       // animation_choice.h; empty: the default
  ReadingChoice reading;
  std::uint32_t threads = 0, camera_index = 0;
  std::uint32_t texture_side_max = kTextureSideMax;
  // Files that the command writes besides --json. None may replace a file that the scene is read from.
  std::vector<NamedFile> outputs;
  std::string output_folder;
  SettingOptions settings;
  std::string quality;  // a level of plan/quality_level.h; empty: medium, without looking for a measured front
  std::string coherence = "off";
  std::uint32_t coherence_table = Settings().coherence_table;
};

// Returns the largest block to take from a system with that many free bytes: leaves it an eighth and at least 4 MiB; 0:
// unknown.
std::size_t memory_to_take(std::size_t free_bytes);
// Parses the options into settings. Memory is that of --memory, otherwise the device's, or 64 MiB if the system has it.
Status read_settings(const CommonOptions& options, Settings* settings);
// Picture size: --size, otherwise the emulated device's screen as held, otherwise 320 × 240.
Status picture_size(const CommonOptions& options, std::uint32_t* width, std::uint32_t* height);
// Finds the profile named by --device or --emulate; succeeds with null if neither is given.
Status find_device(const CommonOptions& options, const platform::Device** device);

// Number of tracing threads: `asked`, or one per core if that is 0. Fails if it exceeds kThreadCountMax.
Status choose_thread_count(std::uint32_t asked, unsigned core_count, std::uint32_t* count);

// Parses --isa; empty: the CPU's best.
Status parse_coherence(const std::string& text, CoherenceMode* mode);  // on, off or auto
Status parse_isa(const std::string& text, Isa* isa);
// Finds an accelerator by name; null for "auto".
const AccelInfo* find_accel(const std::string& name);
// "WIDTHxHEIGHT"; "24M", "512K", "1G" or bytes; "ex,ey,ez tx,ty,tz ux,uy,uz VFOV" (degrees).
Status parse_size(const std::string& text, std::uint32_t* width, std::uint32_t* height);
Status parse_bytes(const std::string& text, std::size_t* bytes, const char* option = "--memory");
// `origin`: the scene's origin in the coordinates of the text.
Status parse_camera(const std::string& text, Camera* camera, const SceneOrigin& origin = {0, 0, 0});
// Parses --background, --light and --fov.
Status parse_look(const CommonOptions& options, Look* look);
enum class ExposureChoice { as_scene, measured, fixed };
// Parses --exposure: whether to measure it (as the scene asks, always or never), and the factor on that exposure.
Status parse_exposure(const std::string& text, ExposureChoice* choice, float* factor);
}  // namespace pocketray
