// No frame makes a NaN on its way: no operation of a frame is invalid in IEEE's sense (0/0, ∞ − ∞, 0·∞, the root of a
// negative number, a comparison < with a NaN, a conversion to an integer that does not fit). Overflow and division by
// zero do occur, on purpose: 1/d of a direction with a zero component is an infinity that the box test replaces, and
// the squared distance to a light may overflow in scenes that reach the limit of coordinates.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <cfenv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "base/limits.h"
#include "plan/plan_scene.h"
#include "present/pack.h"
#include "scene/baked.h"
#include "scene/builtin_helpers.h"
#include "support/effort.h"
#include "support/generated_scene.h"
#ifdef POCKETRAY_HAVE_IMPORT
#include "session/source.h"
#endif

using namespace pocketray;

namespace {

// Soft-float CPUs have no flags to raise. Clang assumes that nobody reads flags and evaluates both sides of a choice,
// even the one not taken: flags then say nothing about the source.
bool flags_are_kept() {
#if defined(FE_INVALID) && !defined(__clang__)
  volatile double zero = 0;
  std::feclearexcept(FE_ALL_EXCEPT);
  volatile double nan = zero / zero;
  (void)nan;
  bool kept = std::fetestexcept(FE_INVALID) != 0;
  std::feclearexcept(FE_ALL_EXCEPT);
  if (kept) return true;
#endif
  std::printf("skipped: this CPU or compiler keeps no floating-point flags\n");
  return false;
}

bool invalid_raised() {
#ifdef FE_INVALID
  return std::fetestexcept(FE_INVALID) != 0;
#else
  return false;
#endif
}

void pack_everywhere(const Renderer& renderer) {
  int width = static_cast<int>(renderer.settings.width), height = static_cast<int>(renderer.settings.height);
  std::vector<std::uint8_t> pixels(4 * renderer.image.count);
  for (const PixelFormat& format : {kXrgb8888, kRgb565, kRgb888})
    for (bool dither : {false, true})
      pack_rows(renderer.image.data, width, height, 0, height, display_of(renderer), format, Rotation::none, dither,
                pixels.data(), width * format.bits_per_pixel / 8);
}

// Renders every AOV at these times; clears the flags before each frame and reads them after tracing and after packing.
void check_frames(const Scene& scene, const Settings& settings, const AccelInfo* accel,
                  const std::vector<double>& times) {
  Status status;
  auto test = make_renderer(scene, settings, accel, &status);
  REQUIRE_MESSAGE(status.ok, status.message);
  for (double seconds : times)
    for (Aov aov : {Aov::none, Aov::depth, Aov::normal, Aov::triangle, Aov::cost}) {
      CAPTURE(seconds);
      CAPTURE(static_cast<int>(aov));
      std::feclearexcept(FE_ALL_EXCEPT);
      if (!render_frame(&test->renderer, seconds, aov).ok) continue;  // a camera that moves out of its limits
      CHECK_MESSAGE(!invalid_raised(), "while tracing");
      std::feclearexcept(FE_ALL_EXCEPT);
      pack_everywhere(test->renderer);
      CHECK_MESSAGE(!invalid_raised(), "while packing");
    }
}

Settings small_settings(std::uint32_t samples, std::uint32_t depth) {
  Settings settings;
  settings.width = effort_side(48), settings.height = effort_side(36);
  settings.samples_per_pixel = samples, settings.ray_depth = depth;
  return settings;
}

std::vector<double> times_of(const Scene& scene) {
  return is_animated(scene) ? std::vector<double>{0, 0.37, 1.5, 1e4} : std::vector<double>{0};
}

// A value of the given interval: one of its ends, near one, or anywhere by magnitude.
float extreme(Rng* rng, float low, float high) {
  float picks[] = {low, high, 0, 1, std::nextafterf(high, low), std::numeric_limits<float>::min(), 1e-45f};
  float value = picks[next_u32(rng) % 7];
  if (next_u32(rng) % 2) value = std::ldexp(1 + next_float(rng), static_cast<int>(next_u32(rng) % 250) - 125);
  if (low < 0 && next_u32(rng) % 2) value = -value;
  return value < low ? low : value > high ? high : value;
}
Vec3 extreme3(Rng* rng, float low, float high) {
  return {extreme(rng, low, high), extreme(rng, low, high), extreme(rng, low, high)};
}
template <class T>
T& any(Rng* rng, std::vector<T>* list) {
  return (*list)[next_u32(rng) % list->size()];
}

void make_material_extreme(Rng* rng, Material* m) {
  switch (next_u32(rng) % 12) {
    case 0:
      m->diffuse = extreme3(rng, 0, 1);
      break;
    case 1:
      m->specular = extreme3(rng, 0, 1);
      break;
    case 2:
      m->exponent = extreme(rng, 0, kPhongExponentMax);
      break;
    case 3:
      m->mirror = extreme3(rng, 0, 1);
      break;
    case 4:
      m->transmission = extreme3(rng, 0, 1);
      break;
    case 5:
      m->ior = extreme(rng, 1, kIorMax);
      break;
    case 6:
      m->absorption = extreme3(rng, 0, kRadianceMax);
      break;
    case 7:
      m->emission = extreme3(rng, 0, kRadianceMax);
      break;
    case 8:
      m->opacity = extreme(rng, 0, 1), m->alpha_mode = AlphaMode::blend;
      break;
    case 9:
      m->alpha_cutoff = extreme(rng, 0, 3e38f), m->alpha_mode = AlphaMode::mask;
      break;
    case 10:
      m->thin ^= 1;
      break;
    default:
      for (TextureUse* use : {&m->diffuse_texture, &m->emission_texture})
        use->m[next_u32(rng) % 2][next_u32(rng) % 3] = extreme(rng, -kCoordinateMax, kCoordinateMax);
  }
}

void make_light_extreme(Rng* rng, Light* light) {
  switch (next_u32(rng) % 5) {
    case 0:
      light->position = extreme3(rng, -kCoordinateMax, kCoordinateMax);
      break;
    case 1:
      light->intensity = extreme3(rng, 0, kRadianceMax);
      break;
    case 2:
      light->range = extreme(rng, 0, 3e38f);
      break;
    case 3:
      light->cos_outer = light->cos_inner = extreme(rng, -1, 1);
      break;
    default:
      light->direction = normalize(extreme3(rng, -1, 1));
  }
}

// Replaces a few numbers of a scene by the limits of what a scene may hold.
void make_extreme(Rng* rng, GeneratedScene* s) {
  switch (next_u32(rng) % 9) {
    case 0:
      any(rng, &s->positions) = extreme3(rng, -kCoordinateMax, kCoordinateMax);
      break;
    case 1:
      any(rng, &s->normals) = normalize(extreme3(rng, -1, 1));
      break;
    case 2:
      any(rng, &s->uvs) = {extreme(rng, -kCoordinateMax, kCoordinateMax), extreme(rng, 0, kCoordinateMax)};
      break;
    case 3: {
      float scale = extreme(rng, 0, 1e17f);
      for (Vec3& p : s->positions) p = p * scale;
      for (Vec3& p : s->rest_positions) p = p * scale;
      for (float& x : s->key_values) x *= scale;
      for (Light& light : s->lights) light.position = light.position * scale;
      for (Camera& c : s->cameras) c.eye = c.eye * scale, c.target = c.target * scale;
      break;
    }
    case 4:
      s->lights.empty() ? void() : make_light_extreme(rng, &any(rng, &s->lights));
      break;
    case 5:
      s->scene.info.ambient = extreme3(rng, 0, kRadianceMax);
      break;
    case 6:
      s->scene.info.background = extreme3(rng, 0, kRadianceMax);
      break;
    case 7:
      if (!s->key_values.empty()) any(rng, &s->key_values) = extreme(rng, -kCoordinateMax, kCoordinateMax);
      break;
    default:
      make_material_extreme(rng, &any(rng, &s->materials));
  }
}

}  // namespace

