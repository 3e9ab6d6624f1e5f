#include "mbk/model/perturbation/multisine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "mbk/base/numeric/random.h"
#include "mbk/model/perturbation/largest_value.h"

namespace mbk::perturbation {

Result<Multisine> Multisine::create(double period, std::vector<Line> lines) {
  if (!(period > 0.0 && std::isfinite(period))) return bad_usage(fmt::format("period {} s is not above 0", period));
  if (lines.empty()) return bad_usage("a multisine needs at least one line");
  std::set<int> seen;
  for (const Line& line : lines) {
    if (line.harmonic < 1) return bad_usage(fmt::format("harmonic {} is not above 0", line.harmonic));
    if (line.harmonic > kHighestHarmonic) {
      return bad_usage(fmt::format("harmonic {} is above {}", line.harmonic, kHighestHarmonic),
                       "take a shorter period");
    }
    if (!seen.insert(line.harmonic).second) return bad_usage(fmt::format("harmonic {} stands twice", line.harmonic));
    if (!std::isfinite(line.amplitude) || !std::isfinite(line.phase)) {
      return bad_usage(fmt::format("amplitude {} or phase {} rad of harmonic {} is not finite", line.amplitude,
                                   line.phase, line.harmonic));
    }
  }
  return Multisine(period, std::move(lines));
}

Result<Multisine> Multisine::with_random_phases(double period, const std::vector<int>& harmonics,
                                                const std::vector<double>& amplitudes, std::uint64_t seed,
                                                std::uint32_t stream) {
  if (harmonics.size() != amplitudes.size()) {
    return bad_usage(fmt::format("{} harmonics, but {} amplitudes", harmonics.size(), amplitudes.size()));
  }
  numeric::Random random(seed, stream);
  std::vector<Line> lines;
  for (std::size_t i = 0; i < harmonics.size(); ++i) {
    lines.push_back({harmonics[i], amplitudes[i], 2.0 * std::numbers::pi * random.uniform()});
  }
  return create(period, std::move(lines));
}

Jet<double> Multisine::at(double t) const {
  const double turns = std::fmod(t, period_) / period_;  // of the base period: keeps the sine's argument small
  Jet<double> sum{0.0, 0.0, 0.0};
  for (const Line& line : lines_) {
    const double omega = 2.0 * std::numbers::pi * line.harmonic / period_;
    const double angle = 2.0 * std::numbers::pi * line.harmonic * turns + line.phase;
    const double sine = line.amplitude * std::sin(angle);
    sum.value += sine;
    sum.first += omega * line.amplitude * std::cos(angle);
    sum.second -= omega * omega * sine;
  }
  return sum;
}

double Multisine::root_mean_square() const {
  double power = 0.0;
  for (const Line& line : lines_) power += 0.5 * line.amplitude * line.amplitude;
  return std::sqrt(power);
}

double Multisine::peak() const {
  const int samples = 64 * std::ranges::max(lines_, {}, &Line::harmonic).harmonic;
  const auto magnitude = [&](double t) { return std::abs(at(t).value); };
  std::vector<double> times, values;
  for (int k = 0; k <= samples; ++k) {
    times.push_back(period_ * k / samples);
    values.push_back(magnitude(times.back()));
  }
  return largest_value(times, values, magnitude).value;
}

double Multisine::crest_factor() const {
  const double rms = root_mean_square();
  return rms > 0.0 ? peak() / rms : 0.0;
}

Multisine Multisine::scaled(double factor) const {
  Multisine other = *this;
  for (Line& line : other.lines_) line.amplitude *= factor;
  return other;
}

}  // namespace mbk::perturbation
