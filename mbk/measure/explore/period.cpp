#include "mbk/measure/explore/period.h"

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/FFT>

#include "mbk/base/dsp/spectrum.h"

namespace mbk::explore {
namespace {

constexpr double kReturns = 1e-3;  ///< of the range: coarser than any converter's step, finer than any change

/// Columns without their means and of variance 1; those that never change are left out.
Matrix standardised(const Matrix& signals) {
  Matrix kept(signals.rows(), signals.cols());
  Index columns = 0;
  for (Index k = 0; k < signals.cols(); ++k) {
    Vector x = signals.col(k).array() - signals.col(k).mean();
    const double deviation = std::sqrt(x.squaredNorm() / static_cast<double>(x.size()));
    if (deviation > 0.0) kept.col(columns++) = x / deviation;
  }
  return kept.leftCols(columns);
}

/// d(p) for p = 0 … most.
Vector difference_ratio(const Matrix& signals, Index most) {
  const Index n = signals.rows(), length = dsp::fast_length_above(n + most + 1);
  Vector product = Vector::Zero(most + 1), power = Vector::Zero(n + 1);
  Eigen::FFT<double> fft;
  Vector padded = Vector::Zero(length), correlation;
  Eigen::VectorXcd transform;
  for (Index k = 0; k < signals.cols(); ++k) {
    padded.head(n) = signals.col(k);
    fft.fwd(transform, padded);
    transform = transform.cwiseAbs2().cast<std::complex<double>>().eval();
    fft.inv(correlation, transform);
    product += correlation.head(most + 1);
    for (Index i = 0; i < n; ++i) power[i + 1] += signals(i, k) * signals(i, k);
  }
  for (Index i = 0; i < n; ++i) power[i + 1] += power[i];
  Vector ratio(most + 1);
  for (Index p = 0; p <= most; ++p) {
    const double both = power[n - p] + power[n] - power[p];
    ratio[p] = both > 0.0 ? std::max(0.0, 1.0 - 2.0 * product[p] / both) : 0.0;
  }
  return ratio;
}

Vector ranges_of(const Matrix& signals) {
  return (signals.colwise().maxCoeff() - signals.colwise().minCoeff()).transpose();
}

bool returns(const Matrix& signals, const Vector& range, Index i, Index period) {
  for (Index k = 0; k < signals.cols(); ++k) {
    if (!(std::abs(signals(i + period, k) - signals(i, k)) <= kReturns * range[k])) return false;
  }
  return true;
}

}  // namespace

std::optional<Index> find_period(const Matrix& signals, bool exact) {
  const Matrix x = standardised(signals);
  const Index most = signals.rows() / 2;
  if (x.cols() == 0 || most < 4) return std::nullopt;
  const Vector ratio = difference_ratio(x, most);
  Index first = 1;
  while (first <= most && !(ratio[first] > 0.5)) ++first;
  std::vector<Index> minima;
  for (Index p = first + 1; p <= most; ++p) {
    if (ratio[p] <= ratio[p - 1] && (p == most || ratio[p] < ratio[p + 1]) && ratio[p] < 0.5) minima.push_back(p);
  }
  if (exact) {
    const Vector range = ranges_of(signals);
    for (const Index p : minima) {
      Index same = 0;
      for (Index i = 0; i + p < signals.rows(); ++i) same += returns(signals, range, i, p) ? 1 : 0;
      if (2 * same >= signals.rows() - p) return p;
    }
    return std::nullopt;
  }
  constexpr double kLike = 0.1, kMargin = 0.01;
  double least = 1.0;
  for (const Index p : minima) least = std::min(least, ratio[p]);
  if (!(least < kLike)) return std::nullopt;
  for (const Index p : minima) {
    if (ratio[p] <= 1.5 * least + kMargin) return p;
  }
  return std::nullopt;
}

std::vector<PeriodicPart> periodic_parts(const Matrix& signals, Index period) {
  std::vector<PeriodicPart> parts;
  const Vector range = ranges_of(signals);
  const Index last = signals.rows() - period;
  for (Index i = 0; i < last;) {
    if (!returns(signals, range, i, period)) {
      ++i;
      continue;
    }
    const Index begin = i;
    while (i < last && returns(signals, range, i, period)) ++i;
    if (i - begin >= period) parts.push_back({begin, i + period});
  }
  return parts;
}

}  // namespace mbk::explore
