// Settings: what was asked for. Plain data with defaults that just work.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/vec3.h"
#include "effect/effect.h"

namespace pocketray {

enum class TextureFilter : std::uint8_t { as_scene, nearest, bilinear };
enum class NormalMode : std::uint8_t { as_scene, flat };

struct Settings {
  std::uint32_t width = 320, height = 240;  // pixels
  std::uint32_t samples_per_pixel = 1;      // 1–16
  std::uint32_t ray_depth = 8;              // reflections and refractions along a path, 0–16
  std::uint32_t points_per_area_light = 4;  // 1–256
  std::uint32_t threads = 1;
  // What the rays left out of a sample may be worth together, in displayed levels; 0: none is left out, 0.5 cannot be
  // seen.
  float cut_off_levels = 0.5f;
  TextureFilter texture_filter = TextureFilter::as_scene;
  NormalMode normals = NormalMode::as_scene;
  EffectMask forced_on = 0, forced_off = 0;  // --effects
  std::size_t memory_bytes = 64u << 20;      // the fixed block
};

}  // namespace pocketray
