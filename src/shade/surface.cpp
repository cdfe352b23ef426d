#include "shade/surface.h"

#include "effect/effect_probe.h"
#include "indirect/surroundings.h"
#include "shade/footprint.h"
#include "shade/instances.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

// Flips the interpolated normal to the side of the geometric normal; falls back to the latter if there is none.
Vec3 smooth_normal(const FrameData& frame, const Triangle& t, float w, float u, float v, const Vec3& geometric) {
  Vec3 n = normalize(frame.geometry.normals[t.vertex(0)] * w + frame.geometry.normals[t.vertex(1)] * u +
                     frame.geometry.normals[t.vertex(2)] * v);
  if (is_zero(n)) return geometric;
  return dot(n, geometric) < 0 ? -n : n;
}

Vec3 vertex_color(const Scene& scene, const Triangle& t, float u, float v) {
  auto at = [&](int i) {
    const Rgba16& c = scene.colors[t.vertex(i)];
    return Vec3{static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b)} * (1.0f / 65535.0f);
  };
  const Vec3 first = at(0);
  return max(first + (at(1) - first) * u + (at(2) - first) * v, {0, 0, 0});  // exact where equal, whatever u and v
}

// Moves a point that lies on an edge of its triangle, within rounding, slightly towards the middle. From a point beside
// the edge, a ray would start beyond the adjoining face and leave a closed room through it (HARDCASES row 24). The
// limit and the distance were found with rays along the edges of the Cornell box (tests/shade/room_test.cpp).
void keep_off_edges(const Vec3& a, const Vec3& b, const Vec3& c, float least_weight, float double_area,
                    float corner_distance, float offset, Vec3* point) {
  // The height over an edge is the doubled area divided by the edge's length, which is at most 2√3 corner_distance.
  if (least_weight * double_area > corner_distance * (16 * offset)) return;
  Vec3 inward = (a + b + c) * (1.0f / 3) - *point;
  float size = max_component(abs(inward)), step = 8 * offset;
  *point += step < size ? inward * (step / size) : inward;
}

template <EffectMask mask>
inline Vec3 texture_color(const FrameData& frame, const TextureUse& use, const Surface& s) {
  if constexpr (has(mask, Effect::second_uv)) return frame.kernels.color(frame, use, s).rgb;
  const Scene& scene = *frame.scene;
  return color_at<has(mask, Effect::mip_map)>(scene, use, hit_uv(scene, s.hit.triangle, s.hit.u, s.hit.v),
                                              frame.settings.texture_filter, s.footprint)
      .rgb;
}

// Sets the light that leaves the surface without any lights.
template <EffectMask mask>
inline void add_glow(const FrameData& frame, Surface* s) {
  const Scene& scene = *frame.scene;
  const Material& m = *s->material;
  s->glow = {0, 0, 0};
  if constexpr (has(mask, Effect::emission)) {
    if (m.unlit) {
      effect_entered<Effect::emission>();
      s->glow = s->diffuse;
      s->diffuse = {0, 0, 0};
    }
  }
  if constexpr ((mask & kEffectsBuilt & IndirectList::kEffects) != 0) {
    IndirectPoint point = {scene,           nullptr,  s->point, s->normal, s->diffuse,
                           s->hit.triangle, s->hit.u, s->hit.v, s->front,  frame.settings.reconstruction};
    if constexpr (has(mask, Effect::radiosity)) {
      if (!m.unlit && has(frame.mask, Effect::specular) && !reflects_surroundings(m))
        point.glossy = reflectance_at(*s, m.specular, m.specular_tinted);
    }
    IndirectList::add_radiance<mask>(frame.indirect.prepared, point, &s->glow);
  }
  if constexpr (has(mask, Effect::emission)) {
    if (!is_zero(m.emission) && (s->front || m.double_sided)) {
      effect_entered<Effect::emission>();
      Vec3 emission = m.emission;
      if constexpr (has(mask, Effect::texture)) {
        if (m.emission_texture.texture != kNone) emission *= texture_color<mask>(frame, m.emission_texture, *s);
      }
      s->glow += emission;
    }
  }
}

inline void find_footprint(const FrameData& frame, float t, const Vec3& direction, const Vec3& perpendicular,
                           const Vec3& outward, Array<const Vec2> uvs, const Triangle& triangle, Footprint* result) {
  result->area = footprint(frame.view.cone, t, direction, perpendicular, outward, uvs, triangle);
  if (frame.settings.texture_filter == TextureFilter::anisotropic)
    result->axis = footprint_axis(frame, t, direction, perpendicular, outward, uvs, triangle);
}

