#include "desktop/reference/guide.h"

#include <limits>

#include "base/check.h"
#include "base/fmath.h"
#include "brdf/directions.h"

namespace pocketray {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t kCellCountMax = 1u << 14, kTableSize = 4 * kCellCountMax;
constexpr double kGuidedShare = 0.15;  // of the directions, if there are spots
constexpr double kSpotSizeMax = 3;     // cells; points farther apart belong to different spots
constexpr std::uint32_t kMirrorSpotCountMax = 4;

// Finds the cell of a point, by its place along each axis; returns false if out of range.
bool cell_at(const ReferenceGuide& guide, const Vec3d& point, std::int32_t (&at)[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    double place = point[axis] / guide.cell_size;
    if (!(std::fabs(place) < 0x1p30)) return false;
    at[axis] = static_cast<std::int32_t>(place);
    at[axis] -= place < at[axis];
  }
  return true;
}

// The table slot of the cell, or a free one for it.
struct Found {
  ReferenceSlot* slot;
  std::uint32_t hash;
};
Found slot_of(const ReferenceGuide& guide, const std::int32_t (&at)[3]) {
  std::uint32_t hash = 0;
  for (std::int32_t a : at) {
    hash = (hash ^ static_cast<std::uint32_t>(a)) * 0x9E3779B1u;
    hash ^= hash >> 15;
  }
  for (std::uint32_t i = hash % kTableSize;; i = (i + 1) % kTableSize) {
    ReferenceSlot* slot = &guide.table[i];
    if (slot->cell == kNone) return {slot, hash};
    if (slot->hash != hash) continue;
    const std::int32_t* b = guide.cells[slot->cell].at;
    if (b[0] == at[0] && b[1] == at[1] && b[2] == at[2]) return {slot, hash};
  }
}

// Largest side of a spot after adding a point.
double grown_size(const ReferenceSpot& spot, const Vec3d& point) {
  double size = 0;
  for (int axis = 0; axis < 3; ++axis)
    size = std::fmax(size, std::fmax(spot.high[axis], point[axis]) - std::fmin(spot.low[axis], point[axis]));
  return size;
}

void add_to_spot(const Vec3d& point, ReferenceSpot* spot) {
  for (int axis = 0; axis < 3; ++axis) {
    spot->low[axis] = std::fmin(spot->low[axis], point[axis]);
    spot->high[axis] = std::fmax(spot->high[axis], point[axis]);
  }
  ++spot->count;
}

// Adds the point to the first spot of its kind that stays small, else to a new spot, else to the spot that stays
// smallest. A light's bright spot is a single one, whatever its size.
void add_to_cell(const ReferenceWay& way, double size_max, ReferenceCell* cell) {
  std::uint32_t best = 0, count = 0;
  double least = kInfinity;
  for (std::uint32_t i = 0; i < cell->spot_count; ++i) {
    if (cell->spot[i].kind != way.kind) continue;
    double size = grown_size(cell->spot[i], way.point);
    if (count++ == 0 || size < least) least = size, best = i;
  }
  if (count == 0 || (!(least <= size_max) && way.kind == kByMirrors && count < kMirrorSpotCountMax)) {
    if (cell->spot_count == kReferenceSpotCountMax) {
      if (count == 0) return;
    } else {
      best = cell->spot_count++;
      cell->spot[best] = {way.point, way.point, 0, 0, way.kind};
    }
  }
  ++cell->count;
  add_to_spot(way.point, &cell->spot[best]);
  cell->spot[best].margin = std::fmax(cell->spot[best].margin, way.margin);
}

// A spot as a sphere seen from a point: the vector to its centre, its radius and its distance, both squared.
struct GuideView {
  Vec3d way;
  double radius2, distance2;
};
GuideView view_of(const ReferenceSpot& spot, const Vec3d& point) {
  Vec3d way = (spot.low + spot.high) * 0.5 - point, size = spot.high - spot.low;
  double radius = 0.5 * length(size) + spot.margin;
  return {way, radius * radius, dot(way, way)};
}
bool is_within(const GuideView& view) { return !(view.distance2 > view.radius2); }
// 1 − cosine of the half angle of the cone around it; from inside, all directions.
double cone_height(const GuideView& view) {
  if (is_within(view)) return 2;
  double sine2 = view.radius2 / view.distance2;
  return sine2 / (1 + std::sqrt(1 - sine2));
}
bool is_towards(const Vec3d& direction, const GuideView& view) {
  double along = dot(direction, view.way);
  return is_within(view) || (along > 0 && along * along >= view.distance2 - view.radius2);
}

}  // namespace

