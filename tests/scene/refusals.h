// Changes to a valid scene that validate_scene() must refuse, or accept.
#pragma once
#include <doctest/doctest.h>

#include <functional>
#include <limits>
#include <string>

#include "scene/baked.h"
#include "scene/full_scene.h"

namespace pocketray {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

// Changes a valid scene and expects a refusal that mentions `what`.
inline void refuses(const char* what, const std::function<void(FullScene*)>& change) {
  FullScene full;
  make_full_scene(21, 14, 6, &full);
  Status status = validate_scene(full.scene);
  REQUIRE_MESSAGE(status.ok, status.message);
  change(&full);
  full.bind();
  status = validate_scene(full.scene);
  std::string message = status.message;
  CAPTURE(what);
  CAPTURE(message);
  CHECK(!status.ok);
  CHECK(message.find(what) != std::string::npos);
  CHECK(message.find('\n') == std::string::npos);
}

// Expects that the change keeps the scene valid.
inline void accepts(const std::function<void(FullScene*)>& change) {
  FullScene full;
  make_full_scene(21, 14, 6, &full);
  change(&full);
  full.bind();
  Status status = validate_scene(full.scene);
  CHECK_MESSAGE(status.ok, status.message);
}

}  // namespace pocketray
