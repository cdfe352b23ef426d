#include "import/ply_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "import/import_error.h"

namespace pocketray {
namespace {

enum class PlyFormat { ascii, little_endian, big_endian };

struct PlyType {
  const char *name, *other_name;
  unsigned bytes;
  bool is_float, is_signed;
};
const PlyType kTypes[] = {{"char", "int8", 1, false, true},    {"uchar", "uint8", 1, false, false},
                          {"short", "int16", 2, false, true},  {"ushort", "uint16", 2, false, false},
                          {"int", "int32", 4, false, true},    {"uint", "uint32", 4, false, false},
                          {"float", "float32", 4, true, true}, {"double", "float64", 8, true, true}};

struct PlyProperty {
  const PlyType *count, *value;  // `count` is null except for lists
  bool is_corners;
};
struct PlyElement {
  std::string name;
  std::uint64_t count;
  std::vector<PlyProperty> properties;
};
struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::size_t end = 0;  // where the elements begin
  std::uint64_t vertex_count = 0;
};

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
  bool is_corners = header->elements.back().name == "face" && std::strncmp(fourth, "vertex_ind", 10) == 0;
  header->elements.back().properties.push_back(is_list ? PlyProperty{find_type(second), find_type(third), is_corners}
                                                       : PlyProperty{nullptr, find_type(first), false});
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
    header->format = std::strcmp(name, "binary_little_endian") == 0 ? PlyFormat::little_endian
                     : std::strcmp(name, "binary_big_endian") == 0  ? PlyFormat::big_endian
                                                                    : PlyFormat::ascii;
  }
}

PlyHeader read_header(const Bytes& bytes) {
  constexpr std::size_t kHeaderBytesMax = 65536;
  std::string text(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(std::min(bytes.size(), kHeaderBytesMax)));
  std::size_t end = text.find("end_header");
  if (text.compare(0, 3, "ply") != 0 || end == std::string::npos) fail_import("not a PLY file; export it again");
  PlyHeader header;
  for (std::size_t at = 0; at < end;) {
    std::size_t next = std::min(text.find('\n', at), end) + 1;
    read_line(text.substr(at, next - at), &header);
    at = next;
  }
  const void* line_end = std::memchr(bytes.data() + end, '\n', bytes.size() - end);
  header.end =
      line_end ? static_cast<std::size_t>(static_cast<const std::uint8_t*>(line_end) - bytes.data()) + 1 : bytes.size();
  return header;
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

// Reads the numbers of the body in order.
class PlyNumbers {
 public:
  PlyNumbers(const Bytes& bytes, const PlyHeader& header)
      : at_(bytes.data() + header.end), end_(bytes.data() + bytes.size()), format_(header.format) {}

  // False at the end of the file.
  bool next(const PlyType& type, double* value) {
    if (format_ == PlyFormat::ascii) return next_word(value);
    if (left() < type.bytes) return false;
    std::uint8_t bytes[8];
    std::reverse_copy(at_, at_ + type.bytes, bytes);
    if (format_ == PlyFormat::little_endian) std::reverse(bytes, bytes + type.bytes);
    at_ += type.bytes;
    *value = number(type, bytes);  // assumes a little-endian machine
    return true;
  }
  bool skip(const PlyType& type, std::uint64_t count) {
    double unused;
    if (format_ == PlyFormat::ascii) {
      while (count > 0 && next_word(&unused)) --count;
      return count == 0;
    }
    if (count > left() / type.bytes) return false;
    at_ += count * type.bytes;
    return true;
  }
  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }

 private:
  static double number(const PlyType& type, const std::uint8_t* bytes) {
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
  bool next_word(double* value) {
    while (at_ < end_ && *at_ <= ' ') ++at_;
    char word[32];
    std::size_t length = 0;
    for (; at_<end_&& * at_> ' '; ++at_)
      if (length + 1 < sizeof word) word[length++] = static_cast<char>(*at_);
    word[length] = 0;
    *value = std::strtod(word, nullptr);
    return length > 0;
  }
  const std::uint8_t *at_, *end_;
  PlyFormat format_;
};

// False if the file ends early; the reader decides whether that is an error.
bool check_list(const PlyProperty& property, std::uint64_t element, std::uint64_t vertex_count, PlyNumbers* numbers) {
  double count;
  if (!numbers->next(*property.count, &count)) return false;
  unsigned long long shown = static_cast<unsigned long long>(element);
  if (!(count >= 0) || count > static_cast<double>(numbers->left()) || count != std::floor(count))
    fail_import("list %llu of the PLY file has %g entries; export the file again", shown, count);
  if (!property.is_corners) return numbers->skip(*property.value, static_cast<std::uint64_t>(count));
  if (count == 0) fail_import("face %llu of the PLY file has no corners; remove it or export the file again", shown);
  for (double i = 0; i < count; ++i) {
    double vertex;
    if (!numbers->next(*property.value, &vertex)) return false;
    if (!(vertex >= 0 && vertex < static_cast<double>(vertex_count)))
      fail_import("face %llu of the PLY file uses vertex %g of %llu; export the file again", shown, vertex,
                  static_cast<unsigned long long>(vertex_count));
  }
  return true;
}

}  // namespace

void check_ply(const Bytes& bytes) {
  PlyHeader header = read_header(bytes);
  check_counts(header, bytes.size() - header.end);
  PlyNumbers numbers(bytes, header);
  for (const PlyElement& element : header.elements)
    for (std::uint64_t i = 0; i < element.count && !element.properties.empty(); ++i)
      for (const PlyProperty& property : element.properties) {
        bool there =
            property.count ? check_list(property, i, header.vertex_count, &numbers) : numbers.skip(*property.value, 1);
        if (!there) return;
      }
}

}  // namespace pocketray
