// Groups of interleaved sources that share a shadow ray.
#include "shade/interleaved_rays.h"

#undef CHECK
#undef CHECK_EQ
#undef CHECK_NE
#undef CHECK_LT
#undef CHECK_LE
#undef CHECK_GT
#undef CHECK_GE
#include <doctest/doctest.h>

#include <cmath>
#include <memory>

#include "base/rng.h"

using namespace pocketray;

namespace {

// Sources of random brightness above a floor, of which one is hidden.
struct RandomSources {
  static constexpr float kFaint = 0;
  std::uint32_t count;
  float tolerance;
  const float* brightness;

  SteppedIndices<kPatternPixels> of_place(std::uint32_t place) const { return {place, count}; }
  bool arrives(std::uint32_t index, const Surface&, Vec3* light) const {
    *light = Vec3{1, 0.5f, 0.25f} * brightness[index];
    return *light != Vec3{0, 0, 0};
  }
  Ray ray(std::uint32_t index, const Surface&, const Vec3& origin) const {
    return {origin, {static_cast<float>(index), 1, 0}, 1};
  }
};

struct HalfFaintSources : RandomSources {
  static constexpr float kFaint = 0.5f;
};

std::uint32_t hidden_source = kNone;
const float* hidden_brightness = nullptr;  // null: `hidden_source` alone is hidden
float hidden_below = 0;
bool hides(const Accel&, const Ray& ray, const HitFilter*, TraceStats*) {
  if (hidden_brightness) return hidden_brightness[static_cast<std::uint32_t>(ray.direction.x)] < hidden_below;
  return ray.direction.x == static_cast<float>(hidden_source);
}

struct Gathering {
  AccelTraversal rays = {};
  FrameData frame;
  Surface surface = {};
  float brightness[kInterleavedSourceMax];

  explicit Gathering(std::uint32_t seed) {
    rays.occluded = hides, frame.geometry.first_rays = &rays;
    surface.diffuse = {1, 1, 1};
    Rng rng = make_rng(seed);
    for (float& b : brightness) {
      const float u = next_float(&rng);
      b = u < 0.1f ? 0 : u * u * u;  // few are bright
    }
  }

  template <class Source>
  InterleavedLight of(const Source& source, std::uint32_t place, std::uint64_t* ray_count) const {
    const Surface* surfaces[] = {&surface};
    const std::uint8_t places[] = {static_cast<std::uint8_t>(place)};
    TraceStats stats;
    InterleavedLight light;
    *ray_count = 0;
    gather_interleaved(frame, {1, surfaces, places}, source, true, &stats, ray_count, &light);
    return light;
  }
};

}  // namespace

// Goal: a ray that stands for some sources errs by less than twice the tolerance's share of the light, and there are
// few rays however many sources [Walter05]. Method: random sources, each hidden in turn; against a ray to every source.
TEST_CASE("ray_groups_err_less_than_twice_the_tolerance") {
  std::uint64_t saved = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const auto gathering = std::make_unique<Gathering>(seed);
    for (std::uint32_t count : {16u, 64u, 256u, 512u})
      for (float tolerance : {0.0f, 0.0625f, 0.25f, 1.0f}) {
        CAPTURE(count);
        CAPTURE(tolerance);
        const std::uint32_t place = seed;
        const RandomSources grouped = {count, tolerance, gathering->brightness};
        const RandomSources every = {count, 0, gathering->brightness};
        std::uint64_t ray_count, all_count;
        for (hidden_source = place; hidden_source < count; hidden_source += kPatternPixels) {
          const InterleavedLight light = gathering->of(grouped, place, &ray_count),
                                 exact = gathering->of(every, place, &all_count);
          CHECK(max_component(abs(light.lit - exact.lit)) <= (2 * tolerance + 1e-5f) * light.open.x);
          CHECK(light.open == exact.open);
          if (tolerance > 0) CHECK(static_cast<float>(ray_count) <= 1 + 1 / tolerance);
          CHECK(ray_count <= all_count);
          saved += all_count - ray_count;
        }
        hidden_source = kNone;  // all of it arrives, to the last bit
        const InterleavedLight open = gathering->of(grouped, place, &ray_count);
        CHECK(open.lit == open.open);
      }
  }
  CHECK(saved > 10000);
}

// Goal: which source's ray stands for a group does not favour bright sources over hidden ones: the light that arrives
// is right on average, however many sources there are. Method: the fainter half hidden, which has a part of the light
// that is known; the mean over places and seeds.
TEST_CASE("ray_groups_are_right_on_average") {
  for (std::uint32_t count : {64u, 256u, 512u}) {
    double found = 0, expected = 0, open = 0;
    for (std::uint32_t seed = 1; seed <= 64; ++seed) {
      const auto gathering = std::make_unique<Gathering>(seed);
      hidden_below = .25f, hidden_brightness = gathering->brightness;
      for (std::uint32_t place = 0; place < kPatternPixels; ++place) {
        std::uint64_t rays;
        gathering->surface.hit = {static_cast<float>(place) / kPatternPixels, static_cast<float>(seed) / 64, 0};
        found +=
            static_cast<double>(gathering->of(RandomSources{count, .5f, gathering->brightness}, place, &rays).lit.x);
        const InterleavedLight every = gathering->of(RandomSources{count, 0, gathering->brightness}, place, &rays);
        expected += static_cast<double>(every.lit.x), open += static_cast<double>(every.open.x);
      }
    }
    hidden_brightness = nullptr;
    CAPTURE(count);
    CHECK(std::fabs(found - expected) < .02 * open);
    CHECK(expected < .9 * open);
  }
}

// Goal: the rays that are listed, for coherence, are those that are traced. Method: as many, and each that changes the
// light when it is hidden is among them; with sources too faint for a ray, too.
TEST_CASE("ray_groups_are_listed_as_traced") {
  const auto gathering = std::make_unique<Gathering>(5);
  for (std::uint32_t count : {48u, 512u})
    for (float tolerance : {0.0f, 0.0625f, 0.25f}) {
      const HalfFaintSources source = {{count, tolerance, gathering->brightness}};
      SourceRay listed[kSourcesOfPixelMax];
      const std::uint32_t listed_count = list_source_rays(source, gathering->surface, 3, listed);
      std::uint64_t ray_count;
      hidden_source = kNone;
      const InterleavedLight open = gathering->of(source, 3, &ray_count);
      CHECK(ray_count == listed_count);
      for (hidden_source = 3; hidden_source < count; hidden_source += kPatternPixels) {
        bool is_listed = false;
        for (std::uint32_t i = 0; i < listed_count; ++i) is_listed = is_listed || listed[i].source == hidden_source;
        const bool changes = gathering->of(source, 3, &ray_count).lit != open.lit;
        CHECK(changes == is_listed);
      }
    }
}
