// Reads .pray files into memory, without the levels of textures for which it has no room.
#pragma once
#include <functional>
#include <string>

#include "base/arena.h"
#include "base/status.h"
#include "scene/content_hash.h"
#include "scene/scene.h"

namespace pocketray {

// A file's bytes, which come in order.
struct ByteSource {
  std::uint64_t byte_count = 0;
  std::function<Status(std::uint8_t* bytes, std::size_t count)> read;  // the next `count` bytes
};
// Bytes in memory, which must outlive the source.
ByteSource bytes_in_memory(const std::uint8_t* bytes, std::size_t byte_count);

// A .pray file in memory. If levels are left out, it is the file as it would be without them.
struct FittedFile {
  std::uint8_t* bytes = nullptr;  // null if it does not fit
  std::size_t byte_count = 0;
  std::uint32_t texture_side_max = kTextureSideMax;  // levels of textures beyond it are left out
  bool is_whole = true;
  ContentHash whole;  // of the source's bytes, if some are left out
};

// Reads a file into the arena, aligned to 64 bytes, without the levels of textures beyond texture_side_max and beyond
// what fits in the arena. baked_open() has to check it: one that is damaged or hostile stays so. A file of another form
// is read as it is.
Status read_fitted(const ByteSource& source, std::uint32_t texture_side_max, Arena* arena, FittedFile* file);

// Bytes of texels that a scene keeps without the levels beyond a side; textures may share texels.
std::uint64_t kept_texel_bytes(Array<const Texture> textures, std::uint32_t texture_side_max);
// The largest power of two below `side` that leaves out more levels; 0 if none does.
std::uint32_t next_smaller_side(Array<const Texture> textures, std::uint32_t side);

// Opens a file and calls read() with its bytes, valid during the call. `name` is not repeated in messages.
Status with_file(const std::string& path, const std::function<Status(const ByteSource& source)>& read);

}  // namespace pocketray
