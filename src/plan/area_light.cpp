#include "plan/area_light.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/limits.h"
#include "shade/even_points.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

// A piece of an area light: a triangle, or two that form a parallelogram, (a, b, c) and (a, c, d) with b − a = c − d.
struct Emitter {
  std::uint32_t triangle;
  bool parallelogram;
  double area;
  std::uint32_t first_vertex[2];  // per triangle: the vertex that is a
};

double triangle_area(const FrameData& frame, std::uint32_t triangle) {
  const Triangle& t = frame.scene->triangles[triangle];
  Vec3 e1 = frame.geometry.positions[t.vertex(1)] - frame.geometry.positions[t.vertex(0)];
  Vec3 e2 = frame.geometry.positions[t.vertex(2)] - frame.geometry.positions[t.vertex(0)];
  const float longest = max_component(max(abs(e1), abs(e2)));
  if (longest > 0x1p-15f && longest < 0x1p15f) {
    const float twice = length(cross(e1, e2));
    if (twice > 0x1p-40f) return 0.5 * static_cast<double>(twice);
  }
  // Scaled by a power of two, which is exact, so that edges of any length stay in range.
  int exponent;
  std::frexp(longest, &exponent);
  for (int axis = 0; axis < 3; ++axis)
    e1[axis] = std::ldexp(e1[axis], -exponent), e2[axis] = std::ldexp(e2[axis], -exponent);
  return std::ldexp(0.5 * static_cast<double>(length(cross(e1, e2))), 2 * exponent);
}

// Returns the lamp's emitter that starts at a triangle. Halves of a parallelogram may begin at any of their vertices.
Emitter emitter_at(const FrameData& frame, const Lamp& lamp, std::uint32_t triangle) {
  const Scene& scene = *frame.scene;
  Emitter e = {triangle, false, triangle_area(frame, triangle), {0, 0}};
  if (!is_part_of(scene, lamp, triangle + 1)) return e;
  const Triangle &t = scene.triangles[triangle], &next = scene.triangles[triangle + 1];
  auto corner = [&](const Triangle& of, std::uint32_t i) -> const Vec3& {
    return frame.geometry.positions[of.vertex(i % 3)];
  };
  for (std::uint32_t i = 0; i < 3; ++i) {
    const Vec3 &a = corner(t, i), &b = corner(t, i + 1), &c = corner(t, i + 2);
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (!(corner(next, k) == a && corner(next, k + 1) == c)) continue;
      const Vec3 skew = (b - a) - (c - corner(next, k + 2));
      if (length(skew) > length(b - a) * 1e-3f) continue;
      e.parallelogram = true;
      e.first_vertex[0] = i, e.first_vertex[1] = k;
      e.area += triangle_area(frame, triangle + 1);
      return e;
    }
  }
  return e;
}

// Visits the emitters of a lamp in order.
template <class Visit>
void each_emitter(const FrameData& frame, const Lamp& lamp, Visit visit) {
  const Scene& scene = *frame.scene;
  for (std::uint32_t i = lamp.begin; i < lamp.end; ++i) {
    if (!is_part_of(scene, lamp, i)) continue;
    Emitter e = emitter_at(frame, lamp, i);
    if (e.area > 0) visit(e);
    if (e.parallelogram) ++i;
  }
}

// Position of a cell's point on the emitter: barycentrics in the triangle, or in one half of the parallelogram. It is
// the centroid of the cell's image, so the mean of the points is the emitter's centroid.
void place_on_emitter(const Emitter& e, const UnitCell& cell, std::uint32_t* triangle, float* u, float* v) {
  *triangle = e.triangle;
  float x = static_cast<float>(0.5 * (cell.x_begin + cell.x_end)), y = static_cast<float>(cell.y);
  if (!e.parallelogram) {
    // Points (√x(1 − y), √xy) are uniform if x and y are [Turk 1990, "Generating random points in triangles", method
    // 1]; √x is averaged over the cell.
    const double begin = cell.x_begin * std::sqrt(cell.x_begin), end = cell.x_end * std::sqrt(cell.x_end);
    const double width = cell.x_end - cell.x_begin;
    const double root = width > 0 ? 2 * (end - begin) / (3 * width) : std::sqrt(cell.x_begin);
    *u = static_cast<float>(root * (1 - cell.y));
    *v = static_cast<float>(root * cell.y);
  } else {  // a + x(b − a) + y(d − a), with c = b + d − a
    const bool second = x < y;
    *triangle += second;
    // Weights of a, the vertex after it and the one before it.
    const float weights[3] = {1 - (second ? y : x), second ? x : x - y, second ? y - x : y};
    const std::uint32_t a = e.first_vertex[second];
    *u = weights[(1 + 3 - a) % 3];
    *v = weights[(2 + 3 - a) % 3];
  }
}

