// Suggests the word that a user probably meant.
#pragma once
#include <cstddef>

namespace pocketray {

// Keeps the nearest of the names offered, the first of several, within two letters inserted, deleted, replaced or
// swapped; within one if the word or the name has two or three letters, and none if it has one. Ignores case and, at
// the front, hyphens.
class NearestWord {
 public:
  NearestWord(const char* word, std::size_t byte_count);
  explicit NearestWord(const char* word);
  void offer(const char* name);
  // The nearest name so far, or null.
  const char* name() const { return nearest_; }

 private:
  static constexpr std::size_t kLetterMax = 40;  // longer words have no neighbours
  char word_[kLetterMax] = {};
  std::size_t count_ = 0;
  int cost_;  // of the edits that lead to the nearest name
  const char* nearest_ = nullptr;
};

}  // namespace pocketray
