// Rays by which the solver finds the light that reaches a point.
#pragma once
#include "desktop/radiosity/patches.h"
#include "shade/filters.h"

namespace pocketray {

// Rays through what lets light through, from points lifted off their surfaces.
struct SceneRays {
  const FrameData& frame;
  ShadowContext context = {&frame, nullptr};
  HitFilter opaque = {frame.filters.accept_opaque, &context};
  const std::vector<char>* bodies = nullptr;  // by triangle, see bodies.h; null: all are
  bool has_sheets = false;                    // one-sided ones
  const HitFilter* filter() const { return frame.filters.every_shadow ? &opaque : nullptr; }
};

// Radiance of the environment, without its sun, or of the background.
Vec3d sky_radiance(const Scene& scene, const Vec3& direction);

constexpr std::uint32_t kPatchRays = 36;  // from each of a patch's samples, to see what surrounds it

struct Receiver {
  Vec3d point, normal;
  double lift;
};

// Which backs of one-sided surfaces hide nothing, as for viewers: none; those of sheets, which are no bodies; all.
enum class Backs { hide, of_bodies_hide, hide_nothing };
bool is_visible(const SceneRays& rays, const Receiver& from, const Vec3d& to, Backs backs = Backs::hide);

// Shares of the cosine-weighted hemisphere over a receiver: no surface; a surface's front; the back of one.
struct Outlook {
  double open = 0, front = 0, back = 0;
  Vec3d sky = {0, 0, 0};  // radiance of the environment or background, times `open`
};
// Sheets are seen through from behind. `seed` turns the pattern of `count` rays, a square number.
Outlook look_around(const SceneRays& rays, const Receiver& from, std::uint32_t count, std::uint32_t seed);

// The sum of a receiver's form factors as it should be, given the sum as found and the share of `count` rays that met
// surfaces: that share, unless the sum lies within its error.
double credible_sum(double sum, double closed, std::uint32_t count);

// The share of a patch that a receiver sees, and the share from which the patch would see the receiver: they differ if
// backs are seen through. By up to kPatchSamples rays: all where the patch fills more than a hundredth of the
// hemisphere, otherwise one.
struct VisibleShare {
  double here, there;
};
VisibleShare visible_share(const SceneRays& rays, const Receiver& from, const Patch& patch, double factor,
                           std::uint32_t seed, Backs backs);

// The irradiance of point, spot and directional lights.
Vec3d light_irradiance(const SceneRays& rays, const Receiver& at);

// Calls work(i) for every i below count, on `threads` threads.
void for_each_on_threads(std::uint32_t count, std::uint32_t threads, void (*work)(void* user, std::uint32_t i),
                         void* user);
template <class Work>
void parallel_for(std::uint32_t count, std::uint32_t threads, const Work& work) {
  for_each_on_threads(
      count, threads, [](void* user, std::uint32_t i) { (*static_cast<const Work*>(user))(i); },
      const_cast<Work*>(&work));
}

}  // namespace pocketray
