#include "desktop/sweep/reference_file.h"

#include <nlohmann/json.hpp>

#include "base/check.h"
#include "effect/setting_list.h"
#include "engine/frame.h"
#include "platform/file.h"
#include "session/output.h"
#include "session/report.h"
#include "session/scene_options.h"

namespace pocketray {
namespace {

std::string text_of(const Vec3& v) {
  char text[80];
  std::snprintf(text, sizeof text, "%.9g,%.9g,%.9g", static_cast<double>(v.x), static_cast<double>(v.y),
                static_cast<double>(v.z));
  return text;
}

std::string camera_text(const CameraRays& c) {
  return text_of(c.eye) + " " + text_of(c.forward) + " " + text_of(c.right) + " " + text_of(c.up) +
         (c.orthographic ? " orthographic" : "") +
         (c.near_distance > 0 ? " near " + std::to_string(c.near_distance) : "");
}

}  // namespace

const char* name_of(Transport transport) { return transport == Transport::model ? "model" : "physical"; }

Status prepare_for_reference(double seconds, Rig* rig) {
  CHECK(rig != nullptr && rig->opened.renderer.accel.info != nullptr);  // opened
  RETURN_IF_ERROR(change_settings(&rig->opened.renderer, reference_settings(rig->baseline.settings)));
  return begin_frame(&rig->opened.renderer, {seconds});
}

std::string reference_key(const Rig& rig, const AccuracyOptions& options, Transport transport) {
  const Renderer& renderer = rig.opened.renderer;
  CHECK(renderer.frame.scene != nullptr);
  Json key = {{"kind", name_of(transport)},
              {"scene", rig.scene_hash},
              {"size", std::to_string(renderer.settings.width) + "x" + std::to_string(renderer.settings.height)},
              {"camera", camera_text(renderer.frame.view.camera)},
              {"time", options.seconds},
              {"effects", options.common.effects},
              {"sampler", kReferenceSampler}};
  const CommonOptions& common = options.common;  // --fov is part of the camera, --environment of the scene's hash
  if (common.environment == kNoEnvironment) key["environment"] = common.environment;
  if (!common.background.empty()) key["background"] = common.background;
  if (common.light != CommonOptions().light) key["light"] = common.light;
  return key.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Status load_accumulation(const std::string& path, Accumulation* accumulation, Transport* transport) {
  CHECK(accumulation != nullptr && transport != nullptr);
  platform::LoadedFile file;
  platform::FileError error;
  if (!platform::load_file(path.c_str(), &file, &error)) return failure("%.300s %s", path.c_str(), error.text);
  Status status = decode_accumulation(file.bytes, file.byte_count, accumulation);
  platform::unload_file(&file);
  if (!status.ok) return failure("%.300s %.180s", path.c_str(), status.message);
  Json key = Json::parse(accumulation->key, nullptr, false);
  bool named = key.is_object() && key.contains("kind") && key["kind"].is_string();
  if (!named || (key["kind"] != "model" && key["kind"] != "physical"))
    return failure("%.300s is a reference of unknown kind: remove it, or use another copy", path.c_str());
  *transport = key["kind"] == "model" ? Transport::model : Transport::physical;
  return success();
}

Status check_same_reference(const std::string& path, const Accumulation& there, const Accumulation& wanted) {
  Json has = Json::parse(there.key, nullptr, false), wants = Json::parse(wanted.key, nullptr, false);
  CHECK(wants.is_object());
  for (const auto& item : wants.items()) {
    std::string value = has.is_object() && has.contains(item.key()) ? has[item.key()].dump() : "unknown";
    if (value != item.value().dump())
      return failure("%.200s is a reference with %s %.90s, not %.90s: name another file", path.c_str(),
                     item.key().c_str(), value.c_str(), item.value().dump().c_str());
  }
  if (has.is_object())
    for (const auto& item : has.items())
      if (!wants.contains(item.key()))
        return failure("%.200s is a reference with %s %.90s, not the scene's own: name another file", path.c_str(),
                       item.key().c_str(), item.value().dump(-1, ' ', false, Json::error_handler_t::replace).c_str());
  if (there.key == wanted.key && there.width == wanted.width && there.height == wanted.height) return success();
  return failure("%.300s is damaged: remove it, or use another copy", path.c_str());
}

Status save_accumulation(const std::string& path, const Accumulation& accumulation) {
  CHECK(!path.empty());
  std::vector<std::uint8_t> bytes = encode_accumulation(accumulation);
  return write_encoded(path.c_str(), [&](const ByteSink& sink) {
    sink.write(sink.user, bytes.data(), bytes.size());
    return success();
  });
}

}  // namespace pocketray
