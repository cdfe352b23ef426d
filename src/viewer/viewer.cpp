#include "viewer/viewer.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "base/printable.h"
#include "base/seal.h"
#include "platform/file.h"
#include "present/png_file.h"
#include "session/interrupt.h"
#include "session/picture.h"
#include "viewer/steps.h"

namespace pocketray {
namespace {

using platform::Button;

constexpr std::uint64_t kMillisecond = 1000000;
constexpr std::uint64_t kFileCheckNs = 500 * kMillisecond, kNoteNs = 4000 * kMillisecond;

PixelFormat to_pixel_format(const platform::ScreenFormat& f) {
  auto channel = [](const platform::Channel& c) { return PixelChannel{c.offset, c.length}; };
  return {f.bits_per_pixel, channel(f.red), channel(f.green), channel(f.blue), channel(f.alpha)};
}

void take_events(Viewer* v) {
  SealPause pause(takes_memory(*v->backend));
  platform::Event event;
  while (v->backend->poll(&event)) {
    bool down = event.type == platform::EventType::button_down;
    if (event.type == platform::EventType::quit) v->quit = true;
    if (event.type == platform::EventType::file_drop && event.path) {
      std::snprintf(v->dropped, sizeof v->dropped, "%s", event.path);
      v->reload = true;
    }
    if (!down && event.type != platform::EventType::button_up) continue;
    v->held[static_cast<int>(event.button)] = down;
    if (!down) continue;
    if (event.button == Button::hud || event.button == Button::y) v->hud = !v->hud;
    if (event.button == Button::x) v->paused = !v->paused;
    if (event.button == Button::screenshot) v->screenshot = true;
    if (event.button == Button::reload) v->reload = true;
    if (event.button == Button::start) v->home = v->front_home = true;
    if (event.button == Button::finer) ++v->front_steps;
    if (event.button == Button::faster) --v->front_steps;
    if (event.button == Button::split) ++v->split_presses;
    if (event.button == Button::select) v->change_mode = true;
  }
  if (interrupted) v->quit = true;
}

CameraInput read_input(const Viewer& v) {
  auto axis = [&](Button plus, Button minus) {
    return (v.held[static_cast<int>(plus)] ? 1.0f : 0.0f) - (v.held[static_cast<int>(minus)] ? 1.0f : 0.0f);
  };
  CameraInput in;
  in.right = axis(Button::right, Button::left);
  in.up = axis(Button::up, Button::down);
  in.forward = axis(Button::a, Button::b);
  in.sideways = axis(Button::r, Button::l);
  return in;
}

void save_screenshot(Viewer* v, Renderer* r) {
  char path[600], told[640];
  const char* ending = encode_png_need(1) > 0 ? "png" : "ppm";  // built without libpng
  do {
    std::snprintf(path, sizeof path, "%.500s/pocketray-%04u.%s", v->options.screenshot_folder.c_str(),
                  ++v->screenshot_count, ending);
  } while (platform::file_stamp(path) != 0 && v->screenshot_count < 9999);
  PictureOptions picture;
  if (shows_split(*v)) picture.radiance = split_picture(v->split, *r);
  if (v->picture_shared) {
    SharedPicture shared = shared_picture(*v->sharing);
    picture.packed = shared.pixels, picture.packed_line_bytes = shared.line_bytes;
    picture.packed_format = shared.format;
  }
  Status status = write_picture(path, picture, r);
  std::snprintf(told, sizeof told, "saved %s", path);
  tell(v, status.ok ? told : status.message);
}

// What was asked for by buttons that not every run has a use for.
void answer_buttons(Viewer* v, Renderer* r) {
  if (v->screenshot) save_screenshot(v, r);
  v->screenshot = false;
  bool toggled = v->split_presses % 2 != 0;
  if (v->split && toggled) v->split_shown = !v->split_shown, v->split_changed = true;
  if (!v->split && v->split_presses > 0) tell(v, split_screen_hint());
  v->split_presses = 0;
  if (!v->budget && v->front_steps != 0)
    tell(v, "page up and down choose settings within a budget: start with --budget-ms to have one");
  if (!v->budget) v->front_steps = 0, v->front_home = false;
}

bool is_file_changed(const Viewer& v, FileWatch* watch) {
  std::uint64_t now = v.backend->now_ns();
  if (now - watch->last_look_ns <= kFileCheckNs) return false;
  watch->last_look_ns = now;
  std::uint64_t stamp = platform::file_stamp(v.scene_path.c_str());
  bool changed = stamp != 0 && stamp != watch->loaded && stamp == watch->seen;
  watch->seen = stamp;
  return changed;
}

std::ptrdiff_t row_bytes(const Viewer& v) { return screen_width(v) * (v.format.bits_per_pixel / 8); }

// The last picture, or black, and a text over it; takes events. False: the user wants to leave.
bool show_text(Viewer* v, const HudText& text) {
  take_events(v);
  if (v->quit) return false;
  platform::Page page = v->backend->begin_frame();
  if (page.pixels) {
    std::ptrdiff_t bytes = row_bytes(*v);
    for (int y = 0; y < screen_height(*v); ++y) {
      auto* row = static_cast<std::uint8_t*>(page.pixels) + static_cast<std::ptrdiff_t>(y) * page.line_bytes;
      if (v->has_picture)
        std::memcpy(row, static_cast<const std::uint8_t*>(v->picture_memory) + y * bytes,
                    static_cast<std::size_t>(bytes));
      else
        std::memset(row, 0, static_cast<std::size_t>(bytes));
    }
    draw_hud_text(text, v->format, v->rotation, v->width, v->height, page.pixels, page.line_bytes);
    v->hud_rows_shown = std::min(hud_rows(text), static_cast<std::uint32_t>(v->height));
    v->backend->end_frame(0, screen_height(*v));
  }
  v->backend->sleep_ns(50 * kMillisecond);
  return true;
}

// Keeps the picture as it is on the screen, but for the text over it.
void keep_picture(Viewer* v, const Renderer& r) {
  const Vec3* radiance = shows_split(*v) ? split_picture(v->split, r) : r.image.data;
  if (!v->picture_shared && !radiance) return;
  pack_picture(*v, r, radiance, 0, v->height, {v->picture_memory, static_cast<int>(row_bytes(*v)), 0});
  v->has_picture = true;
}

void keep_view(Viewer* v, const ViewerLoop& loop) {
  std::snprintf(v->kept.scene_path, sizeof v->kept.scene_path, "%s", v->scene_path.c_str());
  v->kept.control = loop.control;
  v->kept.control.camera.node = kNone;  // it stands where the user put it, whatever moves in the scene
  v->kept.camera_moved = loop.camera_moved;
  v->kept.seconds = loop.seconds;
}

// A view that the scene as it is now cannot have is dropped.
void take_kept_view(const Viewer& v, Renderer* r, ViewerLoop* loop) {
  if (v.kept.scene_path != v.scene_path) return;
  loop->seconds = v.kept.seconds;
  loop->control.mode = v.kept.control.mode;
  loop->camera_moved = v.kept.camera_moved && set_camera(r, v.kept.control.camera).ok;
  if (loop->camera_moved) loop->control.camera = v.kept.control.camera;
}

// Where none is named: the first that opens. The one that shows nothing must be asked for.
Status open_any_screen(const platform::ScreenOptions& options, Viewer* v, platform::ScreenFormat* format) {
  std::string tried;
  for (int i = 0; i + 1 < platform::kBackendCount; ++i) {
    const platform::Backend* backend = platform::kBackends[i];
    platform::Error error;
    std::snprintf(error.text, sizeof error.text, "needs %s", backend->needs);
    v->backend = backend;
    if (backend->usable() && backend->open(options, format, &error)) return success();
    tried += std::string(tried.empty() ? "" : "; ") + backend->name + " " + std::string(error.text).substr(0, 120);
  }
  v->backend = nullptr;
  return failure("no screen was found (%.300s): choose one by --screen, or write pictures with `pocketray render`",
                 tried.c_str());
}

Status open_screen(const platform::ScreenOptions& options, Viewer* v, platform::ScreenFormat* format) {
  const std::string& name = v->options.backend;
  if (name == "auto" && !options.device) return open_any_screen(options, v, format);
  v->backend = platform::platform_find(name == "auto" ? "linux" : name.c_str());  // whose a framebuffer is
  if (!v->backend) return failure("--screen is '%s': this program has sdl2, linux or null, as built", name.c_str());
  platform::Error error;
  if (v->backend->open(options, format, &error)) return success();
  v->backend = nullptr;
  return failure("%s", error.text);
}

// Moves camera and time on; marks the picture as changed.
Status step_scene(Viewer* v, Renderer* r, ViewerLoop* loop) {
  std::uint64_t now = v->backend->now_ns();
  float elapsed = static_cast<float>(std::min<std::uint64_t>(now - loop->last_ns, 250 * kMillisecond)) * 1e-9f;
  loop->last_ns = now;
  bool moved = move_camera(&loop->control, read_input(*v), elapsed);
  if (v->change_mode)
    loop->control.mode = loop->control.mode == CameraMode::orbit ? CameraMode::fly : CameraMode::orbit;
  loop->camera_moved = (loop->camera_moved || moved) && !v->home;
  if (v->home) reset_camera(&loop->control), moved = true;
  v->change_mode = v->home = false;
  if (moved) {
    RETURN_IF_ERROR(set_camera(r, loop->control.camera));
    loop->moved = true;
  }
  bool passes = has(r->effects.mask, Effect::animation) && !v->paused && !shows_split(*v);
  if (passes) {
    loop->seconds += static_cast<double>(elapsed);
    loop->passed = true;
  }
  if (v->split && (moved || passes)) forget_split_screen(v->split);
  return success();
}

// Takes memory for pages and opens the screen; what has been taken stays so on failure.
Status take_screen(const ViewOptions& options, int width, int height, Viewer* v) {
  std::size_t page_bytes = platform::page_bytes_max(width, height);
  v->page_memory = std::malloc(page_bytes);
  v->picture_memory = std::malloc(page_bytes);
  if (!v->page_memory || !v->picture_memory)
    return failure("no memory for a page of %dx%d pixels: lower --size", width, height);
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
  screen.memory = v->page_memory;
  screen.memory_bytes = page_bytes;
  platform::ScreenFormat format;
  RETURN_IF_ERROR(open_screen(screen, v, &format));
  v->format = to_pixel_format(format);
  if (format.width >= screen_width(*v) && format.height >= screen_height(*v)) return success();
  return failure("the screen has %dx%d pixels, too few for the picture: use --size %dx%d", format.width, format.height,
                 quarter_turned(*v) ? format.height : format.width, quarter_turned(*v) ? format.width : format.height);
}

}  // namespace

std::size_t viewer_bytes(const Settings& settings) { return picture_bytes(settings) + progressive_need(settings); }

Status open_viewer(const ViewOptions& options, const char* scene, int width, int height, Viewer* v) {
  v->options = options;
  v->scene_path = scene;
  v->width = width;
  v->height = height;
  if (!rotation_from_degrees(options.rotation, &v->rotation))
    return failure("--rotate is %d: it must be 0, 90, 180 or 270", options.rotation);
  Status status = take_screen(options, width, height, v);
  if (!status.ok) {
    close_viewer(v);
    return status;
  }
  v->waiting_since_ns = v->backend->now_ns();
  watch_scene(v);
  return success();
}

void watch_scene(Viewer* v) {
  std::uint64_t stamp = platform::file_stamp(v->scene_path.c_str());
  v->watch = {stamp, stamp, v->backend->now_ns()};
}

void tell(Viewer* v, const char* text) {
  std::snprintf(v->note.text, sizeof v->note.text, "%s", text);
  make_printable(v->note.text, std::strlen(v->note.text));
  std::fprintf(stderr, "pocketray: %s\n", v->note.text);
  v->note.until_ns = v->backend->now_ns() + kNoteNs;
  ++v->note.number;
}

bool show_waiting(Viewer* v, const char* text) {
  HudText hud;
  write_waiting(text, static_cast<double>(v->backend->now_ns() - v->waiting_since_ns) * 1e-9, &hud);
  return show_text(v, hud);
}

bool wait_for_another(Viewer* v, const char* why) {
  HudText hud;
  add_hud_text(&hud, why);
  for (v->reload = false; !v->reload; v->reload = v->reload || is_file_changed(*v, &v->watch))
    if (!show_text(v, hud)) return false;
  v->waiting_since_ns = v->backend->now_ns();
  return true;
}

Status run_viewer(Viewer* v, Renderer* r, bool* again) {
  ViewerLoop loop;
  std::size_t mark = arena_mark(r->frame_arena);
  loop.row_spans = arena_array<Span>(&r->frame_arena, r->settings.width);
  loop.control = make_camera_control(r->camera, r->accel.bounds);
  take_kept_view(*v, r, &loop);
  loop.last_ns = v->backend->now_ns();
  loop.finished = true;  // nothing under way
  v->picture_shared = false;
  *again = false;
  v->reload = v->dropped[0] != 0;  // while this one was loading
  Status status;
  while (status.ok) {
    take_events(v);
    bool enough = v->options.frame_count > 0 && v->frames_finished >= v->options.frame_count;
    if (v->quit || enough) break;
    if (v->reload || is_file_changed(*v, &v->watch)) {
      *again = true;
      keep_view(v, loop);
      keep_picture(v, *r);
      v->waiting_since_ns = v->backend->now_ns();
      break;
    }
    answer_buttons(v, r);
    status = step_scene(v, r, &loop);
    if (status.ok) status = step_viewer(v, r, &loop);
  }
  arena_release(&r->frame_arena, mark);
  return status;
}

void close_viewer(Viewer* v) {
  if (v->backend) v->backend->close();
  v->backend = nullptr;
  std::free(v->page_memory);
  std::free(v->picture_memory);
  v->page_memory = v->picture_memory = nullptr;
}

}  // namespace pocketray
