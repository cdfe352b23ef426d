// pocketray bake: converts a model into one .pray file, accelerator included, which a device loads as it is.
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "app/commands.h"
#include "app/options.h"
#include "platform/file.h"
#include "scene/baked.h"
#include "session/animation_choice.h"
#include "session/compress.h"
#include "session/environment.h"
#include "session/heap_scene.h"
#include "session/interrupt.h"
#include "session/measured_view.h"
#include "session/note.h"
#include "session/output.h"
#include "session/radiosity.h"
#include "session/report.h"
#include "session/room_light.h"

namespace pocketray {
namespace {

struct BakeOptions {
  std::string input, output, json, environment, animation, accel = kBvhAccel.name, textures = "exact";
  ModelOptions model;
  bool radiosity = false, no_radiosity = false, no_mip_maps = false;
  std::uint32_t patch_count = 0;  // of radiosity; 0: the default
};

Status write_scene(const std::string& path, const Scene& scene, std::size_t* byte_count) {
  std::vector<std::uint8_t> bytes(baked_size(scene));
  baked_write(scene, bytes.data());
  *byte_count = bytes.size();
  return write_encoded(path.c_str(), [&](const ByteSink& sink) {
    sink.write(sink.user, bytes.data(), bytes.size());
    return success();
  });
}

// Refuses bad paths before any work. Devices, pipes and standard output may have any name.
Status check(const BakeOptions& o) {
  if (!platform::is_device_or_pipe(o.output.c_str()) && !has_suffix(o.output.c_str(), ".pray"))
    return failure("-o is '%.300s': the name must end in .pray", o.output.c_str());
  if (o.patch_count > 0 && !o.radiosity) return failure("--patches applies to --radiosity: add it");
  return check_outputs({{"IN", o.input}}, {{"-o", o.output}, {"--json", o.json}});
}

// Prints a row for each compressed texture, if requested, and returns the rows.
nlohmann::json report_textures(const CompressedTextures& compressed, bool prints) {
  nlohmann::json rows = nlohmann::json::array();
  for (const CompressedTexture& row : compressed.report) {
    const bool is_exact = std::isinf(row.psnr);
    char error[32] = "without error";
    if (!is_exact) std::snprintf(error, sizeof error, "PSNR %.1f dB", row.psnr);
    if (prints)
      std::printf("texture %u, %u×%u: %s, %s\n", row.texture, row.width, row.height, describe_format(row.format),
                  error);
    rows.push_back({{"texture", row.texture},
                    {"format", describe_format(row.format)},
                    {"psnr_db", is_exact ? nlohmann::json() : nlohmann::json(row.psnr)}});
  }
  return rows;
}

// Removes all animations except the requested one.
Status keep_animation(const std::string& asked, Scene* scene) {
  std::uint32_t index;
  RETURN_IF_ERROR(find_animation(*scene, asked, &index));
  if (asked.empty() || asked == kAllAnimations) return success();
  static constexpr Animation kStill = {0, 0, 0};
  if (index == kNone && scene->animations.count) scene->animations = {&kStill, 1}, scene->animation_labels = {};
  if (index == kNone) return success();
  scene->animations = {&scene->animations[index], 1};
  if (scene->animation_labels.count) scene->animation_labels = {&scene->animation_labels[index], 1};
  return success();
}

// Solves radiosity if it is asked for, and for rooms unless it is too much.
Status light(const BakeOptions& o, Scene* scene, SolvedRadiosity* solved, bool* too_much) {
  const std::uint32_t threads = std::thread::hardware_concurrency();
  if (o.no_radiosity) {
    drop_radiosity(scene);
    return success();
  }
  if (o.radiosity) return solve_scene(o.input, {threads, o.patch_count}, scene, solved);
  if (!calls_for_radiosity(*scene)) return success();
  RadiosityFit fit;
  if (!fit_radiosity(threads, *scene, kBakeLimit, &fit).ok) return success();
  *too_much = fit.patch_count == 0;
  return *too_much ? success() : solve_scene(o.input, {threads, fit.patch_count}, scene, solved);
}

Status bake(const BakeOptions& o) {
  RETURN_IF_ERROR(check(o));
  if (o.output == "-") RETURN_IF_ERROR(keep_output_for_data());
  std::uint64_t start = clock_ns();
  HeapScene heap;
  ModelOptions model = o.model;
  model.tells_halved = true;
  model.mip_maps = !o.no_mip_maps, model.studio = o.environment.empty();
  model.animations = o.animation != kNoAnimation;
  RETURN_IF_ERROR(read_heap_scene(o.input, model, &heap));
  Scene& scene = heap.scene;
  RETURN_IF_ERROR(keep_animation(o.animation, &scene));
  double read_ms = static_cast<double>(clock_ns() - start) * 1e-6;
  start = clock_ns();
  EnvironmentMemory environment;
  const bool has_studio = scene.environment_info.count > 0;
  if (!o.environment.empty() && o.environment != kNoEnvironment)
    RETURN_IF_ERROR(set_environment(o.environment, &scene, &environment));
  if (!environment.file.empty()) heap.files.push_back(environment.file);
  RETURN_IF_ERROR(check_not_read(heap.files, {{"-o", o.output}, {"--json", o.json}}));
  if (interrupted) return failure("interrupted: nothing is written");
  SolvedRadiosity solved;
  bool too_much = false;
  RETURN_IF_ERROR(light(o, &scene, &solved, &too_much));
  double solve_ms = static_cast<double>(clock_ns() - start) * 1e-6;
  CompressedTextures compressed;
  if (o.textures == "compressed") compress_textures(&scene, &compressed);
  start = clock_ns();
  void* accel_block = build_heap_accel(*find_accel(o.accel), scene, &scene.accel);
  if (!accel_block) return failure("not enough memory to build the accelerator: bake a smaller model");
  double build_ms = static_cast<double>(clock_ns() - start) * 1e-6;
  if (interrupted) {
    give_block_back(accel_block);
    return failure("interrupted: nothing is written");
  }
  MeasuredView view;
  if (needs_view(scene) && (scene.framings.empty() || !o.animation.empty())) measure_view(&scene, &view);
  std::size_t byte_count = 0;
  Status status = write_scene(o.output, scene, &byte_count);
  std::size_t accel_bytes = scene.accel.bytes();
  give_block_back(accel_block);
  RETURN_IF_ERROR(status);
  if (!heap.warning.empty()) print_note(heap.warning);
  if (heap.has_fill)
    print_note("the model has lights but no surroundings: baking a dimmed studio with it; --environment none omits it");
  else if (has_studio)
    print_note("the model has no light: baking a studio with it; --environment none omits it");
  if (o.json != "-")
    std::printf("%s: %s, %s, %s, %.2f MiB (accelerator %.2f MiB), read in %.0f ms, built in %.0f ms\n",
                o.output == "-" ? "standard output" : shown(o.output).c_str(),
                counted(scene.triangles.count, "triangle").c_str(), counted(scene.materials.count, "material").c_str(),
                counted(scene.textures.count, "texture").c_str(), static_cast<double>(byte_count) / (1 << 20),
                static_cast<double>(accel_bytes) / (1 << 20), read_ms, build_ms);
  const bool has_solved = !solved.memory.empty();
  if (too_much) print_note("its radiosity would take more than a minute or 2 MiB: --radiosity stores it nevertheless");
  if (has_solved && o.json != "-")
    std::printf("radiosity: %s, %.2f MiB, solved in %.1f s%s\n", solved.summary.c_str(),
                static_cast<double>(solved.memory.size()) / (1 << 20), solve_ms * 1e-3,
                o.radiosity ? "" : "; --no-radiosity omits it");
  const nlohmann::json texture_rows = report_textures(compressed, o.json != "-");
  if (o.json.empty()) return success();
  return write_json(o.json, {{"output", o.output},
                             {"triangles", scene.triangles.count},
                             {"materials", scene.materials.count},
                             {"textures", scene.textures.count},
                             {"texture_bytes", scene.texels.bytes()},
                             {"environment_bytes", scene.environment_texels.bytes()},
                             {"compressed_textures", texture_rows},
                             {"bytes", byte_count},
                             {"accelerator", o.accel},
                             {"accel_bytes", accel_bytes},
                             {"read_ms", read_ms},
                             {"build_ms", build_ms},
                             {"radiosity_bytes", solved.memory.size()},
                             {"radiosity_ms", has_solved ? solve_ms : 0},
                             {"warning", heap.warning}});
}

int run(const BakeOptions& o) {
  const Status status = bake(o);
  const int exit_status = report(status);
  return status.ok || !interrupted ? exit_status : kExitInterrupted;
}

}  // namespace

void add_bake_command(Command program, int* exit_status) {
  auto options = std::make_shared<BakeOptions>();
  Command command = program.add_subcommand("bake", "convert a model into one .pray file for devices");
  command.add_option("IN", options->input, "a model (glTF, OBJ, PLY, STL, …) or a built-in scene").required();
  command.chapter("Output");
  command.add_option("-o,--output FILE", options->output, "the .pray file to write").required();
  add_json_option(command, &options->json);
  command.chapter("Textures and meshes");
  command.add_option("--texture-max N", options->model.texture_side_max, "halve textures with more texels a side")
      .range(1, kTextureSideMax)
      .capture_default_str();
  command.add_option("--textures HOW", options->textures, "how textures are stored")
      .one_of({"exact", "compressed"})
      .capture_default_str()
      .details("compressed: blocks of 4 to 12 bits a texel instead of 32; their errors are printed.");
  command.add_flag("--no-mip-maps", options->no_mip_maps, "store no smaller levels of textures")
      .details("Textures then take a quarter less memory but sparkle where they appear small.");
  add_environment_option(command, &options->environment);
  command.add_flag("--radiosity", options->radiosity, "store light between surfaces, whatever it takes")
      .details(
          "Lit rooms get it without this, unless it would take more than a minute or 2 MiB. It costs "
          "devices little. The pose is that of time 0.");
  command.add_flag("--no-radiosity", options->no_radiosity, "store no light between surfaces")
      .excludes(command.get_option("--radiosity"), "it asks for radiosity");
  command.add_option("--patches N", options->patch_count, "with --radiosity: patches that exchange light")
      .range(kPatchCountMin, kPatchCountMax)
      .default_str("about 1200")
      .details(
          "A quarter takes a third of the time and bytes and hardly errs more; `pocketray accuracy IN --bake-choices` "
          "measures it.");
  add_animation_option(command, &options->animation);
  add_reading_options(command, &options->model.reading);
  std::vector<std::string> names;
  std::string help;
  for (const AccelInfo* info : kAccelList) {
    if (!info->magic) continue;  // it has no data
    names.push_back(info->name);
    if (*info->help) help += std::string(info->name) + ": " + info->help + ". ";
  }
  command.chapter("Output");
  command.add_option("--accel NAME", options->accel, "structure stored for tracing")
      .one_of(names)
      .capture_default_str()
      .details(help);
  command.everyday("Output", {"--output", "--accel"});
  command.everyday("Light", {"--radiosity", "--no-radiosity", "--environment"});
  command.everyday("Model", {"--up", "--animation"});
  command.everyday("Textures", {"--texture-max", "--textures"});
  command.example("pocketray bake model.glb -o model.pray");
  command.example("pocketray bake cornell -o cornell.pray");
  command.callback([=] { *exit_status = run(*options); });
}

}  // namespace pocketray
