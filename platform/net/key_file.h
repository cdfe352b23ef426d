// The key shared by a device and its render servers: 256 random bits in a file of one line, readable only by its
// owner,
//
//     pocketray-key-1:<64 hexadecimal digits>
#pragma once
#include <cstddef>

#include "platform/file.h"

namespace platform {

struct SharedKey {
  static constexpr std::size_t kByteCount = 32;
  unsigned char bytes[kByteCount] = {};
};

// Writes a key to a new file of mode 0600. Fails if anything of that name exists.
bool create_key_file(const char* path, const SharedKey& key, FileError* error);
// Fails if others than the owner have any access to the file, or if it is not a key file.
bool read_key_file(const char* path, SharedKey* key, FileError* error);

// Overwrites secret bytes before their memory is reused; not optimised away.
void wipe(void* bytes, std::size_t byte_count);

}  // namespace platform
