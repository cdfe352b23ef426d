#include "session/measure.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/rng.h"
#include "engine/frame.h"
#include "session/interrupt.h"

namespace pocketray {
namespace {

Status render_once(Renderer* renderer, std::uint32_t frame, double* ns_per_pixel) {
  CHECK_GT(renderer->scene.info.frames_per_second, 0);
  double seconds = frame / static_cast<double>(renderer->scene.info.frames_per_second);
  RETURN_IF_ERROR(render_frame(renderer, seconds, Aov::none, &interrupted));
  *ns_per_pixel = renderer->timings.trace_ms * 1e6 / pixel_count(*renderer);
  return success();
}

// Renders the next frame, tracing only what may have changed since the last.
Status render_next(Renderer* renderer, std::uint32_t frame, double* ns_per_pixel) {
  double seconds = frame / static_cast<double>(renderer->scene.info.frames_per_second);
  RETURN_IF_ERROR(render_frame(renderer, changes_at(seconds, &interrupted)));
  *ns_per_pixel = renderer->timings.trace_ms * 1e6 / pixel_count(*renderer);
  return success();
}

Status measure_price(Renderer* renderer, Effect effect, double* price) {
  constexpr int kRounds = 3;  // chosen: the minimum whose median one disturbed frame does not spoil
  EffectMask mask = renderer->effects.mask;
  CHECK(has(mask, effect));
  std::uint32_t samples = renderer->settings.samples_per_pixel;
  double with[kRounds], without[kRounds];
  for (int round = 0; round < kRounds; ++round) {
    RETURN_IF_ERROR(render_once(renderer, 0, &with[round]));
    renderer->effects.mask = mask & ~bit(effect);
    if (effect == Effect::supersampling) renderer->settings.samples_per_pixel = 1;
    Status status = render_once(renderer, 0, &without[round]);
    renderer->effects.mask = mask;
    renderer->settings.samples_per_pixel = samples;
    RETURN_IF_ERROR(status);
    if (interrupted) return success();
  }
  *price = range_of(with, kRounds).median - range_of(without, kRounds).median;
  return success();
}

// Time per pixel of the spans, traced repeatedly until it takes about as long as a frame.
double trace_list(Renderer* renderer, const std::vector<Span>& spans, double fraction) {
  CHECK(fraction > 0 && fraction <= 1);
  std::uint32_t span_count = static_cast<std::uint32_t>(spans.size());
  std::uint64_t pixels = 0, begin_ns = clock_ns();
  for (int repeat = 0; repeat < static_cast<int>(1 / fraction); ++repeat) {
    SpanList list;
    list.spans = spans.data(), list.span_count = span_count;
    SpanSource source = list_source(&list);
    source.stop = &interrupted;
    trace_frame(renderer, source);
    pixels += span_pixel_count(spans.data(), span_count);
  }
  return pixels > 0 ? static_cast<double>(clock_ns() - begin_ns) / static_cast<double>(pixels) : 0;
}

}  // namespace

double pixel_count(const Renderer& renderer) {
  return static_cast<double>(renderer.settings.width) * renderer.settings.height;
}

MeasuredRange range_of(double* values, std::uint32_t count) {
  CHECK(values != nullptr);
  CHECK_GT(count, 0u);
  std::sort(values, values + count);
  return {values[0], (values[(count - 1) / 2] + values[count / 2]) / 2, values[count - 1]};
}

Measurement make_measurement(const Renderer& renderer, std::uint32_t frame_count_max) {
  CHECK_LE(frame_count_max, kFrameCountMax);
  Measurement m;
  m.frame_count_max = frame_count_max;
  m.ns_per_pixel.resize(frame_count_max);
  m.pose_ms.resize(frame_count_max);
  m.refit_ms.resize(frame_count_max);
  m.row_ns.resize(static_cast<std::size_t>(renderer.settings.height) * frame_count_max);
  std::fill_n(m.effect_price, kEffectCount, std::numeric_limits<double>::quiet_NaN());
  return m;
}

Status measure_frames(Renderer* renderer, Measurement* m) {
  CHECK_EQ(m->ns_per_pixel.size(), m->frame_count_max);
  CHECK_EQ(m->row_ns.size(), std::size_t(renderer->settings.height) * m->frame_count_max);
  double warm_up;
  m->coherent = renderer->history.state.planned;
  const auto render = m->coherent ? render_next : render_once;
  RETURN_IF_ERROR(render(renderer, 0, &warm_up));
  for (std::uint32_t frame = 0; frame < m->frame_count_max && !interrupted; ++frame) {
    RETURN_IF_ERROR(render(renderer, frame + m->coherent, &m->ns_per_pixel[frame]));
    if (interrupted) break;
    m->pixels_traced += m->coherent ? renderer->history.state.pixels_traced : renderer->image.count;
    if (m->coherent && renderer->history.state.whole_because != nullptr) {
      ++m->whole_frames;
      m->whole_because = renderer->history.state.whole_because;
    }
    for (std::uint32_t row = 0; row < renderer->settings.height; ++row)
      m->row_ns[static_cast<std::size_t>(row) * m->frame_count_max + frame] =
          static_cast<double>(renderer->row_ns[row]);
    m->trace_ns += renderer->timings.trace_ms * 1e6;
    m->pose_ms[frame] = renderer->timings.pose_ms;
    m->refit_ms[frame] = renderer->timings.refit_ms;
    m->counts = total_counts(*renderer);
    m->frame_count = frame + 1;
  }
  return success();
}

Status measure_prices(Renderer* renderer, Measurement* m) {
  for (int i = 0; i < kEffectCount; ++i) {
    Effect effect = static_cast<Effect>(i);
    if (!has(renderer->effects.mask, effect) || interrupted) continue;
    if (effect == Effect::animation) {  // posing and refitting happen before tracing
      double seconds = 1 / static_cast<double>(renderer->scene.info.frames_per_second);
      RETURN_IF_ERROR(begin_frame(renderer, {seconds}));
      m->effect_price[i] = (renderer->timings.pose_ms + renderer->timings.refit_ms) * 1e6 / pixel_count(*renderer);
      continue;
    }
    RETURN_IF_ERROR(measure_price(renderer, effect, &m->effect_price[i]));
  }
  return success();
}

std::vector<Span> sparse_spans(const Settings& settings, double fraction, bool patches) {
  CHECK(fraction > 0 && fraction <= 1);
  constexpr std::uint32_t kSeed = 1;  // arbitrary
  const std::uint32_t side = patches ? kPatchSide : 1, offset = side / 3;
  const std::uint32_t cells = (settings.width + offset) / side + 1;
  std::vector<bool> chosen(cells);
  std::vector<Span> spans;
  Rng rng = make_rng(kSeed);
  for (std::uint32_t row = 0; row < settings.height; ++row) {
    if (row == 0 || (row + offset) % side == 0)
      for (std::uint32_t i = 0; i < cells; ++i) chosen[i] = static_cast<double>(next_float(&rng)) < fraction;
    std::uint32_t end = 0;
    for (std::uint32_t begin = 0; begin < settings.width; begin = end + 1) {
      for (end = begin; end < settings.width && chosen[(end + offset) / side]; ++end) {
      }
      if (end > begin)
        spans.push_back(
            {static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(begin), static_cast<std::uint16_t>(end)});
    }
  }
  return spans;
}

Status measure_sparse(Renderer* renderer, int round_count, SparseCost* costs) {
  CHECK_GT(round_count, 0);
  CHECK(costs != nullptr);
  std::vector<Span> spans[kSparseFractionCount][2];
  std::vector<double> ns[kSparseFractionCount][2];
  for (int i = 0; i < kSparseFractionCount; ++i)
    for (bool patches : {false, true}) {
      spans[i][patches] = sparse_spans(renderer->settings, kSparseFractions[i], patches);
      ns[i][patches].resize(static_cast<std::size_t>(round_count));
    }
  RETURN_IF_ERROR(begin_frame(renderer, {0}));
  for (int round = 0; round < round_count; ++round)
    for (int i = 0; i < kSparseFractionCount; ++i)
      for (bool patches : {false, true})
        ns[i][patches][static_cast<std::size_t>(round)] = trace_list(renderer, spans[i][patches], kSparseFractions[i]);
  if (interrupted) return success();
  for (int i = 0; i < kSparseFractionCount; ++i) {
    std::uint32_t count = static_cast<std::uint32_t>(round_count);
    costs[i] = {kSparseFractions[i], range_of(ns[i][0].data(), count), range_of(ns[i][1].data(), count)};
  }
  return success();
}

double rays_per_second(const Measurement& m) {
  std::uint64_t rays = 0;
  for (std::uint64_t count : m.counts.rays) rays += count;
  return m.trace_ns > 0 ? static_cast<double>(rays) * m.frame_count / (m.trace_ns * 1e-9) : 0;
}

}  // namespace pocketray
