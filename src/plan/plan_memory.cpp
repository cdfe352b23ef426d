#include "plan/plan_memory.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <utility>

#include "base/check.h"
#include "base/span.h"
#include "indirect/indirect_list.h"
#include "plan/place_light_polygons.h"
#include "plan/resolve.h"
#include "scene/animate.h"
#include "shade/sample_points.h"

namespace pocketray {
namespace {

void add_part(MemoryPlan* plan, const char* name, ArenaKind arena, std::size_t bytes) {
  CHECK(name != nullptr);
  if (bytes == 0) return;  // an absent effect takes no memory
  MemoryPart* part = std::find_if(plan->parts, plan->parts + plan->part_count, [&](const MemoryPart& other) {
    return std::strcmp(other.name, name) == 0 && other.arena == arena;
  });
  if (part == plan->parts + plan->part_count) {
    CHECK_LT(plan->part_count, kMemoryPartMax);
    plan->parts[plan->part_count++] = {name, arena, 0};
  }
  part->bytes = size_sum(part->bytes, bytes);
  std::size_t* arena_bytes = &plan->arena_bytes[static_cast<int>(arena)];
  *arena_bytes = size_sum(*arena_bytes, bytes);
  plan->total_bytes = size_sum(plan->total_bytes, bytes);
}

// Aligns the start of each arena.
void align_arenas(MemoryPlan* plan) {
  for (std::size_t& bytes : plan->arena_bytes) {
    if (bytes == 0) continue;
    bytes = size_sum(bytes, kArenaAlignment);
    plan->total_bytes = size_sum(plan->total_bytes, kArenaAlignment);
  }
  const std::size_t* bytes = plan->arena_bytes;
  CHECK_EQ(size_sum(size_sum(bytes[0], bytes[1]), bytes[2]), plan->total_bytes);
}

std::size_t megabytes_up(std::size_t bytes) { return ((bytes - 1) >> 20) + 1; }
double megabytes(std::size_t bytes) { return static_cast<double>(bytes) / (1 << 20); }

}  // namespace

CoherencePlan coherence_plan(const PlannedFor& planned, std::uint32_t area_light_count, std::uint32_t recolorable) {
  const Settings& settings = planned.settings;
  CoherencePlan plan;
  plan.width = settings.width, plan.height = settings.height;
  plan.samples = settings.samples_per_pixel + settings.edge_samples, plan.threads = settings.threads,
  plan.light_points = planned.light_points, plan.sample_points = planned.sample_points;
  plan.area_lights = area_light_count, plan.recolorable = recolorable;
  plan.compensated = settings.compensation == Compensation::rays;
  plan.table_side = settings.coherence_table, plan.tables_only = settings.coherence_by_tables;
  return plan;
}

namespace {

Status plan_memory_with(const Scene& scene, const Settings& settings, const EffectPlan& effects, const AccelInfo& accel,
                        const SceneStorage& storage, const PlannedLights& lights, const OutputNeed& output,
                        bool with_coherence, MemoryPlan* plan) {
  CHECK(plan != nullptr);
  CHECK(settings.threads >= 1 && settings.threads <= kThreadCountMax);
  CHECK(settings.width <= kImageSideMax && settings.height <= kImageSideMax);
  *plan = MemoryPlan();
  plan->limit_bytes = settings.memory_bytes;
  const std::size_t environment = std::min(scene.environment_texels.bytes(), storage.arena_bytes);
  add_part(plan, "scene", ArenaKind::scene, storage.arena_bytes - environment);
  add_part(plan, "environment", ArenaKind::scene, environment);

  bool moves = has(effects.mask, Effect::animation) && is_animated(scene);
  std::uint32_t triangles = scene.triangles.count;
  bool rebuilds = moves && !accel.refit;  // for every frame
  std::size_t keep = 0, scratch = 0;
  if (scene.accel.empty() || rebuilds) {
    keep = accel.need(triangles);
    scratch = accel.scratch_need(triangles);
  } else if (moves) {
    keep = arena_need(scene.accel.bytes());  // refit needs a writable copy
  }
  add_part(plan, "accelerator", ArenaKind::persistent, keep);
  add_part(plan, "pose", ArenaKind::persistent, moves ? pose_need(scene) : 0);
  scratch = std::max(scratch, indirect_need(scene, settings, prepared_methods(scene, settings, effects.mask)).scratch);
  const std::uint32_t sample_points = sample_point_count(effects.mask, lights.points);
  plan->planned_for = {settings, effects.mask, lights.points, sample_points, lights.selected};
  for (const MemoryRow& row : memory_rows())
    add_part(plan, row.part, ArenaKind::persistent, row.need(scene, plan->planned_for));
  add_part(plan, "materials", ArenaKind::persistent,
           storage.recolorable ? arena_need<Material>(storage.recolorable) : 0);
  add_part(plan, "threads", ArenaKind::persistent, arena_need<Tracer>(settings.threads));
  add_part(plan, "spans", ArenaKind::persistent,
           arena_need<Span>(settings.height) + arena_need<std::uint64_t>(settings.height));
  std::size_t pixel_count = static_cast<std::size_t>(settings.width) * settings.height;
  add_part(plan, "radiance", ArenaKind::persistent, arena_need<Vec3>(pixel_count));
  if (with_coherence) {
    add_part(plan, "coherence", ArenaKind::persistent,
             coherence_need(
                 scene, effects.mask,
                 coherence_plan(plan->planned_for, light_polygon_count(scene, effects.mask), storage.recolorable)));
    scratch = std::max(scratch, coherence_scratch_need(scene, effects.mask));
  }
  // A single build's scratch is free again before the first frame is shown, so output shares its part of the frame
  // arena.
  if (rebuilds) add_part(plan, "build scratch", ArenaKind::frame, std::exchange(scratch, 0));
  add_part(plan, scratch > output.output_bytes ? "build scratch, then output" : "output", ArenaKind::frame,
           std::max(scratch, output.output_bytes));
  add_part(plan, "encrypted links", ArenaKind::frame, output.tls_bytes);
  align_arenas(plan);

  if (plan->total_bytes <= plan->limit_bytes) return success();
  const MemoryPart* largest = &plan->parts[0];
  for (int i = 1; i < plan->part_count; ++i)
    if (plan->parts[i].bytes > largest->bytes) largest = &plan->parts[i];
  std::size_t fits = megabytes_up(plan->total_bytes);
  return failure(
      "the scene needs %.1f MiB of memory but %.1f MiB are allowed; the largest part is %s with %.1f MiB%s; "
      "%zu MiB would be enough",
      megabytes(plan->total_bytes), megabytes(plan->limit_bytes), largest->name, megabytes(largest->bytes),
      scene.accel.empty() && triangles > 1000 ? " (baking the scene saves the build's scratch)" : "", fits);
}

}  // namespace

Status plan_memory(const Scene& scene, const Settings& settings, const EffectPlan& effects, const AccelInfo& accel,
                   const SceneStorage& storage, const PlannedLights& lights, const OutputNeed& output, MemoryPlan* plan,
                   const char** without_coherence) {
  const bool changes = (has(effects.mask, Effect::animation) && is_animated(scene)) || storage.recolorable > 0;
  bool wanted = settings.coherence == CoherenceMode::on || (settings.coherence == CoherenceMode::automatic && changes);
  const char* mixes = unfollowed_because(effects.mask, settings.coherence_by_tables);
  wanted = wanted && !mixes;
  const char* why = mixes                                      ? mixes
                    : settings.coherence == CoherenceMode::off ? "coherence is off"
                    : wanted                                   ? nullptr
                                                               : "nothing moves";
  Status status = plan_memory_with(scene, settings, effects, accel, storage, lights, output, wanted, plan);
  if (wanted && !status.ok) {
    wanted = false;
    why = kCoherenceTooLarge;
    status = plan_memory_with(scene, settings, effects, accel, storage, lights, output, wanted, plan);
  }
  if (without_coherence) *without_coherence = why;
  return status;
}

Status plan_output_memory(const Settings& settings, const OutputNeed& output, MemoryPlan* plan) {
  CHECK(plan != nullptr);
  *plan = MemoryPlan();
  plan->limit_bytes = settings.memory_bytes;
  add_part(plan, "output", ArenaKind::frame, output.output_bytes);
  add_part(plan, "encrypted links", ArenaKind::frame, output.tls_bytes);
  align_arenas(plan);
  if (plan->total_bytes <= plan->limit_bytes) return success();
  return failure(
      "pictures of %ux%u pixels need %.1f MiB of memory without a scene but %.1f MiB are allowed; "
      "%zu MiB would be enough, or a smaller picture",
      settings.width, settings.height, megabytes(plan->total_bytes), megabytes(plan->limit_bytes),
      megabytes_up(plan->total_bytes));
}

std::size_t draw_memory_plan(const MemoryPlan& plan, char* text, std::size_t size) {
  std::size_t length = 0;
  auto add = [&](const char* format, auto... values) {
    int n = std::snprintf(text + length, size - length, format, values...);
    if (n > 0) length = std::min(length + static_cast<std::size_t>(n), size - 1);
  };
  CHECK_GT(size, 0u);
  CHECK(text != nullptr);
  CHECK_LE(plan.part_count, kMemoryPartMax);
  text[0] = 0;
  auto line = [&](const char* name, const char* where, std::size_t bytes) {
    char bar[33];
    std::size_t filled = plan.total_bytes ? bytes * 32 / plan.total_bytes : 0;
    for (std::size_t i = 0; i < 32; ++i) bar[i] = i < filled ? '#' : '.';
    bar[32] = 0;
    bool small = bytes < (100u << 10);
    add("  %-11s %-27s %9.1f %s  %s\n", where, name, small ? static_cast<double>(bytes) / 1024 : megabytes(bytes),
        small ? "KiB" : "MiB", bar);
  };
  for (int arena = 0; arena < 3; ++arena)
    for (int i = 0; i < plan.part_count; ++i)
      if (plan.parts[i].arena == static_cast<ArenaKind>(arena))
        line(plan.parts[i].name, kArenaNames[arena], plan.parts[i].bytes);
  add("  %-11s %-27s %9.1f MiB  of %.1f MiB allowed\n", "total", "", megabytes(plan.total_bytes),
      megabytes(plan.limit_bytes));
  return length;
}

}  // namespace pocketray
