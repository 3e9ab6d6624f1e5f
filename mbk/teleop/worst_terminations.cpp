#include "mbk/teleop/worst_terminations.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace mbk::teleop {
namespace {

using Complex = std::complex<double>;

/// A mass or a spring with that reactance.
Termination pure(double reactance, double omega) {
  return reactance >= 0.0 ? Termination{reactance / omega, 0.0, 0.0} : Termination{0.0, 0.0, -reactance * omega};
}

Complex impedance(const Termination& termination, double omega) {
  return {termination.damping, termination.mass * omega - termination.stiffness / omega};
}

/// The impedance at port `first` when the other port is terminated by z.
Complex driving_point(const Eigen::Matrix2cd& z, Index first, Complex termination) {
  return z(first, first) - z(0, 1) * z(1, 0) / (z(1 - first, 1 - first) + termination);
}

/// The reactance of the other port that makes the real part of `first` lowest: with z₂₂ + jX₂ = R₂ + jY and R₂ > 0,
///   z₁₂ z₂₁/(R₂ + jY) = |z₁₂ z₂₁| cos θ e^{j(φ − θ)}/R₂,   tan θ = Y/R₂,   whose real part is largest at θ = φ/2
std::optional<double> lowest_at(const Eigen::Matrix2cd& z, Index first) {
  const Complex other = z(1 - first, 1 - first), p = z(0, 1) * z(1, 0);
  if (!(other.real() > 0.0)) return std::nullopt;
  return other.real() * std::tan(0.5 * std::arg(p)) - other.imag();
}

/// σ/ω; values above a hundredth are treated alike.
double per_radian(const WorstTerminations& found) {
  constexpr double kEnough = 0.01;
  return std::min(found.growth / found.frequency.value, kEnough);
}

/// Terminations, and whether nothing else grows nearly as fast.
struct Candidate {
  WorstTerminations found;
  bool alone = false;

  [[nodiscard]] bool better_than(const Candidate& other) const {
    if (alone != other.alone) return alone;
    const double here = per_radian(found), there = per_radian(other.found);
    return here != there ? here > there : found.frequency < other.found.frequency;
  }
};

/// Frequencies at which a closed loop is looked at for what else may grow.
std::vector<double> scan(double sample_time, std::span<const RadPerSec> frequencies) {
  constexpr int kPoints = 1500;
  constexpr double kBeyond = 100.0, kBelow = 1e-2;  // [rad/s]
  double high = 1.0;
  for (const RadPerSec omega : frequencies) high = std::max(high, omega.value);
  high = sample_time > 0.0 ? std::numbers::pi / sample_time : kBeyond * high;
  std::vector<double> omega;
  for (int i = 0; i < kPoints; ++i) omega.push_back(kBelow * std::pow(high / kBelow, double(i) / (kPoints - 1)));
  return omega;
}

class TerminationSearch {
 public:
  TerminationSearch(const Teleoperator& teleoperator, double sample_time, Port port, double a,
                    std::span<const RadPerSec> frequencies)
      : teleoperator_(teleoperator),
        sample_time_(sample_time),
        port_(port == Port::one ? 0 : 1),
        a_(a),
        scanned_(scan(sample_time, frequencies)) {
    for (const double omega : scanned_) z_.push_back(z_at(omega));
  }

