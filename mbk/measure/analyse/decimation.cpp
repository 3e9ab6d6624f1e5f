#include "mbk/measure/analyse/decimation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "mbk/base/core/nan.h"

namespace mbk::analyse {
namespace {

Index total_of(const std::vector<Rows>& pieces) {
  Index total = 0;
  for (const Rows& piece : pieces) total += piece.size();
  return total;
}

/// Of N rows one is kept, or two with their extremes.
Index bucket_of(Index total, Decimation how) {
  if (total <= kDrawnRows) return 1;
  const Index kept = how == Decimation::extremes ? 2 : 1;
  return (kept * total + kDrawnRows - 1) / kDrawnRows;
}

/// The smallest and the largest number of a column's part, in their order.
std::pair<double, double> extremes_of(const Eigen::Ref<const Vector>& part) {
  Index low = -1, high = -1;
  for (Index i = 0; i < part.size(); ++i) {
    if (std::isnan(part[i])) continue;
    if (low < 0 || part[i] < part[low]) low = i;
    if (high < 0 || part[i] > part[high]) high = i;
  }
  if (low < 0) return {kNaN, kNaN};
  return {part[std::min(low, high)], part[std::max(low, high)]};
}

}  // namespace

std::vector<Rows> rows_of(const PreparedTrial& trial, std::optional<Purpose> purpose) {
  std::vector<Rows> rows;
  for (const Segment& segment : trial.segments) {
    if (purpose && segment.purpose != *purpose) continue;
    const bool follows = !rows.empty() && rows.back().end == segment.begin &&
                         trial.time[segment.begin] - trial.time[segment.begin - 1] < 1.5 * trial.sample_time;
    if (follows) {
      rows.back().end = segment.end;
    } else {
      rows.push_back({segment.begin, segment.end, segment.first_sample});
    }
  }
  return rows;
}

std::vector<Rows> pieces_between_gaps(const Vector& time) {
  constexpr double kSeen = 1.0 / 500.0;  // of the plot's width
  const Index samples = time.size();
  if (samples == 0) return {};
  const auto steps = (time.tail(samples - 1) - time.head(samples - 1)).cwiseAbs();
  const double sum = steps.sum();
  const double usual = samples > 1 ? sum / static_cast<double>(samples - 1) : 0.0;
  const double seen = std::max(kSeen * sum, 2.0 * usual);
  std::vector<Rows> pieces = {{0, samples, 0}};
  for (Index i = 0; i < steps.size(); ++i) {
    if (!(steps[i] > seen)) continue;
    pieces.back().end = i + 1;
    pieces.push_back({i + 1, samples, i + 1});
  }
  return pieces;
}

Decimation decimation_of(const PreparedTrial& trial, const std::vector<Rows>& pieces) {
  const double step = static_cast<double>(bucket_of(total_of(pieces), Decimation::every)) * trial.sample_time;
  const auto& cutoff = trial.preparation.cutoff;
  return cutoff && 4.0 * step * cutoff->value <= 1.0 ? Decimation::every : Decimation::extremes;
}

Series decimated_in_passing(const Vector& time, Index columns, const MakeRows& make, const std::vector<Rows>& pieces,
                            Decimation how) {
  const Index bucket = bucket_of(total_of(pieces), how);
  const bool all = bucket == 1 || how == Decimation::every;
  const Index most = 2 * total_of(pieces) / bucket + 3 * static_cast<Index>(pieces.size());
  Series series{Vector(most), Matrix(most, columns)};
  Matrix rows(bucket, columns);
  Index row = 0;
  for (const Rows& piece : pieces) {
    if (piece.size() <= 0) continue;
    if (row > 0) {
      series.time[row] = kNaN;
      series.values.row(row++).setConstant(kNaN);
    }
    for (Index begin = piece.begin; begin < piece.end; begin += bucket) {
      const Index size = std::min(bucket, piece.end - begin);
      make(begin, rows.topRows(size));
      series.time[row] = time[begin];
      if (all || size == 1) {
        series.values.row(row++) = rows.row(0);
        continue;
      }
      series.time[row + 1] = time[begin + size / 2];
      for (Index column = 0; column < columns; ++column) {
        std::tie(series.values(row, column), series.values(row + 1, column)) = extremes_of(rows.col(column).head(size));
      }
      row += 2;
    }
  }
  series.time.conservativeResize(row);
  series.values.conservativeResize(row, Eigen::NoChange);
  return series;
}

Series decimated(const Vector& time, const Matrix& values, const std::vector<Rows>& pieces, Decimation how) {
  const auto copy = [&](Index begin, Eigen::Ref<Matrix> rows) { rows = values.middleRows(begin, rows.rows()); };
  return decimated_in_passing(time, values.cols(), copy, pieces, how);
}

}  // namespace mbk::analyse
