// Coarse-to-fine frames: every picture on the way, and what they cost.
#include "engine/progressive.h"

#include <doctest/doctest.h>

#include <string>

#include "effect/setting_list.h"
#include "scene/builtin_helpers.h"
#include "support/effort.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

Settings sized(std::uint32_t width, std::uint32_t height) { return settings_for(kAllFeatures, width, height); }

struct Steps {
  Renderer* renderer;
  std::vector<Span> spans = std::vector<Span>(progressive_spans_max(renderer->settings));
  Progressive progressive = {};
  bool advance() {
    return advance_progressive(renderer, {spans.data(), static_cast<std::uint32_t>(spans.size())}, 0, &progressive);
  }
};

// Whether rows [begin, end) show the pixels of a grid, each as a square.
bool shows_cells(const Renderer& renderer, const Picture& expected, std::uint32_t step, std::uint32_t begin,
                 std::uint32_t end) {
  for (std::size_t row = begin; row < end; ++row)
    for (std::size_t column = 0; column < renderer.settings.width; ++column) {
      const std::size_t from = (row - row % step) * renderer.settings.width + column - column % step;
      const Vec3 &shown = renderer.image[row * renderer.settings.width + column], &wanted = expected[from];
      if (!(shown.x == wanted.x && shown.y == wanted.y && shown.z == wanted.z)) return false;
    }
  return true;
}

// Refines a frame batch by batch and checks the picture after each.
void check_steps(Renderer* renderer, const Picture& expected, const std::vector<std::uint32_t>& wanted_steps) {
  const std::uint32_t width = renderer->settings.width, height = renderer->settings.height;
  REQUIRE(begin_frame(renderer, {0.3}).ok);
  for (Vec3& pixel : renderer->image) pixel = {-1, -1, -1};
  std::vector<std::uint64_t> row_ns(height, 0);
  Steps steps = {renderer};
  steps.progressive.row_ns = row_ns.data();
  std::vector<std::uint32_t> seen;
  std::uint64_t pixels = 0;
  for (bool finished = false; !finished;) {
    const std::uint32_t step = steps.progressive.step;
    if (seen.empty() || seen.back() != step) {
      if (!seen.empty()) CHECK(shows_cells(*renderer, expected, seen.back(), 0, height));
      CHECK(steps.progressive.shown_coarse == !seen.empty());
      seen.push_back(step);
    }
    finished = steps.advance();
    CHECK(steps.progressive.pixels_traced >= pixels);
    CHECK(steps.progressive.pixels_traced <=
          pixels + 64 * (renderer->settings.threads > 1 ? 8 * renderer->settings.threads : 4));
    pixels = steps.progressive.pixels_traced;
    CHECK(shows_cells(*renderer, expected, 1, 0, finished_rows(*renderer, steps.progressive)));
    std::uint32_t begin = 0, end = 0;
    CHECK(take_dirty_rows(&steps.progressive, &begin, &end));
    CHECK(begin < end);
    CHECK(end <= height);
    CHECK(end - begin <= 8 * step);
  }
  CHECK(seen == wanted_steps);
  CHECK(finished_rows(*renderer, steps.progressive) == height);
  CHECK(shows_cells(*renderer, expected, 1, 0, height));
  CHECK(pixels == std::uint64_t(width) * height);
  std::uint64_t sum = 0;
  for (std::uint64_t ns : row_ns) {
    CHECK(ns > 0);
    sum += ns;
  }
  CHECK(sum == steps.progressive.trace_ns);
  CHECK(steps.advance());
}

struct Work {
  std::uint64_t nodes, triangles, rays, primary;
};
Work operator-(const Work& a, const Work& b) {
  return {a.nodes - b.nodes, a.triangles - b.triangles, a.rays - b.rays, a.primary - b.primary};
}
bool operator==(const Work& a, const Work& b) {
  return a.nodes == b.nodes && a.triangles == b.triangles && a.rays == b.rays && a.primary == b.primary;
}
Work work_of(const Renderer& renderer) {
  const Tracer counts = total_counts(renderer);
  Work work = {counts.stats.nodes, counts.stats.triangles, 0, counts.rays[static_cast<int>(RayKind::primary)]};
  for (std::uint64_t rays : counts.rays) work.rays += rays;
  return work;
}

}  // namespace

