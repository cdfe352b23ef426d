// Pairs of features render what their declarations promise: however a frame is traced, its bits are those of the frame
// traced whole.
#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <string>

#include "engine/frame.h"
#include "engine/light_map.h"
#include "engine/progressive.h"
#include "engine/shared_rows.h"
#include "plan/resolve.h"
#include "support/generated_scene.h"
#include "support/test_environment.h"

using namespace pocketray;

namespace {

constexpr std::uint32_t kWidth = 28, kHeight = 21;

// What a case renders. Features change it before the renderers are made.
struct Case {
  std::unique_ptr<GeneratedScene> made;
  TestEnvironment environment = even_environment({0.4f, 0.5f, 0.6f});
  std::vector<std::uint32_t> places;
  std::vector<Vec3> values;
  RadiosityInfo radiosity = {{1e6f, 1e6f, 1e6f}};
  Settings settings;
};

// Renders the frame at a time into the renderer's image. Returns whether it is as promised beside the whole frame.
using Way = bool (*)(Renderer* renderer, const Picture& whole, double seconds);

struct Paired {
  const char* name;
  EffectMask effects;  // that it turns on
  void (*apply)(Case* c);
  Way way;  // null: as any frame
};

bool same_bits(const Renderer& renderer, const Picture& whole) {
  return same_picture({renderer.image.begin(), renderer.image.end()}, whole);
}

bool render_whole(Renderer* renderer, const Picture& whole, double seconds) {
  return render_frame(renderer, seconds).ok && same_bits(*renderer, whole);
}

bool render_changes(Renderer* renderer, const Picture& whole, double seconds) {
  if (!render_frame(renderer, changes_at(seconds)).ok) return false;
  const bool follows = !unfollowed_because(renderer->effects.mask);
  return renderer->history.state.planned == follows && same_bits(*renderer, whole);
}

bool render_steps(Renderer* renderer, const Picture& whole, double seconds) {
  if (!begin_frame(renderer, {seconds}).ok) return false;
  std::vector<Span> spans(progressive_spans_max(renderer->settings));
  Progressive progressive;
  while (!advance_progressive(renderer, {spans.data(), static_cast<std::uint32_t>(spans.size())}, 0, &progressive)) {
  }
  return same_bits(*renderer, whole);
}

bool trace_list(Renderer* renderer, const Span* spans, std::uint32_t count, Aov aov = Aov::none) {
  SpanList list;
  list.spans = spans, list.span_count = count;
  SpanSource source = list_source(&list);
  source.aov = aov;
  return trace_frame(renderer, source);
}

// The lower rows first, as a server begins with the last ones.
bool render_rows(Renderer* renderer, const Picture& whole, double seconds) {
  if (!begin_frame(renderer, {seconds, FramePurpose::shared_rows}).ok) return false;
  while (!search_shared_rows(renderer, 200)) {
  }
  for (std::uint32_t begin : {kHeight / 2, 0u}) {
    const std::uint32_t end = begin ? kHeight : kHeight / 2;
    for (std::uint32_t row = begin; row < end;) {
      const std::uint32_t last = std::min(end, row + listed_rows_max(*renderer));
      const SharedSpans spans = list_rows(renderer, row, last);
      if (spans.count > 0 && !trace_list(renderer, spans.spans, spans.count)) return false;
      row = last;
    }
    finish_shared_rows(renderer, begin, end);
  }
  return same_bits(*renderer, whole);
}

// False colours of single pixels are those of the whole picture, and leave nothing behind for the next frame.
bool render_depth(Renderer* renderer, const Picture&, double seconds) {
  if (!render_frame(renderer, seconds, Aov::depth).ok) return false;
  const Picture depth(renderer->image.begin(), renderer->image.end());
  for (Vec3& pixel : renderer->image) pixel = {-1, -1, -1};
  for (std::uint32_t row = kHeight; row-- > 0;)
    for (std::uint32_t begin = 0; begin < kWidth; begin += 5) {
      const Span span = row_span(row, begin, std::min(begin + 5, kWidth));
      if (!trace_list(renderer, &span, 1, Aov::depth)) return false;
    }
  return same_bits(*renderer, depth);
}

// A map of the frame's own light changes nothing but by rounding, unless an effect declares that it cannot have one.
// Stored radiosity is never the device's own light beside a map: own_indirect().
bool render_with_map(Renderer* renderer, const Picture& whole, double seconds) {
  std::vector<Hit> hits(first_hit_count(renderer->settings));
  FrameTask task = {seconds};
  task.first_hits = hits.data();
  if (!begin_frame(renderer, task).ok) return false;
  SpanList list = whole_frame(renderer);
  if (!trace_frame(renderer, list_source(&list)) || !same_bits(*renderer, whole)) return false;
  if (unshared_because(renderer->effects.mask) || has(renderer->effects.mask, Effect::radiosity)) return true;
  const LightGrid grid = light_grid(renderer->settings, 3);
  std::vector<MappedSurface> surfaces(light_count(grid));
  std::vector<Vec3> lights(light_count(grid));
  take_mapped_surfaces(renderer, hits.data(), kHeight, grid, surfaces.data());
  for (std::uint32_t i = 0; i < light_count(grid); ++i) {
    const std::uint32_t row = i / grid.columns * 3, column = i % grid.columns * 3;
    const Span span = row_span(row, column, column + 1);
    trace_spans(&renderer->tracers[0], &span, 1, Aov::indirect_light, renderer->image.data);
    lights[i] = renderer->image[row * kWidth + column];
  }
  std::copy(whole.begin(), whole.end(), renderer->image.begin());
  const LightMap map = {grid, renderer->frame.view.camera, seconds, surfaces.data(), lights.data()};
  add_mapped_light(renderer, hits.data(), map, 0, kHeight);
  for (std::size_t i = 0; i < whole.size(); ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::fabs(renderer->image[i][k] - whole[i][k]) <= 1e-5f * (1 + whole[i][k]))) return false;
  return true;
}

