#pragma once

#include <algorithm>
#include <optional>
#include <ranges>
#include <string>
#include <utility>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/validation_table.h"

namespace mbk::validation {

/// An accepted range, with its ends.
using Range = std::pair<double, double>;

[[nodiscard]] Range at_least(double limit);  ///< [limit, ∞)
[[nodiscard]] Range at_most(double limit);   ///< (−∞, limit]

/// Accepted shares [%]. Of 95 % intervals that hold the truth: where coverage is the question of a study, and where a
/// study with fewer runs looks at it too.
inline constexpr Range kNominal = {92.0, 98.0}, kNearNominal = {85.0, 100.0};
inline constexpr Range kNominalOrMore = {92.0, 100.0};  ///< the same where too wide an interval is no fault
/// Of what a study expects of every trial, and of what should never happen: no finite number of runs shows 100 or 0 %.
inline constexpr Range kNearlyAlways = {95.0, 100.0}, kHardlyEver = {0.0, 5.0};
/// Of what must always be so, such as what has to follow every fault, and of what must never be.
inline constexpr Range kAlways = {99.0, 100.0}, kNever = {0.0, 1.0};
/// Of tests at a level of 5 % that find a difference where there is none.
inline constexpr Range kFalsePositives = {3.5, 6.5};

/// Share of the trials of which something is so [%], with its exact (Clopper–Pearson) 95 % interval. Of no trials it is
/// undefined, between 0 and 100 %.
/// @param hits  0 … trials
[[nodiscard]] ValidationRow share_row(std::string what, int hits, int trials, std::optional<Range> expected);

/// The same of the runs or trials in a range that are so.
template <std::ranges::sized_range Runs, class Is>
[[nodiscard]] ValidationRow share_row(std::string what, const Runs& runs, const Is& is, std::optional<Range> expected) {
  return share_row(std::move(what), static_cast<int>(std::ranges::count_if(runs, is)),
                   static_cast<int>(std::ranges::size(runs)), expected);
}

/// Mean over independent runs, with the 95 % interval of Student's t and the spread of the runs; of one run the
/// interval is unbounded.
[[nodiscard]] ValidationRow mean_row(std::string what, const Vector& values, std::optional<Range> expected,
                                     std::string unit);

/// Mean of errors; within ±`allowed` is accepted.
[[nodiscard]] ValidationRow bias_row(std::string what, const Vector& errors, double allowed, std::string unit);

/// Median over independent trials, between two of them: the k-th from either end, the largest k with
/// 2 P(fewer than k of n lie below the median) ≤ 5 %. Of fewer than six the interval is unbounded.
[[nodiscard]] ValidationRow median_row(std::string what, const Vector& values, std::optional<Range> expected,
                                       std::string unit);

/// Standard deviation of normal runs over a known one, with the 95 % interval of χ²; of one run it is undefined.
[[nodiscard]] ValidationRow spread_row(std::string what, const Vector& values, double known, Range expected);

/// What is not an estimate: nothing in it is random, or it counts what happened in these runs.
[[nodiscard]] ValidationRow exact_row(std::string what, double value, std::optional<Range> expected, std::string unit);

/// A share that a study judges.
struct JudgedShare {
  Range expected;  ///< [%], at least one end of it within (0, 100)
  double share;    ///< where all is well [%]; inside `expected`, at an end of it only where that is 0 or 100
  double trials_per_run = 1.0;  ///< > 0
};

/// The smallest number of runs with which some outcome can be met.
[[nodiscard]] int min_runs(const JudgedShare& judged);

/// How likely it is that a share that truly is `share` [%] is met in so many trials.
[[nodiscard]] double chance_to_be_met(Range expected, double share, int trials);

/// The first of 10, 15, 20, 25, 30, 50, 100, 150, … runs with which it is met with 99.9 %.
[[nodiscard]] int default_runs(const JudgedShare& judged);

}  // namespace mbk::validation
