#include "mbk/base/core/edit_distance.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace mbk {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j + 1] + 1, row[j] + 1});
    }
  }
  return row.back();
}

std::string meant_word(std::string_view word, std::span<const std::string> known) {
  constexpr std::size_t kLongest = 100;
  if (word.size() > kLongest) return "";
  std::string meant;
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : known) {
    const std::size_t d = edit_distance(word, candidate);
    if (d < least && d < candidate.size()) {
      least = d;
      meant = candidate;
    }
  }
  return meant;
}

}  // namespace mbk
