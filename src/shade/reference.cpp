#include "shade/reference.h"

#include <limits>

#include "base/fmath.h"
#include "shade/media.h"
#include "shade/reference_light.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kSureDepth = 4;  // scatterings before Russian roulette
constexpr double kSurvivalMax = 0.98;    // with which every path ends some time

struct Path {
  Vec3d weight = {1, 1, 1};
  MediumStack media;
  bool sees_lights = true;  // in full: no next-event estimation has looked for them
  Vec3d scattered_at;       // the point that next-event estimation looked from,
  double density = 0;       // and the density with which the path left it
};

const Material& material_of(const FrameData& frame, const ReferenceHit& hit) {
  return frame.scene->materials[frame.scene->triangles[hit.triangle].material()];
}

// The face of a contact that the ray is at: a blending one as often as it covers; else what is behind them: something
// opaque, else a body that is entered or left, else a thin sheet. Null: the ray passes.
const ReferenceHit* pick_face(const FrameData& frame, const ReferenceContact& contact, Rng* rng) {
  const ReferenceHit *body = nullptr, *sheet = nullptr, *opaque = nullptr;
  for (std::uint32_t i = 0; i < contact.count; ++i) {
    const ReferenceHit& face = contact.face[i];
    const Material& m = material_of(frame, face);
    if (is_culled(m, contact.front[i])) continue;
    if (m.alpha_mode == AlphaMode::blend) {
      double alpha = static_cast<double>(hit_alpha(*frame.scene, m, face.triangle, static_cast<float>(face.u),
                                                   static_cast<float>(face.v), frame.settings.texture_filter));
      if (next_double(rng) < alpha) return &face;
      continue;
    }
    const ReferenceHit*& kind = is_zero(m.transmission) ? opaque : m.thin ? sheet : body;
    if (!kind) kind = &face;
  }
  return opaque ? opaque : body ? body : sheet;
}

// The surface that a ray meets, past what it does not see. False: none. Takes what bodies absorb on the way.
bool find_surface(const Reference& reference, const ReferenceRay& ray, Path* path, Rng* rng, ReferenceSurface* s,
                  ReferenceContact* contact) {
  const FrameData& frame = *reference.world.frame;
  double passed = 0;
  ReferenceHit hit = next_hit(reference.world, ray, nullptr);
  for (; hit.triangle != kNone; hit = next_hit(reference.world, ray, &contact->last)) {
    if (path->media.depth > 0) {
      const Material& m = frame.scene->materials[path->media.material[path->media.depth - 1]];
      for (int c = 0; c < 3; ++c) path->weight[c] *= det_exp(-static_cast<double>(m.absorption[c]) * (hit.t - passed));
    }
    passed = hit.t;
    contact->count = 0;
    contact->last = hit;
    const ReferenceHit* face = &hit;
    const Material& m = material_of(frame, hit);
    if (!m.double_sided || m.alpha_mode == AlphaMode::blend || !is_zero(m.transmission)) {  // it may be passed
      *contact = gather_contact(reference.world, ray, hit);
      face = pick_face(frame, *contact, rng);
    }
    if (!face) continue;
    *s = reference_surface(frame, *face, ray.direction);
    return true;
  }
  return false;
}

void cross_faces(const Scene& scene, const ReferenceContact& contact, MediumStack* media) {
  for (bool entering : {false, true})
    for (std::uint32_t i = 0; i < contact.count; ++i) {
      std::uint32_t material = scene.triangles[contact.face[i].triangle].material();
      const Material& m = scene.materials[material];
      if (contact.front[i] != entering || is_zero(m.transmission) || m.thin) continue;
      entering ? enter_medium(media, material) : exit_medium(media, material);
    }
}

Vec3d mirrored(const Vec3d& direction, const ReferenceSurface& s) {
  Vec3d d = direction - s.normal * (2 * dot(direction, s.normal));
  if (!(dot(d, s.geometric) > 0)) d = direction - s.geometric * (2 * dot(direction, s.geometric));
  return normalize(d);
}

// Reflects or transmits at a boundary, as often as the Fresnel equations say.
Vec3d cross_boundary(const FrameData& frame, const ReferenceSurface& s, const ReferenceContact& contact,
                     const Vec3d& direction, Path* path, Rng* rng) {
  const Scene& scene = *frame.scene;
  MediumStack beyond = path->media;
  double eta;
  if (s.material->thin) {
    eta = 1 / static_cast<double>(s.material->ior);
  } else {
    cross_faces(scene, contact, &beyond);
    eta = static_cast<double>(medium_ior(scene, path->media)) / static_cast<double>(medium_ior(scene, beyond));
  }
  Vec3d n = -dot(direction, s.normal) > 0 ? s.normal : s.geometric;
  double cos_i = -dot(direction, n), cos_t, reflectance = boundary_reflectance(cos_i, eta, &cos_t);
  if (s.material->thin && reflectance < 1) reflectance = 2 * reflectance / (1 + reflectance);
  if (next_double(rng) < reflectance) return mirrored(direction, s);
  for (std::uint32_t i = 0; i < contact.count; ++i) {
    const Material& m = material_of(frame, contact.face[i]);
    if (!is_zero(m.transmission) && (contact.front[i] || m.thin)) path->weight *= to_double(m.transmission);
  }
  path->media = beyond;
  if (s.material->thin) return direction;
  Vec3d bent = normalize(direction * eta + n * (eta * cos_i - cos_t));
  return dot(bent, s.geometric) < 0 ? bent : direction;
}

