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
  double wide = 0.25, open = 0;
  bool flag = false;
  int runs = 0;
};

// A program with one command, which has an option of each type.
struct Program {
  CommandLine line{"program", "describes the program"};
  Values values;
  Command command = line.program().add_subcommand("command", "describes the command");
  Program() {
    line.set_version("1.2.3\n");
    command.add_option("TEXT", values.text, "help on text").required();
    command.add_option("--list", values.list, "help on list").one_value_each();
    command.add_option("--signed", values.signed_count, "help on signed").range(-2, 2);
    command.add_option("--count", values.count, "help on count").range(1, 5).capture_default_str();
    command.add_option("--real", values.real, "help on real").range(0, 1);
    command.add_option("--wide", values.wide, "help on wide").range(0, 1);
    command.add_option("--open", values.open, "help on open, without a range");
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
  const Wrong lines[] = {{{}, "name a command"},
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
                         {{"command", "b", "--wide"}, "--wide needs a value: --wide X, 0 … 1"},
                         {{"command", "b", "--count", "--flag"}, "--count needs a value: --count N, 1 … 5"},
                         {{"command", "b", "--count=9"}, "--count is 9: it must lie in 1 … 5"},
                         {{"command", "b", "--count", "4294967297"}, "--count is 4294967297: it must lie in 1 … 5"},
                         {{"command", "b", "--count", "0x3"}, "--count is '0x3': it must be a whole number in 1 … 5"},
                         {{"command", "b", "--count", " 3"}, "--count is ' 3': it must be a whole number"},
                         {{"command", "b", "--real", " .5"}, "--real is ' .5': it must be a finite number in 0 … 1"},
                         {{"command", "b", "--flag=yes"}, "--flag takes no value, here 'yes'"},
                         {{"command", "b", "--flag", "--flag"}, "--flag is given twice"},
                         {{"command", "b", "--", "--flag"}, "'--flag' is one argument too many"}};
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
      {{"something"}, "there is no command 'something'; `program help` lists them"},
      {{"help", "comand"}, "there is no command 'comand', did you mean 'command'?"},
      {{"help", "command", "reel"}, "there is no option --reel, did you mean '--real'?"},
      {{"command", "--help", "--reel"}, "there is no option --reel, did you mean '--real'?"},
      {{"command", "b", "-list", "c"}, "there is no option -list, did you mean '--list'?"},
      {{"other", "--real", "1"}, "there is no option --real in other; command has one"},
      {{"--real", "1"}, "there is no option --real before the command; command has one"},
      {{"--verson"}, "there is no option --verson, did you mean '--version'?"},
      {{"command", "b", "--reel=1"}, "there is no option --reel, did you mean '--real'?"},
      {{"command", "b", "--count", "3", "--lits", "c"}, "there is no option --lits, did you mean '--list'?"},
      {{"command", "b", "--nonsense"}, "there is no option --nonsense; `program command --help-all` lists them"}};
  for (const Misspelt& line : lines) {
    Program program;
    program.line.program().add_subcommand("other", "describes the other command");
    const ParseResult parsed = program.line.parse(line.words);
    CHECK(parsed.error == line.error);
    CHECK(parsed.usage);
  }
  Program program;
  CHECK_FALSE(program.line.parse({"command", "b", "--count", "6"}).usage);
  CHECK_FALSE(program.line.parse({"command", "b", "--count", "x"}).usage);
  CHECK(program.line.parse({"command"}).usage);
}

// Goal: help and version are returned and are no error; no command is called. Method: every way to ask for each.
TEST_CASE("command_line_returns_help") {
  Program program;
  auto help = [&](const std::vector<std::string>& words) {
    const ParseResult parsed = program.line.parse(words);
    CHECK(parsed.error.empty());
    return parsed.help;
  };
  for (const char* word : {"--help", "-h", "help"}) {
    CHECK(contains(help({word}), "describes the program\n"));
    CHECK(contains(help({word}), "  command  describes the command\n"));
    CHECK(contains(help({word, "command"}), "Usage: program command TEXT [options]\nDescribes the command.\n"));
  }
  const std::string command = help({"command", "--help"});
  CHECK(contains(command, "  TEXT          help on text\n"));
  CHECK(contains(command, "  --count N     help on count (1 … 5; default 1)\n"));
  CHECK(command == help({"help", "command"}));
  CHECK(command == help({"command", "b", "--flag", "-h"}));
  for (const auto& words : {std::vector<std::string>{"command", "--help", "--count"},
                            {"command", "--help", "count"},
                            {"help", "command", "count"},
                            {"help", "command", "--count"}})
    CHECK(help(words) == "Usage: program command … --count N\n\nHelp on count.\n\n  Range     1 … 5\n  Default   1\n");
  for (const char* word : {"version", "--version", "-V", "-v"}) CHECK(help({word}) == "1.2.3\n");
  CHECK(program.values.runs == 0);
}