Vec3 surface_point(const FrameData& frame, std::uint32_t triangle, float u, float v) {
  const Triangle& t = frame.scene->triangles[triangle];
  const Vec3 &a = frame.geometry.positions[t.vertex(0)], &b = frame.geometry.positions[t.vertex(1)],
             &c = frame.geometry.positions[t.vertex(2)];
  return a * (1 - u - v) + b * u + c * v;
}

// Barycentric coordinates of the triangle's point nearest to p [Ericson 2005, "Real-Time
// Collision Detection", sec. 5.1.5], in double precision since fourth powers of lengths exceed
// the range of float. Returns the squared distance.
double nearest_point(const FrameData& frame, std::uint32_t triangle, const Vec3& p, float* u, float* v) {
  const Triangle& t = frame.scene->triangles[triangle];
  const Vec3 &a = frame.geometry.positions[t.vertex(0)], &b = frame.geometry.positions[t.vertex(1)],
             &c = frame.geometry.positions[t.vertex(2)];
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  auto product = [](const Vec3& l, const Vec3& r) {
    return static_cast<double>(l.x) * r.x + static_cast<double>(l.y) * r.y + static_cast<double>(l.z) * r.z;
  };
  const double d1 = product(ab, ap), d2 = product(ac, ap), d3 = product(ab, bp), d4 = product(ac, bp),
               d5 = product(ab, cp), d6 = product(ac, cp);
  const double of_a = d3 * d6 - d5 * d4, of_b = d5 * d2 - d1 * d6, of_c = d1 * d4 - d3 * d2;
  double x = 0, y = 0;
  if (d1 <= 0 && d2 <= 0) {  // at a
  } else if (d3 >= 0 && d4 <= d3) {
    x = 1;  // at b
  } else if (of_c <= 0 && d1 >= 0 && d3 <= 0) {
    x = d1 / (d1 - d3);  // on ab
  } else if (d6 >= 0 && d5 <= d6) {
    y = 1;  // at c
  } else if (of_b <= 0 && d2 >= 0 && d6 <= 0) {
    y = d2 / (d2 - d6);  // on ac
  } else if (of_a <= 0 && d4 >= d3 && d5 >= d6) {
    y = (d4 - d3) / ((d4 - d3) + (d5 - d6));  // on bc
    x = 1 - y;
  } else {
    const double sum = of_a + of_b + of_c;
    x = of_b / sum, y = of_c / sum;
  }
  *u = static_cast<float>(x), *v = static_cast<float>(y);
  const Vec3 offset = surface_point(frame, triangle, *u, *v) - p;
  return product(offset, offset);
}

LightPoint point_on(const FrameData& frame, const Emitter& e, std::uint32_t triangle, float u, float v, double area) {
  const Scene& scene = *frame.scene;
  const Triangle& t = scene.triangles[triangle];
  const Material& m = scene.materials[t.material()];
  const Vec3 &a = frame.geometry.positions[t.vertex(0)], &b = frame.geometry.positions[t.vertex(1)],
             &c = frame.geometry.positions[t.vertex(2)];
  LightPoint p = {};
  p.position = surface_point(frame, triangle, u, v);
  p.direction = normalize(cross(b - a, c - a));
  Vec3 emission = m.emission;
  if (m.emission_texture.texture != kNone && scene.uvs.count) {
    const Vec2 uv = has(frame.mask, Effect::second_uv) ? texture_uv(scene, m.emission_texture, triangle, u, v)
                                                       : hit_uv(scene, triangle, u, v);
    emission *= sample_texture(scene, m.emission_texture, uv, frame.settings.texture_filter).rgb;
  }
  constexpr float most = std::numeric_limits<float>::max();
  p.intensity = min(emission * static_cast<float>(area), Vec3{most, most, most});
  p.material = t.material(), p.triangle = e.triangle, p.count = e.parallelogram ? 2 : 1;
  p.two_sided = m.double_sided;
  return p;
}

