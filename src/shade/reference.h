// The oracle: a path tracer in double precision with next-event estimation and multiple importance sampling [Veach
// 1997, sec. 9.2], nothing clamped and nothing left out but by Russian roulette. It shares the scene and its textures
// with the renderer and no arithmetic. For desktops: it takes as long as it takes.
#pragma once
#include "base/rng.h"
#include "shade/reference_world.h"

namespace pocketray {

enum class Transport {
  // The renderer's own lighting model at its limit: direct light, mirrors, glass and the ambient term, with whole area
  // lights, every depth and no cut-off. The glossy lobe reflects lights alone; shadow rays pass glass without bending.
  model,
  // Light from everywhere to everywhere, and no ambient term. Punctual lights reach through glass without bending, as
  // nothing else could find them there; area lights reach through it by the paths that are bent.
  physical,
};

struct ReferenceOptions {
  Transport transport = Transport::physical;
  std::uint32_t samples_per_pixel = 64;   // a square number parts the pixel into as many cells
  std::uint32_t depth_max = 0xFFFFFFFFu;  // scatterings along a path
  std::uint64_t seed = 1;
};

// A triangle that emits, and the share of all picks that go to it and those before it.
struct ReferenceEmitter {
  std::uint32_t triangle;
  double share_end, area;
};

struct Reference {
  ReferenceWorld world;
  Array<ReferenceEmitter> emitters;
};

// Bytes of arena that the reference of such a frame takes.
std::size_t reference_need(const FrameData& frame);
// The frame is posed and has its lights; it has to outlive the reference.
Reference make_reference(const FrameData& frame, Arena* arena);

// Radiance that arrives along a ray: one sample of it.
Vec3d sample_radiance(const Reference& reference, const ReferenceOptions& options, const Vec3d& origin,
                      const Vec3d& direction, Rng* rng);

// The means of the samples of rows [row_begin, row_end), width × rows of them. What a pixel gets depends on the seed
// and on itself alone.
void trace_reference(const Reference& reference, const ReferenceOptions& options, std::uint32_t row_begin,
                     std::uint32_t row_end, Vec3d* means);

}  // namespace pocketray