std::size_t reference_cells_need() {
  return arena_need<ReferenceSlot>(kTableSize) + arena_need<ReferenceCell>(kCellCountMax);
}

void make_reference_cells(Arena* arena, ReferenceGuide* guide) {
  CHECK(arena != nullptr && guide != nullptr);
  guide->table = arena_array<ReferenceSlot>(arena, kTableSize);
  for (ReferenceSlot& slot : guide->table) slot = {0, kNone};
  guide->cells = arena_array<ReferenceCell>(arena, kCellCountMax);
  guide->cells.count = 0;
}

void remember(const Vec3d& point, const ReferenceWay& way, ReferenceGuide* guide) {
  for (int corner = 0; corner < 8; ++corner) {
    Vec3d beside = point;
    for (int axis = 0; axis < 3; ++axis) beside[axis] += guide->cell_size * ((corner >> axis & 1) ? 0.5 : -0.5);
    std::int32_t at[3];
    if (!cell_at(*guide, beside, at)) continue;
    Found found = slot_of(*guide, at);
    std::uint32_t cell = found.slot->cell;
    if (cell == kNone) {
      if (guide->cells.count == kCellCountMax) continue;
      cell = guide->cells.count++;
      *found.slot = {found.hash, cell};
      guide->cells[cell].count = guide->cells[cell].spot_count = 0;
      for (int axis = 0; axis < 3; ++axis) guide->cells[cell].at[axis] = at[axis];
    }
    add_to_cell(way, kSpotSizeMax * guide->cell_size, &guide->cells[cell]);
  }
}

const ReferenceCell* find_cell(const ReferenceGuide& guide, const Vec3d& point) {
  std::int32_t at[3];
  if (guide.cells.empty() || !cell_at(guide, point, at)) return nullptr;
  std::uint32_t cell = slot_of(guide, at).slot->cell;
  return cell == kNone ? nullptr : &guide.cells[cell];
}

double guided_density(const ReferenceSurface& s, const Vec3d& to_viewer, const Vec3d& to_light) {
  double lobes = lobe_density(s, to_viewer, to_light);
  const ReferenceCell* cell = s.cell;
  if (!cell) return lobes;
  double spots = 0;
  for (std::uint32_t i = 0; i < cell->spot_count; ++i) {
    GuideView view = view_of(cell->spot[i], s.point);
    if (is_towards(to_light, view)) spots += cell->spot[i].count / (2 * kPi * cone_height(view));
  }
  return (1 - kGuidedShare) * lobes + kGuidedShare * spots / cell->count;
}

bool sample_guided(const ReferenceSurface& s, const Vec3d& to_viewer, double choice, const Pair& pair,
                   Vec3d* direction) {
  const ReferenceCell* cell = s.cell;
  if (!cell) return sample_lobes(s, to_viewer, choice, pair, direction);
  if (choice >= kGuidedShare)
    return sample_lobes(s, to_viewer, (choice - kGuidedShare) / (1 - kGuidedShare), pair, direction);
  double pick = choice / kGuidedShare * cell->count;
  std::uint32_t i = 0;
  for (; i + 1 < cell->spot_count && pick >= cell->spot[i].count; ++i) pick -= cell->spot[i].count;
  GuideView view = view_of(cell->spot[i], s.point);
  Vec3d axis = is_within(view) ? Vec3d{0, 0, 1} : view.way / std::sqrt(view.distance2), tangent, bitangent;
  double below = cone_height(view) * pair.u, sine = std::sqrt(below * (2 - below)), phi = 2 * kPi * pair.v;
  make_basis(axis, &tangent, &bitangent);
  *direction = tangent * (sine * det_cos(phi)) + bitangent * (sine * det_sin(phi)) + axis * (1 - below);
  return dot(*direction, s.normal) > 0;
}

}  // namespace pocketray
