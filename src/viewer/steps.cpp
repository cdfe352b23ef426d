#include "viewer/steps.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/check.h"
#include "base/seal.h"
#include "engine/frame.h"
#include "plan/resolve.h"
#include "present/repack.h"
#include "session/interrupt.h"
#include "viewer/follow.h"
#include "viewer/traced_overlay.h"

namespace pocketray {
namespace {

constexpr std::uint64_t kMillisecond = 1000000;
// Chosen: polling the buttons 40 times a second feels immediate; idle, a few times per display frame, or every second
// display frame if no button was used for a while.
constexpr std::uint64_t kSliceNs = 25 * kMillisecond;  // between two polls of the buttons
constexpr std::uint64_t kIdleNs = 8 * kMillisecond, kLongIdleNs = 33 * kMillisecond;
constexpr std::uint64_t kLongIdleAfterNs = 1000 * kMillisecond;

// End of the slice that begins now, by the clock of local frames.
std::uint64_t slice_end(const Renderer& renderer) { return renderer.pace.clock->now_ns() + kSliceNs; }

bool dims_kept_pixels(const Viewer& viewer) {
  return viewer.traced && !viewer.picture_merged && !shows_side_by_side(viewer);
}

// Packs and shows the changed rows. Returns false if the screen takes no picture now.
bool show_rows(Viewer* viewer, const Renderer& renderer, const HudText& text, std::uint32_t row_begin,
               std::uint32_t row_end) {
  CHECK(row_begin <= row_end && row_end <= renderer.settings.height);
  SealPause pause(takes_memory(*viewer->backend));
  platform::Page page = viewer->backend->begin_frame();
  if (!page.pixels) return false;
  if (page.age != 1 || quarter_turned(*viewer)) row_begin = 0, row_end = renderer.settings.height;
  std::uint32_t note = note_now(*viewer);
  HudText shown;
  if (viewer->hud) shown = text;
  if (note) add_hud_text(&shown, viewer->note.text);
  std::uint32_t covered = std::min(hud_rows(shown), renderer.settings.height);
  if (covered > 0 || viewer->hud_rows_shown > 0)
    row_begin = 0, row_end = std::max(row_end, std::max(covered, viewer->hud_rows_shown));
  // Dimming can change in any row.
  if (viewer->traced || viewer->traced_shown) row_begin = 0, row_end = renderer.settings.height;
  const Vec3* radiance = renderer.image.data;
  if (shows_side_by_side(*viewer))
    radiance = viewer->side_by_side->backend->picture(viewer->side_by_side, renderer), row_begin = 0,
    row_end = renderer.settings.height;
  std::uint64_t start = clock_ns();
  pack_picture(*viewer, renderer, radiance, static_cast<int>(row_begin), static_cast<int>(row_end), page);
  viewer->pack_ns = clock_ns() - start;
  if (dims_kept_pixels(*viewer))
    dim_kept_pixels(renderer,
                    {page.pixels, page.line_bytes, viewer->format, viewer->width, viewer->height, viewer->rotation});
  viewer->traced_shown = viewer->traced;
  draw_hud_text(shown, viewer->format, viewer->rotation, viewer->width, viewer->height, page.pixels, page.line_bytes);
  viewer->hud_shown = viewer->hud, viewer->note_shown = note, viewer->hud_rows_shown = covered;
  bool whole = quarter_turned(*viewer) || page.age != 1;
  if (whole) {
    viewer->backend->end_frame(0, screen_height(*viewer));
  } else if (viewer->rotation == Rotation::half) {
    viewer->backend->end_frame(viewer->height - static_cast<int>(row_end),
                               viewer->height - static_cast<int>(row_begin));
  } else {
    viewer->backend->end_frame(static_cast<int>(row_begin), static_cast<int>(row_end));
  }
  return true;
}

// Shows rows as show_rows() does. `whole`: the whole screen then shows the current picture.
void show_picture(Viewer* viewer, const Renderer& renderer, const HudText& text, std::uint32_t row_begin,
                  std::uint32_t row_end, bool whole) {
  if (show_rows(viewer, renderer, text, row_begin, row_end) && whole)
    show_motion(&viewer->motion, viewer->backend->now_ns());
}

// True if the overlays on the screen are up to date.
bool is_overlay_shown(const Viewer& viewer) {
  return viewer.hud == viewer.hud_shown && note_now(viewer) == viewer.note_shown &&
         viewer.traced == viewer.traced_shown;
}

// With a frame count, even a still is rendered repeatedly to reach it; with a reference, only once that has
// kSideBySideSamples. Chosen: few, so that runs with a frame count end soon; more would make the displayed error more
// certain.
constexpr std::uint32_t kSideBySideSamples = 32;
bool goes_on(const Viewer& viewer) { return viewer.options.frame_count > 0 && !shows_side_by_side(viewer); }

void write_picture_lines(const Viewer& viewer, const Renderer& renderer, ViewerLoop* loop) {
  write_hud(renderer, loop->progressive, loop->control.mode, &loop->hud);
  write_latency(viewer.motion, &loop->hud);
  if (viewer.budget) write_budget_lines(*viewer.budget, &loop->hud);
  if (viewer.servers) viewer.servers->backend->write_lines(*viewer.servers, true, &loop->hud);
}

// Without changes: refines the reference, or waits for the buttons.
Status idle(Viewer* viewer, Renderer* renderer, ViewerLoop* loop) {
  if (viewer->options.frame_count > 0 && !shows_side_by_side(*viewer)) loop->passed = true;  // hidden meanwhile
  bool refines = shows_side_by_side(*viewer) && !viewer->side_by_side->backend->is_full(*viewer->side_by_side);
  if (!refines && !viewer->side_by_side_changed) {
    bool rests = viewer->backend->now_ns() - viewer->event_ns > kLongIdleAfterNs;
    viewer->backend->sleep_ns(rests ? kLongIdleNs : kIdleNs);
    return success();
  }
  viewer->side_by_side_changed = false;
  write_picture_lines(*viewer, *renderer, loop);
  if (shows_side_by_side(*viewer)) {
    const SideBySideBackend& reference = *viewer->side_by_side->backend;
    RETURN_IF_ERROR(reference.advance(viewer->side_by_side, renderer, loop->seconds, viewer->frames_finished,
                                      clock_ns() + kSliceNs));
    reference.write_lines(*viewer->side_by_side, &loop->hud);
    if (viewer->options.frame_count > 0 && reference.samples(*viewer->side_by_side) >= kSideBySideSamples)
      loop->passed = true;
  }
  show_rows(viewer, *renderer, loop->hud, 0, renderer->settings.height);
  return success();
}

// Sets the accuracy of the next frames.
Status set_quality(Renderer* renderer, const Quality& quality) {
  Settings settings = renderer->settings;
  static_cast<Quality&>(settings) = quality;
  return change_settings(renderer, settings);
}

// Samples of each pixel of a picture that rests.
constexpr std::uint32_t kRestingSamples = kSampleCountMax;

bool can_refine(const Viewer& viewer, const Renderer& renderer, const ViewerLoop& loop) {
  if (loop.exact || viewer.picture_merged || viewer.options.frame_count > 0) return false;
  if (loop.refines || (renderer.effects.mask & kInterpolatingEffects) != 0) return true;
  // Servers are asked for pictures of the renderer's settings.
  return !viewer.servers && !viewer.options.keeps_samples && renderer.settings.samples_per_pixel < kRestingSamples;
}

// Sets the accuracy of a picture that rests: all pixels are traced, with as many samples as memory is planned for.
Status set_resting_quality(const Viewer& viewer, Renderer* renderer) {
  Quality exact = renderer->settings;
  trace_all_pixels(&exact);
  if (viewer.options.keeps_samples) return set_quality(renderer, exact);
  const std::uint32_t samples = std::exchange(exact.samples_per_pixel, kRestingSamples);
  if (set_quality(renderer, exact).ok) return success();
  exact.samples_per_pixel = samples;
  return set_quality(renderer, exact);
}

// Traces a slice of the resting picture, over one with fewer samples or with interpolated pixels.
Status refine(Viewer* viewer, Renderer* renderer, ViewerLoop* loop) {
  if (!loop->refines) {
    loop->quality = renderer->settings;
    loop->refines = true;
    RETURN_IF_ERROR(set_resting_quality(*viewer, renderer));
    RETURN_IF_ERROR(begin_frame(renderer, {loop->seconds}));
    loop->progressive = afresh();
  }
  loop->exact = advance_progressive(renderer, loop->tile_spans, slice_end(*renderer), &loop->progressive);
  write_picture_lines(*viewer, *renderer, loop);
  std::uint32_t begin = 0, end = 0;
  take_dirty_rows(&loop->progressive, &begin, &end);
  show_rows(viewer, *renderer, loop->hud, begin, end);
  return success();
}

// Marks the rows from the first to the last that the frame has traced for display.
void mark_changed_rows(const Renderer& renderer, Progressive* progressive) {
  const Coherence& c = renderer.history.coherence;
  for (std::uint32_t row = 0; row < c.tile_rows; ++row) {
    const std::uint64_t* tiles = c.changed.data + std::size_t(row) * c.tile_columns;
    if (std::all_of(tiles, tiles + c.tile_columns, [](std::uint64_t tile) { return tile == 0; })) continue;
    if (progressive->dirty_end == 0) progressive->dirty_begin = row * kChangeTileSide;
    progressive->dirty_end = std::min((row + 1) * kChangeTileSide, renderer.settings.height);
  }
}

// Traces a slice of the picture: all of it, coarse first, or only the changes.
bool advance_picture(Renderer* renderer, ViewerLoop* loop) {
  Progressive* progressive = &loop->progressive;
  History* history = &renderer->history;
  if (!history->spans.all) {
    bool complete = trace_frame(renderer, frame_source(renderer, nullptr, slice_end(*renderer)));
    progressive->pixels_traced = renderer->image.count;  // the picture has all of them
    progressive->trace_ns = history->prepare_ns + history->spent_ns;
    progressive->shown_coarse = true;
    if (complete) mark_changed_rows(*renderer, progressive);
    if (complete) progressive->step = 0;
    return complete;
  }
  const bool was_visible = progressive->shown_coarse;
  bool complete = advance_progressive(renderer, loop->tile_spans, slice_end(*renderer), progressive);
  if (!was_visible && progressive->shown_coarse) loop->coarse_ns = history->prepare_ns + progressive->trace_ns;
  if (complete) {
    history->state.pixels_traced = progressive->pixels_traced;
    progressive->trace_ns = history->prepare_ns + history->spent_ns;  // total time of the frame
  }
  return complete;
}

bool is_visible(const Renderer& renderer, const ViewerLoop& loop) {
  return loop.finished || (renderer.history.spans.all && loop.progressive.shown_coarse);
}

// Returns whether a visible picture is dropped for one with newer input, which would be visible before the rest of this
// one is traced. The remainder of a frame of changes is unknown.
bool coarse_gives_way(const Renderer& renderer, const ViewerLoop& loop) {
  const Progressive& p = loop.progressive;
  if (!p.shown_coarse) return false;
  if (!renderer.history.spans.all || p.pixels_traced == 0) return true;
  const double pixel_ns = static_cast<double>(p.trace_ns) / static_cast<double>(p.pixels_traced);
  PictureChoice choice;
  choice.left_ns = pixel_ns * static_cast<double>(renderer.image.count - p.pixels_traced);
  choice.anew_ns = static_cast<double>(loop.coarse_ns);
  return gives_way(choice);
}

// Begins the next picture once the current one is visible, traces a slice of it and shows it.
Status step_picture(Viewer* viewer, Renderer* renderer, ViewerLoop* loop) {
  // Follows a moving camera once a coarse picture is visible, unless that is finished sooner than a new one is visible.
  // Time waits for the finished picture; so does the camera if finished frames are counted.
  bool follow =
      loop->moved && viewer->options.frame_count == 0 && !loop->finished && coarse_gives_way(*renderer, *loop);
  if (follow || (loop->finished && (loop->moved || loop->passed))) {
    RETURN_IF_ERROR(end_refining(renderer, loop));
    RETURN_IF_ERROR(begin_frame(renderer, {loop->seconds, FramePurpose::changes}));
    take_motion(&viewer->motion);
    loop->progressive = Progressive();
    loop->moved = loop->passed = loop->finished = false;
  }
  if (loop->finished && can_refine(*viewer, *renderer, *loop)) return refine(viewer, renderer, loop);
  if (loop->finished && is_overlay_shown(*viewer)) return idle(viewer, renderer, loop);
  bool was_finished = loop->finished;
  if (!was_finished) loop->finished = advance_picture(renderer, loop);
  if (loop->finished && !was_finished) {
    ++viewer->frames_finished;
    if (goes_on(*viewer)) loop->passed = true;
  }
  // The cost of a frame of changes is known at its end; until then the display shows the previous frame's.
  if (loop->finished || renderer->history.spans.all) write_picture_lines(*viewer, *renderer, loop);
  std::uint32_t begin = 0, end = 0;
  take_dirty_rows(&loop->progressive, &begin, &end);
  show_picture(viewer, *renderer, loop->hud, begin, end, is_visible(*renderer, *loop));
  return success();
}

// A still is rendered repeatedly until its settings settle: kSteadyFrames with equal settings, twice as long as the
// governor waits before it tries others (kTrialPause). kStillFramesMax, chosen, ends it if noise makes two candidates
// alternate: after 4 s at 40 ms.
constexpr std::uint32_t kSteadyFrames = 16, kStillFramesMax = 100;

// Renders whole frames within a budget and shows each when complete.
Status step_budgeted(Viewer* viewer, Renderer* renderer, ViewerLoop* loop) {
  Budget* budget = viewer->budget;
  if (viewer->front_home || viewer->quality_steps != 0) {
    move_along_front(budget, viewer->front_home ? 0 : viewer->quality_steps);
    viewer->front_home = false;
    viewer->quality_steps = 0;
    loop->passed = true;
  }
  if (loop->moved || loop->passed) loop->still_frames = loop->steady_frames = 0;
  bool due = loop->moved || loop->passed || (!loop->settled && viewer->options.frame_count == 0);
  if (!due && can_refine(*viewer, *renderer, *loop)) return refine(viewer, renderer, loop);
  if (!due && is_overlay_shown(*viewer)) return idle(viewer, renderer, loop);
  std::uint32_t before = budget->last;
  std::uint64_t start = clock_ns(), traced = start;
  if (due) {
    RETURN_IF_ERROR(end_refining(renderer, loop));
    RETURN_IF_ERROR(begin_budget_frame(budget, renderer));
    take_motion(&viewer->motion);
    RETURN_IF_ERROR(render_frame(renderer, changes_at(loop->seconds, &interrupted)));
    traced = clock_ns();
    loop->progressive = {};
    loop->progressive.step = 0;
    loop->progressive.pixels_traced = std::uint64_t(renderer->settings.width) * renderer->settings.height;
    loop->progressive.trace_ns = traced - start;
    loop->moved = loop->passed = false;
  }
  write_picture_lines(*viewer, *renderer, loop);
  show_picture(viewer, *renderer, loop->hud, 0, renderer->settings.height, !interrupted);
  if (!due || interrupted) return success();
  end_budget_frame(budget, traced - start + paced_ns(renderer->pace, 0, viewer->pack_ns));
  ++viewer->frames_finished;
  loop->passed = goes_on(*viewer);
  ++loop->still_frames;
  loop->steady_frames = budget->last == before ? loop->steady_frames + 1 : 0;
  loop->settled = budget->pinned || loop->steady_frames >= kSteadyFrames || loop->still_frames >= kStillFramesMax;
  return success();
}

// Returns whether the current split frame is dropped for one with newer input. Counted frames never are.
bool split_gives_way(const Viewer& viewer, const ViewerLoop& loop) {
  if (loop.finished || !loop.moved || viewer.options.frame_count > 0 || !viewer.options.drops_frames) return false;
  const ServersState state = viewer.servers->backend->state(*viewer.servers);
  return gives_way({state.left_ns, state.anew_ns, loop.dropped && !state.coarse_shown});
}

// Traces a slice of a split frame and shows the rows finished so far from both ends.
Status step_merged(Viewer* viewer, Renderer* renderer, ViewerLoop* loop) {
  const ServersBackend& servers = *viewer->servers->backend;
  const bool drops = split_gives_way(*viewer, *loop);
  const bool was_shown = loop->coarse_shown;
  if (drops || (loop->finished && (loop->moved || loop->passed))) {
    RETURN_IF_ERROR(end_refining(renderer, loop));
    RETURN_IF_ERROR(servers.begin_frame(viewer->servers, renderer, loop->seconds));
    take_motion(&viewer->motion);
    loop->dropped = drops && !was_shown;
    viewer->frames_dropped += loop->dropped;
    loop->moved = loop->passed = loop->finished = false;
  }
  if (loop->finished && is_overlay_shown(*viewer)) return idle(viewer, renderer, loop);
  if (!loop->finished && servers.advance_frame(viewer->servers, renderer, kSliceNs, nullptr)) {
    loop->finished = true;
    ++viewer->frames_finished;
    if (goes_on(*viewer)) loop->passed = true;
  }
  loop->hud.line_count = 0;
  servers.write_lines(*viewer->servers, false, &loop->hud);
  write_latency(viewer->motion, &loop->hud);
  std::uint32_t begin = 0, end = 0;
  servers.take_rows(viewer->servers, &begin, &end);
  loop->coarse_shown = servers.state(*viewer->servers).coarse_shown;
  show_picture(viewer, *renderer, loop->hud, begin, end, loop->finished || loop->coarse_shown);
  return success();
}

// Chooses who renders the next picture: with servers in reach it completes soon, otherwise the device refines it alone.
// When a server comes into reach, a picture still being refined is restarted with it, as a slow device may take
// minutes. Within a split frame a moving camera is followed if its servers are gone, or if gives_way() says so.
Status step_with_servers(Viewer* viewer, Renderer* renderer, ViewerLoop* loop) {
  const ServersBackend& servers = *viewer->servers->backend;
  if (!viewer->picture_merged || loop->finished) servers.tend(viewer->servers);
  bool any = servers.state(*viewer->servers).in_use;
  bool follow =
      loop->moved && viewer->options.frame_count == 0 && (viewer->picture_merged || loop->progressive.shown_coarse);
  bool helped = any && !viewer->picture_merged && !loop->finished && loop->progressive.shown_coarse;
  bool due = follow || helped || (loop->finished && (loop->moved || loop->passed));
  if (due && viewer->picture_merged != any) {
    if (any && renderer->image.data) servers.show_own_picture(viewer->servers, *renderer);  // the device has the scene
    viewer->picture_merged = any;
    loop->finished = loop->passed = true;  // abandons the current picture
  }
  return viewer->picture_merged ? step_merged(viewer, renderer, loop) : step_picture(viewer, renderer, loop);
}

}  // namespace

void pack_picture(const Viewer& viewer, const Renderer& renderer, const Vec3* radiance, int row_begin, int row_end,
                  const platform::Page& page) {
  if (!viewer.picture_merged) {
    pack_rows(radiance, viewer.width, viewer.height, row_begin, row_end, display_of(renderer), viewer.format,
              viewer.rotation, viewer.options.dither, page.pixels, page.line_bytes);
    return;
  }
  CHECK(viewer.servers != nullptr);
  MergedPicture merged = viewer.servers->backend->picture(*viewer.servers);
  repack_rows(merged.format, merged.pixels, merged.line_bytes, viewer.width, viewer.height, row_begin, row_end,
              viewer.format, viewer.rotation, page.pixels, page.line_bytes);
}

Status end_refining(Renderer* renderer, ViewerLoop* loop) {
  const bool refines = loop->refines;
  loop->refines = loop->exact = false;
  return refines ? set_quality(renderer, loop->quality) : success();
}

bool takes_memory(const platform::Backend& screen) { return std::strcmp(screen.name, "sdl2") == 0; }

Status step_viewer(Viewer* viewer, Renderer* renderer, ViewerLoop* loop) {
  CHECK(viewer->backend != nullptr);
  CHECK_GE(loop->tile_spans.count, progressive_spans_max(renderer->settings));
  if (viewer->budget) return step_budgeted(viewer, renderer, loop);
  return viewer->servers ? step_with_servers(viewer, renderer, loop) : step_picture(viewer, renderer, loop);
}

}  // namespace pocketray
