#include "mbk/measure/analyse/tremor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "mbk/base/dsp/cross_spectrum.h"
#include "mbk/base/dsp/spectrum.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::analyse {
namespace {

constexpr double kLowest = 3.0, kHighest = 14.0;  ///< [Hz]
constexpr double kResolution = 0.25;              ///< [Hz]
constexpr double kNear = 0.75, kFar = 2.0;        ///< of what a line is compared with [Hz]
constexpr double kShortest = 16.0;                ///< [s]
constexpr double kAbove = 5.0, kChance = 1e-3;
constexpr double kReach = 0.5;          ///< of a line of the reference in the spectrum [Hz]
constexpr double kWeakest = 1e-4;       ///< line of a reference, of its strongest
constexpr double kShareOfForce = 0.08;  ///< standard deviation over that of the force

/// The median of the spectrum beside a line, on the side where it is lower and where it is higher.
std::pair<double, double> beside(const dsp::Spectrum& spectrum, Index line) {
  std::pair<double, double> sides = {std::numeric_limits<double>::infinity(), 0.0};
  for (const Index step : {-1, 1}) {
    std::vector<double> values;
    const auto away = [&](Index k) { return std::abs(spectrum.frequency[k] - spectrum.frequency[line]); };
    for (Index k = line + step; k > 0 && k < spectrum.frequency.size() && away(k) <= kFar; k += step) {
      if (away(k) >= kNear) values.push_back(spectrum.density[k]);
    }
    if (values.empty()) continue;
    const double middle = numeric::median(values);
    sides = {std::min(sides.first, middle), std::max(sides.second, middle)};
  }
  return sides;
}

/// Whether the reference, whose strongest line is given, has one near there: a line that stands above what is beside it
/// on either side.
bool has_line(const dsp::Spectrum& reference, double strongest, Index at) {
  const double low = reference.frequency[at] - kReach, high = reference.frequency[at] + kReach;
  const Vector& f = reference.frequency;
  for (Index k = std::max<Index>(1, std::ranges::lower_bound(f, low) - f.begin()); k < f.size() && f[k] <= high; ++k) {
    const double here = reference.density[k];
    if (here > kWeakest * strongest && here > kAbove * beside(reference, k).first) return true;
  }
  return false;
}

/// How far a line stands above what is beside it.
double prominence(const dsp::Spectrum& spectrum, Index line) {
  const double floor = beside(spectrum, line).second;
  return floor > 0.0 ? spectrum.density[line] / floor : 0.0;
}

/// The lines of the force that the references make, told by their coherence with all of them: what reaches the robot
/// through a filter, or from the other axis, need be no line of a reference.
class MadeByReferences {
 public:
  MadeByReferences(const Matrix& signals, double rate) : signals_(signals), rate_(rate) {}

  [[nodiscard]] bool at(double frequency_hz) {
    constexpr double kMade = 0.5;
    if (!known_) {
      known_ = true;
      const Index length = dsp::segment_length(Hertz(rate_), Hertz(kResolution), signals_.rows());
      const auto spectra = dsp::cross_spectra({signals_}, Hertz(rate_), length, Hertz(kHighest + kFar));
      if (spectra) {
        frequency_ = spectra->frequency;
        coherence_ = dsp::multiple_coherence(*spectra, signals_.cols() - 1);
      }
    }
    for (Index k = 0; k < frequency_.size(); ++k) {
      if (std::abs(frequency_[k] - frequency_hz) <= kResolution && coherence_(k, 0) > kMade) return true;
    }
    return false;
  }

