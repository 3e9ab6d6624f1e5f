#pragma once

#include <string_view>

namespace mbk {

/// What is known of a limb's passivity.
enum class Verdict {
  passive,    ///< it absorbs energy
  active,     ///< it generates energy
  undecided,  ///< the data do not say
};

[[nodiscard]] constexpr std::string_view text(Verdict verdict) {
  switch (verdict) {
    case Verdict::passive:
      return "passive";
    case Verdict::active:
      return "active";
    case Verdict::undecided:
      return "undecided";
  }
  return "unknown";
}

}  // namespace mbk
