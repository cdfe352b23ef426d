// Checks the JSON text of a glTF file before use, so that errors name a place in the document.
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "desktop/import/gltf.h"
#include "desktop/import/import_error.h"

namespace pocketray {
namespace {

constexpr std::size_t kJsonDepthMax = 64;  // tinygltf walks extras and extensions by recursion

// Walks the document and refuses the first invalid value or number beyond float.
class Checker {
 public:
  bool null() { return begin_value(); }
  bool boolean(bool) { return begin_value(); }
  bool number_integer(std::int64_t) { return begin_value(); }
  bool number_unsigned(std::uint64_t) { return begin_value(); }
  bool number_float(double value, const std::string& text) {
    begin_value();
    if (!std::isfinite(static_cast<float>(value)) && !in_extras())
      fail_import("%.200s is %.40s, larger than a float holds; fix that number or export the file again",
                  place().c_str(), text.c_str());
    return true;
  }
  bool string(const std::string& text) {
    begin_value();
    if (!levels_.empty() && levels_.back().key == "name") levels_.back().name = text.substr(0, 60);
    return true;
  }
  bool binary(const std::vector<std::uint8_t>&) { return true; }
  bool key(const std::string& text) {
    levels_.back().key = text;
    return true;
  }
  bool start_object(std::size_t) { return begin_level(false); }
  bool start_array(std::size_t) { return begin_level(true); }
  bool end_object() { return end_level(); }
  bool end_array() { return end_level(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& error) {
    // "[json.exception.parse_error.101] parse error at line 1, column 1: …"
    const char *where = std::strstr(error.what(), "at line "), *end = where ? std::strchr(where, ':') : nullptr;
    fail_import("not a valid JSON object, so not glTF, at %.60s%s%.*s; export the file again", place(true).c_str(),
                end ? ", " : "", end ? static_cast<int>(end - where) - 3 : 0, end ? where + 3 : "");
  }

 private:
  struct Level {
    bool is_array;
    std::size_t count;      // elements begun
    std::string key, name;  // of an object: its latest member, and its name
  };
  bool begin_value() {
    if (!levels_.empty() && levels_.back().is_array) ++levels_.back().count;
    return true;
  }
  bool begin_level(bool is_array) {
    begin_value();
    if (levels_.size() >= kJsonDepthMax)
      fail_import("the JSON nests deeper than %zu; export the file again", kJsonDepthMax);
    levels_.push_back({is_array, 0, "", ""});
    return true;
  }
  bool end_level() {
    levels_.pop_back();
    return true;
  }
  // Extras may hold anything and are not read.
  bool in_extras() const {
    for (const Level& level : levels_)
      if (level.key == "extras") return true;
    return false;
  }
  // Returns a path like /nodes/3/scale/0 of the latest value, or of the `next` one if it could not begin, and the
  // innermost known name.
  std::string place(bool next = false) const {
    std::string path, name;
    for (const Level& level : levels_) {
      path += "/" + (level.is_array ? std::to_string(level.count - (next && &level == &levels_.back() ? 0 : 1))
                                    : level.key.substr(0, 60));
      if (!level.name.empty()) name = level.name;
    }
    return (path.empty() ? "/" : path) + (name.empty() ? "" : " ('" + name + "')");
  }

  std::vector<Level> levels_;
};

}  // namespace

void gltf_check_json(const std::string& text) {
  Checker checker;
  nlohmann::json::sax_parse(text, &checker);
}

}  // namespace pocketray
