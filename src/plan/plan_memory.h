// Sums every part's need() into a map of the memory block.
#pragma once
#include <cstddef>

#include "accel/accel.h"
#include "base/status.h"
#include "effect/effect_plan.h"
#include "plan/memory_list.h"
#include "scene/scene.h"
#include "temporal/coherence.h"

namespace pocketray {

enum class ArenaKind : int { scene, persistent, frame };
constexpr const char* kArenaNames[3] = {"scene", "persistent", "frame"};

struct MemoryPart {
  const char* name;
  ArenaKind arena;
  std::size_t bytes;
};

constexpr int kMemoryPartMax = 16;  // one for each name: tests/plan/plan_memory_test.cpp

struct MemoryPlan {
  MemoryPart parts[kMemoryPartMax];
  int part_count = 0;
  std::size_t arena_bytes[3] = {0, 0, 0};
  std::size_t total_bytes = 0, limit_bytes = 0;
  PlannedFor planned_for;
};

// Memory that the scene uses before planning.
struct SceneStorage {
  std::size_t arena_bytes = 0;    // already taken from the scene arena
  std::uint32_t recolorable = 0;  // materials kept as a copy, so that they can change
};

// Upper bounds.
struct PlannedLights {
  std::uint32_t points = 0;
  std::uint32_t selected = 0;  // points from which source selection chooses; 0: it is not planned
};

// The caller's use of the frame arena.
struct OutputNeed {
  std::size_t output_bytes = 0;  // to show or write a frame: packed pixels, PNG encoder, rows of render servers
  std::size_t tls_bytes = 0;     // to encrypt the links to render servers
  OutputNeed(std::size_t bytes) : output_bytes(bytes) {}
};

// Why every frame is traced whole if tracing only what changes does not fit.
inline constexpr const char* kCoherenceTooLarge = "coherence does not fit into memory";

// Plans the block.
// Fails with the figures and a setting that would fit if the total exceeds settings.memory_bytes; fills the plan in
// either case.
// Memory for tracing only what changes is planned as requested, and left out if everything else fits without it:
// *without_coherence (may be null) receives the reason, or null.
Status plan_memory(const Scene& scene, const Settings& settings, const EffectPlan& effects, const AccelInfo& accel,
                   const SceneStorage& storage, const PlannedLights& lights, const OutputNeed& output, MemoryPlan* plan,
                   const char** without_coherence = nullptr);
CoherencePlan coherence_plan(const PlannedFor& planned, std::uint32_t area_light_count, std::uint32_t recolorable = 0);

// Plans the block of a device that only shows frames rendered elsewhere: it has only the output.
Status plan_output_memory(const Settings& settings, const OutputNeed& output, MemoryPlan* plan);

// Draws the map as text, one line per part, into `text` (`size` bytes, always terminated). Returns its length.
std::size_t draw_memory_plan(const MemoryPlan& plan, char* text, std::size_t size);

}  // namespace pocketray
