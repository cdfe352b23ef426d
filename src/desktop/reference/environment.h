// The stored environment in double precision, sampled by importance: luminance × solid angle.
#pragma once
#include "desktop/reference/optics.h"

namespace pocketray {

// Radiance for rays that hit nothing, and in place of rays beyond the maximum depth.
Vec3d radiance_behind(const FrameData& frame, const Vec3d& direction);
Vec3d radiance_beyond_depth(const FrameData& frame, const Vec3d& direction);

// Cumulative shares of the map's texels in the probability of picking them; empty without an environment or for a black
// one.
std::size_t environment_shares_need(const FrameData& frame);
Array<double> make_environment_shares(const FrameData& frame, Arena* arena);

// Density of picking a direction, 1/sr.
double environment_density(const Reference& reference, const Vec3d& direction);
// Picks a direction from numbers uniform in [0, 1).
Vec3d sample_environment(const Reference& reference, const Pair& pair);

// One sample of the environment's light towards the viewer. In the renderer's model only diffuse surfaces are shadowed,
// and Phong's lobe reflects none; in light transport, paths that continue get a share by multiple importance sampling.
Vec3d environment_light(const Reference& reference, const ReferenceOptions& options, const ReferenceSurface& s,
                        const Vec3d& to_viewer, bool goes_on, ReferenceSamples* samples);

// The renderer's own approximation: nine coefficients, the split sum, and the visible fraction of all distant lights
// (where a pixel traces rays to some).
Vec3d environment_light_as_rendered(const Reference& reference, const ReferenceSurface& s, const Vec3d& to_viewer);

}  // namespace pocketray
