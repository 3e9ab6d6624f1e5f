#include "mbk/study/statistics/outcome_rows.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "mbk/study/reliability/axial.h"
#include "mbk/study/store/study_summary.h"

namespace mbk::statistics {
namespace {

constexpr double kRadian = std::numbers::pi / 180.0;  // of a degree

void unwrap(OutcomeRows& rows) {
  Vector angles(static_cast<Index>(rows.rows.size()));
  for (Index i = 0; i < angles.size(); ++i) angles[i] = kRadian * rows.rows[static_cast<std::size_t>(i)].value;
  const auto mean = reliability::axial_mean(angles);
  if (!mean || mean->support != Support::enough) {
    rows.trusted = false;
    return;
  }
  const reliability::Unwrapped unwrapped = reliability::unwrapped_about(angles, mean->mean);
  rows.trusted = unwrapped.trusted;
  for (Index i = 0; i < angles.size(); ++i) {
    rows.rows[static_cast<std::size_t>(i)].value = unwrapped.angles[i] / kRadian;
  }
}

/// Repetitions in the order in which most people have them, and the number of people who have the first k.
struct Common {
  std::vector<std::int64_t> repetitions;
  std::vector<int> people;  ///< people[k]: have the first k
};

Common common_repetitions(const std::vector<Cell>& cells) {
  std::map<std::int64_t, int> counts;
  for (const Cell& cell : cells) ++counts[cell.repetition];
  Common common;
  for (const auto& [repetition, count] : counts) common.repetitions.push_back(repetition);
  std::ranges::stable_sort(common.repetitions, std::greater(), [&](std::int64_t one) { return counts[one]; });
  std::map<std::int64_t, std::size_t> rank;
  for (std::size_t k = 0; k < common.repetitions.size(); ++k) rank[common.repetitions[k]] = k;
  common.people.assign(common.repetitions.size() + 1, 0);
  for (std::size_t begin = 0; begin < cells.size();) {
    std::set<std::size_t> ranks;
    std::size_t end = begin;
    for (; end < cells.size() && cells[end].participant == cells[begin].participant; ++end) {
      ranks.insert(rank[cells[end].repetition]);
    }
    for (std::size_t k = 0; k < common.people.size() && (k == 0 || ranks.contains(k - 1)); ++k) ++common.people[k];
    begin = end;
  }
  return common;
}

}  // namespace

OutcomeRows rows_of(const store::OutcomeColumns& columns, const store::OutcomeColumn& column, int condition,
                    const std::vector<bool>& keep) {
  OutcomeRows rows;
  rows.axial = store::is_orientation(column.name);
  for (std::size_t k = 0; k < columns.trials.size(); ++k) {
    const store::TrialRow& trial = columns.trials[k];
    if (condition >= 0 && trial.condition != condition) continue;
    if (!keep.empty() && !keep[k]) continue;
    if (!std::isfinite(column.values[k])) continue;
    rows.rows.push_back({trial.participant, trial.session, column.values[k],
                         column.standard_errors.empty() ? kNaN : column.standard_errors[k], k});
  }
  if (rows.axial && !rows.rows.empty()) unwrap(rows);
  return rows;
}

std::vector<Cell> session_cells(const OutcomeRows& rows) {
  std::vector<Cell> cells;
  for (const OutcomeRow& row : rows.rows) {
    if (cells.empty() || cells.back().participant != row.participant || cells.back().repetition != row.session) {
      cells.push_back({row.participant, row.session, 0.0, 0});
    }
    cells.back().mean += row.value;
    ++cells.back().count;
  }
  for (Cell& cell : cells) cell.mean /= cell.count;
  return cells;
}

Repeated repeated(const std::vector<Cell>& cells) {
  const Common common = common_repetitions(cells);
  Repeated result;
  std::size_t chosen = 0;
  std::int64_t best = -1;
  for (std::size_t k = 2; k < common.people.size(); ++k) {
    const std::int64_t people = common.people[k];
    // People count most until there are enough of them.
    const std::int64_t worth =
        people >= reliability::kMinPeople ? 1'000'000'000 + people * std::int64_t(k - 1) : people;
    if (worth <= best) continue;
    best = worth;
    chosen = k;
  }
  const int all = common.people.empty() ? 0 : common.people.front();
  if (chosen == 0 || common.people[chosen] == 0) {
    result.support = all < reliability::kMinPeople ? Support::too_few_people : Support::too_few_sessions;
    result.left_out = all;
    return result;
  }
  result.repetitions.assign(common.repetitions.begin(), common.repetitions.begin() + std::ptrdiff_t(chosen));
  std::ranges::sort(result.repetitions);
  result.left_out = all - common.people[chosen];
  result.scores.resize(common.people[chosen], static_cast<Index>(chosen));
  for (std::size_t begin = 0; begin < cells.size();) {
    std::size_t end = begin, found = 0;
    Vector of_person(static_cast<Index>(chosen));
    for (; end < cells.size() && cells[end].participant == cells[begin].participant; ++end) {
      const auto at = std::ranges::lower_bound(result.repetitions, cells[end].repetition);
      if (at == result.repetitions.end() || *at != cells[end].repetition) continue;
      of_person[at - result.repetitions.begin()] = cells[end].mean;
      ++found;
    }
    if (found == chosen) {
      result.scores.row(std::ssize(result.participants)) = of_person.transpose();
      result.participants.push_back(cells[begin].participant);
    }
    begin = end;
  }
  auto reliability = reliability::test_retest(result.scores);
  result.support = reliability ? reliability->support : Support::no_variation;
  if (!reliability || result.support != Support::enough) return result;
  // Where people have exactly the same value each time, no error was measured, and none may be claimed to be 0.
  const double rounding = 16.0 * std::numeric_limits<double>::epsilon() * result.scores.cwiseAbs().maxCoeff();
  if (reliability->mean_squares.residual <= rounding * rounding) {
    result.support = Support::no_variation;
    return result;
  }
  result.test_retest = std::move(*reliability);
  return result;
}

bool all_known(const std::vector<OutcomeRow>& rows) {
  return !rows.empty() && std::ranges::all_of(rows, [](const OutcomeRow& row) {
    return std::isfinite(row.standard_error) && row.standard_error > 0.0;
  });
}

Vector as_vector(const std::vector<double>& values) {
  return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
}

std::string listed(const std::vector<std::int64_t>& numbers) {
  constexpr std::size_t kMax = 5;
  if (numbers.size() <= kMax) return fmt::format("{}", fmt::join(numbers, ", "));
  return fmt::format("{} and {} more", fmt::join(numbers.begin(), numbers.begin() + kMax, ", "), numbers.size() - kMax);
}

}  // namespace mbk::statistics
