#include "app/viewer.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "app/interrupt.h"
#include "app/picture.h"
#include "app/viewer_steps.h"
#include "base/seal.h"
#include "platform/file.h"

namespace pocketray {
namespace {

using platform::Button;

constexpr std::uint64_t kMillisecond = 1000000;
constexpr std::uint64_t kFileCheckNs = 500 * kMillisecond;

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
    if (event.button == Button::split && v->split) v->split_shown = !v->split_shown, v->split_changed = true;
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

Status save_screenshot(Viewer* v, Renderer* r) {
  char path[600];
  do {
    std::snprintf(path, sizeof path, "%.500s/pocketray-%04u.png", v->options.screenshot_folder.c_str(),
                  ++v->screenshot_count);
  } while (platform::file_stamp(path) != 0 && v->screenshot_count < 9999);
  PictureOptions picture;
  if (shows_split(*v)) picture.radiance = split_picture(v->split, *r);
  if (v->picture_shared) {
    SharedPicture shared = shared_picture(*v->sharing);
    picture.packed = shared.pixels, picture.packed_line_bytes = shared.line_bytes;
    picture.packed_format = shared.format;
  }
  RETURN_IF_ERROR(write_picture(path, picture, r));
  std::fprintf(stderr, "pocketray: saved %s\n", path);
  return success();
}

// Moves camera and time on; marks the picture as changed.
Status step_scene(Viewer* v, Renderer* r, ViewerLoop* loop) {
  std::uint64_t now = v->backend->now_ns();
  float elapsed = static_cast<float>(std::min<std::uint64_t>(now - loop->last_ns, 250 * kMillisecond)) * 1e-9f;
  loop->last_ns = now;
  bool moved = move_camera(&loop->control, read_input(*v), elapsed);
  if (v->change_mode)
    loop->control.mode = loop->control.mode == CameraMode::orbit ? CameraMode::fly : CameraMode::orbit;
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

}  // namespace

std::size_t viewer_bytes(const Settings& settings) { return picture_bytes(settings) + progressive_need(settings); }

Status open_viewer(const ViewOptions& options, const char* scene, int width, int height, Viewer* v) {
  v->options = options;
  v->scene_path = scene;
  v->width = width;
  v->height = height;
  if (!rotation_from_degrees(options.rotation, &v->rotation))
    return failure("--rotate is %d: it must be 0, 90, 180 or 270", options.rotation);
  v->backend =
      options.backend == "auto" ? platform::platform_default() : platform::platform_find(options.backend.c_str());
  if (!v->backend)
    return failure("--screen is '%s': this program has sdl2, linux or null, as built", options.backend.c_str());
  std::size_t page_bytes = platform::page_bytes_max(width, height);
  v->page_memory = std::malloc(page_bytes);
  if (!v->page_memory) return failure("no memory for a page of %dx%d pixels: lower --size", width, height);
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
  platform::Error error;
  if (!v->backend->open(screen, &format, &error)) return failure("%s", error.text);
  v->format = to_pixel_format(format);
  if (format.width < screen_width(*v) || format.height < screen_height(*v)) {
    v->backend->close();
    return failure("the screen has %dx%d pixels, too few for the picture: use --size %dx%d", format.width,
                   format.height, quarter_turned(*v) ? format.height : format.width,
                   quarter_turned(*v) ? format.width : format.height);
  }
  v->waiting_since_ns = v->backend->now_ns();
  return success();
}

bool show_waiting(Viewer* v, const char* text) {
  take_events(v);
  if (v->quit) return false;
  platform::Page page = v->backend->begin_frame();
  if (page.pixels) {
    int bytes = v->format.bits_per_pixel / 8;
    for (int y = 0; y < screen_height(*v); ++y)
      std::memset(static_cast<std::uint8_t*>(page.pixels) + static_cast<std::ptrdiff_t>(y) * page.line_bytes, 0,
                  static_cast<std::size_t>(screen_width(*v) * bytes));
    HudText hud;
    write_waiting(text, static_cast<double>(v->backend->now_ns() - v->waiting_since_ns) * 1e-9, &hud);
    draw_hud_text(hud, v->format, v->rotation, v->width, v->height, page.pixels, page.line_bytes);
    v->backend->end_frame(0, screen_height(*v));
  }
  v->backend->sleep_ns(50 * kMillisecond);
  return true;
}

Status run_viewer(Viewer* v, Renderer* r, bool* again) {
  ViewerLoop loop;
  std::size_t mark = arena_mark(r->frame_arena);
  loop.row_spans = arena_array<Span>(&r->frame_arena, r->settings.width);
  loop.control = make_camera_control(r->camera, r->accel.bounds);
  loop.last_ns = loop.last_check_ns = v->backend->now_ns();
  loop.stamp = platform::file_stamp(v->scene_path.c_str());
  loop.finished = true;  // nothing under way
  v->picture_shared = false;
  *again = v->reload = false;
  Status status;
  while (status.ok) {
    take_events(v);
    bool enough = v->options.frame_count > 0 && v->frames_finished >= v->options.frame_count;
    if (v->quit || enough) break;
    std::uint64_t now = v->backend->now_ns();
    if (now - loop.last_check_ns > kFileCheckNs) {
      loop.last_check_ns = now;
      std::uint64_t stamp = platform::file_stamp(v->scene_path.c_str());
      if (stamp != 0 && stamp != loop.stamp) v->reload = true;
    }
    if (v->reload) {
      *again = true;
      v->waiting_since_ns = now;
      break;
    }
    if (v->screenshot) {
      v->screenshot = false;
      Status saved = save_screenshot(v, r);
      if (!saved.ok) std::fprintf(stderr, "pocketray: %s\n", saved.message);
    }
    status = step_scene(v, r, &loop);
    if (status.ok) status = step_viewer(v, r, &loop);
  }
  arena_release(&r->frame_arena, mark);
  return status;
}

void close_viewer(Viewer* v) {
  if (v->backend) v->backend->close();
  std::free(v->page_memory);
  v->page_memory = nullptr;
}

}  // namespace pocketray
