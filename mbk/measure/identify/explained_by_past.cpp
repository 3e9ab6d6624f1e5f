#include "mbk/measure/identify/explained_by_past.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "mbk/base/numeric/dense.h"

namespace mbk::identify {

namespace {

/// h of s_t = Σ_k h_k r_{t−k}, by least squares on the correlations of signals without a mean.
Vector finite_impulse_response(const Eigen::Ref<const Vector>& r, const Eigen::Ref<const Vector>& s, Index lags) {
  Vector own(lags), cross(lags);
  for (Index k = 0; k < lags; ++k) {
    own[k] = r.head(r.size() - k).dot(r.tail(r.size() - k));
    cross[k] = r.head(r.size() - k).dot(s.tail(r.size() - k));
  }
  constexpr double kRidge = 1e-9;
  Matrix gram(lags, lags);
  for (Index i = 0; i < lags; ++i) {
    for (Index j = 0; j < lags; ++j) gram(i, j) = own[std::abs(i - j)] * (i == j ? 1.0 + kRidge : 1.0);
  }
  return numeric::PivotedCholesky(gram).solve(cross);
}

}  // namespace

Vector explained_by_past(const Vector& reference, const Vector& signal) {
  constexpr Index kMaxLags = 300;
  const Index total = signal.size(), lags = std::clamp<Index>(total / 20, 1, kMaxLags), half = total / 2;
  const double mean = signal.mean();
  const Vector r = reference.array() - reference.mean(), s = signal.array() - mean;
  const Vector of_first = finite_impulse_response(r.head(half), s.head(half), lags);
  const Vector of_second = finite_impulse_response(r.tail(total - half), s.tail(total - half), lags);
  Vector explained = Vector::Constant(total, mean);
  for (Index k = 0; k < lags; ++k) {
    explained.segment(k, half - k) += of_second[k] * r.head(half - k);
    explained.tail(total - half) += of_first[k] * r.segment(half - k, total - half);
  }
  return explained;
}

}  // namespace mbk::identify
