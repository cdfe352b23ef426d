// The interactive loop between a screen and a renderer.
#pragma once
#include <string>

#include "app/budget.h"
#include "app/camera_control.h"
#include "app/progressive.h"
#include "app/sharing.h"
#include "app/split_screen.h"
#include "base/status.h"
#include "platform/devices/device.h"
#include "platform/platform.h"
#include "present/pack.h"

namespace pocketray {

struct ViewOptions {
  std::string backend = "auto", device, screenshot_folder = ".";
  int rotation = -1, scale = 0;         // degrees clockwise; −1: the device's
  const std::uint16_t* keys = nullptr;  // of the device's buttons; null: a keyboard's
  bool dither = false;
  const platform::Device* emulated = nullptr;  // whose pixels to show, upright; null: the screen's own
  std::uint32_t frame_count = 0;
};

struct Viewer {
  const platform::Backend* backend = nullptr;
  ViewOptions options;
  std::string scene_path;  // reloaded when this file changes
  int width = 0, height = 0;
  Rotation rotation = Rotation::none;
  PixelFormat format;
  Sharing* sharing = nullptr;    // null: the device renders alone
  Budget* budget = nullptr;      // null: frames take what they take, and are refined
  SplitScreen* split = nullptr;  // null: no reference to show
  bool split_shown = true;       // the user wants to see it
  std::uint64_t pack_ns = 0;     // of the last picture shown
  bool picture_shared = false;   // the picture under way, or shown: by servers, too
  void* page_memory = nullptr;
  char dropped[1024] = {0};  // a file dropped on the window: the scene to show next
  bool held[platform::kButtonCount] = {};
  bool quit = false, reload = false, screenshot = false, home = false, change_mode = false;  // asked for
  int front_steps = 0;                                                                       // asked for
  bool split_changed = false;  // split_shown has, and the screen not yet
  bool front_home = false;     //   as the budget has it
  bool hud = true, hud_shown = false, paused = false;
  std::uint64_t waiting_since_ns = 0;
  std::uint32_t screenshot_count = 0, frames_finished = 0;
};

// What the frame arena must hold while viewing: span list and screenshot encoder.
std::size_t viewer_bytes(const Settings& settings);

Status open_viewer(const ViewOptions& options, const char* scene, int width, int height, Viewer* viewer);
// Shows a sign of life while a scene loads, and takes events. False: the user wants to leave.
bool show_waiting(Viewer* viewer, const char* text);
// Runs until the user leaves (*again false), the scene's file changed or is to be reloaded (*again true), or
// options.frame_count frames are finished. Allocates nothing but for the split screen.
Status run_viewer(Viewer* viewer, Renderer* renderer, bool* again);
void close_viewer(Viewer* viewer);

}  // namespace pocketray
