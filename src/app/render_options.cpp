#include "app/render_options.h"

#include <cinttypes>
#include <cmath>

#include "base/limit_list.h"
#include "engine/pocketray.h"
#include "plan/resolve.h"
#include "scene/content_hash.h"
#include "session/output.h"
#include "session/resume.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kTurntableMax = 3600;  // a tenth of a degree

Status parse_aov(const std::string& text, Aov* aov) {
  constexpr struct {
    const char* name;
    Aov aov;
  } kNames[] = {{"none", Aov::none},         {"depth", Aov::depth},       {"normal", Aov::normal},
                {"triangle", Aov::triangle}, {"position", Aov::position}, {"cost", Aov::cost}};
  for (const auto& row : kNames)
    if (text == row.name) return *aov = row.aov, success();
  return failure("--aov is '%s': it must be depth, normal, triangle, position or cost", text.c_str());
}

Status parse_raw_format(const std::string& text, PixelFormat* format) {
  const struct {
    const char* name;
    PixelFormat format;
  } kNames[] = {{"rgb565", kRgb565},     {"bgr565", kBgr565}, {"xrgb8888", kXrgb8888},
                {"xbgr8888", kXbgr8888}, {"rgb888", kRgb888}, {"bgr888", kBgr888}};
  for (const auto& row : kNames)
    if (text == row.name) return *format = row.format, success();
  return failure("--raw-format is '%s': it must be rgb565, bgr565, xrgb8888, xbgr8888, rgb888 or bgr888", text.c_str());
}

// "out.png" and 7 → "out-0007.png".
std::string numbered_path(const std::string& path, std::uint32_t number) {
  char digits[16];
  std::snprintf(digits, sizeof digits, "-%04" PRIu32, number);
  std::size_t dot = path.rfind('.');
  return path.substr(0, dot) + digits + path.substr(dot);
}

// `output`: -o as given.
Uses uses_of(const RenderOptions& o, const RenderRequest& request, const char* output) {
  const bool sequence = request.sequence.given, animation = request.animation != AnimationKind::none;
  const bool numbered = sequence && !animation && o.output != "-";
  Uses uses;
  uses.add(Use::servers, !o.servers.addresses.empty());
  add_budget_uses(o.budget, &uses);
  uses.add(Use::ranks, o.parts.team.size > 1);
  uses.add(Use::frames, !o.frames.empty());
  uses.add(Use::turntable, o.turntable > 0);
  uses.add(Use::sequence, sequence);
  uses.add(Use::numbered, numbered);
  uses.add(Use::animation, animation, output);
  uses.add(Use::still, numbered && o.turntable > 0);
  uses.add(Use::output, o.output == "-" && !animation);
  uses.add(Use::orbit, o.orbit_degrees != 0);
  uses.add(Use::frame_rate, o.frames_per_second > 0);
  uses.add(Use::resume, o.resume);
  uses.add(Use::values, stores_values(request.kind));
  uses.add(Use::raw, has_suffix(request.kind.c_str(), ".raw"));
  uses.add(Use::aov, request.aov != Aov::none);
  uses.add(Use::crop, !o.crop.empty());
  uses.add(Use::rotate, o.rotation != 0);
  uses.add(Use::dither, o.dither);
  uses.add(Use::coherence, o.common.coherence == "on");
  return uses;
}

std::vector<NamedFile> inputs_of(const RenderOptions& o) {
  return {{"SCENE", o.common.scene}, {"--front", o.budget.front}, {"--key", o.servers.key}};
}

Status check_path(const RenderOptions& o, const std::string& path, RenderRequest* request) {
  request->paths.push_back(path);
  return check_outputs(inputs_of(o), {{"-o", path}, {"--json", o.common.json}});
}

// Standard output has no suffix: PNG unless --format says otherwise.
Status choose_kind(const RenderOptions& o, RenderRequest* request) {
  request->kind = o.output;
  if (o.output != "-")
    return o.format.empty() ? success()
                            : failure("--format is for -o -: the ending of -o %.200s decides", o.output.c_str());
  request->kind = "-." + (o.format.empty() ? "png" : o.format);
  return keep_output_for_data();
}

