#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace mbk {

/// Checks the value of an option.
struct OptionCheck {
  std::function<std::string(const std::string& given)> wrong;  ///< the error of a value; "": none
  std::vector<std::string> words = {};                         ///< possible values, for a shell to offer
};

/// Each error names the value and the limit. Empty values, "nan" and "inf" are rejected.
[[nodiscard]] OptionCheck positive();
[[nodiscard]] OptionCheck not_negative();
[[nodiscard]] OptionCheck number_within(double largest);  ///< from −largest to largest
[[nodiscard]] OptionCheck whole_number(std::int64_t least, std::int64_t most);
[[nodiscard]] OptionCheck odd_number(std::int64_t least, std::int64_t most);
[[nodiscard]] OptionCheck not_empty();

/// One of a few words, which a shell also offers.
[[nodiscard]] OptionCheck one_of(const std::vector<std::string>& words);

/// Words for a shell to offer; every value is accepted.
[[nodiscard]] OptionCheck suggests(const std::vector<std::string>& words);

/// The given value for a message: 'abc', truncated if it is long.
[[nodiscard]] std::string quoted(const std::string& given);

}  // namespace mbk