void use_virtual_lights(Case* c) { c->settings.indirect = indirect_choice(Effect::instant_radiosity); }

const Paired kFeatures[] = {
    {"selective", bit(Effect::selective), [](Case* c) { c->settings.selective_contrast = 0.3f; }, nullptr},
    {"undersampling", bit(Effect::undersampling), [](Case* c) { c->settings.resolution = Resolution::checkerboard; },
     nullptr},
    {"coherence", 0, [](Case* c) { c->settings.coherence = CoherenceMode::on; }, render_changes},
    {"instant radiosity", bit(Effect::instant_radiosity), use_virtual_lights, nullptr},
    {"radiosity", bit(Effect::radiosity),
     [](Case* c) {
       Scene& scene = c->made->scene;
       c->places.assign(scene.triangles.count, kRadiosityAtVertices);
       for (std::uint32_t i = 0; i < scene.positions.count; ++i)
         c->values.push_back(Vec3{1, 0.8f, 0.6f} * (0.1f + 0.02f * static_cast<float>(i % 9)));
       scene.radiosity_info = {&c->radiosity, 1};
       scene.radiosity_triangles = {c->places.data(), scene.triangles.count};
       scene.radiosity_values = {c->values.data(), scene.positions.count};
     },
     nullptr},
    {"compensation", bit(Effect::instant_radiosity),
     [](Case* c) { use_virtual_lights(c), c->settings.compensation = Compensation::rays; }, nullptr},
    {"environment shadows", bit(Effect::environment_shadow), [](Case* c) { c->environment.give(&c->made->scene); },
     nullptr},
    {"source selection", bit(Effect::source_selection),
     [](Case* c) {
       for (int i = 0; i < 20; ++i) {
         Light light;
         light.position = {static_cast<float>(i % 5) - 2, 3, static_cast<float>(i / 5) - 2};
         light.intensity = {0.3f, 0.3f, 0.2f};
         c->made->lights.push_back(light);
       }
       c->made->bind();
     },
     nullptr},
    {"light maps", 0, [](Case*) {}, render_with_map},
    {"rows shared", 0, [](Case*) {}, render_rows},
    {"samples", bit(Effect::supersampling), [](Case* c) { c->settings.samples_per_pixel = 3; }, nullptr},
    {"edge samples", bit(Effect::edge_sampling), [](Case* c) { c->settings.edge_samples = 4; }, nullptr},
    {"orthographic", 0,
     [](Case* c) {
       Camera& camera = c->made->cameras[0];
       camera.projection = Projection::orthographic;
       camera.vertical_extent = 0.6f * length(camera.target - camera.eye);
     },
     nullptr},
    {"false colours", 0, [](Case*) {}, render_depth},
    {"progressive", 0, [](Case*) {}, render_steps},
};

bool are_methods(const Paired& a, const Paired& b) {
  const EffectMask both = kIndirectEffects & (a.effects | b.effects);
  return (both & (both - 1)) != 0;  // one method at a time
}

// The effects that a pair turns on, less those that yield.
EffectMask declared(const Paired& a, const Paired& b) {
  const EffectMask asked = a.effects | b.effects;
  EffectMask on = 0;
  for (const EffectRow& row : kEffectList)
    if ((asked & bit(row.effect)) && !(row.yields_to & on)) on |= bit(row.effect);
  return on;
}

void check_pair(const Paired& a, const Paired& b, std::uint32_t features, std::uint64_t seed) {
  Case c;
  c.made = generate_scene(features, seed);
  c.settings = settings_for(features, kWidth, kHeight);
  c.settings.virtual_lights = 32;
  for (const Paired* feature : {&b, &a})  // source selection binds the scene anew
    feature->apply(&c);
  const Scene scene = c.made->scene;
  auto whole = make_renderer(scene, c.settings), tested = make_renderer(scene, c.settings);
  CHECK((whole->renderer.effects.mask & (a.effects | b.effects)) == declared(a, b));
  const Way ways[] = {a.way ? a.way : render_rows, b.way ? b.way : a.way ? a.way : render_whole};
  for (int frame = 0; frame < 4; ++frame) {
    CAPTURE(frame);
    const double seconds = 0.1 * (frame / 2);  // each way sees a frame that stands still and one that moves
    REQUIRE(render_frame(&whole->renderer, seconds).ok);
    const Picture picture(whole->renderer.image.begin(), whole->renderer.image.end());
    CHECK(ways[frame % 2](&tested->renderer, picture, seconds));
  }
}

}  // namespace

// Goal: every pair of features that may be used together keeps the promise of its declarations: the same bits as the
// whole frame, or the stated bound. Method: each pair in two scenes, still and moving; the ways of tracing of a pair
// take turns on one renderer, so that one would see what the other leaves behind.
TEST_CASE("pairs_render_what_they_declare") {
  const std::uint32_t some =
      bit(Feature::emission) | bit(Feature::mirror) | bit(Feature::animation) | bit(Feature::ambient);
  const std::uint32_t all = kAllFeatures & ~bit(Feature::supersampling);
  int pairs = 0;
  for (const Paired& a : kFeatures)
    for (const Paired& b : kFeatures) {
      if (&b <= &a || are_methods(a, b)) continue;
      CAPTURE(std::string(a.name));
      CAPTURE(std::string(b.name));
      check_pair(a, b, some, 5), check_pair(a, b, all, 3);
      ++pairs;
    }
  CHECK(pairs == 103);  // of 105; radiosity replaces virtual lights, with compensation or not
}
