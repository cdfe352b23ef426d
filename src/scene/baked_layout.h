// Header and table of sections of a .pray file, for what reads or writes its bytes.
#pragma once
#include <cstddef>
#include <cstdint>

#include "scene/baked.h"

namespace pocketray {

constexpr std::uint64_t kSectionAlignment = 64;
inline constexpr std::uint8_t kMagic[8] = {0x89, 'P',  'R',  'A',
                                           'Y',  '\r', '\n', 0x1A};  // as PNG: text-mode copies damage it

struct FileHeader {
  std::uint8_t magic[8];
  std::uint32_t version;
  std::uint32_t checksum;  // baked_checksum() of everything after this field
  std::uint64_t byte_count;
  std::uint32_t section_count;
  std::uint32_t reserved[9];  // zero
};
static_assert(sizeof(FileHeader) == 64, "no padding");
constexpr std::size_t kChecksumBegin = 16;
constexpr std::uint32_t kJoinedSumVersion = 21;  // first to have joined_sum() as its checksum, not CRC-32

// The checksum that a file of this version has in its header. `bytes` is aligned to 4.
std::uint32_t baked_checksum(std::uint32_t version, const std::uint8_t* bytes, std::size_t byte_count,
                             const ParallelLoop& loop = {});

struct Section {
  std::uint32_t kind, element_bytes;
  std::uint64_t offset;  // from the start of the file
  std::uint32_t count, reserved;
};
static_assert(sizeof(Section) == 24, "no padding");

constexpr std::uint32_t kArrayCount = 52;
constexpr std::uint32_t kSectionCount = 1 + kArrayCount;  // kind 0 is SceneInfo
constexpr std::uint32_t kTexturesSection = 7, kTexelsSection = 8;

constexpr std::uint64_t aligned(std::uint64_t offset) {
  return (offset + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
}
constexpr std::uint64_t first_offset(std::uint32_t section_count) {
  return aligned(sizeof(FileHeader) + section_count * sizeof(Section));
}
// Older files lack the last arrays.
constexpr std::uint32_t section_count_of(std::uint32_t version) {
  return version < 8    ? 33
         : version < 9  ? 35
         : version < 10 ? 37
         : version < 11 ? 38
         : version < 12 ? 40
         : version < 13 ? 41
         : version < 14 ? 44
         : version < 15 ? 45
         : version < 17 ? 46
         : version < 18 ? 47
         : version < 19 ? 48
         : version < 20 ? 52
                        : kSectionCount;
}

}  // namespace pocketray
