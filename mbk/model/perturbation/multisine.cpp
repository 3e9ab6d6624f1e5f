#include "mbk/model/perturbation/multisine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include "mbk/base/numeric/random.h"
#include "mbk/model/perturbation/largest_value.h"

namespace mbk::perturbation {
namespace {

/// Cosine and sine of an angle.
struct Turn {
  double cosine = 1.0, sine = 0.0;

  [[nodiscard]] Turn and_then(const Turn& other) const {
    return {cosine * other.cosine - sine * other.sine, sine * other.cosine + cosine * other.sine};
  }
};

/// That turn `times` times.
Turn repeated(Turn turn, int times) {
  Turn all;
  for (; times > 0; times /= 2) {
    if (times % 2 == 1) all = all.and_then(turn);
    turn = turn.and_then(turn);
  }
  return all;
}

}  // namespace

Multisine::Multisine(double period, std::vector<Line> lines) : period_(period), lines_(std::move(lines)) {
  std::vector<Line> sorted = lines_;
  std::ranges::sort(sorted, {}, &Line::harmonic);
  int before = 0;
  for (const Line& line : sorted) {
    steps_.push_back({line.harmonic - before, 2.0 * std::numbers::pi * line.harmonic / period,
                      line.amplitude * std::cos(line.phase), line.amplitude * std::sin(line.phase)});
    before = line.harmonic;
  }
}

Result<Multisine> Multisine::create(double period, std::vector<Line> lines) {
  if (!(period > 0.0 && std::isfinite(period))) return bad_usage(fmt::format("period {} s is not positive", period));
  if (lines.empty()) return bad_usage("a multisine needs at least one harmonic", "name its harmonics");
  std::set<int> seen;
  for (const Line& line : lines) {
    if (line.harmonic < 1) return bad_usage(fmt::format("harmonic {} is not positive", line.harmonic));
    if (line.harmonic > kHighestHarmonic) {
      return bad_usage(fmt::format("harmonic {} is above {}", line.harmonic, kHighestHarmonic),
                       "choose a shorter period");
    }
    if (!seen.insert(line.harmonic).second) {
      return bad_usage(fmt::format("harmonic {} occurs twice", line.harmonic), "name each harmonic once");
    }
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
    return bad_usage(fmt::format("there are {} harmonics but {} amplitudes", harmonics.size(), amplitudes.size()));
  }
  numeric::Random random(seed, stream);
  std::vector<Line> lines;
  for (std::size_t i = 0; i < harmonics.size(); ++i) {
    lines.push_back({harmonics[i], amplitudes[i], 2.0 * std::numbers::pi * random.uniform()});
  }
  return create(period, std::move(lines));
}

Jet<double> Multisine::at(double t) const {
  const double angle = 2.0 * std::numbers::pi * (std::fmod(t, period_) / period_);
  const Turn base{std::cos(angle), std::sin(angle)};
  Turn turn, rise = base;  // to a line, and to it from the line before
  int times = 1;
  Jet<double> sum{0.0, 0.0, 0.0};
  for (const Step& step : steps_) {
    if (step.rise != times) {
      times = step.rise;
      rise = repeated(base, times);
    }
    turn = turn.and_then(rise);
    const double sine = step.in_phase * turn.sine + step.ahead * turn.cosine;
    sum.value += sine;
    sum.first += step.omega * (step.in_phase * turn.cosine - step.ahead * turn.sine);
    sum.second -= step.omega * step.omega * sine;
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
  std::vector<Line> lines = lines_;
  for (Line& line : lines) line.amplitude *= factor;
  return Multisine(period_, std::move(lines));
}

}  // namespace mbk::perturbation
