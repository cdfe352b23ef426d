// Light maps: a frame's indirect light at every few pixels, rendered elsewhere, and how this machine adds it to a frame
// that it has traced with its own indirect light, or none. What is mapped is light before surfaces reflect it, which is
// smooth; this machine knows the surface of each pixel, and multiplies by its albedo.
//
// A pixel takes the light of the mapped pixels about it that show its surface (joint bilateral upsampling [Kopf 2007];
// for indirect light [Sloan 2007]). Their surfaces are this machine's own first hits, so nothing but light is sent. A
// map of an earlier frame is looked up where its camera saw the pixel's surface.
#pragma once
#include "engine/renderer.h"

namespace pocketray {

// Pixels between mapped ones, along rows and columns.
constexpr std::uint32_t kLightPitchMin = 2, kLightPitchMax = 16;

struct LightGrid {
  std::uint32_t pitch = 0, columns = 0, rows = 0;
};
inline LightGrid light_grid(const Settings& settings, std::uint32_t pitch) {
  return {pitch, grid_side(settings.width, pitch), grid_side(settings.height, pitch)};
}
constexpr std::uint32_t light_count(const LightGrid& grid) { return grid.columns * grid.rows; }

// What a mapped pixel shows. triangle: kNone if it shows no surface that reflects indirect light.
struct MappedSurface {
  Vec3 point, normal;
  std::uint32_t triangle;
};

struct LightMap {
  LightGrid grid;
  CameraRays camera;             // of its frame,
  double seconds = 0;            // and that frame's time
  const MappedSurface* surface;  // of each mapped pixel, by rows
  const Vec3* light;             // the same: as indirect_light() has it
};

// The indirect light of frames that take more from a map: ambient light, or what the scene has besides stored
// radiosity, which is among what maps have.
IndirectChoice own_indirect(const Scene& scene);

// Why the indirect light of a renderer's frames cannot come from a map; null: it can.
const char* mapped_light_unfit(const Renderer& renderer);
// Why a renderer's frames, of its own indirect light, cannot take more from a map; null: they can. The text continues
// "light maps: ".
const char* light_map_unfit(const Renderer& renderer);

// Number of first hits that the frame keeps for what follows: set FrameData::first_hits after prepare_frame().
std::size_t first_hit_count(const Settings& settings);

// The surfaces of mapped pixels, by the first hits of the frame's rows above `traced_end`; of those below, rays are
// traced. `surfaces` has light_count(grid) places.
void take_mapped_surfaces(Renderer* renderer, const Hit* first_hits, std::uint32_t traced_end, const LightGrid& grid,
                          MappedSurface* surfaces);

// Replaces the renderer's own indirect light on the first surfaces of rows of its image by that of the map. Where these
// are behind glass or in mirrors, the own light stays. The rows have been traced with these first hits.
void add_mapped_light(Renderer* renderer, const Hit* first_hits, const LightMap& map, std::uint32_t row_begin,
                      std::uint32_t row_end);

// Whether the map is of the same view at the same time as the prepared frame.
bool is_map_of_frame(const LightMap& map, const Renderer& renderer, double seconds);

}  // namespace pocketray
