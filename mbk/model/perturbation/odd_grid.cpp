#include "mbk/model/perturbation/odd_grid.h"

#include <fmt/format.h>

#include "mbk/base/numeric/random.h"
#include "mbk/model/perturbation/multisine.h"

namespace mbk::perturbation {

Result<std::vector<int>> odd_grid(int highest, int group, std::uint64_t seed) {
  if (highest < 1 || highest > Multisine::kHighestHarmonic) {
    return bad_usage(
        fmt::format("the highest odd harmonic {} is not within 1 to {}", highest, Multisine::kHighestHarmonic));
  }
  if (group < 0 || group == 1) {
    return bad_usage(fmt::format("omitting one of every {} harmonics leaves none", group), "choose 2 or more, or 0");
  }
  std::vector<int> lines;
  numeric::Random random(seed, 20);
  const int count = (highest + 1) / 2;
  for (int first = 0; first<count; first += group> 0 ? group : count) {
    const int size = group > 0 ? group : count;
    const bool whole = group == 0 || first + size > count;
    const int left_out = whole ? -1 : first + static_cast<int>(random.below(static_cast<std::uint64_t>(size)));
    for (int k = first; k < first + size && k < count; ++k) {
      if (k != left_out) lines.push_back(2 * k + 1);
    }
  }
  return lines;
}

}  // namespace mbk::perturbation
