// A reference of a scene in its own memory, and its estimates of single rays, for the suites that verify it.
#pragma once
#include <doctest/doctest.h>

#include <cmath>

#include "desktop/reference/reference.h"
#include "support/generated_scene.h"

namespace pocketray {

inline Settings small_settings() {
  Settings settings;
  settings.width = settings.height = 8;
  return settings;
}

struct TestReference {
  std::unique_ptr<TestRenderer> renderer;
  std::vector<std::uint8_t> memory;
  Reference reference;

  explicit TestReference(const Scene& scene, Settings settings = small_settings(),
                         std::uint32_t guide_path_count = 2000) {
    renderer = make_renderer(scene, settings);
    Status status = render_frame(&renderer->renderer, 0);
    REQUIRE_MESSAGE(status.ok, status.message);
    const FrameData& frame = renderer->renderer.frame;
    memory.resize(reference_need(frame) + kArenaAlignment);
    Arena arena = make_arena("reference", memory.data(), memory.size());
    reference = make_reference(frame, &arena, guide_path_count);
    CHECK(arena.used <= reference_need(frame));
  }
};

struct Estimate {
  double mean, error;  // error: standard error of the mean
};

// The green radiance along a ray.
inline Estimate estimate(const TestReference& t, Transport transport, const Vec3d& origin, const Vec3d& direction,
                         int count, std::uint64_t seed = 1, std::uint32_t depth_max = kNone) {
  ReferenceOptions o;
  o.transport = transport, o.depth_max = depth_max;
  Rng rng = make_rng(seed);
  double sum = 0, squares = 0;
  for (int i = 0; i < count; ++i) {
    double v = sample_radiance(t.reference, o, origin, direction, &rng).y;
    sum += v, squares += v * v;
  }
  double mean = sum / count;
  return {mean, std::sqrt(std::fmax(0, squares / count - mean * mean) / count)};
}

// Within five standard errors and a relative tolerance, by default the rounding of the scene's floats.
inline void check_equal(const Estimate& e, double expected, double tolerance = 1e-6) {
  CAPTURE(e.mean);
  CAPTURE(expected);
  CHECK(std::fabs(e.mean - expected) <= 5 * e.error + tolerance * expected);
  CHECK(e.error <= 0.25 * expected);
}

inline void add_camera(GeneratedScene* s) { aim(s, {0, 0.5f, 0.2f}, {0.1f, 0, 0}, 40); }

inline Material emitter(float radiance) {
  Material m;
  m.diffuse = {0, 0, 0};
  m.emission = {radiance, radiance, radiance};
  return m;
}
inline Material white() {
  Material m;
  m.diffuse = {1, 1, 1};
  return m;
}

// A unit vector at a cosine from z.
inline Vec3d at(double cosine, double turn) {
  const double sine = std::sqrt(1 - cosine * cosine);
  return {sine * std::cos(turn), sine * std::sin(turn), cosine};
}
inline Material plastic() {
  Material m;
  m.diffuse = {0.5f, 0.5f, 0.5f}, m.specular = {0.1f, 0.1f, 0.1f}, m.grazing = 1, m.roughness = 0.3f, m.brdf = kGgx;
  return m;
}

}  // namespace pocketray
