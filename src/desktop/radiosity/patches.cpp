#include "desktop/radiosity/patches.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "base/check.h"
#include "base/fmath.h"
#include "brdf/brdf_list.h"
#include "desktop/radiosity/cuts.h"
#include "effect/settings.h"
#include "scene/metallic_roughness.h"
#include "shade/texture.h"

namespace pocketray {
namespace {

constexpr double kLift = 1e-4;  // of a patch's size

struct Facet {
  Vec3d a, b, c, normal;
  double area;
  std::uint32_t triangle;
};

double radical_inverse(int i) {
  double v = 0;
  for (double digit = 0.5; i; i >>= 1, digit *= 0.5) v += (i & 1) * digit;
  return v;
}

// Samples that share the area evenly: Hammersley's points, warped into the facets.
void place_samples(const std::vector<Facet>& facets, double area, int count, PatchSample* samples) {
  std::size_t at = 0;
  double before = 0;
  for (int i = 0; i < count; ++i) {
    const double wanted = (i + 0.5) / count * area;
    while (at + 1 < facets.size() && before + facets[at].area <= wanted) before += facets[at++].area;
    const Facet& f = facets[at];
    const double u = std::min(1.0, std::max(0.0, (wanted - before) / f.area));
    const double root = std::sqrt(u), v = radical_inverse(i) + 0.5 / count;
    samples[i] = {f.a * (1 - root) + f.b * (root * (1 - v)) + f.c * (root * v), f.normal, f.triangle};
  }
}

void finish(const std::vector<Facet>& facets, Patch* patch) {
  Vec3d normal = {0, 0, 0}, centre = {0, 0, 0};
  patch->area = 0;
  for (const Facet& f : facets) {
    if (patch->triangles.empty() || patch->triangles.back() != f.triangle) patch->triangles.push_back(f.triangle);
    normal += f.normal * f.area;
    centre += (f.a + f.b + f.c) * (f.area / 3);
    patch->area += f.area;
  }
  CHECK(patch->area > 0);
  patch->centre = centre / patch->area;
  patch->normal = normalize(normal);
  patch->radius = 0;
  for (const Facet& f : facets)
    for (const Vec3d& p : {f.a, f.b, f.c}) patch->radius = std::max(patch->radius, length(p - patch->centre));
  patch->lift = kLift * patch->radius;
  place_samples(facets, patch->area, kPatchSamples, patch->samples);
  patch->light_samples.resize(kLightSamples);
  place_samples(facets, patch->area, kLightSamples, patch->light_samples.data());
}

struct Barycentric {
  double u, v;
};
Barycentric barycentric_at(const Scene& scene, std::uint32_t triangle, const Vec3d& point) {
  const Vec3d a = corner_of(scene, triangle, 0), e = corner_of(scene, triangle, 1) - a,
              f = corner_of(scene, triangle, 2) - a, n = cross(e, f), way = point - a;
  const double square = dot(n, n);
  return {dot(cross(way, f), n) / square, dot(cross(e, way), n) / square};
}
Vec2 uv_at(const Scene& scene, const TextureUse& use, std::uint32_t triangle, const Vec3d& point) {
  const Barycentric at = barycentric_at(scene, triangle, point);
  return texture_uv(scene, use, triangle, static_cast<float>(at.u), static_cast<float>(at.v));
}

// Albedo at a point of a triangle, with texture and vertex colours.
Vec3d albedo_at(const Scene& scene, std::uint32_t triangle, const Vec3d& point) {
  const Triangle& t = scene.triangles[triangle];
  const Material& m = scene.materials[t.material()];
  const Barycentric at = barycentric_at(scene, triangle, point);
  const double u = at.u, v = at.v;
  Vec3d tint = {1, 1, 1};
  auto uv = [&](const TextureUse& use) { return uv_at(scene, use, triangle, point); };
  auto color_of = [&](const TextureUse& use) { return sample_texture(scene, use, uv(use), TextureFilter::as_scene); };
  if (m.diffuse_texture.texture != kNone) tint *= to_double(color_of(m.diffuse_texture).rgb);
  if (scene.colors.count) {
    Vec3d color = {0, 0, 0};
    const double weight[3] = {1 - u - v, u, v};
    for (std::uint32_t i = 0; i < 3; ++i) {
      const Rgba16& c = scene.colors[t.vertex(i)];
      color += Vec3d{double(c.r), double(c.g), double(c.b)} * (weight[i] / 65535);
    }
    tint *= color;
  }
  const double lobe = m.brdf == kPhong ? static_cast<double>(kPhongAlbedo) : 1;
  const Vec3d glossy = to_double(m.specular) * lobe + to_double(m.mirror);
  const Vec3d tinted = to_double(m.specular_tinted) * lobe + to_double(m.mirror_tinted);
  if (scene.material_maps.count && has_lobe_map(scene.material_maps[t.material()])) {
    const MaterialMaps& maps = scene.material_maps[t.material()];
    double metallic = double(maps.metallic);
    Vec3d dielectric = to_double(maps.model.dielectric);
    if (maps.metallic_roughness.texture != kNone)
      metallic *=
          double(
              sample_numbers(scene, maps.metallic_roughness, uv(maps.metallic_roughness), TextureFilter::as_scene).z) /
          255;
    if (maps.specular.texture != kNone) dielectric = dielectric * double(color_of(maps.specular).alpha);
    if (maps.specular_color.texture != kNone) dielectric *= to_double(color_of(maps.specular_color).rgb);
    return to_double(maps.model.base) * tint + dielectric * (1 - metallic);
  }
  return to_double(m.diffuse) * tint + glossy - tinted * (Vec3d{1, 1, 1} - tint);
}

Patch patch_of(const Scene& scene, std::uint32_t material) {
  const Material& m = scene.materials[material];
  Patch patch;
  patch.material = material;
  patch.is_back = patch.is_flat = false, patch.double_sided = m.double_sided && is_zero(m.transmission);
  patch.emission = to_double(m.emission);
  return patch;
}

// Once the samples are placed.
void set_emission(const Scene& scene, const Material& m, Patch* patch) {
  if (m.emission_texture.texture == kNone || !scene.uvs.count || is_zero(m.emission)) return;
  Vec3d sum = {0, 0, 0};
  for (const PatchSample& s : patch->light_samples) {
    const Vec2 uv = uv_at(scene, m.emission_texture, s.triangle, s.point);
    sum += to_double(sample_texture(scene, m.emission_texture, uv, TextureFilter::as_scene).rgb);
  }
  patch->emission *= sum * (1.0 / static_cast<double>(patch->light_samples.size()));
}

// Once the samples are placed.
void set_albedo(const Scene& scene, const Material& m, Patch* patch) {
  patch->albedo = {0, 0, 0};
  if (m.unlit || !is_zero(m.transmission)) return;
  for (const PatchSample& s : patch->samples)
    patch->albedo += albedo_at(scene, s.triangle, s.point) * (1.0 / kPatchSamples);
  for (int axis = 0; axis < 3; ++axis) patch->albedo[axis] = std::min(std::max(patch->albedo[axis], 0.0), kAlbedoMax);
}

// Nothing is added for pieces without area.
void add_cell(const Scene& scene, const FlatSurface& flat, const std::vector<Piece>& pieces,
              std::vector<Patch>* patches) {
  Patch patch = patch_of(scene, flat.material);
  patch.is_flat = true;
  std::vector<Facet> facets;
  for (const Piece& piece : pieces) {
    const Polygon& p = piece.polygon;
    patch.pieces.push_back(p), patch.piece_triangles.push_back(piece.triangle);
    for (std::size_t i = 2; i < p.size(); ++i) {
      const double area = 0.5 * length(cross(p[i - 1] - p[0], p[i] - p[0]));
      if (area > 0) facets.push_back({p[0], p[i - 1], p[i], flat.normal, area, piece.triangle});
    }
  }
  if (facets.empty()) return;
  finish(facets, &patch);
  set_albedo(scene, scene.materials[flat.material], &patch);
  set_emission(scene, scene.materials[flat.material], &patch);
  patches->push_back(patch);
}

void add_cells(const Scene& scene, const FlatSurface& flat, double side, const std::vector<CutEdge>& edges,
               std::vector<Patch>* patches) {
  const int columns = std::max(1, static_cast<int>(std::ceil(flat.width / side - 0.25)));
  const int rows = std::max(1, static_cast<int>(std::ceil(flat.height / side - 0.25)));
  const double width = flat.width / columns, height = flat.height / rows;
  std::vector<std::vector<Piece>> cells(static_cast<std::size_t>(columns * rows));
  for (std::uint32_t t : flat.triangles) {
    const Polygon whole = {corner_of(scene, t, 0), corner_of(scene, t, 1), corner_of(scene, t, 2)};
    double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
    for (const Vec3d& p : whole) {
      const double at[2] = {dot(p - flat.origin, flat.s) / width, dot(p - flat.origin, flat.t) / height};
      for (int k = 0; k < 2; ++k) low[k] = std::min(low[k], at[k]), high[k] = std::max(high[k], at[k]);
    }
    auto cell = [](double x, int count) { return std::min(count - 1, std::max(0, static_cast<int>(x))); };
    for (int column = cell(low[0], columns); column <= cell(high[0], columns); ++column) {
      Polygon strip =
          clip(clip(whole, flat.origin, flat.s, column * width), flat.origin, -flat.s, -(column + 1) * width);
      for (int row = cell(low[1], rows); strip.size() >= 3 && row <= cell(high[1], rows); ++row) {
        Polygon part = clip(clip(strip, flat.origin, flat.t, row * height), flat.origin, -flat.t, -(row + 1) * height);
        if (part.size() >= 3 && polygon_area(part) > 1e-9 * width * height)
          cells[static_cast<std::size_t>(row * columns + column)].push_back({part, t});
      }
    }
  }
  const std::vector<CutEdge> close = edges_close_to(flat, edges, side);
  for (const std::vector<Piece>& cell : cells)
    for (const std::vector<Piece>& part : cut_cell(flat, close, cell)) add_cell(scene, flat, part, patches);
}

void add_clusters(const Scene& scene, const Surfaces& surfaces, std::vector<Patch>* patches) {
  std::map<std::tuple<std::uint32_t, int, int, int, int>, std::vector<Facet>> clusters;
  const double side = surfaces.patch_side;
  for (std::uint32_t t : surfaces.others) {
    const Vec3d a = corner_of(scene, t, 0), b = corner_of(scene, t, 1), c = corner_of(scene, t, 2);
    const Vec3d middle = (a + b + c) / 3.0, n = surfaces.normal[t];
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (std::fabs(n[k]) > std::fabs(n[axis])) axis = k;
    auto cell = [&](double x) { return static_cast<int>(std::floor(std::min(1e9, std::max(-1e9, x / side)))); };
    clusters[{scene.triangles[t].material(), 2 * axis + (n[axis] < 0), cell(middle.x), cell(middle.y), cell(middle.z)}]
        .push_back({a, b, c, n, surfaces.area[t], t});
  }
  for (const auto& entry : clusters) {
    Patch patch = patch_of(scene, std::get<0>(entry.first));
    if (entry.second.size() == 1) patch.pieces = {{entry.second[0].a, entry.second[0].b, entry.second[0].c}};
    finish(entry.second, &patch);
    set_albedo(scene, scene.materials[patch.material], &patch);
    set_emission(scene, scene.materials[patch.material], &patch);
    patches->push_back(patch);
  }
}

}  // namespace

Patch back_of(const Patch& front) {
  Patch back = front;
  back.is_back = true;
  back.normal = -front.normal;
  for (Polygon& piece : back.pieces) std::reverse(piece.begin(), piece.end());
  for (PatchSample& sample : back.samples) sample.normal = -sample.normal;
  for (PatchSample& sample : back.light_samples) sample.normal = -sample.normal;
  return back;
}

double patch_form_factor(const Vec3d& point, const Vec3d& normal, const Patch& patch) {
  const Vec3d way = patch.centre - point;
  const double square = dot(way, way), far = 5 * patch.radius;
  if (square > far * far || patch.pieces.empty()) {
    const double below = -dot(way, patch.normal), above = dot(way, normal);
    if (!(below > 0 && above > 0)) return 0;
    // The cluster as a disk, seen from a point [Wallace et al. 1989, eq. 4].
    return above * below * patch.area / (square * (kPi * square + patch.area));
  }
  double sum = 0;
  for (const Polygon& piece : patch.pieces) sum += point_form_factor(point, normal, piece);
  return sum * patch.uncovered;
}

std::vector<Patch> quarters_of(const Scene& scene, const Surfaces& surfaces, const Patch& patch) {
  CHECK(patch.is_flat);
  const FlatSurface& flat = surfaces.flat[surfaces.flat_of[patch.triangles[0]]];
  std::vector<Patch> quarters;
  for (int q = 0; q < 4; ++q) {
    const Vec3d s = q & 1 ? flat.s : -flat.s, t = q & 2 ? flat.t : -flat.t;
    std::vector<Piece> pieces;
    for (std::size_t i = 0; i < patch.pieces.size(); ++i) {
      const Polygon part = clip(clip(patch.pieces[i], patch.centre, s, 0), patch.centre, t, 0);
      if (part.size() >= 3) pieces.push_back({part, patch.piece_triangles[i]});
    }
    add_cell(scene, flat, pieces, &quarters);
  }
  return quarters;
}

std::vector<Patch> make_patches(const Scene& scene, const Surfaces& surfaces) {
  std::vector<Patch> patches;
  const std::vector<CutEdge> edges = find_cut_edges(scene, surfaces);
  for (const FlatSurface& flat : surfaces.flat) add_cells(scene, flat, surfaces.patch_side, edges, &patches);
  add_clusters(scene, surfaces, &patches);
  return patches;
}

}  // namespace pocketray