// Checks that each picture can be written, before rendering the first.
Status check_paths(const RenderOptions& o, RenderRequest* request) {
  const FrameRange& s = request->sequence;
  if (request->animation != AnimationKind::none) return check_path(o, o.output, request);
  RETURN_IF_ERROR(check_picture_path(request->kind));
  for (std::uint32_t frame = s.first; frame <= s.last; ++frame)
    RETURN_IF_ERROR(check_path(o, s.given ? numbered_path(o.output, frame) : o.output, request));
  return success();
}

// "X,Y,WxH" in pixels.
Status read_crop(const RenderOptions& o, RenderRequest* request) {
  std::uint32_t width, height;
  RETURN_IF_ERROR(picture_size(o.common, &width, &height));
  if (o.crop.empty()) return success();
  int used = 0;
  PixelBox box;
  const bool plain = o.crop.find_first_not_of("0123456789,x") == std::string::npos;  // a sign would wrap around
  if (!plain ||
      std::sscanf(o.crop.c_str(), "%6d,%6d,%6dx%6d%n", &box.left, &box.top, &box.width, &box.height, &used) != 4 ||
      static_cast<std::size_t>(used) != o.crop.size() || box.width < 1 || box.height < 1 ||
      box.left + box.width > static_cast<int>(width) || box.top + box.height > static_cast<int>(height))
    return failure("--crop is '%.100s': write X,Y,WxH, as 0,0,%ux%u, within the picture's %ux%u pixels", o.crop.c_str(),
                   (width + 1) / 2, (height + 1) / 2, width, height);
  request->picture.crop = box;
  return success();
}

Status check_journal(const RenderOptions& o, const RenderRequest& request) {
  if (!keeps_journal(o, request)) return success();
  return check_outputs(inputs_of(o), {{"-o", journal_path(o.output)}, {"--json", o.common.json}});
}

Status check_frame_rate(const RenderOptions& o, const RenderRequest& request) {
  Settings settings;
  RETURN_IF_ERROR(picture_size(o.common, &settings.width, &settings.height));
  const PixelBox box = box_to_write(request.picture, settings);
  return check_animation(request.animation, o.frames_per_second, static_cast<std::uint32_t>(box.width),
                         static_cast<std::uint32_t>(box.height));
}

}  // namespace

bool keeps_journal(const RenderOptions& o, const RenderRequest& request) {
  return request.sequence.given && request.animation == AnimationKind::none && o.servers.addresses.empty() &&
         !chooses_settings(o.budget);
}

std::string identity_of(const RenderOptions& o, const RenderRequest& request, const SceneSource& source,
                        const Renderer& renderer) {
  std::string text = o.common.scene.substr(0, source.baked ? 0 : std::string::npos);  // a built-in scene is its name
  auto add = [&](const char* format, auto... values) {
    char part[400];
    std::snprintf(part, sizeof part, format, values...);
    text += part;
  };
  const ContentHash scene = content_hash(source.baked, source.baked_bytes);
  add(" %" PRIx64 " %" PRIx64, source.environment.low, source.environment.high);
  add(" %" PRIx64 " %" PRIx64 " %d.%d.%d", scene.low, scene.high, POCKETRAY_VERSION_MAJOR, POCKETRAY_VERSION_MINOR,
      POCKETRAY_VERSION_PATCH);
  add(" %u %u %" PRIx64, renderer.settings.width, renderer.settings.height, std::uint64_t(renderer.effects.mask));
  for (const SettingRow& row : kSettingList) add(" %a", row.field.get(renderer.settings));
  const Camera& c = renderer.view.camera;
  for (const Vec3& v : {c.eye, c.target, c.up, renderer.scene.info.background, renderer.scene.info.ambient})
    add(" %a %a %a", static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z));
  add(" %a %a %d %u %d", static_cast<double>(c.vertical_fov), static_cast<double>(c.vertical_extent),
      static_cast<int>(c.projection), renderer.view.camera_index, renderer.view.camera_overridden);
  add(" %a %d %u", static_cast<double>(renderer.view.exposure), static_cast<int>(renderer.view.look.light),
      renderer.view.animation);
  add(" %a %u %a %a", static_cast<double>(o.orbit_degrees), o.turntable, o.seconds, o.frames_per_second);
  if (moves_camera(o)) add(" %u", request.sequence.first);
  const PixelBox box = box_to_write(request.picture, renderer.settings);
  add(" %s %s %d %d %d,%d,%dx%d", o.aov.c_str(), o.raw_format.c_str(), o.rotation, o.dither, box.left, box.top,
      box.width, box.height);
  const ContentHash hash = content_hash(text.data(), text.size());
  char digits[40];
  std::snprintf(digits, sizeof digits, "%016" PRIx64 "%016" PRIx64, hash.low, hash.high);
  return digits;
}

