#include "mbk/base/numeric/quadratic_program.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {
namespace {

/// How far along `direction` the values may go before one of them is zero; at most 1.
double longest_step(const Vector& values, const Vector& direction) {
  double step = 1.0;
  for (Index i = 0; i < values.size(); ++i) {
    if (direction[i] < 0.0) step = std::min(step, -values[i] / direction[i]);
  }
  return step;
}

double largest(const Vector& values) {
  return values.size() == 0 ? 0.0 : values.lpNorm<Eigen::Infinity>();
}

bool well_formed(const QuadraticProgram& p) {
  const Index n = p.g.size();
  return n > 0 && p.H.rows() == n && p.H.cols() == n && p.C.rows() == p.b.size() &&
         (p.C.rows() == 0 || p.C.cols() == n) && p.G.rows() == p.h.size() && p.G.rows() > 0 && p.G.cols() == n &&
         p.H.allFinite() && p.g.allFinite() && p.C.allFinite() && p.b.allFinite() && p.G.allFinite() && p.h.allFinite();
}

}  // namespace

Result<QuadraticSolution> solve_quadratic_program(const QuadraticProgram& program) {
  constexpr int kMaxSteps = 100;
  constexpr double kMet = 1e-10;
  constexpr double kBack = 0.995;  // how much of the way to the border a step takes
  if (!well_formed(program)) return bad_usage("a quadratic program has inconsistent sizes or a non-finite number");
  const auto& [H, g, C, b, G, h] = program;
  const Index n = g.size(), p = b.size(), m = h.size();
  QuadraticSolution now;
  now.z = Vector::Zero(n);
  now.y = Vector::Zero(p);
  now.lambda = Vector::Ones(m);
  Vector s = (h - G * now.z).cwiseMax(1.0);  // slack of G z ≤ h
  const double scale_dual = 1.0 + largest(g) + H.cwiseAbs().maxCoeff(), scale_equal = 1.0 + largest(b),
               scale_unequal = 1.0 + largest(h);
  Matrix kkt = Matrix::Zero(n + p, n + p);
  if (p > 0) {
    kkt.topRightCorner(n, p) = C.transpose();
    kkt.bottomLeftCorner(p, n) = C;
  }
  for (now.iterations = 0; now.iterations < kMaxSteps; ++now.iterations) {
    Vector dual = H * now.z + g + G.transpose() * now.lambda;
    Vector equal = -b;
    if (p > 0) {
      dual += C.transpose() * now.y;
      equal += C * now.z;
    }
    const Vector unequal = G * now.z + s - h;
    const double gap = s.dot(now.lambda) / static_cast<double>(m);
    if (largest(dual) <= kMet * scale_dual && largest(equal) <= kMet * scale_equal &&
        largest(unequal) <= kMet * scale_unequal && gap <= kMet * scale_dual) {
      now.value = 0.5 * now.z.dot(H * now.z) + g.dot(now.z);
      return now;
    }
    const Vector weight = now.lambda.cwiseQuotient(s);
    kkt.topLeftCorner(n, n) = H + G.transpose() * weight.asDiagonal() * G;
    const Lu lu(kkt);
    Vector dz, dy, ds, dlambda;
    // The Newton step towards s∘λ = target: s dλ + λ ds = −complement.
    const auto newton = [&](const Vector& complement) {
      Vector right(n + p);
      right << -dual - G.transpose() * (now.lambda.cwiseProduct(unequal) - complement).cwiseQuotient(s), -equal;
      const Vector step = lu.solve(right);
      dz = step.head(n);
      dy = step.tail(p);
      ds = -unequal - G * dz;
      dlambda = -(complement + now.lambda.cwiseProduct(ds)).cwiseQuotient(s);
    };
    newton(s.cwiseProduct(now.lambda));
    const double affine = std::min(longest_step(s, ds), longest_step(now.lambda, dlambda));
    const double affine_gap = (s + affine * ds).dot(now.lambda + affine * dlambda) / static_cast<double>(m);
    const double centring = std::pow(affine_gap / gap, 3.0);
    newton(s.cwiseProduct(now.lambda) + ds.cwiseProduct(dlambda) - Vector::Constant(m, centring * gap));
    if (!dz.allFinite() || !dlambda.allFinite()) break;
    const double step = kBack * std::min(longest_step(s, ds), longest_step(now.lambda, dlambda));
    now.z += step * dz;
    now.y += step * dy;
    s += step * ds;
    now.lambda += step * dlambda;
  }
  return fail(ErrorKind::not_usable, "no point was found that satisfies every condition of a quadratic program");
}

}  // namespace mbk::numeric
