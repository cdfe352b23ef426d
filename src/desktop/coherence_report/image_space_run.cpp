#include "desktop/coherence_report/image_space_run.h"

#include <algorithm>

#include "base/check.h"
#include "desktop/accuracy/display.h"
#include "desktop/accuracy/flip.h"
#include "desktop/accuracy/text.h"
#include "engine/frame.h"
#include "session/interrupt.h"

namespace pocketray {
namespace {

constexpr OutputFormat kShown = {"rgb888", kRgb888, false};
constexpr std::uint64_t kSeed = 1988;

// Traces pixels of frames with a renderer, posed again whenever the frame changes.
struct PixelTracer {
  Renderer* renderer;
  bool posed = false;
  std::uint32_t frame = 0;  // the frame that it is posed for
  std::uint64_t rays = 0;   // of all previous frames
  std::vector<Span> spans;
};

// Converts pixels to spans, each a run of a row.
void list_spans(const PixelList& pixels, std::uint32_t width, std::vector<Span>* spans) {
  spans->clear();
  for (std::size_t i = 0, end; i < pixels.size(); i = end) {
    const std::uint32_t row = pixels[i] / width;
    for (end = i + 1; end < pixels.size() && pixels[end] == pixels[end - 1] + 1 && pixels[end] / width == row;) ++end;
    const std::uint32_t column = pixels[i] % width;
    spans->push_back({static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(column),
                      static_cast<std::uint16_t>(column + (end - i))});
  }
}

Status trace_pixels(PixelTracer* tracer, std::uint32_t frame, const PixelList& pixels, FrameImage* image) {
  Renderer* renderer = tracer->renderer;
  if (!tracer->posed || tracer->frame != frame) {
    if (tracer->posed) tracer->rays += ray_count(*renderer);
    RETURN_IF_ERROR(begin_frame(renderer, {seconds_of(*renderer, frame)}));
    tracer->posed = true, tracer->frame = frame;
  }
  CHECK(renderer->frame.kernels.trace_strip == nullptr);  // pixels would depend on their neighbours
  list_spans(pixels, renderer->settings.width, &tracer->spans);
  SpanList list;
  list.spans = tracer->spans.data(), list.span_count = static_cast<std::uint32_t>(tracer->spans.size());
  SpanSource source = list_source(&list);
  source.stop = &interrupted;
  trace_frame(renderer, source);
  for (std::uint32_t pixel : pixels) (*image)[pixel] = renderer->image[pixel];
  return success();
}

// Images of a group: the previous group's last frame, then its own frames.
using Group = std::vector<FrameImage>;

struct WayState {
  BadtState badt;
  FrameImage last;  // of Chapman's frames
};

Status run_badt(const TracePixels& trace, std::uint32_t first, std::uint32_t divisor, BadtState* state, Group* group,
                std::vector<std::uint64_t>* traced) {
  CHECK_EQ(traced->size(), group->size());
  for (std::size_t i = 1; i < group->size(); ++i) {
    RETURN_IF_ERROR(badt_frame(trace, first + static_cast<std::uint32_t>(i), 1.0 / divisor, state, &(*traced)[i]));
    (*group)[i] = state->image;
  }
  return success();
}

Status run_chapman(const TracePixels& trace, std::uint32_t first, std::uint32_t step, FrameImage* last, Group* group,
                   std::vector<std::uint64_t>* traced) {
  CHECK_EQ(traced->size(), group->size());
  CHECK_GT(step, 0u);
  group->front() = *last;
  for (std::size_t begin = 0, end; begin + 1 < group->size(); begin = end) {
    end = std::min(begin + step, group->size() - 1);
    RETURN_IF_ERROR(chapman_frames(trace, first + static_cast<std::uint32_t>(begin), end - begin + 1, &(*group)[begin],
                                   &(*traced)[begin]));
  }
  *last = group->back();
  return success();
}

Status run_way(const ImageSpaceWay& way, Renderer* renderer, std::uint32_t first, WayState* state, Group* group,
               RenderCost* cost, std::uint64_t* traced_sum) {
  std::vector<std::uint64_t> traced(group->size());
  PixelTracer tracer = {renderer, false, 0, 0, {}};
  const TracePixels trace = [&tracer](std::uint32_t frame, const PixelList& pixels, FrameImage* image) {
    return trace_pixels(&tracer, frame, pixels, image);
  };
  const Stopwatch watch;
  RETURN_IF_ERROR(way.method == ImageSpaceMethod::badt
                      ? run_badt(trace, first, way.parameter, &state->badt, group, &traced)
                      : run_chapman(trace, first, way.parameter, &state->last, group, &traced));
  stop(watch, cost);
  cost->rays = tracer.rays + (tracer.posed ? ray_count(*renderer) : 0);
  *traced_sum = 0;
  for (std::uint64_t count : traced) *traced_sum += count;
  return success();
}

Status run_whole(Renderer* renderer, std::uint32_t frame, FrameImage* image, RenderCost* cost) {
  const Stopwatch watch;
  RenderCost spent;
  RETURN_IF_ERROR(render_frame(renderer, seconds_of(*renderer, frame), Aov::none, &interrupted));
  stop(watch, &spent);
  spent.rays = ray_count(*renderer);
  image->assign(renderer->image.begin(), renderer->image.end());
  add(spent, cost);
  return success();
}

// Begins with the first frame, which each variant traces whole.
void begin_ways(const FrameImage& first, const RenderCost& cost, ImageSpaceRun* run, std::vector<WayState>* states) {
  for (const ImageSpaceWay& way : kImageSpaceWays) {
    run->ways.push_back({way, cost, first.size(), {}});
    states->push_back({{run->width, run->height, first, {}, make_rng(kSeed)}, first});
  }
  run->whole = cost, run->frame_count = 1;
}

}  // namespace

void add_errors(const FrameImage& whole, const FrameImage& image, std::uint32_t width, std::uint32_t height,
                const Display& display, ImageSpaceErrors* errors) {
  CHECK_EQ(whole.size(), std::size_t(width) * height);
  CHECK_EQ(image.size(), whole.size());
  std::uint64_t wrong = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) wrong += differs(whole[i], image[i]);
  errors->wrong += wrong, errors->wrong_most = std::max(errors->wrong_most, wrong);
  if (wrong == 0) return;
  const Levels truth = displayed_levels(whole.data(), width, height, display, kShown);
  const Levels shown = displayed_levels(image.data(), width, height, display, kShown);
  std::uint64_t wrong_shown = 0;
  for (std::size_t i = 0; i < whole.size(); ++i)
    wrong_shown += !std::equal(&truth.rgb[3 * i], &truth.rgb[3 * i] + 3, &shown.rgb[3 * i]);
  errors->wrong_shown += wrong_shown;
  if (wrong_shown == 0) return;
  const std::vector<float> flip =
      flip_errors(encoded_levels(truth), encoded_levels(shown), width, height, kHandheldPixelsPerDegree);
  errors->flip_sum += mean_of(flip);
  errors->flip_max = std::max(errors->flip_max, double(*std::max_element(flip.begin(), flip.end())));
}

