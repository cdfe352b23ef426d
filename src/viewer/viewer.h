// The interactive loop between a screen and a renderer.
#pragma once
#include <string>

#include "base/status.h"
#include "budget/budget.h"
#include "engine/progressive.h"
#include "platform/devices/device.h"
#include "platform/platform.h"
#include "present/pack.h"
#include "session/camera_control.h"
#include "session/open_scene.h"
#include "session/servers.h"
#include "viewer/hud.h"
#include "viewer/side_by_side.h"

namespace pocketray {

struct ViewOptions {
  std::string backend = "auto", device, screenshot_folder = ".";
  int rotation = -1, scale = 0;         // degrees clockwise; −1: the device's
  const std::uint16_t* keys = nullptr;  // of the device's buttons; null: a keyboard's
  bool dither = false;
  const platform::Device* emulated = nullptr;  // whose pixels to show, upright; null: the screen's own
  std::uint32_t frame_count = 0;
  bool has_reference = false;  // the build has it: side_by_side can be asked for
};

// A file that is loaded anew when it has changed, and nobody is writing it any more: it looks the same twice in a row.
struct FileWatch {
  std::uint64_t loaded = 0, seen = 0;  // stamps
  std::uint64_t last_look_ns = 0;
};

// What stays of the view when the scene is loaded anew.
struct KeptView {
  char scene_path[1024] = {0};  // of which scene; empty: nothing was kept
  CameraControl control;
  bool camera_moved = false;  // by the user; else the scene's own camera is shown, which may be another one now
  double seconds = 0;
};

struct Viewer {
  const platform::Backend* backend = nullptr;
  ViewOptions options;
  std::string scene_path;  // loaded anew when this file changes
  int width = 0, height = 0;
  Rotation rotation = Rotation::none;
  PixelFormat format;
  Servers* servers = nullptr;          // null: the device renders alone
  Budget* budget = nullptr;            // null: frames take what they take, and are refined
  SideBySide* side_by_side = nullptr;  // null: no reference to show
  bool side_by_side_shown = true;      // the user wants to see it
  std::uint64_t pack_ns = 0;           // of the last picture shown
  bool picture_merged = false;         // the picture under way, or shown: by servers, too
  void* page_memory = nullptr;
  FileWatch watch;
  KeptView kept;
  void* picture_memory = nullptr;  // the last picture, rows as the screen has them, shown while there is no scene
  bool has_picture = false;
  HudNote note;
  char dropped[1024] = {0};  // a file dropped on the window: the scene to show next
  bool held[platform::kButtonCount] = {};
  bool quit = false, reload = false, screenshot = false, home = false, change_mode = false;  // asked for
  int front_steps = 0;                                                                       // asked for
  int side_by_side_presses = 0;                                                              // asked for
  bool side_by_side_changed = false;  // side_by_side_shown has, and the screen not yet
  bool front_home = false;            //   as the budget has it
  bool hud = true, hud_shown = false, paused = false;
  std::uint32_t note_shown = 0, hud_rows_shown = 0;  // on the screen: the note's number, and what the text covers
  std::uint64_t waiting_since_ns = 0;
  std::uint32_t screenshot_count = 0, frames_finished = 0;
};

// What the frame arena must hold while viewing: span list and screenshot encoder.
std::size_t viewer_bytes(const Settings& settings);

Status open_viewer(const ViewOptions& options, const char* scene, int width, int height, Viewer* viewer);
// To be called before the scene is loaded: changes from now on are noticed.
void watch_scene(Viewer* viewer);
// Shows a sign of life while a scene loads, over the last picture where there is one, and takes events. False: the user
// wants to leave.
bool show_waiting(Viewer* viewer, const char* text);
// The scene cannot be loaded: shows why, over the last picture, until its file changes, another is dropped or the user
// asks to try again. False: the user wants to leave.
bool wait_for_another(Viewer* viewer, const char* why);
// Tells the user something, over the picture and in a line of standard error.
void tell(Viewer* viewer, const char* text);
// Runs until the user leaves (*again false), the scene is to be loaded anew (*again true), or options.frame_count
// frames are finished. Camera and time go on from viewer->kept where that is of this scene; the view and the picture
// are kept for the next one. Allocates nothing but for the reference side by side.
Status run_viewer(Viewer* viewer, Renderer* renderer, bool* again);
// Of one that is closed, or that was never opened, too.
void close_viewer(Viewer* viewer);

}  // namespace pocketray