// Goal: no invalid operations in frames of the built-in scenes. Method: the CPU's flags, on the rendering thread, over
// times, quantities, samples, depths and accelerators.
TEST_CASE("frames_of_builtin_scenes_raise_no_invalid_operation") {
  if (!flags_are_kept()) return;
  int count;
  const BuiltinScene* list = builtin_list(&count);
  for (int i = 0; i < count; ++i) {
    CAPTURE(std::string(list[i].name));
    auto built = build_builtin(list[i]);
    for (const AccelInfo* accel : kAccelList) {
      if (accel == &kBruteAccel && built->scene.triangles.count > 1000) continue;
      CAPTURE(std::string(accel->name));
      check_frames(built->scene, small_settings(1, 8), accel, times_of(built->scene));
    }
    if (built->scene.lights.count > 64) continue;  // each sample asks each light
    Settings settings = small_settings(4, 2);
    check_frames(built->scene, settings, nullptr, {0});
    settings.cut_off_levels = 0, settings.forced_on = ~EffectMask(0), settings.points_per_area_light = 9;
    check_frames(built->scene, settings, nullptr, {0});
    settings.normals = NormalMode::flat, settings.texture_filter = TextureFilter::nearest;
    check_frames(built->scene, settings, nullptr, {0});
  }
}