  [[nodiscard]] std::optional<Candidate> at(double omega, Index first) const {
    const Eigen::Matrix2cd z = z_at(omega);
    if (!z.allFinite()) return std::nullopt;
    // a port with negative resistance of its own shows it when the other cannot move
    constexpr double kClamp = 1e3;
    const double reactance = lowest_at(z, first).value_or(kClamp * std::abs(z(1 - first, 1 - first)));
    const Termination second = pure(reactance, omega);
    const Complex seen = driving_point(z, first, impedance(second, omega));
    if (!(seen.real() < 0.0)) return std::nullopt;

    constexpr double kStep = 1e-5;  // relative, of a difference in double
    const auto seen_at = [&](double where) { return driving_point(z_at(where), first, impedance(second, where)); };
    const Complex slope = (seen_at(omega * (1 + kStep)) - seen_at(omega * (1 - kStep))) / (2.0 * kStep * omega);
    constexpr double kSlowest = 50.0, kDominates = 4.0;
    const double requested = std::max(kDominates * std::abs(slope), kSlowest * -seen.real() / omega);
    // m ω − k/ω cancels Im seen; m + k/ω² = wanted, or what one of them alone has
    const double cancels = -seen.imag() / omega, total = std::max(requested, std::abs(cancels));
    Termination closing{0.5 * (total + cancels), 0.0, 0.5 * (total - cancels) * omega * omega};

    WorstTerminations found;
    found.frequency = RadPerSec(omega);
    found.growth = -seen.real() / (slope.imag() + total);
    found.at_port[static_cast<std::size_t>(first)] = closing;
    found.at_port[static_cast<std::size_t>(1 - first)] = second;
    const bool alone = !grows_elsewhere(first, found);
    found.at_port[static_cast<std::size_t>(port_)].damping -= a_;
    return Candidate{found, alone};
  }

 private:
  /// Whether the loop has a negative resistance at another frequency where its reactances cancel, and would grow there
  /// more than half as fast, by the same estimate.
  [[nodiscard]] bool grows_elsewhere(Index first, const WorstTerminations& found) const {
    constexpr double kSame = 0.05, kHalf = 0.5;
    Complex before;
    for (std::size_t i = 0; i < scanned_.size(); ++i) {
      const double omega = scanned_[i];
      const Complex round =
          driving_point(z_[i], first, impedance(found.at_port[static_cast<std::size_t>(1 - first)], omega)) +
          impedance(found.at_port[static_cast<std::size_t>(first)], omega);
      const bool crosses = i > 0 && (before.imag() < 0.0) != (round.imag() < 0.0) && before.real() < 0.0;
      const bool elsewhere = std::abs(omega / found.frequency.value - 1.0) > kSame;
      if (crosses && elsewhere) {
        const double slope = (round.imag() - before.imag()) / (omega - scanned_[i - 1]);
        if (-before.real() / std::abs(slope) > kHalf * found.growth) return true;
      }
      before = round;
    }
    return false;
  }

  [[nodiscard]] Eigen::Matrix2cd z_at(double omega) const {
    Eigen::Matrix2cd z = immittance(teleoperator_.with_exact_delay(RadPerSec(omega), sample_time_), Form::z);
    z(port_, port_) -= a_;
    return z;
  }

  const Teleoperator& teleoperator_;
  double sample_time_;
  Index port_;
  double a_;
  std::vector<double> scanned_;
  std::vector<Eigen::Matrix2cd> z_;
};

}  // namespace

std::optional<WorstTerminations> worst_terminations(const Teleoperator& teleoperator,
                                                    std::span<const RadPerSec> frequencies, double sample_time,
                                                    Port port, double a) {
  if (frequencies.empty()) return std::nullopt;
  const TerminationSearch search(teleoperator, sample_time, port, a, frequencies);
  std::optional<Candidate> best;
  for (const RadPerSec omega : frequencies) {
    for (const Index first : {0, 1}) {
      const auto found = search.at(omega.value, first);
      if (found && (!best || found->better_than(*best))) best = found;
    }
  }
  return best ? std::optional(best->found) : std::nullopt;
}

std::vector<RadPerSec> violated_frequencies(const AbsoluteStability& stability, RadPerSec highest) {
  constexpr int kPoints = 50;
  constexpr double kReach = 1e3;  // how far below its upper end a band that begins at 0 is looked at, by a factor
  std::vector<RadPerSec> frequencies;
  for (const StabilityOutcome& outcome : stability.conditions) {
    if (outcome.condition == StabilityCondition::right_poles || outcome.condition == StabilityCondition::axis_poles) {
      continue;
    }
    for (const ViolatedBand& band : outcome.violated) {
      const double high = std::min(band.high.value, highest.value), low = std::max(band.low.value, high / kReach);
      if (!(low < high)) continue;
      for (int i = 0; i < kPoints; ++i) frequencies.emplace_back(low * std::pow(high / low, (i + 0.5) / kPoints));
      if (band.worst <= highest) frequencies.push_back(band.worst);
    }
  }
  return frequencies;
}

}  // namespace mbk::teleop
