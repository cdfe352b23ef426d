#include "session/baked_file.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "base/check.h"
#include "platform/file.h"
#include "scene/baked_layout.h"
#include "scene/checksum.h"
#include "scene/texel_blocks.h"
#include "scene/texture_side.h"

namespace pocketray {
namespace {

// Words of texels, from begin up to end.
struct Run {
  std::uint32_t begin, end;
};

// The words that textures read, in order and without overlaps, if they lose their levels beyond a side.
std::vector<Run> kept_runs(Array<const Texture> textures, std::uint32_t side_max) {
  std::vector<Run> runs, merged;
  for (const Texture& texture : textures) {
    const Texture t = without_levels_beyond(texture, side_max);
    runs.push_back({t.texel_begin, t.texel_begin + level_words(t.format, t.width, t.height, t.level_count)});
  }
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.begin < b.begin; });
  for (const Run& run : runs) {
    if (!merged.empty() && run.begin <= merged.back().end)
      merged.back().end = std::max(merged.back().end, run.end);
    else
      merged.push_back(run);
  }
  return merged;
}

std::uint64_t word_count(const std::vector<Run>& runs) {
  std::uint64_t count = 0;
  for (const Run& run : runs) count += run.end - run.begin;
  return count;
}

// Place of a kept word among the kept ones.
std::uint32_t place_of(std::uint32_t word, const std::vector<Run>& runs) {
  std::uint32_t before = 0;
  for (const Run& run : runs) {
    if (word <= run.end) return before + (word - run.begin);
    before += run.end - run.begin;
  }
  CHECK(!runs.empty());
  return before;
}

// Hands the source's bytes on. Once some are to be left out, sums them up: only a whole file can be summed up later.
class Intake {
 public:
  explicit Intake(const ByteSource& source) : source_(source) {}

  std::uint64_t left() const { return source_.byte_count - come_; }
  Status read(std::uint8_t* bytes, std::uint64_t count) {
    CHECK_LE(count, left());
    RETURN_IF_ERROR(source_.read(bytes, static_cast<std::size_t>(count)));
    come_ += count;
    if (!part_.empty()) sum_up(bytes, static_cast<std::size_t>(count));
    return success();
  }
  // `bytes` are all those read so far, the header and more.
  void begin_sums(std::uint32_t version, const std::uint8_t* bytes) {
    CHECK(part_.empty());
    is_joined_ = version >= kJoinedSumVersion;
    part_.resize(kPartBytes);
    sum_up(bytes, static_cast<std::size_t>(come_));
  }
  Status skip(std::uint64_t count) {
    std::uint8_t bytes[4096];
    for (std::uint64_t step; count > 0; count -= step) {
      step = std::min<std::uint64_t>(count, sizeof bytes);
      RETURN_IF_ERROR(read(bytes, step));
    }
    return success();
  }
  void end_sums(std::uint32_t* checksum, ContentHash* hash) {
    take_part();
    *checksum = checksum_, *hash = hash_end(hasher_);
  }

 private:
  static constexpr std::size_t kPartBytes = kChecksumBlockBytes;  // a multiple of 16, as hash_part() needs it

  void sum_up(const std::uint8_t* bytes, std::size_t count) {
    for (std::size_t step; count > 0; bytes += step, count -= step) {
      step = std::min(count, kPartBytes - part_count_);
      std::memcpy(part_.data() + part_count_, bytes, step);
      part_count_ += step;
      if (part_count_ == kPartBytes) take_part();
    }
  }
  void take_part() {
    if (part_count_ == 0) return;
    const std::size_t begin = hasher_.byte_count == 0 ? kChecksumBegin : 0;
    CHECK_LE(begin, part_count_);
    const std::uint8_t* bytes = part_.data() + begin;
    const std::size_t count = part_count_ - begin;
    checksum_ = is_joined_ ? join_sums(checksum_, block_sum(bytes, count))
                           : static_cast<std::uint32_t>(crc32_z(checksum_, bytes, count));
    hash_part(&hasher_, part_.data(), std::exchange(part_count_, 0));
  }

  const ByteSource& source_;
  std::uint64_t come_ = 0;
  bool is_joined_ = true;  // as baked_checksum()
  std::uint32_t checksum_ = 0;
  ContentHasher hasher_;
  std::vector<std::uint8_t> part_;
  std::size_t part_count_ = 0;
};

// A file on its way into the arena.
struct Fitting {
  Intake intake;
  std::uint64_t byte_count;  // of the source
  Arena* arena;
  std::size_t mark;
  std::uint8_t* bytes = nullptr;
  std::uint64_t read_count = 0;
};

// Takes memory for that many bytes in all; those that have been read stay. Returns false if there is too little.
bool take(std::uint64_t byte_count, Fitting* f) {
  arena_release(f->arena, f->mark);
  f->bytes = static_cast<std::uint8_t*>(arena_try_allocate(f->arena, byte_count));
  return f->bytes != nullptr;
}

