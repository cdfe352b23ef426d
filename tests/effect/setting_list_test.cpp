// Every row of the settings' list, in every place derived from the list. A new row is tested here without another line.
#include "effect/setting_list.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "plan/front.h"
#include "plan/plan_effects.h"
#ifdef POCKETRAY_HAVE_ACCURACY
#include "desktop/accuracy/knob_list.h"
#endif
#ifdef POCKETRAY_HAVE_NETWORK
#include "wire/message.h"
#endif
#include "app/options.h"
#include "support/help_entry.h"

using namespace pocketray;

namespace {

// A value from the sweep other than the default.
double other_value(const SettingRow& row) {
  const double usual = row.field.get(Quality());
  for (int i = 0; i < row.sweep.count; ++i)
    if (row.sweep.values[i] != usual) return row.sweep.values[i];
  return usual;
}

std::string text_of(const SettingRow& row, double value) {
  char text[64];
  describe_value(row, value, 9, text, sizeof text);
  return text;
}

std::string range_of(const SettingRow& row) {
  char text[128];
  describe_range(row, text, sizeof text);
  return text;
}

// Settings of a command called with these words.
Status read_line(std::vector<std::string> words, Settings* settings) {
  CommandLine line("program", "");
  CommonOptions options;
  BudgetOptions budget;
  add_scene_options(line.program(), &options);
  add_budget_options(line.program(), &budget);
  words.insert(words.begin(), "cube");
  ParseResult parsed = line.parse(words);
  if (!parsed.error.empty()) return failure("%.400s", parsed.error.c_str());
  return read_settings(options, settings);
}

}  // namespace

// Goal: rows are distinct, their defaults are allowed, and get and set access one member each. Method: set each value
// in turn and read all rows.
TEST_CASE("settings_are_set_one_at_a_time") {
  for (const SettingRow& row : kSettingList) {
    CAPTURE(std::string(row.name));
    CHECK(find_setting(row.name) == &row);
    CHECK(*row.what);
    CHECK(within_setting(row, row.field.get(Quality())));
    CHECK((row.field.names != nullptr) == (row.field.kind == SettingKind::choice));
    CHECK(row.seen_with == (row.seen_with | row.effects));
    for (int i = 0; i < row.sweep.count; ++i) {
      Quality quality;
      row.field.set(&quality, row.sweep.values[i]);
      for (const SettingRow& any : kSettingList)
        CHECK(any.field.get(quality) == (&any == &row ? row.sweep.values[i] : any.field.get(Quality())));
    }
    Quality other;
    row.field.set(&other, other_value(row));
    CHECK_FALSE(same_quality(Quality(), other));
    CHECK(same_lights(Quality(), other) == !row.places_lights);
    CHECK(row.field.get(reference_settings(with_candidate(Settings(), other))) ==
          (std::isnan(row.exact) ? other_value(row) : row.exact));
  }
  CHECK(find_setting("no such setting") == nullptr);
}

// Goal: all rows are options with help, default and limits, which set the value they name and exclude a budget. Method:
// a command line for each; values beyond the limits are refused under the option's name, and by the library under its
// own.
TEST_CASE("settings_are_options") {
  CommandLine line("program", "");
  CommonOptions options;
  add_scene_options(line.program(), &options);
  for (const SettingRow& row : kSettingList) {
    CAPTURE(std::string(row.name));
    const std::string option = std::string("--") + row.name;
    const std::string help = help_entry(&line, option);
    CHECK(help.find(row.what + 1) != std::string::npos);  // its first letter is a capital
    CHECK(help.find(range_of(row)) != std::string::npos);
    CHECK(help.find("Default " + text_of(row, row.field.get(Quality())) + " ") != std::string::npos);
    Settings settings;
    const std::string other = text_of(row, other_value(row));
    CHECK(std::strstr(read_line({"--budget-ms", "40", option, other}, &settings).message, "excludes") != nullptr);
    REQUIRE(read_line({option, other}, &settings).ok);
    for (const SettingRow& any : kSettingList)
      CHECK(any.field.get(settings) == (&any == &row ? other_value(row) : any.field.get(Quality())));
    bool is_choice = row.field.kind == SettingKind::choice;
    double beyond = is_choice ? row.field.name_count : limit_of(row.field.quantity).high + 1;
    Status status = read_line({option, is_choice ? "sparkle" : std::to_string(beyond).substr(0, 3)}, &settings);
    CHECK_FALSE(status.ok);
    CHECK(std::strstr(status.message, option.c_str()) != nullptr);
    settings = Settings();
    row.field.set(&settings, beyond);
    status = validate_settings(settings);
    CHECK_FALSE(status.ok);
    CHECK(std::strstr(status.message, range_of(row).c_str()) != nullptr);
  }
}

