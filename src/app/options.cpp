#include "app/options.h"

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "accel/accel_list.h"
#include "scene/builtin/builtin.h"

namespace pocketray {
namespace {

std::string scene_help() {
  std::string text = "a built-in scene (";
  int count;
  const BuiltinScene* list = builtin_list(&count);
  for (int i = 0; i < count; ++i) text += std::string(i ? ", " : "") + list[i].name;
  text += "), a .pray file";
#ifdef POCKETRAY_HAVE_IMPORT
  text += ", or a model: glTF, OBJ, PLY, STL, …";
#endif
  return text;
}

std::string device_names() {
  std::string names;
  for (const platform::Device& device : platform::kDevices)
    names += std::string(names.empty() ? "" : ", ") + device.name;
  return names;
}

CLI::Option* add_setting_option(CLI::App* command, const SettingRow& row, SettingOption* option) {
  char range[128];
  describe_range(row, range, sizeof range);
  std::string name = std::string("--") + row.name;
  std::string help = row.what + std::string(row.field.kind == SettingKind::choice ? ": " : ", ") + range;
  if (*row.note) help += std::string("; ") + row.note;
  if (row.field.kind == SettingKind::count) return command->add_option(name, option->count, help);
  if (row.field.kind == SettingKind::real) return command->add_option(name, option->real, help);
  return command->add_option(name, option->choice, help);
}

}  // namespace

void add_scene_options(CLI::App* command, CommonOptions* o) {
  command->add_option("SCENE", o->scene, scene_help())->required();
  command->add_option("--size", o->size, "picture size in pixels, WIDTHxHEIGHT")
      ->default_str("320x240, or the emulated device's");
  for (int i = 0; i < kSettingCount; ++i)
    add_setting_option(command, kSettingList[i], &o->settings.options[i])->capture_default_str();
  command
      ->add_option("--effects", o->effects,
                   "what to simulate: auto (what the scene calls for), all, or names; \"auto,-shadow\" leaves one out")
      ->capture_default_str();
  command->add_option("--memory", o->memory, "the block everything must fit in, as 24M")
      ->default_str("64M, or the device's");
  command->add_option("--device", o->device,
                      "take memory, and in view rotation and buttons, from a device's profile: " + device_names());
  command->add_option("--emulate", o->emulate,
                      "trace as slowly as a handheld would, with its memory, cores and screen: see --device");
  command->add_option("--threads", o->threads, "threads that trace; 0: one per core")->capture_default_str();
  command->add_option("--isa", o->isa, "instruction set to trace with: baseline, avx2 or avx512")
      ->default_str("the best of this CPU");
  std::vector<std::string> accels = {"auto"};
  std::string known, automatic;
  for (const AccelInfo* info : kAccelList) {
    accels.push_back(info->name);
    known +=
        std::string(known.empty() ? "" : ", ") + info->name + (*info->help ? std::string(" (") + info->help + ")" : "");
    if (info->is_automatic)
      automatic += std::string(automatic.empty() ? ", else " : ", or where that does not fit ") + info->name;
  }
  command
      ->add_option("--accel", o->accel,
                   "what finds a ray's triangles: " + known + ", or auto: what the scene was baked with" + automatic)
      ->check(CLI::IsMember(accels))
      ->capture_default_str();
  command->add_option("--camera", o->camera,
                      "\"ex,ey,ez tx,ty,tz ux,uy,uz VFOV\": eye, target, up, degrees from top to bottom");
  command->add_option("--camera-index", o->camera_index, "which of the scene's cameras")->capture_default_str();
  command->add_option("--exposure", o->exposure, "stops brighter or darker than the scene's own, or auto");
}

void add_budget_options(CLI::App* command, BudgetOptions* o) {
  std::string names;
  for (const SettingRow& row : kSettingList) names += std::string(names.empty() ? "" : ", ") + row.name;
  CLI::Option* budget = command->add_option("--budget-ms", o->ms,
                                            "milliseconds a frame may take: " + names +
                                                " are chosen for it, with the least error, by what frames take; "
                                                "prices are kept per scene and machine (see `bench --front`)");
  budget->check([](const std::string& text) {
    double ms = std::strtod(text.c_str(), nullptr);
    return ms >= kBudgetMsMin && ms <= kBudgetMsMax ? "" : "must lie in 0.001 … 10000000 milliseconds";
  });
  for (const SettingRow& row : kSettingList) budget->excludes(command->get_option(std::string("--") + row.name));
  command->add_option("--front", o->front, "the file of settings to choose from")
      ->default_str("the scene's in the cache")
      ->needs(budget);
}

void add_servers_options(CLI::App* command, ServersOptions* o) {
  const char* group = "Servers frames with render servers";
  command
      ->add_option("--server", o->addresses,
                   "HOST:PORT of a `pocketray serve` that takes a share of every frame; may be given several times")
      ->allow_extra_args(false)
      ->group(group);
  command->add_option("--share", o->device_share, "the device's share of the rows, 0 … 1, instead of the best")
      ->group(group);
  command
      ->add_option("--verify", o->verify,
                   "pixels that the device renders again in each frame, at random, to check the servers: 0 … 1024; "
                   "default: as many as take 1 % of the time. A server caught with a wrong one is not used any more. N "
                   "pixels find one wrong row of R in a frame with the probability 1 - (1 - 1/R)^N or more")
      ->group(group);
  command->add_option("--price", o->price, "what 10^6 bytes from a server cost, in any unit")->group(group);
  command->add_option("--energy-pixel", o->energy_pixel, "what rendering a pixel costs the device, in that unit")
      ->group(group);
  command->add_option("--energy-byte", o->energy_byte, "what receiving a byte costs the device, in that unit")
      ->group(group);
  command->add_option("--cost-weight", o->cost_weight_ms, "milliseconds that a unit of cost is worth: weigh both")
      ->group(group);
  command->add_option("--cost-cap", o->cost_cap, "cost that a frame may have: the fastest that keeps to it")
      ->group(group);
}

void add_side_by_side_option(CLI::App* command, SideBySideOptions* o) {
  command
      ->add_option("--side-by-side", o->reference,
                   "show the reference on the right half, model (the lighting model at its limit) or physical (all "
                   "transport), refined for as long as nothing moves; time stands still meanwhile")
      ->check(CLI::IsMember({"model", "physical"}));
}

}  // namespace pocketray