// Reads up to that byte of the file.
Status read_up_to(std::uint64_t end, Fitting* f) {
  CHECK_LE(f->read_count, end);
  RETURN_IF_ERROR(f->intake.read(f->bytes + f->read_count, end - f->read_count));
  f->read_count = end;
  return success();
}

Status read_rest(Fitting* f, FittedFile* file) {
  if (!take(f->byte_count, f)) return success();
  RETURN_IF_ERROR(read_up_to(f->byte_count, f));
  file->bytes = f->bytes, file->byte_count = static_cast<std::size_t>(f->byte_count);
  return success();
}

Section section_of(const std::uint8_t* bytes, std::uint32_t kind) {
  Section section;
  std::memcpy(&section, bytes + sizeof(FileHeader) + kind * sizeof section, sizeof section);
  return section;
}
std::uint64_t end_of(const Section& section) {
  return section.offset + std::uint64_t(section.count) * section.element_bytes;
}

bool has_form(const FileHeader& header, std::uint64_t byte_count) {
  return std::memcmp(header.magic, kMagic, sizeof kMagic) == 0 && header.version >= kBakedVersionMin &&
         header.version <= kBakedVersion && header.byte_count == byte_count &&
         header.section_count == section_count_of(header.version) && byte_count >= first_offset(header.section_count);
}

// Returns whether each section follows the one before, and textures and texels are ours.
bool sections_follow(const std::uint8_t* bytes, std::uint32_t section_count, std::uint64_t byte_count) {
  std::uint64_t next = first_offset(section_count);
  for (std::uint32_t kind = 0; kind < section_count; ++kind) {
    const Section section = section_of(bytes, kind);
    if (section.offset != next || end_of(section) > byte_count) return false;
    next = aligned(end_of(section));
  }
  return next == byte_count && section_of(bytes, kTexturesSection).element_bytes == sizeof(Texture) &&
         section_of(bytes, kTexelsSection).element_bytes == sizeof(std::uint32_t);
}

// Returns whether a texture's levels are its own and in the file.
bool is_sound(const Texture& t, std::uint32_t texel_count) {
  if (t.width < 1 || t.height < 1 || t.width > kTextureSideMax || t.height > kTextureSideMax) return false;
  if (static_cast<int>(t.format) >= kTexelFormatCount || t.level_count < 1 ||
      t.level_count > level_count_max(t.width, t.height))
    return false;
  const std::uint32_t words = level_words(t.format, t.width, t.height, t.level_count);
  return t.texel_begin <= texel_count && words <= texel_count - t.texel_begin;
}

// States where textures and sections lie without the words that are not in `runs`. A file that was damaged stays
// damaged.
void restate(const std::vector<Run>& runs, std::uint32_t side_max, std::uint64_t byte_count, bool is_damaged,
             std::uint8_t* bytes) {
  FileHeader header;
  std::memcpy(&header, bytes, sizeof header);
  const Section textures = section_of(bytes, kTexturesSection);
  auto* table = reinterpret_cast<Texture*>(bytes + textures.offset);
  for (std::uint32_t i = 0; i < textures.count; ++i) {
    table[i] = without_levels_beyond(table[i], side_max);
    table[i].texel_begin = place_of(table[i].texel_begin, runs);
  }
  std::uint64_t shift = 0;
  for (std::uint32_t kind = kTexelsSection; kind < header.section_count; ++kind) {
    Section section = section_of(bytes, kind);
    section.offset -= shift;
    if (kind == kTexelsSection) {
      const std::uint64_t before = aligned(end_of(section));
      section.count = static_cast<std::uint32_t>(word_count(runs));
      shift = before - aligned(end_of(section));
    }
    std::memcpy(bytes + sizeof header + kind * sizeof section, &section, sizeof section);
  }
  header.byte_count = byte_count;
  std::memcpy(bytes, &header, sizeof header);
  header.checksum = baked_checksum(header.version, bytes, static_cast<std::size_t>(byte_count));
  header.checksum ^= is_damaged;
  std::memcpy(bytes, &header, sizeof header);
}