template <EffectMask mask>
void evaluate_surface(const FrameData& frame, const Ray& ray, const Hit& hit, Surface* s) {
  const Scene& scene = *frame.scene;
  const Triangle& t = scene.triangles[hit.triangle];
  const Material& m = scene.materials[t.material()];
  const Vec3 &a = frame.geometry.positions[t.vertex(0)], &b = frame.geometry.positions[t.vertex(1)],
             &c = frame.geometry.positions[t.vertex(2)];
  float u = hit.u, v = hit.v, w = 1 - u - v;
  s->material = &m;
  s->hit = {u, v, hit.triangle};
  s->point = a * w + b * u + c * v;
  Vec3 perpendicular = cross(b - a, c - a), outward = normalize(perpendicular);
  s->front = dot(outward, ray.direction) <= 0;
  s->geometric = s->front ? outward : -outward;
  float corner_distance = max_component(max(max(abs(a - s->point), abs(b - s->point)), abs(c - s->point)));
  float offset = origin_offset(abs(a) * std::fabs(w) + abs(b) * std::fabs(u) + abs(c) * std::fabs(v), corner_distance,
                               s->geometric);
  s->offset = s->geometric * offset;
  float least_weight = u < v ? u : v;
  if (w < least_weight) least_weight = w;
  keep_off_edges(a, b, c, least_weight, max_component(abs(perpendicular)), corner_distance, offset, &s->point);
  s->normal = s->geometric;
  if constexpr (has(mask, Effect::smooth_normal)) {
    effect_entered<Effect::smooth_normal>();
    if (frame.geometry.normals.count) s->normal = smooth_normal(frame, t, w, u, v, s->geometric);
  }
  if constexpr (has(mask, Effect::mip_map)) {
    find_footprint(frame, hit.t, ray.direction, perpendicular, outward, scene.uvs, t, &s->footprint);
    if constexpr (has(mask, Effect::second_uv))
      find_footprint(frame, hit.t, ray.direction, perpendicular, outward, scene.second_uvs, t, &s->footprint.second);
  }
  s->diffuse = m.diffuse;
  s->is_tinted = false;
  if constexpr (has(mask, Effect::texture)) {
    const bool takes_part = !has(mask, Effect::second_uv) || has(frame.mask, Effect::texture);
    if (m.diffuse_texture.texture != kNone && takes_part) {
      effect_entered<Effect::texture>();
      s->tint = texture_color<mask>(frame, m.diffuse_texture, *s);
      s->diffuse *= s->tint;
      s->is_tinted = true;
    }
  }
  if constexpr (has(mask, Effect::vertex_color)) {
    if (scene.colors.count) {
      effect_entered<Effect::vertex_color>();
      Vec3 color = vertex_color(scene, t, u, v);
      s->diffuse *= color;
      s->tint = s->is_tinted ? s->tint * color : color;
      s->is_tinted = true;
    }
  }
  add_glow<mask>(frame, s);
}

struct SurfacePart {
  using Function = SurfaceFunction;
  static constexpr auto kTable = kSurfaceTable;
  template <EffectMask mask>
  static constexpr Function instance() {
    return evaluate_surface<mask>;
  }
};

struct GlowPart {
  using Function = GlowFunction;
  static constexpr auto kTable = kGlowTable;
  template <EffectMask mask>
  static constexpr Function instance() {
    return add_glow<mask>;
  }
};

}  // namespace

GlowFunction find_glow_function(EffectMask mask) { return Instantiations<GlowPart>::find(mask); }

Vec3 curved_origin(const FrameData& frame, const Surface& s) {
  Surface moved = s;
  if (frame.geometry.normals.count) {
    const Triangle& t = frame.scene->triangles[s.hit.triangle];
    float weight[3] = {1 - s.hit.u - s.hit.v, s.hit.u, s.hit.v};
    Vec3 lift = {0, 0, 0};
    for (int i = 0; i < 3; ++i) {
      Vec3 n = frame.geometry.normals[t.vertex(i)];
      if (dot(n, s.normal) < 0) n = -n;
      float below = dot(s.point - frame.geometry.positions[t.vertex(i)], n);
      if (below < 0) lift += n * (-below * weight[i]);
    }
    moved.point = s.point + lift;
  }
  return safe_origin(moved, 1);
}

SurfaceFunction find_surface_function(EffectMask mask) { return Instantiations<SurfacePart>::find(mask); }

}  // namespace pocketray
