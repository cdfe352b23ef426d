#include "app/options.h"

#include <cstdlib>

#include "accel/accel_list.h"
#include "app/measured_prices.h"
#include "plan/quality_level.h"
#include "scene/builtin/builtin.h"

namespace pocketray {
namespace {

std::string scene_help() {
  std::vector<std::string> names;
  int count;
  const BuiltinScene* list = builtin_list(&count);
  for (int i = 0; i < count; ++i) names.push_back(list[i].name);
  std::string text;
  for (const std::string& name : names) text += name + ", ";
#ifdef POCKETRAY_HAVE_IMPORT
  return text + "a .pray file, or a model (glTF, OBJ, PLY, STL, …)";
#else
  return text + "or a .pray file";
#endif
}

std::vector<std::string> device_names() {
  std::vector<std::string> names;
  for (const platform::Device& device : platform::kDevices) names.push_back(device.name);
  return names;
}

std::string all_device_names() {
  std::string text;
  for (const std::string& name : device_names()) text += (text.empty() ? "" : ", ") + name;
  return "Devices: " + text + ".";
}

Option declare_setting(Command command, const SettingRow& row, SettingOption* option) {
  const std::string name = std::string("--") + row.name;
  if (row.field.kind == SettingKind::choice)
    return command.add_option(name + " NAME", option->choice, row.what)
        .one_of({row.field.names, row.field.names + row.field.name_count});
  const LimitRow& limit = limit_of(row.field.quantity);
  if (row.field.kind == SettingKind::count)
    return command.add_option(name + " N", option->count, row.what).range(limit.low, limit.high);
  return command.add_option(name + " X", option->real, row.what).range(limit.low, limit.high);
}

void add_setting_option(Command command, const SettingRow& row, SettingOption* option) {
  Option declared = declare_setting(command, row, option)
                        .capture_default_str()
                        .details(row.note)
                        .price(measured_price(std::string("--") + row.name));
  option->given = [declared] { return declared.count() > 0; };
}

void add_quality(Command command, CommonOptions* o) {
  command.chapter("Speed and accuracy");
  command.add_option("--quality LEVEL", o->quality, "accuracy")
      .one_of({kQualityLevelNames, kQualityLevelNames + kQualityLevelCount})
      .default_str("medium")
      .details(
          "The dial between speed and accuracy. Levels are points of the scene's front if `pocketray accuracy` "
          "measured it, and otherwise built in; "
          "`pocketray plan SCENE` shows what each means. Single settings, given besides, change it.")
      .price(measured_price("--quality"));
}

void add_scene(Command command, CommonOptions* o, bool required) {
  Option scene = command.add_option("SCENE", o->scene, scene_help());
  if (required) scene.required();
  command.chapter("Picture");
  command.add_option("--size WxH", o->size, "picture size in pixels").default_str("320x240, or the device's");
}

void add_effects(Command command, CommonOptions* o) {
  command.add_option("--effects LIST", o->effects, "effects to simulate: auto, all, or names")
      .capture_default_str()
      .details(
          "auto simulates what the scene calls for; \"auto,-shadow\" leaves one out, \"shadow,texture\" has no others. "
          "`pocketray plan SCENE` lists all.");
}

void add_threads(Command command, CommonOptions* o) {
  command.add_option("--threads N", o->threads, "threads that trace; 0: one per core")
      .range(0, kThreadCountMax)
      .capture_default_str();
}

void add_camera(Command command, CommonOptions* o) {
  command.chapter("Camera");
  command.add_option("--camera CAMERA", o->camera, "\"ex,ey,ez tx,ty,tz ux,uy,uz VFOV\"")
      .default_str("the scene's")
      .details(
          "Eye, target, up vector, and the vertical field of view in degrees, 0.001 … 179. Example: "
          "\"0,1,4 0,1,0 0,1,0 40\".");
  command.add_option("--camera-index N", o->camera_index, "which of the scene's cameras, from 0")
      .range(0, kCameraCountMax - 1)
      .capture_default_str();
}

void add_exposure(Command command, CommonOptions* o) {
  command.add_option("--exposure STOPS", o->exposure, "brightness in stops, auto or fixed")
      .default_str("the scene's")
      .details(
          "-60 … 60 stops, added to the scene's exposure, which is measured for imported models with lights. auto "
          "measures it always; fixed or fixed,STOPS never: radiance 1 is white.");
  command.add_option("--tone NAME", o->tone, "how light too bright for the display is shown")
      .one_of({kToneNames[0], kToneNames[1]})
      .capture_default_str()
      .details(
          "clip: each of red, green and blue ends at white. film: light above .8 of white fades to white, by the curve "
          "of Khronos PBR Neutral.");
}

void add_memory_and_devices(Command command, CommonOptions* o) {
  command.chapter("Memory and devices");
  command.add_option("--memory SIZE", o->memory, "size of the one memory block")
      .default_str(std::to_string(kMemoryUsual >> 20) + "M, or the device's")
      .details(
          "It holds everything. Bytes, or K, M or G of them (24M, 24MB and 24MiB are equal), 64K … 64G. A system with "
          "less free memory has "
          "a "
          "smaller default.");
  command.add_option("--texture-max N", o->texture_side_max, "leave out levels of textures with more texels a side")
      .range(1, kTextureSideMax)
      .default_str("what fits in --memory")
      .details("Textures without smaller levels stay. Models are read with at most " +
               std::to_string(kTextureSideUsual) + " texels a side; `pocketray bake --texture-max` stores more.");
  command.add_option("--device NAME", o->device, "use a device's memory size and, in view, its buttons")
      .details(all_device_names());
  command.add_option("--emulate NAME", o->emulate, "imitate a device's speed, memory, cores and screen")
      .details(all_device_names() + " Speeds are listed with their sources in platform/devices/README.md.");
  add_threads(command, o);
  add_isa_option(command, &o->isa);
  std::vector<std::string> accels = {"auto"};
  std::string known, automatic;
  for (const AccelInfo* info : kAccelList) {
    accels.push_back(info->name);
    if (*info->help) known += std::string(info->name) + ": " + info->help + ". ";
    if (info->is_automatic)
      automatic += std::string(automatic.empty() ? ", else " : ", or if that does not fit, ") + info->name;
  }
  command.add_option("--accel NAME", o->accel, "accelerator")
      .one_of(accels)
      .capture_default_str()
      .details("The structure that finds what rays hit. " + known + "auto: the one the scene was baked with" +
               automatic + ".");
}

}  // namespace

Option add_json_option(Command command, std::string* path) {
  command.chapter("Output");
  return command.add_option("--json FILE", *path, "also write the results as JSON; -: standard output");
}

Option add_isa_option(Command command, std::string* isa) {
  return command.add_option("--isa NAME", *isa, "instruction set: baseline, avx2 or avx512")
      .default_str("the CPU's best");
}

void add_scene_options(Command command, CommonOptions* o, bool scene_required) {
  add_scene(command, o, scene_required);
  add_exposure(command, o);
  add_quality(command, o);
  command.chapter("Quality settings");
  for (int i = 0; i < kSettingCount; ++i) add_setting_option(command, kSettingList[i], &o->settings.options[i]);
  add_effects(command, o);
  add_camera(command, o);
  add_animation_option(command, &o->animation);
  add_memory_and_devices(command, o);
  add_reading_options(command, &o->reading);
}

void add_view_options(Command command, CommonOptions* o) {
  add_scene(command, o, true);
  add_exposure(command, o);
  add_effects(command, o);
  add_threads(command, o);
  add_camera(command, o);
  add_reading_options(command, &o->reading);
}

void add_reading_options(Command command, ReadingChoice* choice) {
#ifdef POCKETRAY_HAVE_IMPORT
  command.chapter("Models");
  command.add_option("--up AXIS", choice->up, "axis that points up")
      .one_of({"y", "z"})
      .default_str("by format")
      .details("In PLY, STL, OBJ and OFF, which do not tell: z in PLY and STL, y in the others.");
  command.add_option("--glass KIND", choice->glass, "glass for which a glTF file has no volume")
      .one_of({"auto", "thin", "solid"})
      .default_str("auto")
      .details("auto: solid where its mesh is closed and holds no light or opaque object, otherwise a thin sheet.");
  command.add_flag("--strict", choice->strict,
                   "refuse vertices that are not finite; otherwise their faces are left out");
  command
      .add_option("--model-root DIR", choice->root,
                  "folder that must contain the model and all files it refers to, even by ../")
      .default_str("the model's folder");
#else
  (void)command, (void)choice;
#endif
}

void add_animation_option(Command command, std::string* name) {
  command.chapter("Animation");
  command.add_option("--animation NAME", *name, "which animation plays: name, number, all or none")
      .default_str("all")
      .details("`pocketray plan SCENE` lists names and numbers. all plays those that drive different things.");
}

Option add_environment_option(Command command, std::string* name) {
  command.chapter("Light and background");
  return command.add_option("--environment WHAT", *name, "surrounding light: FILE, sky, studio, none")
      .default_str("the scene's")
      .details(
          "FILE is an equirectangular picture, .hdr, .png or .jpg. sky, or sky:ELEVATION,TURBIDITY, is a clear sky "
          "with "
          "a sun 0 … 90 degrees high (45) and haze 2 … 10 (3). studio lights models without light of their own, where "
          "it matters.");
}

void add_look_options(Command command, CommonOptions* o, std::initializer_list<const char*> own_look) {
  Option environment = add_environment_option(command, &o->environment);
  Option background =
      command.add_option("--background COLOUR", o->background, "colour where nothing is hit")
          .default_str("the scene's")
          .details("#rrggbb as displayed without exposure and tone (quote it), or linear radiance as r,g,b.")
          .excludes(environment, "the environment is the background");
  Option light = command.add_option("--light NAME", o->light, "light for a scene that has none")
                     .one_of({"key", "sun", "none"})
                     .capture_default_str()
                     .details(
                         "key: a key and a fill light on the camera's side. sun: one from high above. none: ambient "
                         "light only.");
  for (const char* other : own_look)
    for (Option option : {background, environment, light})
      option.excludes(command.get_option(other), "errors are known for the scene's own light only");
  command.chapter("Camera");
  command.add_option("--fov DEGREES", o->fov, "vertical field of view, 0.001 … 179")
      .default_str("the camera's")
      .details("For the scene's cameras; the automatic camera moves so that it still frames the scene.")
      .excludes(command.get_option("--camera"), "--camera states its own field of view");
#ifdef POCKETRAY_HAVE_IMPORT
  command.add_option("--focus NAME", o->focus, "fill the picture with one part of the model")
      .default_str("all of it")
      .details("A node, object or group, seen from the same side; --orbit and --turntable circle it.")
      .excludes(command.get_option("--camera"), "--camera states what it looks at");
#endif
}

void add_coherence_options(Command command, CommonOptions* o, const char* usual) {
  o->coherence = usual;
  command.chapter("Animation");
  command.add_option("--coherence WHEN", o->coherence, "trace only what may have changed since the last frame")
      .one_of({"off", "auto", "on"})
      .capture_default_str()
      .details("The pictures stay equal, bit for bit. auto does so if it pays off and memory allows it.");
  command
      .add_option("--coherence-table N", o->coherence_table,
                  "blocks of pixels, NxN, for which rays behind mirrors and glass are kept")
      .range(1, kCoherenceTableSideMax)
      .capture_default_str()
      .details("More blocks take more memory and save rays.");
}

void add_budget_options(Command command, BudgetOptions* o) {
  command.chapter("Speed and accuracy");
  std::string names;
  for (const SettingRow& row : kSettingList) names += std::string(names.empty() ? "" : ", ") + row.name;
  Option budget = command.add_option("--budget-ms MS", o->ms, "best settings that keep a frame within MS milliseconds")
                      .range(kBudgetMsMin, kBudgetMsMax)
                      .details("Chooses " + names +
                               ", and follows measured frame times. Prices are kept per scene and machine; see "
                               "`pocketray bench --front`.")
                      .price(measured_price("--budget-ms"));
  Option flip =
      command.add_option("--flip-max X", o->flip_max, "the fastest settings with a mean ꟻLIP of at most X")
          .range(0, 1)
          .details(
              "Above 0. Errors are those that `pocketray accuracy` measured for the scene: .01 is hard to see, "
              ".05 seen at once, .2 another picture. With --budget-ms, the best of these in that time.")
          .check([](const std::string& text) {
            return std::strtod(text.c_str(), nullptr) > 0 ? "" : "must be above 0 and at most 1";
          });
  const std::pair<Option, const char*> choosers[] = {{budget, "--budget-ms"}, {flip, "--flip-max"}};
  for (auto [option, name] : choosers) {
    const std::string because = std::string(name) + " chooses the settings";
    for (const SettingRow& row : kSettingList)
      option.excludes(command.get_option(std::string("--") + row.name), because);
    option.excludes(command.get_option("--quality"), because);
  }
  command.add_option("--front FILE", o->front, "file of the settings to choose from")
      .default_str("the scene's, in the cache");
}

void add_side_by_side_option(Command command, SideBySideOptions* o) {
  command.chapter("Viewer");
  command.add_option("--side-by-side REFERENCE", o->reference, "show the reference on the right half")
      .one_of({"model", "physical"})
      .details(
          "model: the lighting model, converged. physical: full light transport. It is refined while nothing moves; "
          "the "
          "animation stands still meanwhile.");
}

}  // namespace pocketray
