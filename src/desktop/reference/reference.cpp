#include "desktop/reference/reference.h"

#include <algorithm>
#include <limits>

#include "base/check.h"
#include "base/fmath.h"
#include "brdf/rough_refraction.h"
#include "desktop/reference/environment.h"
#include "desktop/reference/guide.h"
#include "desktop/reference/light.h"
#include "scene/metallic_roughness.h"
#include "shade/media.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kSureDepth = 4;  // scatterings before Russian roulette
constexpr double kSurvivalMax = 0.98;    // every path ends eventually

struct Path {
  Vec3d weight = {1, 1, 1};
  double worth = 1;  // throughput by the surfaces alone, however directions were sampled
  MediumStack media;
  bool sees_lights = true;  // in full: not sampled by next-event estimation
  Vec3d scattered_at;       // origin of the last next-event estimation,
  double density = 0;       // and density with which the path left it
};

// Picks the face of a contact with which the ray interacts: a blending one with the probability of its opacity, else
// the one behind. Null: the ray passes.
const ReferenceHit* pick_face(const FrameData& frame, const ReferenceContact& contact, ReferenceSamples* samples) {
  for (std::uint32_t i = 0; i < contact.count; ++i)
    if (lies_over(frame, contact, i) && samples->next() < alpha_of(frame, contact.face[i])) return &contact.face[i];
  return face_behind(frame, contact);
}

// Finds the surface that a ray meets, beyond those it passes. Returns false if there is none. Applies absorption.
bool find_surface(const Reference& reference, const ReferenceRay& ray, Path* path, ReferenceSamples* samples,
                  ReferenceSurface* s, ReferenceContact* contact) {
  const FrameData& frame = *reference.world.frame;
  double passed = 0;
  ReferenceHit hit = next_hit(reference.world, ray, nullptr);
  for (; hit.triangle != kNone; hit = next_hit(reference.world, ray, &contact->last)) {
    path->weight *= medium_transmittance(*frame.scene, path->media, hit.t - passed);
    passed = hit.t;
    contact->count = 0;
    contact->last = hit;
    const ReferenceHit* face = &hit;
    if (may_be_passed(material_of(frame, hit.triangle))) {
      *contact = gather_contact(reference.world, ray, hit);
      face = pick_face(frame, *contact, samples);
    }
    if (!face) continue;
    *s = reference_surface(frame, *face, ray.direction);
    return true;
  }
  return false;
}

// Reflects or transmits a path at a glass boundary by a uniform number; false: it ends.
bool pass_boundary(const FrameData& frame, const ReferenceSurface& s, const ReferenceBoundary& boundary, double choice,
                   const Vec3d& way, Path* path, ReferenceSamples* samples, Vec3d* direction) {
  const bool is_rough = scatters_passing_light(frame, s);
  const double alpha = is_rough ? facet_alpha<double>(lobes_of(s)) : 0;
  Vec3d facet = boundary.normal, reflectance = boundary.reflectance;
  if (is_rough) {
    const Pair pair = samples->direction();
    facet = visible_facet(boundary.normal, -way, alpha, pair.u, pair.v);
    reflectance = facet_reflectance(s, -dot(way, facet), boundary.eta);
  }
  const double share = max_component(reflectance);
  if (choice < share) {
    path->weight *= reflectance / share;
    *direction = mirrored(way, s);
    if (!is_rough) return true;
    if (!leaves_body(s)) {  // the glossy lobe has the rest
      path->weight = path->weight * static_cast<double>(mirror_share(lobes_of(s).roughness));
      return !is_zero(path->weight);
    }
    *direction = way - facet * (2 * dot(way, facet));
    return dot(*direction, s.geometric) > 0;
  }
  path->weight *= boundary.tint * (Vec3d{1, 1, 1} - reflectance) / (1 - share);
  path->media = boundary.beyond;
  *direction = boundary.direction;
  if (!is_rough) return true;
  *direction = passed_direction(lobes_of(s), way, boundary.normal, facet, boundary.eta);
  path->weight = path->weight * unmasked_share(dot(*direction, boundary.normal), alpha);
  return !is_zero(path->weight) && dot(*direction, s.geometric) < 0;
}

