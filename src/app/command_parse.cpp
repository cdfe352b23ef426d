// Parsing of command lines: CLI11 divides them into options and their texts; refusals, each of which names the option
// and the cure, are ours.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "app/command_spec.h"
#include "base/nearest_word.h"

namespace pocketray {
namespace {

// Thrown by parsing, caught by CommandLine::parse(): the message, and whether usage or a value is wrong.
struct Refusal {
  std::string text;
  bool is_usage;
};

[[noreturn]] void refuse_usage(const std::string& text) { throw Refusal{text, true}; }
[[noreturn]] void refuse_value(const std::string& text) { throw Refusal{text, false}; }

// At most 60 bytes of a word, for a message.
std::string cut(const std::string& word) {
  std::size_t count = std::min<std::size_t>(word.size(), 60);
  while (count > 0 && count < word.size() && (static_cast<unsigned char>(word[count]) & 0xc0) == 0x80) --count;
  return word.substr(0, count) + (count < word.size() ? "…" : "");
}

std::string quoted(const std::string& word) { return "'" + cut(word) + "'"; }

bool is_help(const std::string& word) { return word == "--help" || word == "-h"; }
bool is_help_all(const std::string& word) { return word == "--help-all"; }

bool looks_like_option(const std::string& word) { return word.size() > 1 && word[0] == '-'; }

std::string name_of(const std::string& word) { return word.substr(0, word.find('=')); }

bool is_option(const CommandSpec& command, const std::string& word) {
  return looks_like_option(word) && (find_option(command, name_of(word)) || is_help(word) || is_help_all(word));
}

std::vector<std::string> option_names(const CommandSpec& command) {
  std::vector<std::string> names = {"--help", "--help-all"};
  if (!command.commands.empty()) names.push_back("--version");
  for (const auto& option : command.options)
    if (!option->is_hidden && !option->is_positional)
      names.insert(names.end(), option->names.begin(), option->names.end());
  return names;
}

std::vector<std::string> command_names(const CommandSpec& program) {
  std::vector<std::string> names;
  for (const auto& command : program.commands) names.push_back(command->name);
  for (const char* name : {"help", "version"}) names.push_back(name);
  return names;
}

[[noreturn]] void refuse_option(const CommandSpec& program, const CommandSpec& command, const std::string& word) {
  const std::string name = name_of(word);
  const bool is_command = command.parent != nullptr;
  std::string cure = suggestion(name, option_names(command));
  for (const auto& other : program.commands) {
    const OptionSpec* there = find_option(*other, name);
    if (cure.empty() && there && !there->is_hidden)
      cure = (is_command ? " in " + command.name : " before the command") + "; " + other->name + " has one";
  }
  if (cure.empty()) cure = "; `" + full_name(command) + " --help" + (is_command ? "-all" : "") + "` lists them";
  refuse_usage("there is no option " + cut(name) + cure);
}

const CommandSpec& named_command(const CommandSpec& program, const std::string& word) {
  if (const CommandSpec* command = find_command(program, word)) return *command;
  const std::string near = suggestion(word, command_names(program));
  refuse_usage("there is no command " + quoted(word) +
               (near.empty() ? "; `" + program.name + " help` lists them" : near));
}

void check_choice(const OptionSpec& option, const std::string& text) {
  const std::vector<std::string>& choices = option.choices;
  if (choices.empty() || std::find(choices.begin(), choices.end(), text) != choices.end()) return;
  const std::string near = suggestion(text, choices), must = "must be " + allowed_values(option);
  refuse_value(option.names[0] + " is " + quoted(text) + (near.empty() ? ": it " + must : near + " It " + must));
}

void check_number(const OptionSpec& option, const std::string& text) {
  const double value = std::strtod(text.c_str(), nullptr);
  const std::string range = allowed_values(option);
  if (option.has_range && !(value >= option.low && value <= option.high))
    refuse_value(option.names[0] + " is " + cut(text) + ": it must lie in " + range);
}

[[noreturn]] void refuse_form(const OptionSpec& option, const std::string& text) {
  const std::string range = option.has_range ? " in " + allowed_values(option) : "";
  refuse_value(option.names[0] + " is " + quoted(text) + ": it must be a " +
               (option.kind == ValueKind::whole_number ? "whole number" : "finite number") + range);
}

void store(OptionSpec* option, const std::string& text) {
  if (text.empty()) refuse_value(option->names[0] + " must not be empty");
  check_choice(*option, text);
  if (option->kind == ValueKind::whole_number || option->kind == ValueKind::number) {
    const bool is_number = std::isfinite(std::strtod(text.c_str(), nullptr));
    if (!option->store(text)) {
      // A number that is too large for the variable is beyond the range as well.
      if (is_number && text.find_first_not_of("-+0123456789") == std::string::npos) check_number(*option, text);
      refuse_form(*option, text);
    }
    check_number(*option, text);
  }
  for (const auto& check : option->checks)
    if (const std::string refusal = check(text); !refusal.empty())
      refuse_value(option->names[0] + " is " + quoted(text) + ": it " + refusal);
  if (option->kind == ValueKind::text) option->store(text);
}

// CLI11's options, one for each of a command's.
using Reader = std::vector<std::pair<OptionSpec*, CLI::Option*>>;

CLI::Option* declare(const OptionSpec& option, CLI::App* app) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "" : ",") + name;
  CLI::Option* declared = app->add_option(names, [](const CLI::results_t&) { return true; });
  declared->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  if (option.kind == ValueKind::flag || option.value_is_optional) declared->expected(0, 1);
  if (option.is_positional) declared->required(option.is_required);  // lists leave a word for it
  if (option.is_list) declared->expected(1, CLI::detail::expected_max_vector_size);
  return declared->allow_extra_args(option.is_list && !option.one_value_each);
}

