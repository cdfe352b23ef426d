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
#include "session/quality_dial.h"
#include "session/servers.h"
#include "viewer/hud.h"
#include "viewer/motion.h"
#include "viewer/side_by_side.h"

namespace pocketray {

struct ViewOptions {
  std::string backend = "auto", device, screenshot_folder = ".";
  int rotation = -1, scale = 0;         // degrees clockwise; −1: the device's
  const std::uint16_t* keys = nullptr;  // key codes of the device's buttons; null: a keyboard's
  bool dither = false;
  const platform::Device* emulated = nullptr;  // device whose screen to show, upright; null: the screen's own pixels
  std::uint32_t frame_count = 0;
  bool hud = true;             // shown from the start
  bool has_reference = false;  // the build has --side-by-side
  bool keeps_samples = false;  // a picture at rest is not refined to more
  bool drops_frames = true;    // a stalled split frame is dropped for newer input; false: for comparisons
};

// Watches a file in order to reload it after a change, once writing has ended: when two looks in a row agree.
struct FileWatch {
  std::uint64_t loaded = 0, seen = 0;  // stamps
  std::uint64_t last_look_ns = 0;
};

// The parts of the view that survive a reload of the scene.
struct KeptView {
  char scene_path[1024] = {0};  // the scene it belongs to; empty: nothing kept
  CameraControl control;
  bool camera_moved = false;  // by the user; otherwise shows the scene's own camera, which may have changed
  double seconds = 0;
  std::uint32_t animation = 0;
  int quality_steps = 0;  // as of QualityDial
};

struct Viewer {
  const platform::Backend* backend = nullptr;
  ViewOptions options;
  std::string scene_path;                   // reloaded when this file changes
  Box focus = empty_box();                  // bounds of the part that the camera turns around; empty: the scene
  std::vector<std::string> material_names;  // of the current scene, as far as known
  int width = 0, height = 0;
  Rotation rotation = Rotation::none;
  PixelFormat format;
  Servers* servers = nullptr;          // null: the device renders alone
  Budget* budget = nullptr;            // null: frames are refined, however long they take
  QualityDial* dial = nullptr;         // null: the quality is the budget's, or agreed with servers
  SideBySide* side_by_side = nullptr;  // null: no reference to show
  bool side_by_side_shown = true;      // the user wants to see it
  std::uint64_t pack_ns = 0;           // for the last picture shown
  bool picture_merged = false;         // servers take part in the current picture
  void* page_memory = nullptr;
  FileWatch watch;
  KeptView kept;
  void* picture_memory = nullptr;  // the last picture, in the screen's rows, shown while no scene is loaded
  bool has_picture = false;
  HudNote note;
  char dropped[1024] = {0};  // a file dropped on the window: the scene to show next
  bool held[platform::kButtonCount] = {};
  bool select_alone = false;  // no other button was pressed since select was: its release switches orbit and fly
  bool quit = false, reload = false, screenshot = false, home = false, change_mode = false;  // requested
  int quality_steps = 0;                                                                     // requested
  int side_by_side_presses = 0;                                                              // requested
  bool side_by_side_changed = false;  // side_by_side_shown changed and the screen does not show it yet
  bool front_home = false;            //   returns the choice to the budget
  int traced_presses = 0;             // requested
  int animation_presses = 0;          // requested
  bool hud = true, hud_shown = false, paused = false;
  bool traced = false, traced_shown = false;  // dims reused pixels; the screen does so
  std::uint64_t event_ns = 0;                 // of the last button
  bool pressed = false;                       // one was pressed since the camera last moved,
  std::uint64_t pressed_ns = 0;               //   the first such press
  Motion motion;                              // its way to the screen
  std::uint32_t note_shown = 0,
                hud_rows_shown = 0;  // on the screen: the note's number, and the rows that the overlay covers
  std::uint64_t waiting_since_ns = 0;
  std::uint32_t screenshot_count = 0, frames_finished = 0, frames_dropped = 0;
};

// Bytes needed in the frame arena for viewing: span list and screenshot encoder.
std::size_t viewer_bytes(const Settings& settings);

Status open_viewer(const ViewOptions& options, const char* scene, int width, int height, Viewer* viewer);
// Call before loading the scene, to notice changes from then on.
void watch_scene(Viewer* viewer);
// Shows that a scene is loading, over the last picture if any, and handles events. Returns false if the user quit.
bool show_waiting(Viewer* viewer, const char* text);
// Shows why the scene failed to load, over the last picture, until its file changes, another is dropped or the user
// reloads. Returns false if the user quit.
bool wait_for_another(Viewer* viewer, const char* why);
// Shows a message over the picture and prints it on stderr.
void tell(Viewer* viewer, const char* text);
// Runs until the user quits or options.frame_count frames are finished (*again false), or a reload is due (*again
// true). Continues with the camera and time of viewer->kept if it belongs to this scene; keeps the view and the picture
// for the next run. Allocates nothing, except for the reference.
Status run_viewer(Viewer* viewer, Renderer* renderer, bool* again);
// Safe on a viewer that is closed or was never opened.
void close_viewer(Viewer* viewer);

}  // namespace pocketray