// Where the path goes on, by one of the surface's lobes; false: nowhere. Sets the weight and what the next emitter it
// meets has to know.
bool scatter(const FrameData& frame, const ReferenceOptions& options, const ReferenceSurface& s,
             const ReferenceContact& contact, ReferenceRay* ray, Path* path, Rng* rng) {
  const Material& m = *s.material;
  Vec3d mirror = to_double(m.mirror), to_viewer = -ray->direction;
  double mirror_share = max_component(mirror), glass_share = is_zero(m.transmission) ? 0 : 1, lobe_share = 0;
  if (options.transport == Transport::physical)
    lobe_share = max_component(s.diffuse) + static_cast<double>(max_component(m.specular));
  double total = mirror_share + glass_share + lobe_share, pick = next_double(rng) * total;
  if (!(total > 0)) return false;
  path->sees_lights = true;
  Vec3d direction;
  if (pick < mirror_share) {
    path->weight *= mirror * (total / mirror_share);
    direction = mirrored(ray->direction, s);
  } else if (pick < mirror_share + glass_share) {
    path->weight = path->weight * (total / glass_share);
    direction = cross_boundary(frame, s, contact, ray->direction, path, rng);
  } else {
    if (!sample_lobes(s, to_viewer, rng, &direction)) return false;
    path->density = lobe_density(s, to_viewer, direction);
    if (!(path->density > 0)) return false;
    path->weight *=
        lobe_value(s, to_viewer, direction) * (dot(s.normal, direction) / path->density * (total / lobe_share));
    path->sees_lights = false;
    path->scattered_at = s.point;
  }
  *ray = leave(frame, s, direction, kInfinity);
  return !is_zero(path->weight);
}

// The share of an emitter's radiance that falls to a path which meets it.
double emission_weight(const Reference& reference, const ReferenceSurface& s, const Vec3d& direction,
                       const Path& path) {
  if (path.sees_lights) return 1;
  double cos_light = -dot(s.geometric, direction), area_density = emitter_density(reference, s.triangle);
  if (!(area_density > 0) || !(cos_light > 0)) return 1;
  Vec3d way = s.point - path.scattered_at;
  return power_heuristic(path.density, area_density * dot(way, way) / cos_light);
}

}  // namespace

std::size_t reference_need(const FrameData& frame) {
  std::uint32_t count = frame.scene->triangles.count;
  return reference_world_need(count) + arena_need<ReferenceEmitter>(count);
}

Reference make_reference(const FrameData& frame, Arena* arena) {
  Reference reference;
  reference.world = make_reference_world(frame, arena);
  reference.emitters = arena_array<ReferenceEmitter>(arena, frame.scene->triangles.count);
  reference.emitters.count = find_emitters(frame, reference.emitters.data);
  return reference;
}

Vec3d sample_radiance(const Reference& reference, const ReferenceOptions& options, const Vec3d& origin,
                      const Vec3d& direction, Rng* rng) {
  const FrameData& frame = *reference.world.frame;
  const SceneInfo& info = frame.scene->info;
  bool model = options.transport == Transport::model;
  Vec3d sum = {0, 0, 0};
  Path path;
  path.media = frame.eye_media;
  ReferenceRay ray = {origin, direction, 0, kInfinity};
  for (std::uint32_t depth = 0;; ++depth) {
    ReferenceSurface s;
    ReferenceContact contact;
    if (!find_surface(reference, ray, &path, rng, &s, &contact)) return sum + path.weight * to_double(info.background);
    if (s.material->unlit) return sum + path.weight * s.diffuse;
    if (!is_zero(s.emission)) sum += path.weight * s.emission * emission_weight(reference, s, ray.direction, path);
    if (model) sum += path.weight * s.diffuse * to_double(info.ambient);
    if (!is_zero(s.diffuse) || !is_zero(s.material->specular))
      sum += path.weight * sample_direct_light(reference, options, s, -ray.direction, rng);
    if (depth >= options.depth_max || !scatter(frame, options, s, contact, &ray, &path, rng)) return sum;
    if (depth < kSureDepth) continue;
    double survival = std::fmin(kSurvivalMax, max_component(path.weight));
    if (!(next_double(rng) < survival)) return sum;
    path.weight = path.weight / survival;
  }
}

void trace_reference(const Reference& reference, const ReferenceOptions& options, std::uint32_t row_begin,
                     std::uint32_t row_end, Vec3d* means) {
  const CameraRays& c = reference.world.frame->camera;
  std::uint32_t width = static_cast<std::uint32_t>(c.width), n = options.samples_per_pixel, side = 1;
  while (side * side < n) ++side;
  if (side * side != n) side = 1;
  Vec3d eye = to_double(c.eye), forward = to_double(c.forward), right = to_double(c.right), up = to_double(c.up);
  for (std::uint32_t y = row_begin; y < row_end; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      Rng rng = make_rng(options.seed, std::uint64_t(y) * width + x);
      Vec3d sum = {0, 0, 0};
      for (std::uint32_t i = 0; i < n; ++i) {
        double column = x + (i % side + next_double(&rng)) / side,
               row = y + (i / side % side + next_double(&rng)) / side;
        double sx = 2 * column / static_cast<double>(c.width) - 1, sy = 1 - 2 * row / static_cast<double>(c.height);
        Vec3d across = right * sx + up * sy;
        sum += c.orthographic ? sample_radiance(reference, options, eye + across, forward, &rng)
                              : sample_radiance(reference, options, eye, normalize(forward + across), &rng);
      }
      means[std::size_t(y - row_begin) * width + x] = sum / static_cast<double>(n);
    }
}

}  // namespace pocketray
