#include "session/scene_options.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "accel/accel_list.h"
#include "base/check.h"
#include "base/color.h"
#include "base/fmath.h"
#include "base/nearest_word.h"
#include "plan/plan_effects.h"
#include "platform/memory.h"

namespace pocketray {
namespace {

// Names the option in errors; validate_settings() checks the same limits under the library's names.
Status read_setting(const SettingRow& row, const SettingOption& option, Quality* quality) {
  const std::string name = std::string("--") + row.name;
  double value = row.field.kind == SettingKind::count ? double(option.count) : double(option.real);
  if (row.field.kind == SettingKind::choice && !find_choice(row, option.choice.data(), option.choice.size(), &value)) {
    char names[128];
    describe_range(row, names, sizeof names);
    return failure("%s is '%.200s': it must be %s", name.c_str(), option.choice.c_str(), names);
  }
  RETURN_IF_ERROR(check_setting(row, value, name.c_str()));
  row.field.set(quality, value);
  return success();
}

// Reads numbers separated by spaces or commas; returns false unless there are exactly `count` finite ones.
bool read_numbers(const std::string& text, double* values, int count) {
  const char* at = text.c_str();
  for (int i = 0; i < count; ++i) {
    while (*at == ' ' || *at == ',') ++at;
    char* end;
    values[i] = std::strtod(at, &end);
    if (end == at || !std::isfinite(static_cast<float>(values[i]))) return false;
    at = end;
  }
  while (*at == ' ') ++at;
  return *at == 0;
}
bool read_numbers(const std::string& text, float* values, int count) {
  double exact[3];
  CHECK(count >= 1 && count <= 3);
  if (!read_numbers(text, exact, count)) return false;
  for (int i = 0; i < count; ++i) values[i] = static_cast<float>(exact[i]);
  return true;
}

}  // namespace

SettingOptions::SettingOptions() {
  const Quality usual;
  for (int i = 0; i < kSettingCount; ++i) {
    const SettingField& field = kSettingList[i].field;
    double value = field.get(usual);
    if (field.kind == SettingKind::count) options[i].count = static_cast<std::uint32_t>(value);
    if (field.kind == SettingKind::real) options[i].real = static_cast<float>(value);
    if (field.kind == SettingKind::choice) options[i].choice = field.names[static_cast<int>(value)];
  }
}

SettingOption& SettingOptions::operator[](const char* name) {
  const SettingRow* row = find_setting(name);
  CHECK(name != nullptr);
  CHECK(row != nullptr);
  return options[row - kSettingList];
}

std::size_t memory_to_take(std::size_t free_bytes) {
  if (free_bytes == 0) return static_cast<std::size_t>(kMemoryBytesMax);
  // For the program's own heap, stacks and screen. Chosen: an eighth of a small system alone gets the program killed.
  constexpr std::size_t kLeastLeft = 4 << 20;
  std::size_t left = std::max(free_bytes / 8, kLeastLeft);
  std::size_t bytes = free_bytes > left ? (free_bytes - left) >> 20 << 20 : 0;
  return std::max(bytes, static_cast<std::size_t>(kMemoryBytesMin));
}

Status parse_coherence(const std::string& text, CoherenceMode* mode) {
  constexpr const char* kNames[] = {"off", "auto", "on"};  // in the order of CoherenceMode
  for (int i = 0; i < 3; ++i)
    if (text == kNames[i]) return *mode = static_cast<CoherenceMode>(i), success();
  return failure("--coherence is '%s': it must be on, off or auto", text.c_str());
}

namespace {

Status read_others(const CommonOptions& o, Settings* settings) {
  if (o.coherence_table < 1 || o.coherence_table > kCoherenceTableSideMax)
    return failure("--coherence-table is %u: it must lie in 1 … %u", o.coherence_table, kCoherenceTableSideMax);
  settings->coherence_table = o.coherence_table;
  RETURN_IF_ERROR(check_limit(Quantity::texture_side, double(o.texture_side_max), "--texture-max"));
  settings->texture_side_max = o.texture_side_max;
  return parse_coherence(o.coherence, &settings->coherence);
}

}  // namespace

Status read_settings(const CommonOptions& o, Settings* settings) {
  RETURN_IF_ERROR(picture_size(o, &settings->width, &settings->height));
  const platform::Device* device;
  RETURN_IF_ERROR(find_device(o, &device));
  settings->memory_bytes = device ? device->memory_bytes : kMemoryUsual;
  settings->memory_bytes = std::min(settings->memory_bytes, memory_to_take(platform::free_memory()));
  if (!o.memory.empty()) RETURN_IF_ERROR(parse_bytes(o.memory, &settings->memory_bytes));
  RETURN_IF_ERROR(parse_effects(o.effects.c_str(), settings));
  RETURN_IF_ERROR(check_limit(Quantity::width, double(settings->width), "the width of --size"));
  RETURN_IF_ERROR(check_limit(Quantity::height, double(settings->height), "the height of --size"));
  RETURN_IF_ERROR(check_limit(Quantity::camera_index, double(o.camera_index), "--camera-index"));
  for (int i = 0; i < kSettingCount; ++i)
    RETURN_IF_ERROR(read_setting(kSettingList[i], o.settings.options[i], settings));
  RETURN_IF_ERROR(read_others(o, settings));
  ExposureChoice exposure;
  float factor;
  RETURN_IF_ERROR(parse_exposure(o.exposure, &exposure, &factor));  // checked even by commands that show nothing
  settings->tone = tone_named(o.tone.c_str());
  unsigned cores = std::thread::hardware_concurrency();
  CHECK(o.emulate.empty() || device != nullptr);
  if (!o.emulate.empty() && device->core_count > 0) cores = static_cast<unsigned>(device->core_count);
  RETURN_IF_ERROR(choose_thread_count(o.threads, cores, &settings->threads));
  return validate_settings(*settings);
}

Status find_device(const CommonOptions& o, const platform::Device** device) {
  *device = nullptr;
  if (!o.emulate.empty() && !o.device.empty() && o.emulate != o.device)
    return failure("--emulate is '%s' and --device is '%s': give only one of them", o.emulate.c_str(),
                   o.device.c_str());
  const std::string& name = o.emulate.empty() ? o.device : o.emulate;
  if (name.empty()) return success();
  *device = platform::find_device(name.c_str());
  if (*device) return success();
  const char* option = o.emulate.empty() ? "device" : "emulate";
  std::string names;
  NearestWord nearest(name.c_str());
  for (const platform::Device& d : platform::kDevices) {
    names += std::string(names.empty() ? "" : ", ") + d.name;
    nearest.offer(d.name);
  }
  if (nearest.name()) return failure("--%s is '%.60s', did you mean '%s'?", option, name.c_str(), nearest.name());
  return failure("--%s is '%.60s': it must be one of %s", option, name.c_str(), names.c_str());
}

Status picture_size(const CommonOptions& o, std::uint32_t* width, std::uint32_t* height) {
  const platform::Device* device;
  RETURN_IF_ERROR(find_device(o, &device));
  *width = 320;
  *height = 240;
  if (!o.size.empty()) return parse_size(o.size, width, height);
  if (o.emulate.empty()) return success();
  CHECK(device != nullptr);
  bool turned = device->rotation % 180 != 0;
  *width = static_cast<std::uint32_t>(turned ? device->screen_height : device->screen_width);
  *height = static_cast<std::uint32_t>(turned ? device->screen_width : device->screen_height);
  return success();
}

Status choose_thread_count(std::uint32_t asked, unsigned core_count, std::uint32_t* count) {
  if (asked > kThreadCountMax) return failure("--threads is %u: it must lie in 0 … %u", asked, kThreadCountMax);
  *count = asked > 0 ? asked : core_count < 1 ? 1 : core_count > kThreadCountMax ? kThreadCountMax : core_count;
  return success();
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
  std::string plain = text;  // with one kind of cross
  for (const char* cross : {"X", "×"})
    if (const std::size_t at = plain.find(cross); at != std::string::npos) plain.replace(at, std::strlen(cross), "x");
  if (plain.find_first_not_of("0123456789x") != std::string::npos ||  // a sign would wrap around
      std::sscanf(plain.c_str(), "%5ux%5u%n", width, height, &used) != 2 ||
      static_cast<std::size_t>(used) != plain.size())
    return failure("--size is '%.60s': write it as 320x240, 1x1 … %ux%u", text.c_str(), kImageSideMax, kImageSideMax);
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
  if (unit > 1 && *end == 'i' && (end[1] == 'B' || end[1] == 'b')) ++end;  // MiB
  if (unit > 1 && (*end == 'B' || *end == 'b')) ++end;                     // MB, of memory
  if (end == text.c_str() || *end || !(value * unit >= kMemoryBytesMin) || !(value * unit <= kMemoryBytesMax))
    return failure("%s is '%.60s': write it as 24M (64K … %s)", option, text.c_str(),
                   sizeof(void*) == 4 ? "2047M" : "64G");
  *bytes = static_cast<std::size_t>(value * unit);
  return success();
}

Status parse_camera(const std::string& text, Camera* camera, const SceneOrigin& origin) {
  double v[10];
  if (!read_numbers(text, v, 10))
    return failure("--camera is '%.60s': write it as \"ex,ey,ez tx,ty,tz ux,uy,uz VFOV\", the field of view in degrees",
                   text.c_str());
  for (int i = 0; i < 9; ++i) RETURN_IF_ERROR(check_limit(Quantity::coordinate, v[i], "a coordinate of --camera"));
  *camera = Camera();
  camera->eye = to_float(Vec3d{v[0] - origin.x, v[1] - origin.y, v[2] - origin.z});
  camera->target = to_float(Vec3d{v[3] - origin.x, v[4] - origin.y, v[5] - origin.z});
  camera->up = to_float(Vec3d{v[6], v[7], v[8]});
  camera->vertical_fov = static_cast<float>(radians(static_cast<float>(v[9])));
  if (!within(Quantity::field_of_view, camera->vertical_fov))
    return failure("the field of view of --camera is %g degrees: it must lie in 0.001 … 179", v[9]);
  return success();
}

namespace {

// Parses "#rrggbb", sRGB levels, or "r,g,b", radiance.
Status parse_background(const std::string& text, Vec3* radiance) {
  float v[3];
  if (text[0] == '#' && text.size() == 7 && text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos)
    for (std::size_t i = 0; i < 3; ++i)
      v[i] = srgb_to_linear(static_cast<std::uint8_t>(std::stoul(text.substr(1 + 2 * i, 2), nullptr, 16)));
  else if (text[0] == '#' || !read_numbers(text, v, 3))
    return failure("--background is '%.100s': write #rrggbb, or radiance as r,g,b", text.c_str());
  for (float x : v)
    if (!(x >= 0 && x <= kRadianceMax))
      return failure("a radiance of --background is %g: it must lie in 0 … %g", static_cast<double>(x),
                     static_cast<double>(kRadianceMax));
  *radiance = {v[0], v[1], v[2]};
  return success();
}

}  // namespace

Status parse_look(const CommonOptions& o, Look* look) {
  CHECK(look != nullptr);
  *look = Look();
  look->has_background = !o.background.empty();
  if (look->has_background) RETURN_IF_ERROR(parse_background(o.background, &look->background));
  if (!o.environment.empty())
    look->environment = o.environment == kNoEnvironment ? EnvironmentChoice::none : EnvironmentChoice::given;
  if (o.light == "sun") look->light = LightChoice::sun;
  if (o.light == "none") look->light = LightChoice::none;
  float degrees;
  if (o.fov.empty()) return success();
  if (!read_numbers(o.fov, &degrees, 1) || !within(Quantity::field_of_view, static_cast<float>(radians(degrees))))
    return failure("--fov is '%.100s': it must lie in 0.001 … 179 degrees", o.fov.c_str());
  look->vertical_fov = radians(degrees);
  return success();
}

Status parse_exposure(const std::string& text, ExposureChoice* choice, float* factor) {
  constexpr const char* kFixed = "fixed";
  const bool fixed = text.compare(0, std::strlen(kFixed), kFixed) == 0;
  *choice = text == "auto" ? ExposureChoice::measured : fixed ? ExposureChoice::fixed : ExposureChoice::as_scene;
  std::string given = fixed ? text.substr(std::strlen(kFixed)) : text;
  if (fixed && !given.empty()) given = given[0] == ',' && given.size() > 1 ? given.substr(1) : "?";
  float stops = 0;
  if (*choice != ExposureChoice::measured && !given.empty() &&
      (!read_numbers(given, &stops, 1) || !(std::fabs(stops) <= kExposureStopsMax)))
    return failure("--exposure is '%.60s': write stops as 1.5 or -2, -60 … 60, auto, fixed, or fixed,STOPS",
                   text.c_str());
  *factor = static_cast<float>(det_exp(static_cast<double>(stops) * 0.693147180559945309));
  return success();
}

const AccelInfo* find_accel(const std::string& name) {
  for (const AccelInfo* info : kAccelList)
    if (name == info->name) return info;
  return nullptr;
}

}  // namespace pocketray
