#include "mbk/model/perturbation/phases.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"

namespace mbk::perturbation {
namespace {

constexpr double kLargestNorm = 1024.0;  // p of the last L_p norm
constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// One period of a multisine as a function of its phases φ alone:
///   r = S a∘cos φ + C a∘sin φ,   S(n, i) = sin 2πkᵢn/N,   C(n, i) = cos 2πkᵢn/N.
class SampledPeriod {
 public:
  /// @param density  samples to the period of the highest line
  SampledPeriod(const std::vector<Multisine::Line>& lines, int density) {
    const auto count = static_cast<Index>(lines.size());
    const Index samples = density * std::ranges::max(lines, {}, &Multisine::Line::harmonic).harmonic;
    sine_.resize(samples, count);
    cosine_.resize(samples, count);
    amplitude_.resize(count);
    for (Index i = 0; i < count; ++i) {
      const Multisine::Line& line = lines[static_cast<std::size_t>(i)];
      amplitude_[i] = line.amplitude;
      for (Index n = 0; n < samples; ++n) {
        const double turns =
            std::fmod(static_cast<double>(line.harmonic) * static_cast<double>(n) / static_cast<double>(samples), 1.0);
        sine_(n, i) = std::sin(kTwoPi * turns);
        cosine_(n, i) = std::cos(kTwoPi * turns);
      }
    }
  }

  [[nodiscard]] Vector signal(const Vector& phase) const {
    return sine_ * amplitude_.cwiseProduct(phase.array().cos().matrix()) +
           cosine_ * amplitude_.cwiseProduct(phase.array().sin().matrix());
  }

  /// ∂r(n)/∂φᵢ
  [[nodiscard]] Matrix slope(const Vector& phase) const {
    return cosine_ * amplitude_.cwiseProduct(phase.array().cos().matrix()).asDiagonal() -
           Matrix(sine_ * amplitude_.cwiseProduct(phase.array().sin().matrix()).asDiagonal());
  }

 private:
  Matrix sine_, cosine_;
  Vector amplitude_;
};

/// Levenberg–Marquardt on e = |r/R|^{p/2}, with R the peak of the present signal, so that no power overflows.
Vector minimise_norm(const SampledPeriod& period, Vector phase, double p) {
  constexpr int kIterations = 40;
  constexpr double kSmallestStep = 1e-9;  // of the phases [rad]
  double damping = 1e-3;
  Vector r = period.signal(phase);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const double scale = r.cwiseAbs().maxCoeff();
    const Vector relative = r.cwiseAbs() / scale;
    const Vector e = relative.array().pow(0.5 * p);
    const Vector weight = 0.5 * p / scale * relative.array().pow(0.5 * p - 1.0) * r.array().sign();
    const Matrix J = weight.asDiagonal() * period.slope(phase);
    const Matrix gram = J.transpose() * J;
    const Vector gradient = J.transpose() * e;
    const double largest = gram.diagonal().maxCoeff();
    bool improved = false;
    // A delay and a change of sign leave the norm as it is, so that the Gram matrix alone is singular.
    while (!improved && damping < 1e6) {
      const Matrix damped = gram + damping * largest * Matrix::Identity(gram.rows(), gram.cols());
      const Vector step = numeric::PivotedCholesky(damped).solve(-gradient);
      const Vector trial = period.signal(phase + step);
      if ((trial.array().abs() / scale).pow(p).sum() < e.squaredNorm()) {
        improved = true;
        phase += step;
        r = trial;
        damping = std::max(0.1 * damping, 1e-9);
        if (step.cwiseAbs().maxCoeff() < kSmallestStep) return phase;
      } else {
        damping *= 4.0;
      }
    }
    if (!improved) break;
  }
  return phase;
}

Multisine with_phases(const Multisine& signal, const Vector& phase) {
  std::vector<Multisine::Line> lines = signal.lines();
  for (std::size_t i = 0; i < lines.size(); ++i) {
    lines[i].phase = std::remainder(phase[static_cast<Index>(i)], kTwoPi);
  }
  return *Multisine::create(signal.period(), std::move(lines));  // the lines were a multisine before
}

Vector phases_of(const Multisine& signal) {
  Vector phase(static_cast<Index>(signal.lines().size()));
  for (Index i = 0; i < phase.size(); ++i) phase[i] = signal.lines()[static_cast<std::size_t>(i)].phase;
  return phase;
}

}  // namespace

Multisine with_schroeder_phases(const Multisine& signal) {
  const std::vector<Multisine::Line>& lines = signal.lines();
  std::vector<std::size_t> order(lines.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::sort(order, {}, [&](std::size_t i) { return lines[i].harmonic; });
  double power = 0.0;
  for (const Multisine::Line& line : lines) power += line.amplitude * line.amplitude;

  Vector phase = Vector::Zero(static_cast<Index>(lines.size()));
  double angle = 0.5 * std::numbers::pi, below = 0.0;  // `below` is Σ pⱼ of the lines below
  phase[static_cast<Index>(order[0])] = angle;
  for (std::size_t i = 1; i < order.size() && power > 0.0; ++i) {
    const Multisine::Line& previous = lines[order[i - 1]];
    below += previous.amplitude * previous.amplitude / power;
    angle -= kTwoPi * (lines[order[i]].harmonic - previous.harmonic) * below;
    phase[static_cast<Index>(order[i])] = angle;
  }
  return with_phases(signal, phase);
}

Result<Multisine> with_low_crest_phases(const Multisine& signal, const LowCrestOptions& options) {
  if (options.starts < 1) return bad_usage(fmt::format("{} starts are too few: at least 1 is needed", options.starts));
  if (!(signal.root_mean_square() > 0.0)) return bad_usage("every amplitude of the multisine is zero");
  constexpr int kCoarse = 16, kFine = 64, kHighestHarmonic = 10'000;
  const int highest = std::ranges::max(signal.lines(), {}, &Multisine::Line::harmonic).harmonic;
  if (highest > kHighestHarmonic) {
    return bad_usage(fmt::format("harmonic {} is above {}", highest, kHighestHarmonic), "choose a shorter period");
  }
  const SampledPeriod period(signal.lines(), kCoarse);
  numeric::Random random(options.seed);
  Multisine best = with_schroeder_phases(signal);
  for (int start = 0; start < options.starts; ++start) {
    Vector phase = phases_of(with_schroeder_phases(signal));
    if (start > 0) {
      for (double& angle : phase) angle = kTwoPi * random.uniform();
    }
    for (double p = 4.0; p <= kLargestNorm; p *= 2.0) phase = minimise_norm(period, phase, p);
    const Multisine candidate = with_phases(signal, phase);
    if (candidate.crest_factor() < best.crest_factor()) best = candidate;
  }
  Vector phase = phases_of(best);
  const SampledPeriod fine(signal.lines(), kFine);
  for (double p = 256.0; p <= kLargestNorm; p *= 2.0) phase = minimise_norm(fine, phase, p);
  const Multisine polished = with_phases(signal, phase);
  return polished.crest_factor() < best.crest_factor() ? polished : best;
}

}  // namespace mbk::perturbation
