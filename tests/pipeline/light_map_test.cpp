// Light maps: indirect light at some pixels, added to a frame that was traced without it.
#include "engine/light_map.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "effect/setting_list.h"
#include "engine/frame.h"
#include "plan/resolve.h"
#include "scene/builtin_helpers.h"
#include "support/effort.h"
#include "support/generated_scene.h"
#include "support/scaled_scene.h"

using namespace pocketray;

namespace {

Settings settings_of(Effect method) {
  Settings settings;
  settings.width = 80, settings.height = 60;
  settings.indirect = indirect_choice(method);
  return settings;
}

// A map of a frame and what it refers to.
struct OwnedMap {
  std::vector<MappedSurface> surfaces;
  std::vector<Vec3> lights;
  LightMap map;
};

// Traces a frame of the device, keeping its first hits.
std::vector<Hit> traced(Renderer* renderer, double seconds = 0) {
  std::vector<Hit> hits(first_hit_count(renderer->settings));
  FrameTask task = {seconds};
  task.first_hits = hits.data();
  REQUIRE(render_frame(renderer, task).ok);
  return hits;
}

// The map of a frame whose light another renderer has; the device has traced it.
std::unique_ptr<OwnedMap> map_of(Renderer* light, Renderer* device, const std::vector<Hit>& hits, std::uint32_t pitch,
                                 double seconds = 0) {
  auto owned = std::make_unique<OwnedMap>();
  const LightGrid grid = light_grid(device->settings, pitch);
  owned->surfaces.resize(light_count(grid)), owned->lights.resize(light_count(grid));
  take_mapped_surfaces(device, hits.data(), device->settings.height, grid, owned->surfaces.data());
  light->view.camera = device->view.camera, light->view.camera_overridden = true;
  REQUIRE(begin_frame(light, {seconds}).ok);
  for (std::uint32_t i = 0; i < light_count(grid); ++i) {
    const auto row = static_cast<std::uint16_t>(i / grid.columns * pitch);
    const auto column = static_cast<std::uint16_t>(i % grid.columns * pitch);
    const Span span = {row, column, static_cast<std::uint16_t>(column + 1)};
    trace_spans(&light->tracers[0], &span, 1, Aov::indirect_light, light->image.data);
    owned->lights[i] = light->image[row * light->settings.width + column];
    CHECK((owned->lights[i].x < 0) == (owned->surfaces[i].triangle == kNone));
  }
  owned->map = {grid, device->frame.view.camera, seconds, owned->surfaces.data(), owned->lights.data()};
  return owned;
}

Picture picture_of(const Renderer& renderer) { return {renderer.image.begin(), renderer.image.end()}; }

double mean_difference(const Picture& a, const Picture& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int c = 0; c < 3; ++c) sum += std::fabs(double(std::min(a[i][c], 2.0f)) - double(std::min(b[i][c], 2.0f)));
  return sum / (3.0 * static_cast<double>(a.size()));
}

}  // namespace

// Goal: a map of the device's own indirect light changes nothing but by rounding: what is added is what the device
// lacks, at every pixel and sample. Method: scenes with glass, mirrors, textures; samples.
TEST_CASE("light_map_of_the_own_light_changes_nothing") {
  const char* scenes[] = {"cornell", "cube", "seesaw", "lanterns"};
  for (int i = 0; i < (kEffortDivisor > 6 ? 2 : 4); ++i) {
    CAPTURE(scenes[i]);
    const std::unique_ptr<BuiltScene> built = build_builtin(scenes[i]);
    for (std::uint32_t samples : {1u, 3u}) {
      Settings settings = settings_of(Effect::ambient);
      settings.samples_per_pixel = samples;
      const std::unique_ptr<TestRenderer> device = make_renderer(built->scene, settings);
      const std::unique_ptr<TestRenderer> light = make_renderer(built->scene, settings);
      const std::vector<Hit> hits = traced(&device->renderer);
      const Picture before = picture_of(device->renderer);
      const auto owned = map_of(&light->renderer, &device->renderer, hits, 5);
      add_mapped_light(&device->renderer, hits.data(), owned->map, 0, settings.height);
      for (std::size_t k = 0; k < before.size(); ++k)
        for (int c = 0; c < 3; ++c)
          REQUIRE(std::fabs(device->renderer.image[k][c] - before[k][c]) <= 1e-6f * (1 + before[k][c]));
    }
  }
}

