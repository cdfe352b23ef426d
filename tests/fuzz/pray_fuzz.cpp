// An untrusted .pray file: opened, posed, rendered.
#include <cstring>

#include "fuzz/fuzz.h"
#include "scene/baked_file.h"

POCKETRAY_FUZZ_TARGET(fuzz_pray)

namespace pocketray {

void fuzz_pray(const std::uint8_t* bytes, std::size_t byte_count) {
  if (byte_count == 0) return;
  bool repair = bytes[0] & 1;
  ++bytes, --byte_count;
  BakedFile file(byte_count);
  if (byte_count > 0) std::memcpy(file.data(), bytes, byte_count);
  if (repair && byte_count >= kTableAt) {
    put_u64(file, kByteCountAt, byte_count);
    fix_checksum(file);
  }
  Scene scene;
  if (!baked_open(file.data(), file.size(), &scene).ok) return;
  ++fuzz_counts.scenes;
  fuzz_render(scene);
}

}  // namespace pocketray
