// A scene opened for a sweep.
#include <zlib.h>

#include <algorithm>

#include "base/check.h"
#include "base/limits.h"
#include "desktop/sweep/bake_rig.h"
#include "desktop/sweep/sweep.h"
#include "effect/setting_list.h"
#include "engine/frame.h"
#include "platform/instructions.h"
#include "scene/baked.h"
#include "session/front_file.h"
#include "session/interrupt.h"
#include "session/scene_identity.h"

namespace pocketray {
namespace {

// Initial address space if no --memory is given; a sweep touches only what it needs of it.
constexpr std::size_t kMemoryFirst = std::size_t(1) << 30;

std::string hash_of(const SceneSource& source, const Scene& scene) {
  std::vector<std::uint8_t> own;
  const std::uint8_t* bytes = source.baked;
  std::size_t byte_count = source.baked_bytes;
  if (!bytes) {
    own.resize(baked_size(scene));
    baked_write(scene, own.data());
    bytes = own.data(), byte_count = own.size();
  }
  char text[48];
  std::snprintf(text, sizeof text, "%08lx of %zu bytes", crc32_z(0, bytes, byte_count), byte_count);
  return text;
}

// Plans for the most memory that a sweep needs for each setting.
Status plan_sweeps(Renderer* renderer, const SceneStorage& storage, const OutputNeed& output) {
  RETURN_IF_ERROR(plan_renderer(renderer, storage, output));
  std::vector<Quality> swept;
  for (const SettingRow& row : kSettingList)
    for (int i = 0; i < row.sweep.count; ++i) {
      swept.push_back(renderer->settings);
      row.field.set(&swept.back(), row.sweep.values[i]);
    }
  renderer->settings =
      widest_settings(renderer->scene, renderer->settings, {swept.data(), static_cast<std::uint32_t>(swept.size())});
  return plan_renderer(renderer, storage, output);
}

Status load_cornell(std::uint32_t sphere_columns, Renderer* renderer, SceneStorage* storage) {
  if (tessellated_cornell_need(sphere_columns) > arena_free(renderer->memory.scene))
    return failure("cornell with a sphere of %u columns does not fit in --memory: raise it", sphere_columns);
  build_tessellated_cornell(sphere_columns, &renderer->memory.scene, &renderer->scene);
  CHECK_LE(renderer->memory.scene.used, tessellated_cornell_need(sphere_columns));
  *storage = SceneStorage();
  storage->arena_bytes = renderer->memory.scene.used;
  return success();
}

Status open_with(const AccuracyOptions& options, const CommonOptions& common, const SceneChoice& choice, Rig* rig) {
  const std::uint32_t sphere_columns = choice.sphere_columns;
  OpenHooks hooks;
  hooks.output_bytes = [](const Settings&) -> std::size_t { return 0; };
  if (sphere_columns != kCornellSphereColumns)
    hooks.load = [=](const std::string&, Renderer* renderer, SceneSource*, SceneStorage* storage) {
      return load_cornell(sphere_columns, renderer, storage);
    };
  if (!is_as_opened(choice.bake))
    hooks.load = [&](const std::string& name, Renderer* renderer, SceneSource* source, SceneStorage* storage) {
      return load_as_baked(choice.bake, common.accel, name, renderer, source, storage, &rig->bake_seconds);
    };
  hooks.loaded = [&](const SceneSource& source, Renderer* renderer) {
    rig->baseline.settings = renderer->settings;
    rig->scene_hash = hash_of(source, renderer->scene);
    if (renderer->view.animation != 0) rig->scene_hash += ", animation " + common.animation;
    ContentHash identity;
    rig->has_own_look = common.background.empty() && common.environment.empty() &&
                        common.light == CommonOptions().light && renderer->view.animation == 0;
    if (!rig->has_own_look || !identify_scene(source, renderer, &identity).ok) return success();
    rig->front_path = front_path(common.scene, identity);
    rig->prices_path =
        front_path(common.scene, identity, machine_name(renderer->pace.device, renderer->settings.threads));
    return success();
  };
  hooks.plan = plan_sweeps;
  RETURN_IF_ERROR(open_scene(common, hooks, &rig->opened));
  RETURN_IF_ERROR(start_scene(&rig->opened, common));
  Renderer* renderer = &rig->opened.renderer;
  rig->stored_bytes = static_cast<double>(stored_bytes_of(*renderer));
  RETURN_IF_ERROR(change_settings(renderer, rig->baseline.settings));
  RETURN_IF_ERROR(begin_frame(renderer, {options.seconds}));
  ExposureChoice exposure_choice;
  float factor;
  RETURN_IF_ERROR(parse_exposure(common.exposure, &exposure_choice, &factor));
  if (renderer->scene.info.auto_exposure == 0) return success();
  renderer->view.exposure = measure_exposure(renderer);
  return change_exposure(factor, &renderer->view.exposure);
}

// Number of whole-picture rows with as many pixels as a frame.
std::uint32_t row_count(const Rig& rig) {
  const Settings& settings = rig.opened.renderer.settings;
  return rig.part_pixels ? rig.part_pixels / settings.width : settings.height;
}

}  // namespace

Status open_rig(const AccuracyOptions& options, const SceneChoice& choice, std::unique_ptr<Rig>* rig) {
  CommonOptions common = options.common;
  bool grows = common.memory.empty() && common.device.empty() && common.emulate.empty();
  std::size_t memory = kMemoryFirst;
  for (;;) {
    if (grows) common.memory = std::to_string(memory);
    *rig = std::make_unique<Rig>();
    (*rig)->baseline.output = find_output_format(options.output);
    (*rig)->baseline.sphere_columns = kCornellSphereColumns;
    Status status = open_with(options, common, choice, rig->get());
    std::size_t wanted = (*rig)->opened.source.bytes_wanted;
    if (status.ok || !grows || wanted <= memory) return status;
    memory = size_sum(wanted, wanted / 4);
  }
}

void make_rig_reference(Rig* rig) {
  if (!rig->reference_memory.empty()) return;
  const FrameData& frame = rig->opened.renderer.frame;
  rig->reference_memory.resize(reference_need(frame) + kArenaAlignment);
  Arena arena = make_arena("reference", rig->reference_memory.data(), rig->reference_memory.size());
  rig->reference = make_reference(frame, &arena);
}

std::uint32_t take_part(Rig* rig) {
  Renderer* renderer = &rig->opened.renderer;
  constexpr std::uint32_t kParts = 4;  // along each axis
  std::uint32_t width = renderer->settings.width, height = renderer->settings.height, quarter = width / kParts,
                count = 0;
  if (quarter < kTileRows || height < kParts * kTileRows) return width * height;
  for (std::uint32_t band = kParts / 2; (band + 1) * kTileRows <= height; band += kParts)
    for (std::uint32_t row = band * kTileRows; row < (band + 1) * kTileRows; ++row) {
      std::uint32_t begin = band / kParts % kParts * quarter;
      renderer->spans[count++] = {static_cast<std::uint16_t>(row), static_cast<std::uint16_t>(begin),
                                  static_cast<std::uint16_t>(begin + quarter)};
    }
  CHECK(count > 0 && count <= renderer->spans.count);
  renderer->spans.count = count;
  return rig->part_pixels = count * quarter;
}

Status time_frame(Rig* rig, const Configuration& configuration, double seconds, double* ns_per_pixel) {
  Renderer* renderer = &rig->opened.renderer;
  RETURN_IF_ERROR(change_settings(renderer, configuration.settings));
  RETURN_IF_ERROR(begin_frame(renderer, {seconds}));  // a change of settings does not count towards the frame
  std::uint64_t start = clock_ns();
  RETURN_IF_ERROR(render_frame(renderer, seconds, Aov::none, &interrupted));
  double frame_ns = static_cast<double>(clock_ns() - start);
  CHECK_GE(configuration.output, 0);
  const OutputFormat& output = kOutputFormats[configuration.output];
  int width = static_cast<int>(renderer->settings.width), height = static_cast<int>(renderer->settings.height),
      line_bytes = width * output.format.bits_per_pixel / 8;
  rig->packed.resize((static_cast<std::size_t>(line_bytes) * renderer->settings.height + 3) / 4);
  start = clock_ns();
  pack_rows(renderer->image.data, width, height, 0, static_cast<int>(row_count(*rig)), display_of(*renderer),
            output.format, Rotation::none, output.dither, rig->packed.data(), line_bytes);
  double pack_ns = static_cast<double>(clock_ns() - start);
  *ns_per_pixel = (frame_ns + pack_ns) / static_cast<double>(renderer->image.count);
  return success();
}

Status count_instructions(Rig* rig, const Configuration& configuration, double seconds, double* per_pixel) {
  CHECK(per_pixel != nullptr);
  *per_pixel = kNotMeasured;
  std::uint64_t start = platform::instruction_count();
  if (start == 0) return success();
  Renderer* renderer = &rig->opened.renderer;
  RETURN_IF_ERROR(change_settings(renderer, configuration.settings));
  RETURN_IF_ERROR(begin_frame(renderer, {seconds}));
  start = platform::instruction_count();
  RETURN_IF_ERROR(begin_frame(renderer, {seconds}));  // prepares again, so that this is not counted
  std::uint64_t prepared = platform::instruction_count();
  double ns_per_pixel;
  RETURN_IF_ERROR(time_frame(rig, configuration, seconds, &ns_per_pixel));
  std::uint64_t end = platform::instruction_count();
  double traced = static_cast<double>(end - prepared) - 2 * static_cast<double>(prepared - start);
  if (!interrupted && traced > 0) *per_pixel = traced / static_cast<double>(renderer->image.count);
  return success();
}

}  // namespace pocketray
