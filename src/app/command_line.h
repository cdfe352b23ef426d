// Commands and options of a program: declaring them, their help, and parsing.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "session/terminal.h"

namespace pocketray {

struct CommandSpec;
struct OptionSpec;

// An option of a command: a handle, valid as long as its CommandLine. Every setter returns the option itself.
class Option {
 public:
  explicit Option(OptionSpec* spec) : spec_(spec) {}

  Option required();
  // The default shown in help: the variable's current value, or `text`. The variable is unchanged.
  Option capture_default_str();
  Option default_str(const std::string& text);
  // Sentences that follow the short help where it is about this option alone.
  Option details(const std::string& text);
  // Its measured price, shown there, too.
  Option price(const std::string& text);
  // Help omits the option.
  Option hidden();
  // With this option, a command line must also have `other`, or must not; `because` says why not.
  Option needs(Option other);
  Option excludes(Option other, const std::string& because);
  // Makes an option for a list take one value each time it is given, instead of all words up to the next option.
  Option one_value_each();

  // Checks apply to every value as written on the command line, in the order of these calls. `refusal` describes what
  // is wrong with the value, "must be …", or returns an empty string.
  Option check(std::function<std::string(const std::string& text)> refusal);
  // Help and refusals list the values.
  Option one_of(const std::vector<std::string>& values);
  // Bounds are inclusive; help and refusals tell them.
  Option range(double low, double high);

  // Number of times that the option was given, after parsing.
  std::size_t count() const;

 private:
  OptionSpec* spec_;
};

// A command of a program, or the program itself: a handle, valid as long as its CommandLine.
class Command {
 public:
  explicit Command(CommandSpec* spec) : spec_(spec) {}

  Command add_subcommand(const std::string& name, const std::string& help);
  // `name`: "--name WHAT" or "-n,--name WHAT", where WHAT stands for the value in help, and "[WHAT]" for one that may
  // be left out; "NAME" for a positional argument. Parsing stores the value in `variable`, which must outlive it and
  // keeps its value, the default, if the option is absent. Empty values, NaN and infinity are refused.
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

  // Chapter of --help-all for the options added from here on.
  void chapter(const std::string& title);
  // Shows these options under a heading in --help, which then leaves the others to --help-all. Names that the build
  // lacks are skipped.
  void everyday(const std::string& heading, const std::vector<std::string>& names);
  // Command lines to try, below --help.
  void example(const std::string& line);
  // Paragraphs below --help-all.
  void about(const std::string& paragraph);
  // Text below --help, printed as it stands.
  void footer(const std::string& text);
  // Called by CommandLine::parse() if the command is given.
  void callback(std::function<void()> run);

 private:
  CommandSpec* spec_;
};

struct ParseResult {
  std::string error;   // error message; empty: none
  bool usage = false;  // true: wrong usage; false: a wrong value of an option
  std::string help;    // the help or version to print, if requested; otherwise empty
};

// A program's command line; owns its commands and options. Every program has --help, --help-all and, for one option,
// --help OPTION; one with commands also has `help`.
class CommandLine {
 public:
  // `description` opens the program's help.
  CommandLine(const std::string& program_name, const std::string& description);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  // The program, to which commands and options are added.
  Command program() const { return Command(program_.get()); }
  // Text printed by `version`, --version, -V and -v.
  void set_version(const std::string& text);
  // How help looks; otherwise 80 columns of plain text.
  void set_style(const TextStyle& style);
  // Parses the words after the program's name and calls the given command's callback; exceptions of the callback pass
  // through. Calls nothing if the result has an error or help.
  ParseResult parse(const std::vector<std::string>& words);

 private:
  std::unique_ptr<CommandSpec> program_;
  std::string version_;
  TextStyle style_;
};

}  // namespace pocketray
