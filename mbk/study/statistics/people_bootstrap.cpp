#include "mbk/study/statistics/people_bootstrap.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::statistics {
namespace {

using reliability::Pairing;
using Rows = std::vector<Index>;

constexpr std::size_t kOfReliability = 3;  ///< ICC(A,1), ICC(C,1), SEM

std::size_t numbers_in(const PeopleTable& table) {
  return table.pairing ? 1 : kOfReliability;
}

/// What is stated of the people in these rows, behind `numbers`.
void add_numbers(const PeopleTable& table, const Rows& first, const Rows& second, std::vector<double>& numbers) {
  if (table.pairing) {
    numbers.push_back(table.second(second, 0).mean() - table.first(first, 0).mean());
    return;
  }
  const auto squares = reliability::mean_squares(table.first(first, Eigen::all));
  if (!squares) {
    numbers.insert(numbers.end(), kOfReliability, kNaN);
    return;
  }
  const double n = squares->people;
  numbers.push_back(reliability::icc_of(reliability::IccForm::agreement, *squares));
  numbers.push_back(reliability::icc_of(reliability::IccForm::consistency, *squares));
  numbers.push_back(std::sqrt(squares->between_sessions / n + squares->residual * (1.0 - 1.0 / n)));
}

Rows all_rows(Index count) {
  Rows rows(static_cast<std::size_t>(count));
  for (Index i = 0; i < count; ++i) rows[static_cast<std::size_t>(i)] = i;
  return rows;
}

Rows all_but(Index count, Index left_out) {
  Rows rows = all_rows(count);
  rows.erase(rows.begin() + left_out);
  return rows;
}

Rows drawn_rows(Index count, numeric::Random& random) {
  Rows rows(static_cast<std::size_t>(count));
  for (Index& row : rows) row = static_cast<Index>(random.below(static_cast<std::uint64_t>(count)));
  return rows;
}

/// The numbers of a table without each of its people, sample by sample.
std::vector<std::vector<std::vector<double>>> without_each(const PeopleTable& table) {
  const Index n1 = table.first.rows(), n2 = table.second.rows();
  const bool unpaired = table.pairing == Pairing::unpaired;
  const auto without = [&](const Rows& first, const Rows& second) {
    std::vector<double> numbers;
    add_numbers(table, first, second, numbers);
    return numbers;
  };
  std::vector<std::vector<std::vector<double>>> samples(1);
  for (Index i = 0; i < n1; ++i) {
    const Rows others = all_but(n1, i);
    samples.back().push_back(without(others, unpaired ? all_rows(n2) : others));
  }
  if (!unpaired) return samples;
  samples.emplace_back();
  for (Index i = 0; i < n2; ++i) samples.back().push_back(without(all_rows(n1), all_but(n2, i)));
  return samples;
}

/// a of BCa, of the number `which`.
double acceleration(const std::vector<std::vector<std::vector<double>>>& without, std::size_t which) {
  double cubes = 0.0, squares = 0.0;
  for (const auto& sample : without) {
    const auto n = static_cast<double>(sample.size());
    double mean = 0.0;
    for (const auto& one : sample) mean += one[which] / n;
    for (const auto& one : sample) {
      const double u = (n - 1.0) * (mean - one[which]) / n;
      cubes += u * u * u;
      squares += u * u;
    }
  }
  return squares > 0.0 ? cubes / (6.0 * std::pow(squares, 1.5)) : 0.0;
}

/// @param sorted  the draws that gave a number
Interval bca(const Vector& sorted, double value, double a) {
  const auto [low, high] = std::equal_range(sorted.begin(), sorted.end(), value);
  const auto count = static_cast<double>(sorted.size());
  const double below = (static_cast<double>(low - sorted.begin()) + 0.5 * static_cast<double>(high - low)) / count;
  if (!(below > 0.0 && below < 1.0)) return {kNaN, kNaN};
  const double z0 = numeric::normal_quantile(below);
  const auto end = [&](double tail) {
    const double z = z0 + numeric::normal_quantile(tail), scale = 1.0 - a * z;
    return scale > 0.0 ? numeric::quantile(sorted, numeric::normal_probability(z0 + z / scale)) : kNaN;
  };
  return {end(reliability::kTail95), end(1.0 - reliability::kTail95)};
}

BootstrapInterval interval_of(Vector draws, double value, double a) {
  constexpr double kMaxUndefined = 0.05;
  BootstrapInterval result;
  result.value = value;
  const auto end = std::remove_if(draws.begin(), draws.end(), [](double one) { return !std::isfinite(one); });
  const Index defined = end - draws.begin();
  result.undefined = static_cast<int>(draws.size() - defined);
  if (!std::isfinite(value) || defined < 2 || result.undefined > kMaxUndefined * static_cast<double>(draws.size())) {
    return result;
  }
  Vector sorted = draws.head(defined);
  std::sort(sorted.begin(), sorted.end());
  result.standard_error = std::sqrt(numeric::variance(sorted));
  result.percentile95 = {numeric::quantile(sorted, reliability::kTail95),
                         numeric::quantile(sorted, 1.0 - reliability::kTail95)};
  if (std::isfinite(a)) result.bca95 = bca(sorted, value, a);
  return result;
}

/// Intervals of a table whose numbers begin at `at` in each draw.
std::vector<BootstrapInterval> intervals_of(const PeopleTable& table, const std::vector<std::vector<double>>& draws,
                                            std::size_t at) {
  std::vector<double> values;
  add_numbers(table, all_rows(table.first.rows()), all_rows(table.second.rows()), values);
  const auto without = without_each(table);
  std::vector<BootstrapInterval> intervals;
  for (std::size_t which = 0; which < values.size(); ++which) {
    Vector column(static_cast<Index>(draws.size()));
    for (std::size_t k = 0; k < draws.size(); ++k) column[static_cast<Index>(k)] = draws[k][at + which];
    intervals.push_back(interval_of(std::move(column), values[which], acceleration(without, which)));
  }
  return intervals;
}

bool is_stated(const OutcomeReliability& one) {
  return one.between_sessions.support == Support::enough;
}

bool is_stated(const OutcomeComparison& one) {
  return one.difference.support == Support::enough;
}

}  // namespace

