#include "desktop/reference/optics.h"

#include <limits>

#include "base/fmath.h"
#include "brdf/iridescence.h"
#include "scene/metallic_roughness.h"
#include "shade/media.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

constexpr double kTogether = 0x1p-40;  // relative to coordinates: faces this close are in contact

void cross_faces(const Scene& scene, const ReferenceContact& contact, MediumStack* media) {
  for (bool entering : {false, true})
    for (std::uint32_t i = 0; i < contact.count; ++i) {
      std::uint32_t material = scene.triangles[contact.face[i].triangle].material();
      const Material& m = scene.materials[material];
      if (contact.front[i] != entering || is_zero(m.transmission) || m.thin) continue;
      entering ? enter_medium(media, material) : exit_medium(media, material);
    }
}

}  // namespace

ReferenceRay reference_camera_ray(const CameraRays& c, double column, double row) {
  double sx = 2 * column / static_cast<double>(c.width) - 1, sy = 1 - 2 * row / static_cast<double>(c.height);
  Vec3d across = to_double(c.right) * sx + to_double(c.up) * sy, eye = to_double(c.eye);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Vec3d forward = to_double(c.forward);
  const double near_distance = static_cast<double>(c.near_distance);
  if (c.orthographic) return {eye + across + forward * near_distance, forward, 0, kInfinity};
  const Vec3d way = forward + across;
  return {eye + way * near_distance, normalize(way), 0, kInfinity};
}

ReferenceContact gather_contact(const ReferenceWorld& world, const ReferenceRay& ray, const ReferenceHit& first) {
  const FrameData& frame = *world.frame;
  ReferenceContact contact;
  contact.count = 0;
  double magnitude = 0;
  for (std::uint32_t i = 0; i < 3; ++i) {
    Vec3d p = corner_of(frame, first.triangle, i);
    for (int axis = 0; axis < 3; ++axis) magnitude = std::fmax(magnitude, std::fabs(p[axis]));
  }
  double end = first.t + kTogether * magnitude / length(ray.direction);
  for (ReferenceHit hit = first; hit.t <= end; hit = next_hit(world, ray, &contact.last)) {
    bool front = dot(area_vector(frame, hit.triangle), ray.direction) <= 0, known = false;
    std::uint32_t material = material_index(frame, hit.triangle);
    for (std::uint32_t i = 0; i < contact.count; ++i)
      known = known || (contact.front[i] == front && material_index(frame, contact.face[i].triangle) == material);
    if (!known && contact.count < kMediumDepthMax) {
      contact.face[contact.count] = hit;
      contact.front[contact.count++] = front;
    }
    contact.last = hit;
  }
  return contact;
}

double alpha_of(const FrameData& frame, const ReferenceHit& face) {
  return alpha_at(frame, face.triangle, face.u, face.v);
}

const ReferenceHit* face_behind(const FrameData& frame, const ReferenceContact& contact) {
  const ReferenceHit *body = nullptr, *sheet = nullptr;
  for (std::uint32_t i = 0; i < contact.count; ++i) {
    const ReferenceHit& face = contact.face[i];
    const Material& m = material_of(frame, face.triangle);
    if (is_culled(m, contact.front[i]) || m.alpha_mode == AlphaMode::blend) continue;
    if (is_zero(m.transmission)) return &face;
    const ReferenceHit*& kind = m.thin ? sheet : body;
    if (!kind) kind = &face;
  }
  return body ? body : sheet;
}

Vec3d medium_transmittance(const Scene& scene, const MediumStack& media, double distance) {
  Vec3d result = {1, 1, 1};
  if (media.depth == 0) return result;
  const Vec3& absorption = scene.materials[media.material[media.depth - 1]].absorption;
  for (int c = 0; c < 3; ++c)
    if (absorption[c] > 0) result[c] = det_exp(-static_cast<double>(absorption[c]) * distance);
  return result;
}

double boundary_reflectance(double cos_i, double eta, double* cos_t) {
  *cos_t = 0;
  if (cos_i > 1) cos_i = 1;
  double sin2_t = eta * eta * ((1 - cos_i) * (1 + cos_i));
  if (!(sin2_t < 1)) return 1;
  *cos_t = std::sqrt(1 - sin2_t);
  if (eta == 1) return 0;
  double s = (eta * cos_i - *cos_t) / (eta * cos_i + *cos_t), p = (cos_i - eta * *cos_t) / (cos_i + eta * *cos_t);
  return 0.5 * (s * s + p * p);
}

Vec3d mirrored(const Vec3d& direction, const ReferenceSurface& s, const Vec3d& normal) {
  Vec3d d = direction - normal * (2 * dot(direction, normal));
  if (!(dot(d, s.geometric) > 0)) d = direction - s.geometric * (2 * dot(direction, s.geometric));
  return normalize(d);
}

Vec3d facet_reflectance(const ReferenceSurface& s, double cosine, double eta) {
  double cos_t, reflectance = boundary_reflectance(cosine, eta, &cos_t);
  if (s.material->thin && reflectance < 1) reflectance = 2 * reflectance / (1 + reflectance);  // all orders
  const Vec3d bare = {reflectance, reflectance, reflectance};
  if (!(s.film_strength > 0) || !(reflectance < 1)) return bare;
  const double root = (static_cast<double>(s.material->ior) - 1) / (static_cast<double>(s.material->ior) + 1);
  const Vec3d base = Vec3d{1, 1, 1} * (root * root);
  return bare * (1 - s.film_strength) +
         film_reflectance(s.film_ior, s.film_thickness, base, eta < 1 ? cosine : cos_t) * s.film_strength;
}

Vec3d transmission_of(const FrameData& frame, const ReferenceHit& face, const Vec3d& direction) {
  const std::uint32_t material = material_index(frame, face.triangle);
  if (!has(frame.mask, Effect::transmission_map) || !glass_map_of(*frame.scene, material))
    return to_double(frame.scene->materials[material].transmission);
  return reference_surface(frame, face, direction).transmission;
}

ReferenceBoundary meet_boundary(const FrameData& frame, const ReferenceSurface& s, const ReferenceContact& contact,
                                const Vec3d& direction, const MediumStack& media) {
  const Scene& scene = *frame.scene;
  ReferenceBoundary b = {{0, 0, 0}, {1, 1, 1}, direction, {0, 0, 0}, 1, media};
  double eta = 1 / static_cast<double>(s.material->ior);
  if (!s.material->thin) {
    cross_faces(scene, contact, &b.beyond);
    eta = static_cast<double>(medium_ior(scene, media)) / static_cast<double>(medium_ior(scene, b.beyond));
  }
  Vec3d n = -dot(direction, s.normal) > 0 ? s.normal : s.geometric;
  double cos_i = -dot(direction, n), cos_t;
  boundary_reflectance(cos_i, eta, &cos_t);
  b.normal = n, b.eta = eta, b.reflectance = facet_reflectance(s, cos_i, eta);
  for (std::uint32_t i = 0; i < contact.count; ++i) {
    const Material& m = material_of(frame, contact.face[i].triangle);
    if (!is_zero(m.transmission) && (contact.front[i] || m.thin))
      b.tint *= transmission_of(frame, contact.face[i], direction);
  }
  if (s.material->thin) return b;
  Vec3d bent = normalize(direction * eta + n * (eta * cos_i - cos_t));
  if (dot(bent, s.geometric) < 0) b.direction = bent;  // otherwise the shading normal deviates too far
  return b;
}

}  // namespace pocketray
