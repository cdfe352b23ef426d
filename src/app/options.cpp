#include "app/options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>
#include <thread>

#include "accel/accel_list.h"
#include "app/interrupt.h"
#include "app/note.h"
#include "base/fmath.h"
#include "base/limit_list.h"
#include "plan/plan_effects.h"
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

Status parse_texture_filter(const std::string& text, TextureFilter* filter) {
  if (text == "scene")
    *filter = TextureFilter::as_scene;
  else if (text == "nearest")
    *filter = TextureFilter::nearest;
  else if (text == "bilinear")
    *filter = TextureFilter::bilinear;
  else
    return failure("--texture-filter is '%s': it must be scene, nearest or bilinear", text.c_str());
  return success();
}

// Reads numbers separated by spaces or commas; false when there are not exactly `count` finite ones.
bool read_numbers(const std::string& text, float* values, int count) {
  const char* at = text.c_str();
  for (int i = 0; i < count; ++i) {
    while (*at == ' ' || *at == ',') ++at;
    char* end;
    values[i] = std::strtof(at, &end);
    if (end == at || !std::isfinite(values[i])) return false;
    at = end;
  }
  while (*at == ' ') ++at;
  return *at == 0;
}

Status set_pace(const CommonOptions& o, Renderer* r) {
  const platform::Device* device;
  RETURN_IF_ERROR(find_device(o, &device));
  if (o.emulate.empty()) return success();
  r->pace.slowdown = device->slowdown;
  r->pace.device = device->name;
  r->pace.stop = &interrupted;
  return success();
}

}  // namespace

Status read_settings(const CommonOptions& o, Settings* s) {
  RETURN_IF_ERROR(picture_size(o, &s->width, &s->height));
  const platform::Device* device;
  RETURN_IF_ERROR(find_device(o, &device));
  if (device) s->memory_bytes = device->memory_bytes;
  if (!o.memory.empty()) RETURN_IF_ERROR(parse_bytes(o.memory, &s->memory_bytes));
  RETURN_IF_ERROR(parse_effects(o.effects.c_str(), s));
  RETURN_IF_ERROR(parse_texture_filter(o.texture_filter, &s->texture_filter));
  if (o.normals != "scene" && o.normals != "flat")
    return failure("--normals is '%s': it must be scene or flat", o.normals.c_str());
  s->normals = o.normals == "flat" ? NormalMode::flat : NormalMode::as_scene;
  s->samples_per_pixel = o.samples;
  s->ray_depth = o.depth;
  s->points_per_area_light = o.area_lights;
  s->cut_off_levels = o.cut_off;
  // By the names that were typed; validate_settings() tests the same limits, by the names that a library's user knows.
  const struct {
    Quantity quantity;
    double value;
    const char* option;
  } kOptions[] = {
      {Quantity::width, double(s->width), "the width of --size"},
      {Quantity::height, double(s->height), "the height of --size"},
      {Quantity::samples, double(o.samples), "--samples"},
      {Quantity::depth, double(o.depth), "--depth"},
      {Quantity::area_light_points, double(o.area_lights), "--area-lights"},
      {Quantity::cut_off, double(o.cut_off), "--cut-off"},
      {Quantity::camera_index, double(o.camera_index), "--camera-index"},
  };
  for (const auto& row : kOptions) RETURN_IF_ERROR(check_limit(row.quantity, row.value, row.option));
  bool measured;
  float factor;
  RETURN_IF_ERROR(parse_exposure(o.exposure, &measured, &factor));  // also of commands that show nothing
  if (o.threads > kThreadCountMax) return failure("--threads is %u: it must lie in 0 … %u", o.threads, kThreadCountMax);
  unsigned cores = std::thread::hardware_concurrency();
  if (!o.emulate.empty() && device->core_count > 0) cores = static_cast<unsigned>(device->core_count);
  s->threads = choose_thread_count(o.threads, cores);
  return validate_settings(*s);
}

Status find_device(const CommonOptions& o, const platform::Device** device) {
  *device = nullptr;
  if (!o.emulate.empty() && !o.device.empty() && o.emulate != o.device)
    return failure("--emulate is '%s' and --device '%s': name one of them", o.emulate.c_str(), o.device.c_str());
  const std::string& name = o.emulate.empty() ? o.device : o.emulate;
  if (name.empty()) return success();
  *device = platform::find_device(name.c_str());
  if (*device) return success();
  std::string names;
  for (const platform::Device& d : platform::kDevices) names += std::string(names.empty() ? "" : ", ") + d.name;
  return failure("--%s is '%s': it must be one of %s", o.emulate.empty() ? "device" : "emulate", name.c_str(),
                 names.c_str());
}

