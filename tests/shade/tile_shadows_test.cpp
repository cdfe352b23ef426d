#include "shade/tile_shadows.h"

#include <doctest/doctest.h>

#include "shade/filters.h"
#include "shade/shade_helpers.h"
#include "shade/trace_spans.h"
#include "support/effort.h"

using namespace pocketray;

namespace {

// The frame that the renderer is ready for, traced by one thread, whose tracer keeps the scratch of its selection.
Picture trace_all(const FrameData& frame, Tracer* tracer) {
  Picture picture(std::size_t(frame.settings.width) * frame.settings.height);
  std::vector<Span> spans;
  for (int row = 0; row < static_cast<int>(frame.settings.height); ++row)
    spans.push_back({static_cast<std::uint16_t>(row), 0, static_cast<std::uint16_t>(frame.settings.width)});
  const Array<LightEntry> entries = tracer->light_entries;
  *tracer = make_tracer(frame), tracer->light_entries = entries;
  trace_spans(tracer, spans.data(), static_cast<std::uint32_t>(spans.size()), Aov::none, picture.data());
  return picture;
}

}  // namespace

// Goal: shadow rays that a tile traces in packets before shading needs them change neither pixels nor the number of
// rays requested. Method: generated scenes with every feature in turn, and one with more lights than tiles handle, with
// and without packets.
TEST_CASE("tile_shadows_change_no_pixel") {
  for (std::uint32_t seed = 0; seed < static_cast<std::uint32_t>(effort(24)); ++seed) {
    CAPTURE(seed);
    auto scene = generate_scene(seed % 2 ? ~0u : 1u << seed / 2 % 20 | 1u << seed % 7, seed);
    if (seed % 4 == 0) {
      Light light;
      light.kind = LightKind::point, light.intensity = {0.2f, 0.2f, 0.2f};
      Rng rng = make_rng(seed);
      while (scene->lights.size() <= kTileLightMax + 3) {
        light.position = {4 * next_float(&rng) - 2, 4 * next_float(&rng), 4 * next_float(&rng) - 2};
        scene->lights.push_back(light);
      }
      scene->bind();
    }
    Status status;
    Settings settings = settings_for(seed, 48, 40);
    settings.light_tolerance = 0, settings.area_shadows = AreaShadows::every;
    auto test = make_renderer(scene->scene, settings, nullptr, &status);
    REQUIRE_MESSAGE(status.ok, status.message);
    REQUIRE(render_frame(&test->renderer, 0, Aov::none).ok);
    FrameData frame = test->renderer.frame;
    make_filters(&frame);
    Tracer in_packets, one_by_one;
    Picture expected = trace_all(frame, &in_packets);
    frame.kernels.find_shadows = nullptr;
    CHECK(same_picture(expected, trace_all(frame, &one_by_one)));
    for (int kind = 0; kind < kRayKindCount; ++kind) CHECK(in_packets.rays[kind] == one_by_one.rays[kind]);
  }
}

// Goal: a tile's results are used for its first hits only. Method: one pixel's results, requested for its light and for
// others, beyond those known, too; surfaces that differ in one respect.
TEST_CASE("tile_shadows_are_known_at_first_hits_alone") {
  TileShadows shadows = {};
  shadows.traced[2].set(5), shadows.blocked[2].set(5), shadows.traced[3].set(5);
  Tracer tracer;
  bool blocked = false;
  CHECK_FALSE(is_known(tracer, 2, &blocked));
  tracer.tile_shadows = &shadows, tracer.tile_pixel = 5;
  CHECK((is_known(tracer, 2, &blocked) && blocked));
  CHECK((is_known(tracer, 3, &blocked) && !blocked));
  CHECK_FALSE(is_known(tracer, 1, &blocked));
  CHECK_FALSE(is_known(tracer, kTileLightMax, &blocked));
  Surface first = {};
  first.hit = {0.25f, 0.5f, 7}, first.front = true;
  Surface same = first, other_u = first, other_v = first, other_triangle = first, other_side = first;
  same.point = {1, 2, 3};  // met by another ray
  other_u.hit.u = 0.5f, other_v.hit.v = 0.25f, other_triangle.hit.triangle = 8, other_side.front = false;
  CHECK(same_surface(first, same));
  for (const Surface* s : {&other_u, &other_v, &other_triangle, &other_side}) CHECK_FALSE(same_surface(first, *s));
}

// Goal: rays to a light that several pixels of a tile select are traced together, each only once, and nothing else
// changes. Method: 30 lights; single rays and those in packets, counted; bits without packets.
TEST_CASE("tile_shadows_of_selected_lights_are_traced_together") {
  auto s = generate_scene(bit(Feature::ambient), 3);
  for (int i = 0; i < 30; ++i) {
    Light light;
    light.position = {0.4f * static_cast<float>(i % 6) - 1, 2 + 0.1f * static_cast<float>(i), 0.5f};
    light.intensity = {1, 1, 1};
    s->lights.push_back(light);
  }
  s->bind();
  Settings settings = settings_for(bit(Feature::ambient), 40, 32);
  settings.light_tolerance = 1.0f / 16;
  auto test = make_renderer(s->scene, settings);
  REQUIRE(has(test->renderer.effects.mask, Effect::source_selection));
  REQUIRE(render_frame(&test->renderer, 0).ok);
  FrameData frame = test->renderer.frame;
  static AccelTraversal base;
  static std::uint64_t single, together;
  base = *frame.geometry.first_rays, single = together = 0;
  AccelTraversal counting = base;
  counting.occluded = [](const Accel& accel, const Ray& ray, const HitFilter* filter, TraceStats* stats) {
    return ++single, base.occluded(accel, ray, filter, stats);
  };
  counting.occluded_packet = [](const Accel& accel, const SegmentPacket& rays, const HitFilter* filter,
                                TraceStats* stats) {
    return together += rays.count, base.occluded_packet(accel, rays, filter, stats);
  };
  frame.geometry.first_rays = &counting;
  Tracer tracer, one_by_one;
  tracer.light_entries = one_by_one.light_entries = test->renderer.tracers[0].light_entries;
  const Picture picture = trace_all(frame, &tracer);
  const std::uint64_t wanted = tracer.rays[static_cast<int>(RayKind::shadow)];
  CHECK(single < wanted / 2);
  CHECK(single + together >= wanted);
  CHECK(single + together < wanted + wanted / 4);  // some pixels do not select the light
  frame.geometry.ray_by_ray = true;
  CHECK(same_picture(picture, trace_all(frame, &one_by_one)));
  CHECK(one_by_one.rays[static_cast<int>(RayKind::shadow)] == wanted);
}
