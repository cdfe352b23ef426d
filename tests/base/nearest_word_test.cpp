// Suggestions for misspelt words.
#include "base/nearest_word.h"

#include <doctest/doctest.h>

#include <cstring>
#include <string>
#include <vector>

#include "base/rng.h"

using namespace pocketray;

namespace {

const char* const kNames[] = {"cornell", "statue", "pi-zero", "--size", "--samples", "up", "on", "off", "auto"};

const char* suggested(const std::string& word) {
  NearestWord nearest(word.data(), word.size());
  for (const char* name : kNames) nearest.offer(name);
  return nearest.name() ? nearest.name() : "";
}

}  // namespace

// Goal: a word is suggested within two edits, or one for short words, and none beyond. Method: each kind of edit at
// both ends and in the middle, upper case, hyphens; words that resemble nothing.
TEST_CASE("nearest_word_within_two_edits") {
  const char* const words[][2] = {{"cornel", "cornell"},
                                  {"ornell", "cornell"},
                                  {"cornelll", "cornell"},
                                  {"xcornell", "cornell"},
                                  {"cornlel", "cornell"},
                                  {"ocrnell", "cornell"},
                                  {"xxrnell", "cornell"},
                                  {"Cornell", "cornell"},
                                  {"STATUE", "statue"},
                                  {"pizero", "pi-zero"},
                                  {"pi_zero", "pi-zero"},
                                  {"-size", "--size"},
                                  {"--sise", "--size"},
                                  {"size", "--size"},
                                  {"--sampels", "--samples"},
                                  {"of", "off"},
                                  {"aut", "auto"},
                                  {"xxxnell", ""},
                                  {"xon", "on"},
                                  {"xn", "on"},
                                  {"xx", ""},
                                  {"o", ""},
                                  {"jump", ""},
                                  {"no", "on"},
                                  {"sparkle", ""},
                                  {"", ""},
                                  {"-", ""}};
  for (const auto& row : words) {
    CAPTURE(row[0]);
    CHECK(std::string(suggested(row[0])) == row[1]);
  }
}

// Goal: the nearest of several names wins, the first among equals. Method: names at distances 2, 1 and 1.
TEST_CASE("nearest_word_prefers_the_nearest") {
  NearestWord nearest("light");
  nearest.offer("lighter");
  CHECK(std::string(nearest.name()) == "lighter");
  nearest.offer("lights");
  nearest.offer("flight");
  CHECK(std::string(nearest.name()) == "lights");
  nearest.offer("light");
  CHECK(std::string(nearest.name()) == "light");
}

// Goal: no word, however long, is read or written out of bounds, and it is suggested after one random edit. Method:
// words of 4 … 60 letters under a sanitizer; those of more than 40 have no suggestion.
TEST_CASE("nearest_word_of_any_length") {
  Rng rng = make_rng(11);
  for (std::size_t count = 4; count <= 60; ++count)
    for (int repeat = 0; repeat < 20; ++repeat) {
      std::string name;
      for (std::size_t i = 0; i < count; ++i) name += static_cast<char>('a' + next_u32(&rng) % 26);
      std::string word = name;
      word[next_u32(&rng) % count] = '_';
      NearestWord nearest(word.c_str());
      nearest.offer(name.c_str());
      CHECK((nearest.name() != nullptr) == (count <= 40));
    }
}