// Goal: every picture on the way shows the final values of its grid, and the last is that of a direct frame; rows,
// pixels and costs are counted. Method: differential, stopped at every batch; sizes of no whole tiles, a row, a column
// and a pixel; packets, single rays, an orthographic camera.
TEST_CASE("progressive_shows_final_pixels_in_every_picture") {
  auto generated = generate_scene(kAllFeatures, 31);
  const std::uint32_t large[] = {effort_side(70), effort_side(61)};
  const std::uint32_t sizes[][2] = {{45, 34}, {64, 16}, {large[0], large[1]}, {131, 12}, {19, 1}, {1, 19}, {1, 1}};
  for (bool orthographic : {false, true}) {
    if (orthographic)
      for (Camera& camera : generated->cameras)
        camera.projection = Projection::orthographic, camera.vertical_extent = 5;
    for (const auto& size : sizes)
      for (std::uint32_t threads : {1u, 3u})
        for (const AccelInfo* accel : {&kBvhAccel, &kBruteAccel}) {
          const std::string what = accel->name;
          CAPTURE(what);
          CAPTURE(size[0]);
          CAPTURE(size[1]);
          CAPTURE(threads);
          CAPTURE(orthographic);
          Settings settings = sized(size[0], size[1]);
          const Picture expected = render_picture(generated->scene, settings, 0.3);
          settings.threads = threads;
          auto test = make_renderer(generated->scene, settings, accel);
          if (accel->packets_by_rays || orthographic)
            check_steps(&test->renderer, expected, {8, 4, 2, 1});
          else
            check_steps(&test->renderer, expected, {8, 1});
        }
  }
}

// Goal: the same where pixels share virtual lights in blocks. Method: as above.
TEST_CASE("progressive_shows_final_pixels_lit_by_virtual_lights") {
  auto built = build_builtin("cornell");
  for (std::uint32_t threads : {1u, 3u}) {
    Settings settings;
    settings.width = 45, settings.height = 34;
    settings.indirect = indirect_choice(Effect::instant_radiosity), settings.virtual_lights = 16;
    const Picture expected = render_picture(built->scene, settings, 0.3);
    settings.threads = threads;
    auto test = make_renderer(built->scene, settings);
    CHECK(has(test->renderer.effects.mask, Effect::instant_radiosity));
    check_steps(&test->renderer, expected, {8, 1});
  }
}

// Goal: threads divide a frame, and a few rows of one, without more work: into whole tiles. Method: boxes, triangles
// and rays counted, exactly, of all rows and of the eight that a server traces at once.
TEST_CASE("threads_divide_rows_by_tiles") {
  for (const char* name : {"cornell", "seesaw"})
    for (std::uint32_t row_count : {8u, 75u}) {
      auto built = build_builtin(name);
      Settings settings;
      settings.width = 100, settings.height = 75;
      Work alone = {};
      for (std::uint32_t threads : {1u, 2u, 3u, 6u}) {
        CAPTURE(name);
        CAPTURE(row_count);
        CAPTURE(threads);
        settings.threads = threads;
        auto test = make_renderer(built->scene, settings);
        REQUIRE(begin_frame(&test->renderer, {0.3}).ok);
        SpanList list = whole_frame(&test->renderer);
        list.spans += settings.height - row_count, list.span_count = row_count;
        CHECK(trace_frame(&test->renderer, list_source(&list)));
        const Work work = work_of(test->renderer);
        if (threads == 1) alone = work;
        CHECK(work == alone);
      }
    }
}

// Goal: refining a frame costs little more than rendering it, however many threads: the fine tiles are those of a
// direct frame, and the coarse picture takes a ray in 64. Where rays are traced one by one, nothing is traced twice.
// Method: boxes, triangles and rays counted, exactly; a band of few rows included.
TEST_CASE("progressive_refines_with_the_work_of_a_direct_frame") {
  for (const char* name : {"cornell", "seesaw"}) {
    auto built = build_builtin(name);
    for (std::uint32_t height : {48u, 75u, 84u})
      for (const AccelInfo* accel : {&kBvhAccel, &kGridAccel}) {
        Settings settings;
        settings.width = 100, settings.height = height;
        auto direct = make_renderer(built->scene, settings, accel);
        REQUIRE(render_frame(&direct->renderer, 0.3).ok);
        const Work whole = work_of(direct->renderer);
        for (std::uint32_t threads : {1u, 2u, 3u}) {
          CAPTURE(name);
          CAPTURE(height);
          CAPTURE(threads);
          const std::string what = accel->name;
          CAPTURE(what);
          settings.threads = threads;
          auto test = make_renderer(built->scene, settings, accel);
          Renderer* renderer = &test->renderer;
          REQUIRE(begin_frame(renderer, {0.3}).ok);
          Steps steps = {renderer};
          while (!steps.progressive.shown_coarse) steps.advance();
          const Work coarse = work_of(*renderer);
          CHECK(coarse.primary == std::uint64_t(13) * ((height + 7) / 8));
          while (!steps.advance()) {
          }
          if (accel->packets_by_rays) {
            CHECK(work_of(*renderer).rays == whole.rays);
          } else {
            CHECK(work_of(*renderer) - coarse == whole);
          }
        }
      }
  }
}
