#include "desktop/sweep/state.h"

#include <algorithm>
#include <limits>

#include "base/check.h"
#include "desktop/accuracy/claim.h"
#include "platform/file.h"
#include "session/output.h"

namespace pocketray {
namespace {

constexpr const char* kStateName = "accuracy.state";

// JSON has neither NaN nor infinity, which is the PSNR of equal pictures.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(value > 0 ? "inf" : "none"); }
double number_of(const Json& json) {
  if (json == "inf") return std::numeric_limits<double>::infinity();
  return json == "none" ? kNotMeasured : json.get<double>();
}

Json to_json(const Distance& d) { return {{"flip", number(d.flip)}, {"one", d.one}, {"other", d.other}}; }

Json to_json(const PointFigures& f) {
  Json json = {{"ns_per_pixel", f.ns_per_pixel},
               {"instructions_per_pixel", number(f.instructions_per_pixel)},
               {"bytes_per_frame", number(f.bytes_per_frame)},
               {"stored_bytes", number(f.stored_bytes)},
               {"bake_seconds", number(f.bake_seconds)}};
  if (f.has_errors) {
    const PictureErrors& e = f.errors;
    json["errors"] = {number(f.flip_before), number(e.rmse), number(e.rel_mse), number(e.p99),
                      number(e.max),         number(e.bias), number(e.psnr)};
    json["truth"] = to_json(f.truth), json["model"] = to_json(f.model);
    for (double flip : f.flip_as) json["flip_as"].push_back(number(flip));
  }
  return json;
}

Distance distance_from(const Json& json) {
  Distance d;
  d.flip = number_of(json.at("flip"));
  d.one = json.at("one").get<std::vector<float>>(), d.other = json.at("other").get<std::vector<float>>();
  return d;
}

PointFigures figures_from(const Json& json) {
  PointFigures f;
  f.ns_per_pixel = json.at("ns_per_pixel").get<std::vector<double>>();
  f.instructions_per_pixel = number_of(json.at("instructions_per_pixel"));
  f.bytes_per_frame = number_of(json.at("bytes_per_frame"));
  f.stored_bytes = number_of(json.at("stored_bytes")), f.bake_seconds = number_of(json.at("bake_seconds"));
  f.has_errors = json.contains("errors");
  if (!f.has_errors) return f;
  const Json& e = json.at("errors");
  f.flip_before = number_of(e.at(0));
  f.errors = {number_of(e.at(1)), number_of(e.at(2)), number_of(e.at(3)),
              number_of(e.at(4)), number_of(e.at(5)), number_of(e.at(6))};
  f.truth = distance_from(json.at("truth")), f.model = distance_from(json.at("model"));
  for (std::size_t i = 0; i < f.flip_as.size(); ++i) f.flip_as[i] = number_of(json.at("flip_as").at(i));
  return f;
}

bool is_within(double value, double low, double high) { return value >= low && value <= high; }

bool is_sane(const Distance& d) {
  auto is_flip = [](float flip) { return flip >= 0 && flip <= 1; };
  return is_within(d.flip, 0, 1) && !d.one.empty() && d.one.size() == d.other.size() &&
         d.one.size() <= kBlocksPerSide * kBlocksPerSide && std::all_of(d.one.begin(), d.one.end(), is_flip) &&
         std::all_of(d.other.begin(), d.other.end(), is_flip);
}

// True if a sweep could have written it; other values could not be plotted.
bool is_sane(const PointFigures& f) {
  constexpr double kNsPerPixelMax = 1e15, kInstructionsPerPixelMax = 1e16, kBytesPerFrameMax = 1e12;
  for (double ns : f.ns_per_pixel)
    if (!(ns > 0 && ns <= kNsPerPixelMax)) return false;
  if (!std::isnan(f.instructions_per_pixel) && !is_within(f.instructions_per_pixel, 0, kInstructionsPerPixelMax))
    return false;
  if (!std::isnan(f.bytes_per_frame) && !is_within(f.bytes_per_frame, 0, kBytesPerFrameMax)) return false;
  constexpr double kStoredBytesMax = 1e12, kBakeSecondsMax = 1e9;
  if (!std::isnan(f.stored_bytes) && !is_within(f.stored_bytes, 0, kStoredBytesMax)) return false;
  if (!std::isnan(f.bake_seconds) && !is_within(f.bake_seconds, 0, kBakeSecondsMax)) return false;
  const PictureErrors& e = f.errors;  // of light between 0 and 1
  for (double flip : f.flip_as)
    if (f.has_errors && !is_within(flip, 0, 1)) return false;
  return !f.has_errors || (is_sane(f.truth) && is_sane(f.model) && is_within(f.flip_before, 0, 1) &&
                           is_within(e.rmse, 0, 1) && is_within(e.rel_mse, 0, 1 / kRelativeFloor) &&
                           is_within(e.p99, 0, 1) && is_within(e.max, 0, 1) && is_within(e.bias, -1, 1) && e.psnr >= 0);
}

Status read_state(const std::string& text, const std::string& path, AccuracyState* state) {
  try {
    Json json = Json::parse(text);
    state->key = json.at("key");
    state->rounds = json.at("rounds").get<std::uint32_t>();
    state->counted = json.value("counted", std::string());
    state->references = json.at("references").get<std::vector<std::string>>();
    for (const auto& item : json.at("points").items()) {
      PointFigures f = figures_from(item.value());
      if (f.ns_per_pixel.size() != state->rounds)
        return failure("%s does not have one time per round: use --restart to start over", path.c_str());
      if (!is_sane(f)) return failure("%s has impossible figures: use --restart to start over", path.c_str());
      state->points[item.key()] = f;
    }
  } catch (const Json::exception&) {
    return failure("%s is damaged: use --restart to start over", path.c_str());
  }
  return success();
}

// Fails with a message on the first difference.
Status compare_keys(const std::string& folder, const Json& there, const Json& wanted) {
  for (const auto& item : wanted.items())
    if (!there.is_object() || !there.contains(item.key()) || there.at(item.key()) != item.value()) {
      std::string other = there.is_object() && there.contains(item.key()) ? there.at(item.key()).dump() : "another";
      return failure(
          "%.200s holds a sweep with %s %.60s, not %.60s: name another folder with -o, or use --restart to start over",
          folder.c_str(), item.key().c_str(), other.c_str(), item.value().dump().c_str());
    }
  return success();
}

// Replaces bytes that are not UTF-8, which file names may contain.
std::string written(const Json& json) { return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"; }

}  // namespace

Status open_state(const std::string& folder, const Json& wanted, bool restart, AccuracyState* state) {
  CHECK(state != nullptr);
  *state = AccuracyState();
  Json key = Json::parse(written(wanted));  // as it will be read back
  platform::FileError error;
  if (!platform::make_folder(folder.c_str(), &error)) return failure("%s %s", folder.c_str(), error.text);
  std::string path = folder + "/" + kStateName;
  if (!restart && platform::file_stamp(path.c_str()) != 0) {
    platform::LoadedFile file;
    if (!platform::load_file(path.c_str(), &file, &error))
      return failure("%s %s, or use --restart to start over", path.c_str(), error.text);
    std::string text(reinterpret_cast<const char*>(file.bytes), file.byte_count);
    platform::unload_file(&file);
    RETURN_IF_ERROR(read_state(text, path, state));
    return compare_keys(folder, state->key, key);
  }
  state->key = key;
  return save_state(folder, *state);
}

Status save_state(const std::string& folder, const AccuracyState& state) {
  Json points = Json::object();
  for (const auto& point : state.points) points[point.first] = to_json(point.second);
  Json json = {{"key", state.key},
               {"rounds", state.rounds},
               {"counted", state.counted},
               {"references", state.references},
               {"points", points}};
  return save_text(folder, kStateName, written(json));
}

Status save_text(const std::string& folder, const std::string& name, const std::string& text) {
  return write_file(folder + "/" + name, text);
}

}  // namespace pocketray
