// What raters contribute to the variance of an outcome.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "mbk/base/numeric/statistics.h"
#include "mbk/study/statistics/outcome_rows.h"

namespace mbk::statistics {
namespace {

/// The medians of the raters and sessions of a person, and of the trials of a rater in a session.
reliability::Averaged typical_numbers(const reliability::Ratings& ratings, const reliability::RaterModel& model) {
  std::map<int, std::set<int>> raters, sessions;
  std::map<std::tuple<int, int, int>, int> trials;
  for (std::size_t k = 0; k < ratings.participants.size(); ++k) {
    raters[ratings.participants[k]].insert(ratings.raters[k]);
    sessions[ratings.participants[k]].insert(ratings.sessions[k]);
    ++trials[{ratings.participants[k], ratings.raters[k], ratings.sessions[k]}];
  }
  const auto median = [](const auto& groups, auto count) {
    std::vector<double> counts;
    for (const auto& [key, group] : groups) counts.push_back(static_cast<double>(count(group)));
    return static_cast<int>(numeric::upper_median(std::move(counts)));
  };
  const auto size = [](const std::set<int>& group) { return group.size(); };
  const bool separate = model.session_facet == reliability::SessionFacet::separate;
  return {median(raters, size), separate ? median(sessions, size) : 1,
          model.has_trials ? median(trials, [](int count) { return count; }) : 1};
}

bool alike_numbers(const reliability::Averaged& one, const reliability::Averaged& other) {
  return std::tie(one.raters, one.sessions, one.trials) == std::tie(other.raters, other.sessions, other.trials);
}

}  // namespace

std::optional<RaterReliability> rater_reliability(const store::OutcomeColumns& columns, const OutcomeRows& rows,
                                                  const std::optional<reliability::Averaged>& averaged,
                                                  std::vector<std::string>& notes) {
  reliability::Ratings ratings;
  std::vector<double> values;
  for (const OutcomeRow& row : rows.rows) {
    const int rater = columns.trials[row.trial].rater;
    if (rater < 0) continue;
    values.push_back(row.value);
    ratings.participants.push_back(static_cast<int>(row.participant));
    ratings.raters.push_back(rater);
    ratings.sessions.push_back(static_cast<int>(row.session));
  }
  if (values.empty() || !rows.trusted) return std::nullopt;
  ratings.values = as_vector(values);
  RaterReliability result;
  result.without_rater = static_cast<int>(rows.rows.size() - values.size());
  auto model = reliability::fit_raters(ratings);
  if (!model) {
    notes.push_back("no variances of raters: " + model.error().message);
    return std::nullopt;
  }
  result.model = std::move(*model);
  if (result.without_rater > 0) {
    notes.push_back(
        fmt::format("{} results name no rater and are left out of the variances of raters", result.without_rater));
  }
  if (result.model.support != Support::enough) return result;
  if (result.model.session_facet == reliability::SessionFacet::confounded) {
    notes.emplace_back(
        "each rater has sessions of their own: differences between sessions are part of those between raters");
  }
  if (result.model.session_facet == reliability::SessionFacet::too_few && result.model.sessions > 1) {
    notes.push_back(
        fmt::format("fewer than {} people have two sessions: the variances of raters take sessions as trials",
                    reliability::kMinPeople));
  }
  std::vector<reliability::Averaged> numbers = {{1, 1, 1}};
  const auto add = [&](const reliability::Averaged& one) {
    const bool there = std::ranges::any_of(numbers, [&](const auto& other) { return alike_numbers(one, other); });
    if (!there) numbers.push_back(one);
  };
  add(typical_numbers(ratings, result.model));
  for (int count = 1; averaged && count <= averaged->raters; ++count) {
    add({count, averaged->sessions, averaged->trials});
  }
  for (const reliability::Averaged& one : numbers) {
    if (auto made = reliability::generalizability(result.model, one)) result.of_numbers.push_back(*made);
  }
  return result;
}

}  // namespace mbk::statistics
