#include "apps/mbk/terminal/command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <utility>

#include "apps/mbk/terminal/messages.h"
#include "apps/mbk/terminal/usage_error.h"

namespace mbk::app {
namespace {

constexpr std::string_view kSuggestions = "suggestions";  ///< the name of a validator begins so where words follow

}  // namespace

Option Option::type_name(const std::string& placeholder) const {
  option_->type_name(placeholder);
  return *this;
}

Option Option::option_text(const std::string& placeholder) const {
  option_->option_text(placeholder);
  return *this;
}

Option Option::description(const std::string& help) const {
  option_->description(help);
  return *this;
}

Option Option::group(const std::string& heading) const {
  option_->group(heading);
  return *this;
}

Option Option::check(const Check& check) const {
  CLI::Validator validator;
  if (check.wrong) validator.operation(check.wrong);
  if (!check.words.empty()) validator.name(fmt::format("{} {}", kSuggestions, fmt::join(check.words, " ")));
  option_->check(std::move(validator));
  return *this;
}

Option Option::check(std::function<std::string(const std::string&)> wrong) const {
  return check(Check{std::move(wrong)});
}

Option Option::required(bool yes) const {
  option_->required(yes);
  return *this;
}

Option Option::needs(Option other) const {
  option_->needs(other.option_);
  return *this;
}

Option Option::remove_needs(Option other) const {
  option_->remove_needs(other.option_);
  return *this;
}

Option Option::excludes(Option other) const {
  option_->excludes(other.option_);
  return *this;
}

Option Option::expected(int values) const {
  option_->expected(values);
  return *this;
}

Option Option::expected(int least, int most) const {
  option_->expected(least, most);
  return *this;
}

Option Option::default_str(const std::string& value) const {
  option_->default_str(value);
  return *this;
}

Option Option::delimiter(char between_values) const {
  option_->delimiter(between_values);
  return *this;
}

Option Option::allow_extra_args(bool allow) const {
  option_->allow_extra_args(allow);
  return *this;
}

Option Option::take_all() const {
  option_->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  return *this;
}

std::string Option::name() const {
  return option_->get_name();
}

bool Option::is_flag() const {
  return option_->get_items_expected_max() == 0;
}

bool Option::is_given() const {
  return option_->count() > 0;
}

bool Option::takes_following() const {
  return option_->get_allow_extra_args() && option_->get_items_expected_max() > 1;
}

std::vector<std::string> Option::values() const {
  return is_flag() ? std::vector<std::string>() : option_->results();
}

std::vector<std::string> Option::words() const {
  std::vector<std::string> words;
  for (int i = 0;; ++i) {
    try {
      std::istringstream name(option_->get_validator(i)->get_name());
      std::string word;
      if (!(name >> word) || word != kSuggestions) continue;
      while (name >> word) words.push_back(word);
    } catch (const CLI::OptionNotFound&) {
      return words;  // that was the last one
    }
  }
}

Command Command::add_command(const std::string& name, const std::string& summary) const {
  CLI::App* const below = app_->add_subcommand(name, summary);
  // The parser does not pass the name of an option that it does not list on to commands below.
  if (app_->get_help_all_ptr() != nullptr) below->set_help_all_flag(kHelpAll)->group("");
  return Command(*below);
}

template <class T>
Option Command::add_option(const std::string& name, T& variable, const std::string& help) const {
  return Option(*app_->add_option(name, variable, help));
}

Option Command::add_option_function(const std::string& name, const std::function<void(const std::string&)>& take,
                                    const std::string& help) const {
  return Option(*app_->add_option_function<std::string>(name, take, help));
}

Option Command::add_option_function(const std::string& name,
                                    const std::function<void(const std::vector<std::string>&)>& take,
                                    const std::string& help) const {
  return Option(*app_->add_option_function<std::vector<std::string>>(name, take, help));
}

Option Command::add_flag(const std::string& name, bool& variable, const std::string& help) const {
  return Option(*app_->add_flag(name, variable, help));
}

Option Command::add_flag_callback(const std::string& name, std::function<void()> given, const std::string& help) const {
  return Option(*app_->add_flag_callback(name, std::move(given), help));
}

Option Command::add_text_flag(const std::string& name, std::function<std::string()> text,
                              const std::string& help) const {
  return add_flag_callback(
      name, [text = std::move(text)] { throw CLI::CallForVersion(text(), 0); }, help);
}

void Command::accept_former_name(Option option, const std::string& former) const {
  CLI::Option& now = option.cli();
  add_option_function(
      former,
      [&now, former](const std::vector<std::string>& given) {
        say_former_name(former, now.get_name());
        for (const std::string& value : given) now.add_result(value);
        now.run_callback();
      },
      "")
      .expected(now.get_expected_min(), now.get_expected_max())
      .group("");
}

void Command::remove_option(const std::string& name) const {
  app_->remove_option(app_->get_option(name));
}

void Command::footer(const std::string& text) const {
  app_->footer(text);
}

void Command::footer(std::function<std::string()> text) const {
  app_->footer(std::move(text));
}

void Command::require_subcommand() const {
  app_->require_subcommand(1);
}

std::string Command::name() const {
  return app_->get_name();
}

Option Command::get_option(const std::string& name) const {
  return Option(*app_->get_option(name));
}

std::optional<Option> Command::find_option(const std::string& name) const {
  CLI::Option* const option = app_->get_option_no_throw(name);
  return option != nullptr ? std::optional(Option(*option)) : std::nullopt;
}

std::vector<Option> Command::options() const {
  std::vector<Option> options;
  for (CLI::Option* option : app_->get_options()) options.emplace_back(*option);
  return options;
}

std::vector<std::string> Command::option_names() const {
  std::vector<std::string> names;
  for (const CLI::Option* option : app_->get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

std::vector<Command> Command::commands() const {
  std::vector<Command> commands;
  for (CLI::App* below : app_->get_subcommands({})) commands.emplace_back(*below);
  return commands;
}

bool Command::has_typed(const std::string& below) const {
  return app_->got_subcommand(below);
}

bool Command::is_bare() const {
  return app_->count_all() <= 1;  // the command itself
}

Parser::Parser(const std::string& name, const std::string& description)
    : app_(std::make_unique<CLI::App>(description, name)) {
  app_->allow_windows_style_options(false);  // "/folder/file" is a file there, too
}

Parser::~Parser() = default;

tl::expected<void, NotTaken> Parser::parse(std::vector<std::string> words) const {
  std::ranges::reverse(words);  // the parser takes them from the end
  try {
    app_->parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    NotTaken why{error.what(), usage_message(command(), error), typed_command(command())};
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
      std::ostringstream answer, unused;
      answer.exceptions(std::ios::badbit);  // where there is no memory
      app_->exit(error, answer, unused);
      why.answer = answer.str();
    }
    return tl::unexpected(std::move(why));
  }
  return {};
}

// The types of variables that options have.
using Text = const std::string&;
template Option Command::add_option(Text, double&, Text) const;
template Option Command::add_option(Text, int&, Text) const;
template Option Command::add_option(Text, unsigned&, Text) const;
template Option Command::add_option(Text, std::int64_t&, Text) const;
template Option Command::add_option(Text, std::uint64_t&, Text) const;
template Option Command::add_option(Text, std::uint16_t&, Text) const;
template Option Command::add_option(Text, std::string&, Text) const;
template Option Command::add_option(Text, std::filesystem::path&, Text) const;
template Option Command::add_option(Text, std::optional<double>&, Text) const;
template Option Command::add_option(Text, std::optional<int>&, Text) const;
template Option Command::add_option(Text, std::optional<std::int64_t>&, Text) const;
template Option Command::add_option(Text, std::optional<std::uint64_t>&, Text) const;
template Option Command::add_option(Text, std::optional<std::string>&, Text) const;
template Option Command::add_option(Text, std::optional<std::filesystem::path>&, Text) const;
template Option Command::add_option(Text, std::vector<double>&, Text) const;
template Option Command::add_option(Text, std::vector<std::string>&, Text) const;
template Option Command::add_option(Text, std::vector<std::filesystem::path>&, Text) const;

}  // namespace mbk::app
