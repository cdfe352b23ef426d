// Commands and options of a program: declaring them, their help, and parsing. Only command_line.cpp includes CLI11,
// whose templates take long to compile; names and meanings are CLI11's.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace pocketray {

// An option of a command: a handle, valid as long as its CommandLine. Every setter returns the option itself.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option required();
  // The default shown in help: the variable's current value, or `text`. The variable is unchanged.
  Option capture_default_str();
  Option default_str(const std::string& text);
  // Heading in the help; empty: help omits the option.
  Option group(const std::string& name);
  // With this option, a command line must also have `other`, or must not.
  Option needs(Option other);
  Option excludes(Option other);
  // Number of values that follow the option; a minimum of 0 allows the option alone.
  Option expected(int value_count_min, int value_count_max);
  // Allows an option for a list to take several values at once; otherwise it is repeated for each.
  Option allow_extra_args(bool allowed);

  // Checks apply to every value as written on the command line, in the order of these calls. `refusal` describes what
  // is wrong with the value, or returns an empty string.
  Option check(std::function<std::string(const std::string& text)> refusal);
  Option one_of(const std::vector<std::string>& values);
  // Bounds are inclusive and have the variable's type. NaN is accepted: see refuse_meaningless_values().
  Option range(int low, int high);
  Option range(std::uint32_t low, std::uint32_t high);
  Option range(float low, float high);
  Option range(double low, double high);

  // Number of times that the option was given, after parsing.
  std::size_t count() const;

 private:
  CLI::Option* option_;
};

// A command of a program, or the program itself: a handle, valid as long as its CommandLine.
class Command {
 public:
  explicit Command(CLI::App* app) : app_(app) {}

  Command add_subcommand(const std::string& name, const std::string& help);
  // "--name", "-n,--name", or "NAME" for a positional argument. Parsing stores the value in `variable`, which must
  // outlive it and keeps its value, the default, if the option is absent.
  Option add_option(const std::string& name, std::string& variable, const std::string& help);
  Option add_option(const std::string& name, std::vector<std::string>& variable, const std::string& help);
  Option add_option(const std::string& name, int& variable, const std::string& help);
  Option add_option(const std::string& name, std::uint32_t& variable, const std::string& help);
  Option add_option(const std::string& name, float& variable, const std::string& help);
  Option add_option(const std::string& name, double& variable, const std::string& help);
  // An option without a value, which sets the variable to true.
  Option add_flag(const std::string& name, bool& variable, const std::string& help);
  // Returns the option with that name, which must exist.
  Option get_option(const std::string& name) const;
  // Text below the command's help.
  void footer(const std::string& text);
  // Called by CommandLine::parse() if the command is given.
  void callback(std::function<void()> run);

 private:
  CLI::App* app_;
};

struct ParseResult {
  std::string error;   // error message; empty: none
  bool usage = false;  // true: wrong usage; false: a wrong value of an option
  std::string help;    // the help or version to print, if requested; otherwise empty
};

// A program's command line; owns its commands and options.
class CommandLine {
 public:
  // `description` opens the program's help.
  CommandLine(const std::string& program_name, const std::string& description);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  // The program, to which commands and options are added.
  Command program() const { return Command(app_.get()); }
  void set_version_flag(const std::string& name, const std::string& version);
  // Exactly `count` commands must be given.
  void require_subcommand(int count);
  // Makes every command's options refuse empty values, NaN and infinity. Call once, after adding all options.
  void refuse_meaningless_values();
  // Parses the words after the program's name and calls the given command's callback; exceptions of the callback pass
  // through. Calls nothing if the result has an error or help.
  ParseResult parse(const std::vector<std::string>& words);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace pocketray