std::vector<PeopleTable> people_tables(const StudyStatistics& statistics) {
  std::vector<PeopleTable> tables;
  for (const OutcomeReliability& one : statistics.reliability) {
    if (is_stated(one)) tables.push_back({std::nullopt, one.between_sessions.scores, {}});
  }
  if (!statistics.comparison) return tables;
  for (const OutcomeComparison& one : statistics.comparison->outcomes) {
    if (is_stated(one)) tables.push_back({one.difference.pairing, one.first_values, one.second_values});
  }
  return tables;
}

std::vector<double> bootstrap_draw(std::span<const PeopleTable> tables, std::uint64_t seed, int draw) {
  std::map<std::pair<Index, Index>, std::pair<Rows, Rows>> drawn;
  std::vector<double> numbers;
  for (const PeopleTable& table : tables) {
    const bool unpaired = table.pairing == Pairing::unpaired;
    const std::pair people(table.first.rows(), unpaired ? table.second.rows() : 0);
    const auto [at, fresh] = drawn.try_emplace(people);
    auto& [first, second] = at->second;
    if (fresh) {
      numeric::Random random(seed, static_cast<std::uint32_t>(draw));
      first = drawn_rows(people.first, random);
      second = drawn_rows(people.second, random);
    }
    add_numbers(table, first, unpaired ? second : first, numbers);
  }
  return numbers;
}

void add_bootstrap(StudyStatistics& statistics, std::span<const PeopleTable> tables,
                   const std::vector<std::vector<double>>& draws, std::uint64_t seed) {
  statistics.bootstrap = {static_cast<int>(draws.size()), seed};
  auto table = tables.begin();
  std::size_t at = 0;
  const auto next = [&] {
    auto intervals = intervals_of(*table, draws, at);
    at += numbers_in(*table++);
    return intervals;
  };
  for (OutcomeReliability& one : statistics.reliability) {
    if (!is_stated(one)) continue;
    const auto intervals = next();
    one.bootstrap = {intervals[0], intervals[1], intervals[2]};
  }
  if (!statistics.comparison) return;
  for (OutcomeComparison& one : statistics.comparison->outcomes) {
    if (is_stated(one)) one.bootstrap = next().front();
  }
}

}  // namespace mbk::statistics
