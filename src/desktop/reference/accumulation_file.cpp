// The file of an accumulation, little-endian behind the picture: magic, key, ranges of each row, sums, hash of all that
// precedes. Whatever a file holds, reading it ends with an accumulation or an error.
#include <algorithm>
#include <cstdio>
#include <cstring>

#include "base/check.h"
#include "base/float_bits.h"
#include "base/limits.h"
#include "desktop/reference/accumulation.h"
#include "scene/content_hash.h"

namespace pocketray {
namespace {

constexpr char kMagic[] = "\npocketray reference 1\n";
constexpr std::size_t kMagicBytes = sizeof kMagic - 1, kHashBytes = 16;
constexpr std::uint32_t kKeyBytesMax = 1 << 16;

std::vector<Vec3> mean_of_both(const Accumulation& a) {
  std::vector<Vec3> mean = mean_of_half(a, 0), other = mean_of_half(a, 1);
  for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = mean[i] * 0.5f + other[i] * 0.5f;
  return mean;
}

void put(std::uint64_t value, std::size_t byte_count, std::vector<std::uint8_t>* bytes) {
  for (std::size_t i = 0; i < byte_count; ++i) bytes->push_back(static_cast<std::uint8_t>(value >> 8 * i));
}
void put_float(float value, std::vector<std::uint8_t>* bytes) { put(float_bits(value), 4, bytes); }
void put_text(const char* text, std::size_t byte_count, std::vector<std::uint8_t>* bytes) {
  bytes->insert(bytes->end(), text, text + byte_count);
}

// Reads from bytes that may be truncated: past the end, it reads zeros and records that.
struct Reader {
  const std::uint8_t* at;
  std::size_t left;
  bool ok = true;

  const std::uint8_t* take(std::size_t byte_count) {
    if (byte_count > left) ok = false, left = 0;
    if (!ok) return nullptr;
    const std::uint8_t* taken = at;
    at += byte_count, left -= byte_count;
    return taken;
  }
  std::uint64_t number(std::size_t byte_count) {
    const std::uint8_t* taken = take(byte_count);
    std::uint64_t value = 0;
    for (std::size_t i = 0; taken && i < byte_count; ++i) value |= std::uint64_t(taken[i]) << 8 * i;
    return value;
  }
  bool matches(const char* text, std::size_t byte_count) {
    const std::uint8_t* taken = take(byte_count);
    return ok = taken && std::memcmp(taken, text, byte_count) == 0;
  }
};

// Header "PF\nWIDTH HEIGHT\n-1.0\n", as we write it.
bool read_header(Reader* reader, std::uint32_t* width, std::uint32_t* height) {
  char text[40] = {}, again[40];
  std::memcpy(text, reader->at, std::min(reader->left, sizeof text - 1));
  if (std::sscanf(text, "PF\n%5u %5u\n-1.0", width, height) != 2) return false;
  if (*width < 1 || *width > kImageSideMax || *height < 1 || *height > kImageSideMax) return false;
  int length = std::snprintf(again, sizeof again, "PF\n%u %u\n-1.0\n", *width, *height);
  return reader->matches(again, static_cast<std::size_t>(length));
}

bool read_set(Reader* reader, SampleSet* set) {
  std::uint64_t count = reader->number(4);
  std::uint32_t end = 0;
  for (std::uint64_t i = 0; reader->ok && i < count; ++i) {
    auto begin = static_cast<std::uint32_t>(reader->number(4));
    bool touches = i > 0 && begin <= end;
    end = static_cast<std::uint32_t>(reader->number(4));
    if (touches || begin >= end || end > kReferenceSampleMax) return false;
    set->push_back({begin, end});
  }
  return reader->ok;
}

bool read_sums(Reader* reader, Accumulation* a) {
  std::string key = a->key;
  std::vector<SampleSet> rows = a->rows;
  if (reader->left != std::uint64_t(kReferenceHalfCount) * a->width * a->height * 3 * sizeof(ExactSum)) return false;
  *a = empty_accumulation(key, a->width, a->height);
  a->rows = rows;
  for (std::vector<ExactSum>& half : a->sums)
    for (ExactSum& sum : half) sum.low = reader->number(8), sum.high = reader->number(8);
  return reader->ok;
}

bool read_behind_picture(Reader* reader, Accumulation* a) {
  auto key_bytes = static_cast<std::uint32_t>(reader->number(4));
  if (key_bytes > kKeyBytesMax) return false;
  const std::uint8_t* key = reader->take(key_bytes);
  if (!key) return false;
  a->key.assign(key, key + key_bytes);
  a->rows.resize(a->height);
  for (SampleSet& row : a->rows)
    if (!read_set(reader, &row)) return false;
  return read_sums(reader, a);
}

}  // namespace

std::vector<std::uint8_t> encode_accumulation(const Accumulation& a) {
  CHECK_LE(a.key.size(), kKeyBytesMax);
  CHECK_EQ(a.rows.size(), a.height);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(std::size_t(a.width) * a.height * (sizeof(Vec3) + kReferenceHalfCount * 3 * sizeof(ExactSum)) + 4096);
  char header[40];
  put_text(header,
           static_cast<std::size_t>(std::snprintf(header, sizeof header, "PF\n%u %u\n-1.0\n", a.width, a.height)),
           &bytes);
  std::vector<Vec3> mean = mean_of_both(a);
  for (std::uint32_t row = a.height; row-- > 0;)  // bottom row first
    for (std::uint32_t x = 0; x < a.width; ++x)
      for (int c = 0; c < 3; ++c) put_float(mean[std::size_t(row) * a.width + x][c], &bytes);
  put_text(kMagic, kMagicBytes, &bytes);
  put(a.key.size(), 4, &bytes);
  put_text(a.key.data(), a.key.size(), &bytes);
  for (const SampleSet& row : a.rows) {
    put(row.size(), 4, &bytes);
    for (const SampleRange& range : row) put(range.begin, 4, &bytes), put(range.end, 4, &bytes);
  }
  for (const std::vector<ExactSum>& half : a.sums)
    for (const ExactSum& sum : half) put(sum.low, 8, &bytes), put(sum.high, 8, &bytes);
  ContentHash hash = content_hash(bytes.data(), bytes.size());
  put(hash.low, 8, &bytes), put(hash.high, 8, &bytes);
  return bytes;
}

Status decode_accumulation(const std::uint8_t* bytes, std::size_t byte_count, Accumulation* a) {
  CHECK(bytes != nullptr && a != nullptr);
  *a = Accumulation();
  Reader reader = {bytes, byte_count};
  if (!read_header(&reader, &a->width, &a->height)) return failure("is not a picture of linear light (.pfm)");
  (void)reader.take(std::size_t(a->width) * a->height * sizeof(Vec3));
  if (!reader.matches(kMagic, kMagicBytes))
    return failure("is a picture without its samples: name a whole file that `pocketray reference` wrote");
  Reader hash = {bytes, byte_count};
  (void)hash.take(byte_count - std::min(byte_count, kHashBytes));
  ContentHash expected = content_hash(bytes, byte_count - std::min(byte_count, kHashBytes)), there;
  there.low = hash.number(8), there.high = hash.number(8);
  bool whole = hash.ok && there == expected && reader.left >= kHashBytes;
  if (whole) {
    reader.left -= kHashBytes;
    whole = read_behind_picture(&reader, a);
  }
  return whole ? success() : failure("is damaged: remove it, or take another copy");
}

}  // namespace pocketray
