#include "mbk/base/dsp/derivative_filter.h"

#include <utility>

#include "mbk/base/numeric/dense.h"

namespace mbk::dsp {

namespace {

/// Φ, and what an input of 1 adds over `step`.
std::pair<Matrix, Vector> constant_step(const Vector& denominator, double step) {
  const Index n = denominator.size();
  Matrix F = Matrix::Zero(n + 1, n + 1);
  F.diagonal(1).setOnes();
  F.row(n - 1).head(n) = -denominator.transpose();
  const Matrix E = numeric::matrix_exponential(step * F);
  return {E.topLeftCorner(n, n), E.col(n).head(n)};
}

}  // namespace

HeldStep held_step(const Vector& denominator, double step, std::optional<double> held) {
  const Index n = denominator.size();
  if (held) {
    const auto [before, from_last] = constant_step(denominator, *held * step);
    if (*held == 1.0) return {before, from_last, Vector::Zero(n)};
    const auto [after, from_next] = constant_step(denominator, (1.0 - *held) * step);
    return {after * before, after * from_last, from_next};
  }
  Matrix F = Matrix::Zero(n + 2, n + 2);
  F.diagonal(1).head(n - 1).setOnes();
  F.row(n - 1).head(n) = -denominator.transpose();
  F(n - 1, n) = 1.0;
  F(n, n + 1) = 1.0;
  const Matrix E = numeric::matrix_exponential(step * F);
  const Vector from_next = E.col(n + 1).head(n) / step;
  return {E.topLeftCorner(n, n), E.col(n).head(n) - from_next, from_next};
}

DerivativeFilter::DerivativeFilter(const Vector& denominator, std::optional<double> held)
    : a_(denominator), x_(Vector::Zero(denominator.size())), held_share_(held), n_(denominator.size()) {}

void DerivativeFilter::set_state(const Vector& state, double input) {
  x_ = state;
  last_input_ = input;
}

void DerivativeFilter::set_step(double step) {
  if (step == step_) return;
  step_ = step;
  held_ = held_step(a_, step, held_share_);
}

template <int N>
void DerivativeFilter::run_fixed(const double* input, Index count, double* states, Index stride) {
  using State = Eigen::Matrix<double, N, 1>;
  const Eigen::Matrix<double, N, N> transition = held_.transition;
  const State from_last = held_.from_last, from_next = held_.from_next;
  State x = x_;
  double last = last_input_;
  for (Index i = 0; i < count; ++i) {
    State next = from_last * last + from_next * input[i];
    next.noalias() += transition * x;
    x = next;
    last = input[i];
    Eigen::Map<State>(states + i * stride, n_) = x;
  }
  x_ = x;
  last_input_ = last;
}

void DerivativeFilter::run(double step, const double* input, Index count,
                           Eigen::Ref<Matrix, 0, Eigen::OuterStride<>> states) {
  set_step(step);
  double* const to = states.data();
  const Index stride = states.outerStride();
  switch (n_) {
    case 1:
      return run_fixed<1>(input, count, to, stride);
    case 2:
      return run_fixed<2>(input, count, to, stride);
    case 3:
      return run_fixed<3>(input, count, to, stride);
    case 4:
      return run_fixed<4>(input, count, to, stride);
    case 5:
      return run_fixed<5>(input, count, to, stride);
    case 6:
      return run_fixed<6>(input, count, to, stride);
    case 7:
      return run_fixed<7>(input, count, to, stride);
    case 8:
      return run_fixed<8>(input, count, to, stride);
    default:
      for (Index i = 0; i < count; ++i) {
        x_ = (held_.transition * x_ + held_.from_last * last_input_ + held_.from_next * input[i]).eval();
        last_input_ = input[i];
        states.col(i) = x_;
      }
  }
}

}  // namespace mbk::dsp
