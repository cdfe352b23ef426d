#include "base/nearest_word.h"

#include <algorithm>
#include <climits>
#include <cstring>

#include "base/check.h"

namespace pocketray {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

void skip_hyphens(const char** word, std::size_t* byte_count) {
  while (*byte_count > 0 && **word == '-') ++*word, --*byte_count;
}

// One edit; a replaced letter costs a little more, so that "of" is "off" rather than "on".
constexpr int kEditCost = 8, kReplaceCost = 9;

// Cost of letters to insert, delete, replace or swap with a neighbour to turn one word into the other: optimal string
// alignment [Damerau 1964, Wagner & Fischer 1974]. `Rows` has three rows of more than b_count columns.
template <class Rows>
int edit_cost(const char* a, std::size_t a_count, const char* b, std::size_t b_count, Rows& rows) {
  for (std::size_t j = 0; j <= b_count; ++j) rows[0][j] = static_cast<int>(j) * kEditCost;
  for (std::size_t i = 1; i <= a_count; ++i) {
    const int *above = rows[(i - 1) % 3], *two_above = rows[(i + 1) % 3];
    int* row = rows[i % 3];
    row[0] = static_cast<int>(i) * kEditCost;
    for (std::size_t j = 1; j <= b_count; ++j) {
      const char x = lower(a[i - 1]), y = lower(b[j - 1]);
      row[j] = std::min({above[j - 1] + (x != y) * kReplaceCost, above[j] + kEditCost, row[j - 1] + kEditCost});
      if (i > 1 && j > 1 && x == lower(b[j - 2]) && y == lower(a[i - 2]))
        row[j] = std::min(row[j], two_above[j - 2] + kEditCost);
    }
  }
  return rows[a_count % 3][b_count];
}

}  // namespace

NearestWord::NearestWord(const char* word, std::size_t byte_count) : cost_(INT_MAX) {
  CHECK(word != nullptr || byte_count == 0);
  skip_hyphens(&word, &byte_count);
  if (byte_count > kLetterMax) byte_count = 0;
  std::copy(word, word + byte_count, word_);
  count_ = byte_count;
}

NearestWord::NearestWord(const char* word) : NearestWord(word, std::strlen(word)) {}

void NearestWord::offer(const char* name) {
  CHECK(name != nullptr);
  const char* letters = name;
  std::size_t letter_count = std::strlen(name);
  skip_hyphens(&letters, &letter_count);
  const std::size_t shorter = std::min(count_, letter_count);
  if (shorter == 0 || letter_count > kLetterMax) return;
  const int edits_max = shorter == 1 ? 0 : shorter <= 3 ? 1 : 2;
  int rows[3][kLetterMax + 1];
  const int cost = edit_cost(word_, count_, letters, letter_count, rows);
  if (cost <= edits_max * kReplaceCost && cost < cost_) cost_ = cost, nearest_ = name;
}

}  // namespace pocketray
