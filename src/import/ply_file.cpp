#include "import/ply_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "import/import_error.h"

namespace pocketray {
namespace {

const PlyType kTypes[] = {{"char", "int8", 1, false, true},    {"uchar", "uint8", 1, false, false},
                          {"short", "int16", 2, false, true},  {"ushort", "uint16", 2, false, false},
                          {"int", "int32", 4, false, true},    {"uint", "uint32", 4, false, false},
                          {"float", "float32", 4, true, true}, {"double", "float64", 8, true, true}};

const PlyType* find_type(const char* name) {
  for (const PlyType& type : kTypes)
    if (std::strcmp(name, type.name) == 0 || std::strcmp(name, type.other_name) == 0) return &type;
  fail_import("the PLY header has a property of unknown type '%.40s'; export the file again", name);
}

void add_property(const std::string& line, PlyHeader* header) {
  char first[64] = "", second[64] = "", third[64] = "", fourth[64] = "";
  int words = std::sscanf(line.c_str(), "property %63s %63s %63s %63s", first, second, third, fourth);
  bool is_list = std::strcmp(first, "list") == 0;
  if (words < (is_list ? 4 : 2) || header->elements.empty())
    fail_import("the PLY header has an incomplete property; export the file again");
  header->elements.back().properties.push_back(is_list ? PlyProperty{fourth, find_type(second), find_type(third)}
                                                       : PlyProperty{second, nullptr, find_type(first)});
}

PlyFormat format_of(const char* name) {
  if (std::strcmp(name, "ascii") == 0) return PlyFormat::ascii;
  if (std::strcmp(name, "binary_little_endian") == 0) return PlyFormat::little_endian;
  if (std::strcmp(name, "binary_big_endian") == 0) return PlyFormat::big_endian;
  fail_import("the PLY header has the unknown format '%.40s'; export the file again", name);
}

void read_line(const std::string& line, PlyHeader* header) {
  char name[64] = "";
  unsigned long long count = 0;
  if (std::sscanf(line.c_str(), "element %63s %20llu", name, &count) == 2) {
    header->elements.push_back({name, count, {}});
    if (std::strcmp(name, "vertex") == 0) header->vertex_count = count;
  } else if (line.compare(0, 9, "property ") == 0) {
    add_property(line, header);
  } else if (std::sscanf(line.c_str(), "format %63s", name) == 1) {
    header->format = format_of(name);
  } else if (line.compare(0, 19, "comment TextureFile") == 0) {
    header->names_texture = true;
  }
}

// Every element needs at least a byte per property.
void check_counts(const PlyHeader& header, std::uint64_t left) {
  for (const PlyElement& element : header.elements)
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      if (element.count > left)
        fail_import("the PLY header states %llu elements, more than the file holds; copy the file again",
                    static_cast<unsigned long long>(element.count));
      left -= element.count;
    }
}

// Assumes a little-endian machine.
double number(const PlyType& type, const std::uint8_t* bytes) {
  if (type.is_float) {
    float single;
    double both;
    std::memcpy(&single, bytes, 4);
    if (type.bytes == 4) return static_cast<double>(single);
    std::memcpy(&both, bytes, 8);
    return both;
  }
  std::uint32_t word = 0;
  std::memcpy(&word, bytes, type.bytes);
  std::uint32_t sign = type.is_signed ? 1u << (8 * type.bytes - 1) : 0;
  return static_cast<double>(static_cast<std::int64_t>(word ^ sign) - static_cast<std::int64_t>(sign));
}

[[noreturn]] void fail_at_end() { fail_import("the PLY file ends too early; copy it again"); }

}  // namespace

PlyHeader read_ply_header(const Bytes& bytes) {
  constexpr std::size_t kHeaderBytesMax = 65536;
  std::string text(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(std::min(bytes.size(), kHeaderBytesMax)));
  if (text.compare(0, 3, "ply") != 0) fail_import("not a PLY file; export it again");
  // All lines end as the first does: the byte after the header may itself be a line feed.
  std::string line_end = text.compare(3, 2, "\r\n") == 0 ? "\r\n" : text.compare(3, 1, "\r") == 0 ? "\r" : "\n";
  PlyHeader header;
  for (std::size_t at = 0;;) {
    std::size_t next = text.find(line_end, at);
    std::string line = text.substr(at, next - at);
    bool last = line.compare(0, 10, "end_header") == 0;
    if (!last && next == std::string::npos) fail_import("the PLY header has no end_header; export the file again");
    at = next == std::string::npos ? text.size() : next + line_end.size();
    if (last) {
      header.end = at;
      check_counts(header, bytes.size() - header.end);
      return header;
    }
    read_line(line, &header);
  }
}

double PlyNumbers::next(const PlyType& type) {
  if (format_ == PlyFormat::ascii) return next_word();
  if (left() < type.bytes) fail_at_end();
  std::uint8_t bytes[8];
  std::reverse_copy(at_, at_ + type.bytes, bytes);
  if (format_ == PlyFormat::little_endian) std::reverse(bytes, bytes + type.bytes);
  at_ += type.bytes;
  return number(type, bytes);
}

void PlyNumbers::skip(const PlyType& type, std::uint64_t count) {
  if (format_ == PlyFormat::ascii) {
    for (; count > 0; --count) next_word();
    return;
  }
  if (count > left() / type.bytes) fail_at_end();
  at_ += count * type.bytes;
}

std::uint64_t PlyNumbers::next_count(const PlyType& type, std::uint64_t list) {
  double count = next(type);
  if (!(count >= 0) || count > static_cast<double>(left()) || count != std::floor(count))
    fail_import("list %llu of the PLY file has %g entries; export the file again",
                static_cast<unsigned long long>(list), count);
  return static_cast<std::uint64_t>(count);
}

double PlyNumbers::next_word() {
  while (at_ < end_ && *at_ <= ' ') ++at_;
  char word[64];
  std::size_t length = 0;
  for (; at_ < end_; ++at_) {
    if (*at_ <= ' ') break;
    if (length + 1 < sizeof word) word[length++] = static_cast<char>(*at_);
  }
  word[length] = 0;
  if (length == 0) fail_at_end();
  char* end;
  double value = std::strtod(word, &end);
  if (*end != 0) fail_import("the PLY file has '%.40s' instead of a number; export the file again", word);
  return value;
}

}  // namespace pocketray