// Refuses what CLI11 would read otherwise: "-output" is no value of -o, and "--size=" takes no word after it.
void check_words(const CommandSpec& program, const CommandSpec& command, const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    const std::string name = name_of(word);
    if (word.size() > 2 && word[0] == '-' && word[1] != '-' && find_option(command, "-" + name))
      refuse_option(program, command, word);
    const OptionSpec* option = looks_like_option(word) ? find_option(command, name) : nullptr;
    if (option && word == name + "=" && option->kind != ValueKind::flag) refuse_value(name + " must not be empty");
  }
}

[[noreturn]] void refuse_without_value(const OptionSpec& option) {
  const std::string allowed = allowed_values(option), &name = option.names[0];
  refuse_usage(name + " needs a value: " + name + " " + option.metavar + (allowed.empty() ? "" : ", " + allowed));
}

// Refuses the first word that is neither an option nor an argument's.
void check_remaining(const CommandSpec& program, const CommandSpec& command, const std::vector<std::string>& words) {
  if (words.empty() || words == std::vector<std::string>{"--"}) return;
  if (looks_like_option(words[0]) && words[0] != "--") refuse_option(program, command, words[0]);
  const std::string& word = words[words[0] == "--"];
  std::string takes;
  for (const auto& option : command.options)
    if (option->is_positional) takes += (takes.empty() ? "" : " and ") + option->names[0];
  refuse_usage(quoted(word) + " is one argument too many: " + full_name(command) + " takes " +
               (takes.empty() ? "options only" : takes));
}

// Refuses an option of the command as the value of another.
void check_value(const CommandSpec& command, const OptionSpec& option, const CLI::results_t& texts) {
  if (option.is_positional || option.kind == ValueKind::flag) return;
  for (const std::string& text : texts)
    if (is_option(command, text)) refuse_without_value(option);
}

void store_all(OptionSpec* option, const CLI::results_t& texts) {
  option->count = texts.size();
  const std::string& name = option->names[0];
  if (texts.size() > 1 && !option->is_list) refuse_usage(name + " is given twice: give it once");
  for (const std::string& text : texts) {
    if (option->kind == ValueKind::flag) {
      if (!text.empty()) refuse_usage(name + " takes no value, here " + quoted(text));
      option->store("");
    } else if (!text.empty() || !option->value_is_optional) {
      store(option, text);
    }
  }
}

void check_presence(const CommandSpec& command) {
  for (const auto& option : command.options) {
    if (option->is_required && option->count == 0)
      refuse_usage(command.name + " needs " + option->names[0] + (option->is_positional ? "" : " " + option->metavar) +
                   ": " + option->help);
    if (option->count == 0) continue;
    for (const OptionSpec* other : option->needs)
      if (other->count == 0) refuse_usage(option->names[0] + " needs " + other->names[0] + ": add it");
    for (const Exclusion& exclusion : option->excludes)
      if (exclusion.other->count > 0)
        refuse_usage(option->names[0] + " excludes " + exclusion.other->names[0] + ": " + exclusion.because +
                     "; drop one of them");
  }
}

