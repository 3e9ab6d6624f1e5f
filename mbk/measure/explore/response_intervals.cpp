#include "mbk/measure/explore/response_intervals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::explore {
namespace {

/// Half width of |G| and radius of the disc, both per σ̂.
std::pair<double, double> widths(double degrees_of_freedom) {
  const double nu = degrees_of_freedom;
  if (!(nu >= 1.0)) {
    constexpr double kUnknown = std::numeric_limits<double>::infinity();
    return {kUnknown, kUnknown};
  }
  constexpr double kMany = 1e6;  // Student's t is normal there
  const auto real = static_cast<int>(2.0 * std::min(nu, kMany));
  return {numeric::student_quantile(0.975, real) / std::sqrt(2.0), std::sqrt(nu * std::expm1(-std::log(0.05) / nu))};
}

}  // namespace

void add_intervals(FrequencyResponseEstimate& estimate) {
  const Index lines = estimate.size();
  const Index entries = lines > 0 ? estimate.response.front().size() : 0;
  estimate.magnitude_low.resize(lines, entries);
  estimate.magnitude_high.resize(lines, entries);
  estimate.phase_half_width.resize(lines, entries);
  estimate.radius95.resize(lines, entries);
  std::map<double, std::pair<double, double>> known;
  for (Index k = 0; k < lines; ++k) {
    const double nu = estimate.degrees_of_freedom[k];
    const auto found = known.find(nu);
    const auto [half, radius] = found != known.end() ? found->second : (known[nu] = widths(nu));
    const auto at = static_cast<std::size_t>(k);
    for (Index e = 0; e < entries; ++e) {
      const double deviation = std::sqrt(std::max(0.0, estimate.covariance[at](e, e).real()));
      const double magnitude = std::abs(estimate.response[at].reshaped()[e]);
      estimate.magnitude_low(k, e) = std::max(0.0, magnitude - half * deviation);
      estimate.magnitude_high(k, e) = magnitude + half * deviation;
      estimate.phase_half_width(k, e) =
          half * deviation < magnitude ? std::asin(half * deviation / magnitude) : std::numbers::pi;
      estimate.radius95(k, e) = radius * deviation;
    }
  }
}

}  // namespace mbk::explore