 private:
  const Matrix& signals_;
  double rate_;
  bool known_ = false;
  Vector frequency_;
  Matrix coherence_;
};

/// The clearest line of one axis.
/// @param signals  [references of all axes | force]
AssumptionTest line_of(const Matrix& signals, double rate) {
  AssumptionTest result{Assumption::no_tremor};
  const auto spectrum_of = [&](Index column) {
    return dsp::welch(signals.col(column), Hertz(rate), Hertz(kResolution));
  };
  const Index references = signals.cols() - 1;
  const auto of_force = spectrum_of(references);
  if (!of_force) return result;
  std::vector<dsp::Spectrum> of_reference;
  for (Index k = 0; k < references; ++k) {
    auto one = spectrum_of(k);
    if (!one) return result;
    of_reference.push_back(std::move(*one));
  }
  const auto is_of_a_reference = [&](Index line) {
    return std::ranges::any_of(of_reference,
                               [&](const dsp::Spectrum& one) { return has_line(one, one.density.maxCoeff(), line); });
  };
  const double width = of_force->frequency[1] - of_force->frequency[0];
  const double segments = static_cast<double>(signals.rows()) / rate * width;
  MadeByReferences made(signals, rate);
  Index lines = 0, best = 0;
  double highest = 0.0;
  for (Index k = 1; k + 1 < of_force->frequency.size(); ++k) {
    if (of_force->frequency[k] < kLowest || of_force->frequency[k] > kHighest) continue;
    ++lines;
    const double above = prominence(*of_force, k);
    if (above <= highest || is_of_a_reference(k) || (above > kAbove && made.at(of_force->frequency[k]))) continue;
    highest = above;
    best = k;
  }
  if (best == 0) return result;
  // Hann windows that overlap by half: about 1.9 degrees of freedom for each length of data that a segment takes.
  const double freedom = 1.9 * 2.0 * segments;
  result.p_value =
      std::min(1.0, static_cast<double>(lines) * numeric::f_probability_above(highest, freedom, 2.0 * freedom));
  const double floor = beside(*of_force, best).second;
  result.size = std::sqrt(std::max(0.0, of_force->density.segment(best - 1, 3).sum() - 3.0 * floor) * width);
  result.frequency_hz = of_force->frequency[best];
  result.contradicted = highest > kAbove && result.p_value < kChance &&
                        result.size > kShareOfForce * std::sqrt(numeric::variance(signals.col(references)));
  return result;
}

}  // namespace

std::optional<AssumptionTest> test_tremor(std::span<const Recording* const> recordings,
                                          std::span<const PreparedTrial> trials) {
  std::optional<AssumptionTest> clearest;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const Recording& recording = *recordings[k];
    const PreparedTrial& trial = trials[k];
    const double rate = trial.recording_rate;
    const Columns force = channels_of(recording, kForceChannels, trial.axes),
                  reference = channels_of(recording, kReferenceChannels, trial.axes);
    if (force.size() == 0 || reference.size() == 0 || !(rate > 4.0 * kHighest)) continue;
    const Index begin = std::max<Index>(0, std::llround(trial.preparation.from_s * rate)),
                end = std::min<Index>(recording.samples(), std::llround(trial.preparation.to_s * rate) + 1);
    if (static_cast<double>(end - begin) < kShortest * rate) continue;
    const auto time = recording.time.segment(begin, end - begin);
    if ((time.tail(time.size() - 1) - time.head(time.size() - 1)).maxCoeff() * rate > 1.5) continue;
    Matrix signals(end - begin, reference.cols() + 1);
    bool finite = true;
    for (Index axis = 0; axis < reference.cols(); ++axis) {
      signals.col(axis) = reference.col(axis).segment(begin, end - begin);
      finite = finite && first_non_finite(signals.col(axis)) < 0;
    }
    for (Index axis = 0; finite && axis < trial.axes; ++axis) {
      signals.col(reference.cols()) = force.col(axis).segment(begin, end - begin);
      if (first_non_finite(signals.col(reference.cols())) >= 0) continue;
      const AssumptionTest found = line_of(signals, rate);
      if (!clearest || found.p_value < clearest->p_value) clearest = found;
    }
  }
  return clearest;
}

void warn_of_tremor(const AssumptionTest& tremor, Identification& identification) {
  identification.assumptions.push_back(tremor);
  if (!tremor.contradicted || identification.method == Method::instrumental_variables) return;
  identification.warnings.push_back(
      {WarningCode::tremor,
       fmt::format("the force contains a rhythm at {:.3g} Hz, {:.2g} {} (standard deviation), that the perturbation "
                   "did not cause: tremor, which biases M, B and K from least squares",
                   tremor.frequency_hz, tremor.size, units_of(identification.motion).force),
       "use --method iv: it treats tremor as noise"});
}

}  // namespace mbk::analyse
