#include "mbk/study/store/study_summary.h"

#include <algorithm>
#include <cmath>

#include "mbk/base/core/units.h"

namespace mbk::store {
namespace {

/// What is summed up of one participant's results.
struct Sums {
  std::int64_t count = 0;
  double value = 0.0;               ///< Σ x
  double cosine = 0.0, sine = 0.0;  ///< Σ cos 2θ, Σ sin 2θ
};

struct Group {
  std::vector<Sums> participants;
  std::int64_t last = 0;  ///< whose sums are the last ones
  double minimum = std::numeric_limits<double>::infinity(), maximum = -std::numeric_limits<double>::infinity();
};

void mean_of_axes(const Group& group, OutcomeSummary& summary) {
  double cosine = 0.0, sine = 0.0;
  for (const Sums& sums : group.participants) {
    const double length = std::hypot(sums.cosine, sums.sine);
    if (length > 0.0) cosine += sums.cosine / length;
    if (length > 0.0) sine += sums.sine / length;
  }
  const double n = static_cast<double>(group.participants.size());
  const double angle = std::atan2(sine, cosine) / (2.0 * kDegree);
  summary.mean = angle < 0.0 ? angle + 180.0 : angle;
  const double length = std::min(1.0, std::hypot(cosine, sine) / n);
  if (n > 1.0) summary.standard_deviation = 0.5 * std::sqrt(-2.0 * std::log(length)) / kDegree;
}

void mean_of_numbers(const Group& group, OutcomeSummary& summary) {
  double sum = 0.0, squares = 0.0;
  for (const Sums& sums : group.participants) sum += sums.value / static_cast<double>(sums.count);
  const double n = static_cast<double>(group.participants.size());
  summary.mean = sum / n;
  for (const Sums& sums : group.participants) {
    const double difference = sums.value / static_cast<double>(sums.count) - summary.mean;
    squares += difference * difference;
  }
  if (n > 1.0) summary.standard_deviation = std::sqrt(squares / (n - 1.0));
}

void add_to(Group& group, std::int64_t participant, double value, bool axis) {
  if (group.participants.empty() || group.last != participant) {
    group.participants.emplace_back();
    group.last = participant;
  }
  Sums& sums = group.participants.back();
  ++sums.count;
  sums.value += value;
  if (axis) {
    sums.cosine += std::cos(2.0 * kDegree * value);
    sums.sine += std::sin(2.0 * kDegree * value);
  }
  group.minimum = std::min(group.minimum, value);
  group.maximum = std::max(group.maximum, value);
}

}  // namespace

bool is_orientation(std::string_view outcome) {
  return outcome.ends_with("_orientation");
}

std::vector<OutcomeSummary> summarise_outcomes(const OutcomeColumns& columns) {
  std::vector<std::vector<Group>> of_outcome;
  for (const OutcomeColumn& column : columns.outcomes) {
    std::vector<Group>& groups = of_outcome.emplace_back(columns.conditions.size());
    const bool axis = is_orientation(column.name);
    for (std::size_t k = 0; k < columns.trials.size(); ++k) {
      const TrialRow& trial = columns.trials[k];
      if (std::isnan(column.values[k])) continue;
      add_to(groups[static_cast<std::size_t>(trial.condition)], trial.participant, column.values[k], axis);
    }
  }
  std::vector<OutcomeSummary> summaries;
  for (std::size_t condition = 0; condition < columns.conditions.size(); ++condition) {
    for (std::size_t k = 0; k < columns.outcomes.size(); ++k) {
      const Group& group = of_outcome[k][condition];
      if (group.participants.empty()) continue;
      OutcomeSummary summary{.condition = columns.conditions[condition],
                             .outcome = columns.outcomes[k].name,
                             .unit = columns.outcomes[k].unit};
      for (const Sums& sums : group.participants) summary.results += sums.count;
      summary.participants = std::ssize(group.participants);
      summary.minimum = group.minimum;
      summary.maximum = group.maximum;
      is_orientation(summary.outcome) ? mean_of_axes(group, summary) : mean_of_numbers(group, summary);
      summaries.push_back(std::move(summary));
    }
  }
  return summaries;
}

}  // namespace mbk::store
