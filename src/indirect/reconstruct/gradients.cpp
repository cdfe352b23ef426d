#include "indirect/reconstruct/gradients.h"

#include "base/check.h"
#include "indirect/reconstruct/triangle.h"

namespace pocketray {
namespace {

// A corner's least-squares problem, and later the range of the values around it.
struct Fit {
  Vec3 xx_yy_zz, xy_yz_zx;  // Σ w u uᵀ over edges of length l along u, w = 1/l
  Vec3 right[3];            // Σ w u · slope, per channel
  Vec3 normal;              // not normalised
  Vec3 around;              // sum of the opposite edges: 0 where triangles surround the corner
  float around_length;
  Vec3 low, high;
};

// Visits the parts of all triangles that store values at corners. In a solution, each corner belongs to one part;
// hostile files whose splits share parts are not followed further.
template <class Visit>
struct PartWalk {
  const Scene& scene;
  std::uint64_t left;
  const Visit& visit;

  void part(const RadiosityCorners& corners, const Vec3 (&place)[3]) {
    if (left == 0) return;
    --left;
    visit(RadiosityPart{corners, {place[0], place[1], place[2]}});
  }
  void walk(std::uint32_t at, const Vec3 (&place)[3]) {
    if (left == 0) return;
    if (!(at & kRadiositySplitBit)) return part(scene.radiosity_corners[at & kRadiosityPartMax], place);
    const RadiositySplit& split = scene.radiosity_splits[at & kRadiosityPartMax];
    const HalvedCorners h = halved_corners(at);
    const Vec3 middle = (place[h.a] + place[h.b]) * 0.5f;
    walk(split.part[0], {place[h.a], middle, place[h.c]});
    walk(split.part[1], {middle, place[h.b], place[h.c]});
  }
};

template <class Visit>
void each_part(const Scene& scene, const Visit& visit) {
  PartWalk<Visit> walk = {scene, std::uint64_t(scene.radiosity_corners.count) + scene.radiosity_triangles.count, visit};
  for (std::uint32_t side = 0; side < scene.radiosity_triangles.count; ++side) {
    const std::uint32_t at = scene.radiosity_triangles[side];
    if (at == kNone || (at & kRadiosityGridBit)) continue;
    const Triangle& t = scene.triangles[side % scene.triangles.count];
    const Vec3 place[3] = {scene.positions[t.vertex(0)], scene.positions[t.vertex(1)], scene.positions[t.vertex(2)]};
    if (at == kRadiosityAtVertices)
      walk.part({{t.vertex(0), t.vertex(1), t.vertex(2)}}, place);
    else if (is_split(at))
      walk.walk(at, place);
    else
      walk.part(scene.radiosity_corners[at], place);
  }
}

// Adds an edge to a fit, with its variation of light.
void add_edge(const Vec3& edge, const Vec3& variation, Fit* fit) {
  const float square = dot(edge, edge);
  if (!(square > 0)) return;
  const float inverse = 1 / std::sqrt(square);
  const Vec3 u = edge * inverse, weighted = u * inverse, slope = variation * inverse;
  fit->xx_yy_zz += weighted * u;
  fit->xy_yz_zx += weighted * Vec3{u.y, u.z, u.x};
  for (int channel = 0; channel < 3; ++channel) fit->right[channel] += weighted * slope[channel];
}

// Adds a part's edges from one of its corners, the opposite edge, and its normal.
void add_part(const RadiosityPart& part, int i, Fit* fit) {
  const Vec3 &at = part.place[i], &next = part.place[next_corner(i)], &previous = part.place[previous_corner(i)];
  fit->normal += cross(next - at, previous - at);
  fit->around += previous - next;
  fit->around_length += length(previous - next);
}

// Chosen: the rounding of sums of a few edges is far below, the gap at a border far above.
constexpr float kClosed = 1e-3f;
bool is_border(const Fit& fit) { return !(length(fit.around) <= kClosed * fit.around_length); }

// Gradient without its component along the normal; 0 where the edges determine none.
RadiosityGradient solution_of(const Fit& fit) {
  const Vec3 d = fit.xx_yy_zz, o = fit.xy_yz_zx;
  const float size = length(fit.normal), trace = d.x + d.y + d.z;
  if (!(size > 0)) return {};
  const Vec3 n = fit.normal / size, weighted = n * trace;
  const Vec3 rows[3] = {Vec3{d.x, o.x, o.z} + weighted * n.x, Vec3{o.x, d.y, o.y} + weighted * n.y,
                        Vec3{o.z, o.y, d.z} + weighted * n.z};
  const Vec3 cofactors[3] = {cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])};
  const float determinant = dot(rows[0], cofactors[0]);
  if (!(determinant > 0)) return {};
  RadiosityGradient g;
  for (int channel = 0; channel < 3; ++channel) {
    const Vec3& b = fit.right[channel];
    Vec3 x = (cofactors[0] * b.x + cofactors[1] * b.y + cofactors[2] * b.z) / determinant;
    if (!is_finite(x)) x = {0, 0, 0};
    g.dx[channel] = x.x, g.dy[channel] = x.y, g.dz[channel] = x.z;
  }
  return g;
}

