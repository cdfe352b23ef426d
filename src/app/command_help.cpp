// Help screens: everyday options, all of them by chapter, or one in full.
#include <algorithm>
#include <cstdio>
#include <map>

#include "app/command_spec.h"

namespace pocketray {
namespace {

constexpr std::size_t kEntryWidthMax = 24;  // wider entries have a line of their own
constexpr const char* kExitStatus = "Exit status: 0 done, 1 bad input or environment, 2 wrong usage, 3 interrupted.";

std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

// Composes a screen; every text passes through here, so this alone knows the style.
class Screen {
 public:
  explicit Screen(const TextStyle& style) : style_(style) {}

  void line(const std::string& text = "") { text_ += styled(text) + "\n"; }
  void heading(const std::string& text) {
    line();
    line(style_.bold ? "\033[1m" + text + "\033[0m" : text);
  }
  // Wraps the words at the width; lines after the first begin with `indent` spaces. `begun`: the first line so far.
  void paragraph(const std::string& begun, std::size_t indent, const std::string& text) {
    const auto column_count = static_cast<std::size_t>(style_.column_count);
    std::string now = styled(begun);
    bool has_word = false;
    const std::string words = styled(text);
    for (std::size_t at = 0; at < words.size();) {
      std::size_t end = words.find(' ', at);
      if (end == std::string::npos) end = words.size();
      const std::string word = words.substr(at, end - at);
      at = end + 1;
      if (has_word && width_of(now) + 1 + width_of(word) > column_count) {
        text_ += now + "\n";
        now = std::string(indent, ' ');
        has_word = false;
      }
      now += (has_word ? " " : "") + word;
      has_word = true;
    }
    text_ += now + "\n";
  }
  void entry(const std::string& name, std::size_t name_width, const std::string& help) {
    const std::size_t indent = name_width + 4;
    std::string begun = "  " + name;
    if (width_of(name) > name_width) line(begun), begun.clear();
    paragraph(begun + std::string(indent - width_of(begun), ' '), indent, help);
  }

  const std::string& text() const { return text_; }

 private:
  std::string styled(const std::string& text) const { return style_.ascii_only ? as_ascii(text) : text; }

  TextStyle style_;
  std::string text_;
};

// "-o, --output FILE"
std::string entry_name(const OptionSpec& option) {
  std::string name = option.names[0];
  for (const std::string& each : option.names)
    if (each.size() == 2 && option.names[0].size() > 2) name = each + ", " + name;
  if (option.metavar.empty()) return name;
  return name + " " + (option.value_is_optional ? "[" + option.metavar + "]" : option.metavar);
}

// In full, or on one line: then without a range, and with its default in brackets.
std::string description(const OptionSpec& option, bool in_full) {
  const std::string allowed = allowed_values(option), &usual = option.default_text;
  std::string text = option.help;
  if (!option.choices.empty()) text += ": " + allowed;
  if (!in_full) return usual.empty() ? text : text + " [" + usual + "]";
  const std::string range = option.choices.empty() ? allowed : "";
  if (!range.empty() && !usual.empty()) return text + " (" + range + "; default " + usual + ")";
  if (!usual.empty()) return text + " (default " + usual + ")";
  return range.empty() ? text : text + " (" + range + ")";
}

std::size_t name_width(const std::vector<EverydayGroup>& groups) {
  std::size_t width = 0;
  for (const EverydayGroup& group : groups)
    for (const OptionSpec* option : group.options)
      if (const std::size_t own = width_of(entry_name(*option)); own <= kEntryWidthMax) width = std::max(width, own);
  return width;
}

// All options by chapter, the positional arguments first and without a heading.
std::vector<EverydayGroup> chapters_of(const CommandSpec& command, bool everything) {
  std::vector<EverydayGroup> chapters = {{"", {}}};
  auto add = [&chapters](const std::string& title, const OptionSpec* option) {
    auto found =
        std::find_if(chapters.begin(), chapters.end(), [&](const auto& each) { return each.heading == title; });
    if (found == chapters.end()) found = chapters.insert(chapters.end(), {title, {}});
    found->options.push_back(option);
  };
  for (const auto& option : command.options)
    if (!option->is_hidden && (option->is_positional || everything))
      add(option->is_positional ? "" : option->chapter, option.get());
  if (!everything) chapters.insert(chapters.end(), command.everyday.begin(), command.everyday.end());
  return chapters;
}

std::string sentence(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text + ".";
}

std::string usage_of(const CommandSpec& command) {
  std::string text = "Usage: " + full_name(command);
  for (const auto& option : command.options)
    if (option->is_positional) text += option->is_required ? " " + option->names[0] : " [" + option->names[0] + "]";
  for (const auto& option : command.options)
    if (!option->is_positional && option->is_required)
      text += " " + option->names.back() + (option->metavar.empty() ? "" : " " + option->metavar);
  return text + " [options]";
}

void add_examples(const std::vector<std::string>& examples, Screen* screen) {
  if (examples.empty()) return;
  screen->heading("Try");
  for (const std::string& example : examples) screen->line("  " + example);
}

void add_command(const CommandSpec& command, bool everything, Screen* screen) {
  screen->paragraph("", 0, usage_of(command));
  if (command.parent) screen->paragraph("", 0, sentence(command.help));
  everything = everything || command.everyday.empty();
  const std::vector<EverydayGroup> chapters = chapters_of(command, everything);
  const std::size_t width = name_width(chapters);
  for (const EverydayGroup& chapter : chapters) {
    if (chapter.options.empty()) continue;
    if (chapter.heading.empty()) screen->line();
    if (!chapter.heading.empty()) screen->heading(chapter.heading);
    for (const OptionSpec* option : chapter.options)
      screen->entry(entry_name(*option), width, description(*option, everything));
  }
  if (everything)
    for (const std::string& paragraph : command.about) screen->line(), screen->paragraph("", 0, paragraph);
  if (!command.footer.empty()) screen->line(), screen->line(command.footer);
  add_examples(command.examples, screen);
}

}  // namespace

std::string full_name(const CommandSpec& command) {
  return command.parent ? command.parent->name + " " + command.name : command.name;
}

std::string enumerated(const std::vector<std::string>& words, const char* last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) text += (i == 0 ? "" : i + 1 < words.size() ? ", " : last) + words[i];
  return text;
}

