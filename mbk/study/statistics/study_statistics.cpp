#include "mbk/study/statistics/study_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/study/statistics/outcome_rows.h"

namespace mbk::statistics {
namespace {

Result<std::vector<const store::OutcomeColumn*>> chosen_columns(const store::OutcomeColumns& columns,
                                                                const std::vector<std::string>& names) {
  std::vector<const store::OutcomeColumn*> chosen;
  if (names.empty()) {
    for (const store::OutcomeColumn& column : columns.outcomes) chosen.push_back(&column);
    return chosen;
  }
  for (const std::string& name : names) {
    const auto found = std::ranges::find(columns.outcomes, name, &store::OutcomeColumn::name);
    if (found == columns.outcomes.end()) {
      std::string known;
      for (const store::OutcomeColumn& column : columns.outcomes) known += (known.empty() ? "" : ", ") + column.name;
      return bad_usage(fmt::format("there is no outcome '{}'", printable(name)),
                       known.empty() ? "no result is usable" : "choose one of: " + known);
    }
    if (std::ranges::find(chosen, &*found) == chosen.end()) chosen.push_back(&*found);
  }
  return chosen;
}

/// Whether two trials have the same numbers, but for the rounding of text.
bool same_numbers(const store::OutcomeColumns& columns, std::size_t one, std::size_t other) {
  constexpr double kRounding = 1e-9;
  constexpr int kEnough = 3;  // numbers that agree by chance are fewer
  int alike = 0;
  for (const store::OutcomeColumn& column : columns.outcomes) {
    const double a = column.values[one], b = column.values[other];
    if (std::isnan(a) != std::isnan(b)) return false;
    if (std::isnan(a)) continue;
    if (!(std::abs(a - b) <= kRounding * std::max(std::abs(a), std::abs(b)))) return false;
    ++alike;
  }
  return alike >= kEnough;
}

/// Recordings that have the same results as another one: one trial that came in twice, as two files.
void note_duplicates(const store::OutcomeColumns& columns, std::vector<std::string>& notes) {
  if (columns.outcomes.empty()) return;
  // Same numbers stand beside each other in the order of any one that all have.
  const auto& key = std::ranges::max_element(columns.outcomes, {}, [](const store::OutcomeColumn& column) {
                      return std::ranges::count_if(column.values, [](double x) { return !std::isnan(x); });
                    })->values;
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < key.size(); ++k) {
    if (!std::isnan(key[k])) order.push_back(k);
  }
  std::ranges::sort(order, {}, [&](std::size_t k) { return std::pair(key[k], columns.trials[k].recording); });
  std::vector<std::pair<std::int64_t, std::int64_t>> pairs;
  for (std::size_t k = 1; k < order.size(); ++k) {
    if (!same_numbers(columns, order[k - 1], order[k])) continue;
    const std::int64_t a = columns.trials[order[k - 1]].recording, b = columns.trials[order[k]].recording;
    pairs.emplace_back(std::min(a, b), std::max(a, b));
  }
  std::ranges::sort(pairs);
  constexpr std::size_t kMax = 5;
  for (std::size_t k = 0; k < std::min(pairs.size(), kMax); ++k) {
    notes.push_back(
        fmt::format("recordings {} and {} have the same results; if one trial was added twice, 'mbk study exclude' "
                    "excludes one",
                    pairs[k].first, pairs[k].second));
  }
  if (pairs.size() > kMax) notes.push_back(fmt::format("{} more pairs have the same results", pairs.size() - kMax));
}

}  // namespace

Result<StudyStatistics> study_statistics(const store::OutcomeColumns& columns, const StatisticsOptions& options) {
  const auto chosen = MBK_TRY(chosen_columns(columns, options.outcomes));
  if (options.averaged && columns.raters.empty()) {
    return bad_usage("no usable result names a rater", "omit --raters, or add recordings with --rater");
  }
  StudyStatistics statistics;
  note_duplicates(columns, statistics.notes);
  const int outcomes = static_cast<int>(chosen.size());
  const int count = outcomes * static_cast<int>(columns.conditions.size());
  std::vector<OutcomeReliability> reliability(static_cast<std::size_t>(count));
  MBK_TRY(numeric::parallel_for(count, options.threads, [&](int k) -> Result<void> {
    const store::OutcomeColumn& column = *chosen[static_cast<std::size_t>(k % outcomes)];
    const int condition = k / outcomes;
    OutcomeReliability named;
    named.condition = columns.conditions[static_cast<std::size_t>(condition)];
    named.outcome = column.name;
    named.unit = column.unit;
    const OutcomeRows rows = rows_of(columns, column, condition);
    OutcomeReliability& one = reliability[static_cast<std::size_t>(k)];
    one = reliability_of(rows, std::move(named));
    one.raters = rater_reliability(columns, rows, options.averaged, one.notes);
    return {};
  }));
  std::erase_if(reliability, [](const OutcomeReliability& one) { return one.results == 0; });
  statistics.reliability = std::move(reliability);
  if (options.outcomes.empty()) statistics.matrices = matrix_spreads(columns);
  if (options.comparing) {
    auto comparison = MBK_TRY(compared(columns, chosen, options, statistics.notes));
    statistics.comparison = std::move(comparison);
  }
  return statistics;
}

}  // namespace mbk::statistics
