// The oracle: a path tracer in double precision with next-event estimation and multiple importance sampling [Veach
// 1997, sec. 9.2], without clamping; only Russian roulette ends paths. It shares the scene and its textures with the
// renderer, but no arithmetic. Desktop only: it is slow.
#pragma once
#include "base/rng.h"
#include "desktop/reference/exact_sum.h"
#include "desktop/reference/world.h"

namespace pocketray {

enum class Transport {
  // The renderer's own lighting model in the limit: direct light, mirrors, glass and the ambient term, with whole area
  // lights, every depth and no cut-off. Glossy lobes reflect only lights and the surroundings, an environment by its
  // integral and without shadows; shadow rays pass glass without refraction.
  model,
  // Full light transport, without the ambient term. Punctual lights shine through glass without refraction, because no
  // path could find them otherwise; light of area lights is refracted.
  physical,
};

// Incremented whenever samples change, so that those of different programs are not added up.
constexpr int kReferenceSampler = 1;

struct ReferenceOptions {
  Transport transport = Transport::physical;
  std::uint32_t samples_per_pixel = 64;   // preferably a power of two, see sobol.h
  std::uint32_t first_sample = 0;         // of a pixel's sequence: continues an earlier picture
  std::uint32_t depth_max = 0xFFFFFFFFu;  // after that many scatterings, a path takes direct light and ends; in the
                                          // renderer's model with CutOff::beyond_depth
  std::uint64_t seed = 1;
};

// An emissive triangle, and the cumulative probability of picking it or one before it.
struct ReferenceEmitter {
  std::uint32_t triangle;
  double share_end, area;
};

// Spots through which light arrives by mirrors and glass, see guide.h.
constexpr std::uint32_t kReferenceSpotCountMax = 8;
struct ReferenceSpot {
  Vec3d low, high;      // box of the points that reflect or refract it
  double margin;        // tolerance around these
  std::uint32_t count;  // number of paths through it
  std::uint32_t kind;   // spots of different kinds are never merged
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
  Array<ReferenceSlot> table;  // hashed by position; kNone: no cell
  Array<ReferenceCell> cells;
};
constexpr std::uint32_t kGuidePathCount = 1u << 16;

struct Reference {
  ReferenceWorld world;
  Array<ReferenceEmitter> emitters;
  Array<double> environment_shares;  // environment.h
  ReferenceGuide guide;
};

// Bytes that the reference of such a frame takes from the arena.
std::size_t reference_need(const FrameData& frame);
// The frame must be posed, have its lights and outlive the reference. More guide paths reduce the noise of light from
// mirrors and glass.
Reference make_reference(const FrameData& frame, Arena* arena, std::uint32_t guide_path_count = kGuidePathCount);

// One sample of the radiance that arrives along a ray.
Vec3d sample_radiance(const Reference& reference, const ReferenceOptions& options, const Vec3d& origin,
                      const Vec3d& direction, Rng* rng);

// Mean samples of rows [row_begin, row_end), width × rows of them. A pixel depends only on the seed and its
// position.
void trace_reference(const Reference& reference, const ReferenceOptions& options, std::uint32_t row_begin,
                     std::uint32_t row_end, Vec3d* means);

// Adds the samples of a row to its sums: R, G, B of each pixel.
void add_reference(const Reference& reference, const ReferenceOptions& options, std::uint32_t row, ExactSum* sums);

}  // namespace pocketray