std::string allowed_values(const OptionSpec& option) {
  if (!option.choices.empty()) return enumerated(option.choices, " or ");
  if (!option.has_range) return "";
  char text[64];
  const int digits = std::max(-option.low, option.high) < 1e8 ? 10 : 6;
  std::snprintf(text, sizeof text, "%.*g … %.*g", digits, option.low, digits, option.high);
  return text;
}

std::string program_help(const CommandSpec& program, bool everything, const TextStyle& style) {
  Screen screen(style);
  screen.paragraph("", 0, program.help);
  screen.line();
  screen.paragraph("", 0, "Usage: " + program.name + " COMMAND [options]");
  std::vector<std::string> groups;
  std::size_t width = 0;
  for (const auto& command : program.commands) {
    width = std::max(width, command->name.size());
    if (std::find(groups.begin(), groups.end(), command->group) == groups.end()) groups.push_back(command->group);
  }
  for (const std::string& group : groups) {
    screen.heading(group);
    for (const auto& command : program.commands)
      if (command->group == group) screen.entry(command->name, width, command->help);
  }
  screen.heading("Help");
  screen.entry("help", width, "this list; or help COMMAND, or help COMMAND OPTION");
  screen.entry("version", width, "the program's version, and those of its files and messages");
  add_examples(program.examples, &screen);
  screen.line();
  screen.paragraph("", 0, kExitStatus);
  if (!everything) return screen.text();
  for (const auto& command : program.commands) screen.heading(command->name), add_command(*command, true, &screen);
  return screen.text();
}

std::string command_help(const CommandSpec& command, bool everything, const TextStyle& style) {
  Screen screen(style);
  if (!command.parent) screen.paragraph("", 0, command.help);
  add_command(command, everything, &screen);
  screen.line();
  const std::string name = full_name(command);
  if (everything || command.everyday.empty()) {
    screen.paragraph("", 0, kExitStatus);
  } else {
    screen.paragraph("", 0, "All options, with their ranges: " + name + " --help-all");
  }
  screen.paragraph("", 0, "One option: " + name + " --help OPTION");
  return screen.text();
}

std::string option_help(const CommandSpec& command, const OptionSpec& option, const TextStyle& style) {
  Screen screen(style);
  screen.paragraph("", 0, "Usage: " + full_name(command) + " … " + entry_name(option));
  screen.line();
  screen.paragraph("", 0, sentence(option.help));
  if (!option.details.empty()) screen.paragraph("", 0, option.details);
  screen.line();
  std::vector<std::pair<std::string, std::string>> facts;
  facts.emplace_back(option.choices.empty() ? "Range" : "Values", allowed_values(option));
  facts.emplace_back("Default", option.default_text);
  std::map<std::string, std::vector<std::string>> excluded;
  for (const Exclusion& exclusion : option.excludes) excluded[exclusion.because].push_back(exclusion.other->names[0]);
  for (const auto& [because, names] : excluded)
    facts.emplace_back("Excludes", enumerated(names, " and ") + ": " + because);
  std::vector<std::string> others;
  for (const OptionSpec* other : option.needs) others.push_back(other->names[0]);
  facts.emplace_back("Needs", enumerated(others, " and "));
  facts.emplace_back("Also", option.names.size() > 2 ? option.names[1] : "");
  facts.emplace_back("Price", option.price);
  for (const auto& [name, text] : facts)
    if (!text.empty()) screen.entry(name, 8, text);
  return screen.text();
}

CommandSpec* find_command(const CommandSpec& program, const std::string& name) {
  for (const auto& command : program.commands)
    if (command->name == name) return command.get();
  return nullptr;
}

OptionSpec* find_option(const CommandSpec& command, const std::string& name) {
  for (const auto& option : command.options)
    if (std::find(option->names.begin(), option->names.end(), name) != option->names.end()) return option.get();
  return nullptr;
}

}  // namespace pocketray
