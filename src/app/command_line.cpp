#include "app/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <utility>

#include "base/check.h"

namespace pocketray {
namespace {

// CLI11's range checks accept a NaN, which is neither below nor above.
std::string refuse_meaningless(const std::string& text, bool is_real) {
  if (text.empty()) return "must not be empty";
  return is_real && !std::isfinite(std::strtod(text.c_str(), nullptr)) ? "must be a finite number" : "";
}

// Number of letters to insert, delete or replace to turn one word into the other [Wagner & Fischer 1974].
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t corner = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = corner + (a[i] != b[j]);
      corner = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, corner + 1});
    }
  }
  return row.back();
}

// ", did you mean 'render'?", or empty if no name is close.
std::string suggestion(const std::string& word, const std::vector<std::string>& names) {
  std::string nearest;
  std::size_t least = 1 + std::min<std::size_t>(word.size() / 3, 3);
  for (const std::string& name : names) {
    const std::size_t distance = edit_distance(word, name);
    if (distance < least) least = distance, nearest = name;
  }
  return nearest.empty() ? "" : ", did you mean '" + nearest + "'?";
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

// Names the wrong word, if any: an unknown command, or an unknown option of a command.
std::string unknown_word(const CLI::App& app, const std::vector<std::string>& words) {
  if (words.empty()) return "";
  const CLI::App* command = nullptr;
  std::vector<std::string> names;
  for (const CLI::App* each : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(each->get_name());
    if (each->get_name() == words[0]) command = each;
  }
  if (!names.empty() && !command && words[0][0] != '-')
    return "there is no command '" + words[0] + "'" + suggestion(words[0], names);
  const std::vector<std::string> options = option_names(command ? *command : app);
  for (const std::string& word : words) {
    const std::string name = word.substr(0, word.find('='));
    if (name.compare(0, 2, "--") == 0 && std::find(options.begin(), options.end(), name) == options.end())
      return "there is no option " + name + suggestion(name, options);
  }
  return "";
}

}  // namespace

Option Option::required() { return Option(option_->required()); }

Option Option::capture_default_str() { return Option(option_->capture_default_str()); }

Option Option::default_str(const std::string& text) { return Option(option_->default_str(text)); }

Option Option::group(const std::string& name) { return Option(option_->group(name)); }

Option Option::needs(Option other) { return Option(option_->needs(other.option_)); }

Option Option::excludes(Option other) { return Option(option_->excludes(other.option_)); }

Option Option::expected(int value_count_min, int value_count_max) {
  return Option(option_->expected(value_count_min, value_count_max));
}

Option Option::allow_extra_args(bool allowed) { return Option(option_->allow_extra_args(allowed)); }

Option Option::check(std::function<std::string(const std::string& text)> refusal) {
  return Option(option_->check(std::move(refusal)));
}

Option Option::one_of(const std::vector<std::string>& values) { return Option(option_->check(CLI::IsMember(values))); }

Option Option::range(int low, int high) { return Option(option_->check(CLI::Range(low, high))); }

Option Option::range(std::uint32_t low, std::uint32_t high) { return Option(option_->check(CLI::Range(low, high))); }

Option Option::range(float low, float high) { return Option(option_->check(CLI::Range(low, high))); }

Option Option::range(double low, double high) { return Option(option_->check(CLI::Range(low, high))); }

std::size_t Option::count() const { return option_->count(); }

Command Command::add_subcommand(const std::string& name, const std::string& help) {
  return Command(app_->add_subcommand(name, help));
}

Option Command::add_option(const std::string& name, std::string& variable, const std::string& help) {
  return Option(app_->add_option(name, variable, help));
}

Option Command::add_option(const std::string& name, std::vector<std::string>& variable, const std::string& help) {
  return Option(app_->add_option(name, variable, help));
}

Option Command::add_option(const std::string& name, int& variable, const std::string& help) {
  return Option(app_->add_option(name, variable, help));
}

Option Command::add_option(const std::string& name, std::uint32_t& variable, const std::string& help) {
  return Option(app_->add_option(name, variable, help));
}

Option Command::add_option(const std::string& name, float& variable, const std::string& help) {
  return Option(app_->add_option(name, variable, help));
}

Option Command::add_option(const std::string& name, double& variable, const std::string& help) {
  return Option(app_->add_option(name, variable, help));
}

Option Command::add_flag(const std::string& name, bool& variable, const std::string& help) {
  return Option(app_->add_flag(name, variable, help));
}

Option Command::get_option(const std::string& name) const {
  CLI::Option* option = app_->get_option_no_throw(name);
  CHECK(option != nullptr);
  return Option(option);
}

void Command::footer(const std::string& text) { app_->footer(text); }

void Command::callback(std::function<void()> run) { app_->callback(std::move(run)); }

CommandLine::CommandLine(const std::string& program_name, const std::string& description)
    : app_(std::make_unique<CLI::App>(description, program_name)) {}

CommandLine::~CommandLine() = default;

void CommandLine::set_version_flag(const std::string& name, const std::string& version) {
  app_->set_version_flag(name, version);
}

void CommandLine::require_subcommand(int count) { app_->require_subcommand(count); }

void CommandLine::refuse_meaningless_values() {
  for (CLI::App* command : app_->get_subcommands({}))
    for (CLI::Option* option : command->get_options()) {
      if (option->get_items_expected_min() == 0) continue;  // a flag, or an optional value
      bool is_real = option->get_type_name().compare(0, 5, "FLOAT") == 0;
      option->check([is_real](const std::string& text) { return refuse_meaningless(text, is_real); });
    }
}

ParseResult CommandLine::parse(const std::vector<std::string>& words) {
  ParseResult result;
  try {
    app_->parse(std::vector<std::string>(words.rbegin(), words.rend()));  // CLI11 takes the last word first
  } catch (const CLI::ValidationError& error) {
    result.error = error.what();
  } catch (const CLI::ConversionError& error) {
    result.error = error.what();
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) {
      result.usage = true;
      result.error = unknown_word(*app_, words);
      if (result.error.empty()) result.error = error.what();
    } else {
      std::ostringstream help;
      app_->exit(error, help);
      result.help = help.str();
    }
  }
  return result;
}

}  // namespace pocketray
