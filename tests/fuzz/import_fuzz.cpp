// An untrusted model file of any supported format.
#ifdef POCKETRAY_HAVE_IMPORT
#include "fuzz/fuzz.h"

POCKETRAY_FUZZ_TARGET(fuzz_import)

namespace pocketray {

void fuzz_import(const std::uint8_t* bytes, std::size_t byte_count) {
  static const std::vector<std::string> endings = import_endings();
  if (byte_count == 0) return;
  fuzz_model(endings[bytes[0] % endings.size()], bytes + 1, byte_count - 1);
}

}  // namespace pocketray
#endif
