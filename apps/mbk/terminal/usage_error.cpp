#include "apps/mbk/terminal/usage_error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "mbk/base/core/edit_distance.h"

namespace mbk::app {
namespace {

/// The innermost command that was typed.
Command chosen(Command app) {
  const auto parts = app.cli().get_subcommands();
  return parts.empty() ? app : chosen(Command(*parts.front()));
}

std::vector<std::string> part_names(Command command) {
  std::vector<std::string> names;
  for (const Command part : command.commands()) names.push_back(part.name());
  return names;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& known) {
  const std::string meant = meant_word(word, known);
  return meant.empty() ? "" : fmt::format("; did you mean '{}'?", meant);
}

/// The message for a word that no option or argument takes.
std::string unknown_word(Command command, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  if (name.size() > 1 && name.front() == '-') {
    return fmt::format("unknown option '{}'{}", name, did_you_mean(name, command.option_names()));
  }
  if (const std::vector<std::string> parts = part_names(command); !parts.empty()) {
    return fmt::format("unknown command '{}'{}", word, did_you_mean(word, parts));
  }
  return fmt::format("unexpected argument '{}' for '{}'", word, typed_command(command));
}

/// The words before and after `between`; nothing if `text` does not contain it.
std::optional<std::pair<std::string, std::string>> split_at(std::string_view text, std::string_view between) {
  const std::size_t at = text.find(between);
  if (at == std::string_view::npos) return std::nullopt;
  return std::pair(std::string(text.substr(0, at)), std::string(text.substr(at + between.size())));
}

/// The parser's message about the number of values of an option, in plain words.
std::string count_message(const std::string& said) {
  constexpr std::string_view kReceived = " required but received ";
  for (const auto& [between, how] : {std::pair(": At Most ", "at most"), std::pair(": At least ", "at least")}) {
    const auto name_and_counts = split_at(said, between);
    if (!name_and_counts) continue;
    const auto counts = split_at(name_and_counts->second, kReceived);
    if (!counts) continue;
    return fmt::format("{} takes {} {} value{}, but {} {} given", name_and_counts->first, how, counts->first,
                       counts->first == "1" ? "" : "s", counts->second, counts->second == "1" ? "was" : "were");
  }
  constexpr std::string_view kMissing = " missing";
  const auto name_and_type = split_at(said, ": 1 required ");
  if (name_and_type && name_and_type->second.ends_with(kMissing)) {
    const std::string& type = name_and_type->second;
    return fmt::format("{} needs a value ({})", name_and_type->first, type.substr(0, type.size() - kMissing.size()));
  }
  return said;
}

}  // namespace

std::string usage_message(Command app, const CLI::ParseError& error) {
  const Command command = chosen(app);
  const std::string said = error.what();
  const auto is = [&](CLI::ExitCodes kind) { return error.get_exit_code() == static_cast<int>(kind); };
  std::vector<std::string> left = command.cli().remaining();
  if (left.empty()) left = app.cli().remaining(true);
  const std::vector<std::string> parts = part_names(command);
  const bool wants_part = !parts.empty() && command.cli().get_require_subcommand_min() > 0;
  if (is(CLI::ExitCodes::ExtrasError) || (is(CLI::ExitCodes::RequiredError) && wants_part && !left.empty())) {
    return left.empty() ? said : unknown_word(command, left.front());
  }
  if (is(CLI::ExitCodes::RequiredError) && wants_part) {
    return &command.cli() == &app.cli()
               ? "the command is missing"
               : fmt::format("the subcommand is missing; choose one of {}", fmt::join(parts, ", "));
  }
  if (is(CLI::ExitCodes::ArgumentMismatch)) return count_message(said);
  if (const auto both = is(CLI::ExitCodes::ExcludesError) ? split_at(said, " excludes ") : std::nullopt) {
    return fmt::format("{} and {} cannot be given together", both->first, both->second);
  }
  if (const auto both = is(CLI::ExitCodes::RequiresError) ? split_at(said, " requires ") : std::nullopt) {
    return fmt::format("{} is valid only with {}", both->first, both->second);
  }
  return said;
}

std::string typed_command(Command app) {
  const CLI::App& command = chosen(app).cli();
  std::string name = command.get_name();
  for (const CLI::App* above = command.get_parent(); above != nullptr; above = above->get_parent()) {
    if (!above->get_name().empty()) name = above->get_name() + " " + name;
  }
  return name;
}

}  // namespace mbk::app
