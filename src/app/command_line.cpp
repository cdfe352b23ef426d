#include "app/command_line.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "app/command_spec.h"
#include "base/check.h"

namespace pocketray {
namespace {

// "-o,--output FILE" → names, the long one first, and metavar.
void split_name(const std::string& text, OptionSpec* option) {
  const std::size_t space = text.find(' ');
  std::string names = text.substr(0, space);
  if (space != std::string::npos) option->metavar = text.substr(space + 1);
  option->is_positional = names[0] != '-';
  for (std::size_t comma; !names.empty(); names = comma == std::string::npos ? "" : names.substr(comma + 1)) {
    comma = names.find(',');
    option->names.push_back(names.substr(0, comma));
  }
  std::stable_partition(option->names.begin(), option->names.end(),
                        [](const std::string& name) { return name.compare(0, 2, "--") == 0; });
  if (option->metavar[0] != '[') return;
  option->value_is_optional = true;
  option->metavar = option->metavar.substr(1, option->metavar.size() - 2);
}

OptionSpec* declare(CommandSpec* command, const std::string& name, ValueKind kind, const std::string& help) {
  auto option = std::make_unique<OptionSpec>();
  split_name(name, option.get());
  option->kind = kind;
  option->help = help;
  option->chapter = command->chapter;
  if (option->metavar.empty() && !option->is_positional)
    option->metavar = kind == ValueKind::text ? "VALUE" : kind == ValueKind::whole_number ? "N" : "X";
  for (const std::string& each : option->names) CHECK(find_option(*command, each) == nullptr);
  command->options.push_back(std::move(option));
  return command->options.back().get();
}

bool is_whole_number(const std::string& text) {
  const std::size_t sign = text[0] == '-' || text[0] == '+';
  return text.size() > sign && text.find_first_not_of("0123456789", sign) == std::string::npos;
}

// Stores a number of type T, from the text in full.
template <class T>
bool store_whole(const std::string& text, T* variable) {
  errno = 0;
  const long long value = is_whole_number(text) ? std::strtoll(text.c_str(), nullptr, 10) : 0;
  if (!is_whole_number(text) || errno || static_cast<long long>(static_cast<T>(value)) != value) return false;
  *variable = static_cast<T>(value);
  return true;
}

bool store_real(const std::string& text, double* variable) {
  char* end;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || std::isspace(static_cast<unsigned char>(text[0])) || *end || !std::isfinite(value)) return false;
  *variable = value;
  return true;
}

std::string text_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

}  // namespace

Option Option::required() { return spec_->is_required = true, *this; }

Option Option::capture_default_str() { return default_str(spec_->current()); }

Option Option::default_str(const std::string& text) { return spec_->default_text = text, *this; }

Option Option::details(const std::string& text) { return spec_->details = text, *this; }

Option Option::price(const std::string& text) { return spec_->price = text, *this; }

Option Option::hidden() { return spec_->is_hidden = true, *this; }

Option Option::needs(Option other) { return spec_->needs.push_back(other.spec_), *this; }

Option Option::excludes(Option other, const std::string& because) {
  spec_->excludes.push_back({other.spec_, because});
  other.spec_->excludes.push_back({spec_, because});
  return *this;
}

Option Option::one_value_each() { return spec_->one_value_each = true, *this; }

Option Option::check(std::function<std::string(const std::string& text)> refusal) {
  return spec_->checks.push_back(std::move(refusal)), *this;
}

Option Option::one_of(const std::vector<std::string>& values) { return spec_->choices = values, *this; }

Option Option::range(double low, double high) {
  CHECK_LE(low, high);
  spec_->has_range = true, spec_->low = low, spec_->high = high;
  return *this;
}

std::size_t Option::count() const { return spec_->count; }

