#include "desktop/sweep/radiosity_prediction.h"

#include <cmath>
#include <thread>

#include "base/check.h"
#include "desktop/accuracy/text.h"
#include "desktop/sweep/bake_rig.h"
#include "session/interrupt.h"
#include "session/radiosity.h"
#include "session/radiosity_solver.h"

namespace pocketray {
namespace {

// A solution of so many patches takes a hundredth of the usual one's time between patches.
constexpr std::uint32_t kFewPatches = 75;

const char* reason_against(const Rig& rig) {
  const Renderer& renderer = rig.opened.renderer;
  const IndirectChoice indirect = rig.baseline.settings.indirect;
  if (!renderer.scene.radiosity_triangles.empty()) return "the scene stores it";
  if (indirect != IndirectChoice::automatic) return "--indirect asks for another method";
  if (!rig.has_own_look) return "the scene's light is overridden";
  return can_solve_radiosity(renderer.scene) ? nullptr : "the scene has no light of its own";
}

}  // namespace

std::string bake_note(const SweepPlan& plan, const Scene& scene) {
  std::uint32_t count = 0;
  double patches = 0;  // work, relative to that with the usual number
  for (const SweepPoint& point : plan.points) {
    const BakeChoices& bake = point.configuration.bake;
    if (is_as_opened(bake) || !point.missing.empty()) continue;
    ++count;
    patches += std::pow(bake.patch_count / static_cast<double>(RadiosityOptions().patch_count), 2);
  }
  if (count == 0) return "--bake-choices changes nothing: no other bake of this scene differs";
  std::string text = format("--bake-choices bakes the scene %u times", count);
  RadiosityCost cost;
  if (patches > 0 && forecast_scene(std::thread::hardware_concurrency(), scene, &cost).ok)
    text += format(", about %.2g s of which are for radiosity", patches * cost.seconds);
  return text + ", and each counts as a configuration of every round";
}

Status predict_radiosity(const AccuracyOptions& options, const Judges& judges, Rigs* rigs, Sweep* sweep, bool* whole) {
  CHECK(rigs != nullptr && sweep != nullptr && whole != nullptr);
  RadiosityPrediction* predicted = &sweep->radiosity;
  const Rig& first = *first_rig(*rigs);
  if (const char* reason = reason_against(first)) {
    predicted->why_not = reason;
    return success();
  }
  RadiosityCost cost;
  const Status forecast = forecast_scene(std::thread::hardware_concurrency(), first.opened.renderer.scene, &cost);
  if (!forecast.ok) {
    predicted->why_not = forecast.message;
    return success();
  }
  predicted->seconds = cost.seconds, predicted->bytes = static_cast<double>(cost.bytes);
  predicted->flip_without = sweep->measured.front().truth.flip;
  Configuration coarse = first.baseline;
  coarse.bake.patch_count = kFewPatches;
  Rig* rig;
  const Status opened = rig_for(rigs, coarse, &rig);
  *whole = !interrupted;
  if (!*whole) return success();
  if (!opened.ok) {
    predicted->why_not = opened.message;
    return success();
  }
  RETURN_IF_ERROR(time_frame(rig, coarse, options.seconds, &predicted->ns_per_pixel));
  *whole = !interrupted;
  if (!*whole) return success();
  PointFigures figures;
  RETURN_IF_ERROR(find_errors(options, judges, false, coarse, rig, &figures));
  *whole = figures.has_errors;
  if (*whole) predicted->flip = figures.truth.flip;
  return success();
}

}  // namespace pocketray
