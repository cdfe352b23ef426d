// Structure-aware mutation of glTF: changes counts, offsets, strides, indices and references in the JSON, which stays
// valid, so that changes reach the importer's checks rather than its parser's.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/rng.h"

namespace pocketray {

using GltfJson = nlohmann::ordered_json;

// Values that a number is replaced by; kMissingNumber stands for removing it.
constexpr double kGltfNumbers[] = {
    0, -1, 1, 2, 3, 255, 65536, 2147483647, 2147483648.0, 4294967295.0, 4294967296.0, 1e18, -2147483648.0, 0.5};
constexpr std::size_t kGltfNumberCount = sizeof kGltfNumbers / sizeof kGltfNumbers[0];

// Paths of all numbers, and of all members and elements, in the order of the document.
inline void list_places(const GltfJson& at, const GltfJson::json_pointer& path,
                        std::vector<GltfJson::json_pointer>* numbers, std::vector<GltfJson::json_pointer>* all) {
  if (!path.empty()) all->push_back(path);
  if (at.is_number()) numbers->push_back(path);
  if (at.is_object())
    for (auto item = at.begin(); item != at.end(); ++item) list_places(*item, path / item.key(), numbers, all);
  if (at.is_array())
    for (std::size_t i = 0; i < at.size(); ++i) list_places(at[i], path / i, numbers, all);
}

inline void remove_place(GltfJson* document, const GltfJson::json_pointer& path) {
  GltfJson& parent = (*document)[path.parent_pointer()];
  if (parent.is_object()) parent.erase(path.back());
  if (parent.is_array()) parent.erase(static_cast<std::size_t>(std::stoul(path.back())));
}

// An integral value is written as one.
inline void set_number(GltfJson* document, const GltfJson::json_pointer& path, double value) {
  const auto whole = static_cast<std::int64_t>(value);
  GltfJson& place = (*document)[path];
  if (static_cast<double>(whole) != value)
    place = value;
  else if (whole < 0)
    place = whole;
  else
    place = static_cast<std::uint64_t>(whole);
}

// One change: a number becomes another, changes by one or takes the value of another place; a member or an element is
// removed, copied elsewhere or repeated.
inline void mutate_gltf(GltfJson* document, Rng* rng) {
  std::vector<GltfJson::json_pointer> numbers, all;
  list_places(*document, GltfJson::json_pointer(), &numbers, &all);
  if (all.empty()) return;
  auto pick = [rng](const std::vector<GltfJson::json_pointer>& places) {
    return places[next_u32(rng) % static_cast<std::uint32_t>(places.size())];
  };
  const std::uint32_t kind = next_u32(rng) % 16;
  if (kind < 11 && !numbers.empty()) {
    const GltfJson::json_pointer at = pick(numbers);
    if (kind < 7) return set_number(document, at, kGltfNumbers[next_u32(rng) % kGltfNumberCount]);
    if (kind == 7) return remove_place(document, at);
    const double value = (*document)[kind < 10 ? at : pick(numbers)].get<double>();
    return set_number(document, at, kind == 8 ? value + 1 : kind == 9 ? value - 1 : value);
  }
  const GltfJson::json_pointer at = pick(all);
  if (kind < 13) return remove_place(document, at);
  const GltfJson copied = (*document)[pick(all)];
  if (copied.dump().size() > 4096) return;
  GltfJson& place = (*document)[at];
  if (kind == 15 && place.is_array())
    place.push_back(place.empty() ? copied : place[0]);
  else
    place = copied;
}

}  // namespace pocketray