void fit_planes(const Scene& scene, Array<Fit> fits, Array<RadiosityGradient> gradients) {
  auto each_corner = [&](auto visit) {
    each_part(scene, [&](const RadiosityPart& part) {
      for (int i = 0; i < 3; ++i)
        for (int k : {next_corner(i), previous_corner(i)}) {
          const std::uint32_t from = part.corners.value[i], to = part.corners.value[k];
          visit(&fits[from], to, part.place[k] - part.place[i],
                scene.radiosity_values[to] - scene.radiosity_values[from]);
        }
    });
  };
  each_part(scene, [&](const RadiosityPart& part) {
    for (int i = 0; i < 3; ++i) add_part(part, i, &fits[part.corners.value[i]]);
  });
  each_corner([](Fit* fit, std::uint32_t, const Vec3& edge, const Vec3& variation) { add_edge(edge, variation, fit); });
  for (std::uint32_t i = 0; i < fits.count; ++i) {
    gradients[i] = solution_of(fits[i]);
    if (is_border(fits[i])) fits[i].xx_yy_zz = fits[i].xy_yz_zx = {0, 0, 0};
    for (Vec3& right : fits[i].right) right = {0, 0, 0};
  }
  each_corner([&](Fit* fit, std::uint32_t to, const Vec3& edge, const Vec3& variation) {
    if (is_border(*fit)) add_edge(edge, variation * 2.0f - gradients[to].along(edge), fit);
  });
  for (std::uint32_t i = 0; i < fits.count; ++i)
    if (is_border(fits[i])) gradients[i] = solution_of(fits[i]);
}

// Removes from a gradient the component along an edge that leaves the range, and nothing else.
void clip(const Fit& fit, const Vec3& value, const Vec3& edge, RadiosityGradient* gradient) {
  const float square = dot(edge, edge);
  if (!(square > 0)) return;
  const Vec3 step = gradient->along(edge) * 0.5f, ends = min(max(value + step, fit.low), fit.high);
  const Vec3 excess = (value + step - ends) * (2 / square);
  gradient->dx += excess * -edge.x, gradient->dy += excess * -edge.y, gradient->dz += excess * -edge.z;
}

void limit_planes(const Scene& scene, Array<Fit> fits, Array<RadiosityGradient> gradients) {
  for (std::uint32_t i = 0; i < fits.count; ++i) fits[i].low = fits[i].high = scene.radiosity_values[i];
  each_part(scene, [&](const RadiosityPart& part) {
    for (std::uint32_t at : part.corners.value)
      for (std::uint32_t other : part.corners.value) {
        fits[at].low = min(fits[at].low, scene.radiosity_values[other]);
        fits[at].high = max(fits[at].high, scene.radiosity_values[other]);
      }
  });
  each_part(scene, [&](const RadiosityPart& part) {
    for (int i = 0; i < 3; ++i)
      for (int k : {next_corner(i), previous_corner(i)}) {
        const std::uint32_t at = part.corners.value[i];
        clip(fits[at], scene.radiosity_values[at], part.place[k] - part.place[i], &gradients[at]);
      }
  });
}

}  // namespace

std::size_t gradients_need(const Scene& scene) {
  const std::uint32_t count = scene.radiosity_values.count;
  return count ? arena_need<RadiosityGradient>(count) : 0;
}
std::size_t gradients_scratch_need(const Scene& scene) {
  const std::uint32_t count = scene.radiosity_values.count;
  return count ? arena_need<Fit>(count) : 0;
}

const RadiosityGradient* set_gradients(const Scene& scene, Arena* keep, Arena* scratch) {
  CHECK(keep != nullptr && scratch != nullptr);
  const std::uint32_t count = scene.radiosity_values.count;
  if (count == 0) return nullptr;
  const Array<RadiosityGradient> gradients = arena_array<RadiosityGradient>(keep, count);
  const std::size_t mark = arena_mark(*scratch);
  const Array<Fit> fits = arena_array_zeroed<Fit>(scratch, count);
  fit_planes(scene, fits, gradients);
  limit_planes(scene, fits, gradients);
  arena_release(scratch, mark);
  return gradients.data;
}

}  // namespace pocketray