std::uint64_t image_space_step_count(const FrameRange& range) {
  return (std::uint64_t(range.last) - range.first + 1) * (1 + std::size(kImageSpaceWays));
}

Status run_image_space(Renderer* renderer, const FrameRange& range, Progress* progress, ImageSpaceRun* run) {
  CHECK_LE(range.first, range.last);
  CHECK(!renderer->history.state.planned);
  run->width = renderer->settings.width, run->height = renderer->settings.height;
  Group whole(1), group;
  RenderCost cost;
  std::vector<WayState> states;
  RETURN_IF_ERROR(run_whole(renderer, range.first, &whole[0], &cost));  // touches the memory
  cost = RenderCost();
  RETURN_IF_ERROR(run_whole(renderer, range.first, &whole[0], &cost));
  if (interrupted) return success();
  begin_ways(whole[0], cost, run, &states);
  std::uint64_t done = 1 + run->ways.size();
  for (std::uint32_t first = range.first, count; first < range.last; first += count) {
    count = std::min(kGroupFrames, range.last - first);
    whole.resize(count + 1), group.resize(count + 1);
    ImageSpaceRun next = *run;
    for (std::uint32_t i = 1; i <= count; ++i) RETURN_IF_ERROR(run_whole(renderer, first + i, &whole[i], &next.whole));
    show_progress(progress, done += count);
    for (std::size_t i = 0; i < next.ways.size() && !interrupted; ++i) {
      ImageSpaceFigures* f = &next.ways[i];
      std::uint64_t traced;
      RETURN_IF_ERROR(run_way(f->way, renderer, first, &states[i], &group, &cost, &traced));
      CHECK_LE(traced, (std::uint64_t(count) + 1) * whole[0].size());
      add(cost, &f->cost), f->traced += traced;
      for (std::uint32_t k = 1; k <= count; ++k)
        add_errors(whole[k], group[k], run->width, run->height, display_of(*renderer), &f->errors);
      show_progress(progress, done += count);
    }
    if (interrupted) break;
    next.frame_count += count;
    *run = std::move(next);
    whole[0].swap(whole[count]);
  }
  return success();
}

std::string name_of(const ImageSpaceWay& way) {
  return way.method == ImageSpaceMethod::badt ? format("Badt 1988, 1/%u of the pixels sampled", way.parameter)
                                              : format("Chapman 1990, frames %u apart", way.parameter);
}

}  // namespace pocketray
