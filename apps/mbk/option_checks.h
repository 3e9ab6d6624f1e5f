#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace mbk::app {

/// What an option's value may be. Each names the value and the limit; the parser's own checks print 300 digits, and let
/// empty values, "nan" and "inf" through.
[[nodiscard]] CLI::Validator positive();
[[nodiscard]] CLI::Validator not_negative();
[[nodiscard]] CLI::Validator whole_number(long least, long most);
[[nodiscard]] CLI::Validator odd_number(long least, long most);
[[nodiscard]] CLI::Validator not_empty();

/// What was given, as it stands in a message: 'abc', cut where it is long.
[[nodiscard]] std::string quoted(const std::string& given);

}  // namespace mbk::app
