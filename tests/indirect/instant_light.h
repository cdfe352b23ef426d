// Frames lit by instant radiosity.
#pragma once
#include <doctest/doctest.h>

#include <memory>

#include "engine/frame.h"
#include "support/generated_scene.h"

namespace pocketray {

inline Settings instant_settings(std::uint32_t lights, std::uint32_t width = 40, std::uint32_t height = 28) {
  Settings settings;
  settings.width = width, settings.height = height;
  settings.indirect = indirect_choice(Effect::instant_radiosity), settings.virtual_lights = lights;
  return settings;
}

inline std::unique_ptr<TestRenderer> rendered(const Scene& scene, const Settings& settings) {
  std::unique_ptr<TestRenderer> t = make_renderer(scene, settings);
  const Status status = render_frame(&t->renderer, 0);
  REQUIRE_MESSAGE(status.ok, status.message);
  return t;
}

}  // namespace pocketray
