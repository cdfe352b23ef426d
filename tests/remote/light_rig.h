// A device whose frames a server lights, and what they should show.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "remote/client/light.h"
#include "split_rig.h"

namespace pocketray {

constexpr IndirectChoice kVirtual = indirect_choice(Effect::instant_radiosity),
                         kAmbient = indirect_choice(Effect::ambient);

inline LightOptions by_effect() {
  LightOptions light;
  light.split = SplitKind::effect, light.indirect = kVirtual;
  light.wait_ns = 10'000'000'000;
  return light;
}

inline SplitRigOptions effect_rig(const char* scene) {
  SplitRigOptions o;
  o.scene = scene, o.compares = false;
  o.client.light = by_effect();
  return o;
}

inline double mean_error(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(int(a[i]) - int(b[i]));
  return sum / static_cast<double>(a.size());
}

inline std::vector<std::uint8_t> pixels_of(const Client& client) {
  return {client.picture.pixels.begin(), client.picture.pixels.end()};
}

// The device's frame with its own indirect light.
inline std::vector<std::uint8_t> ambient_pixels(SplitRig* rig, double seconds) {
  Settings settings = rig->whole->renderer.settings;
  const IndirectChoice before = settings.indirect;
  settings.indirect = kAmbient;
  REQUIRE(change_settings(&rig->whole->renderer, settings).ok);
  const std::vector<std::uint8_t> pixels = rig->local_pixels(seconds);
  settings.indirect = before;
  REQUIRE(change_settings(&rig->whole->renderer, settings).ok);
  return pixels;
}

inline void turn(Renderer* renderer, float degrees) {
  Camera camera = renderer->view.camera;
  const Vec3 way = camera.eye - camera.target;
  const float angle = degrees * kPiF / 180, c = 1 - angle * angle / 2, s = angle;
  camera.eye = camera.target + Vec3{way.x * c + way.z * s, way.y, way.z * c - way.x * s};
  REQUIRE(set_camera(renderer, camera).ok);
}

}  // namespace pocketray