// Help on the command, or on the option named after --help.
std::string help_after(const CommandSpec& program, const CommandSpec& command, const std::string& word,
                       const TextStyle& style) {
  for (const std::string& name : {word, "--" + word})
    if (const OptionSpec* option = find_option(command, name)) return option_help(command, *option, style);
  if (looks_like_option(word)) refuse_option(program, command, word);
  return command_help(command, false, style);
}

// Returns help if it is asked for.
std::string read_options(const CommandSpec& program, CommandSpec* command, const std::vector<std::string>& words,
                         const TextStyle& style) {
  const auto help = std::find_if(words.begin(), words.end(), is_help);
  if (help != words.end()) return help_after(program, *command, help + 1 == words.end() ? "" : help[1], style);
  if (std::any_of(words.begin(), words.end(), is_help_all)) return command_help(*command, true, style);
  check_words(program, *command, words);
  CLI::App app;
  app.set_help_flag();
  app.allow_extras();
  Reader reader;
  for (const auto& option : command->options) reader.emplace_back(option.get(), declare(*option, &app));
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // CLI11 takes the last word first
  } catch (const CLI::ArgumentMismatch&) {
    // Only the last word can lack a value.
    if (const OptionSpec* last = find_option(*command, words.back())) refuse_without_value(*last);
    refuse_usage(quoted(words.back()) + " needs a value");
  } catch (const CLI::RequiredError&) {  // check_presence() tells of it
  } catch (const CLI::ParseError&) {
    refuse_usage("these words are no options: `" + full_name(*command) + " --help` lists them");
  }
  for (const auto& read : reader) check_value(*command, *read.first, read.second->results());
  check_remaining(program, *command, app.remaining());
  for (const auto& read : reader) store_all(read.first, read.second->results());
  check_presence(*command);
  return "";
}

bool is_any_of(const std::string& word, std::initializer_list<const char*> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

// Forgets what an earlier parsing counted.
void forget_counts(CommandSpec* command) {
  for (const auto& option : command->options) option->count = option->value_count = 0;
  for (const auto& each : command->commands) forget_counts(each.get());
}

// Help on the program, on one of its commands or on an option of that.
std::string help_on(const CommandSpec& program, const std::vector<std::string>& words, const TextStyle& style) {
  if (words.empty()) return program_help(program, false, style);
  if (is_help_all(words[0])) return program_help(program, true, style);
  if (is_any_of(words[0], {"help", "version"})) return program_help(program, false, style);
  const CommandSpec& command = named_command(program, words[0]);
  if (words.size() < 2) return command_help(command, false, style);
  if (is_help_all(words[1])) return command_help(command, true, style);
  for (const std::string& name : {words[1], "--" + words[1]})
    if (const OptionSpec* option = find_option(command, name)) return option_help(command, *option, style);
  refuse_option(program, command, looks_like_option(words[1]) ? words[1] : "--" + words[1]);
}

}  // namespace

std::string suggestion(const std::string& word, const std::vector<std::string>& names) {
  NearestWord nearest(word.data(), word.size());
  for (const std::string& name : names) nearest.offer(name.c_str());
  return nearest.name() ? std::string(", did you mean '") + nearest.name() + "'?" : "";
}

ParseResult CommandLine::parse(const std::vector<std::string>& words) {
  ParseResult result;
  forget_counts(program_.get());
  CommandSpec* command = program_.get();
  std::vector<std::string> rest = words;
  try {
    if (!program_->commands.empty()) {
      if (words.empty()) refuse_usage("name a command, as render or view; `" + program_->name + " help` lists them");
      rest.erase(rest.begin());
      if (is_help_all(words[0])) return result.help = program_help(*program_, true, style_), result;
      if (is_help(words[0]) || words[0] == "help") return result.help = help_on(*program_, rest, style_), result;
      if (is_any_of(words[0], {"version", "--version", "-V", "-v"})) return result.help = version_, result;
      if (looks_like_option(words[0])) refuse_option(*program_, *program_, words[0]);
      named_command(*program_, words[0]);
      command = find_command(*program_, words[0]);
    }
    result.help = read_options(*program_, command, rest, style_);
  } catch (const Refusal& refusal) {
    result.error = refusal.text;
    result.usage = refusal.is_usage;
    return result;
  }
  if (result.help.empty() && command->run) command->run();
  return result;
}

}  // namespace pocketray