Status picture_size(const CommonOptions& o, std::uint32_t* width, std::uint32_t* height) {
  const platform::Device* device;
  RETURN_IF_ERROR(find_device(o, &device));
  *width = 320;
  *height = 240;
  if (!o.size.empty()) return parse_size(o.size, width, height);
  if (o.emulate.empty()) return success();
  bool turned = device->rotation % 180 != 0;
  *width = static_cast<std::uint32_t>(turned ? device->screen_height : device->screen_width);
  *height = static_cast<std::uint32_t>(turned ? device->screen_width : device->screen_height);
  return success();
}

std::uint32_t choose_thread_count(std::uint32_t asked, unsigned core_count) {
  if (asked > 0) return asked;
  return core_count < 1 ? 1 : core_count > kThreadCountMax ? kThreadCountMax : core_count;
}

Status parse_isa(const std::string& text, Isa* isa) {
  *isa = best_isa();
  if (text.empty()) return success();
  std::string names;
  for (int i = 0; i <= static_cast<int>(best_isa()); ++i) {
    *isa = static_cast<Isa>(i);
    if (text == isa_name(*isa)) return success();
    names += std::string(i ? ", " : "") + isa_name(*isa);
  }
  return failure("--isa is '%s': this CPU has %s", text.c_str(), names.c_str());
}

Status parse_size(const std::string& text, std::uint32_t* width, std::uint32_t* height) {
  int used = 0;
  if (text.find_first_not_of("0123456789x") != std::string::npos ||  // a sign would wrap around
      std::sscanf(text.c_str(), "%5ux%5u%n", width, height, &used) != 2 ||
      static_cast<std::size_t>(used) != text.size())
    return failure("--size is '%s': write it as 320x240", text.c_str());
  return success();
}

Status parse_bytes(const std::string& text, std::size_t* bytes, const char* option) {
  char* end;
  double value = std::strtod(text.c_str(), &end);
  double unit = *end == 'K' || *end == 'k'   ? 1 << 10
                : *end == 'M' || *end == 'm' ? 1 << 20
                : *end == 'G' || *end == 'g' ? 1 << 30
                                             : 1;
  if (unit > 1) ++end;
  if (end == text.c_str() || *end || !(value * unit >= kMemoryBytesMin) || !(value * unit <= kMemoryBytesMax))
    return failure("%s is '%s': write it as 24M (64K … %s)", option, text.c_str(),
                   sizeof(void*) == 4 ? "2047M" : "64G");
  *bytes = static_cast<std::size_t>(value * unit);
  return success();
}

Status parse_camera(const std::string& text, Camera* camera) {
  float v[10];
  if (!read_numbers(text, v, 10))
    return failure("--camera is '%s': write it as \"ex,ey,ez tx,ty,tz ux,uy,uz VFOV\", the field of view in degrees",
                   text.c_str());
  for (int i = 0; i < 9; ++i)
    RETURN_IF_ERROR(check_limit(Quantity::coordinate, static_cast<double>(v[i]), "a coordinate of --camera"));
  *camera = Camera();
  camera->eye = {v[0], v[1], v[2]};
  camera->target = {v[3], v[4], v[5]};
  camera->up = {v[6], v[7], v[8]};
  camera->vertical_fov = static_cast<float>(radians(v[9]));
  if (!within(Quantity::field_of_view, camera->vertical_fov))
    return failure("the field of view of --camera is %g degrees: it must lie in 0.001 … 179",
                   static_cast<double>(v[9]));
  return success();
}

Status parse_exposure(const std::string& text, bool* measured, float* factor) {
  float stops = 0;
  *measured = text == "auto";
  if (!*measured && !text.empty() && (!read_numbers(text, &stops, 1) || !(std::fabs(stops) <= kExposureStopsMax)))
    return failure("--exposure is '%s': write stops as 1.5 or -2, -60 … 60, or auto", text.c_str());
  *factor = static_cast<float>(det_exp(static_cast<double>(stops) * 0.693147180559945309));
  return success();
}

Status change_exposure(float factor, float* exposure) {
  *exposure *= factor;
  return check_limit(Quantity::exposure, static_cast<double>(*exposure), "the scene's exposure times --exposure");
}

const AccelInfo* find_accel(const std::string& name) {
  for (const AccelInfo* info : kAccelList)
    if (name == info->name) return info;
  return nullptr;
}

