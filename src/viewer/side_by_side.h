// Split screen: the left half shows the picture, the right half the reference, which is traced on for as long as
// nothing changes. For the emulator. Its memory is its own, taken before the seal: no device has it.
#pragma once
#include <string>

#include "session/open_scene.h"
#include "viewer/hud.h"

namespace pocketray {

struct SplitScreen;

struct SplitScreenOptions {
  std::string reference;  // "model" or "physical"; empty: no split screen
};
// What the help says of its key.
const char* split_screen_key_help();
// What the viewer says of its key where there is no split screen.
const char* split_screen_hint();

// Null where none is asked for. The scene is open; the picture is judged as a screen of such pixels shows it.
SplitScreen* open_split_screen(const SplitScreenOptions& options, const Renderer& renderer, int bits_per_pixel,
                               bool dither);
void close_split_screen(SplitScreen* split);

// With a picture finished: traces the reference of the same view and time until about `deadline_ns` by clock_ns(),
// anew where these are others than at the last call. `picture` numbers the pictures. Settings are left as they are; the
// renderer has to prepare its next frame. Fails as prepare_frame() does.
Status advance_split_screen(SplitScreen* split, Renderer* renderer, double seconds, std::uint32_t picture,
                            std::uint64_t deadline_ns);
// The view or the time is about to change: what is shown of the reference is no longer true.
void forget_split_screen(SplitScreen* split);
// Nothing is left to refine.
bool is_split_screen_full(const SplitScreen& split);
// Samples that every pixel of the reference has.
std::uint32_t split_screen_samples(const SplitScreen& split);

// Radiance of both halves, with a line between them; valid until the next call. Where the reference has nothing yet
// it is the picture itself.
const Vec3* split_picture(SplitScreen* split, const Renderer& renderer);

// What is shown, and how far the whole picture is from the whole reference.
void write_split_lines(const SplitScreen& split, HudText* text);
void print_split_screen(const SplitScreen& split);

}  // namespace pocketray
