#include "mbk/measure/analyse/analyse_width.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/model/impedance/impedance_width.h"
#include "mbk/model/impedance/passivity_index.h"

namespace mbk::analyse {
namespace {

/// χ², 95 %, of 1, 3 and 6 degrees of freedom: the numbers of a symmetric part with 1, 2 and 3 axes.
constexpr std::array kChiSquared95 = {3.841458820694124, 7.814727903251179, 12.591587243743977};

/// The numbers of a symmetric part from those of its matrix, row by row: [z], or [z_xx z_s z_yy], …
Matrix symmetrise(Index axes) {
  Matrix to_symmetric = Matrix::Zero(axes * (axes + 1) / 2, axes * axes);
  Index row = 0;
  for (Index i = 0; i < axes; ++i) {
    for (Index j = i; j < axes; ++j, ++row) {
      to_symmetric(row, i * axes + j) += 0.5;
      to_symmetric(row, j * axes + i) += 0.5;
    }
  }
  return to_symmetric;
}

bool differ(const Matrix& first, const Matrix& second, const Matrix& covariance, Index axes) {
  if (!covariance.allFinite()) return false;
  const Matrix to_symmetric = symmetrise(axes);
  const Matrix change = (second - first).transpose();
  const Vector difference = to_symmetric * Vector(change.reshaped());
  const Matrix spread = to_symmetric * covariance * to_symmetric.transpose();
  const double distance = difference.dot(numeric::PivotedCholesky(spread).solve(difference));
  return distance > kChiSquared95[static_cast<std::size_t>(axes - 1)];
}

double root(double variance) {
  return variance < 0.0 ? 0.0 : std::sqrt(variance);  // NaN, where there is no covariance, stays NaN
}

bool surely_positive(const Identification& id, int matrix) {
  const impedance::Sensitive smallest = impedance::smallest_eigenvalue(id.model, matrix);
  constexpr double kOneSided95 = 1.6448536269514722;
  return smallest.value - kOneSided95 * impedance::standard_error(smallest, id.covariance) > 0.0;
}

}  // namespace

Result<WidthFindings> analyse_width(const Identification& first, const Identification& second) {
  if (first.axes != second.axes) {
    return bad_data(
        fmt::format("one result has {} and the other {} ax{}s", first.axes, second.axes, second.axes == 1 ? "i" : "e"),
        "compare results with the same number of axes");
  }
  if (first.motion != second.motion && first.motion != Motion::unknown && second.motion != Motion::unknown) {
    return bad_data(fmt::format("the inertia is in {} in one result and in {} in the other",
                                units_of(first.motion).inertia, units_of(second.motion).inertia),
                    "compare results of the same kind of motion");
  }
  const Index n = first.axes, size = n * n;
  WidthFindings findings;
  findings.motion = first.motion == Motion::unknown ? second.motion : first.motion;
  for (int matrix = 0; matrix < 3; ++matrix) {
    const auto k = static_cast<std::size_t>(matrix);
    const Matrix& one = impedance::matrix_of(first.model, matrix);
    const Matrix& other = impedance::matrix_of(second.model, matrix);
    const auto width = impedance::impedance_width(one, other);
    if (!width) {
      findings.refused[k] = width.error().message;
      continue;
    }
    const Matrix C1 = first.covariance.block(matrix * size, matrix * size, size, size);
    const Matrix C2 = second.covariance.block(matrix * size, matrix * size, size, size);
    const auto variance = [&](const Eigen::RowVectorXd& by_first, const Eigen::RowVectorXd& by_second) {
      return (by_first * C1 * by_first.transpose() + by_second * C2 * by_second.transpose()).value();
    };
    WidthFinding finding;
    finding.distance = width->distance;
    finding.surely_positive = surely_positive(first, matrix) && surely_positive(second, matrix);
    finding.distinguishable = differ(one, other, C1 + C2, n);
    finding.distance95 = numeric::interval95(width->distance, root(variance(width->by_first, width->by_second)));
    const bool known = !std::isnan(finding.distance95.first);
    if (known) finding.distance95.first = finding.distinguishable ? std::max(0.0, finding.distance95.first) : 0.0;
    for (Index i = 0; i < n; ++i) {
      const double ratio = width->ratios[i];
      const double error = root(variance(width->ratios_by_first.row(i), width->ratios_by_second.row(i)));
      double direction = 0.0;
      if (n == 2) {
        direction = std::atan2(width->directions(1, i), width->directions(0, i));
        if (direction < 0.0) direction += std::numbers::pi;
        if (direction >= std::numbers::pi) direction = 0.0;
      }
      finding.ratios.push_back({ratio, numeric::positive_interval95(ratio, ratio * error), direction});
      if (n == 3) {
        Vector& along = finding.ratios.back().along = width->directions.col(i);
        Index largest = 0;
        along.cwiseAbs().maxCoeff(&largest);
        if (along[largest] < 0.0) along = -along;
      }
    }
    findings.of[k] = std::move(finding);
  }
  return findings;
}

}  // namespace mbk::analyse
