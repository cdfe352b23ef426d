// One row per part of the memory that an effect or a setting calls for. The memory map, the refusals of settings beyond
// the plan and the settings to plan for when they are to change later all derive from the rows.
#pragma once
#include "base/array.h"
#include "base/status.h"
#include "effect/setting_list.h"
#include "scene/scene.h"

namespace pocketray {

// Settings, effects and lights that memory is planned for.
struct PlannedFor {
  Settings settings;
  EffectMask mask = 0;
  std::uint32_t light_points = 0;     // upper bound
  std::uint32_t sample_points = 0;    // likewise of Lights::sample_points
  std::uint32_t selected_points = 0;  // from which source selection chooses; 0: it is off
};

struct MemoryRow {
  const char* part;    // in the memory map; rows of one name are summed
  EffectMask effects;  // with any of these, frames cannot do with less than need(); 0: they are only slower
  std::size_t (*need)(const Scene& scene, const PlannedFor& in);
};
Array<const MemoryRow> memory_rows();

// Refuses settings that need more memory than planned, and says which. `mask`: their effects; *in receives what they
// need memory for.
Status check_planned(const Scene& scene, const PlannedFor& planned, const Settings& settings, EffectMask mask,
                     PlannedFor* in);

// Returns the settings with the value of each setting, among its own and the candidates', that needs most memory.
// Leaves out values for which the lights need too many points.
Settings widest_settings(const Scene& scene, const Settings& settings, Array<const Quality> candidates);

}  // namespace pocketray
