#include "app/options.h"

#include <cstdlib>

#include "accel/accel_list.h"
#include "engine/light_map.h"
#include "plan/quality_level.h"
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

Option declare_setting(Command command, const SettingRow& row, SettingOption* option) {
  char range[128];
  describe_range(row, range, sizeof range);
  std::string name = std::string("--") + row.name;
  std::string help = row.what + std::string(row.field.kind == SettingKind::choice ? ": " : ", ") + range;
  if (*row.note) help += std::string("; ") + row.note;
  if (row.field.kind == SettingKind::count) return command.add_option(name, option->count, help);
  if (row.field.kind == SettingKind::real) return command.add_option(name, option->real, help);
  return command.add_option(name, option->choice, help);
}

Option add_setting_option(Command command, const SettingRow& row, SettingOption* option) {
  const Option declared = declare_setting(command, row, option);
  option->given = [declared] { return declared.count() > 0; };
  return declared;
}

void add_quality(Command command, CommonOptions* o) {
  std::string names;
  for (const char* name : kQualityLevelNames) names += std::string(names.empty() ? "" : ", ") + name;
  command
      .add_option(
          "--quality", o->quality,
          "the dial between speed and accuracy: " + names +
              "; of the scene's front if `pocketray accuracy` measured it, otherwise built in. `pocketray plan` "
              "shows what each level means. The single settings below change it")
      .default_str("medium");
}

void add_scene(Command command, CommonOptions* o, bool required) {
  auto scene = command.add_option("SCENE", o->scene, scene_help());
  if (required) scene.required();
  command.add_option("--size", o->size, "picture size, WIDTHxHEIGHT in pixels")
      .default_str("320x240, or the emulated device's");
}

void add_effects(Command command, CommonOptions* o) {
  command
      .add_option("--effects", o->effects,
                  "effects to simulate: auto (those the scene needs), all, or names; \"auto,-shadow\" switches one off")
      .capture_default_str();
}

void add_threads(Command command, CommonOptions* o) {
  command.add_option("--threads", o->threads, "tracing threads; 0: one per core").capture_default_str();
}

void add_camera(Command command, CommonOptions* o) {
  command.add_option("--camera", o->camera,
                     "\"ex,ey,ez tx,ty,tz ux,uy,uz VFOV\": eye, target, up vector, vertical field of view in degrees");
  command.add_option("--camera-index", o->camera_index, "index of the scene's camera to use, counted from 0")
      .capture_default_str();
  command.add_option(
      "--exposure", o->exposure,
      "stops to add to the scene's exposure, which is measured if an imported model has lights; auto: always "
      "measured; fixed or fixed,STOPS: never, radiance 1 is white");
}

}  // namespace

Option add_json_option(Command command, std::string* path) {
  return command.add_option("--json", *path, "also write the results as JSON to FILE, or - for standard output");
}

Option add_isa_option(Command command, std::string* isa) {
  return command.add_option("--isa", *isa, "instruction set for tracing: baseline, avx2 or avx512")
      .default_str("the best on this CPU");
}

Option add_server_option(Command command, std::vector<std::string>* addresses) {
  return command.add_option("--server", *addresses, "HOST:PORT of a `pocketray serve`; repeat it for several servers")
      .allow_extra_args(false);
}

Option add_key_option(Command command, std::string* path) {
  return command.add_option("--key", *path,
                            "encrypt the links and accept only peers that have the key in FILE, made by `pocketray "
                            "keygen` and equal on both sides; its mode must be 0600");
}

