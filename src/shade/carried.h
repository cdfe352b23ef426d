// Interleaved pictures: half of the pixels are traced, the other half in the next picture, and what is missing is
// carried over from the last picture: where the surface was, as its camera and its triangle moved, and within the
// range of the traced neighbours' colours, so that what has changed leaves no ghosts: checkerboard rendering
// [El Mansouri 2016, "Rendering Rainbow Six Siege", GDC] with the clamp of [Karis 2014, "High-Quality Temporal
// Supersampling", SIGGRAPH courses].
#pragma once
#include "shade/lattice.h"

namespace pocketray {

// Its memory: planned for with the settings, even if their effects are off at first. Pixels are kept to be carried
// over; where vertices were, to tell how fast surfaces move, too.
constexpr bool plans_last_pixels(const Settings& settings) {
  return settings.resolution == Resolution::interleaved && plans_lattice(settings);
}
constexpr bool plans_last_picture(const Settings& settings) {
  return plans_last_pixels(settings) || settings.moving_contrast == MovingContrast::as_seen;
}
inline std::uint32_t kept_position_count(const Scene& scene, EffectMask mask) {
  return has(mask, Effect::animation) && is_animated(scene) ? scene.positions.count : 0;
}
std::size_t last_picture_need(const Scene& scene, EffectMask mask, const Settings& settings);

// Where a camera sees a point, in pixels; false: behind it, or nowhere.
bool place_in_picture(const CameraRays& camera, const Vec3& point, Vec2* place);

// How far it is, in pixels, from where the pixel's ray hits a surface now to where that was in the last picture. The
// background lies at infinity. False if that camera did not see it.
bool step_to_last(const FrameData& frame, const LastPicture& last, std::uint32_t column, std::uint32_t row,
                  const Hit& hit, Vec2* step);

// The traced neighbours of a missing pixel, in opposite pairs.
struct CarryFrom {
  const Vec3* value[4];
  std::size_t index[4];  // in the picture
  Vec2 step[4];          // x is NaN where there is none
  bool knows_steps;
};

// The missing pixel; `between` is what its neighbours make of it, from the pair that `pair` begins.
Vec3 carried(const LastPicture& last, const CameraRays& camera, std::uint32_t column, std::uint32_t row,
             const CarryFrom& from, int pair, const Vec3& between);

// For Tracer::window: keeps how far the pixel has moved.
void keep_step(Tracer* tracer, std::uint32_t column, std::uint32_t row, const Hit& hit);

}  // namespace pocketray
