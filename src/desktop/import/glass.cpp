#include "desktop/import/glass.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/check.h"

namespace pocketray {
namespace {

// Share of the sum of absolute volumes below which a surface encloses nothing, such as a sheet with a front and a back.
// Chosen: above the rounding of floats, below a disc whose height is a thousandth of its width.
constexpr double kVolumeMin = 1e-5;

using Indices = std::vector<std::uint32_t>;

// Triangles of one material in one part, and which of them belong to closed surfaces.
struct GlassMesh {
  std::uint32_t material = 0;
  Indices triangles;
  std::vector<bool> closed;
};

// Sets of triangles that share edges.
class Pieces {
 public:
  explicit Pieces(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

 private:
  Indices parent_;
};

bool is_before(const Vec3& a, const Vec3& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a[axis] != b[axis]) return a[axis] < b[axis];
  return false;
}

// A grid that positions are rounded to. Some programs round the ends of a seam differently. Chosen: 2⁻²⁰ of the mesh,
// some units in the last place; on either of two grids, half a step apart, such positions are the same.
struct Grid {
  Vec3 origin = {0, 0, 0};
  float scale = 0;  // 0: positions as they are
  float offset = 0;
};
constexpr float kGridSteps = 0x1p20f;

Vec3 on_grid(const Grid& grid, const Vec3& p) {
  if (!(grid.scale > 0)) return p;
  const Vec3 steps = (p - grid.origin) * grid.scale;
  return {std::floor(steps.x + grid.offset), std::floor(steps.y + grid.offset), std::floor(steps.z + grid.offset)};
}

// Numbers the corners of triangles by position: files repeat vertices at seams of normals and texture coordinates.
Indices corners_by_position(const SceneArrays& out, const Indices& triangles, const Grid& grid) {
  Indices order(3 * triangles.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<Vec3> position(order.size());
  for (std::uint32_t corner : order)
    position[corner] = on_grid(grid, out.positions[out.triangles[triangles[corner / 3]].vertex(corner % 3)]);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return is_before(position[a], position[b]); });
  Indices number(order.size());
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i > 0 && is_before(position[order[i - 1]], position[order[i]])) ++last;
    number[order[i]] = last;
  }
  return number;
}

struct Edge {
  std::uint32_t low, high, triangle;
  int direction;  // +1: from low to high
};
bool same_ends(const Edge& a, const Edge& b) { return a.low == b.low && a.high == b.high; }

std::vector<Edge> edges_of(const Indices& corners) {
  std::vector<Edge> edges;
  edges.reserve(corners.size());
  for (std::uint32_t c = 0; c < corners.size(); ++c) {
    const std::uint32_t a = corners[c], b = corners[c % 3 == 2 ? c - 2 : c + 1];
    if (a != b) edges.push_back({std::min(a, b), std::max(a, b), c / 3, a < b ? 1 : -1});
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
  });
  return edges;
}

// Marks the triangles of pieces that are closed on the grid.
void mark_closed(const SceneArrays& out, const Grid& grid, GlassMesh* mesh) {
  const std::size_t count = mesh->triangles.size();
  const std::vector<Edge> edges = edges_of(corners_by_position(out, mesh->triangles, grid));
  Pieces pieces(count);
  std::vector<bool> open(count);  // by piece
  for (std::size_t begin = 0, end; begin < edges.size(); begin = end) {
    for (end = begin + 1; end < edges.size() && same_ends(edges[begin], edges[end]);) ++end;
    for (std::size_t i = begin + 1; i < end; ++i) pieces.join(edges[begin].triangle, edges[i].triangle);
  }
  for (std::size_t begin = 0, end; begin < edges.size(); begin = end) {
    int sum = 0;
    for (end = begin; end < edges.size() && same_ends(edges[begin], edges[end]); ++end) sum += edges[end].direction;
    if (sum != 0) open[pieces.find(edges[begin].triangle)] = true;
  }
  std::vector<double> volume(count), absolute(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t piece = pieces.find(i);
    const Vec3d from = to_double(out.positions[out.triangles[mesh->triangles[piece]].vertex(0)]);
    Vec3d p[3];
    for (std::uint32_t c = 0; c < 3; ++c)
      p[c] = to_double(out.positions[out.triangles[mesh->triangles[i]].vertex(c)]) - from;
    const double six_fold = dot(p[0], cross(p[1], p[2]));
    volume[piece] += six_fold, absolute[piece] += std::fabs(six_fold);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t piece = pieces.find(i);
    if (!open[piece] && std::fabs(volume[piece]) > kVolumeMin * absolute[piece]) mesh->closed[i] = true;
  }
}

