#include "desktop/import/obj_file.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "base/limits.h"
#include "desktop/import/import_error.h"
#include "desktop/import/obj_lines.h"

namespace pocketray {
namespace {

constexpr float kFloatMax = std::numeric_limits<float>::max(), kNan = std::numeric_limits<float>::quiet_NaN();

class Reader {
 public:
  Reader(const SceneBuilder& builder, ObjFile* file) : builder_(builder), file_(*file) {}

  void read(ObjLine* line) {
    ObjWord key;
    if (!line->next(&key)) return;
    if (key.is("v")) return read_vertex(line);
    if (key.is("f")) return read_face(line);
    if (key.is("vt")) return read_values(line, 1, 2, kCoordinateMax, &file_.uvs);
    if (key.is("vn")) return read_values(line, 3, 3, kFloatMax, &file_.normals);
    if (key.is("g") || key.is("o")) return begin_shape(line->rest());
    if (key.is("usemtl")) return use_material(line->rest());
    if (key.is("s")) return begin_group(line);
    if (key.is("mtllib")) return name_file(line->rest());
    if (key.is("l")) file_.has_lines = true;
    if (key.is("p")) file_.has_points = true;
    if (!key.is("l") && !key.is("p")) name_unknown(key.text());
  }
  void end() {
    if (!file_.shapes.empty()) file_.shapes.back().face_end = file_.faces.size();
  }

 private:
  // Returns a number, or NaN if it is not finite or too large.
  float value(const ObjLine& line, const ObjWord& word, float limit) const {
    float number;
    if (!builder_.options.strict && read_number(word, &number) && !(std::fabs(number) <= limit)) return kNan;
    if (!builder_.options.strict && is_not_finite(word)) return kNan;
    return line.number(word, limit);
  }

  double coordinate(const ObjLine& line, const ObjWord& word) const {
    double number;
    const bool is_valid = read_number(word, &number) && std::fabs(number) <= static_cast<double>(kCoordinateMax);
    return is_valid ? number : static_cast<double>(value(line, word, kCoordinateMax));
  }

  void read_vertex(ObjLine* line) {
    double place[3] = {};
    float values[7] = {};
    int count = 0;
    ObjWord word;
    for (; line->next(&word); ++count) {
      if (count < 3)
        place[count] = coordinate(*line, word);
      else if (count < 7)
        values[count] = value(*line, word, kFloatMax);
    }
    if (count < 3) line->refuse("a vertex has three coordinates");
    file_.positions.insert(file_.positions.end(), place, place + 3);
    // x y z r g b, or x y z w r g b
    const float* color = count >= 7 ? values + 4 : values + 3;
    if (count >= 6) file_.colors.insert(file_.colors.end(), color, color + 3);
  }

  void read_values(ObjLine* line, int count_min, int count, float limit, std::vector<float>* values) {
    float all[3] = {0, 0, 0};
    int given = 0;
    ObjWord word;
    for (; line->next(&word); ++given) {
      const float number = value(*line, word, limit);
      if (given < count) all[given] = std::isfinite(number) ? number : 0;
    }
    if (given < count_min) line->refuse("numbers are missing");
    values->insert(values->end(), all, all + count);
  }

  // Index into a list of `count` elements, counted from 1, or from its end if negative.
  std::int32_t index(const ObjLine& line, const char*& at, const char* end, std::size_t count) const {
    const char* begin = at;
    const bool negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+')) ++at;
    std::int64_t number = 0;
    const char* digits = at;
    for (; at < end && *at >= '0' && *at <= '9' && number <= 0x7FFFFFFF; ++at) number = 10 * number + (*at - '0');
    const bool valid = at > digits && number > 0 && number <= 0x7FFFFFFF && (at == end || *at == '/');
    if (!valid || (negative && number > static_cast<std::int64_t>(count)))
      line.refuse("'" + std::string(begin, std::min(end, begin + 40)) + "' is not a vertex of a face");
    return static_cast<std::int32_t>(negative ? static_cast<std::int64_t>(count) - number : number - 1);
  }

  // position, position/uv, position//normal or position/uv/normal
  ObjCorner corner(const ObjLine& line, const ObjWord& word) const {
    ObjCorner made = {0, kNoElement, kNoElement};
    const char* at = word.begin;
    made.position = index(line, at, word.end, file_.positions.size() / 3);
    if (at < word.end && ++at < word.end && *at != '/') made.uv = index(line, at, word.end, file_.uvs.size() / 2);
    if (at < word.end && ++at < word.end) made.normal = index(line, at, word.end, file_.normals.size() / 3);
    return made;
  }

  void read_face(ObjLine* line) {
    if (file_.shapes.empty()) begin_shape("");
    const std::size_t begin = file_.corners.size();
    ObjWord word;
    while (line->next(&word)) file_.corners.push_back(corner(*line, word));
    require_bytes(builder_, file_.corners.size(), sizeof(ObjCorner), "the faces");
    const std::size_t end = file_.corners.size();
    if (end - begin < 3) return file_.corners.resize(begin);
    file_.faces.push_back({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end), material_, group_});
  }

  void begin_shape(const std::string& name) {
    end();
    if (!file_.shapes.empty() && file_.shapes.back().face_begin == file_.faces.size()) file_.shapes.pop_back();
    file_.shapes.push_back({name, file_.faces.size(), file_.faces.size()});
  }

  void name_file(const std::string& name) {
    constexpr std::size_t kFilesMax = 64;  // chosen: each is searched for in several places
    std::vector<std::string>& all = file_.material_files;
    if (all.size() < kFilesMax && std::find(all.begin(), all.end(), name) == all.end()) all.push_back(name);
  }

  void use_material(const std::string& name) {
    const auto added = materials_.emplace(name, static_cast<std::uint32_t>(file_.material_names.size()));
    if (added.second) file_.material_names.push_back(name);
    material_ = added.first->second;
  }

  void begin_group(ObjLine* line) {
    ObjWord word;
    float number = 0;
    file_.has_groups = true;
    group_ = kFlatGroup;
    if (line->next(&word) && read_number(word, &number) && number >= 1 && number < 1e9f)
      group_ = static_cast<std::uint32_t>(number);
  }

  void name_unknown(const std::string& name) {
    constexpr std::size_t kNamesMax = 8;  // chosen: keeps the line readable
    std::vector<std::string>& all = file_.unknown;
    if (all.size() < kNamesMax && std::find(all.begin(), all.end(), name) == all.end()) all.push_back(name);
  }

  const SceneBuilder& builder_;
  ObjFile& file_;
  std::unordered_map<std::string, std::uint32_t> materials_;
  std::uint32_t material_ = kNone, group_ = kNoGroup;
};

}  // namespace

ObjFile read_obj_file(const Bytes& bytes, const SceneBuilder& builder) {
  ObjFile file;
  Reader reader(builder, &file);
  for_each_line(bytes, "", [&](ObjLine* line) { reader.read(line); });
  reader.end();
  if (file.colors.size() != file.positions.size()) file.colors.clear();
  return file;
}

}  // namespace pocketray
