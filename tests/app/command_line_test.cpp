// The command line: values of each type, refusals, help.
#include "app/command_line.h"

#include <doctest/doctest.h>

#include "support/help_entry.h"

using namespace pocketray;

namespace {

struct Values {
  std::string text = "a";
  std::vector<std::string> list;
  int signed_count = -1;
  std::uint32_t count = 1;
  float real = 0.5f;
  double wide = 0.25;
  bool flag = false;
  int runs = 0;
};

// A program with one command, which has an option of each type.
struct Program {
  CommandLine line{"program", "describes the program"};
  Values values;
  Command command = line.program().add_subcommand("command", "describes the command");
  Program() {
    line.set_version_flag("--version", "1.2.3");
    line.require_subcommand(1);
    command.add_option("TEXT", values.text, "help on text").required();
    command.add_option("--list", values.list, "help on list").allow_extra_args(false);
    command.add_option("--signed", values.signed_count, "help on signed").range(-2, 2);
    command.add_option("--count", values.count, "help on count").range(1u, 5u).capture_default_str();
    command.add_option("--real", values.real, "help on real").range(0.0f, 1.0f);
    command.add_option("--wide", values.wide, "help on wide").range(0.0, 1.0);
    command.add_flag("--flag", values.flag, "help on flag");
    command.callback([this] { ++values.runs; });
  }
};

bool contains(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

}  // namespace

// Goal: parsing stores each value and calls the command. Method: all options at once, and none.
TEST_CASE("command_line_stores_values") {
  Program program;
  ParseResult parsed = program.line.parse({"command", "b", "--list", "c", "--list", "d", "--signed", "-2", "--count",
                                           "5", "--real", "1", "--wide", "0.125", "--flag"});
  const Values& values = program.values;
  CHECK(parsed.error.empty());
  CHECK(parsed.help.empty());
  CHECK(values.text == "b");
  CHECK(values.list == std::vector<std::string>{"c", "d"});
  CHECK(values.signed_count == -2);
  CHECK(values.count == 5);
  CHECK(values.real == 1);
  CHECK(values.wide == 0.125);
  CHECK(values.flag);
  CHECK(values.runs == 1);
  Program other;
  CHECK(other.line.parse({"command", "b"}).error.empty());
  CHECK(other.values.signed_count == -1);
  CHECK(other.values.count == 1);
  CHECK_FALSE(other.values.flag);
}

// Goal: a wrong command line is refused, and its command not called. Method: each way of being wrong; the error names
// the option.
TEST_CASE("command_line_refuses_wrong_usage") {
  struct Wrong {
    std::vector<std::string> words;
    const char* error;
  };
  const Wrong lines[] = {{{}, "subcommand"},
                         {{"command"}, "TEXT"},
                         {{"command", "b", "--nonsense"}, "--nonsense"},
                         {{"command", "b", "--list", "c", "d"}, "d"},
                         {{"command", "b", "--signed", "3"}, "--signed"},
                         {{"command", "b", "--signed", "-3"}, "--signed"},
                         {{"command", "b", "--count", "0"}, "--count"},
                         {{"command", "b", "--count", "6"}, "--count"},
                         {{"command", "b", "--count", "x"}, "--count"},
                         {{"command", "b", "--real", "1.5"}, "--real"},
                         {{"command", "b", "--wide", "-0.5"}, "--wide"},
                         {{"command", "b", "--wide"}, "--wide"}};
  for (const Wrong& line : lines) {
    CAPTURE(line.error);
    Program program;
    ParseResult parsed = program.line.parse(line.words);
    CHECK(contains(parsed.error, line.error));
    CHECK(parsed.help.empty());
    CHECK(program.values.runs == 0);
  }
}

// Goal: a misspelt command or option is named with the nearest known one, if any is near; a bad value is told from
// wrong usage.
TEST_CASE("command_line_suggests_the_nearest_word") {
  struct Misspelt {
    std::vector<std::string> words;
    const char* error;
  };
  const Misspelt lines[] = {
      {{"comand", "b"}, "there is no command 'comand', did you mean 'command'?"},
      {{"something"}, "there is no command 'something'"},
      {{"--verson"}, "there is no option --verson, did you mean '--version'?"},
      {{"command", "b", "--reel=1"}, "there is no option --reel, did you mean '--real'?"},
      {{"command", "b", "--count", "3", "--lits", "c"}, "there is no option --lits, did you mean '--list'?"},
      {{"command", "b", "--nonsense"}, "there is no option --nonsense"}};
  for (const Misspelt& line : lines) {
    Program program;
    const ParseResult parsed = program.line.parse(line.words);
    CHECK(parsed.error == line.error);
    CHECK(parsed.usage);
  }
  Program program;
  CHECK_FALSE(program.line.parse({"command", "b", "--count", "6"}).usage);
  CHECK_FALSE(program.line.parse({"command", "b", "--count", "x"}).usage);
  CHECK(program.line.parse({"command"}).usage);
}

// Goal: help and version are returned and are no error; no command is called. Method: both; the help of the program
// and of its command.
TEST_CASE("command_line_returns_help") {
  Program program;
  ParseResult parsed = program.line.parse({"--help"});
  CHECK(parsed.error.empty());
  CHECK(contains(parsed.help, "describes the program"));
  CHECK(contains(parsed.help, "describes the command"));
  parsed = program.line.parse({"command", "--help"});
  CHECK(parsed.error.empty());
  for (const char* part : {"describes the command", "TEXT REQUIRED", "--count UINT:UINT in [1 - 5]=1", "help on flag"})
    CHECK(contains(parsed.help, part));
  parsed = program.line.parse({"--version"});
  CHECK(parsed.error.empty());
  CHECK(parsed.help == "1.2.3\n");
  CHECK(program.values.runs == 0);
}

// Goal: options that depend on each other, and checks of values. Method: a line that satisfies each and one that does
// not.
TEST_CASE("command_line_relates_options") {
  std::string first, second, third, shown = "shown", hidden;
  std::size_t third_count = 0;
  auto parse = [&](const std::vector<std::string>& words) {
    CommandLine line("program", "");
    Command command = line.program();
    Option one = command.add_option("--first", first, "").one_of({"a", "b"});
    command.add_option("--second", second, "").needs(one).check([](const std::string& text) {
      return text == "bad" ? "is bad" : "";
    });
    Option optional = command.add_option("--third", third, "").expected(0, 1).excludes(command.get_option("--first"));
    command.add_option("--shown", shown, "").default_str("in words").group("Heading");
    command.add_option("--hidden", hidden, "").group("");
    std::string error = line.parse(words).error;
    third_count = optional.count();
    CHECK(contains(help_entry(&line, "--shown"), "TEXT=in words"));
    CHECK(help_entry(&line, "--hidden").empty());
    return error;
  };
  CHECK(parse({"--first", "a", "--second", "x"}) == "");
  CHECK(contains(parse({"--first", "c"}), "--first"));
  CHECK(contains(parse({"--second", "x"}), "--first"));
  CHECK(contains(parse({"--first", "a", "--second", "bad"}), "is bad"));
  CHECK(third_count == 0);
  CHECK(parse({"--third"}) == "");
  CHECK(third_count == 1);
  CHECK(parse({"--third", "x"}) == "");
  CHECK(third == "x");
  CHECK(contains(parse({"--first", "a", "--third"}), "--third"));
  CHECK(parse({"--hidden", "x"}) == "");
  CHECK(hidden == "x");
}

// Goal: no number is NaN or infinite, and no value empty. Method: such values for each type, where only reals refuse
// "nan" by this rule; a flag has no value to check.
TEST_CASE("command_line_refuses_meaningless_values") {
  for (const char* option : {"--real", "--wide"})
    for (const char* value : {"nan", "-nan", "inf", "-inf", "1e999"}) {
      CAPTURE(option);
      CAPTURE(value);
      Program program;
      program.line.refuse_meaningless_values();
      CHECK(contains(program.line.parse({"command", "b", option, value}).error, option));
    }
  Program program;
  program.line.refuse_meaningless_values();
  CHECK(contains(program.line.parse({"command", ""}).error, "must not be empty"));
  CHECK(contains(program.line.parse({"command", "b", "--list", ""}).error, "must not be empty"));
  CHECK(program.line.parse({"command", "nan", "--list", "inf", "--flag", "--real", "0.5"}).error.empty());
}