// Goal: light under coats and sheens is attenuated once. Method: ambient light of .4 and a map of .8, against a picture
// of ambient light of .8; without lobes, which reflect the surroundings, too.
TEST_CASE("light_map_lights_what_is_under_layers") {
  auto made = [](float ambient) {
    auto s = std::make_unique<GeneratedScene>();
    Material base;
    base.diffuse = {0.6f, 0.5f, 0.4f};
    for (int i = 0; i < 3; ++i) {
      const float x = static_cast<float>(2 * i - 3);
      add_quad(s.get(), {x, -1, 0}, {x + 2, -1, 0}, {x + 2, 1, 0}, {x, 1, 0}, add_material(s.get(), base));
    }
    s->clear_coats.resize(3), s->sheens.resize(3);
    for (int i : {0, 2}) s->clear_coats[static_cast<std::size_t>(i)].strength = 1;
    for (int i : {1, 2}) {
      Sheen& sheen = s->sheens[static_cast<std::size_t>(i)];
      sheen.color = {0.8f, 0.8f, 0.8f}, sheen.roughness = sheen.roughness_low = 0.4f;
    }
    s->lights.resize(1);
    s->lights[0].intensity = {0, 0, 0};
    s->scene.info.ambient = {ambient, ambient, ambient};
    aim(s.get(), {0.5f, -3, 2}, {0, 0, 0}, 40);
    s->bind();
    return s;
  };
  const std::unique_ptr<GeneratedScene> dim = made(0.4f), bright = made(0.8f);
  Settings settings = settings_of(Effect::ambient);
  settings.forced_off = bit(Effect::specular) | bit(Effect::mirror) | bit(Effect::ambient_gloss);
  const std::unique_ptr<TestRenderer> device = make_renderer(dim->scene, settings),
                                      light = make_renderer(bright->scene, settings),
                                      wanted = make_renderer(bright->scene, settings);
  const std::vector<Hit> hits = traced(&device->renderer);
  const Picture before = picture_of(device->renderer);
  traced(&wanted->renderer);
  const auto owned = map_of(&light->renderer, &device->renderer, hits, 4);
  add_mapped_light(&device->renderer, hits.data(), owned->map, 0, settings.height);
  std::uint32_t brighter = 0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    brighter += before[k].x > 0 && device->renderer.image[k].x > 1.5f * before[k].x;
    for (int c = 0; c < 3; ++c)
      REQUIRE(device->renderer.image[k][c] == doctest::Approx(wanted->renderer.image[k][c]).epsilon(1e-4));
  }
  CHECK(brighter > 500);
}

// Goal: mapped pixels of rows that others trace show the same surfaces.
TEST_CASE("light_map_of_rows_not_traced_here_shows_the_same") {
  for (const char* scene : {"cornell", "seesaw"}) {
    const std::unique_ptr<BuiltScene> built = build_builtin(scene);
    const std::unique_ptr<TestRenderer> device = make_renderer(built->scene, settings_of(Effect::ambient));
    Renderer* d = &device->renderer;
    std::vector<Hit> hits = traced(d);
    const LightGrid grid = light_grid(d->settings, 3);
    std::vector<MappedSurface> all(light_count(grid)), some(light_count(grid));
    take_mapped_surfaces(d, hits.data(), d->settings.height, grid, all.data());
    const std::uint32_t traced_end = 13;
    std::fill(hits.begin() + traced_end * d->settings.width, hits.end(), Hit());
    take_mapped_surfaces(d, hits.data(), traced_end, grid, some.data());
    int shown = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      REQUIRE(some[i].triangle == all[i].triangle);
      if (all[i].triangle == kNone) continue;
      REQUIRE(some[i].point == all[i].point);
      REQUIRE(some[i].normal == all[i].normal);
      ++shown;
    }
    CHECK(shown > int(all.size() / 4));
  }
}