// Continues the path by one of the surface's lobes; false: it ends. Sets the weight and the data for the next emitter.
bool scatter(const Reference& reference, const ReferenceOptions& options, const ReferenceSurface& s,
             const ReferenceContact& contact, ReferenceRay* ray, Path* path, ReferenceSamples* samples) {
  const FrameData& frame = *reference.world.frame;
  Vec3d mirror = s.mirror, to_viewer = -ray->direction;
  double mirror_share = max_component(mirror), glass_share = is_zero(s.transmission) ? 0 : 1, lobe_share = 0;
  if (options.transport == Transport::physical) lobe_share = lobe_weight(s, to_viewer);
  double total = mirror_share + glass_share + lobe_share + s.coat_mirror;
  if (!(total > 0)) return false;
  double choice = samples->choice() * total;  // rescaled after the choice, it is uniform again
  path->worth *= std::fmin(1, total);
  path->sees_lights = true;
  Vec3d direction;
  if (choice < mirror_share) {
    path->weight *= mirror * (total / mirror_share);
    direction = mirrored(ray->direction, s);
  } else if ((choice -= mirror_share) < s.coat_mirror) {
    path->weight = path->weight * total;
    direction = mirrored(ray->direction, s, s.coat_normal);
  } else if ((choice -= s.coat_mirror) < glass_share) {
    path->weight = path->weight * (s.passes * total / glass_share);
    const ReferenceBoundary boundary = meet_boundary(frame, s, contact, ray->direction, path->media);
    if (!pass_boundary(frame, s, boundary, choice / glass_share, ray->direction, path, samples, &direction))
      return false;
  } else {
    choice = (choice - glass_share) / lobe_share;
    if (!sample_guided(s, to_viewer, choice, samples->direction(), &direction)) return false;
    path->density = guided_density(s, to_viewer, direction);
    if (!(path->density > 0)) return false;
    path->weight *=
        lobe_value(s, to_viewer, direction) * (dot(s.normal, direction) / path->density * (total / lobe_share));
    path->sees_lights = false;
    path->scattered_at = s.point;
  }
  *ray = leave(frame, s, direction, kInfinity);
  return !is_zero(path->weight);
}

// Goes on with the light of one side of a surface that light passes diffusely.
void choose_side(const Vec3d& to_viewer, ReferenceSurface* s, Path* path, ReferenceSamples* samples) {
  const double behind = max_component(s->passing),
               all = behind + lobe_weight(*s, to_viewer) + max_component(s->mirror) + s->coat_mirror;
  const double share = is_zero(s->transmission) ? behind / all : 0.5;
  if (samples->next() < share)
    path->weight = path->weight / share, *s = other_side(*s);
  else
    path->weight = path->weight / (1 - share);
}

// Share of an emitter's radiance credited to a path that meets it.
double emission_weight(const Reference& reference, const ReferenceSurface& s, const Vec3d& direction,
                       const Path& path) {
  if (path.sees_lights) return 1;
  double cos_light = -dot(s.geometric, direction), area_density = emitter_density(reference, s.triangle);
  if (!(area_density > 0) || !(cos_light > 0)) return 1;
  Vec3d way = s.point - path.scattered_at;
  return power_heuristic(path.density, area_density * dot(way, way) / cos_light);
}

// Share of the environment's radiance credited to a path that meets it.
double environment_weight(const Reference& reference, const Vec3d& direction, const Path& path) {
  if (path.sees_lights || reference.environment_shares.empty()) return 1;
  return power_heuristic(path.density, environment_density(reference, direction));
}

// One sample of the radiance towards the viewer directly from lights, and that which is not carried by paths.
Vec3d received(const Reference& reference, const ReferenceOptions& options, const ReferenceSurface& s,
               const Vec3d& to_viewer, bool goes_on, ReferenceSamples* samples) {
  const bool model = options.transport == Transport::model;
  Vec3d sum = exact_indirect(*reference.world.frame->scene, s.even, model) * s.open;
  if (model) sum += reflected_surroundings(*reference.world.frame, s, to_viewer);
  if (lobe_weight(s, to_viewer) > 0) sum += sample_direct_light(reference, options, s, to_viewer, goes_on, samples);
  return sum;
}