bool moves_camera(const RenderOptions& o) { return o.orbit_degrees != 0 || o.turntable > 0; }

float orbit_after(const RenderOptions& o, std::uint32_t frame_count) {
  if (o.turntable > 0) return static_cast<float>(360.0 * frame_count / o.turntable);
  return static_cast<float>(frame_count) * o.orbit_degrees;
}

double frame_rate(const RenderOptions& o, const SceneInfo& scene) {
  return o.frames_per_second > 0 ? o.frames_per_second : static_cast<double>(scene.frames_per_second);
}

double time_of(const RenderOptions& o, const RenderRequest& request, std::uint32_t frame, const SceneInfo& scene) {
  return o.turntable > 0 || !request.sequence.given ? o.seconds : frame / frame_rate(o, scene);
}

std::vector<std::string> unexpected(const RenderOptions& o, const RenderRequest& request, const Renderer& renderer) {
  const Scene& scene = renderer.scene;
  std::vector<std::string> notes;
  if (renderer.settings.tone != Settings().tone) {
    if (stores_values(request.kind))
      notes.push_back("--tone has no effect: .pfm and .exr store radiance");
    else if (request.aov != Aov::none)
      notes.push_back("--tone has no effect: the picture does not show light");
  }
  const bool sequence = request.sequence.given && o.turntable == 0;
  const double last = sequence ? time_of(o, request, request.sequence.last, scene.info) : o.seconds;
  if (!is_animated(scene) || renderer.view.animation == kNone) {
    if (o.seconds != 0) notes.push_back("--time has no effect: the scene does not move");
    if (sequence && !moves_camera(o) && request.sequence.last > request.sequence.first)
      notes.push_back(
          "all frames are equal: the scene does not move; --turntable N or --orbit DEGREES moves the camera");
  } else if (const double duration = static_cast<double>(scene.animations[renderer.view.animation].duration);
             last >= duration && last > 0) {
    char text[160];
    std::snprintf(text, sizeof text, "the animation loops after %g s: %s %g s shows its %g s", duration,
                  sequence ? "the last frame, at" : "--time", last, duration > 0 ? std::fmod(last, duration) : 0);
    notes.push_back(text);
  }
  return notes;
}

Status read_render_options(RenderOptions* o, RenderRequest* request) {
  RETURN_IF_ERROR(parse_frames(o->frames, &request->sequence));
  if (o->turntable > 0) request->sequence = {0, o->turntable - 1, true};
  RETURN_IF_ERROR(parse_aov(o->aov, &request->aov));
  RETURN_IF_ERROR(parse_raw_format(o->raw_format, &request->picture.raw_format));
  RETURN_IF_ERROR(choose_kind(*o, request));
  request->animation = animation_kind(request->kind);
  const std::string output = "-o " + o->output;
  Uses uses = uses_of(*o, *request, output.c_str());
  RETURN_IF_ERROR(check_uses(uses));
  uses.add(Use::coherence, o->common.coherence == "auto");
  if (!check_uses(uses).ok) o->common.coherence = "off";
  RETURN_IF_ERROR(check_paths(*o, request));
  if (!rotation_from_degrees(o->rotation, &request->picture.rotation))
    return failure("--rotate is %d: it must be 0, 90, 180 or 270", o->rotation);
  request->picture.dither = o->dither;
  RETURN_IF_ERROR(read_crop(*o, request));
  RETURN_IF_ERROR(check_journal(*o, *request));
  RETURN_IF_ERROR(check_frame_rate(*o, *request));
  if (!(std::fabs(o->orbit_degrees) <= 360)) return failure("--orbit must lie in -360 … 360");
  return check_limit(Quantity::seconds, o->seconds, "--time");
}

