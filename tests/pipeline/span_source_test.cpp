// The frame loop and its sources.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/progressive.h"
#include "scene/builtin_helpers.h"
#include "session/measure.h"
#include "support/feature_sets.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

constexpr Vec3 kUntraced = {-1, -2, -3};

void clear(Renderer* renderer) {
  for (Vec3& pixel : renderer->image) pixel = kUntraced;
}

// Spans of random pixels, some of them in runs, from the top.
std::vector<Span> random_spans(const Settings& s, Rng* rng, double fraction) {
  std::vector<Span> spans;
  std::uint32_t run_max = 1 + next_u32(rng) % 12;
  for (std::uint32_t row = 0; row < s.height; ++row)
    for (std::uint32_t begin = 0; begin < s.width;) {
      std::uint32_t end = std::min(begin + 1 + next_u32(rng) % run_max, s.width);
      if (next_double(rng) < fraction)
        spans.push_back(
            {static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(begin), static_cast<std::uint16_t>(end)});
      begin = end;
    }
  return spans;
}

// The picture with only the list's pixels.
Picture masked(const Settings& s, const Picture& picture, const std::vector<Span>& spans) {
  Picture out(picture.size(), kUntraced);
  for (const Span& span : spans)
    for (std::size_t column = span.column_begin; column < span.column_end; ++column)
      out[span.row * std::size_t(s.width) + column] = picture[span.row * std::size_t(s.width) + column];
  return out;
}

Picture picture_of(const Renderer& renderer) { return Picture(renderer.image.begin(), renderer.image.end()); }

void check_sparse_lists(const Scene& scene, Settings settings, Rng* rng) {
  Picture expected = render_picture(scene, settings, 0.3);
  for (std::uint32_t threads : {1u, 2u, 4u}) {
    settings.threads = threads;
    auto test = make_renderer(scene, settings);
    Renderer* renderer = &test->renderer;
    REQUIRE(begin_frame(renderer, {0.3}).ok);
    for (double fraction : {0.02, 0.1, 0.5, 0.9}) {
      std::vector<Span> spans = random_spans(settings, rng, fraction);
      CAPTURE(threads);
      CAPTURE(fraction);
      clear(renderer);
      SpanList list;
      list.spans = spans.data(), list.span_count = static_cast<std::uint32_t>(spans.size());
      CHECK(trace_frame(renderer, list_source(&list)));
      CHECK(list.done_count == spans.size());
      CHECK(same_picture(picture_of(*renderer), masked(settings, expected, spans)));
    }
  }
}

// A handmade source: rows one by one, empty batches between them, and its own clock.
struct ByHand {
  Renderer* renderer;
  std::uint64_t now_ns = 1000, pace_ns = 0;
  std::uint32_t row = 0, next_count = 0, empty_every = 0, errand_every = 0, errand_count = 0;
  std::uint64_t took_ns = 0;
  std::atomic<bool> stop{false};
  std::uint32_t stop_after = ~0u;
};

SpanSource by_hand(ByHand* hand) {
  SpanSource source = {hand};
  source.next = [](void* context, SpanBatch* batch) {
    ByHand* h = static_cast<ByHand*>(context);
    if (h->errand_every && h->row % h->errand_every == 0)
      batch->errand = {[](void* counts) { ++static_cast<ByHand*>(counts)->errand_count; }, h};
    if (h->empty_every && ++h->next_count % h->empty_every == 0) return;
    batch->spans = &h->renderer->spans[h->row];
    batch->span_count = 1;
  };
  source.finished = [](void* context, const SpanBatch& batch) {
    ByHand* h = static_cast<ByHand*>(context);
    h->row += batch.done_count;
    h->took_ns += batch.took_ns;
    if (h->row >= h->stop_after) h->stop = true;
    return h->row == h->renderer->settings.height;
  };
  source.now_ns = [](void* context) { return static_cast<ByHand*>(context)->now_ns; };
  source.pace = [](void* context, const SpanBatch& batch, std::uint64_t begin_ns) {
    ByHand* h = static_cast<ByHand*>(context);
    CHECK(begin_ns == h->now_ns);
    std::uint64_t took = h->pace_ns * span_pixel_count(batch.spans, batch.done_count);
    h->now_ns += took;
    return took;
  };
  source.stop = &hand->stop;
  return source;
}

struct Subject {
  Settings settings;
  std::unique_ptr<GeneratedScene> generated = generate_scene(kAllFeatures, 21);
  Picture expected;
  std::unique_ptr<TestRenderer> test;
  Renderer* renderer;

  explicit Subject(std::uint32_t threads = 1) {
    settings = settings_for(kAllFeatures, 37, 29);
    settings.threads = threads;
    expected = render_picture(generated->scene, settings, 0);
    test = make_renderer(generated->scene, settings);
    renderer = &test->renderer;
    REQUIRE(begin_frame(renderer, {0}).ok);
    clear(renderer);
  }
};

}  // namespace

// Goal: any list of pixels is traced to the pixels of the whole frame, without touching others: temporal coherence
// relies on that. Method: differential, random lists of every built-in scene at odd sizes, with 1, 2 and 4 threads and
// with 1 and 3 samples.
TEST_CASE("sparse_lists_equal_the_whole_frame_on_builtin_scenes") {
  int count;
  const BuiltinScene* list = builtin_list(&count);
  Rng rng = make_rng(5);
  for (int i = 0; i < count; ++i)
    for (std::uint32_t samples : {1u, 3u}) {
      auto built = build_builtin(list[i]);
      Settings settings;
      settings.width = 61, settings.height = 43;
      if (built->scene.lights.count > 64) settings.width = 21, settings.height = 13;  // each pixel asks each light
      settings.samples_per_pixel = samples;
      CAPTURE(std::string(list[i].name));
      CAPTURE(samples);
      check_sparse_lists(built->scene, settings, &rng);
    }
}

