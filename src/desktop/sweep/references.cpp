#include "desktop/sweep/references.h"

#include <algorithm>
#include <cinttypes>

#include "base/check.h"
#include "base/nearest_word.h"
#include "platform/file.h"
#include "scene/content_hash.h"
#include "session/cache.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kModelSamples = 2048, kPhysicalSamples = 256;

// Path where samples are kept for all sweeps with this scene and camera; empty: nowhere.
std::string cached_path(const std::string& scene, const std::string& key) {
  std::string folder = cache_folder(scene);
  if (folder.empty()) return "";
  ContentHash hash = content_hash(key.data(), key.size());
  char name[48];
  std::snprintf(name, sizeof name, "/%016" PRIx64 "%016" PRIx64 ".pfm", hash.high, hash.low);
  std::string path = folder + name;
  Status status = make_cache(path, "the cache");
  if (status.ok) return path;
  std::fprintf(stderr, "pocketray: %s; the reference is only kept with the sweep\n", status.message);
  return "";
}

// Adopts the samples of a file if it exists and fits; otherwise they are taken again.
void continue_from(const std::string& path, Accumulation* accumulation) {
  if (platform::file_stamp(path.c_str()) == 0) return;
  Accumulation there;
  Transport kind;
  Status status = load_accumulation(path, &there, &kind);
  if (status.ok) status = check_same_reference(path, there, *accumulation);
  if (status.ok)
    *accumulation = there;
  else
    std::fprintf(stderr, "pocketray: %s; taking its samples again\n", status.message);
}

// Adopts a file that must fit.
Status adopt(const std::string& path, Accumulation* accumulation) {
  Accumulation there;
  Transport kind;
  RETURN_IF_ERROR(load_accumulation(path, &there, &kind));
  RETURN_IF_ERROR(check_same_reference(path, there, *accumulation));
  *accumulation = there;
  return success();
}

}  // namespace

std::uint32_t reference_samples(const AccuracyOptions& options, Transport transport) {
  std::uint32_t usual = transport == Transport::model ? kModelSamples : kPhysicalSamples;
  if (options.reference_samples == 0) return usual;
  return options.reference == name_of(transport) ? options.reference_samples
                                                 : std::min(usual, options.reference_samples);
}

Status name_reference(AccuracyOptions* options) {
  CHECK(options != nullptr);
  if (options->reference == "model" || options->reference == "physical") return success();
  NearestWord nearest(options->reference.c_str());
  for (const char* word : {"model", "physical"}) nearest.offer(word);
  if (nearest.name() && platform::file_stamp(options->reference.c_str()) == 0)
    return failure("--reference is '%.60s', did you mean '%s'?", options->reference.c_str(), nearest.name());
  if (!options->reference_file.empty() || platform::file_stamp(options->reference.c_str()) == 0)
    return failure("--reference is '%.200s': it must be model, physical or a file of `pocketray reference`",
                   options->reference.c_str());
  options->reference_file = options->reference;
  Accumulation accumulation;
  Transport transport;
  RETURN_IF_ERROR(load_accumulation(options->reference_file, &accumulation, &transport));
  if (samples_of(accumulation) == 0)
    return failure("%.300s has no samples of some rows yet: continue it with `pocketray reference`",
                   options->reference_file.c_str());
  options->reference = name_of(transport);
  options->reference_samples = static_cast<std::uint32_t>(samples_of(accumulation));
  return success();
}

Status render_reference(const AccuracyOptions& options, Transport transport, const LaterWork& later, Rig* rig,
                        AccuracyState* state, ReferencePictures* pictures, bool* whole) {
  CHECK(rig != nullptr && state != nullptr && pictures != nullptr && whole != nullptr);
  const Settings& settings = rig->opened.renderer.settings;
  std::string name = std::string("reference-") + name_of(transport), path = options.folder + "/" + name + ".pfm";
  *whole = true;
  RETURN_IF_ERROR(prepare_for_reference(options.seconds, rig));
  Accumulation accumulation =
      empty_accumulation(reference_key(*rig, options, transport), settings.width, settings.height);
  if (std::find(state->references.begin(), state->references.end(), name) != state->references.end()) {
    Status status = adopt(path, &accumulation);
    if (!status.ok) return failure("%.400s, or use --restart to start over", status.message);
  } else {
    if (!options.reference_file.empty() && options.reference == name_of(transport)) {
      RETURN_IF_ERROR(adopt(options.reference_file, &accumulation));
    } else {
      ReferenceGoal goal;
      goal.transport = transport;
      goal.samples = std::max(2u, reference_samples(options, transport) / 2 * 2);
      goal.pixels_per_degree = options.pixels_per_degree;
      goal.save_seconds = options.save_seconds;
      goal.row_done = options.row_done;
      goal.team = options.team;
      goal.later = later;
      goal.path = cached_path(options.common.scene, accumulation.key);
      if (goal.path.empty()) goal.path = path;
      continue_from(goal.path, &accumulation);
      if (samples_of(accumulation) < goal.samples) RETURN_IF_ERROR(run_reference(goal, rig, &accumulation, whole));
      if (!*whole) return success();
    }
    RETURN_IF_ERROR(save_accumulation(path, accumulation));
    state->references.push_back(name);
    RETURN_IF_ERROR(save_state(options.folder, *state));
  }
  develop(accumulation, display_of(rig->opened.renderer), options.pixels_per_degree, pictures);
  return success();
}

}  // namespace pocketray
