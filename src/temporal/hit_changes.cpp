// Finds first hits that changed.
#include "accel/accel_list.h"
#include "temporal/tile_search.h"

namespace pocketray {
namespace {

constexpr float kInfinity = __builtin_inff();

}  // namespace

Beam camera_beam(const CameraRays& c, const PixelRect& pixels, float t_max) {
  Box origins = empty_box(), directions = empty_box();
  for (int corner = 0; corner < 4; ++corner) {
    float x = static_cast<float>(pixels.column + (corner & 1 ? pixels.width : 0));
    float y = static_cast<float>(pixels.row + (corner & 2 ? pixels.height : 0));
    float sx = 2 * x / c.width - 1, sy = 1 - 2 * y / c.height;
    Vec3 aside = c.right * sx + c.up * sy;
    const Vec3 way = c.orthographic ? c.forward : c.forward + aside;
    origins = merge(origins, (c.orthographic ? c.eye + aside : c.eye) + way * c.near_distance);
    directions = merge(directions, way);
  }
  // These directions are as long as camera_ray()'s, or longer.
  return beam_along(origins, directions, t_max);
}

namespace {

// Returns whether the ray's first hit, which was `last` and is itself unchanged, is replaced, given its nearest moving
// triangle `moving`.
bool hits_otherwise(const MovingGeometry& m, const Hit& last, const Hit& moving) {
  std::uint32_t id = moving.triangle == kNoTriangle ? kNoTriangle : m.ids[moving.triangle];
  std::uint32_t was = last.triangle == kNoTriangle ? kNoTriangle : moving_index(m, last.triangle);
  if (was != kNoTriangle) return id != last.triangle || moving.t != last.t || moving.u != last.u || moving.v != last.v;
  if (id == kNoTriangle) return false;
  return last.triangle == kNoTriangle || moving.t < last.t || (moving.t == last.t && id < last.triangle);
}

// Returns whether the triangle hit in the last frame has changed.
bool has_hit_changed(const MovingGeometry& m, const Hit& last) {
  const std::uint32_t was = last.triangle == kNoTriangle ? kNoTriangle : moving_index(m, last.triangle);
  return was != kNoTriangle && m.triangle_changed[was];
}

// Lists the pixels of the tile whose camera rays may meet a change, by quarters of the tile, and returns their number;
// pixels whose hits have changed need no ray.
std::uint32_t list_seen(TileSearch* t, float t_max, std::uint8_t* pixels) {
  constexpr std::uint32_t kSide = kChangeTileSide / 2;
  const TilePixels& p = t->pixels;
  bool meets[2][2];
  for (std::uint32_t y = 0; y < 2; ++y)
    for (std::uint32_t x = 0; x < 2; ++x)
      meets[y][x] = sees_change(t->search, {p.column + kSide * x, p.row + kSide * y, kSide, kSide}, t_max);
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < p.count; ++i) {
    if (!meets[p.y[i] / kSide][p.x[i] / kSide]) continue;
    if (has_hit_changed(*t->search.moving, t->hits[index_of(t->frame.settings, p, i)]))
      t->changed |= bit_of(p, i);
    else
      pixels[count++] = static_cast<std::uint8_t>(i);
  }
  return count;
}

}  // namespace

bool sees_change(const ChangeSearch& search, const PixelRect& pixels, float t_max) {
  return search.moving->changed && meets_change(*search.moving, camera_beam(search.frame->view.camera, pixels, t_max));
}

void find_changed_hits(TileSearch* t, float t_max) {
  const TilePixels& p = t->pixels;
  Hit found[kPacketMax];
  std::uint8_t seen[kPacketMax];
  const std::uint32_t count = list_seen(t, t_max, seen);
  if (!t->frame.view.camera.has_one_origin) {
    for (std::uint32_t k = 0; k < count; ++k)
      kBvhAccel.closest(t->search.moving->now, sample_ray(t->frame, p, seen[k], t->offset), nullptr, &found[k],
                        t->stats);
  } else if (count > 0) {
    RayPacket packet;
    packet.origin = t->frame.view.camera.eye, packet.t_max = kInfinity, packet.count = count;
    for (std::uint32_t k = 0; k < count; ++k) {
      Vec3 direction = sample_ray(t->frame, p, seen[k], t->offset).direction;
      for (int axis = 0; axis < 3; ++axis) packet.direction[axis][k] = direction[axis];
    }
    kBvhAccel.closest_packet(t->search.moving->now, packet, nullptr, found, t->stats);
  }
  t->counts->moving_rays += count;
  for (std::uint32_t k = 0; k < count; ++k)
    if (hits_otherwise(*t->search.moving, t->hits[index_of(t->frame.settings, p, seen[k])], found[k]))
      t->changed |= bit_of(p, seen[k]);
}

}  // namespace pocketray
