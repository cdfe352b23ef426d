// pocketray plan: shows the effects that a scene needs, why, and its memory map.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/commands.h"
#include "app/options.h"
#include "effect/effect_list.h"
#include "session/animation_choice.h"
#include "session/measure.h"
#include "session/note.h"
#include "session/output.h"
#include "session/picture.h"
#include "session/quality_choice.h"
#include "session/radiosity.h"
#include "session/report.h"

namespace pocketray {
namespace {

// Renders the scene with and without each effect.
Status print_prices(const CommonOptions& options, OpenScene* opened) {
  RETURN_IF_ERROR(start_scene(opened, options));
  Measurement m = make_measurement(opened->renderer, 1);
  RETURN_IF_ERROR(measure_prices(&opened->renderer, &m));
  std::printf("prices on this machine, ns per pixel\n");
  for (const EffectRow& row : kEffectList) {
    double price = m.effect_price[static_cast<int>(row.effect)];
    if (std::isfinite(price)) std::printf("  %-18s %8.0f\n", row.name, price);
  }
  return success();
}

void print_contents(const std::string& name, const Renderer& renderer) {
  const Scene& scene = renderer.scene;
  const auto emitting = std::count_if(scene.materials.begin(), scene.materials.end(),
                                      [](const Material& material) { return !is_zero(material.emission); });
  std::printf("%s: %s, %s, %s, %s", shown(name).c_str(), counted(scene.triangles.count, "triangle").c_str(),
              counted(scene.materials.count, "material").c_str(), counted(scene.textures.count, "texture").c_str(),
              counted(scene.lights.count, "light").c_str());
  if (emitting > 0) std::printf(", %s", counted(static_cast<std::uint64_t>(emitting), "emitting material").c_str());
  std::printf("; accelerator %s\n", renderer.accel.info->name);
}

void print_animations(const Renderer& renderer) {
  const Scene& scene = renderer.scene;
  for (std::uint32_t index : numbered_animations(scene)) std::printf("%s\n", describe_animation(scene, index).c_str());
  if (scene.animations.count > 1 || (scene.animations.count && renderer.view.animation == kNone))
    std::printf("plays: %s\n", describe_animation(scene, renderer.view.animation).c_str());
}

Json animations_json(const Renderer& renderer) {
  Json list = Json::array();
  for (std::uint32_t index : numbered_animations(renderer.scene))
    list.push_back({{"description", describe_animation(renderer.scene, index)},
                    {"seconds", renderer.scene.animations[index].duration},
                    {"plays", index == renderer.view.animation}});
  return list;
}

using Levels = LevelMeaning[kQualityLevelCount];

double frame_ms(const Renderer& renderer, const LevelMeaning& level) {
  return static_cast<double>(level.candidate.ns_per_pixel) * renderer.settings.width * renderer.settings.height * 1e-6;
}

void print_levels(const Renderer& renderer, const Levels& levels) {
  std::printf("--quality, %s\n",
              !levels[0].is_measured ? "built in; `pocketray accuracy` measures what this scene gains from each"
              : levels[0].is_priced  ? "as `pocketray accuracy` measured this scene (ꟻLIP to full light transport)"
                                     : "as `pocketray accuracy` measured this scene, with times of another machine or "
                                       "number of threads; `bench --front` measures those of this one");
  for (int i = 0; i < kQualityLevelCount; ++i) {
    char change[kFrontLineMax];
    describe_change(Quality(), levels[i].candidate, change, sizeof change);
    std::printf("  %-7s", kQualityLevelNames[i]);
    if (levels[i].is_measured)
      std::printf(" %8.1f ms, ꟻLIP %.3f ", frame_ms(renderer, levels[i]),
                  static_cast<double>(levels[i].candidate.flip));
    std::printf(" %s\n", same_quality(levels[i].candidate, Quality()) ? "the defaults" : change);
  }
}

Json levels_json(const Renderer& renderer, const Levels& levels) {
  Json list = Json::array();
  for (int i = 0; i < kQualityLevelCount; ++i) {
    char settings[kFrontLineMax];
    format_quality(levels[i].candidate, settings, sizeof settings);
    const bool is_measured = levels[i].is_measured;
    list.push_back({{"level", kQualityLevelNames[i]},
                    {"settings", settings},
                    {"measured", is_measured},
                    {"priced_here", levels[i].is_priced},
                    {"ms", is_measured ? Json(frame_ms(renderer, levels[i])) : Json()},
                    {"flip", is_measured ? Json(levels[i].candidate.flip) : Json()}});
  }
  return list;
}

// Forecast of what `bake --radiosity` would store for a scene without it.
struct RadiosityOffer {
  bool is_open = false;   // it stores none and has light to solve for
  std::size_t bytes = 0;  // at least; 0: unknown
  RadiosityCost cost;     // predicted from a sample of the work, if asked for
};
// Chosen: a quarter of a second.
constexpr std::uint32_t kOfferTrianglesMax = 250000;

RadiosityOffer find_offer(const Renderer& renderer) {
  const Scene& scene = renderer.scene;
  if (!scene.radiosity_triangles.empty() || !can_solve_radiosity(scene)) return {};
  return {true, scene.triangles.count <= kOfferTrianglesMax ? stored_radiosity_bytes(scene) : 0, {}};
}

void print_offer(const RadiosityOffer& offer) {
  if (!offer.is_open) return;
  constexpr double kMebibyte = 1 << 20;
  std::printf("radiosity: not stored; bake --radiosity would ");
  if (offer.cost.bytes > 0)
    std::printf("take %.2g s here and store %.2f MiB", offer.cost.seconds,
                static_cast<double>(offer.cost.bytes) / kMebibyte);
  else if (offer.bytes > 0)
    std::printf("store %.2f MiB or more; --prices predicts its time", static_cast<double>(offer.bytes) / kMebibyte);
  else
    std::printf("take what --prices predicts");
  std::printf(", `pocketray accuracy` its error\n");
}

Json offer_json(const RadiosityOffer& offer) {
  if (!offer.is_open) return Json();
  const bool is_predicted = offer.cost.bytes > 0;
  return {{"bytes_at_least", offer.bytes > 0 ? Json(offer.bytes) : Json()},
          {"bytes", is_predicted ? Json(offer.cost.bytes) : Json()},
          {"seconds", is_predicted ? Json(offer.cost.seconds) : Json()}};
}

int run(const CommonOptions& options, bool prices) {
  OpenScene opened;
  Levels levels;
  RadiosityOffer offer;
  Status status = check_outputs({{"SCENE", options.scene}}, {{"--json", options.json}});
  OpenHooks hooks = {picture_bytes};
  hooks.loaded = [&](const SceneSource& source, Renderer* loaded) {
    find_levels(options.scene, source, loaded, levels);
    offer = find_offer(*loaded);
    if (prices && offer.is_open)  // a scene without surfaces that light reaches has nothing to solve
      offer.is_open = forecast_scene(std::thread::hardware_concurrency(), loaded->scene, &offer.cost).ok;
    return success();
  };
  if (status.ok) status = open_scene(options, hooks, &opened);
  const Renderer& renderer = opened.renderer;
  if (renderer.memory.plan.total_bytes > 0) {  // planned, even if it does not fit
    print_notes(opened);
    if (options.json != "-") {
      print_contents(options.scene, renderer);
      print_animations(renderer);
      print_effects(renderer.effects);
      print_memory(renderer.memory.plan);
      print_levels(renderer, levels);
      print_offer(offer);
      const char* without = renderer.history.state.unplanned_because;
      std::printf("coherence: %s%s\n", without ? "every frame is traced whole: " : "only what changes is traced",
                  without ? without : "");
    }
    if (!options.json.empty()) {
      Json json = {{"scene", options.scene},
                   {"triangles", renderer.scene.triangles.count},
                   {"fits", status.ok},
                   {"accelerator", renderer.accel.info->name},
                   {"texture_side_max", renderer.settings.texture_side_max},
                   {"coherence", renderer.history.state.planned},
                   {"quality", levels_json(renderer, levels)},
                   {"radiosity_offer", offer_json(offer)},
                   {"animations", animations_json(renderer)},
                   {"effects", effects_json(renderer.effects)},
                   {"memory", memory_json(renderer.memory.plan)}};
      Status written = write_json(options.json, json);
      if (!written.ok) return report(written);
    }
  }
  if (status.ok && prices) status = print_prices(options, &opened);
  return report(status);
}

}  // namespace

void add_plan_command(Command program, int* exit_status) {
  auto options = std::make_shared<CommonOptions>();
  auto prices = std::make_shared<bool>(false);
  Command command = program.add_subcommand("plan", "show which effects a scene needs, why, and its memory");
  add_scene_options(command, options.get());
  add_look_options(command, options.get());
  add_coherence_options(command, options.get());
  command.chapter("Output");
  command.add_flag("--prices", *prices, "also print what each effect and --radiosity cost here");
  add_json_option(command, &options->json);
  command.everyday("Picture", {"--size", "--quality", "--effects", "--environment"});
  command.everyday("Device", {"--memory", "--device", "--accel"});
  command.everyday("Output", {"--prices", "--json"});
  command.example("pocketray plan seesaw --device miyoo-mini");
  command.callback([=] { *exit_status = run(*options, *prices); });
}

}  // namespace pocketray
