#include "mbk/files/xdf/xdf_order.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mbk/files/xdf/xdf_robust.h"

namespace mbk::recording {
namespace {

constexpr double kBeyondJitter = 5.0;

/// Samples first … end − 1.
struct StampRun {
  Index first, end;
  double begin, latest;  ///< [s], first and greatest stamp
};

}  // namespace

std::vector<Index> order_by_stamps(const Vector& stamps) {
  if (stamps.size() < 3) return {};
  const Vector intervals = differences(stamps);
  const double usual = median_of(intervals);
  const double far = std::max(std::abs(usual) / 2.0, 6.0 * robust_deviation(intervals));
  if (intervals.minCoeff() >= usual - far) return {};

  std::vector<StampRun> runs{{0, 1, stamps[0], stamps[0]}};
  for (Index k = 1; k < stamps.size(); ++k) {
    if (std::abs(intervals[k - 1] - usual) > far) runs.push_back({k, k, stamps[k], stamps[k]});
    runs.back().end = k + 1;
    runs.back().latest = std::max(runs.back().latest, stamps[k]);
  }
  std::vector<std::size_t> sorted(runs.size());
  std::iota(sorted.begin(), sorted.end(), 0U);
  std::ranges::stable_sort(sorted, {}, [&](std::size_t r) { return runs[r].begin; });

  const auto off = [&](const StampRun& before, const StampRun& next) {
    return std::abs(stamps[next.first] - stamps[before.end - 1] - usual);
  };
  /// Runs first … last that change places among each other, and what their intervals were off by.
  struct Moved {
    std::size_t first, last;
    double off;  ///< [s], a typical one
  };
  std::vector<Moved> moved;
  const auto keep_stored = [&](std::size_t first, std::size_t last) {
    std::iota(sorted.begin() + static_cast<std::ptrdiff_t>(first),
              sorted.begin() + static_cast<std::ptrdiff_t>(last) + 1, first);
  };
  // The run before these and the one behind them join them.
  const auto decide = [&](std::size_t first, std::size_t last) {
    const std::size_t from = first == 0 ? 0 : first - 1, to = std::min(last + 1, runs.size() - 1);
    double as_stored = 0.0, as_sorted = 0.0, overlap = 0.0, latest = runs[sorted[from]].latest;
    for (std::size_t place = from + 1; place <= to; ++place) {
      as_stored += off(runs[place - 1], runs[place]);
      as_sorted += off(runs[sorted[place - 1]], runs[sorted[place]]);
      overlap = std::max(overlap, latest - runs[sorted[place]].begin);
      latest = std::max(latest, runs[sorted[place]].latest);
    }
    const double typical = as_stored / static_cast<double>(to - from);
    const double length =
        usual * static_cast<double>(runs[last].end - runs[first].first) / static_cast<double>(last - first + 1);
    if (overlap <= std::max(far, typical / kBeyondJitter) && as_sorted <= as_stored / 4.0 &&
        as_sorted <= length / 4.0 * static_cast<double>(to - from)) {
      moved.push_back({first, last, typical});
    } else {
      keep_stored(first, last);
    }
  };
  std::size_t first = 0, greatest = 0;
  for (std::size_t place = 0; place < sorted.size(); ++place) {
    greatest = std::max(greatest, sorted[place]);
    if (greatest > place) continue;
    if (place > first) decide(first, place);
    first = place + 1;
  }
  // Stamps that still run backward show how far they jitter.
  std::vector<double> backward;
  for (std::size_t place = 1; place < sorted.size(); ++place) {
    const double interval = runs[sorted[place]].begin - stamps[runs[sorted[place - 1]].end - 1];
    if (interval < usual - far) backward.push_back(usual - interval);
  }
  const double jitter = backward.empty() ? 0.0 : numeric::median(std::move(backward));
  std::erase_if(moved, [&](const Moved& these) {
    if (these.off >= kBeyondJitter * jitter) return false;
    keep_stored(these.first, these.last);
    return true;
  });
  if (moved.empty()) return {};
  std::vector<Index> order;
  order.reserve(static_cast<std::size_t>(stamps.size()));
  for (const std::size_t r : sorted) {
    for (Index k = runs[r].first; k < runs[r].end; ++k) order.push_back(k);
  }
  return order;
}

}  // namespace mbk::recording
