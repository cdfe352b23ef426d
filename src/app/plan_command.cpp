// pocketray plan: the effects a scene calls for, the memory map, and why.
#include "app/commands.h"
#include "app/options.h"
#include "app/picture.h"
#include "app/report.h"

namespace pocketray {
namespace {

int run(const CommonOptions& options) {
  OpenScene opened;
  Status status = open_scene(options, picture_bytes, &opened);
  const Renderer& r = opened.renderer;
  if (r.memory.total_bytes > 0) {  // planned, even if it does not fit
    print_notes(opened);
    if (options.json != "-") {
      std::printf("%s: %s triangles, %u materials, %u textures, %u lights\n", options.scene.c_str(), grouped(r.scene.triangles.count).c_str(),
                  r.scene.materials.count, r.scene.textures.count, r.scene.lights.count);
      print_effects(r.effects);
      print_memory(r.memory);
    }
    if (!options.json.empty()) {
      Json json = {{"scene", options.scene},
                   {"triangles", r.scene.triangles.count},
                   {"fits", status.ok},
                   {"effects", effects_json(r.effects)},
                   {"memory", memory_json(r.memory)}};
      Status written = write_json(options.json, json);
      if (!written.ok) return report(written);
    }
  }
  return report(status);
}

}  // namespace

void add_plan_command(CLI::App* program, int* exit_status) {
  auto options = std::make_shared<CommonOptions>();
  CLI::App* command = program->add_subcommand("plan", "show which effects a scene calls for, the memory map, and why");
  add_scene_options(command, options.get());
  command->add_option("--json", options->json, "also write it as JSON to FILE, or - for standard output");
  command->callback([options, exit_status] { *exit_status = run(*options); });
}

}  // namespace pocketray
