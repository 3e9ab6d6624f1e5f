#include "mbk/study/store/study_summary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace mbk::store {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// What is summed up of one participant's results.
struct Sums {
  std::int64_t count = 0;
  double value = 0.0;               ///< Σ x
  double cosine = 0.0, sine = 0.0;  ///< Σ cos 2θ, Σ sin 2θ
};

struct Group {
  std::map<std::int64_t, Sums> of_participant;
  double minimum = std::numeric_limits<double>::infinity(), maximum = -std::numeric_limits<double>::infinity();
};

/// An angle of an axis is the same 180° further.
bool is_axis(const std::string& outcome) {
  return outcome.ends_with("_orientation");
}

void mean_of_axes(const Group& group, OutcomeSummary& summary) {
  double cosine = 0.0, sine = 0.0;
  for (const auto& [participant, sums] : group.of_participant) {
    const double length = std::hypot(sums.cosine, sums.sine);
    if (length > 0.0) cosine += sums.cosine / length;
    if (length > 0.0) sine += sums.sine / length;
  }
  const double n = static_cast<double>(group.of_participant.size());
  const double angle = std::atan2(sine, cosine) / (2.0 * kDegree);
  summary.mean = angle < 0.0 ? angle + 180.0 : angle;
  const double length = std::min(1.0, std::hypot(cosine, sine) / n);
  if (n > 1.0) summary.standard_deviation = 0.5 * std::sqrt(-2.0 * std::log(length)) / kDegree;
}

void mean_of_numbers(const Group& group, OutcomeSummary& summary) {
  double sum = 0.0, squares = 0.0;
  for (const auto& [participant, sums] : group.of_participant) sum += sums.value / static_cast<double>(sums.count);
  const double n = static_cast<double>(group.of_participant.size());
  summary.mean = sum / n;
  for (const auto& [participant, sums] : group.of_participant) {
    const double difference = sums.value / static_cast<double>(sums.count) - summary.mean;
    squares += difference * difference;
  }
  if (n > 1.0) summary.standard_deviation = std::sqrt(squares / (n - 1.0));
}

}  // namespace

std::vector<OutcomeSummary> summarise_outcomes(const ObservationTable& table) {
  const std::size_t outcomes = table.outcomes.size();
  std::vector<Group> groups(table.conditions.size() * outcomes);
  for (const Observation& one : table.observations) {
    Group& group = groups[static_cast<std::size_t>(one.condition) * outcomes + static_cast<std::size_t>(one.outcome)];
    Sums& sums = group.of_participant[one.participant];
    ++sums.count;
    sums.value += one.value;
    if (is_axis(table.outcomes[static_cast<std::size_t>(one.outcome)])) {
      sums.cosine += std::cos(2.0 * kDegree * one.value);
      sums.sine += std::sin(2.0 * kDegree * one.value);
    }
    group.minimum = std::min(group.minimum, one.value);
    group.maximum = std::max(group.maximum, one.value);
  }
  std::vector<OutcomeSummary> summaries;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const Group& group = groups[k];
    if (group.of_participant.empty()) continue;
    OutcomeSummary summary{.condition = table.conditions[k / outcomes],
                           .outcome = table.outcomes[k % outcomes],
                           .unit = table.units[k % outcomes]};
    for (const auto& [participant, sums] : group.of_participant) summary.results += sums.count;
    summary.participants = std::ssize(group.of_participant);
    summary.minimum = group.minimum;
    summary.maximum = group.maximum;
    is_axis(summary.outcome) ? mean_of_axes(group, summary) : mean_of_numbers(group, summary);
    summaries.push_back(std::move(summary));
  }
  return summaries;
}

}  // namespace mbk::store