// Goal: the same in generated scenes with every effect together, and each alone.
TEST_CASE("frames_of_generated_scenes_raise_no_invalid_operation") {
  if (!flags_are_kept()) return;
  for (int feature = -1; feature < kFeatureCount; ++feature) {
    CAPTURE(feature);
    auto generated = generate_scene(feature < 0 ? kAllFeatures : 1u << feature, 7);
    Settings settings = small_settings(feature < 0 ? 2 : 1, 8);
    for (const AccelInfo* accel : kAccelList)
      if (feature < 0 || accel != &kBruteAccel) check_frames(generated->scene, settings, accel, {0, 0.4});
  }
}

// Goal: the same for any other valid content of a scene. Method: generated scenes with up to four numbers at the ends
// of their ranges, as far as a loader accepts them.
TEST_CASE("frames_of_extreme_scenes_raise_no_invalid_operation") {
  if (!flags_are_kept()) return;
  int taken = 0;
  for (int seed = 1; seed <= effort(100); ++seed) {
    CAPTURE(seed);
    Rng rng = make_rng(static_cast<std::uint64_t>(seed));
    auto generated = generate_scene(seed % 3 ? kAllFeatures : next_u32(&rng) & kAllFeatures, 7);
    for (std::uint32_t i = 0, count = 1 + next_u32(&rng) % 4; i < count; ++i) make_extreme(&rng, generated.get());
    generated->bind();
    if (!validate_scene(generated->scene).ok) continue;
    ++taken;
    Settings settings = small_settings(1, 6);
    settings.width = 24, settings.height = 18;
    check_frames(generated->scene, settings, nullptr, {0, 0.4});
  }
  CHECK(taken * 2 > effort(100));
}

#ifdef POCKETRAY_HAVE_IMPORT
// Goal: the same in real models. Method: those available, in small pictures.
TEST_CASE("frames_of_models_raise_no_invalid_operation") {
  if (!flags_are_kept()) return;
  const char* const models[] = {
      "mesh/happy_vrip_res3.ply",
      "mesh/cube/cube.obj",
      "cornell/mcguire/CornellBox-Sphere.obj",
      "cornell/mcguire/CornellBox-Glossy.obj",
      "cornell/mcguire/CornellBox-Mirror.obj",
      "cornell/bevy_CornellBox.glb",
      "gltf/AlphaBlendModeTest.glb",
      "gltf/AnimatedMorphCube.glb",
      "gltf/AttenuationTest.glb",
      "gltf/BoxVertexColors.glb",
      "gltf/CesiumMan.glb",
      "gltf/EmissiveStrengthTest.glb",
      "gltf/Fox.glb",
      "gltf/InterpolationTest.glb",
      "gltf/Lights.glb",
      "gltf/MetalRoughSpheresNoTextures.glb",
      "gltf/NegativeScaleTest.glb",
      "gltf/TextureSettingsTest.glb",
      "gltf/TransmissionTest.glb",
      "gltf/VertexColorTest.glb",
      "rooms/glass-table.glb",
      "rooms/holodeck/holodeck.obj",
      "animation/alien.glb",
      "animation/robot.glb",
  };
  int found = 0;
  for (const char* name : models) {
    std::string path = std::string(POCKETRAY_SHARED) + "/scenes/" + name;
    struct stat info;
    if (stat(path.c_str(), &info) != 0) continue;
    ++found;
    CAPTURE(path);
    ImportedScene imported;
    Status status = import_model(path, ImportOptions(), &imported);
    REQUIRE_MESSAGE(status.ok, status.message);
    Settings settings = small_settings(1, 6);
    settings.memory_bytes = 256u << 20;
    check_frames(imported.scene, settings, nullptr, times_of(imported.scene));
  }
  if (!found) std::printf("skipped: the models are absent\n");
}
#endif
