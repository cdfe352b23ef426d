// What the viewer does between two looks at the buttons: makes the next part of a picture, by whoever is to make it,
// and shows it.
#pragma once
#include "viewer/hud.h"
#include "viewer/viewer.h"

namespace pocketray {

struct ViewerLoop {
  CameraControl control;
  Progressive progressive;
  Array<Span> row_spans;
  HudText hud;
  double seconds = 0;                 // of the animation
  bool camera_moved = false;          // by the user, since the scene's own was shown
  bool moved = false, passed = true;  // the camera has moved, time has passed: another picture is due
  bool finished = false;
  // With a budget, since camera or time moved: frames, and of these the last ones in a row with one choice of settings.
  std::uint32_t still_frames = 0, steady_frames = 0;
  bool settled = true;
  std::uint64_t last_ns = 0;
};

inline bool quarter_turned(const Viewer& viewer) {
  return viewer.rotation == Rotation::quarter || viewer.rotation == Rotation::three_quarters;
}
inline int screen_width(const Viewer& viewer) { return quarter_turned(viewer) ? viewer.height : viewer.width; }
inline int screen_height(const Viewer& viewer) { return quarter_turned(viewer) ? viewer.width : viewer.height; }

// The reference is on the screen, too.
inline bool shows_side_by_side(const Viewer& viewer) { return viewer.side_by_side && viewer.side_by_side_shown; }

// A window system takes memory when it likes; the seal is lifted while it is called. Screens of devices are not spared.
bool takes_memory(const platform::Backend& screen);

// The number of the note to be shown now; 0: none.
inline std::uint32_t note_now(const Viewer& viewer) {
  return viewer.backend->now_ns() < viewer.note.until_ns ? viewer.note.number : 0;
}

// Packs rows of the picture as it is, radiance or what servers sent, for the screen.
void pack_picture(const Viewer& viewer, const Renderer& renderer, const Vec3* radiance, int row_begin, int row_end,
                  const platform::Page& page);

// One step: a slice of a picture that is refined or that servers share, a whole one within a budget, a slice of the
// reference beside it, or a moment's sleep. Camera and time stand as the loop has them.
Status step_viewer(Viewer* viewer, Renderer* renderer, ViewerLoop* loop);

}  // namespace pocketray