// Goal: a pixel takes the light of its own surface, at its own place, whatever the pitch and the view of the map.
// Method: light that says where and on which wall of the cube it is.
TEST_CASE("light_map_gives_surfaces_their_own_light") {
  const std::unique_ptr<BuiltScene> built = build_builtin("cube");
  const std::unique_ptr<TestRenderer> device = make_renderer(built->scene, settings_of(Effect::ambient));
  const std::unique_ptr<TestRenderer> light = make_renderer(built->scene, settings_of(Effect::ambient));
  Renderer* d = &device->renderer;
  const Vec3 low = d->bounds.low, size = extent(d->bounds);
  auto painted = [&](const std::vector<Hit>& hits, std::uint32_t pitch) {
    std::unique_ptr<OwnedMap> owned = map_of(&light->renderer, d, hits, pitch);
    for (std::size_t i = 0; i < owned->lights.size(); ++i) {
      const MappedSurface& m = owned->surfaces[i];
      if (m.triangle == kNone) continue;
      const Vec3 place = m.point - low;
      owned->lights[i] = abs(m.normal) + Vec3{place.x / size.x, place.y / size.y, place.z / size.z};
    }
    return owned;
  };
  auto with = [&](const LightMap& map) {
    const std::vector<Hit> hits = traced(d);
    add_mapped_light(d, hits.data(), map, 0, d->settings.height);
    return picture_of(*d);
  };
  const auto before = painted(traced(d), 8);
  const double by_pitch = mean_difference(with(before->map), with(painted(traced(d), 2)->map));
  CAPTURE(by_pitch);
  CHECK(by_pitch < 0.015);
  Camera camera = d->view.camera;
  camera.eye = camera.target + (camera.eye - camera.target) * 0.8f + Vec3{0.1f, 0.1f, 0} * camera.eye.z;
  REQUIRE(set_camera(d, camera).ok);
  const double by_view = mean_difference(with(before->map), with(painted(traced(d), 2)->map));
  CAPTURE(by_view);
  CHECK(by_view < 0.015);
}

// Goal: the light of virtual lights, mapped at some pixels, gives about the picture that has it everywhere, and the
// more so the more are mapped. A map of another view of the same scene does so, too, where it shows the surfaces.
TEST_CASE("light_map_stands_in_for_light_at_every_pixel") {
  for (const char* scene : {"cornell", "cube"}) {
    CAPTURE(scene);
    const std::unique_ptr<BuiltScene> built = build_builtin(scene);
    const std::unique_ptr<TestRenderer> device = make_renderer(built->scene, settings_of(Effect::ambient));
    const std::unique_ptr<TestRenderer> light = make_renderer(built->scene, settings_of(Effect::instant_radiosity));
    Renderer* d = &device->renderer;
    std::vector<Hit> hits = traced(d);
    const Picture own = picture_of(*d);
    std::unique_ptr<OwnedMap> owned;
    double before = 1e9;
    Picture right;
    for (std::uint32_t pitch : {12u, 6u, 2u}) {
      owned = map_of(&light->renderer, d, hits, pitch);
      REQUIRE(render_frame(&light->renderer, 0).ok);
      right = picture_of(light->renderer);
      hits = traced(d);
      CHECK(is_map_of_frame(owned->map, *d, 0));
      add_mapped_light(d, hits.data(), owned->map, 0, d->settings.height);
      const double error = mean_difference(picture_of(*d), right);
      CHECK(error < before);
      CHECK(error < 0.85 * mean_difference(own, right));  // `right` has the grain of grouped lights, which maps smooth
      before = error;
    }
    // From two degrees on.
    Camera camera = d->view.camera;
    camera.eye = camera.target + (camera.eye - camera.target) * 0.98f + Vec3{0.03f, 0.02f, 0} * (camera.eye.z);
    REQUIRE(set_camera(d, camera).ok);
    hits = traced(d);
    CHECK(!is_map_of_frame(owned->map, *d, 0));
    const Picture own_there = picture_of(*d);
    REQUIRE(set_camera(&light->renderer, camera).ok);
    REQUIRE(render_frame(&light->renderer, 0).ok);
    right = picture_of(light->renderer);
    add_mapped_light(d, hits.data(), owned->map, 0, d->settings.height);
    CHECK(mean_difference(picture_of(*d), right) < 0.35 * mean_difference(own_there, right));
  }
}

