#include "session/focus.h"

#include <algorithm>
#include <cctype>
#include <numeric>

#include "base/check.h"
#include "plan/framing.h"

namespace pocketray {
namespace {

// Derived: five names of 64 bytes fit into the message's 400, which shows as much of the wanted one. Longer names would
// make comparing, which is quadratic, expensive.
constexpr std::size_t kNamesShown = 5, kNameBytesCompared = 64;

std::string lower_case(const std::string& text) {
  std::string lower = text.substr(0, kNameBytesCompared);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

// Insertions, deletions and replacements between two texts [Wagner and Fischer 1974].
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t(0));
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t k = 1; k <= b.size(); ++k) {
      const std::size_t replaced = diagonal + (a[i - 1] != b[k - 1]);
      diagonal = row[k];
      row[k] = std::min({replaced, row[k - 1] + 1, diagonal + 1});
    }
  }
  return row[b.size()];
}

// Dissimilarity of two names; 0 if `name` contains `wanted`.
std::size_t unlikeness(const std::string& wanted, const std::string& name) {
  const std::string a = lower_case(wanted), b = lower_case(name);
  return a.empty() || b.find(a) == std::string::npos ? edit_distance(a, b) : 0;
}

std::string nearest_names(const NamedBoxes& parts, const std::string& name) {
  std::vector<std::pair<std::size_t, std::string>> names;
  for (const auto& part : parts) names.emplace_back(unlikeness(name, part.first), part.first);
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  std::string list;
  for (std::size_t i = 0; i < names.size() && i < kNamesShown; ++i)
    list += (i ? ", '" : "'") + names[i].second.substr(0, kNameBytesCompared) + "'";
  return list;
}

}  // namespace

Status find_part(const SceneSource& source, const std::string& scene, const std::string& name, Box* bounds) {
  CHECK(bounds != nullptr && !name.empty());
  if (source.parts.empty())
    return failure("--focus needs a model whose parts have names, and %.200s has none: drop --focus, or use --camera%s",
                   scene.c_str(), is_baked_name(scene) ? "; a .pray file keeps no names: name the model" : "");
  *bounds = empty_box();
  for (const auto& part : source.parts)
    if (part.first == name) *bounds = merge(*bounds, part.second);
  if (!is_empty(*bounds)) return success();
  return failure("--focus: %.100s has no part '%.64s'; similar ones: %.400s", scene.c_str(), name.c_str(),
                 nearest_names(source.parts, name).c_str());
}

Camera focused_camera(const Camera& camera, const Box& bounds, float aspect, double fov) {
  CHECK(!is_empty(bounds) && fov > 0);
  Vec3 backward = normalize(camera.eye - camera.target);
  if (is_zero(backward)) backward = {0, 0, 1};
  return framing_camera(bounds, aspect, backward, fov);
}

}  // namespace pocketray
