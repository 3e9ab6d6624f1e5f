#include "mbk/base/dsp/derivative_filter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace mbk::dsp {
namespace {

/// By small Runge–Kutta steps, between samples on a straight line or held for that share of them: the slow plain twin.
Matrix integrated(const Vector& a, const Vector& time, const Vector& u, std::optional<double> held = {}) {
  const Index n = a.size();
  Matrix states(n, u.size());
  Vector x = Vector::Zero(n);
  states.col(0) = x;
  const auto rate = [&](const Vector& at, double input) {
    Vector dx(n);
    dx.head(n - 1) = at.tail(n - 1);
    dx[n - 1] = input - a.dot(at);
    return dx;
  };
  constexpr int kSteps = 200;
  for (Index i = 1; i < u.size(); ++i) {
    const double h = (time[i] - time[i - 1]) / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      const auto input = [&](double part) {
        if (held) return k + 0.5 < *held * kSteps ? u[i - 1] : u[i];
        return u[i - 1] + (u[i] - u[i - 1]) * (k + part) / kSteps;
      };
      const Vector k1 = rate(x, input(0.0)), k2 = rate(x + 0.5 * h * k1, input(0.5));
      const Vector k3 = rate(x + 0.5 * h * k2, input(0.5)), k4 = rate(x + h * k3, input(1.0));
      x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    }
    states.col(i) = x;
  }
  return states;
}

TEST(DerivativeFilter, IsTheDifferentialEquationBetweenStraightLines) {
  Vector time(60), u(60);
  for (Index i = 0; i < 60; ++i) {
    time[i] = 0.2 * static_cast<double>(i) + 0.05 * std::sin(static_cast<double>(3 * i));  // uneven
    u[i] = std::cos(1.7 * time[i]) + (i > 30 ? 1.0 : 0.0);
  }
  for (const Index n : {1, 2, 5, 9}) {
    Vector a(n);
    for (Index k = 0; k < n; ++k) a[k] = std::tgamma(n + 1) / std::tgamma(k + 1) / std::tgamma(n - k + 1);  // (s + 1)ⁿ
    const Matrix expected = integrated(a, time, u);
    DerivativeFilter filter(a);
    Matrix states = Matrix::Zero(n, 60);
    filter.begin(u[0]);
    for (Index i = 1; i < 60; ++i) filter.run(time[i] - time[i - 1], &u[i], 1, states.middleCols(i, 1));
    EXPECT_LT((states - expected).lpNorm<Eigen::Infinity>(), 1e-8) << n;
  }
}

TEST(DerivativeFilter, IsTheDifferentialEquationOfAnInputThatIsHeld) {
  const Vector time = Vector::LinSpaced(60, 0.0, 11.8),
               u = (1.7 * time.array()).cos() + (time.array() > 6.0).cast<double>();
  for (const double held : {1.0, 0.7, 0.25}) {  // each a whole number of the twin's steps
    for (const Index n : {1, 2, 5}) {
      const Vector a = Vector::LinSpaced(n, 1.5, 0.8 * static_cast<double>(n));
      const Matrix expected = integrated(a, time, u, held);
      DerivativeFilter filter(a, held);
      Matrix states(n, 60);
      states.col(0).setZero();
      filter.begin(u[0]);
      filter.run(0.2, &u[1], 59, states.rightCols(59));
      EXPECT_LT((states - expected).lpNorm<Eigen::Infinity>(), 1e-8 * expected.lpNorm<Eigen::Infinity>()) << n << held;
    }
  }
}

TEST(DerivativeFilter, GivesTheSameInPiecesAndAtOnce) {
  Vector a(2);
  a << 1.0, 0.6;
  const Vector u = Vector::LinSpaced(50, -1.0, 3.0).array().sin();
  Matrix whole(2, 50), pieces(2, 50);
  DerivativeFilter one(a), two(a);
  one.run(0.1, u.data(), 50, whole);
  two.run(0.1, u.data(), 20, pieces.leftCols(20));
  two.run(0.1, u.data() + 20, 30, pieces.rightCols(30));
  EXPECT_EQ(whole, pieces);
}

TEST(DerivativeFilter, FollowsAFreeMotionFromItsState) {
  Vector a(2);
  a << 1.0, 0.0;  // s² + 1
  DerivativeFilter filter(a);
  filter.set_state(Vector::Unit(2, 0));
  const Vector none = Vector::Zero(100);
  Matrix states(2, 100);
  filter.run(0.1, none.data(), 100, states);
  EXPECT_NEAR(states(0, 99), std::cos(10.0), 1e-12);
  EXPECT_NEAR(states(1, 99), -std::sin(10.0), 1e-12);
}

}  // namespace
}  // namespace mbk::dsp