// Goal: help shows everyday options on one line each, and the others by chapter in full. Method: options in two
// chapters; one of them is everyday, one hidden.
TEST_CASE("command_line_help_is_short_or_full") {
  CommandLine line("program", "");
  Command command = line.program();
  std::uint32_t count = 3;
  std::string name, secret;
  command.chapter("Common");
  command.add_option("-c,--count N", count, "how many").range(1, 5).capture_default_str();
  command.chapter("Rare");
  command.add_option("--name [NAME]", name, "a name").one_of({"a", "b"}).default_str("a").details("Its details.");
  command.add_option("--secret X", secret, "a secret").hidden();
  command.everyday("Daily", {"--count", "--of-another-build"});
  command.about("How it works.");
  const std::string help = line.parse({"--help"}).help, everything = line.parse({"--help-all"}).help;
  CHECK(contains(help, "\nDaily\n  -c, --count N  how many [3]\n"));
  CHECK(contains(everything, "\nCommon\n  -c, --count N  how many (1 … 5; default 3)\n"));
  CHECK(contains(everything, "\nRare\n  --name [NAME]  a name: a or b (default a)\n"));
  CHECK(contains(everything, "How it works."));
  for (const char* part : {"--name", "Rare", "How it works", "--secret"}) CHECK_FALSE(contains(help, part));
  CHECK_FALSE(contains(everything, "--secret"));
  CHECK(contains(line.parse({"--help", "name"}).help, "A name.\nIts details.\n\n  Values    a or b\n  Default   a\n"));
}

// Goal: help fits the style. Method: every width; headings are bold only if asked; without UTF-8 all bytes are ASCII.
TEST_CASE("command_line_help_has_a_style") {
  Program program;
  program.command.add_option("--long WHAT", program.values.text, "an option × with a … long text, ꟻLIP → wrapped");
  for (int columns = 40; columns <= 120; ++columns)
    for (bool ascii : {false, true}) {
      TextStyle style;
      style.column_count = columns;
      style.ascii_only = ascii;
      program.line.set_style(style);
      const std::string help = program.line.parse({"command", "--help"}).help;
      CHECK_FALSE(contains(help, "\033"));
      CHECK(contains(help, ascii ? "1 ... 5" : "1 … 5"));
      int width = 0;
      for (char c : help) {
        if (ascii) CHECK(static_cast<unsigned char>(c) < 0x80);
        width = c == '\n' ? 0 : width + ((static_cast<unsigned char>(c) & 0xc0) != 0x80);
        CHECK(width <= columns);
      }
    }
  TextStyle bold;
  bold.bold = true;
  program.line.set_style(bold);
  CHECK(contains(program.line.parse({"command", "--help"}).help, "\n\033[1mOptions\033[0m\n"));
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
    Option optional = command.add_option("--third [X]", third, "").excludes(one, "both are ordinal");
    command.add_option("--shown X", shown, "").default_str("in words");
    command.add_option("--hidden", hidden, "").hidden();
    std::string error = line.parse(words).error;
    third_count = optional.count();
    CHECK(contains(help_entry(&line, "--shown"), "Default in words"));
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
  CHECK(parse({"--first", "a", "--third"}) == "--first excludes --third: both are ordinal; drop one of them");
  CHECK(parse({"--third", "--first", "a"}) == "--first excludes --third: both are ordinal; drop one of them");
  CHECK(parse({"--hidden", "x"}) == "");
  CHECK(hidden == "x");
}

// Goal: no number is NaN or infinite, and no value empty. Method: such values for each type, where only reals refuse
// "nan" by this rule; a flag has no value to check.
TEST_CASE("command_line_refuses_meaningless_values") {
  for (const char* option : {"--real", "--wide", "--open"})
    for (const char* value : {"nan", "-nan", "inf", "-inf", "1e999"}) {
      CAPTURE(option);
      CAPTURE(value);
      Program program;
      CHECK(contains(program.line.parse({"command", "b", option, value}).error, option));
    }
  Program program;
  CHECK(contains(program.line.parse({"command", ""}).error, "must not be empty"));
  CHECK(contains(program.line.parse({"command", "b", "--list", ""}).error, "must not be empty"));
  CHECK(program.line.parse({"command", "nan", "--list", "inf", "--flag", "--real", "0.5"}).error.empty());
}

// Goal: a list takes the words up to the next option, and leaves a required argument its word; so does an optional
// value.
TEST_CASE("command_line_leaves_words_to_arguments") {
  std::string text, maybe;
  std::vector<std::string> list = {"default"};
  auto parse = [&](const std::vector<std::string>& words) {
    text = maybe = "";
    list = {"default"};
    CommandLine line("program", "");
    Command command = line.program();
    command.add_option("TEXT", text, "").required();
    command.add_option("--list X", list, "");
    command.add_option("--maybe [X]", maybe, "");
    return line.parse(words).error;
  };
  const auto words = [](std::initializer_list<const char*> each) {
    return std::vector<std::string>(each.begin(), each.end());
  };
  CHECK(parse({"--list", "a", "b", "c"}) == "");
  CHECK(list == words({"a", "b"}));
  CHECK(text == "c");
  CHECK(parse({"t", "--list", "a", "b", "--maybe", "--list=c"}) == "");
  CHECK(list == words({"a", "b", "c"}));
  CHECK(parse({"--maybe", "t"}) == "");
  CHECK(text == "t");
  CHECK(maybe == "");
  CHECK(parse({"--maybe", "m", "t"}) == "");
  CHECK(maybe == "m");
  CHECK(parse({"-", "--maybe", "-"}) == "");
  CHECK(text == "-");
  CHECK(maybe == "-");
  CHECK(parse({"--", "--list"}) == "");
  CHECK(text == "--list");
  CHECK(list == words({"default"}));
}
