// A .pray file in aligned memory, with access to private details of the format, to damage it on purpose.
#pragma once
#include <cstdlib>
#include <cstring>
#include <memory>

#include "scene/baked.h"
#include "scene/baked_layout.h"

class BakedFile {
 public:
  explicit BakedFile(std::size_t size) : size_(size) {
    void* block = nullptr;
    if (posix_memalign(&block, 64, size ? size : 1) != 0) std::abort();
    bytes_.reset(static_cast<std::uint8_t*>(block));
  }
  std::uint8_t* data() const { return bytes_.get(); }
  std::size_t size() const { return size_; }

 private:
  struct Free {
    void operator()(std::uint8_t* p) const { std::free(p); }
  };
  std::unique_ptr<std::uint8_t, Free> bytes_;
  std::size_t size_;
};

inline BakedFile bake(const pocketray::Scene& scene) {
  BakedFile file(pocketray::baked_size(scene));
  pocketray::baked_write(scene, file.data());
  return file;
}

// Offsets in the file: version, checksum, byte count, section count, section table.
constexpr std::size_t kVersionAt = 8, kChecksumAt = 12, kByteCountAt = 16, kSectionCountAt = 24, kTableAt = 64;
constexpr std::size_t kSectionBytes = 24;  // kind, element bytes, offset (64 bits), count, reserved

inline void put_u32(const BakedFile& file, std::size_t at, std::uint32_t value) {
  std::memcpy(file.data() + at, &value, 4);
}
inline void put_u64(const BakedFile& file, std::size_t at, std::uint64_t value) {
  std::memcpy(file.data() + at, &value, 8);
}

// Makes the checksum match again, as an attacker would.
inline void fix_checksum(const BakedFile& file) {
  std::uint32_t version;
  std::memcpy(&version, file.data() + kVersionAt, sizeof version);
  put_u32(file, kChecksumAt, pocketray::baked_checksum(version, file.data(), file.size()));
}
