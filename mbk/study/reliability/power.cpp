#include "mbk/study/reliability/power.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "mbk/base/numeric/distributions.h"

namespace mbk::reliability {
namespace {

constexpr int kMaxPeople = 10'000'000;

Result<void> check_level(double power, double level) {
  if (!(level > 0.0 && level < 1.0 && power > level && power < 1.0)) {
    return bad_usage(fmt::format("a power of {:g} at a level of {:g} is impossible", power, level),
                     "choose 0 < level < power < 1, such as 0.8 at 0.05");
  }
  return {};
}

}  // namespace

double power_of_t_test(double d, int people, Pairing pairing, double level) {
  const bool paired = pairing == Pairing::paired;
  const double n = people, degrees = paired ? n - 1.0 : 2.0 * n - 2.0;
  const double noncentrality = std::abs(d) * std::sqrt(paired ? n : 0.5 * n);
  const double limit = numeric::student_quantile(1.0 - 0.5 * level, degrees);
  return numeric::noncentral_t_above(limit, degrees, noncentrality) +
         numeric::noncentral_t_below(-limit, degrees, noncentrality);
}

Result<int> people_for_effect(double d, double power, Pairing pairing, double level) {
  MBK_TRY(check_level(power, level));
  if (!std::isfinite(d) || d == 0.0)
    return bad_usage(fmt::format("an effect of {:g} has no sample size", d), "choose one that is not 0");
  int low = 1, high = 2;  // low is too few
  while (power_of_t_test(d, high, pairing, level) < power) {
    low = high;
    high *= 2;
    if (high > kMaxPeople)
      return bad_usage(fmt::format("an effect of {:g} needs more than 10⁷ people", d), "choose a larger one");
  }
  while (high - low > 1) {
    const int middle = std::midpoint(low, high);
    (power_of_t_test(d, middle, pairing, level) < power ? low : high) = middle;
  }
  return high;
}

}  // namespace mbk::reliability