// A light's points represent equal shares of its area, taken in the order of its
// emitters. A slice of an emitter is a part of one share, or several whole shares. Its x
// is the first coordinate of a cell, in which area is uniform.
struct LampSlice {
  std::uint32_t share, share_count;
  bool whole;
  double share_part;  // fraction of one share
  double x_begin, x_end;
};

template <class Visit>
void each_slice(const FrameData& frame, const Lamp& lamp, double area_total, std::uint32_t n, Visit visit) {
  CHECK(area_total > 0);
  CHECK_GE(n, 1u);
  // Snaps borders that miss one between shares by no more than the rounding of the sums.
  auto in_shares = [&](double area) {
    const double shares = area / area_total * n, nearest = std::floor(shares + 0.5);
    return std::fabs(shares - nearest) < 1e-6 ? nearest : shares;
  };
  double area = 0;
  each_emitter(frame, lamp, [&](const Emitter& e) {
    const double begin = in_shares(area), end = in_shares(area += e.area);
    for (double from = begin, to; from < end; from = to) {
      const double share = std::floor(from);
      const bool whole = from == share && std::floor(end) > from;
      to = whole ? std::floor(end) : std::min(end, share + 1);
      LampSlice slice = {static_cast<std::uint32_t>(share), 1, whole, to - from, 0, 0};
      if (whole) slice.share_count = static_cast<std::uint32_t>(to - from);
      CHECK_LT(slice.share, n);
      slice.x_begin = (from - begin) / (end - begin), slice.x_end = (to - begin) / (end - begin);
      visit(e, slice);
    }
  });
}

// The surface point nearest to the centroid of a share that spans several emitters.
struct NearestPoint {
  Vec3 centroid;
  Emitter emitter;  // on which it lies
  std::uint32_t triangle;
  float u, v;
  double square;  // of its distance
};

void approach(const FrameData& frame, const Emitter& e, NearestPoint* nearest) {
  CHECK(nearest != nullptr);
  for (std::uint32_t triangle = e.triangle; triangle <= e.triangle + e.parallelogram; ++triangle) {
    float u, v;
    const double square = nearest_point(frame, triangle, nearest->centroid, &u, &v);
    if (square < nearest->square) *nearest = {nearest->centroid, e, triangle, u, v, square};
  }
}

// Moves a point of a bent lamp off its triangle's edges, where rounding could let a neighbour hide it.
void keep_off_edges(float* u, float* v) {
  constexpr float kLeast = 0x1p-6f;  // chosen: of the triangle's height; more than rounding, less than is visible
  if (std::min(std::min(*u, *v), 1 - *u - *v) >= kLeast) return;
  *u += (1 / 3.0f - *u) * (3 * kLeast), *v += (1 / 3.0f - *v) * (3 * kLeast);
}

// Returns the part of a cell that a set's point stands for; sets divide cells as samples divide a pixel.
UnitCell part_of(const UnitCell& cell, const PointSet& set) {
  if (set.count == 1) return cell;
  const double width = (cell.x_end - cell.x_begin) / set.count, begin = cell.x_begin + set.index * width;
  const double up = static_cast<double>(rook_point(set.index, set.count).y) - 0.5;
  return {begin, begin + width, cell.y + up * cell.height, cell.height};
}

// Places the points of the shares that lie entirely within a slice.
void place_whole_shares(const FrameData& frame, const Emitter& e, const LampSlice& slice, double area,
                        const PointSet& set, LightPoint* points) {
  CHECK(slice.whole);
  const double width = slice.x_end - slice.x_begin;
  for (std::uint32_t j = 0; j < slice.share_count; ++j) {
    UnitCell cell = equal_cell(j, slice.share_count);
    cell.x_begin = slice.x_begin + cell.x_begin * width, cell.x_end = slice.x_begin + cell.x_end * width;
    std::uint32_t triangle;
    float u, v;
    place_on_emitter(e, part_of(cell, set), &triangle, &u, &v);
    points[slice.share + j] = point_on(frame, e, triangle, u, v, area);
  }
}