void add_scene_options(CLI::App* command, CommonOptions* o) {
  command->add_option("SCENE", o->scene, scene_help())->required();
  command->add_option("--size", o->size, "picture size in pixels, WIDTHxHEIGHT")
      ->default_str("320x240, or the emulated device's");
  command->add_option("--samples", o->samples, "rays through each pixel, 1 … 16")->capture_default_str();
  command->add_option("--depth", o->depth, "reflections and refractions along a path, 0 … 16")->capture_default_str();
  command->add_option("--area-lights", o->area_lights, "points that each area light is taken as, 1 … 256")
      ->capture_default_str();
  command
      ->add_option("--effects", o->effects,
                   "what to simulate: auto (what the scene calls for), all, or names; \"auto,-shadow\" leaves one out")
      ->capture_default_str();
  command->add_option("--memory", o->memory, "the block everything must fit in, as 24M")
      ->default_str("64M, or the device's");
  command->add_option(
      "--device", o->device,
      "take memory, and in view rotation and buttons, from a handheld's profile: gp2x, miyoo, miyoo-mini, pi-zero, …");
  command->add_option("--emulate", o->emulate,
                      "trace as slowly as a handheld would, with its memory, cores and screen: see --device");
  command->add_option("--threads", o->threads, "threads that trace; 0: one per core")->capture_default_str();
  command->add_option("--isa", o->isa, "instruction set to trace with: baseline, avx2 or avx512")
      ->default_str("the best of this CPU");
  std::vector<std::string> accels = {"auto"};
  for (const AccelInfo* info : kAccelList) accels.push_back(info->name);
  command
      ->add_option(
          "--accel", o->accel,
          "what finds a ray's triangles: bvh, compact (16 bytes a triangle instead of 52, at 0.6 to 0.95 of the "
          "speed), brute (for "
          "comparisons), or auto: what the scene was baked with, else bvh, else compact where that does not fit")
      ->check(CLI::IsMember(accels))
      ->capture_default_str();
  command->add_option("--camera", o->camera,
                      "\"ex,ey,ez tx,ty,tz ux,uy,uz VFOV\": eye, target, up, degrees from top to bottom");
  command->add_option("--camera-index", o->camera_index, "which of the scene's cameras")->capture_default_str();
  command->add_option("--exposure", o->exposure, "stops brighter or darker than the scene's own, or auto");
  command->add_option("--texture-filter", o->texture_filter, "scene, nearest or bilinear")->capture_default_str();
  command->add_option("--normals", o->normals, "scene (smooth where it has normals) or flat")->capture_default_str();
  command
      ->add_option("--cut-off", o->cut_off,
                   "displayed levels that the rays left out of a pixel may be worth together; 0: trace every ray")
      ->capture_default_str();
}

OpenScene::~OpenScene() {
  stop_workers(renderer.workers);
  give_block_back(block);
}

Status open_scene(const CommonOptions& o, const OpenHooks& hooks, OpenScene* opened) {
  Settings settings;
  RETURN_IF_ERROR(read_settings(o, &settings));
  Isa isa;
  RETURN_IF_ERROR(parse_isa(o.isa, &isa));
  select_isa(isa);
  opened->block = take_block(settings.memory_bytes);
  if (!opened->block) return failure("%zu bytes of memory cannot be had: lower --memory", settings.memory_bytes);
  Renderer* r = &opened->renderer;
  start_renderer(opened->block, settings.memory_bytes, settings, r);
  RETURN_IF_ERROR(set_pace(o, r));
  r->camera_index = o.camera_index;
  r->accel_info = find_accel(o.accel);
  SceneStorage storage;
  RETURN_IF_ERROR(hooks.load(o.scene, r, &opened->source, &storage));
  if (hooks.loaded) RETURN_IF_ERROR(hooks.loaded(opened->source, r));
  Status planned = hooks.plan(r, storage, hooks.output_bytes(settings));
  if (!planned.ok && r->memory.total_bytes > r->memory.limit_bytes) opened->source.bytes_wanted = r->memory.total_bytes;
  if (opened->source.bytes_wanted > 0 && !planned.ok)
    return failure("%s: --memory %zuM", planned.message, (opened->source.bytes_wanted >> 20) + 1);
  RETURN_IF_ERROR(planned);
  if (!o.camera.empty()) {
    Camera camera;
    RETURN_IF_ERROR(parse_camera(o.camera, &camera));
    RETURN_IF_ERROR(set_camera(r, camera));
  }
  return success();
}

Status start_scene(OpenScene* opened, const CommonOptions& o) {
  Renderer* r = &opened->renderer;
  r->workers = start_workers(r->settings.threads);
  bool measured;
  float factor;
  RETURN_IF_ERROR(parse_exposure(o.exposure, &measured, &factor));
  if (measured) r->scene.info.auto_exposure = 1;
  RETURN_IF_ERROR(build_renderer(r));
  return change_exposure(factor, &r->exposure);
}

void print_notes(const OpenScene& opened) {
  if (!opened.source.warning.empty()) print_note(opened.source.warning);
  if (opened.renderer.accel_is_fallback)
    std::fprintf(
        stderr,
        "pocketray: the accelerator bvh does not fit --memory: compact takes its place, somewhat slower; a larger "
        "--memory holds bvh\n");
  const SceneInfo& info = opened.renderer.scene.info;
  if (info.default_camera != 0 && info.default_lights != 0)
    std::fprintf(
        stderr,
        "pocketray: the scene has no camera and no light: framed by its bounds, lit by a key and a fill light\n");
  else if (info.default_camera != 0)
    std::fprintf(stderr, "pocketray: the scene has no camera: framed by its bounds\n");
  else if (info.default_lights != 0)
    std::fprintf(stderr, "pocketray: the scene has no light: lit by a key and a fill light\n");
}

}  // namespace pocketray