// How often the closed surfaces of a mesh surround a point: by the faces above it.
int windings(const SceneArrays& out, const GlassMesh& mesh, const Vec3d& point) {
  int sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!mesh.closed[i]) continue;
    Vec3d p[3];
    for (std::uint32_t c = 0; c < 3; ++c)
      p[c] = to_double(out.positions[out.triangles[mesh.triangles[i]].vertex(c)]) - point;
    // Faces contain the point, seen from above, if it is to the same side of all edges; a point above an edge belongs
    // to the face on one side of it.
    double side[3];
    int lefts = 0;
    for (int c = 0; c < 3; ++c) {
      const Vec3d &a = p[c], &b = p[c == 2 ? 0 : c + 1];
      const bool swap = a.x != b.x ? a.x > b.x : a.z > b.z;  // alike for both faces of an edge
      side[c] = swap ? -(b.x * a.z - b.z * a.x) : a.x * b.z - a.z * b.x;
      lefts += side[c] != 0 ? side[c] > 0 : swap;
    }
    if (lefts != 0 && lefts != 3) continue;
    const double area = side[0] + side[1] + side[2];
    if (area == 0) continue;
    const double height = (p[2].y * side[0] + p[0].y * side[1] + p[1].y * side[2]) / area;
    if (height > 0) sum += lefts == 3 ? 1 : -1;
  }
  return sum;
}

Box bounds_of(const SceneArrays& out, const GlassMesh& mesh) {
  Box box = empty_box();
  for (std::uint32_t t : mesh.triangles)
    for (std::uint32_t v : out.triangles[t].vertices()) box = merge(box, out.positions[v]);
  return box;
}

void find_closed(const SceneArrays& out, GlassMesh* mesh) {
  mesh->closed.assign(mesh->triangles.size(), false);
  mark_closed(out, Grid(), mesh);
  const Box box = bounds_of(out, *mesh);
  const float side = max_component(box.high - box.low);
  if (!(side > 0)) return;
  for (float offset : {0.0f, 0.5f}) mark_closed(out, {box.low, kGridSteps / side, offset}, mesh);
}

bool is_inside(const Box& box, const Vec3& p) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(p[axis] > box.low[axis] && p[axis] < box.high[axis])) return false;
  return true;
}

// Triangles are in the order of their vertices, and so are parts.
std::uint32_t part_of(const SceneBuilder& builder, const Triangle& t) {
  const auto after = std::upper_bound(builder.parts.begin(), builder.parts.end(), t.vertex(0),
                                      [](std::uint32_t v, const PartSource& part) { return v < part.vertex_begin; });
  return static_cast<std::uint32_t>(after - builder.parts.begin());
}

// Opaque triangles of one part and material.
struct Object {
  Box box = empty_box();
  Vec3 point = {0, 0, 0};  // one of its vertices
};
std::vector<Object> opaque_objects(const SceneBuilder& builder) {
  const SceneArrays& out = *builder.out;
  std::vector<Object> objects;
  std::uint32_t last_part = kNone, last_material = kNone;
  for (const Triangle& t : out.triangles) {
    const std::uint32_t material = t.material(), part = part_of(builder, t);
    if (!is_zero(out.materials[material].transmission)) continue;
    if (part != last_part || material != last_material) objects.push_back({empty_box(), out.positions[t.vertex(0)]});
    last_part = part, last_material = material;
    for (std::uint32_t v : t.vertices()) objects.back().box = merge(objects.back().box, out.positions[v]);
  }
  return objects;
}

// Returns whether a light, or an opaque object as a whole, is within the body.
bool holds_something(const SceneArrays& out, const std::vector<Object>& objects, const GlassMesh& mesh) {
  const Box box = bounds_of(out, mesh);
  auto is_within = [&](const Vec3& p) { return is_inside(box, p) && windings(out, mesh, to_double(p)) != 0; };
  for (const Light& light : out.lights)
    if (light.kind != LightKind::directional && light.node == kNone && is_within(light.position)) return true;
  return std::any_of(objects.begin(), objects.end(), [&](const Object& object) {
    return is_inside(box, object.box.low) && is_inside(box, object.box.high) && is_within(object.point);
  });
}

