// Side by side: the left half shows the picture, the right half the reference, refined for as long as nothing changes.
// For the emulator. Its memory is its own, taken before the seal. viewer/reference has the backend; a device build has
// none.
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
  // With the scene open. The picture is judged as a screen of such pixels shows it.
  SideBySide* (*open)(const SideBySideOptions& options, const Renderer& renderer, int bits_per_pixel, bool dither);
  void (*close)(SideBySide* side_by_side);
  // With a picture finished: traces the reference of the same view and time until about `deadline_ns` by clock_ns(),
  // from the start where these differ from the last call's. `picture` numbers the pictures. Settings are left as they
  // are; the renderer has to prepare its next frame. Fails as prepare_frame() does.
  Status (*advance)(SideBySide* side_by_side, Renderer* renderer, double seconds, std::uint32_t picture,
                    std::uint64_t deadline_ns);
  // The view or the time is about to change: the samples no longer hold.
  void (*forget)(SideBySide* side_by_side);
  // Nothing is left to refine.
  bool (*is_full)(const SideBySide& side_by_side);
  // Samples of each pixel.
  std::uint32_t (*samples)(const SideBySide& side_by_side);
  // Radiance of both halves, with a line between them; valid until the next call. Where the reference has nothing yet
  // it is the picture itself.
  const Vec3* (*picture)(SideBySide* side_by_side, const Renderer& renderer);
  // The reference's name and samples, and the distance of the whole picture from it.
  void (*write_lines)(const SideBySide& side_by_side, HudText* text);
  void (*print)(const SideBySide& side_by_side);
};

}  // namespace pocketray