// Goal: the same for scenes with every feature. Method: as above, generated scenes.
TEST_CASE("sparse_lists_equal_the_whole_frame_on_generated_scenes") {
  Rng rng = make_rng(6);
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    CAPTURE(seed);
    auto generated = generate_scene(kAllFeatures, seed);
    check_sparse_lists(generated->scene, settings_for(kAllFeatures, 45, 34), &rng);
  }
}

// Goal: the benchmark's lists are as described. Method: pixels in order and about the right fraction.
TEST_CASE("sparse_spans_of_the_benchmark_have_the_fraction") {
  Settings settings;
  settings.width = 317, settings.height = 241;
  for (bool patches : {false, true})
    for (double fraction : kSparseFractions) {
      std::vector<Span> spans = sparse_spans(settings, fraction, patches);
      std::uint32_t end = 0;
      for (const Span& span : spans) {
        CHECK(span.row * settings.width + span.column_begin >= end);
        CHECK(span.column_begin < span.column_end);
        CHECK(span.column_end <= settings.width);
        end = span.row * settings.width + span.column_end;
      }
      double pixels = static_cast<double>(span_pixel_count(spans.data(), static_cast<std::uint32_t>(spans.size())));
      double share = pixels / (317 * 241);
      CHECK(std::fabs(share - fraction) < (patches ? 0.08 : 0.01));
      if (fraction == 1) CHECK(spans.size() == settings.height);
    }
}

// Goal: a source without work at the moment is asked again, until it reports the frame complete. Method: rows one by
// one with empty batches between them.
TEST_CASE("frame_loop_asks_on_after_empty_batches") {
  Subject subject;
  ByHand hand;
  hand.renderer = subject.renderer, hand.empty_every = 3;
  CHECK(trace_frame(subject.renderer, by_hand(&hand)));
  CHECK(hand.next_count > subject.settings.height);
  CHECK(same_picture(picture_of(*subject.renderer), subject.expected));
}

// Goal: a batch's errand is run once, whoever traces, and not without spans. Method: an errand with every fifth row,
// one thread and four, empty batches between.
TEST_CASE("frame_loop_runs_errands_once") {
  for (std::uint32_t threads : {1u, 4u}) {
    Subject subject(threads);
    ByHand hand;
    hand.renderer = subject.renderer, hand.empty_every = 3, hand.errand_every = 5;
    CHECK(trace_frame(subject.renderer, by_hand(&hand)));
    CHECK(hand.errand_count == 6);
    CHECK(same_picture(picture_of(*subject.renderer), subject.expected));
  }
}

// Goal: a deadline ends a call after at least one batch, by the source's clock and pace, and the next call continues; a
// batch takes as long as the pace says. Method: a virtual clock, batches of 37 pixels of 10 ns.
TEST_CASE("frame_loop_keeps_a_virtual_deadline_and_pace") {
  Subject subject;
  ByHand hand;
  hand.renderer = subject.renderer, hand.pace_ns = 10;
  SpanSource source = by_hand(&hand);
  source.deadline_ns = 0;  // long past
  CHECK_FALSE(trace_frame(subject.renderer, source));
  CHECK(hand.row == 1);
  source.deadline_ns = hand.now_ns + 3 * 370;
  CHECK_FALSE(trace_frame(subject.renderer, source));
  CHECK(hand.row == 4);
  source.deadline_ns = kNoDeadline;
  CHECK(trace_frame(subject.renderer, source));
  CHECK(hand.took_ns == 370 * subject.settings.height);
  CHECK(same_picture(picture_of(*subject.renderer), subject.expected));
}

// Goal: a stop ends the loop before the next batch, and a continued frame is the same. Method: a source that stops
// itself after some rows; a list that is stopped before it begins.
TEST_CASE("frame_loop_stops_and_goes_on") {
  Subject subject;
  ByHand hand;
  hand.renderer = subject.renderer, hand.stop_after = 5;
  CHECK_FALSE(trace_frame(subject.renderer, by_hand(&hand)));
  CHECK(hand.row == 5);
  hand.stop = false, hand.stop_after = ~0u;
  CHECK(trace_frame(subject.renderer, by_hand(&hand)));
  CHECK(same_picture(picture_of(*subject.renderer), subject.expected));

  clear(subject.renderer);
  hand.stop = true;
  SpanList list = whole_frame(subject.renderer);
  SpanSource source = list_source(&list);
  source.stop = &hand.stop;
  CHECK_FALSE(trace_frame(subject.renderer, source));
  CHECK(list.done_count == 0);
  hand.stop = false;
  CHECK(trace_frame(subject.renderer, source));
  CHECK(same_picture(picture_of(*subject.renderer), subject.expected));
}

// Goal: bands report their progress and make the whole frame. Method: bands of five rows.
TEST_CASE("bands_tell_their_progress") {
  Subject subject;
  std::vector<std::uint32_t> told;
  SpanList bands = whole_frame(subject.renderer);
  bands.batch_spans = 5;
  bands.progress_context = &told;
  bands.progress = [](void* context, std::uint32_t done) {
    static_cast<std::vector<std::uint32_t>*>(context)->push_back(done);
  };
  CHECK(trace_frame(subject.renderer, list_source(&bands)));
  CHECK(told == std::vector<std::uint32_t>{5, 10, 15, 20, 25, 29});
  CHECK(same_picture(picture_of(*subject.renderer), subject.expected));
}