// A copy of the material, with whatever belongs to it.
std::uint32_t copy_material(SceneBuilder* builder, std::uint32_t material) {
  SceneArrays& out = *builder->out;
  const std::uint32_t copy =
      add_material(builder, Material(out.materials[material]), builder->material_names[material]);
  auto copy_entry = [&](auto* entries) {
    if (material >= entries->size()) return;
    const auto entry = (*entries)[material];
    entries->resize(copy);
    entries->push_back(entry);
  };
  copy_entry(&out.material_maps), copy_entry(&out.grains), copy_entry(&out.clear_coats), copy_entry(&out.sheens);
  copy_entry(&out.glass_maps), copy_entry(&out.iridescences);
  copy_entry(&out.diffuse_transmissions);
  return copy;
}

bool is_animated(const SceneArrays& out, std::uint32_t material) {
  return std::any_of(out.channels.begin(), out.channels.end(), [&](const Channel& c) {
    return (c.path == ChannelPath::material_diffuse || c.path == ChannelPath::material_emission) && c.node == material;
  });
}

std::vector<GlassMesh> find_glass(const SceneBuilder& builder, std::uint32_t material) {
  const SceneArrays& out = *builder.out;
  std::vector<GlassMesh> meshes;
  std::uint32_t last = kNone;
  for (std::uint32_t i = 0; i < out.triangles.size(); ++i) {
    if (out.triangles[i].material() != material) continue;
    const std::uint32_t part = part_of(builder, out.triangles[i]);
    if (part != last) meshes.emplace_back();
    last = part, meshes.back().material = material;
    meshes.back().triangles.push_back(i);
  }
  return meshes;
}

struct GlassCount {
  std::uint32_t solid = 0, thin = 0;  // meshes; one of both kinds counts as both
};

// Makes a material that of a body, whose thickness is that of its mesh.
void make_body(SceneArrays* out, std::uint32_t material) {
  out->materials[material].thin = 0;
  if (material < out->glass_maps.size())
    out->glass_maps[material].thickness = 0, out->glass_maps[material].thickness_texture = TextureUse();
}

// `objects` that keep closed meshes from being bodies; null: the file says that they are.
void divide(SceneBuilder* builder, const std::vector<Object>* objects, std::uint32_t material, GlassCount* count) {
  SceneArrays& out = *builder->out;
  Indices solid;
  std::size_t all = 0;
  GlassCount own;
  for (GlassMesh& mesh : find_glass(*builder, material)) {
    find_closed(out, &mesh);
    if (objects && holds_something(out, *objects, mesh)) mesh.closed.assign(mesh.closed.size(), false);
    const auto closed_count = static_cast<std::size_t>(std::count(mesh.closed.begin(), mesh.closed.end(), true));
    own.solid += closed_count > 0, own.thin += closed_count < mesh.closed.size();
    for (std::size_t i = 0; i < mesh.closed.size(); ++i)
      if (mesh.closed[i]) solid.push_back(mesh.triangles[i]);
    all += mesh.triangles.size();
  }
  if (!solid.empty() && solid.size() < all && is_animated(out, material)) own.thin += own.solid, own.solid = 0;
  count->solid += own.solid, count->thin += own.thin;
  if (own.solid == 0) return;
  if (solid.size() == all) {
    make_body(&out, material);
    return;
  }
  const std::uint32_t body = copy_material(builder, material);
  make_body(&out, body);
  for (std::uint32_t t : solid) out.triangles[t].set_material(body);
}

}  // namespace

void decide_glass(SceneBuilder* builder) {
  CHECK(builder != nullptr);
  GlassCount count;
  for (std::uint32_t material : std::exchange(builder->volumes, {})) divide(builder, nullptr, material, &count);
  count = {};
  if (builder->options.glass == GlassKind::thin) return;
  if (builder->options.glass == GlassKind::solid) {
    for (std::uint32_t material : builder->glass) builder->out->materials[material].thin = 0;
    return;
  }
  const Indices undecided = builder->glass;
  const std::vector<Object> objects = undecided.empty() ? std::vector<Object>() : opaque_objects(*builder);
  for (std::uint32_t material : undecided) divide(builder, &objects, material, &count);
  if (count.solid + count.thin == 0) return;
  std::string text = "glass without a volume: ";
  if (count.solid > 0) text += std::to_string(count.solid) + " closed, taken as solid";
  if (count.thin > 0)
    text += std::string(count.solid > 0 ? "; " : "") + std::to_string(count.thin) +
            " open or around something, taken as thin";
  note_remark(builder, text + " (--glass thin or solid)");
}

}  // namespace pocketray
