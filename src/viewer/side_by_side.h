// Side by side, for the emulator: the picture on the left half, the reference on the right, refined while nothing
// changes. Takes its own memory before the seal. viewer/reference has the backend; device builds have none.
#pragma once
#include <string>

#include "engine/renderer.h"
#include "present/hud_text.h"

namespace pocketray {

struct SideBySideOptions {
  std::string reference;  // "model" or "physical"; empty: none
};

struct SideBySideBackend;
struct SideBySide {
  const SideBySideBackend* backend;
};

struct SideBySideBackend {
  // Call with the scene open. Judges the picture as displayed with `bits_per_pixel`.
  SideBySide* (*open)(const SideBySideOptions& options, const Renderer& renderer, int bits_per_pixel, bool dither);
  void (*close)(SideBySide* side_by_side);
  // Call with a finished picture: traces the reference for this view and time until about `deadline_ns` of clock_ns(),
  // restarting if view or time differ from the last call's. `picture` numbers the pictures. Settings stay; the renderer
  // must prepare its next frame. Fails as begin_frame() does.
  Status (*advance)(SideBySide* side_by_side, Renderer* renderer, double seconds, std::uint32_t picture,
                    std::uint64_t deadline_ns);
  // Discards the samples; call before view or time change.
  void (*forget)(SideBySide* side_by_side);
  // True once nothing is left to refine.
  bool (*is_full)(const SideBySide& side_by_side);
  // Samples per pixel so far.
  std::uint32_t (*samples)(const SideBySide& side_by_side);
  // Radiance of both halves, with a line between them; valid until the next call. Shows the picture where the reference
  // has no samples yet.
  const Vec3* (*picture)(SideBySide* side_by_side, const Renderer& renderer);
  // Writes the reference's name and samples, and the whole picture's distance from it.
  void (*write_lines)(const SideBySide& side_by_side, HudText* text);
  void (*print)(const SideBySide& side_by_side);
};

}  // namespace pocketray
