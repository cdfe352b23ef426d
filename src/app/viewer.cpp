#include "app/viewer.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "app/frame.h"
#include "app/interrupt.h"
#include "app/picture.h"
#include "app/viewer_hud.h"
#include "base/seal.h"
#include "platform/file.h"
#include "present/repack.h"

namespace pocketray {
namespace {

using platform::Button;

constexpr std::uint64_t kMillisecond = 1000000;
constexpr std::uint64_t kSliceNs = 25 * kMillisecond;  // between two looks at the buttons
constexpr std::uint64_t kIdleNs = 8 * kMillisecond;
constexpr std::uint64_t kFileCheckNs = 500 * kMillisecond;

// A window system takes memory when it likes; the seal is lifted while it is called. Screens of devices are not spared.
bool takes_memory(const platform::Backend& screen) { return std::strcmp(screen.name, "sdl2") == 0; }

PixelFormat to_pixel_format(const platform::ScreenFormat& f) {
  auto channel = [](const platform::Channel& c) { return PixelChannel{c.offset, c.length}; };
  return {f.bits_per_pixel, channel(f.red), channel(f.green), channel(f.blue), channel(f.alpha)};
}

bool quarter_turned(const Viewer& v) {
  return v.rotation == Rotation::quarter || v.rotation == Rotation::three_quarters;
}
int screen_width(const Viewer& v) { return quarter_turned(v) ? v.height : v.width; }
int screen_height(const Viewer& v) { return quarter_turned(v) ? v.width : v.height; }

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

bool shows_split(const Viewer& v) { return v.split && v.split_shown; }

void pack_page(const Viewer& v, const Renderer& r, const Vec3* radiance, int row_begin, int row_end,
               const platform::Page& page) {
  if (!v.picture_shared) {
    pack_rows(radiance, v.width, v.height, row_begin, row_end, r.exposure, v.format, v.rotation, v.options.dither,
              page.pixels, page.line_bytes);
    return;
  }
  SharedPicture shared = shared_picture(*v.sharing);
  repack_rows(shared.format, shared.pixels, shared.line_bytes, v.width, v.height, row_begin, row_end, v.format,
              v.rotation, page.pixels, page.line_bytes);
}

// Packs the rows that changed and shows them.
void show_rows(Viewer* v, const Renderer& r, const HudText& text, std::uint32_t row_begin, std::uint32_t row_end) {
  SealPause pause(takes_memory(*v->backend));
  platform::Page page = v->backend->begin_frame();
  if (!page.pixels) return;
  if (page.age != 1 || quarter_turned(*v)) row_begin = 0, row_end = r.settings.height;
  if (v->hud || v->hud_shown)
    row_begin = 0, row_end = std::max(row_end, std::min<std::uint32_t>(hud_rows(text), r.settings.height));
  const Vec3* radiance = r.image.data;
  if (shows_split(*v)) radiance = split_picture(v->split, r), row_begin = 0, row_end = r.settings.height;
  std::uint64_t start = clock_ns();
  pack_page(*v, r, radiance, static_cast<int>(row_begin), static_cast<int>(row_end), page);
  v->pack_ns = clock_ns() - start;
  if (v->hud) draw_hud_text(text, v->format, v->rotation, v->width, v->height, page.pixels, page.line_bytes);
  v->hud_shown = v->hud;
  bool whole = quarter_turned(*v) || page.age != 1;
  if (whole) {
    v->backend->end_frame(0, screen_height(*v));
  } else if (v->rotation == Rotation::half) {
    v->backend->end_frame(v->height - static_cast<int>(row_end), v->height - static_cast<int>(row_begin));
  } else {
    v->backend->end_frame(static_cast<int>(row_begin), static_cast<int>(row_end));
  }
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

struct Loop {
  CameraControl control;
  Progressive progressive;
  Array<Span> row_spans;
  HudText hud;
  double seconds = 0;                 // of the animation
  bool moved = false, passed = true;  // the camera has moved, time has passed: another picture is due
  bool finished = false;
  // With a budget, since camera or time moved: frames, and of these the last ones in a row with one choice of settings.
  std::uint32_t still_frames = 0, steady_frames = 0;
  bool settled = true;
  std::uint64_t last_ns = 0, last_check_ns = 0, stamp = 0;
};

// Moves camera and time on; marks the picture as changed.
Status step_scene(Viewer* v, Renderer* r, Loop* loop) {
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

// As many frames as were asked for, even of a still; with a reference beside it, when that has some samples.
constexpr std::uint32_t kSplitSamples = 32;
bool goes_on(const Viewer& v) { return v.options.frame_count > 0 && !shows_split(v); }

void write_picture_lines(const Viewer& v, const Renderer& r, Loop* loop) {
  write_hud(r, loop->progressive, loop->control.mode, &loop->hud);
  if (v.budget) write_budget_lines(*v.budget, &loop->hud);
  if (v.sharing) write_server_lines(*v.sharing, &loop->hud);
}

// Nothing has changed: the reference beside the picture is refined, or the buttons are waited for.
Status idle(Viewer* v, Renderer* r, Loop* loop) {
  if (v->options.frame_count > 0 && !shows_split(*v)) loop->passed = true;  // it was put away meanwhile
  bool refines = shows_split(*v) && !is_split_screen_full(*v->split);
  if (!refines && !v->split_changed) {
    v->backend->sleep_ns(kIdleNs);
    return success();
  }
  v->split_changed = false;
  write_picture_lines(*v, *r, loop);
  if (shows_split(*v)) {
    RETURN_IF_ERROR(advance_split_screen(v->split, r, loop->seconds, v->frames_finished, clock_ns() + kSliceNs));
    write_split_lines(*v->split, &loop->hud);
    if (v->options.frame_count > 0 && split_screen_samples(*v->split) >= kSplitSamples) loop->passed = true;
  }
  show_rows(v, *r, loop->hud, 0, r->settings.height);
  return success();
}

// Begins the next picture once the present one can be seen, traces a slice of it, shows it.
Status step_picture(Viewer* v, Renderer* r, Loop* loop) {
  // A moving camera is followed as soon as something can be seen; time waits until the picture is finished, and so does
  // everything where finished frames are counted.
  bool follow = loop->moved && loop->progressive.shown_coarse && v->options.frame_count == 0;
  if (follow || (loop->finished && (loop->moved || loop->passed))) {
    RETURN_IF_ERROR(prepare_frame(r, loop->seconds));
    start_progressive(r, &loop->progressive);
    loop->moved = loop->passed = loop->finished = false;
  }
  if (loop->finished && v->hud == v->hud_shown) return idle(v, r, loop);
  bool was_finished = loop->finished;
  if (!was_finished)
    loop->finished = advance_progressive(r, loop->row_spans, clock_ns() + kSliceNs, &loop->progressive);
  if (loop->finished && !was_finished) {
    ++v->frames_finished;
    if (goes_on(*v)) loop->passed = true;
  }
  write_picture_lines(*v, *r, loop);
  std::uint32_t begin = 0, end = 0;
  take_dirty_rows(&loop->progressive, &begin, &end);
  show_rows(v, *r, loop->hud, begin, end);
  return success();
}

// A still is rendered again until its settings are settled: so many frames with the same ones, longer than the governor
// waits before it tries what may fit. Where noise keeps two candidates in turn, there is an end to it.
constexpr std::uint32_t kSteadyFrames = 16, kStillFramesMax = 100;

// Renders whole frames within a budget; each is shown when it is complete.
Status step_budgeted(Viewer* v, Renderer* r, Loop* loop) {
  Budget* budget = v->budget;
  if (v->front_home || v->front_steps != 0) {
    move_along_front(budget, v->front_home ? 0 : v->front_steps);
    v->front_home = false;
    v->front_steps = 0;
    loop->passed = true;
  }
  if (loop->moved || loop->passed) loop->still_frames = loop->steady_frames = 0;
  bool due = loop->moved || loop->passed || (!loop->settled && v->options.frame_count == 0);
  if (!due && v->hud == v->hud_shown) return idle(v, r, loop);
  std::uint32_t before = budget->last;
  std::uint64_t start = clock_ns(), traced = start;
  if (due) {
    RETURN_IF_ERROR(begin_budget_frame(budget, r));
    RETURN_IF_ERROR(render_frame(r, loop->seconds, Aov::none, &interrupted));
    traced = clock_ns();
    loop->progressive = {};
    loop->progressive.step = 0;
    loop->progressive.pixels_traced = std::uint64_t(r->settings.width) * r->settings.height;
    loop->progressive.trace_ns = traced - start;
    loop->moved = loop->passed = false;
  }
  write_picture_lines(*v, *r, loop);
  show_rows(v, *r, loop->hud, 0, r->settings.height);
  if (!due || interrupted) return success();
  end_budget_frame(budget, traced - start + paced_ns(r->pace, 0, v->pack_ns));
  ++v->frames_finished;
  loop->passed = goes_on(*v);
  ++loop->still_frames;
  loop->steady_frames = budget->last == before ? loop->steady_frames + 1 : 0;
  loop->settled = budget->pinned || loop->steady_frames >= kSteadyFrames || loop->still_frames >= kStillFramesMax;
  return success();
}

// Traces a slice of a frame that servers share, and shows what has come of it from both ends.
Status step_shared(Viewer* v, Renderer* r, Loop* loop) {
  if (loop->finished && (loop->moved || loop->passed)) {
    RETURN_IF_ERROR(begin_shared(v->sharing, r, loop->seconds));
    loop->moved = loop->passed = loop->finished = false;
  }
  if (loop->finished && v->hud == v->hud_shown) return idle(v, r, loop);
  if (!loop->finished && advance_shared(v->sharing, r, clock_ns() + kSliceNs, nullptr)) {
    loop->finished = true;
    ++v->frames_finished;
    if (goes_on(*v)) loop->passed = true;
  }
  loop->hud.line_count = 0;
  write_share_lines(*v->sharing, &loop->hud);
  std::uint32_t begin = 0, end = 0;
  take_shared_rows(v->sharing, &begin, &end);
  show_rows(v, *r, loop->hud, begin, end);
  return success();
}

// Who makes the next picture: with servers in reach it is complete soon, without it is refined. A camera that moves is
// not followed within a frame that servers share, unless they are gone.
Status step_with_servers(Viewer* v, Renderer* r, Loop* loop) {
  if (!v->picture_shared || loop->finished) tend_servers(v->sharing);
  bool any = has_servers(*v->sharing);
  bool follow = loop->moved && v->options.frame_count == 0 && (v->picture_shared || loop->progressive.shown_coarse);
  bool due = follow || (loop->finished && (loop->moved || loop->passed));
  if (due && v->picture_shared != any) {
    v->picture_shared = any;
    loop->finished = true;  // what was under way is given up
  }
  return v->picture_shared ? step_shared(v, r, loop) : step_picture(v, r, loop);
}

Status step_any(Viewer* v, Renderer* r, Loop* loop) {
  if (v->budget) return step_budgeted(v, r, loop);
  return v->sharing ? step_with_servers(v, r, loop) : step_picture(v, r, loop);
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
  Loop loop;
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
    if (status.ok) status = step_any(v, r, &loop);
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
