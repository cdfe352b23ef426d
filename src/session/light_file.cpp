#include "session/light_file.h"

#include <cinttypes>
#include <cstring>

#include "base/check.h"
#include "engine/pocketray.h"
#include "platform/file.h"
#include "scene/baked.h"
#include "scene/validate_checks.h"
#include "session/cache.h"
#include "session/output.h"

namespace pocketray {
namespace {

constexpr char kMagic[8] = {'P', 'R', 'L', 'I', 'G', 'H', 'T', '\n'};
constexpr std::uint64_t kFileBytesMax = std::uint64_t(64) << 20;  // chosen: many times kOpenLimit

// The arrays follow, each padded to kArenaAlignment.
struct Header {
  char magic[8];
  std::uint32_t program, baked_version;
  ContentHash scene, content;  // content: of the bytes that follow
  std::uint32_t counts[kRadiosityArrays];
};

std::size_t padded(std::size_t bytes) { return (bytes + kArenaAlignment - 1) / kArenaAlignment * kArenaAlignment; }

Header header_of(const ContentHash& identity) {
  Header header = {};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  header.program = POCKETRAY_VERSION_NUMBER, header.baked_version = kBakedVersion;
  header.scene = identity;
  return header;
}

bool is_of(const Header& header, const ContentHash& identity) {
  return std::memcmp(header.magic, kMagic, sizeof kMagic) == 0 && header.program == POCKETRAY_VERSION_NUMBER &&
         header.baked_version == kBakedVersion && header.scene == identity;
}

}  // namespace

std::string light_path(const std::string& scene, const ContentHash& identity) {
  const std::string folder = cache_folder(scene);
  if (folder.empty()) return "";
  char name[48];
  std::snprintf(name, sizeof name, "/%016" PRIx64 "%016" PRIx64 ".light", identity.high, identity.low);
  return folder + name;
}

KeptLight read_light(const std::string& path, const ContentHash& identity, Scene* scene, SolvedRadiosity* solved) {
  CHECK(scene != nullptr && solved != nullptr);
  platform::FileReader file;
  platform::FileError error;
  if (path.empty() || !platform::open_reader(path.c_str(), &file, &error)) return KeptLight::none;
  Header header;
  bool ok = file.byte_count >= sizeof header && file.byte_count <= kFileBytesMax &&
            platform::read_bytes(&file, &header, sizeof header, &error) && is_of(header, identity);
  std::uint64_t need = 0;
  Scene lit = *scene;
  std::uint32_t index = 0;
  visit_radiosity(&lit, [&](auto& array) {
    array.count = ok ? header.counts[index++] : 0;
    need += padded(sizeof array[0] * std::uint64_t(array.count));
  });
  ok = ok && need == file.byte_count - sizeof header;
  if (ok) {
    solved->memory.resize(static_cast<std::size_t>(need) + kArenaAlignment);
    Arena arena = make_arena("radiosity", solved->memory.data(), solved->memory.size());
    auto* bytes = static_cast<std::uint8_t*>(arena_allocate(&arena, static_cast<std::size_t>(need)));
    ok = platform::read_bytes(&file, bytes, static_cast<std::size_t>(need), &error) &&
         content_hash(bytes, static_cast<std::size_t>(need)) == header.content;
    visit_radiosity(&lit, [&](auto& array) {
      array.data = array.empty() ? nullptr : reinterpret_cast<decltype(array.data)>(bytes);
      bytes += padded(array.bytes());
    });
  }
  platform::close_reader(&file);
  if (!ok || !validate_radiosity(lit).ok) return KeptLight::none;
  *scene = lit;
  return lit.radiosity_triangles.empty() ? KeptLight::unfit : KeptLight::solved;
}

Status write_light(const std::string& path, const ContentHash& identity, const Scene& scene) {
  RETURN_IF_ERROR(make_cache(path, "the light of rooms"));
  Header header = header_of(identity);
  std::string bytes;
  std::uint32_t index = 0;
  Scene lit = scene;
  visit_radiosity(&lit, [&](auto& array) {
    header.counts[index++] = array.count;
    const std::size_t begin = bytes.size();
    bytes.resize(begin + padded(array.bytes()));
    if (!array.empty()) std::memcpy(&bytes[begin], array.data, array.bytes());
  });
  header.content = content_hash(bytes.data(), bytes.size());
  return write_file(path, std::string(reinterpret_cast<const char*>(&header), sizeof header) + bytes);
}

}  // namespace pocketray
