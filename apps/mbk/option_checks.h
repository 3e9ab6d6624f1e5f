#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace mbk::app {

inline constexpr double kMillimetres = 1000.0;   ///< in a metre: options say lengths in them
inline constexpr double kMilliseconds = 1000.0;  ///< in a second: options say delays in them

/// What an option's value may be. Each names the value and the limit; the parser's own checks print 300 digits, and let
/// empty values, "nan" and "inf" through.
[[nodiscard]] CLI::Validator positive();
[[nodiscard]] CLI::Validator not_negative();
[[nodiscard]] CLI::Validator number_within(double largest);  ///< from −largest to largest
[[nodiscard]] CLI::Validator whole_number(long least, long most);
[[nodiscard]] CLI::Validator odd_number(long least, long most);
[[nodiscard]] CLI::Validator not_empty();

/// One of a few words, which a shell offers too.
[[nodiscard]] CLI::Validator one_of(const std::vector<std::string>& words);

/// Words that the value can be, for a shell to offer; anything is let through.
[[nodiscard]] CLI::Validator suggests(const std::vector<std::string>& words);

/// The words of every one_of() and suggests() that `option` has.
[[nodiscard]] std::vector<std::string> suggestions(CLI::Option& option);

/// The name that `option` had until the version before: still read, but listed nowhere.
void accept_former_name(CLI::App& command, CLI::Option& option, const std::string& former);

/// What was given, as it stands in a message: 'abc', cut where it is long.
[[nodiscard]] std::string quoted(const std::string& given);

}  // namespace mbk::app