// Goal: the picture depends neither on the number of threads nor on which rows are added together.
TEST_CASE("light_map_is_independent_of_threads_and_bands") {
  const std::unique_ptr<BuiltScene> built = build_builtin("seesaw");
  Picture first;
  for (std::uint32_t threads : {1u, 4u}) {
    Settings settings = settings_of(Effect::ambient);
    settings.threads = threads;
    const std::unique_ptr<TestRenderer> device = make_renderer(built->scene, settings);
    const std::unique_ptr<TestRenderer> light = make_renderer(built->scene, settings_of(Effect::instant_radiosity));
    const std::vector<Hit> hits = traced(&device->renderer, 0.5);
    const auto owned = map_of(&light->renderer, &device->renderer, hits, 6, 0.5);
    const std::uint32_t band = threads == 1 ? 60 : 7;
    for (std::uint32_t row = 0; row < 60; row += band)
      add_mapped_light(&device->renderer, hits.data(), owned->map, row, std::min(row + band, 60u));
    if (first.empty()) first = picture_of(device->renderer);
    CHECK(same_picture(first, picture_of(device->renderer)));
  }
}

// Goal: no length is compared with a constant: a scene scaled by a power of two gives the same picture, bit for bit.
TEST_CASE("light_map_is_free_of_scale") {
  const std::unique_ptr<BuiltScene> built = build_builtin("cube");
  Picture first;
  for (float k : {1.0f, 0x1p-20f, 0x1p20f}) {
    const std::unique_ptr<ScaledScene> scaled = scale_scene(built->scene, k);
    const std::unique_ptr<TestRenderer> device = make_renderer(scaled->scene, settings_of(Effect::ambient));
    const std::unique_ptr<TestRenderer> light = make_renderer(scaled->scene, settings_of(Effect::instant_radiosity));
    const std::vector<Hit> hits = traced(&device->renderer);
    const auto owned = map_of(&light->renderer, &device->renderer, hits, 6);
    add_mapped_light(&device->renderer, hits.data(), owned->map, 0, 60);
    if (first.empty()) first = picture_of(device->renderer);
    CHECK(same_picture(first, picture_of(device->renderer)));
  }
}

// Goal: light of any size that a message can hold leaves every pixel finite and not negative.
TEST_CASE("light_map_of_any_light_leaves_numbers") {
  const std::unique_ptr<BuiltScene> built = build_builtin("cornell");
  const std::unique_ptr<TestRenderer> device = make_renderer(built->scene, settings_of(Effect::ambient));
  for (float light : {0.0f, 0x1p-100f, 1.0f, 0x1p64f}) {
    const std::vector<Hit> hits = traced(&device->renderer);
    const auto owned = map_of(&device->renderer, &device->renderer, hits, 16);
    for (Vec3& l : owned->lights) l = {light, light, 0};
    traced(&device->renderer);
    add_mapped_light(&device->renderer, hits.data(), owned->map, 0, 60);
    for (const Vec3& pixel : device->renderer.image)
      for (int c = 0; c < 3; ++c) REQUIRE((std::isfinite(pixel[c]) && pixel[c] >= 0));
  }
}

// Goal: renderers whose frames cannot take light from a map say why.
TEST_CASE("light_map_fits_only_frames_of_whole_pixels") {
  const std::unique_ptr<BuiltScene> built = build_builtin("cornell");
  auto because = [&](const Settings& with) {
    return unshared_because(make_renderer(built->scene, with)->renderer.effects.mask);
  };
  Settings settings = settings_of(Effect::ambient);
  CHECK(because(settings) == nullptr);
  settings.resolution = Resolution::half;
  CHECK(because(settings) != nullptr);
  settings.resolution = Resolution::full, settings.selective_contrast = 0.1f;
  CHECK(because(settings) != nullptr);
  CHECK(because(settings_of(Effect::instant_radiosity)) != nullptr);
}
