// Light maps: a frame's indirect light at every few pixels, rendered elsewhere, and how this machine adds it to a frame
// that it traced with its own indirect light, or none. Maps hold light before reflection, which is smooth; this machine
// knows the surface of each pixel and multiplies by its albedo.
//
// A pixel takes the light of the surrounding mapped pixels that show its surface (joint bilateral upsampling [Kopf
// 2007]; for indirect light [Sloan 2007]). Their surfaces are this machine's own first hits, so only light is sent. A
// map of an earlier frame is looked up where its camera saw the pixel's surface.
#pragma once
#include "engine/renderer.h"

namespace pocketray {

// Spacing of mapped pixels, along rows and columns.
constexpr std::uint32_t kLightPitchMin = 2, kLightPitchMax = 16;

struct LightGrid {
  std::uint32_t pitch = 0, columns = 0, rows = 0;
};
inline LightGrid light_grid(const Settings& settings, std::uint32_t pitch) {
  return {pitch, grid_side(settings.width, pitch), grid_side(settings.height, pitch)};
}
constexpr std::uint32_t light_count(const LightGrid& grid) { return grid.columns * grid.rows; }

// The surface that a mapped pixel shows. triangle: kNone if no surface there reflects indirect light.
struct MappedSurface {
  Vec3 point, normal;
  std::uint32_t triangle;
};

struct LightMap {
  LightGrid grid;
  CameraRays camera;             // of the map's frame,
  double seconds = 0;            // and that frame's time
  const MappedSurface* surface;  // per mapped pixel, by rows
  const Vec3* light;             // per mapped pixel: the value of indirect_light()
};

// Returns the indirect light that frames render themselves when a map adds the rest: ambient light, or what the scene
// has besides stored radiosity, which maps include.
IndirectChoice own_indirect(const Scene& scene);

// Returns why a map cannot hold the indirect light of a renderer's frames; null: it can.
const char* mapped_light_unfit(const Renderer& renderer);

// Number of first hits that the frame keeps for later steps: FrameTask::first_hits.
std::size_t first_hit_count(const Settings& settings);

// Finds the surfaces of mapped pixels, from the frame's first hits in rows above `traced_end`, below it by tracing
// rays. `surfaces` has light_count(grid) elements.
void take_mapped_surfaces(Renderer* renderer, const Hit* first_hits, std::uint32_t traced_end, const LightGrid& grid,
                          MappedSurface* surfaces);

// Replaces the renderer's own indirect light by the map's on the first surfaces in rows of its image. Behind glass and
// in mirrors, its own light stays. The rows must have been traced with these first hits.
void add_mapped_light(Renderer* renderer, const Hit* first_hits, const LightMap& map, std::uint32_t row_begin,
                      std::uint32_t row_end);

// Returns whether the map has the view and time of the prepared frame.
bool is_map_of_frame(const LightMap& map, const Renderer& renderer, double seconds);

}  // namespace pocketray
