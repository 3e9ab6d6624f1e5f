#include "mbk/experiment/console/refusals.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace mbk::console {

bool Refusals::take(Refusal kind, Time now) {
  if (!begin_) begin_ = now;
  return ++counts_[static_cast<std::size_t>(kind)] <= kSaid;
}

std::optional<std::string> Refusals::summary(Time now, bool last) {
  if (!begin_ || (!last && now - *begin_ < kSpell)) return std::nullopt;
  begin_.reset();
  const auto counts = std::exchange(counts_, {});
  std::uint64_t all = 0;
  std::string kinds;
  for (std::size_t k = 0; k < kRefusals; ++k) {
    const std::uint64_t unsaid = counts[k] - std::min(counts[k], kSaid);
    if (unsaid == 0) continue;
    all += unsaid;
    kinds += fmt::format("{}{} × {}", kinds.empty() ? "" : ", ", unsaid, word_of(static_cast<Refusal>(k)));
  }
  if (all == 0) return std::nullopt;
  return fmt::format("{} more within {} s: {}", all, kSpell.count(), kinds);
}

}  // namespace mbk::console
