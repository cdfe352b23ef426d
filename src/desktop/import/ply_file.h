// The header of a PLY file, and the numbers that follow it.
#pragma once
#include <string>
#include <vector>

#include "desktop/import/files.h"

namespace pocketray {

enum class PlyFormat { ascii, little_endian, big_endian };

struct PlyType {
  const char *name, *other_name;
  unsigned bytes;
  bool is_float, is_signed;
};

struct PlyProperty {
  std::string name;
  const PlyType *count, *value;  // `count` is null except for lists
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
  std::vector<std::string> textures;  // named in comments, as MeshLab does
  bool is_upright = false;            // Y is up: written by the programs of Stanford's scanning repository
};

// Throws an ImportError if the header is damaged or states more elements than the file can hold.
PlyHeader read_ply_header(const Bytes& bytes);

// Reads the numbers of the body in order. Throws an ImportError if the file ends or a word is not a number.
class PlyNumbers {
 public:
  PlyNumbers(const Bytes& bytes, const PlyHeader& header)
      : at_(bytes.data() + header.end), end_(bytes.data() + bytes.size()), format_(header.format) {}

  double next(const PlyType& type);
  void skip(const PlyType& type, std::uint64_t count);
  // Returns the length of the next list, at most the bytes left. `list` counts the element's lists, for errors.
  std::uint64_t next_count(const PlyType& type, std::uint64_t list);

 private:
  double next_word();
  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }

  const std::uint8_t *at_, *end_;
  PlyFormat format_;
};

}  // namespace pocketray