// Places the points of shares that span several slices: each at the point of its own surface nearest to its centroid.
// If the centroid lies on another share, as it may in a flat lamp, it is the point itself: flat lamps keep their
// centre.
void place_centroids(const FrameData& frame, const Lamp& lamp, double total, std::uint32_t n, LightPoint* points) {
  const double area = total / n;
  // 1. Centroids.
  for (std::uint32_t i = 0; i < n; ++i) points[i].position = {0, 0, 0};
  each_slice(frame, lamp, total, n, [&](const Emitter& e, const LampSlice& slice) {
    if (slice.whole) return;
    std::uint32_t triangle;
    float u, v;
    place_on_emitter(e, {slice.x_begin, slice.x_end, 0.5, 1}, &triangle, &u, &v);
    points[slice.share].position += surface_point(frame, triangle, u, v) * static_cast<float>(slice.share_part);
  });
  // 2. Nearest points to them: on the share's own surface or, if the centroid is not on it, on the whole lamp.
  const double there = area * 1e-6;  // chosen: a thousandth of the share's size
  NearestPoint nearest = {};
  auto settle = [&](std::uint32_t share) {
    if (nearest.square > there) {
      NearestPoint other = nearest;
      each_emitter(frame, lamp, [&](const Emitter& e) { approach(frame, e, &other); });
      if (other.square <= there) nearest = other;
    }
    if (nearest.square > there) keep_off_edges(&nearest.u, &nearest.v);
    points[share] = point_on(frame, nearest.emitter, nearest.triangle, nearest.u, nearest.v, area);
  };
  std::uint32_t share = kNone;
  each_slice(frame, lamp, total, n, [&](const Emitter& e, const LampSlice& slice) {
    if (slice.whole) return;
    if (slice.share != share) {
      if (share != kNone) settle(share);
      share = slice.share;
      nearest = {points[share].position, e, e.triangle, 0, 0, std::numeric_limits<double>::infinity()};
    }
    approach(frame, e, &nearest);
  });
  if (share != kNone) settle(share);
}

// Places the points of shares that span several slices on the part of each share that the set's point stands for.
void place_parts(const FrameData& frame, const Lamp& lamp, double total, std::uint32_t n, const PointSet& set,
                 LightPoint* points) {
  const Vec2 place = rook_point(set.index, set.count);
  const double wanted = static_cast<double>(place.x);
  std::uint32_t share = kNone;
  double passed = 0;  // fraction of the share
  each_slice(frame, lamp, total, n, [&](const Emitter& e, const LampSlice& slice) {
    if (slice.whole) return;
    if (slice.share != share) share = slice.share, passed = 0;
    const double along = std::min((wanted - passed) / slice.share_part, 1.0);
    passed += slice.share_part;
    if (!(along >= 0)) return;  // an earlier slice has it
    const double x = slice.x_begin + along * (slice.x_end - slice.x_begin);
    std::uint32_t triangle;
    float u, v;
    place_on_emitter(e, {x, x, static_cast<double>(place.y), 1}, &triangle, &u, &v);
    keep_off_edges(&u, &v);
    points[share] = point_on(frame, e, triangle, u, v, total / n);
  });
}

}  // namespace

double lamp_area(const FrameData& frame, const Lamp& lamp) {
  double total = 0;
  each_emitter(frame, lamp, [&](const Emitter& e) { total += e.area; });
  return total;
}

std::uint32_t place_area_light(const FrameData& frame, const Lamp& lamp, std::uint32_t n, const PointSet& set,
                               LightPoint* points) {
  CHECK(n >= 1 && n <= kPointsPerAreaLightMax);
  CHECK_LT(set.index, set.count);
  const double total = lamp_area(frame, lamp);
  if (!(total > 0)) return 0;
  set.count == 1 ? place_centroids(frame, lamp, total, n, points) : place_parts(frame, lamp, total, n, set, points);
  each_slice(frame, lamp, total, n, [&](const Emitter& e, const LampSlice& slice) {
    if (slice.whole) place_whole_shares(frame, e, slice, total / n, set, points);
  });
  return n;
}

}  // namespace pocketray
