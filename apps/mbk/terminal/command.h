#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "mbk/base/core/option_checks.h"

// Every source of a command includes this; CLI11 itself only those that implement it and read the whole tree.
namespace CLI {  // NOLINT(readability-identifier-naming): their name
class App;
class Option;
class ParseError;
}  // namespace CLI

namespace mbk::app {

using Check = OptionCheck;

/// Prints the same as --help; read, but not listed.
inline constexpr const char* kHelpAll = "--help-all";

/// An option, flag or positional argument of a command. A handle: copies refer to the same option. Setters return it,
/// so that calls can be chained.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(&option) {}

  Option type_name(const std::string& placeholder) const;
  Option option_text(const std::string& placeholder) const;  ///< replaces the placeholder in --help
  Option description(const std::string& help) const;
  Option group(const std::string& heading) const;  ///< its heading in --help; "": not listed
  Option check(const Check& check) const;
  Option check(std::function<std::string(const std::string& given)> wrong) const;
  Option required(bool yes = true) const;
  Option needs(Option other) const;
  Option remove_needs(Option other) const;
  Option excludes(Option other) const;
  Option expected(int values) const;
  Option expected(int least, int most) const;
  Option default_str(const std::string& value) const;  ///< its value if it is given without one
  Option delimiter(char between_values) const;
  Option allow_extra_args(bool allow) const;  ///< whether it takes several values each time it is given
  Option take_all() const;                    ///< it may be given several times, and all values are kept

  [[nodiscard]] std::string name() const;  ///< "--cutoff", "FILE"
  [[nodiscard]] bool is_flag() const;
  [[nodiscard]] bool is_given() const;
  [[nodiscard]] bool takes_following() const;             ///< several words may follow it
  [[nodiscard]] std::vector<std::string> values() const;  ///< the given values; none for a flag
  [[nodiscard]] std::vector<std::string> words() const;   ///< the possible words of all its checks

  [[nodiscard]] CLI::Option& cli() const { return *option_; }

 private:
  CLI::Option* option_;
};

/// A command of the program, or the program itself. A handle, as Option is.
class Command {
 public:
  explicit Command(CLI::App& app) : app_(&app) {}

  /// A command below this one.
  Command add_command(const std::string& name, const std::string& summary) const;

  /// An option whose value goes into `variable`, of one of the types at the end of command.cpp.
  template <class T>
  Option add_option(const std::string& name, T& variable, const std::string& help) const;
  /// An option whose value, or values, `take` gets.
  Option add_option_function(const std::string& name, const std::function<void(const std::string&)>& take,
                             const std::string& help) const;
  Option add_option_function(const std::string& name, const std::function<void(const std::vector<std::string>&)>& take,
                             const std::string& help) const;
  Option add_flag(const std::string& name, bool& variable, const std::string& help) const;
  Option add_flag_callback(const std::string& name, std::function<void()> given, const std::string& help) const;
  /// A flag that prints a text instead of running the command.
  Option add_text_flag(const std::string& name, std::function<std::string()> text, const std::string& help) const;
  /// The former name of `option`: still read, with a warning, but not listed.
  void accept_former_name(Option option, const std::string& former) const;
  void remove_option(const std::string& name) const;

  void footer(const std::string& text) const;
  void footer(std::function<std::string()> text) const;  ///< made on demand
  void require_subcommand() const;                       ///< it does nothing without one

  [[nodiscard]] std::string name() const;
  [[nodiscard]] Option get_option(const std::string& name) const;  ///< one that it has
  [[nodiscard]] std::optional<Option> find_option(const std::string& name) const;
  [[nodiscard]] std::vector<Option> options() const;
  [[nodiscard]] std::vector<std::string> option_names() const;   ///< as typed: "--cutoff", "-o"
  [[nodiscard]] std::vector<Command> commands() const;           ///< its direct subcommands
  [[nodiscard]] bool has_typed(const std::string& below) const;  ///< whether this subcommand was typed
  [[nodiscard]] bool is_bare() const;  ///< whether it was typed without any option or argument

  [[nodiscard]] CLI::App& cli() const { return *app_; }

 private:
  CLI::App* app_;
};

/// Why the words of a command line were not accepted.
struct NotTaken {
  std::string what;     ///< in the parser's words
  std::string usage;    ///< the same in one sentence without a full stop, with a suggestion
  std::string command;  ///< the typed command with its parents: "mbk study add"; "mbk" if there is none
  std::optional<std::string> answer = {};  ///< not an error: they request this text, as --help does
};

/// Parses words: the command above all others, or a single command.
class Parser {
 public:
  explicit Parser(const std::string& name = "", const std::string& description = "");
  ~Parser();
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;

  [[nodiscard]] Command command() const { return Command(*app_); }

  /// Sets the variables of the options.
  [[nodiscard]] tl::expected<void, NotTaken> parse(std::vector<std::string> words) const;

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace mbk::app
