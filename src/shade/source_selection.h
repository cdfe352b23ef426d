// Source selection: picks the lights that deserve shadow rays out of many [Kok91; Chen et al. 1991; both in Jansen92].
// A surface's lights are tested strongest first until the rest could add no more than the tolerance [Ward91, "Adaptive
// Shadow Testing for Ray Tracing"]; the rest is assumed to be as visible as the tested lights. Groups of lights that
// are far away or weak are bounded and estimated as one [Walter05, "Lightcuts", sec. 3], so that the cost grows more
// slowly than the number of lights. The true sum and the result lie in one interval: they differ by at most the
// tolerance times the true sum, glow included, in the brightest channel.
#pragma once
#include "base/arena.h"
#include "effect/effect_probe.h"
#include "shade/frame_data.h"
#include "shade/surface.h"
#include "shade/tile_shadows.h"
#include "shade/tracer.h"

namespace pocketray {

// In a search, each node and each light has at most one entry.
static_assert(2 * kPointLightCountMax < 0xFFFF, "LightEntry::next");
constexpr std::uint32_t search_entry_count(std::uint32_t light_points) { return 2 * light_points; }
inline std::size_t selection_need(const Settings& settings, std::uint32_t light_points) {
  if (light_points == 0) return 0;
  return arena_need<LightNode>(light_points) + arena_need<std::uint32_t>(light_points) +
         arena_need<LightEntry>(std::size_t(settings.threads) * search_entry_count(light_points));
}

// Finds a surface's lights from strongest to weakest, to half an octave. Material `m` has the lobes at the point.
class SourceSearch {
 public:
  SourceSearch(Tracer* tracer, const Surface& surface, const Material& m, const Vec3& to_viewer);
  // Upper bound of the sum of all lights not yet taken, by brightest channels; may be infinite.
  double remaining() {
    if (unbounded_ > 0) return static_cast<double>(__builtin_inff());
    if (remaining_ < remaining_max_ * 0x1p-26) sum_up();  // half its bits are lost
    return remaining_;
  }
  // Takes one of the strongest remaining entries. Returns true for a light; splits a group and returns false.
  bool take(LightEntry* light);
  bool is_empty() const { return strengths_ == 0; }
  // Unblocked contribution of the lights not taken; an estimate for groups.
  Vec3 estimate() const;

 private:
  // Entries in lists by the exponent and first mantissa bit of their bound; marks show which lists have entries, and a
  // second level shows which words of marks are set.
  static constexpr std::uint32_t kListCount = 512;

  void add_light(std::uint32_t light, std::uint16_t run);
  void add_node(std::uint32_t node, std::uint16_t run);
  void add(const LightEntry& entry);
  template <class Visit>
  void each_entry(Visit visit) const;
  void sum_up();
  bool radiance(const LightPoint& light, std::uint32_t run, Vec3* radiance) const;

  const FrameData& frame_;
  const LightPoint* light_points_;
  const Surface& surface_;
  const Material& material_;
  const BrdfInfo& lobe_;
  Vec3 to_viewer_, diffuse_, specular_;
  bool shines_;
  float diffuse_most_, specular_most_;  // upper bounds of the lobes; × cosine in the second
  Array<LightEntry> entries_;
  std::uint32_t entry_count_ = 0;
  std::uint16_t first_[kListCount];
  std::uint32_t marks_[kListCount / 32] = {};
  std::uint32_t strengths_ = 0;
  double remaining_ = 0, remaining_max_ = 0;  // the current sum, and the largest since it was last computed
  std::uint32_t unbounded_ = 0;
};

// Counts a light that the pixel being shaded selects. Once half of its tile's pixels so far have selected it, traces
// the shadow rays of all others: they will mostly select it, too, and rays are cheaper together.
void count_selected(Tracer* tracer, const LightRun& run, std::uint32_t light);
inline void trace_selected(Tracer* tracer, const LightRun& run, std::uint32_t light) {
  const TileShadows* tile = tracer->tile_shadows;
  if (tile && light < kTileLightMax && tile->selected[light] != kTileTraced) count_selected(tracer, run, light);
}

// Fills in the surfaces of a tile's first hits; no shadow ray is traced before its light is selected.
void find_tile_surfaces(Tracer* tracer, const RayPacket& rays, const Hit* hits, TileShadows* shadows);

}  // namespace pocketray
