// Measures the extent of the rays of a tile's first hits.
#include <algorithm>
#include <cmath>

#include "shade/edges.h"
#include "temporal/tile_changes.h"

namespace pocketray {
namespace {

// Upper bound of curved_origin()'s lift of a point of the triangle.
float lift_bound(const FrameData& frame, const Triangle& t, const Vec3& point, const float* weight) {
  float lift = 0;
  for (std::uint32_t i = 0; i < 3; ++i)
    lift +=
        std::fabs(weight[i] * dot(point - frame.geometry.positions[t.vertex(i)], frame.geometry.normals[t.vertex(i)]));
  return lift * 1.02f;  // normals may be 1 % too long (scene/validate.cpp)
}

}  // namespace

TileHits measure_tile(const FrameData& frame, const Hit* first_hits, std::uint32_t column, std::uint32_t row,
                      std::uint64_t known) {
  const Settings& settings = frame.settings;
  TileHits tile;
  float reach = 0;  // largest coordinate of the triangles
  const std::uint32_t right = std::min(column + kChangeTileSide, settings.width),
                      bottom = std::min(row + kChangeTileSide, settings.height);
  const std::uint32_t samples = kept_sample_count(settings, frame.mask);
  for (std::uint32_t sample = 0; sample < samples; ++sample) {
    for (std::uint32_t y = row; y < bottom; ++y) {
      if (!(known >> (8 * (y - row)) & 1)) continue;
      const Hit* line = first_hits + (std::size_t(sample) * settings.height + y) * settings.width;
      for (std::uint32_t x = column; x < right; ++x) {
        const Hit& hit = line[x];
        if (sample >= settings.samples_per_pixel && !is_edge(settings, first_hits, x, y)) continue;
        if (hit.triangle == kNoTriangle) {
          tile.t_max = __builtin_inff();
          continue;
        }
        const Triangle& t = frame.scene->triangles[hit.triangle];
        const float weight[3] = {1 - hit.u - hit.v, hit.u, hit.v};
        Vec3 point = {0, 0, 0};
        for (std::uint32_t i = 0; i < 3; ++i) {
          point += frame.geometry.positions[t.vertex(i)] * weight[i];
          reach = std::max(reach, max_component(abs(frame.geometry.positions[t.vertex(i)])));
        }
        tile.t_max = std::max(tile.t_max, hit.t);
        tile.points = merge(tile.points, point);
        if (frame.geometry.normals.count) tile.room = std::max(tile.room, lift_bound(frame, t, point, weight));
      }
    }
  }
  // Shadow rays start off their point by at most 9 times origin_offset(), which is at most 36 · 2^-24 of the largest
  // coordinate of the triangle (keep_off_edges()), or above the curved surface (curved_origin()).
  tile.room += reach * 0x1p-15f;
  return tile;
}

}  // namespace pocketray