Command Command::add_subcommand(const std::string& name, const std::string& help) {
  auto command = std::make_unique<CommandSpec>();
  command->name = name;
  command->help = help;
  command->group = spec_->chapter;
  command->parent = spec_;
  spec_->commands.push_back(std::move(command));
  return Command(spec_->commands.back().get());
}

Option Command::add_option(const std::string& name, std::string& variable, const std::string& help) {
  OptionSpec* option = declare(spec_, name, ValueKind::text, help);
  option->store = [&variable](const std::string& text) { return variable = text, true; };
  option->current = [&variable] { return variable; };
  return Option(option);
}

Option Command::add_option(const std::string& name, std::vector<std::string>& variable, const std::string& help) {
  OptionSpec* option = declare(spec_, name, ValueKind::text, help);
  option->is_list = true;
  option->store = [option, &variable](const std::string& text) {
    if (option->value_count++ == 0) variable.clear();  // the default
    return variable.push_back(text), true;
  };
  option->current = [&variable] { return enumerated(variable, " and "); };
  return Option(option);
}

Option Command::add_option(const std::string& name, int& variable, const std::string& help) {
  OptionSpec* option = declare(spec_, name, ValueKind::whole_number, help);
  option->store = [&variable](const std::string& text) { return store_whole(text, &variable); };
  option->current = [&variable] { return std::to_string(variable); };
  return Option(option);
}

Option Command::add_option(const std::string& name, std::uint32_t& variable, const std::string& help) {
  OptionSpec* option = declare(spec_, name, ValueKind::whole_number, help);
  option->store = [&variable](const std::string& text) { return store_whole(text, &variable); };
  option->current = [&variable] { return std::to_string(variable); };
  return Option(option);
}

Option Command::add_option(const std::string& name, float& variable, const std::string& help) {
  OptionSpec* option = declare(spec_, name, ValueKind::number, help);
  option->store = [&variable](const std::string& text) {
    double value = 0;
    if (!store_real(text, &value) || !std::isfinite(static_cast<float>(value))) return false;
    return variable = static_cast<float>(value), true;
  };
  option->current = [&variable] { return text_of(static_cast<double>(variable)); };
  return Option(option);
}

Option Command::add_option(const std::string& name, double& variable, const std::string& help) {
  OptionSpec* option = declare(spec_, name, ValueKind::number, help);
  option->store = [&variable](const std::string& text) { return store_real(text, &variable); };
  option->current = [&variable] { return text_of(variable); };
  return Option(option);
}

Option Command::add_flag(const std::string& name, bool& variable, const std::string& help) {
  OptionSpec* option = declare(spec_, name, ValueKind::flag, help);
  option->metavar = "";
  option->store = [&variable](const std::string&) { return variable = true; };
  return Option(option);
}

Option Command::get_option(const std::string& name) const {
  OptionSpec* option = find_option(*spec_, name);
  CHECK(option != nullptr);
  return Option(option);
}

void Command::chapter(const std::string& title) { spec_->chapter = title; }

void Command::everyday(const std::string& heading, const std::vector<std::string>& names) {
  EverydayGroup group = {heading, {}};
  for (const std::string& name : names)
    if (const OptionSpec* option = find_option(*spec_, name)) group.options.push_back(option);
  if (!group.options.empty()) spec_->everyday.push_back(group);
}

void Command::example(const std::string& line) { spec_->examples.push_back(line); }

void Command::about(const std::string& paragraph) { spec_->about.push_back(paragraph); }

void Command::footer(const std::string& text) { spec_->footer = text; }

void Command::callback(std::function<void()> run) { spec_->run = std::move(run); }

CommandLine::CommandLine(const std::string& program_name, const std::string& description)
    : program_(std::make_unique<CommandSpec>()) {
  program_->name = program_name;
  program_->help = description;
}

CommandLine::~CommandLine() = default;

void CommandLine::set_version(const std::string& text) { version_ = text; }

void CommandLine::set_style(const TextStyle& style) { style_ = style; }

}  // namespace pocketray
