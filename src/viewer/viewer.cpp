#include "viewer/viewer.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "base/check.h"
#include "base/printable.h"
#include "base/seal.h"
#include "platform/file.h"
#include "session/animation_choice.h"
#include "session/interrupt.h"
#include "session/nothing_picture.h"
#include "session/picture.h"
#include "viewer/steps.h"

namespace pocketray {
namespace {

using platform::Button;

constexpr std::uint64_t kMillisecond = 1000000;
// Chosen: a file counts as changed once two looks agree, so a model appears about a second after it was saved; a note
// stays long enough to be read.
constexpr std::uint64_t kFileCheckNs = 500 * kMillisecond, kNoteNs = 4000 * kMillisecond;

PixelFormat to_pixel_format(const platform::ScreenFormat& f) {
  auto channel = [](const platform::Channel& c) { return PixelChannel{c.offset, c.length}; };
  return {f.bits_per_pixel, channel(f.red), channel(f.green), channel(f.blue), channel(f.alpha)};
}

void take_events(Viewer* viewer) {
  SealPause pause(takes_memory(*viewer->backend));
  platform::Event event;
  while (viewer->backend->poll(&event)) {
    bool down = event.type == platform::EventType::button_down;
    if (event.type == platform::EventType::quit) viewer->quit = true;
    if (event.type == platform::EventType::file_drop && event.path) {
      std::snprintf(viewer->dropped, sizeof viewer->dropped, "%s", event.path);
      viewer->reload = true;
    }
    if (!down && event.type != platform::EventType::button_up) continue;
    CHECK_LT(static_cast<int>(event.button), platform::kButtonCount);
    const bool shifted = viewer->held[static_cast<int>(Button::select)];
    viewer->held[static_cast<int>(event.button)] = down;
    if (event.button == Button::select && !down && viewer->select_alone) viewer->change_mode = true;
    viewer->event_ns = viewer->backend->now_ns();
    if (!down) continue;
    if (!viewer->pressed) viewer->pressed = true, viewer->pressed_ns = event.time_ns;
    if (event.button == Button::hud || event.button == Button::y) viewer->hud = !viewer->hud;
    if (event.button == Button::x) viewer->paused = !viewer->paused;
    if (event.button == Button::screenshot) viewer->screenshot = true;
    if (event.button == Button::reload) viewer->reload = true;
    if (event.button == Button::start) viewer->home = viewer->front_home = true;
    if (event.button == Button::finer || (shifted && event.button == Button::up)) ++viewer->quality_steps;
    if (event.button == Button::faster || (shifted && event.button == Button::down)) --viewer->quality_steps;
    if (event.button == Button::side_by_side) ++viewer->side_by_side_presses;
    if (event.button == Button::traced) ++viewer->traced_presses;
    if (event.button == Button::animation) ++viewer->animation_presses;
    viewer->select_alone = event.button == Button::select;
  }
  if (interrupted) viewer->quit = true;
}

CameraInput read_input(const Viewer& viewer) {
  auto axis = [&](Button plus, Button minus) {
    return (viewer.held[static_cast<int>(plus)] ? 1.0f : 0.0f) - (viewer.held[static_cast<int>(minus)] ? 1.0f : 0.0f);
  };
  CameraInput in;
  if (viewer.held[static_cast<int>(Button::select)]) return in;
  in.right = axis(Button::right, Button::left);
  in.up = axis(Button::up, Button::down);
  in.forward = axis(Button::a, Button::b);
  in.sideways = axis(Button::r, Button::l);
  return in;
}

void save_screenshot(Viewer* viewer, Renderer* renderer) {
  char path[600], told[640];
  do {
    std::snprintf(path, sizeof path, "%.500s/pocketray-%04u.png", viewer->options.screenshot_folder.c_str(),
                  ++viewer->screenshot_count);
  } while (platform::file_stamp(path) != 0 && viewer->screenshot_count < 9999);
  PictureOptions picture;
  if (shows_side_by_side(*viewer))
    picture.radiance = viewer->side_by_side->backend->picture(viewer->side_by_side, *renderer);
  if (viewer->picture_merged) {
    MergedPicture merged = viewer->servers->backend->picture(*viewer->servers);
    picture.packed = merged.pixels, picture.packed_line_bytes = merged.line_bytes;
    picture.packed_format = merged.format;
  }
  Status status = write_picture(path, picture, renderer);
  std::snprintf(told, sizeof told, "saved %s", path);
  tell(viewer, status.ok ? told : status.message);
}

// Toggles the overlay of traced pixels, or tells why there is none.
void answer_traced(Viewer* viewer, const Renderer& renderer) {
  const CoherenceState& coherence = renderer.history.state;
  char told[200];
  if (!coherence.planned) {
    viewer->traced = false;
    bool can_be_on = renderer.settings.coherence != CoherenceMode::on;
    std::snprintf(told, sizeof told, "T dims pixels that were not retraced; all were, since %.80s%s",
                  coherence.unplanned_because, can_be_on ? ": start with --coherence on to use it" : "");
    tell(viewer, told);
  } else if (viewer->picture_merged) {
    tell(viewer, "T dims pixels that were not retraced, but not in frames shared with servers");
  } else if (shows_side_by_side(*viewer)) {
    tell(viewer, "T dims pixels that were not retraced: hide the reference with V to see it");
  } else if (viewer->traced_presses % 2 != 0) {
    viewer->traced = !viewer->traced;
  }
  viewer->traced_presses = 0;
}

// Plays the next of the scene's animations; after the last, none.
void change_animation(Viewer* viewer, Renderer* renderer, ViewerLoop* loop) {
  const Scene& scene = renderer->scene;
  if (viewer->animation_presses == 0) return;
  const char* refused = !has(renderer->effects.mask, Effect::animation) ? "N changes the animation, but nothing moves"
                        : scene.animations.empty()
                            ? "N changes the animation, but only the servers have the scene: start with --animation"
                            : nullptr;
  for (; !refused && viewer->animation_presses > 0; --viewer->animation_presses)
    renderer->view.animation = renderer->view.animation == kNone                       ? 0
                               : renderer->view.animation + 1 < scene.animations.count ? renderer->view.animation + 1
                                                                                       : kNone;
  viewer->animation_presses = 0;
  SealPause pause;  // for the texts
  tell(viewer, refused ? refused : describe_animation(scene, renderer->view.animation).c_str());
  if (refused) return;
  loop->passed = true;
  if (viewer->side_by_side) viewer->side_by_side->backend->forget(viewer->side_by_side);
}

// Turns the dial, and tells what the next pictures show.
void change_quality(Viewer* viewer, Renderer* renderer, ViewerLoop* loop) {
  if (viewer->quality_steps == 0) return;
  Status status = viewer->dial ? end_refining(renderer, loop)
                               : failure("+ and - change the quality, but not of frames shared with servers");
  if (status.ok) status = turn_dial(viewer->dial, viewer->quality_steps, renderer);
  viewer->quality_steps = 0;
  char told[kFrontLineMax + 40] = "";
  if (status.ok) {
    char settings[kFrontLineMax];
    format_hud_quality(candidate_of(renderer->settings), settings, sizeof settings);
    std::snprintf(told, sizeof told, "quality %s: %s", kQualityLevelNames[static_cast<int>(viewer->dial->current)],
                  settings);
    loop->passed = true;
  }
  tell(viewer, status.ok ? told : status.message);
}

// Responds to buttons that have no function in this run.
void answer_buttons(Viewer* viewer, Renderer* renderer, ViewerLoop* loop) {
  if (viewer->screenshot) save_screenshot(viewer, renderer);
  viewer->screenshot = false;
  bool toggled = viewer->side_by_side_presses % 2 != 0;
  if (viewer->side_by_side && toggled)
    viewer->side_by_side_shown = !viewer->side_by_side_shown, viewer->side_by_side_changed = true;
  if (!viewer->side_by_side && viewer->side_by_side_presses > 0)
    tell(viewer, viewer->options.has_reference
                     ? "V shows the reference beside the picture: start with --side-by-side model to use it"
                     : "V shows the reference, which this build does not have: use a desktop build");
  viewer->side_by_side_presses = 0;
  if (viewer->traced_presses > 0) answer_traced(viewer, *renderer);
  if (!viewer->budget) change_quality(viewer, renderer, loop), viewer->front_home = false;
}

bool is_file_changed(const Viewer& viewer, FileWatch* watch) {
  std::uint64_t now = viewer.backend->now_ns();
  if (now - watch->last_look_ns <= kFileCheckNs) return false;
  watch->last_look_ns = now;
  std::uint64_t stamp = platform::file_stamp(viewer.scene_path.c_str());
  bool changed = stamp != 0 && stamp != watch->loaded && stamp == watch->seen;
  watch->seen = stamp;
  return changed;
}

std::ptrdiff_t row_bytes(const Viewer& viewer) { return screen_width(viewer) * (viewer.format.bits_per_pixel / 8); }

// Shows the last picture, or black, with a text over it, and handles events. Returns false if the user quit.
bool show_text(Viewer* viewer, const HudText& text) {
  take_events(viewer);
  if (viewer->quit) return false;
  platform::Page page = viewer->backend->begin_frame();
  if (page.pixels) {
    std::ptrdiff_t bytes = row_bytes(*viewer);
    for (int y = 0; y < screen_height(*viewer); ++y) {
      auto* row = static_cast<std::uint8_t*>(page.pixels) + static_cast<std::ptrdiff_t>(y) * page.line_bytes;
      if (viewer->has_picture)
        std::memcpy(row, static_cast<const std::uint8_t*>(viewer->picture_memory) + y * bytes,
                    static_cast<std::size_t>(bytes));
      else
        std::memset(row, 0, static_cast<std::size_t>(bytes));
    }
    draw_hud_text(text, viewer->format, viewer->rotation, viewer->width, viewer->height, page.pixels, page.line_bytes);
    viewer->hud_rows_shown = std::min(hud_rows(text), static_cast<std::uint32_t>(viewer->height));
    viewer->backend->end_frame(0, screen_height(*viewer));
  }
  viewer->backend->sleep_ns(50 * kMillisecond);  // chosen: polling the buttons 20 times a second feels immediate
  return true;
}

// Keeps a copy of the picture on the screen, without the overlay.
void keep_picture(Viewer* viewer, const Renderer& renderer) {
  const Vec3* radiance = shows_side_by_side(*viewer)
                             ? viewer->side_by_side->backend->picture(viewer->side_by_side, renderer)
                             : renderer.image.data;
  if (!viewer->picture_merged && !radiance) return;
  CHECK(viewer->picture_memory != nullptr);
  pack_picture(*viewer, renderer, radiance, 0, viewer->height,
               {viewer->picture_memory, static_cast<int>(row_bytes(*viewer)), 0});
  viewer->has_picture = true;
}

void keep_view(Viewer* viewer, std::uint32_t animation, const ViewerLoop& loop) {
  viewer->kept.quality_steps = viewer->dial ? viewer->dial->steps : 0;
  std::snprintf(viewer->kept.scene_path, sizeof viewer->kept.scene_path, "%s", viewer->scene_path.c_str());
  viewer->kept.control = loop.control;
  viewer->kept.control.camera.node = kNone;  // it stays where the user put it, attached to no moving node
  viewer->kept.camera_moved = loop.camera_moved;
  viewer->kept.seconds = loop.seconds;
  viewer->kept.animation = animation;
}

// Restores the kept view, unless it is not possible in the reloaded scene.
void take_kept_view(const Viewer& viewer, Renderer* renderer, ViewerLoop* loop) {
  if (viewer.kept.scene_path != viewer.scene_path) return;
  if (viewer.dial && viewer.kept.quality_steps != 0) (void)turn_dial(viewer.dial, viewer.kept.quality_steps, renderer);
  loop->seconds = viewer.kept.seconds;
  if (viewer.kept.animation == kNone || viewer.kept.animation < renderer->scene.animations.count)
    renderer->view.animation = viewer.kept.animation;
  loop->control.mode = viewer.kept.control.mode;
  loop->camera_moved = viewer.kept.camera_moved && set_camera(renderer, viewer.kept.control.camera).ok;
  if (loop->camera_moved) loop->control.camera = viewer.kept.control.camera;
}

// Opens the first screen that works, except `null`, which must be requested by name.
Status open_any_screen(const platform::ScreenOptions& options, Viewer* viewer, platform::ScreenFormat* format) {
  std::string tried;
  for (int i = 0; i + 1 < platform::kBackendCount; ++i) {
    const platform::Backend* backend = platform::kBackends[i];
    platform::Error error;
    std::snprintf(error.text, sizeof error.text, "needs %s", backend->needs);
    viewer->backend = backend;
    if (backend->usable() && backend->open(options, format, &error)) return success();
    tried += std::string(tried.empty() ? "" : "; ") + backend->name + " " + std::string(error.text).substr(0, 120);
  }
  viewer->backend = nullptr;
  return failure("no screen found (%.300s): choose one with --screen, or write pictures with `pocketray render`",
                 tried.c_str());
}

Status open_screen(const platform::ScreenOptions& options, Viewer* viewer, platform::ScreenFormat* format) {
  const std::string& name = viewer->options.backend;
  if (name == "auto" && !options.device) return open_any_screen(options, viewer, format);
  viewer->backend = platform::platform_find(name == "auto" ? "linux" : name.c_str());  // --framebuffer implies linux
  if (!viewer->backend) return failure("--screen is '%s': it must be sdl2, linux or null, if built in", name.c_str());
  platform::Error error;
  if (viewer->backend->open(options, format, &error)) return success();
  const bool is_default = viewer->backend == platform::platform_find("linux") && !options.device;
  viewer->backend = nullptr;
  return failure("%s%s", error.text, is_default ? "; --framebuffer FILE uses another one" : "");
}

// Advances camera and time; marks the picture as changed.
Status step_scene(Viewer* viewer, Renderer* renderer, ViewerLoop* loop) {
  std::uint64_t now = viewer->backend->now_ns();
  if (loop->last_ns == 0) loop->last_ns = now;  // the first picture shows the start of the animation
  const std::uint64_t last_ns = loop->last_ns;
  float elapsed = static_cast<float>(std::min<std::uint64_t>(now - last_ns, 250 * kMillisecond)) * 1e-9f;
  loop->last_ns = now;
  bool moved = move_camera(&loop->control, read_input(*viewer), elapsed);
  if (viewer->change_mode)
    loop->control.mode = loop->control.mode == CameraMode::orbit ? CameraMode::fly : CameraMode::orbit;
  loop->camera_moved = (loop->camera_moved || moved) && !viewer->home;
  if (viewer->home) reset_camera(&loop->control);
  if (moved || viewer->home) {
    const std::uint64_t pressed_ns = viewer->pressed ? std::min(viewer->pressed_ns, now) : now;
    note_motion(&viewer->motion, loop->moving ? last_ns : pressed_ns, now);
  }
  loop->moving = moved, viewer->pressed = false;
  if (moved || viewer->home) {
    // A shifted target rounds the view differently; the scene's own view must give its own pixels.
    RETURN_IF_ERROR(set_camera(renderer, viewer->home ? loop->control.scene : loop->control.camera));
    moved = loop->moved = true;
  }
  viewer->change_mode = viewer->home = false;
  const bool plays = has(renderer->effects.mask, Effect::animation) && renderer->view.animation != kNone;
  const bool passes = plays && !viewer->paused && !shows_side_by_side(*viewer);
  if (passes) {
    loop->seconds += static_cast<double>(elapsed);
    loop->passed = true;
  }
  if (viewer->side_by_side && (moved || passes)) viewer->side_by_side->backend->forget(viewer->side_by_side);
  return success();
}

// Allocates the pages and opens the screen; on failure, leaves cleaning up to close_viewer().
Status take_screen(const ViewOptions& options, int width, int height, Viewer* viewer) {
  CHECK(width > 0 && height > 0);
  CHECK(viewer->page_memory == nullptr && viewer->picture_memory == nullptr);
  std::size_t page_bytes = platform::page_bytes_max(width, height);
  viewer->page_memory = std::malloc(page_bytes);
  viewer->picture_memory = std::malloc(page_bytes);
  if (!viewer->page_memory || !viewer->picture_memory)
    return failure("not enough memory for a page of %dx%d pixels: lower --size", width, height);
  platform::ScreenOptions screen;
  screen.width = width;
  screen.height = height;
  screen.rotation = options.rotation;
  screen.keys = options.keys;
  screen.scale = options.scale;
  screen.title = "pocketray";
  if (const platform::Device* device = options.emulated) {
    screen.bits_per_pixel = device->bits_per_pixel;
    screen.blue_first = device->channel_order[0] == 'b';
    screen.upright = true;
    screen.title = device->name;
  }
  screen.device = options.device.empty() ? nullptr : options.device.c_str();
  screen.memory = viewer->page_memory;
  screen.memory_bytes = page_bytes;
  platform::ScreenFormat format;
  RETURN_IF_ERROR(open_screen(screen, viewer, &format));
  viewer->format = to_pixel_format(format);
  if (format.width >= screen_width(*viewer) && format.height >= screen_height(*viewer)) return success();
  return failure("the screen has only %dx%d pixels: use --size %dx%d", format.width, format.height,
                 quarter_turned(*viewer) ? format.height : format.width,
                 quarter_turned(*viewer) ? format.width : format.height);
}

// Prints a warning if the first finished picture is black or shows nothing.
void explain_first_picture(Viewer* viewer, const Renderer& renderer) {
  char text[kBlackTextBytes];
  if (explain_picture(renderer, viewer->material_names, text)) tell(viewer, text);
}

}  // namespace

std::size_t viewer_bytes(const Settings& settings) { return picture_bytes(settings) + progressive_need(settings); }

Status open_viewer(const ViewOptions& options, const char* scene, int width, int height, Viewer* viewer) {
  CHECK(scene != nullptr && viewer->backend == nullptr);  // opened once
  viewer->options = options;
  viewer->hud = options.hud;
  viewer->scene_path = scene;
  viewer->width = width;
  viewer->height = height;
  if (!rotation_from_degrees(options.rotation, &viewer->rotation))
    return failure("--rotate is %d: it must be 0, 90, 180 or 270", options.rotation);
  Status status = take_screen(options, width, height, viewer);
  if (!status.ok) {
    close_viewer(viewer);
    return status;
  }
  viewer->waiting_since_ns = viewer->backend->now_ns();
  watch_scene(viewer);
  return success();
}

void watch_scene(Viewer* viewer) {
  std::uint64_t stamp = platform::file_stamp(viewer->scene_path.c_str());
  viewer->watch = {stamp, stamp, viewer->backend->now_ns()};
}

void tell(Viewer* viewer, const char* text) {
  CHECK(text != nullptr);
  std::snprintf(viewer->note.text, sizeof viewer->note.text, "%s", text);
  make_printable(viewer->note.text, std::strlen(viewer->note.text));
  std::fprintf(stderr, "pocketray: %s\n", viewer->note.text);
  viewer->note.until_ns = viewer->backend->now_ns() + kNoteNs;
  ++viewer->note.number;
}

bool show_waiting(Viewer* viewer, const char* text) {
  HudText hud;
  write_waiting(text, static_cast<double>(viewer->backend->now_ns() - viewer->waiting_since_ns) * 1e-9, &hud);
  return show_text(viewer, hud);
}

bool wait_for_another(Viewer* viewer, const char* why) {
  HudText hud;
  add_hud_text(&hud, why);
  for (viewer->reload = false; !viewer->reload;
       viewer->reload = viewer->reload || is_file_changed(*viewer, &viewer->watch))
    if (!show_text(viewer, hud)) return false;
  viewer->waiting_since_ns = viewer->backend->now_ns();
  return true;
}

Status run_viewer(Viewer* viewer, Renderer* renderer, bool* again) {
  CHECK(viewer->backend != nullptr);
  CHECK_EQ(renderer->settings.width, static_cast<std::uint32_t>(viewer->width));
  CHECK_EQ(renderer->settings.height, static_cast<std::uint32_t>(viewer->height));
  ViewerLoop loop;
  std::size_t mark = arena_mark(renderer->memory.frame);
  loop.tile_spans = arena_array<Span>(&renderer->memory.frame, progressive_spans_max(renderer->settings));
  loop.control = make_camera_control(renderer->view.camera,
                                     is_empty(viewer->focus) ? renderer->accel.built.bounds : viewer->focus);
  take_kept_view(*viewer, renderer, &loop);
  loop.finished = true;  // no picture in progress
  viewer->picture_merged = false;
  drop_motion(&viewer->motion);
  *again = false;
  viewer->reload = viewer->dropped[0] != 0;  // dropped while this scene was loading
  Status status;
  const std::uint32_t finished_before = viewer->frames_finished;
  bool is_first = !viewer->servers;
  while (status.ok) {
    take_events(viewer);
    bool enough = viewer->options.frame_count > 0 && viewer->frames_finished >= viewer->options.frame_count;
    if (viewer->quit || enough) break;
    if (viewer->reload || is_file_changed(*viewer, &viewer->watch)) {
      *again = true;
      keep_view(viewer, renderer->view.animation, loop);
      keep_picture(viewer, *renderer);
      viewer->waiting_since_ns = viewer->backend->now_ns();
      break;
    }
    answer_buttons(viewer, renderer, &loop);
    change_animation(viewer, renderer, &loop);
    status = step_scene(viewer, renderer, &loop);
    if (status.ok) status = step_viewer(viewer, renderer, &loop);
    if (!status.ok || !is_first || viewer->frames_finished == finished_before) continue;
    is_first = false;
    explain_first_picture(viewer, *renderer);
  }
  if (status.ok) status = end_refining(renderer, &loop);
  arena_release(&renderer->memory.frame, mark);
  return status;
}

void close_viewer(Viewer* viewer) {
  if (viewer->backend) viewer->backend->close();
  viewer->backend = nullptr;
  std::free(viewer->page_memory);
  std::free(viewer->picture_memory);
  viewer->page_memory = viewer->picture_memory = nullptr;
}

}  // namespace pocketray