namespace {

void add_sequence_options(Command command, RenderOptions* o) {
  command.chapter("Animation");
  Option frames = command.add_option("--frames A:B", o->frames, "render frames A to B")
                      .details("Under mpirun, in a build with MPI, ranks share them.");
  command.add_option("--time SECONDS", o->seconds, "the animation's time, for a single frame")
      .range(-kSecondsMax, kSecondsMax)
      .capture_default_str();
  Option orbit = command.add_option("--orbit DEGREES", o->orbit_degrees, "orbit the camera by DEGREES per frame")
                     .range(-360, 360)
                     .capture_default_str();
  command.add_option("--turntable N", o->turntable, "render N frames on a circle around the target")
      .range(2, kTurntableMax)
      .details("The scene's time stands still, at --time.")
      .excludes(frames, "a turntable has frames of its own")
      .excludes(orbit, "a turntable sets the angle between frames");
  command.add_option("--fps N", o->frames_per_second, "frames per second of the scene's time and the file")
      .range(kAnimationRateMin, kAnimationRateMax)
      .default_str("the scene's");
  command.add_flag("--resume", o->resume, "skip frames that an earlier run has finished")
      .details("It must have had the same scene, version and options; OUT.resume lists its frames.");
}

void add_output_options(Command command, RenderOptions* o) {
  command.chapter("Output");
  command.add_option("-o,--output FILE", o->output, "file to write: .png, .jpg, .gif, .mp4, …")
      .capture_default_str()
      .details(
          "A picture: .png, .jpg, .ppm, .pfm or .exr (linear radiance), or .raw (a framebuffer's bytes). Of several "
          "frames, numbered pictures, out-0000.png …, or one animation: .gif, .apng (all colours) or .mp4 (by ffmpeg). "
          "- is standard output.");
  command.add_option("--format NAME", o->format, "format for -o -")
      .one_of({"png", "jpg", "ppm", "pfm", "exr", "raw", "gif", "apng", "mp4"})
      .default_str("png");
  command.add_option("--crop X,Y,WxH", o->crop, "trace and write only these pixels")
      .default_str("all")
      .details("X and Y count from the top left.");
  command.add_option("--aov NAME", o->aov, "show this instead of the picture, in false colours")
      .one_of({"none", "depth", "normal", "triangle", "position", "cost"})
      .capture_default_str()
      .details(".pfm and .exr have the values.");
  command.add_flag("--no-legend", o->no_legend, "leave out the legend of --aov");
  command.add_option("--rotate DEGREES", o->rotation, "rotate .raw pictures clockwise")
      .one_of({"0", "90", "180", "270"})
      .capture_default_str();
  command.add_flag("--dither", o->dither, "apply ordered dithering to .raw pictures");
  command.add_option("--raw-format NAME", o->raw_format, "pixel format of .raw pictures")
      .one_of({"rgb565", "bgr565", "xrgb8888", "xbgr8888", "rgb888", "bgr888"})
      .capture_default_str();
  command.add_flag("--plan", o->plan, "also print the effects and the memory map");
  add_json_option(command, &o->common.json);
}

}  // namespace

void add_render_options(Command command, RenderOptions* o) {
  add_scene_options(command, &o->common);
  add_budget_options(command, &o->budget);
  add_look_options(command, &o->common, {"--budget-ms", "--flip-max"});
  add_sequence_options(command, o);
  add_coherence_options(command, &o->common);
  if (o->parts.servers) add_servers_options(command, &o->servers);
  add_output_options(command, o);
  command.everyday("Picture", {"--output", "--size", "--quality", "--exposure"});
  command.everyday("View", {"--camera", "--focus"});
  command.everyday("Light", {"--environment", "--background"});
  command.everyday("Animation", {"--frames", "--turntable"});
  command.everyday("Speed", {"--budget-ms", "--server"});
  command.example("pocketray render cornell -o cornell.png");
  command.example("pocketray render seesaw --frames 0:99 -o seesaw.gif");
}

}  // namespace pocketray