// Reads the texels of `runs` and the sections after them.
Status read_without(const std::vector<Run>& runs, std::uint32_t side_max, std::uint64_t kept_bytes, Fitting* f,
                    FittedFile* file) {
  const Section texels = section_of(f->bytes, kTexelsSection);
  CHECK_EQ(f->read_count, texels.offset);
  FileHeader header;
  std::memcpy(&header, f->bytes, sizeof header);
  f->intake.begin_sums(header.version, f->bytes);
  std::uint8_t* to = f->bytes + texels.offset;
  std::uint32_t word = 0;
  for (const Run& run : runs) {
    RETURN_IF_ERROR(f->intake.skip(4 * std::uint64_t(run.begin - word)));
    RETURN_IF_ERROR(f->intake.read(to, 4 * std::uint64_t(run.end - run.begin)));
    to += 4 * std::size_t(run.end - run.begin), word = run.end;
  }
  RETURN_IF_ERROR(f->intake.skip(aligned(end_of(texels)) - texels.offset - 4 * std::uint64_t(word)));
  const std::uint64_t place = static_cast<std::uint64_t>(to - f->bytes);
  std::memset(to, 0, static_cast<std::size_t>(aligned(place) - place));
  CHECK_EQ(aligned(place) + f->intake.left(), kept_bytes);
  RETURN_IF_ERROR(f->intake.read(f->bytes + aligned(place), f->intake.left()));
  std::uint32_t checksum;
  f->intake.end_sums(&checksum, &file->whole);
  restate(runs, side_max, kept_bytes, checksum != header.checksum, f->bytes);
  file->bytes = f->bytes, file->byte_count = static_cast<std::size_t>(kept_bytes);
  file->is_whole = false;
  return success();
}

}  // namespace

ByteSource bytes_in_memory(const std::uint8_t* bytes, std::size_t byte_count) {
  std::size_t at = 0;
  return {byte_count, [=](std::uint8_t* to, std::size_t count) mutable {
            CHECK_LE(count, byte_count - at);
            std::memcpy(to, bytes + at, count);
            at += count;
            return success();
          }};
}

std::uint64_t kept_texel_bytes(Array<const Texture> textures, std::uint32_t texture_side_max) {
  return 4 * word_count(kept_runs(textures, texture_side_max));
}

std::uint32_t next_smaller_side(Array<const Texture> textures, std::uint32_t side) {
  for (std::uint32_t smaller = kTextureSideMax; smaller > 0; smaller /= 2)
    if (smaller < side && any_levels_beyond(textures, smaller)) return smaller;
  return 0;
}

Status read_fitted(const ByteSource& source, std::uint32_t texture_side_max, Arena* arena, FittedFile* file) {
  CHECK(arena != nullptr && file != nullptr);
  *file = FittedFile();
  file->texture_side_max = texture_side_max;
  Fitting f = {Intake(source), source.byte_count, arena, arena_mark(*arena)};
  const std::size_t room = arena_free(*arena);
  if (texture_side_max == kTextureSideMax && source.byte_count <= room) return read_rest(&f, file);
  FileHeader header;
  if (source.byte_count < sizeof header || !take(sizeof header, &f)) return read_rest(&f, file);
  RETURN_IF_ERROR(read_up_to(sizeof header, &f));
  std::memcpy(&header, f.bytes, sizeof header);
  if (!has_form(header, source.byte_count) || !take(first_offset(header.section_count), &f)) return read_rest(&f, file);
  RETURN_IF_ERROR(read_up_to(first_offset(header.section_count), &f));
  const Section table = section_of(f.bytes, kTexturesSection), texels = section_of(f.bytes, kTexelsSection);
  if (!sections_follow(f.bytes, header.section_count, source.byte_count) || !take(texels.offset, &f))
    return read_rest(&f, file);
  RETURN_IF_ERROR(read_up_to(texels.offset, &f));
  const Array<const Texture> textures = {reinterpret_cast<const Texture*>(f.bytes + table.offset), table.count};
  if (!std::all_of(textures.begin(), textures.end(),
                   [&](const Texture& texture) { return is_sound(texture, texels.count); }))
    return read_rest(&f, file);
  const std::uint64_t others = source.byte_count - (aligned(end_of(texels)) - texels.offset);
  for (std::uint32_t side = texture_side_max; side > 0; side = next_smaller_side(textures, side)) {
    const bool is_less = any_levels_beyond(textures, side);
    const std::vector<Run> runs = kept_runs(textures, side);
    const std::uint64_t bytes = is_less ? others + aligned(4 * word_count(runs)) : source.byte_count;
    if (bytes > room) continue;
    if (!is_less) return read_rest(&f, file);
    file->texture_side_max = side;
    return take(bytes, &f) ? read_without(runs, side, bytes, &f, file) : success();
  }
  return success();
}

Status with_file(const std::string& path, const std::function<Status(const ByteSource& source)>& read) {
  platform::FileReader reader;
  platform::FileError error;
  if (!platform::open_reader(path.c_str(), &reader, &error)) return failure("%s", error.text);
  CHECK(read != nullptr);
  const Status status =
      read({reader.byte_count, [&](std::uint8_t* bytes, std::size_t count) {
              return platform::read_bytes(&reader, bytes, count, &error) ? success() : failure("%s", error.text);
            }});
  platform::close_reader(&reader);
  return status;
}

}  // namespace pocketray
