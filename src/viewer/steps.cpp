#include "viewer/steps.h"

#include <algorithm>
#include <cstring>

#include "base/seal.h"
#include "engine/frame.h"
#include "present/repack.h"
#include "session/interrupt.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kMillisecond = 1000000;
constexpr std::uint64_t kSliceNs = 25 * kMillisecond;  // between two looks at the buttons
constexpr std::uint64_t kIdleNs = 8 * kMillisecond;

// Packs the rows that changed and shows them.
void show_rows(Viewer* v, const Renderer& r, const HudText& text, std::uint32_t row_begin, std::uint32_t row_end) {
  SealPause pause(takes_memory(*v->backend));
  platform::Page page = v->backend->begin_frame();
  if (!page.pixels) return;
  if (page.age != 1 || quarter_turned(*v)) row_begin = 0, row_end = r.settings.height;
  std::uint32_t note = note_now(*v);
  HudText shown;
  if (v->hud) shown = text;
  if (note) add_hud_text(&shown, v->note.text);
  std::uint32_t covered = std::min(hud_rows(shown), r.settings.height);
  if (covered > 0 || v->hud_rows_shown > 0)
    row_begin = 0, row_end = std::max(row_end, std::max(covered, v->hud_rows_shown));
  const Vec3* radiance = r.image.data;
  if (shows_split(*v)) radiance = split_picture(v->split, r), row_begin = 0, row_end = r.settings.height;
  std::uint64_t start = clock_ns();
  pack_picture(*v, r, radiance, static_cast<int>(row_begin), static_cast<int>(row_end), page);
  v->pack_ns = clock_ns() - start;
  draw_hud_text(shown, v->format, v->rotation, v->width, v->height, page.pixels, page.line_bytes);
  v->hud_shown = v->hud, v->note_shown = note, v->hud_rows_shown = covered;
  bool whole = quarter_turned(*v) || page.age != 1;
  if (whole) {
    v->backend->end_frame(0, screen_height(*v));
  } else if (v->rotation == Rotation::half) {
    v->backend->end_frame(v->height - static_cast<int>(row_end), v->height - static_cast<int>(row_begin));
  } else {
    v->backend->end_frame(static_cast<int>(row_begin), static_cast<int>(row_end));
  }
}

// What is written over the picture is what is to be.
bool is_text_shown(const Viewer& v) { return v.hud == v.hud_shown && note_now(v) == v.note_shown; }

// As many frames as were asked for, even of a still; with a reference beside it, when that has some samples.
constexpr std::uint32_t kSplitSamples = 32;
bool goes_on(const Viewer& v) { return v.options.frame_count > 0 && !shows_split(v); }

void write_picture_lines(const Viewer& v, const Renderer& r, ViewerLoop* loop) {
  write_hud(r, loop->progressive, loop->control.mode, &loop->hud);
  if (v.budget) write_budget_lines(*v.budget, &loop->hud);
  if (v.sharing) write_server_lines(*v.sharing, &loop->hud);
}

// Nothing has changed: the reference beside the picture is refined, or the buttons are waited for.
Status idle(Viewer* v, Renderer* r, ViewerLoop* loop) {
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
Status step_picture(Viewer* v, Renderer* r, ViewerLoop* loop) {
  // A moving camera is followed as soon as something can be seen; time waits until the picture is finished, and so does
  // everything where finished frames are counted.
  bool follow = loop->moved && loop->progressive.shown_coarse && v->options.frame_count == 0;
  if (follow || (loop->finished && (loop->moved || loop->passed))) {
    RETURN_IF_ERROR(prepare_frame(r, loop->seconds));
    loop->progressive = Progressive();
    loop->moved = loop->passed = loop->finished = false;
  }
  if (loop->finished && is_text_shown(*v)) return idle(v, r, loop);
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
Status step_budgeted(Viewer* v, Renderer* r, ViewerLoop* loop) {
  Budget* budget = v->budget;
  if (v->front_home || v->front_steps != 0) {
    move_along_front(budget, v->front_home ? 0 : v->front_steps);
    v->front_home = false;
    v->front_steps = 0;
    loop->passed = true;
  }
  if (loop->moved || loop->passed) loop->still_frames = loop->steady_frames = 0;
  bool due = loop->moved || loop->passed || (!loop->settled && v->options.frame_count == 0);
  if (!due && is_text_shown(*v)) return idle(v, r, loop);
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
Status step_shared(Viewer* v, Renderer* r, ViewerLoop* loop) {
  if (loop->finished && (loop->moved || loop->passed)) {
    RETURN_IF_ERROR(begin_shared(v->sharing, r, loop->seconds));
    loop->moved = loop->passed = loop->finished = false;
  }
  if (loop->finished && is_text_shown(*v)) return idle(v, r, loop);
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

// Who makes the next picture: with servers in reach it is complete soon, without it is refined. One that the device
// alone is still refining is left to both when a server comes into reach, as a slow device may take minutes for it. A
// camera that moves is not followed within a frame that servers share, unless they are gone.
Status step_with_servers(Viewer* v, Renderer* r, ViewerLoop* loop) {
  if (!v->picture_shared || loop->finished) tend_servers(v->sharing);
  bool any = has_servers(*v->sharing);
  bool follow = loop->moved && v->options.frame_count == 0 && (v->picture_shared || loop->progressive.shown_coarse);
  bool helped = any && !v->picture_shared && !loop->finished && loop->progressive.shown_coarse;
  bool due = follow || helped || (loop->finished && (loop->moved || loop->passed));
  if (due && v->picture_shared != any) {
    if (any && r->image.data) show_own_picture(v->sharing, *r);  // a device without the scene has none
    v->picture_shared = any;
    loop->finished = loop->passed = true;  // what was under way is given up
  }
  return v->picture_shared ? step_shared(v, r, loop) : step_picture(v, r, loop);
}

}  // namespace

void pack_picture(const Viewer& v, const Renderer& r, const Vec3* radiance, int row_begin, int row_end,
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

bool takes_memory(const platform::Backend& screen) { return std::strcmp(screen.name, "sdl2") == 0; }

Status step_viewer(Viewer* v, Renderer* r, ViewerLoop* loop) {
  if (v->budget) return step_budgeted(v, r, loop);
  return v->sharing ? step_with_servers(v, r, loop) : step_picture(v, r, loop);
}

}  // namespace pocketray