// One sample of the radiance that arrives along a ray.
Vec3d trace_path(const Reference& reference, const ReferenceOptions& options, ReferenceRay ray,
                 ReferenceSamples* samples) {
  const FrameData& frame = *reference.world.frame;
  bool model = options.transport == Transport::model;
  Vec3d sum = {0, 0, 0};
  Path path;
  path.media = frame.view.eye_media;
  for (std::uint32_t depth = 0;; ++depth) {
    ReferenceSurface s;
    ReferenceContact contact;
    if (!find_surface(reference, ray, &path, samples, &s, &contact))
      return sum +
             path.weight * radiance_behind(frame, ray.direction) * environment_weight(reference, ray.direction, path);
    if (s.material->unlit && has(frame.mask, Effect::emission)) return sum + path.weight * s.diffuse;
    if (!is_zero(s.emission)) sum += path.weight * s.emission * emission_weight(reference, s, ray.direction, path);
    const bool goes_on = depth < options.depth_max;
    if (model && !is_zero(s.passing))
      sum += path.weight * received(reference, options, other_side(s), -ray.direction, goes_on, samples);
    if (!model && !is_zero(s.passing)) choose_side(-ray.direction, &s, &path, samples);
    if (!model) s.cell = find_cell(reference.guide, s.point);
    sum += path.weight * received(reference, options, s, -ray.direction, goes_on, samples);
    bool is_last = depth >= options.depth_max;
    if ((is_last && !model) || !scatter(reference, options, s, contact, &ray, &path, samples)) return sum;
    if (is_last) return sum + path.weight * radiance_beyond_depth(frame, ray.direction);
    if (depth < kSureDepth) continue;
    double survival = std::fmin(kSurvivalMax, path.worth);
    if (!(samples->next() < survival)) return sum;
    path.weight = path.weight / survival, path.worth /= survival;
  }
}

}  // namespace

std::size_t reference_need(const FrameData& frame) {
  std::uint32_t count = frame.scene->triangles.count;
  return reference_world_need(count) + arena_need<ReferenceEmitter>(count) + environment_shares_need(frame) +
         reference_guide_need(count);
}

Reference make_reference(const FrameData& frame, Arena* arena, std::uint32_t guide_path_count) {
  CHECK(frame.scene != nullptr && arena != nullptr);
  const std::size_t used = arena->used;
  Reference reference;
  reference.world = make_reference_world(frame, arena);
  reference.emitters = arena_array<ReferenceEmitter>(arena, frame.scene->triangles.count);
  reference.emitters.count = find_parts(frame, emitted_power, reference.emitters.data);
  reference.environment_shares = make_environment_shares(frame, arena);
  make_reference_guide(frame, guide_path_count, arena, &reference);
  CHECK_LE(arena->used - used, reference_need(frame));
  return reference;
}

Vec3d sample_radiance(const Reference& reference, const ReferenceOptions& options, const Vec3d& origin,
                      const Vec3d& direction, Rng* rng) {
  ReferenceSamples samples(*rng);
  Vec3d radiance = trace_path(reference, options, {origin, direction, 0, kInfinity}, &samples);
  *rng = samples.rng();
  return radiance;
}

namespace {

// Calls add(column, radiance) with every sample of a row.
template <class Add>
void for_samples(const Reference& reference, const ReferenceOptions& options, std::uint32_t row, Add add) {
  const CameraRays& camera = reference.world.frame->view.camera;
  std::uint32_t width = static_cast<std::uint32_t>(camera.width);
  CHECK_GT(options.samples_per_pixel, 0u);
  CHECK_LT(row, static_cast<std::uint32_t>(camera.height));
  for (std::uint32_t x = 0; x < width; ++x) {
    ReferenceSamples samples(options.seed, std::uint64_t(row) * width + x);
    for (std::uint32_t i = 0; i < options.samples_per_pixel; ++i) {
      samples.begin_path(options.first_sample + i);
      Pair at = samples.pixel();
      add(x, trace_path(reference, options, reference_camera_ray(camera, x + at.u, row + at.v), &samples));
    }
  }
}

}  // namespace

void trace_reference(const Reference& reference, const ReferenceOptions& options, std::uint32_t row_begin,
                     std::uint32_t row_end, Vec3d* means) {
  const CameraRays& camera = reference.world.frame->view.camera;
  CHECK(row_begin <= row_end && row_end <= static_cast<std::uint32_t>(camera.height));
  CHECK(means != nullptr);
  std::uint32_t width = static_cast<std::uint32_t>(camera.width);
  for (std::uint32_t row = row_begin; row < row_end; ++row, means += width) {
    std::fill_n(means, width, Vec3d{0, 0, 0});
    for_samples(reference, options, row, [&](std::uint32_t x, const Vec3d& radiance) { means[x] += radiance; });
    for (std::uint32_t x = 0; x < width; ++x) means[x] = means[x] / static_cast<double>(options.samples_per_pixel);
  }
}

void add_reference(const Reference& reference, const ReferenceOptions& options, std::uint32_t row, ExactSum* sums) {
  CHECK(sums != nullptr);
  for_samples(reference, options, row, [&](std::uint32_t x, const Vec3d& radiance) {
    for (int c = 0; c < 3; ++c) add(exact_term(radiance[c]), sums + 3 * x + c);
  });
}

}  // namespace pocketray
