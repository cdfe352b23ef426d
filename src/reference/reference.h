// The oracle: a path tracer in double precision with next-event estimation and multiple importance sampling [Veach
// 1997, sec. 9.2], nothing clamped and nothing left out but by Russian roulette. It shares the scene and its textures
// with the renderer and no arithmetic. For desktops: it takes as long as it takes.
#pragma once
#include "base/rng.h"
#include "reference/world.h"

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
  std::uint32_t samples_per_pixel = 64;   // best a power of two: see sobol.h
  std::uint32_t first_sample = 0;         // of a pixel's sequence: with it a picture is gone on with
  std::uint32_t depth_max = 0xFFFFFFFFu;  // where a path scatters so often, it takes the light of the lights and ends
  std::uint64_t seed = 1;
};

// A triangle that emits, and the share of all picks that go to it and those before it.
struct ReferenceEmitter {
  std::uint32_t triangle;
  double share_end, area;
};

// Where light comes from by way of mirrors and glass, see reference_guide.h.
constexpr std::uint32_t kReferenceSpotCountMax = 8;
struct ReferenceSpot {
  Vec3d low, high;      // a box on what reflects or bends it
  double margin;        // around what was found of it
  std::uint32_t count;  // of the paths that came by it
  std::uint32_t kind;   // spots of different kinds are never joined
};
struct ReferenceCell {
  ReferenceSpot spot[kReferenceSpotCountMax];
  std::uint32_t spot_count, count;
  std::int32_t at[3];  // cells from the origin
};
struct ReferenceSlot {
  std::uint32_t hash, cell;
};
struct ReferenceGuide {
  double cell_size = 0;
  Array<ReferenceSlot> table;  // hashed by place; no cell: kNone
  Array<ReferenceCell> cells;
};
constexpr std::uint32_t kGuidePathCount = 1u << 16;

struct Reference {
  ReferenceWorld world;
  Array<ReferenceEmitter> emitters;
  ReferenceGuide guide;
};

// Bytes of arena that the reference of such a frame takes.
std::size_t reference_need(const FrameData& frame);
// The frame is posed and has its lights; it has to outlive the reference. More paths of the guide lessen the noise of
// light that comes by way of mirrors and glass.
Reference make_reference(const FrameData& frame, Arena* arena, std::uint32_t guide_path_count = kGuidePathCount);

// Radiance that arrives along a ray: one sample of it.
Vec3d sample_radiance(const Reference& reference, const ReferenceOptions& options, const Vec3d& origin,
                      const Vec3d& direction, Rng* rng);

// The means of the samples of rows [row_begin, row_end), width × rows of them. What a pixel gets depends on the seed
// and on itself alone.
void trace_reference(const Reference& reference, const ReferenceOptions& options, std::uint32_t row_begin,
                     std::uint32_t row_end, Vec3d* means);

}  // namespace pocketray
