// One step of the viewer between two polls of the buttons: renders the next part of a picture, locally or with servers,
// and shows it.
#pragma once
#include "engine/frame.h"
#include "viewer/hud.h"
#include "viewer/viewer.h"

namespace pocketray {

struct ViewerLoop {
  CameraControl control;
  Progressive progressive;
  Array<Span> tile_spans;
  HudText hud;
  double seconds = 0;                 // animation time
  bool camera_moved = false;          // by the user, since the scene's own camera was shown
  bool moved = false, passed = true;  // camera or time has changed: a new picture is due
  bool finished = false;
  std::uint64_t coarse_ns = 0;  // time until the last picture was visible
  bool dropped = false;         // the last split picture was dropped for a newer one before it was visible
  bool coarse_shown = false;    // the screen shows the current split picture, coarse
  bool moving = false;          // a button moves the camera
  // With a budget: frames since camera or time moved, and how many of the latest had equal settings.
  std::uint32_t still_frames = 0, steady_frames = 0;
  bool settled = true;
  // A picture with few samples or interpolated pixels is traced exactly once it rests.
  bool refines = false;  // in progress; the next picture uses `quality`
  Quality quality;
  bool exact = false;         // the resting picture has been refined
  std::uint64_t last_ns = 0;  // when camera and time last advanced; 0: not yet
};

inline bool quarter_turned(const Viewer& viewer) {
  return viewer.rotation == Rotation::quarter || viewer.rotation == Rotation::three_quarters;
}
inline int screen_width(const Viewer& viewer) { return quarter_turned(viewer) ? viewer.height : viewer.width; }
inline int screen_height(const Viewer& viewer) { return quarter_turned(viewer) ? viewer.width : viewer.height; }

// True if the reference is on the screen.
inline bool shows_side_by_side(const Viewer& viewer) { return viewer.side_by_side && viewer.side_by_side_shown; }

// Window systems allocate at any time, so the seal is lifted during their calls. Device screens must not allocate.
bool takes_memory(const platform::Backend& screen);

// Number of the note to show now; 0: none.
inline std::uint32_t note_now(const Viewer& viewer) {
  return viewer.backend->now_ns() < viewer.note.until_ns ? viewer.note.number : 0;
}

// Packs rows of the current picture, from radiance or from servers, for the screen.
void pack_picture(const Viewer& viewer, const Renderer& renderer, const Vec3* radiance, int row_begin, int row_end,
                  const platform::Page& page);

// Returns to the former quality for a new picture, if one is being refined.
Status end_refining(Renderer* renderer, ViewerLoop* loop);

// One step: a slice of a refined or split picture, a whole one within a budget, a slice of the reference, or a short
// sleep. Uses the loop's camera and time.
Status step_viewer(Viewer* viewer, Renderer* renderer, ViewerLoop* loop);

}  // namespace pocketray