void add_scene_options(Command command, CommonOptions* o, bool scene_required) {
  add_scene(command, o, scene_required);
  add_quality(command, o);
  for (int i = 0; i < kSettingCount; ++i)
    add_setting_option(command, kSettingList[i], &o->settings.options[i]).capture_default_str();
  add_effects(command, o);
  command.add_option("--memory", o->memory, "size of the one memory block that holds everything, e.g. 24M")
      .default_str("64M, or the device's; less if the system has less");
  command.add_option("--device", o->device,
                     "use a device's memory size and, in view, its rotation and buttons: " + device_names());
  command.add_option("--emulate", o->emulate,
                     "run at a device's speed, with its memory, cores and screen size; names as for --device");
  add_threads(command, o);
  add_isa_option(command, &o->isa);
  std::vector<std::string> accels = {"auto"};
  std::string known, automatic;
  for (const AccelInfo* info : kAccelList) {
    accels.push_back(info->name);
    known +=
        std::string(known.empty() ? "" : ", ") + info->name + (*info->help ? std::string(" (") + info->help + ")" : "");
    if (info->is_automatic)
      automatic += std::string(automatic.empty() ? ", else " : ", or if that does not fit, ") + info->name;
  }
  command
      .add_option("--accel", o->accel,
                  "ray-tracing accelerator: " + known + ", or auto: the one the scene was baked with" + automatic)
      .one_of(accels)
      .capture_default_str();
  add_camera(command, o);
  add_animation_option(command, &o->animation);
  add_reading_options(command, &o->reading);
}

void add_view_options(Command command, CommonOptions* o) {
  add_scene(command, o, true);
  add_effects(command, o);
  add_threads(command, o);
  add_camera(command, o);
  add_reading_options(command, &o->reading);
}

void add_reading_options(Command command, ReadingChoice* choice) {
#ifdef POCKETRAY_HAVE_IMPORT
  command.add_option("--up", choice->up, "the axis that points up in a PLY, STL, OBJ or OFF model: y or z")
      .one_of({"y", "z"})
      .default_str("z for PLY and STL, y for the others");
  command.add_flag("--strict", choice->strict,
                   "refuse a model with vertices that are not finite instead of leaving out their faces");
  command
      .add_option("--model-root", choice->root,
                  "folder that must contain the model and all files it refers to, even by ../")
      .default_str("the model's folder");
#else
  (void)command, (void)choice;
#endif
}

void add_animation_option(Command command, std::string* name) {
  command
      .add_option("--animation", *name,
                  "the animation to play: its name or number as listed by `plan`, all (those that drive "
                  "different things) or none")
      .default_str("all");
}

Option add_environment_option(Command command, std::string* name) {
  return command.add_option(
      "--environment", *name,
      "light from all directions: an equirectangular picture (.hdr, .png, .jpg); sky or sky:ELEVATION,TURBIDITY, a "
      "clear sky with a sun 0 … 90 degrees high (45) and haze 2 … 10 (3); studio, the default of models without light "
      "where it matters; or none");
}

void add_look_options(Command command, CommonOptions* o, std::initializer_list<const char*> own_look) {
  Option background =
      command
          .add_option("--background", o->background,
                      "colour where nothing is hit: #rrggbb as displayed without exposure (quote it), or linear "
                      "radiance as r,g,b")
          .default_str("the scene's");
  Option environment = add_environment_option(command, &o->environment).default_str("the scene's").excludes(background);
  Option light =
      command
          .add_option("--light", o->light,
                      "light for a scene that has none: key (a key and a fill light that follow the camera's side), "
                      "sun (one from high above) or none (ambient light only)")
          .one_of({"key", "sun", "none"})
          .capture_default_str();
  for (const char* other : own_look)
    for (Option option : {background, environment, light}) option.excludes(command.get_option(other));
  command
      .add_option("--fov", o->fov,
                  "vertical field of view in degrees, 0.001 … 179, of the scene's cameras; the automatic camera still "
                  "frames the scene")
      .default_str("the camera's")
      .excludes(command.get_option("--camera"));
#ifdef POCKETRAY_HAVE_IMPORT
  command
      .add_option("--focus", o->focus,
                  "node, object or group of the model that fills the picture, seen from the same side; --orbit and "
                  "--turntable circle it")
      .default_str("the whole scene")
      .excludes(command.get_option("--camera"));
#endif
}

void add_coherence_options(Command command, CommonOptions* o, const char* usual) {
  o->coherence = usual;
  command
      .add_option("--coherence", o->coherence,
                  "trace only what may have changed since the last frame; the pictures stay the same: on, off, or "
                  "auto, if it pays off")
      .capture_default_str();
  command
      .add_option("--coherence-table", o->coherence_table,
                  "N: rays behind mirrors and glass are kept in tables of NxN blocks of pixels; more blocks take "
                  "more memory and save rays")
      .capture_default_str();
}

