#include "shade/carried.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "shade/camera.h"
#include "shade/lattice.h"

namespace pocketray {
namespace {

// Chosen: neighbours that have moved apart by more, in pixels, show different bodies. It hardly matters: .5 to 3 give
// the same errors within 2 % (`cornell`, `statue`, Buddha, the milk truck).
constexpr float kPartedMax = 1;
// Measured on these, the duck and a bust, turning by 1 or 2 degrees a frame: where a surface has moved, what lies
// between two neighbours is closer to the truth than the last picture, which is between its pixels there, unless these
// neighbours differ by more than this share of their sum. At .05 the truck's errors are 8 % above a checkerboard's, at
// .2 all are below.
constexpr float kSimilar = 0.2f;

bool differ_little(const Vec3& a, const Vec3& b) {
  const Vec3 apart = abs(a - b), both = a + b;
  return apart.x + apart.y + apart.z <= kSimilar * (both.x + both.y + both.z);
}

bool same_view(const CameraRays& a, const CameraRays& b) {
  return a.eye == b.eye && a.forward == b.forward && a.right == b.right && a.up == b.up &&
         a.orthographic == b.orthographic;
}

bool are_still(const Vec2 (&steps)[4]) {
  return std::all_of(steps, steps + 4, [](const Vec2& step) { return step.x == 0 && step.y == 0; });
}

// How far the neighbours show what they did in the last picture, before a camera that rests.
enum class Likeness { none, similar, same };
Likeness like_last(const LastPicture& last, const CameraRays& camera, const CarryFrom& from) {
  if (!same_view(last.camera, camera)) return Likeness::none;
  Likeness likeness = Likeness::same;
  for (int i = 0; i < 4; ++i) {
    const Vec3& then = last.pixels[from.index[i]];
    if (*from.value[i] == then) continue;
    if (!differ_little(*from.value[i], then)) return Likeness::none;
    likeness = Likeness::similar;
  }
  return likeness;
}

// The last picture between four of its pixels. False outside.
bool sample(const LastPicture& last, const CameraRays& camera, float x, float y, Vec3* value) {
  const float left = std::floor(x), top = std::floor(y);
  if (!(left >= 0 && top >= 0 && left + 1 < camera.width && top + 1 < camera.height)) return false;
  const auto column = static_cast<std::uint32_t>(left), row = static_cast<std::uint32_t>(top);
  const auto width = static_cast<std::size_t>(camera.width);
  const Vec3* p = &last.pixels[row * width + column];
  const float across = x - left, down = y - top;
  const Vec3 above = p[0] + (p[1] - p[0]) * across, below = p[width] + (p[width + 1] - p[width]) * across;
  *value = above + (below - above) * down;
  return true;
}

}  // namespace

std::size_t last_picture_need(const Scene& scene, EffectMask mask, const Settings& settings) {
  if (!plans_last_picture(settings)) return 0;
  const std::uint32_t positions = kept_position_count(scene, mask);
  std::size_t bytes = positions ? arena_need<Vec3>(positions) : 0;
  if (plans_last_pixels(settings))
    bytes += arena_need<Vec3>(std::size_t(settings.width) * settings.height) +
             arena_need<Vec2>(std::size_t(settings.threads) * window_pixel_count(settings));
  return bytes;
}

bool place_in_picture(const CameraRays& c, const Vec3& point, Vec2* place) {
  const Vec3 to_point = point - c.eye;
  const float depth = c.orthographic ? 1 : dot(to_point, c.forward);
  if (!(depth > 0)) return false;
  const float x = dot(to_point, c.right) / (dot(c.right, c.right) * depth);
  const float y = dot(to_point, c.up) / (dot(c.up, c.up) * depth);
  *place = {(x + 1) * 0.5f * c.width, (1 - y) * 0.5f * c.height};
  return std::isfinite(place->x) && std::isfinite(place->y);
}

bool step_to_last(const FrameData& frame, const LastPicture& last, std::uint32_t column, std::uint32_t row,
                  const Hit& hit, Vec2* step) {
  const bool rests = same_view(frame.camera, last.camera);
  const float x = static_cast<float>(column) + 0.5f, y = static_cast<float>(row) + 0.5f;
  Vec3 point;
  if (hit.triangle == kNoTriangle) {
    if (rests) return *step = {0, 0}, true;
    if (frame.camera.orthographic || last.camera.orthographic) return false;
    point = last.camera.eye + camera_ray(frame.camera, x, y).direction;
  } else {
    const Triangle& t = frame.scene->triangles[hit.triangle];
    const Vec3 &a = last.positions[t.vertex(0)], &b = last.positions[t.vertex(1)], &c = last.positions[t.vertex(2)];
    const bool moved =
        a != frame.positions[t.vertex(0)] || b != frame.positions[t.vertex(1)] || c != frame.positions[t.vertex(2)];
    if (rests && !moved) return *step = {0, 0}, true;
    point = a * (1 - hit.u - hit.v) + b * hit.u + c * hit.v;
  }
  Vec2 place;
  if (!place_in_picture(last.camera, point, &place)) return false;
  *step = {place.x - x, place.y - y};
  return true;
}

Vec3 carried(const LastPicture& last, const CameraRays& camera, std::uint32_t column, std::uint32_t row,
             const CarryFrom& from, int pair, const Vec3& between) {
  const Vec3& there = last.pixels[std::size_t(row) * static_cast<std::size_t>(camera.width) + column];
  if (last.rests) return there;
  const Likeness likeness = like_last(last, camera, from);
  if (likeness == Likeness::same && (!from.knows_steps || are_still(from.step))) return there;
  Vec2 step = {0, 0};
  if (from.knows_steps) {
    const Vec2 &a = from.step[pair], &b = from.step[pair + 1];
    if (!(std::fabs(a.x - b.x) + std::fabs(a.y - b.y) <= kPartedMax)) return between;
    step = {(a.x + b.x) * 0.5f, (a.y + b.y) * 0.5f};
  } else if (likeness == Likeness::none) {
    return between;
  }
  Vec3 value = there;
  if ((step.x != 0 || step.y != 0) &&
      (differ_little(*from.value[pair], *from.value[pair + 1]) ||
       !sample(last, camera, static_cast<float>(column) + step.x, static_cast<float>(row) + step.y, &value)))
    return between;
  const Vec3* const* v = from.value;
  const Vec3 low = min(min(*v[0], *v[1]), min(*v[2], *v[3])), high = max(max(*v[0], *v[1]), max(*v[2], *v[3]));
  return min(max(value, low), high);
}

void keep_step(Tracer* tracer, std::uint32_t column, std::uint32_t row, const Hit& hit) {
  const FrameData& frame = *tracer->frame;
  const LatticeWindow& window = tracer->window;
  CHECK(frame.last != nullptr);
  const std::size_t at = (std::size_t(row) + kRowsAbove - window.row) * frame.settings.width + column;
  CHECK_LT(at, window.steps.count);
  Vec2* step = &window.steps[at];
  if (!step_to_last(frame, *frame.last, column, row, hit, step)) step->x = __builtin_nanf("");
}

}  // namespace pocketray
