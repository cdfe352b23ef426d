#include "session/front_file.h"

#include <cinttypes>

#include "base/check.h"
#include "base/isa.h"
#include "platform/file.h"
#include "session/cache.h"
#include "session/output.h"

namespace pocketray {
namespace {

constexpr std::size_t kFileBytesMax = 1 << 20;  // comments included; chosen: many times kFrontTextMax

}  // namespace

std::string front_path(const std::string& scene, const ContentHash& identity, const std::string& machine) {
  std::string folder = cache_folder(scene);
  if (folder.empty()) return "";
  char hash[40];
  std::snprintf(hash, sizeof hash, "%016" PRIx64 "%016" PRIx64, identity.high, identity.low);
  return folder + "/" + hash + (machine.empty() ? "" : "-" + machine) + ".front";
}

std::string machine_name(const char* emulated, std::uint32_t thread_count) {
  return std::string(emulated ? emulated : isa_name(active_isa())) + "-" + std::to_string(thread_count);
}

Status read_front(const std::string& path, Front* front, bool* there) {
  CHECK(front != nullptr && there != nullptr);
  *front = Front();
  *there = platform::file_stamp(path.c_str()) != 0;
  if (!*there) return success();
  platform::LoadedFile file;
  platform::FileError error;
  if (!platform::load_file(path.c_str(), &file, &error)) return failure("%.300s %s", path.c_str(), error.text);
  Status status = file.byte_count <= kFileBytesMax ? parse_front(file.bytes, file.byte_count, front)
                                                   : failure("longer than %zu bytes: not a front file", kFileBytesMax);
  platform::unload_file(&file);
  return status.ok ? status : failure("%.200s: %.280s", path.c_str(), status.message);
}

CachedFront read_cached_front(const std::string& scene, const ContentHash& identity, const std::string& machine) {
  CachedFront cached;
  bool there;
  cached.front_path = front_path(scene, identity), cached.prices_path = front_path(scene, identity, machine);
  Status status = read_front(cached.front_path, &cached.front, &there);
  if (!status.ok) cached.notes.push_back(std::string(status.message) + "; ignoring it");
  status = read_front(cached.prices_path, &cached.prices, &there);
  if (!status.ok) cached.notes.push_back(std::string(status.message) + "; measuring prices again");
  return cached;
}

Status write_front(const std::string& path, const Front& front) {
  CHECK_LE(front.count, kFrontCandidateMax);
  std::string text(kFrontTextMax, 0);
  text.resize(format_front(front, &text[0], text.size()));
  return write_file(path, text);
}

Status cache_front(const std::string& path, const Front& front) {
  RETURN_IF_ERROR(make_cache(path, "--front"));
  return write_front(path, front);
}

}  // namespace pocketray
