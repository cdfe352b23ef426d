// Declarations of commands and options: command_line.cpp fills them, command_parse.cpp and command_help.cpp read them.
#pragma once
#include "app/command_line.h"

namespace pocketray {

enum class ValueKind { flag, text, whole_number, number };

struct Exclusion {
  const OptionSpec* other;
  std::string because;
};

struct OptionSpec {
  std::vector<std::string> names;  // with hyphens, the one for messages first; a positional's name has none
  ValueKind kind = ValueKind::text;
  std::string metavar;  // stands for the value in help: "WxH"
  std::string help, details, price, chapter;
  std::string default_text;
  bool is_positional = false, is_required = false, is_hidden = false;
  bool value_is_optional = false;
  bool is_list = false, one_value_each = false;
  bool has_range = false;
  double low = 0, high = 0;
  std::vector<std::string> choices;
  std::vector<const OptionSpec*> needs;
  std::vector<Exclusion> excludes;
  std::vector<std::function<std::string(const std::string&)>> checks;
  // Stores a value; returns false if the text has another form.
  std::function<bool(const std::string&)> store;
  std::function<std::string()> current;    // the variable as text
  std::size_t count = 0, value_count = 0;  // times given; values stored
};

struct EverydayGroup {
  std::string heading;
  std::vector<const OptionSpec*> options;
};

struct CommandSpec {
  std::string name, help, group;
  const CommandSpec* parent = nullptr;
  std::vector<std::unique_ptr<OptionSpec>> options;
  std::vector<std::unique_ptr<CommandSpec>> commands;
  std::string chapter = "Options";  // of the next option; for a program, group of the next command
  std::vector<EverydayGroup> everyday;
  std::vector<std::string> examples, about;
  std::string footer;
  std::function<void()> run;
};

// Returns the command or the option with that name, hyphens included; null if there is none.
CommandSpec* find_command(const CommandSpec& program, const std::string& name);
OptionSpec* find_option(const CommandSpec& command, const std::string& name);
// "pocketray render"
std::string full_name(const CommandSpec& command);
// "1 … 16", "scene, nearest or bilinear", or empty if nothing is declared.
std::string allowed_values(const OptionSpec& option);
// "a, b or c", for " or "
std::string enumerated(const std::vector<std::string>& words, const char* last);
// ", did you mean 'render'?", or empty if no name is near.
std::string suggestion(const std::string& word, const std::vector<std::string>& names);

std::string program_help(const CommandSpec& program, bool everything, const TextStyle& style);
std::string command_help(const CommandSpec& command, bool everything, const TextStyle& style);
std::string option_help(const CommandSpec& command, const OptionSpec& option, const TextStyle& style);

// Stores the values that the words after the command give, or returns an error or help.
ParseResult parse_options(const CommandSpec& program, CommandSpec* command, const std::vector<std::string>& words,
                          const TextStyle& style);

}  // namespace pocketray