// Goal: a front's file holds all settings. Method: each with another value, written and read; a line without it, and
// one with a value beyond the limits, are refused; the description of a change names it. What shared frames do without,
// and what is newer than fronts, is its default in a line without it.
TEST_CASE("settings_are_in_fronts") {
  for (const SettingRow& row : kSettingList) {
    CAPTURE(std::string(row.name));
    Front front, back;
    front.count = 1;
    row.field.set(&front.candidates[0], other_value(row));
    std::string text(kFrontTextMax, 0);
    text.resize(format_front(front, &text[0], text.size()));
    REQUIRE(parse_front(text.data(), text.size(), &back).ok);
    CHECK(same_quality(front.candidates[0], back.candidates[0]));
    const std::string word = row.name + ("=" + text_of(row, other_value(row))) + " ";
    const std::size_t at = text.find(word);
    REQUIRE(at != std::string::npos);
    std::string without = text, beyond = text;
    without.erase(at, word.size());
    Status status = parse_front(without.data(), without.size(), &back);
    if (row.wire_bytes == 0 || row.may_be_absent)
      CHECK((status.ok && same_quality(back.candidates[0], Candidate())));
    else
      CHECK(std::strstr(status.message, (std::string(row.name) + "= is missing").c_str()) != nullptr);
    beyond.replace(at, word.size(), std::string(row.name) + "=999 ");
    CHECK_FALSE(parse_front(beyond.data(), beyond.size(), &back).ok);
    char change[kFrontLineMax];
    describe_change(Quality(), front.candidates[0], change, sizeof change);
    CHECK(std::string(change).find(row.name) == 0);
    format_hud_quality(Quality(), change, sizeof change);
    if (row.hud_name) CHECK(std::string(change).find(row.hud_name) != std::string::npos);
    back = front;
    drop_what_scene_ignores(&back, 0);
    CHECK(row.field.get(back.candidates[0]) ==
          (row.seen_with == kAlways ? other_value(row) : row.field.get(Quality())));
    drop_what_scene_ignores(&front, row.effects);
    CHECK(row.field.get(front.candidates[0]) == other_value(row));
  }
}

#ifdef POCKETRAY_HAVE_NETWORK
// Goal: requests carry all settings, in list order and with the sizes of the rows and of PROTOCOL.md. Method: two
// requests that differ in one setting differ only in its bytes and the checksum; invalid values are malformed; the
// document's table, row by row.
TEST_CASE("settings_are_on_the_wire") {
  const std::uint32_t header = kHeaderBytes;
  std::uint32_t place = header + 87;  // frame to height
  for (const SettingRow& row : kSettingList) {
    CAPTURE(std::string(row.name));
    if (row.wire_bytes == 0) continue;  // shared frames do without
    Message message;
    message.type = MessageType::frame_request;
    message.frame_request.row_end = 1;
    std::vector<std::uint8_t> before(message_bytes(message)), after = before;
    encode_message(message, before.data());
    row.field.set(&message.frame_request.settings, other_value(row));
    encode_message(message, after.data());
    for (std::uint32_t i = header; i < before.size(); ++i)
      if (i < place || i >= place + row.wire_bytes) CHECK(before[i] == after[i]);
    CHECK(before != after);
    Message read;
    REQUIRE(decode_message(after.data(), after.size(), kMessageBytesMax, &read).state == DecodeState::message);
    CHECK(row.field.get(read.frame_request.settings) == other_value(row));
    row.field.set(&message.frame_request.settings, 255);
    CHECK(can_encode(message) == within_setting(row, 255));
    place += row.wire_bytes;
  }

  std::ifstream file(POCKETRAY_SOURCE "/src/wire/PROTOCOL.md");
  std::string line;
  while (std::getline(file, line) && line.rfind("| width, height |", 0) != 0) {
  }
  for (const SettingRow& row : kSettingList) {
    CAPTURE(std::string(row.name));
    if (row.wire_bytes == 0) continue;
    REQUIRE(std::getline(file, line));
    std::istringstream cells(line);
    std::string cell[3];
    std::getline(cells, cell[0], '|');
    for (std::string& text : cell) std::getline(cells, text, '|');
    const bool is_real = row.field.kind == SettingKind::real;
    CHECK(cell[1] == " " + std::to_string(row.wire_bytes) + (is_real ? ", real " : " "));
    if (row.field.kind == SettingKind::choice) continue;
    char range[64];
    std::snprintf(range, sizeof range, "%g–%g ", limit_of(row.field.quantity).low, limit_of(row.field.quantity).high);
    CHECK(cell[2].find(range) != std::string::npos);
  }
  REQUIRE(std::getline(file, line));
  CHECK(line.rfind("| effects on, effects off |", 0) == 0);
}
#endif

#ifdef POCKETRAY_HAVE_ACCURACY
// Goal: a sweep covers all settings. Method: the knob with the row's name takes each of the row's values by name, and
// knows effect, theory and price.
TEST_CASE("settings_are_knobs") {
  for (const SettingRow& row : kSettingList) {
    CAPTURE(std::string(row.name));
    const Knob* knob = nullptr;
    for (const Knob& any : knob_list())
      if (std::strcmp(any.name, row.name) == 0) knob = &any;
    REQUIRE(knob != nullptr);
    REQUIRE(knob->values.size() == static_cast<std::size_t>(row.sweep.count));
    for (int i = 0; i < row.sweep.count; ++i) {
      const double value = knob->values[static_cast<std::size_t>(i)];
      Configuration configuration;
      knob->set(&configuration, value);
      CHECK(row.field.get(configuration.settings) == row.sweep.values[i]);
      CHECK(knob->get(configuration) == value);
      char label[32];
      describe_value(row, row.sweep.values[i], 6, label, sizeof label);
      CHECK(value_label(*knob, value) == label);
    }
    CHECK(knob->what == std::string(row.what));
    CHECK(knob->theory == std::string(row.theory));
    CHECK(knob->is_setting);
    CHECK_FALSE(knob->effect.empty());
    CHECK(knob->needs == (row.seen_with == kAlways ? 0 : row.effects));
    CHECK((knob->price == row.price));
  }
}
#endif
