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
    return bad_usage(fmt::format("a power of {:g} at a level of {:g}", power, level),
                     "ask for 0 < level < power < 1, such as 0.8 at 0.05");
  }
  return {};
}

Result<void> check_variances(const VarianceComponents& variances) {
  for (const double one : {variances.participant, variances.session, variances.residual}) {
    if (!(one >= 0.0 && std::isfinite(one))) return bad_usage(fmt::format("a variance of {:g}", one), "give 0 or more");
  }
  return {};
}

double error_of_mean(const VarianceComponents& variances, int sessions, int trials) {
  return (variances.session + variances.residual / trials) / sessions;
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
  if (!std::isfinite(d) || d == 0.0) return bad_usage(fmt::format("an effect of {:g}", d), "ask for one that is not 0");
  int low = 1, high = 2;  // low is too few
  while (power_of_t_test(d, high, pairing, level) < power) {
    low = high;
    high *= 2;
    if (high > kMaxPeople)
      return bad_usage(fmt::format("an effect of {:g} takes more than 10⁷ people", d), "ask for a larger one");
  }
  while (high - low > 1) {
    const int middle = std::midpoint(low, high);
    (power_of_t_test(d, middle, pairing, level) < power ? low : high) = middle;
  }
  return high;
}

Result<std::vector<Plan>> people_and_trials(const VarianceComponents& variances, double difference, double power,
                                            Pairing pairing, int sessions, int max_trials, double level) {
  MBK_TRY(check_variances(variances));
  if (sessions < 1 || max_trials < 1) {
    return bad_usage(fmt::format("{} sessions and {} trials", sessions, max_trials), "ask for 1 or more");
  }
  std::vector<Plan> plans;
  for (int trials = 1; trials <= max_trials; ++trials) {
    Plan plan{sessions, trials, {}, error_of_mean(variances, sessions, trials)};
    plan.variance = pairing == Pairing::paired ? 2.0 * plan.variance : plan.variance + variances.participant;
    if (!(plan.variance > 0.0)) return bad_usage("all variances are 0", "give those of a reliability study");
    const auto people = MBK_TRY(people_for_effect(difference / std::sqrt(plan.variance), power, pairing, level));
    plan.people = people;
    plans.push_back(plan);
  }
  return plans;
}

Result<TrialsForChange> trials_for_change(const VarianceComponents& variances, double change, int sessions) {
  MBK_TRY(check_variances(variances));
  if (sessions < 1) return bad_usage(fmt::format("{} sessions", sessions), "ask for 1 or more");
  if (!(change > 0.0 && std::isfinite(change)))
    return bad_usage(fmt::format("a change of {:g}", change), "ask for one above 0");
  constexpr double kChange = kPublishedNormal95 * std::numbers::sqrt2;
  const auto mdc = [&](double error) { return kChange * std::sqrt(error); };
  TrialsForChange result;
  result.smallest_mdc95 = mdc(variances.session / sessions);
  const double left = sessions * std::pow(change / kChange, 2) - variances.session;
  double trials = 1.0;
  if (variances.residual > 0.0) trials = std::max(1.0, std::ceil(variances.residual / left * (1.0 - 1e-12)));
  if (left < 0.0 || (left == 0.0 && variances.residual > 0.0) || trials > kMaxPeople) {
    result.mdc95 = result.smallest_mdc95;
    return result;
  }
  result.trials = static_cast<int>(trials);
  result.mdc95 = mdc(error_of_mean(variances, sessions, *result.trials));
  return result;
}

}  // namespace mbk::reliability
