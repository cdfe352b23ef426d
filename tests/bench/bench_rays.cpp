#include "bench/bench_rays.h"

#include "base/fmath.h"
#include "base/rng.h"
#include "shade/camera.h"

namespace pocketray {
namespace {

// Bits 0, 2 and 4, side by side.
std::uint32_t even_bits(std::uint32_t slot) { return (slot & 1) | (slot >> 1 & 2) | (slot >> 2 & 4); }

struct Start {
  Vec3 origin, normal;  // on the side that the primary ray came from
};

// False for a triangle without a normal.
bool start_at(const BenchScene& bench, const Ray& ray, const Hit& hit, Start* start) {
  const Scene& scene = bench.scene();
  const Triangle& t = scene.triangles[hit.triangle];
  Vec3 a = scene.positions[t.vertex(0)], b = scene.positions[t.vertex(1)], c = scene.positions[t.vertex(2)];
  Vec3 normal = normalize(cross(b - a, c - a));
  if (is_zero(normal)) return false;
  start->normal = dot(normal, ray.direction) > 0 ? -normal : normal;
  // Far enough in front that no mode of either side hits the surface the ray leaves.
  float in_front = length(extent(bench.bounds)) * 0x1p-16f;
  start->origin = a * (1 - hit.u - hit.v) + b * hit.u + c * hit.v + start->normal * in_front;
  return true;
}

Vec3 cosine_direction(const Vec3& normal, Rng* rng) {
  float radius = std::sqrt(next_float(rng));
  double azimuth = 2 * kPi * next_double(rng);
  Vec3 tangent, bitangent;
  make_basis(normal, &tangent, &bitangent);
  return normalize(tangent * (radius * static_cast<float>(det_cos(azimuth))) +
                   bitangent * (radius * static_cast<float>(det_sin(azimuth))) +
                   normal * std::sqrt(1 - radius * radius));
}

template <class MakeRay>
RaySet make_secondary(RayKindOfBench kind, const BenchScene& scene, const RaySet& primary, const std::vector<Hit>& hits,
                      MakeRay make_ray) {
  RaySet set = {kind, primary.width, primary.height, {}, {0}};
  for (std::size_t i = 0; i < hits.size(); ++i) {
    Start start;
    if (hits[i].triangle != kNoTriangle && start_at(scene, primary.rays[i], hits[i], &start))
      set.rays.push_back(make_ray(start));
    if (i % kRayTileSize == kRayTileSize - 1) set.tile_begin.push_back(set.rays.size());
  }
  return set;
}

}  // namespace

Status make_primary_rays(const BenchScene& scene, std::uint32_t width, std::uint32_t height, RaySet* set) {
  if (width == 0 || height == 0 || width % kRayTileSide || height % kRayTileSide)
    return failure("--size %ux%u: width and height must be multiples of %u", width, height, kRayTileSide);
  CameraRays camera;
  RETURN_IF_ERROR(make_camera_rays(scene.camera, width, height, &camera));
  if (camera.orthographic)
    return failure("%s has an orthographic camera: primary rays must share the eye", scene.name.c_str());
  *set = {RayKindOfBench::primary, width, height, {}, {}};
  set->rays.reserve(static_cast<std::size_t>(width) * height);
  for (std::uint32_t y0 = 0; y0 < height; y0 += kRayTileSide)
    for (std::uint32_t x0 = 0; x0 < width; x0 += kRayTileSide)
      for (std::uint32_t slot = 0; slot < kRayTileSize; ++slot) {
        std::uint32_t x = x0 + even_bits(slot), y = y0 + even_bits(slot >> 1);
        set->rays.push_back(camera_ray(camera, static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
      }
  return success();
}

RaySet make_shadow_rays(const BenchScene& scene, const RaySet& primary, const std::vector<Hit>& hits,
                        float light_distance) {
  Vec3 forward = normalize(scene.camera.target - scene.camera.eye);
  Vec3 right = normalize(cross(forward, scene.camera.up)), up = cross(right, forward);
  Vec3 light = scene.camera.eye + (right + up) * (length(extent(scene.bounds)) * light_distance);
  return make_secondary(RayKindOfBench::shadow, scene, primary, hits, [&](const Start& start) {
    return Ray{start.origin, light - start.origin, 0.999f};
  });
}

RaySet make_bounce_rays(const BenchScene& scene, const RaySet& primary, const std::vector<Hit>& hits) {
  Rng rng = make_rng(1);
  return make_secondary(RayKindOfBench::bounce, scene, primary, hits, [&](const Start& start) {
    return Ray{start.origin, cosine_direction(start.normal, &rng), __builtin_inff()};
  });
}

}  // namespace pocketray
