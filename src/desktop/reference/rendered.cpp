#include "desktop/reference/rendered.h"

#include <limits>

#include "base/check.h"
#include "desktop/reference/environment.h"
#include "desktop/reference/light.h"
#include "scene/metallic_roughness.h"
#include "shade/rough_glass.h"
#include "shade/sample_points.h"
#include "shade/trace_spans.h"

namespace pocketray {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Branch {
  std::uint32_t depth;  // reflections and refractions so far
  MediumStack media;
  double width = 0;  // BeamWidth::alpha
};

Vec3d follow(const Reference& reference, const ReferenceRay& ray, const Branch& branch);

// Radiance of a beam that hits nothing.
Vec3d radiance_behind(const FrameData& frame, const Vec3d& direction, const Branch& branch, const Vec3d& thin) {
  if (!(branch.width > 0) || !has(frame.mask, Effect::environment) || !environment_of(*frame.scene)) return thin;
  return to_double(environment_in_beam(*frame.scene, to_float(direction), static_cast<float>(branch.width)));
}

Vec3d spawn(const Reference& reference, const ReferenceSurface& s, const Vec3d& direction, const Vec3d& weight,
            const Branch& from, const MediumStack& media) {
  const FrameData& frame = *reference.world.frame;
  if (is_zero(weight)) return {0, 0, 0};
  if (from.depth >= frame.settings.ray_depth)
    return weight * radiance_behind(frame, direction, from, radiance_beyond_depth(frame, direction));
  return weight * follow(reference, leave(frame, s, direction, kInfinity), {from.depth + 1, media, from.width});
}

// Light that passes a glass boundary; `passing` is the fraction that is not reflected.
Vec3d transmitted(const Reference& reference, const ReferenceSurface& s, const ReferenceBoundary& b, const Vec3d& way,
                  const Vec3d& passing, const Branch& branch) {
  const Vec3d weight = b.tint * passing * s.passes;
  Branch beam = branch;
  if (!scatters_passing_light(*reference.world.frame, s)) {
    if (!s.material->thin) beam.width *= b.eta;
    return spawn(reference, s, b.direction, weight, beam, b.beyond);
  }
  const Material& m = lobes_of(s);
  const FacetPassage<double> passage = through_facets(m, way, b.normal, b.eta);
  beam.width = widened_beam(m, branch.width, b.eta);
  if (!(passage.share > 0) || !(dot(passage.direction, s.geometric) < 0)) return {0, 0, 0};
  return spawn(reference, s, passage.direction, weight * passage.share, beam, b.beyond);
}

// Radiance of the lobes that the renderer adds up over lights, and of stored light; `open` is the unoccluded fraction.
Vec3d scattered(const Reference& reference, const ReferenceSurface& s, const Vec3d& to_viewer, double open) {
  const FrameData& frame = *reference.world.frame;
  Vec3d sum = exact_indirect_of(*frame.scene, s.even, frame.mask) * open;
  sum += reflected_surroundings(frame, s, to_viewer) + environment_light_as_rendered(reference, s, to_viewer);
  if (lobe_weight(s, to_viewer) > 0) sum += sum_light_points(reference, s, to_viewer, true, true);
  return sum;
}

// Radiance that leaves a surface back along the ray.
Vec3d shade(const Reference& reference, const ReferenceRay& ray, const ReferenceSurface& s,
            const ReferenceContact& contact, const Branch& branch) {
  const FrameData& frame = *reference.world.frame;
  const Material& m = *s.material;
  if (m.unlit && has(frame.mask, Effect::emission)) return s.diffuse;
  const double open = has(frame.mask, Effect::ambient) ? s.open : 1;
  Vec3d sum = s.emission + scattered(reference, s, -ray.direction, open);
  if (!is_zero(s.passing)) sum += scattered(reference, other_side(s), -ray.direction, 1);
  Vec3d turned = {0, 0, 0};
  if (!is_zero(lobes_of(s).mirror)) turned += s.mirror;
  if (!is_zero(s.transmission)) {
    const ReferenceBoundary b = meet_boundary(frame, s, contact, ray.direction, branch.media);
    Vec3d reflected = b.reflectance, passing = Vec3d{1, 1, 1} - reflected;
    if (scatters_passing_light(frame, s)) divide_at_facets(s, lobes_of(s), &reflected, &passing);
    turned += reflected * s.passes;
    sum += transmitted(reference, s, b, ray.direction, passing, branch);
  }
  const Vec3d by_coat = {s.coat_mirror, s.coat_mirror, s.coat_mirror};
  sum += spawn(reference, s, mirrored(ray.direction, s, s.coat_normal), by_coat, branch, branch.media);
  if (!is_zero(turned)) sum += spawn(reference, s, mirrored(ray.direction, s), turned, branch, branch.media);
  return sum;
}

Vec3d follow(const Reference& reference, const ReferenceRay& ray, const Branch& branch) {
  const FrameData& frame = *reference.world.frame;
  Vec3d sum = {0, 0, 0}, carried = {1, 1, 1};  // throughput of the blended surfaces
  double passed = 0;
  ReferenceContact contact;
  ReferenceHit hit = next_hit(reference.world, ray, nullptr);
  for (; hit.triangle != kNone; hit = next_hit(reference.world, ray, &contact.last)) {
    carried *= medium_transmittance(*frame.scene, branch.media, hit.t - passed);
    passed = hit.t;
    contact.count = 0;
    contact.last = hit;
    const ReferenceHit* face = &hit;
    if (may_be_passed(material_of(frame, hit.triangle))) {
      contact = gather_contact(reference.world, ray, hit);
      for (std::uint32_t i = 0; i < contact.count; ++i) {
        if (!lies_over(frame, contact, i)) continue;
        double alpha = alpha_of(frame, contact.face[i]);
        ReferenceSurface over = reference_surface(frame, contact.face[i], ray.direction);
        if (alpha > 0) sum += carried * alpha * shade(reference, ray, over, contact, branch);
        carried = carried * (1 - alpha);
      }
      if (is_zero(carried)) return sum;
      face = face_behind(frame, contact);
    }
    if (!face) continue;
    return sum + carried * shade(reference, ray, reference_surface(frame, *face, ray.direction), contact, branch);
  }
  return sum + carried * radiance_behind(frame, ray.direction, branch, radiance_behind(frame, ray.direction));
}

}  // namespace

