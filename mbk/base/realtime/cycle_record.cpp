#include "mbk/base/realtime/cycle_record.h"

#include <algorithm>
#include <cmath>

namespace mbk::realtime {

constexpr double kShortest = 64.0;  // [ns]

double CycleRecord::edge(int bin) {
  return bin == 0 ? 0.0 : kShortest * std::exp2(static_cast<double>(bin) / kSteps);
}

void CycleRecord::add(std::int64_t nanoseconds) noexcept {
  const double doublings = std::log2(std::max(static_cast<double>(nanoseconds), kShortest) / kShortest);
  const int bin = std::min(static_cast<int>(doublings * kSteps), static_cast<int>(bins_.size()) - 1);
  ++bins_[static_cast<std::size_t>(bin)];
  ++count_;
  worst_ = std::max(worst_, nanoseconds);
}

double CycleRecord::quantile(double share) const {
  if (count_ == 0) return 0.0;
  const double requested = std::clamp(share, 0.0, 1.0) * static_cast<double>(count_);
  double below = 0.0;
  for (int bin = 0; bin < static_cast<int>(bins_.size()); ++bin) {
    below += static_cast<double>(bins_[static_cast<std::size_t>(bin)]);
    if (below >= requested) return std::min(edge(bin + 1), static_cast<double>(worst_));
  }
  return static_cast<double>(worst_);
}

}  // namespace mbk::realtime
