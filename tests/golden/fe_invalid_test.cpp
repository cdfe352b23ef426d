// No frame makes a NaN on its way: no operation of a frame is invalid in IEEE's sense (0/0, ∞ − ∞, 0·∞, the root of a
// negative number, a comparison < with a NaN, an integer made of what does not fit it). Overflow and division by zero
// do occur and are meant to: 1/d of a direction with a zero component is an infinity that the box test replaces, and
// distances to a light squared may overflow in scenes as large as coordinates may be.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <cfenv>
#include <cstdio>
#include <string>
#include <vector>

#include "app/source.h"
#include "plan/plan_scene.h"
#include "present/pack.h"
#include "scene/builtin_helpers.h"
#include "support/effort.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

// Soft-float CPUs have no flags to raise.
bool flags_are_kept() {
#ifdef FE_INVALID
  volatile double zero = 0;
  std::feclearexcept(FE_ALL_EXCEPT);
  volatile double nan = zero / zero;
  (void)nan;
  bool kept = std::fetestexcept(FE_INVALID) != 0;
  std::feclearexcept(FE_ALL_EXCEPT);
  if (kept) return true;
#endif
  std::printf("skipped: this CPU keeps no floating-point flags\n");
  return false;
}

bool invalid_raised() {
#ifdef FE_INVALID
  return std::fetestexcept(FE_INVALID) != 0;
#else
  return false;
#endif
}

void pack_everywhere(const Renderer& r) {
  int width = static_cast<int>(r.settings.width), height = static_cast<int>(r.settings.height);
  std::vector<std::uint8_t> pixels(4 * r.image.count);
  for (const PixelFormat& format : {kXrgb8888, kRgb565, kRgb888})
    for (bool dither : {false, true})
      pack_rows(r.image.data, width, height, 0, height, r.exposure, format, Rotation::none, dither, pixels.data(),
                width * format.bits_per_pixel / 8);
}

// Renders every AOV at these times, flags cleared before each frame and read after it is traced and after it is packed.
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
      REQUIRE(render_frame(&test->renderer, seconds, aov).ok);
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

}  // namespace

// Goal: zero invalid operations in frames of the built-in scenes. Method: the CPU's flags, on the thread that renders,
// over times, quantities, samples, depths and accelerators.
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
    Settings settings = small_settings(4, 2);
    check_frames(built->scene, settings, nullptr, {0});
    settings.cut_off = false, settings.forced_on = ~EffectMask(0), settings.points_per_area_light = 9;
    check_frames(built->scene, settings, nullptr, {0});
    settings.normals = NormalMode::flat, settings.texture_filter = TextureFilter::nearest;
    check_frames(built->scene, settings, nullptr, {0});
  }
}

// Goal: the same in generated scenes that show every effect, and each by itself.
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

#ifdef POCKETRAY_HAVE_IMPORT
// Goal: the same in models as users have them. Method: those at hand, small pictures.
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
