// The rays of the comparison, the same for both sides. They lie in tiles of 8×8 pixels and in Morton order within a
// tile, which suits coherent tracing: any 4, 8, 16 or 64 consecutive rays are a block of 2×2, 4×2, 4×4 or 8×8 pixels.
#pragma once
#include <string>
#include <vector>

#include "accel/ray.h"
#include "bench/bench_scene.h"

namespace pocketray {

enum class RayKindOfBench : int { primary, shadow, bounce };
constexpr const char* kBenchRayNames[] = {"primary", "shadow", "bounce"};

constexpr std::uint32_t kRayTileSide = 8, kRayTileSize = kRayTileSide * kRayTileSide;

struct RaySet {
  RayKindOfBench kind;
  std::uint32_t width, height;          // of the picture; multiples of kRayTileSide
  std::vector<Ray> rays;                // primary: one per pixel, in tiles; else in the order of the hits
  std::vector<std::size_t> tile_begin;  // shadow and bounce: the first ray of each tile, and past the last
  std::string size() const { return std::to_string(width) + "x" + std::to_string(height); }
};

Status make_primary_rays(const BenchScene& scene, std::uint32_t width, std::uint32_t height, RaySet* set);

// Rays from the primary hits, slightly in front of the surface: to a point light beside the eye, ending just before it,
// and into a cosine-distributed direction. `hits` answer the primary rays, slot by slot.
RaySet make_shadow_rays(const BenchScene& scene, const RaySet& primary, const std::vector<Hit>& hits,
                        float light_distance);
RaySet make_bounce_rays(const BenchScene& scene, const RaySet& primary, const std::vector<Hit>& hits);

}  // namespace pocketray
