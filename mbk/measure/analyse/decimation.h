#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk::analyse {

/// Rows [begin, end) that follow each other in time without a break.
struct Rows {
  Index begin = 0, end = 0;
  Index first_sample = 0;  ///< of the recording, behind row `begin`
  [[nodiscard]] Index size() const { return end - begin; }
};

/// The segments of one purpose, or all; those that follow each other without a break are one.
[[nodiscard]] std::vector<Rows> rows_of(const PreparedTrial& trial, std::optional<Purpose> purpose = std::nullopt);

/// The pieces of a recording between the gaps of its clock that can be seen in a plot: at most five hundred.
[[nodiscard]] std::vector<Rows> pieces_between_gaps(const Vector& time);

/// What is drawn: some rows of a series; a row of NaN stands between two pieces.
struct Series {
  Vector time;
  Matrix values;
};

/// How a series is decimated.
enum class Decimation {
  every,     ///< every Nth row: true to a signal that was low-passed far enough
  extremes,  ///< two rows for each so many, with the extremes of each column in the order in which they came; their
             ///< times are those of the first and the middle row. No spike is lost.
};

/// About kDrawnRows rows of a series, or all where it has no more. Non-finite values are passed over where
/// there are others.
/// @param values as many rows as `time`; each column by itself
[[nodiscard]] Series decimated(const Vector& time, const Matrix& values, const std::vector<Rows>& pieces,
                               Decimation how);
inline constexpr Index kDrawnRows = 2000;

/// Writes the rows from `begin` on, as many as there is room for; is asked for each row once, in their order.
using MakeRows = std::function<void(Index begin, Eigen::Ref<Matrix> rows)>;

/// The same of values that are made as they are needed, so that they are never all in memory.
/// @param pieces  one behind the other, without a row between them that belongs to none
[[nodiscard]] Series decimated_in_passing(const Vector& time, Index columns, const MakeRows& make,
                                          const std::vector<Rows>& pieces, Decimation how);

/// Which decimation is true to the signals of a trial: every Nth row where at least four are left in each period of
/// the low-pass's cutoff (at twice the cutoff it passes 1/1000), otherwise the extremes.
[[nodiscard]] Decimation decimation_of(const PreparedTrial& trial, const std::vector<Rows>& pieces);

}  // namespace mbk::analyse
