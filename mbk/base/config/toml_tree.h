#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "mbk/base/core/result.h"

namespace mbk::config {

inline constexpr std::size_t kLargestText = 1'000'000;  ///< bytes of a file
inline constexpr int kDeepestNesting = 32;              ///< arrays and inline tables within each other
inline constexpr int kLongestDottedKey = 32;            ///< parts of a.b.c

struct Node;
using Table = std::map<std::string, Node, std::less<>>;
using List = std::vector<Node>;

/// A date or time, which mbk never uses.
struct Date {};

/// A value of a TOML file and its line.
struct Node {
  int line = 0;  ///< from 1
  std::variant<Table, List, std::string, std::int64_t, double, bool, Date> value;
};

/// The tree of a TOML 1.0 text.
/// @fails  data: larger than kLargestText; nested deeper than kDeepestNesting; a key of more than kLongestDottedKey
///         parts; a syntax error (line, column, what is wrong).
[[nodiscard]] Result<Node> parse_toml(std::string_view text);

}  // namespace mbk::config
