// pocketray plan: shows the effects that a scene needs, why, and its memory map.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/options.h"
#include "effect/effect_list.h"
#include "session/animation_choice.h"
#include "session/measure.h"
#include "session/note.h"
#include "session/output.h"
#include "session/picture.h"
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

int run(const CommonOptions& options, bool prices) {
  OpenScene opened;
  Status status = check_outputs({{"SCENE", options.scene}}, {{"--json", options.json}});
  if (status.ok) status = open_scene(options, {picture_bytes}, &opened);
  const Renderer& renderer = opened.renderer;
  if (renderer.memory.plan.total_bytes > 0) {  // planned, even if it does not fit
    print_notes(opened);
    if (options.json != "-") {
      print_contents(options.scene, renderer);
      print_animations(renderer);
      print_effects(renderer.effects);
      print_memory(renderer.memory.plan);
      const char* without = renderer.history.state.unplanned_because;
      std::printf("coherence: %s%s\n", without ? "every frame is traced whole: " : "only what changes is traced",
                  without ? without : "");
    }
    if (!options.json.empty()) {
      Json json = {{"scene", options.scene},
                   {"triangles", renderer.scene.triangles.count},
                   {"fits", status.ok},
                   {"accelerator", renderer.accel.info->name},
                   {"coherence", renderer.history.state.planned},
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
  Command command = program.add_subcommand("plan", "show which effects a scene needs, why, and its memory map");
  add_scene_options(command, options.get());
  add_look_options(command, options.get());
  add_coherence_options(command, options.get());
  add_json_option(command, &options->json);
  command.add_flag("--prices", *prices, "also render it and print the cost of each effect on this machine");
  command.callback([=] { *exit_status = run(*options, *prices); });
}

}  // namespace pocketray
