#include "mbk/model/perturbation/optimal_power.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>

namespace mbk::perturbation {
namespace {

Result<void> check(const OptimalPowerOptions& o) {
  if (o.limited != LimitedSignal::force) return {};
  if (!o.nominal) {
    return bad_usage("a limited force needs a nominal impedance", "give approximate M, B and K");
  }
  const auto [M, B, K] = *o.nominal;
  if (!(std::isfinite(M) && std::isfinite(B) && std::isfinite(K))) {
    return bad_usage(fmt::format("nominal impedance M {} kg, B {} N·s/m, K {} N/m is not finite", M, B, K));
  }
  return {};
}

/// Limited signal over position at ω.
std::complex<double> transfer(const OptimalPowerOptions& o, double omega) {
  switch (o.limited) {
    case LimitedSignal::position:
      return 1.0;
    case LimitedSignal::velocity:
      return {0.0, omega};
    case LimitedSignal::force:
      return {o.nominal->K - o.nominal->M * omega * omega, o.nominal->B * omega};
  }
  return 1.0;
}

double angular_frequency(int harmonic, double period) {
  return 2.0 * std::numbers::pi * harmonic / period;
}

}  // namespace

Result<OptimalPower> optimal_power(double period, const std::vector<int>& harmonics,
                                   const OptimalPowerOptions& options) {
  MBK_TRY(check(options));
  const auto n = static_cast<Index>(harmonics.size());
  std::vector<Multisine::Line> lines;
  for (const int k : harmonics) lines.push_back({k, 1.0, 0.0});
  MBK_TRY(Multisine::create(period, lines));
  if (n < 2) return bad_usage("one harmonic cannot distinguish M from K", "give at least two harmonics");
  if (!(options.floor >= 0.0 && options.floor * static_cast<double>(n) < 1.0)) {
    return bad_usage(
        fmt::format("floor {} at each of {} harmonics is negative or sums to 1 or more", options.floor, n));
  }
  if (options.floor > 0.0 && n < 5) {
    return bad_usage(fmt::format("{} harmonics leave fewer than three between the lowest and the highest", n),
                     "give at least five harmonics, or set floor 0");
  }

  // Iₖ with frequencies relative to the highest: the determinant changes by a factor only.
  double highest = 0.0;
  for (const int k : harmonics) highest = std::max(highest, angular_frequency(k, period));
  std::vector<Eigen::Matrix3d> information;
  double largest_cost = 0.0;
  for (const int k : harmonics) {
    largest_cost = std::max(largest_cost, std::norm(transfer(options, angular_frequency(k, period))));
  }
  for (const int k : harmonics) {
    const double omega = angular_frequency(k, period);
    const double u = std::pow(omega / highest, 2);
    const double cost = std::norm(transfer(options, omega)) / largest_cost;
    if (!(cost > 0.0)) return bad_usage(fmt::format("the nominal impedance is zero at harmonic {}", k));
    information.push_back((Eigen::Matrix3d() << u * u, 0.0, -u, 0.0, u, 0.0, -u, 0.0, 1.0).finished() / cost);
  }

  constexpr double kGap = 1e-7;
  constexpr int kMaxIterations = 1'000'000;
  const double free = 1.0 - options.floor * static_cast<double>(n);
  Vector v = Vector::Constant(n, 1.0 / static_cast<double>(n));
  OptimalPower power;
  power.sensitivity.resize(n);
  for (power.iterations = 1; power.iterations <= kMaxIterations; ++power.iterations) {
    power.shares = (options.floor + free * v.array()).matrix();
    Eigen::Matrix3d I = Eigen::Matrix3d::Zero();
    for (Index k = 0; k < n; ++k) I += power.shares[k] * information[static_cast<std::size_t>(k)];
    const Eigen::Matrix3d inverse = I.inverse();
    for (Index k = 0; k < n; ++k) {
      power.sensitivity[k] = inverse.cwiseProduct(information[static_cast<std::size_t>(k)]).sum();  // both symmetric
    }
    const double mean = v.dot(power.sensitivity);
    power.gap = free * (power.sensitivity.maxCoeff() - mean);
    power.log_determinant = std::log(I.determinant());
    if (power.gap <= kGap) return power;
    v = v.cwiseProduct(power.sensitivity) / mean;
  }
  return fail(ErrorKind::not_usable,
              fmt::format("the power distribution is {:.1e} from optimal after {} steps", power.gap, kMaxIterations),
              "remove closely spaced harmonics");
}

}  // namespace mbk::perturbation
