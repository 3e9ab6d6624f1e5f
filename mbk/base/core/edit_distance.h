#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace mbk {

/// Levenshtein's distance: the fewest insertions, deletions and replacements of a byte that turn a into b.
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The known word that `word` was probably meant to be: the nearest within a third of its letters, or two; the first of
/// several. Empty if there is none, and for more than 100 letters.
[[nodiscard]] std::string meant_word(std::string_view word, std::span<const std::string> known);

}  // namespace mbk
