// The text of the overlay.
#pragma once
#include "engine/progressive.h"
#include "present/hud_text.h"
#include "session/camera_control.h"
#include "viewer/motion.h"

namespace pocketray {

// A message shown over the picture for some seconds, or until the next one.
struct HudNote {
  char text[600] = {0};
  std::uint64_t until_ns = 0;  // by the screen's clock
  std::uint32_t number = 0;    // count of notes so far
};

// Milliseconds per frame, nanoseconds per pixel of the picture, rays, memory, savings by coherence, effects on.
void write_hud(const Renderer& renderer, const Progressive& progressive, CameraMode mode, HudText* text);
// Motion to photon, once measured.
void write_latency(const Motion& motion, HudText* text);
void write_waiting(const char* what, double seconds, HudText* text);
}  // namespace pocketray
