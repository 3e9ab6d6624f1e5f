#pragma once

#include <cstddef>
#include <string_view>

namespace mbk {

/// Levenshtein's distance: the fewest insertions, deletions and replacements of a byte that turn a into b.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

}  // namespace mbk
