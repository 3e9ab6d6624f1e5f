#pragma once

#include <string>
#include <vector>

#include "apps/mbk/terminal/command.h"

namespace mbk::app {

/// What an option's value may be. Each names the value and the limit; the parser's own checks print 300 digits, and let
/// empty values, "nan" and "inf" through.
[[nodiscard]] Check positive();
[[nodiscard]] Check not_negative();
[[nodiscard]] Check number_within(double largest);  ///< from −largest to largest
[[nodiscard]] Check whole_number(long least, long most);
[[nodiscard]] Check odd_number(long least, long most);
[[nodiscard]] Check not_empty();

/// One of a few words, which a shell offers too.
[[nodiscard]] Check one_of(const std::vector<std::string>& words);

/// Words that the value can be, for a shell to offer; anything is let through.
[[nodiscard]] Check suggests(const std::vector<std::string>& words);

/// What was given, as it stands in a message: 'abc', cut where it is long.
[[nodiscard]] std::string quoted(const std::string& given);

}  // namespace mbk::app
