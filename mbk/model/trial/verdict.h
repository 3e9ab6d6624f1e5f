#pragma once

#include "mbk/base/core/words.h"

namespace mbk {

/// What is known of a limb's passivity.
enum class Verdict {
  passive,    ///< it absorbs energy
  active,     ///< it generates energy
  undecided,  ///< the data do not say
};

[[nodiscard]] constexpr auto word_table(Verdict) {
  using enum Verdict;
  return std::to_array<Word<Verdict>>({{passive, "passive"}, {active, "active"}, {undecided, "undecided"}});
}

}  // namespace mbk
