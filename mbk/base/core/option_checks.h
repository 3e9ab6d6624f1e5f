#pragma once

#include <functional>
#include <string>
#include <vector>

namespace mbk {

/// What the value of an option may be.
struct OptionCheck {
  std::function<std::string(const std::string& given)> wrong;  ///< what is wrong with a value; "": nothing
  std::vector<std::string> words = {};                         ///< that it can be, for a shell to offer
};

/// Each names the value and the limit, and lets neither empty values nor "nan" and "inf" through.
[[nodiscard]] OptionCheck positive();
[[nodiscard]] OptionCheck not_negative();
[[nodiscard]] OptionCheck number_within(double largest);  ///< from −largest to largest
[[nodiscard]] OptionCheck whole_number(long least, long most);
[[nodiscard]] OptionCheck odd_number(long least, long most);
[[nodiscard]] OptionCheck not_empty();

/// One of a few words, which a shell offers too.
[[nodiscard]] OptionCheck one_of(const std::vector<std::string>& words);

/// Words that the value can be, for a shell to offer; anything is let through.
[[nodiscard]] OptionCheck suggests(const std::vector<std::string>& words);

/// What was given, as it stands in a message: 'abc', cut where it is long.
[[nodiscard]] std::string quoted(const std::string& given);

}  // namespace mbk