void add_budget_options(Command command, BudgetOptions* o) {
  std::string names;
  for (const SettingRow& row : kSettingList) names += std::string(names.empty() ? "" : ", ") + row.name;
  Option budget = command.add_option("--budget-ms", o->ms,
                                     "frame time to aim for in milliseconds: chooses " + names +
                                         " for the least error, adapting to measured frame times; prices are "
                                         "saved per scene and machine (see `bench --front`)");
  budget.check([](const std::string& text) {
    double ms = std::strtod(text.c_str(), nullptr);
    return ms >= kBudgetMsMin && ms <= kBudgetMsMax ? "" : "must lie in 0.001 … 10000000 milliseconds";
  });
  Option flip = command.add_option("--flip-max", o->flip_max,
                                   "maximum mean ꟻLIP, as measured by `pocketray accuracy` for the scene: chooses the "
                                   "fastest settings within it or, with --budget-ms, the best ones");
  flip.check([](const std::string& text) {
    const double flip_max = std::strtod(text.c_str(), nullptr);
    return flip_max > 0 && flip_max <= 1 ? "" : "must be above 0 and at most 1";
  });
  for (const SettingRow& row : kSettingList)
    for (Option* option : {&budget, &flip}) option->excludes(command.get_option(std::string("--") + row.name));
  for (Option* option : {&budget, &flip}) option->excludes(command.get_option("--quality"));
  command.add_option("--front", o->front, "file of settings to choose from")
      .default_str("the scene's file in the cache");
}

void add_servers_options(Command command, ServersOptions* o) {
  const char* group = "Render servers";
  add_server_option(command, &o->addresses).group(group);
  add_key_option(command, &o->key).group(group);
  command.add_option("--share", o->device_share, "the device's share of the rows, 0 … 1, instead of the fastest")
      .group(group);
  command
      .add_option("--verify", o->verify,
                  "random pixels per frame that the device renders itself to spot-check the servers, 0 … 1024; "
                  "default: as many as 1 % of the time allows. A server caught with a wrong pixel is dropped. N "
                  "pixels catch one wrong row of R in a frame with a probability of at least 1 - (1 - 1/R)^N")
      .group(group);
  command
      .add_flag("--near-lossless", o->near_lossless,
                "let servers send pixels whose channels may be off by one level of their format, for about half of the "
                "bytes; otherwise every pixel is exact")
      .group(group);
  command
      .add_option(
          "--split", o->split,
          "how to share a frame: rows: servers render some rows, exactly as the device would; effect: the device "
          "renders every pixel without --indirect, a server that light at fewer pixels; auto: whichever is faster, or "
          "both: servers render whole rows, the device the others without --indirect")
      .one_of({"rows", "effect", "auto"})
      .default_str("rows")
      .group(group);
  command
      .add_option(
          "--light-every", o->light_every,
          "with --split: number of frames of a moving view that use one map of a server's light, 1 … 60; 4 take a "
          "quarter of its bytes")
      .range(1u, kLightEveryMax)
      .capture_default_str()
      .group(group);
  command.add_option("--price", o->price, "price of 10^6 bytes from a server, in any unit").group(group);
  command.add_option("--energy-pixel", o->energy_pixel, "cost of rendering a pixel on the device, in that unit")
      .group(group);
  command.add_option("--energy-byte", o->energy_byte, "cost of receiving a byte on the device, in that unit")
      .group(group);
  command
      .add_option("--cost-weight", o->cost_weight_ms,
                  "milliseconds that a unit of cost is worth: minimises time plus weighted cost")
      .group(group);
  command.add_option("--cost-cap", o->cost_cap, "largest cost per frame: takes the fastest split within it")
      .group(group);
}

void add_side_by_side_option(Command command, SideBySideOptions* o) {
  command
      .add_option("--side-by-side", o->reference,
                  "show the reference on the right half: model (the same lighting model, converged) or physical (full "
                  "light transport). It is refined while nothing moves; animation is paused while it is")
      .one_of({"model", "physical"});
}

}  // namespace pocketray