void trace_as_rendered(const Reference& reference, std::uint32_t row_begin, std::uint32_t row_end, Vec3d* picture) {
  const FrameData& frame = *reference.world.frame;
  std::uint32_t width = static_cast<std::uint32_t>(frame.view.camera.width), n = frame.settings.samples_per_pixel;
  CHECK(n >= 1 && n <= kSampleCountMax);
  CHECK(row_begin <= row_end && row_end <= static_cast<std::uint32_t>(frame.view.camera.height));
  CHECK(picture != nullptr);
  FrameData of_sample = frame;
  Reference sampled = reference;
  sampled.world.frame = &of_sample;
  for (std::uint32_t y = row_begin; y < row_end; ++y)
    for (std::uint32_t x = 0; x < width; ++x) {
      Vec3d sum = {0, 0, 0};
      for (std::uint32_t i = 0; i < n; ++i) {
        Vec2 at = sample_offset(i, n);
        ReferenceRay ray =
            reference_camera_ray(frame.view.camera, x + static_cast<double>(at.x), y + static_cast<double>(at.y));
        of_sample.lights.points.data = points_of_sample(frame, i);
        sum += follow(sampled, ray, {0, frame.view.eye_media});
      }
      picture[std::size_t(y - row_begin) * width + x] = sum / static_cast<double>(n);
    }
}

}  // namespace pocketray
