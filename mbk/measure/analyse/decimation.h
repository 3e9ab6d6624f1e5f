#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk::analyse {

/// Rows [begin, end) that are contiguous in time.
struct Rows {
  Index begin = 0, end = 0;
  Index first_sample = 0;  ///< of the recording, behind row `begin`
  [[nodiscard]] Index size() const { return end - begin; }
};

/// The segments of one purpose, or all; contiguous ones are merged.
[[nodiscard]] std::vector<Rows> rows_of(const PreparedTrial& trial, std::optional<Purpose> purpose = std::nullopt);

/// The pieces of a recording between gaps of its clock that are visible in a plot: at most five hundred.
[[nodiscard]] std::vector<Rows> pieces_between_gaps(const Vector& time);

/// Rows to draw; a row of NaN separates two pieces.
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

/// About kDrawnRows rows of a series, or all if it has fewer. Non-finite values are skipped if there are
/// finite ones.
/// @param values  same number of rows as `time`; each column separately
[[nodiscard]] Series decimated(const Vector& time, const Matrix& values, const std::vector<Rows>& pieces,
                               Decimation how);
inline constexpr Index kDrawnRows = 2000;

/// Writes rows from `begin` on until its argument is full; called once for each row, in order.
using MakeRows = std::function<void(Index begin, Eigen::Ref<Matrix> rows)>;

/// The same for values that are generated on demand, so that they are never all in memory.
/// @param pieces  one behind the other, without a row between them that belongs to none
[[nodiscard]] Series decimated_in_passing(const Vector& time, Index columns, const MakeRows& make,
                                          const std::vector<Rows>& pieces, Decimation how);

/// The decimation that preserves the signals of a trial: every Nth row if at least four are left per period of the
/// cutoff frequency (at twice the cutoff the low-pass gain is 1/1000), otherwise the extremes.
[[nodiscard]] Decimation decimation_of(const PreparedTrial& trial, const std::vector<Rows>& pieces);

}  // namespace mbk::analyse
