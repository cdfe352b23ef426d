#include "engine/light_map.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "effect/setting_list.h"
#include "indirect/ambient.h"
#include "indirect/environment.h"
#include "plan/resolve.h"
#include "shade/camera.h"
#include "shade/contact.h"
#include "shade/even_points.h"
#include "shade/filters.h"
#include "shade/indirect_light.h"
#include "shade/pixel.h"

namespace pocketray {
namespace {

// As for interleaved pixels (shade/interleaved.cpp): two show the same surface if it is the same triangle, or if the
// second point lies off the first's plane by at most this slope and their normals differ by less than this cosine.
constexpr float kSamePlane = 0.15f, kSameNormal = 0.7f;

bool shows_same(const Surface& s, const MappedSurface& m) {
  if (m.triangle == s.hit.triangle) return true;
  if (!(dot(s.normal, m.normal) > kSameNormal)) return false;
  const Vec3 way = m.point - s.point;
  const float height = dot(s.normal, way);
  return height * height <= kSamePlane * kSamePlane * dot(way, way);
}

// Weighted mean of light from mapped pixels.
struct Mean {
  Vec3 sum = {0, 0, 0};
  float weight = 0;

  void add(const Vec3& light, float w) { sum += light * w, weight += w; }
};

// Mapped pixels [left, right] × [top, bottom] around a place, which is in units of the grid.
struct Neighbourhood {
  std::uint32_t left, right, top, bottom;
};
Neighbourhood around(const LightGrid& grid, const Vec2& place, std::uint32_t reach) {
  const auto x = static_cast<std::uint32_t>(place.x), y = static_cast<std::uint32_t>(place.y);
  return {x < reach ? 0 : x - reach, std::min(x + 1 + reach, grid.columns - 1), y < reach ? 0 : y - reach,
          std::min(y + 1 + reach, grid.rows - 1)};
}

// Adds the mapped pixels that show surface `s`, or any surface if null; `weigh` maps a distance per axis.
template <class Weigh>
void gather(const LightMap& map, const Surface* s, const Vec2& place, const Neighbourhood& n, Weigh weigh, Mean* mean) {
  for (std::uint32_t row = n.top; row <= n.bottom; ++row)
    for (std::uint32_t column = n.left; column <= n.right; ++column) {
      const std::uint32_t at = row * map.grid.columns + column;
      const MappedSurface& m = map.surface[at];
      if (m.triangle == kNone || (s && !shows_same(*s, m))) continue;
      const float weight =
          weigh(std::fabs(place.x - static_cast<float>(column))) * weigh(std::fabs(place.y - static_cast<float>(row)));
      if (weight > 0) mean->add(map.light[at], weight);
    }
}

// Light on a surface seen at a place of the map: from the four mapped pixels around it; if too few show the surface,
// from the sixteen around it; if none does, from any of these. Returns false if they show nothing.
bool light_at(const LightMap& map, const Surface& s, const Vec2& place, Vec3* light) {
  constexpr float kEnough = 1.0f / 64;  // chosen: below, the nearest that shows the surface is at most a pixel away
  constexpr std::uint32_t kWider = 1;
  auto linear = [](float d) { return std::max(0.0f, 1 - d); };
  auto wide = [](float d) { return 1 / (1 + d * d); };
  Mean mean;
  gather(map, &s, place, around(map.grid, place, 0), linear, &mean);
  if (!(mean.weight >= kEnough)) {
    const Neighbourhood wider = around(map.grid, place, kWider);
    mean = Mean();
    gather(map, &s, place, wider, wide, &mean);
    if (!(mean.weight > 0)) gather(map, nullptr, place, wider, wide, &mean);
  }
  if (!(mean.weight > 0)) return false;
  *light = mean.sum * (1 / mean.weight);
  return true;
}

// Finds where the map shows the surface, in units of its grid. Returns false if it does not.
bool place_in_map(const LightMap& map, const CameraRays& camera, bool is_of_frame, std::uint32_t column,
                  std::uint32_t row, const Vec3& point, Vec2* place) {
  const auto pitch = static_cast<float>(map.grid.pitch);
  Vec2 pixel = {static_cast<float>(column), static_cast<float>(row)};
  if (!is_of_frame) {
    if (!place_in_picture(map.camera, point, &pixel)) return false;
    pixel = {pixel.x - 0.5f, pixel.y - 0.5f};
    const bool inside = pixel.x > -1 && pixel.y > -1 && pixel.x < camera.width && pixel.y < camera.height;
    if (!inside) return false;
  }
  *place = {std::clamp(pixel.x / pitch, 0.0f, static_cast<float>(map.grid.columns - 1)),
            std::clamp(pixel.y / pitch, 0.0f, static_cast<float>(map.grid.rows - 1))};
  return true;
}

bool same_camera(const CameraRays& a, const CameraRays& b) {
  return a.eye == b.eye && a.forward == b.forward && a.right == b.right && a.up == b.up &&
         a.near_distance == b.near_distance && a.orthographic == b.orthographic && a.width == b.width &&
         a.height == b.height;
}

// Finds the surface of a sample that takes light from a map, unless it is one that others are seen through. Without
// first hits, traces the sample's ray.
bool find_surface(Tracer* tracer, const Hit* first_hits, std::uint32_t sample, std::uint32_t column, std::uint32_t row,
                  Surface* s) {
  const FrameData& frame = *tracer->frame;
  const Settings& settings = frame.settings;
  Ray ray = pixel_ray(frame, column, row, rook_point(sample, settings.samples_per_pixel));
  Hit hit;
  if (first_hits)
    hit = first_hits[(std::size_t(sample) * settings.height + row) * settings.width + column];
  else
    frame.geometry.first_rays->closest(frame.geometry.accel, ray, visible_filter(frame), &hit, &tracer->stats);
  if (hit.triangle == kNoTriangle) return false;
  float passed;
  if (!visible_surface(tracer, &ray, &hit, s, &passed) || !takes_indirect_light(*s)) return false;
  return !(has(frame.mask, Effect::alpha_blend) && blends(*s->material, frame.mask));
}

struct RowsOfLight {
  Renderer* renderer;
  const Hit* first_hits;
  const LightMap& map;
  bool is_of_frame;
};

bool add_to_row(void* context, std::uint32_t thread, std::uint32_t row) {
  const RowsOfLight& rows = *static_cast<RowsOfLight*>(context);
  Renderer* renderer = rows.renderer;
  Tracer* tracer = &renderer->tracers[thread];
  const FrameData& frame = renderer->frame;
  const std::uint32_t samples = frame.settings.samples_per_pixel;
  const float share = 1 / static_cast<float>(samples);
  Surface s;
  for (std::uint32_t column = 0; column < frame.settings.width; ++column) {
    Vec3 added = {0, 0, 0};
    for (std::uint32_t sample = 0; sample < samples; ++sample) {
      Vec2 place;
      Vec3 light;
      if (!find_surface(tracer, rows.first_hits, sample, column, row, &s)) continue;
      if (!place_in_map(rows.map, frame.view.camera, rows.is_of_frame, column, row, s.point, &place)) continue;
      if (!light_at(rows.map, s, place, &light)) continue;
      added += s.diffuse * (light - indirect_light(tracer, s));
    }
    Vec3* pixel = &renderer->image[std::size_t(row) * frame.settings.width + column];
    *pixel = max(*pixel + added * share, Vec3{0, 0, 0});
  }
  return true;
}

}  // namespace

IndirectChoice own_indirect(const Scene& scene) {
  const bool has_ambient = AmbientIndirect::use(scene) != IndirectUse::nothing;
  return has_ambient || scene.radiosity_values.empty() ? indirect_choice(Effect::ambient) : IndirectChoice::none;
}

const char* mapped_light_unfit(const Renderer& renderer) {
  const EffectMask mask = renderer.effects.mask;
  if (!has(mask, Effect::radiosity) && !has(mask, Effect::instant_radiosity))
    return "the scene has no indirect light but ambient light: give --indirect instant-radiosity, or bake --radiosity";
  const bool mixes = has(mask, Effect::radiosity) || own_indirect(renderer.scene) == IndirectChoice::none;
  if (mixes && environment_of(renderer.scene)) return "radiosity stores the environment's light, too";
  return nullptr;
}

std::size_t first_hit_count(const Settings& settings) {
  return std::size_t(settings.width) * settings.height * (settings.samples_per_pixel + settings.edge_samples);
}

void take_mapped_surfaces(Renderer* renderer, const Hit* first_hits, std::uint32_t traced_end, const LightGrid& grid,
                          MappedSurface* surfaces) {
  CHECK(grid.pitch >= kLightPitchMin && grid.pitch <= kLightPitchMax);
  CHECK(first_hits != nullptr && surfaces != nullptr);
  CHECK_EQ(grid.columns, grid_side(renderer->settings.width, grid.pitch));
  CHECK_EQ(grid.rows, grid_side(renderer->settings.height, grid.pitch));
  Surface s;
  for (std::uint32_t row = 0; row < grid.rows; ++row)
    for (std::uint32_t column = 0; column < grid.columns; ++column) {
      MappedSurface* m = &surfaces[row * grid.columns + column];
      *m = {{0, 0, 0}, {0, 0, 0}, kNone};
      const Hit* hits = row * grid.pitch < traced_end ? first_hits : nullptr;
      if (find_surface(&renderer->tracers[0], hits, 0, column * grid.pitch, row * grid.pitch, &s))
        *m = {s.point, s.normal, s.hit.triangle};
    }
}

void add_mapped_light(Renderer* renderer, const Hit* first_hits, const LightMap& map, std::uint32_t row_begin,
                      std::uint32_t row_end) {
  CHECK(row_begin <= row_end && row_end <= renderer->settings.height);
  CHECK(first_hits != nullptr);
  CHECK(map.surface != nullptr && map.light != nullptr && unshared_because(renderer->effects.mask) == nullptr);
  RowsOfLight rows = {renderer, first_hits, map, same_camera(map.camera, renderer->frame.view.camera)};
  share_items(renderer->workers, row_begin, row_end, add_to_row, &rows);
}

bool is_map_of_frame(const LightMap& map, const Renderer& renderer, double seconds) {
  return map.seconds == seconds && same_camera(map.camera, renderer.frame.view.camera);
}

}  // namespace pocketray
