#include "mbk/measure/analyse/energy_lines.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include "mbk/base/numeric/statistics.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::analyse {
namespace {

constexpr double kSearchRate = 100.0;    ///< [Hz] at which the period is looked for first
constexpr double kNearlyRepeats = 0.05;  ///< of the reference's variance, at that rate
constexpr double kRepeats = 0.01;        ///< and at the rate of the recording
constexpr double kUnlike = 0.5;          ///< that far a signal has to go from itself before it can come back
constexpr Index kMinPeriods = 3;         ///< with fewer, nothing shows how they differ
constexpr double kHighestLine = 50.0;    ///< [Hz]
constexpr double kShareOfLine = 0.005;   ///< of the variance of an axis

/// The window of a recording, sample by sample.
struct Window {
  Matrix position, force, reference;  ///< N×n
  double rate = 0;                    ///< [Hz]
};

/// Absent where a channel is missing, a value is not a number, or the clock has a gap.
std::optional<Window> window_of(const Recording& recording, const PreparedTrial& trial) {
  if (trial.preparation.protocol == Protocol::underdamped || trial.segments.empty()) return std::nullopt;
  const Segment &first = trial.segments.front(), &last = trial.segments.back();
  const Index begin = first.first_sample, end = last.first_sample + (last.size() - 1) * trial.preparation.every + 1;
  if (begin < 0 || end > recording.samples() || end - begin < 2) return std::nullopt;
  const Vector time = recording.time.segment(begin, end - begin);
  const Vector steps = time.tail(time.size() - 1) - time.head(time.size() - 1);
  if (!(steps.minCoeff() > 0.0 && steps.maxCoeff() * trial.recording_rate <= 1.5)) return std::nullopt;
  Window window;
  window.rate = trial.recording_rate;
  for (const auto& [quantity, values] : {std::pair{&kPositionChannels, &window.position},
                                         {&kForceChannels, &window.force},
                                         {&kReferenceChannels, &window.reference}}) {
    const Matrix all = recorded(recording, *quantity, trial.axes);
    if (all.size() == 0) return std::nullopt;
    *values = all.middleRows(begin, end - begin);
    if (!values->allFinite()) return std::nullopt;
  }
  return window;
}

double total_variance(const Matrix& signal) {
  return (signal.rowwise() - signal.colwise().mean()).squaredNorm() / static_cast<double>(signal.rows());
}

/// How far a signal is from itself `lag` samples later: 0 the same, about 1 nothing in common. Every `step`-th sample.
double unlike_itself(const Matrix& signal, Index lag, Index step, double variance) {
  double sum = 0.0;
  Index count = 0;
  for (Index i = 0; i + lag < signal.rows(); i += step, ++count)
    sum += (signal.row(i + lag) - signal.row(i)).squaredNorm();
  return sum / (2.0 * variance * static_cast<double>(count));
}

/// [samples]; absent where the signal does not repeat itself kMinPeriods times.
std::optional<Index> period_of(const Matrix& reference, double rate) {
  const double variance = total_variance(reference);
  if (!(variance > 0.0)) return std::nullopt;
  const Index step = std::max<Index>(1, static_cast<Index>(rate / kSearchRate));
  bool went_away = false;
  for (Index lag = step; lag <= reference.rows() / kMinPeriods; lag += step) {
    const double unlike = unlike_itself(reference, lag, step, variance);
    went_away = went_away || unlike > kUnlike;
    if (!went_away || unlike > kNearlyRepeats) continue;
    Index best = lag;
    double least = unlike;
    for (Index near = lag - step; near <= std::min(lag + 2 * step, reference.rows() / kMinPeriods); ++near) {
      const double here = unlike_itself(reference, near, step, variance);
      if (here < least) std::tie(best, least) = std::pair{near, here};
    }
    if (least < kRepeats) return best;
  }
  return std::nullopt;
}

/// Cosine and sine of 2π i/period, i = 0 … period − 1, as e^(−2πj i/period).
Eigen::VectorXcd unit_circle(Index period) {
  Eigen::VectorXcd circle(period);
  for (Index i = 0; i < period; ++i) {
    circle[i] = std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(period));
  }
  return circle;
}

/// Complex amplitude of a harmonic in each column of one period: x = Re(X e^(jωt)).
Eigen::RowVectorXcd amplitude(const Matrix& signal, Index harmonic, const Eigen::VectorXcd& circle) {
  const Index period = circle.size();
  Eigen::RowVectorXcd sum = Eigen::RowVectorXcd::Zero(signal.cols());
  for (Index i = 0, at = 0; i < period; ++i, at = (at + harmonic) % period) sum += circle[at] * signal.row(i);
  return sum * (2.0 / static_cast<double>(period));
}

std::vector<Index> harmonics_of(const Matrix& reference, Index period, double rate) {
  const Eigen::VectorXcd circle = unit_circle(period);
  const Matrix one = reference.topRows(period).rowwise() - reference.topRows(period).colwise().mean();
  const double highest = std::min(kHighestLine, 0.25 * rate);
  std::vector<Index> harmonics;
  for (Index h = 1; static_cast<double>(h) * rate / static_cast<double>(period) <= highest; ++h) {
    const Eigen::RowVectorXcd lines = amplitude(one, h, circle);
    for (Index axis = 0; axis < one.cols(); ++axis) {
      const double variance = one.col(axis).squaredNorm() / static_cast<double>(period);
      if (0.5 * std::norm(lines[axis]) < kShareOfLine * variance || variance == 0.0) continue;
      harmonics.push_back(h);
      break;
    }
  }
  return harmonics;
}

/// −∫ F·v dt of one harmonic over one period: −T/2 Re(F* jωX), summed over the axes.
double absorbed_at(const Matrix& position, const Matrix& force, Index harmonic, const Eigen::VectorXcd& circle) {
  const Eigen::RowVectorXcd X = amplitude(position, harmonic, circle), F = amplitude(force, harmonic, circle);
  // T ω = 2π harmonic
  const std::complex<double> work = F.conjugate().cwiseProduct(std::complex<double>(0.0, 1.0) * X).sum();
  return -std::numbers::pi * static_cast<double>(harmonic) * work.real();
}

}  // namespace

std::vector<EnergyLine> energy_lines(std::span<const Recording* const> recordings,
                                     std::span<const PreparedTrial> trials) {
  std::optional<Index> period;
  std::vector<Index> harmonics;
  std::vector<std::vector<double>> absorbed;  // of each period, line by line
  double rate = 0.0;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const auto window = window_of(*recordings[k], trials[k]);
    if (!window) return {};
    const auto found = period_of(window->reference, window->rate);
    if (!found || (period && (*found != *period || window->rate != rate))) return {};
    period = found;
    rate = window->rate;
    const auto lines = harmonics_of(window->reference, *period, rate);
    if (lines.empty() || (k > 0 && lines != harmonics)) return {};
    harmonics = lines;
    const Eigen::VectorXcd circle = unit_circle(*period);
    for (Index begin = 0; begin + *period <= window->position.rows(); begin += *period) {
      const Matrix x = window->position.middleRows(begin, *period), F = window->force.middleRows(begin, *period);
      std::vector<double> one;
      for (const Index h : harmonics) one.push_back(absorbed_at(x, F, h, circle));
      absorbed.push_back(std::move(one));
    }
  }
  const auto periods = static_cast<Index>(absorbed.size());
  if (periods < kMinPeriods) return {};
  const double quantile =
      numeric::student_quantile(1.0 - 0.025 / static_cast<double>(harmonics.size()), static_cast<int>(periods) - 1);
  std::vector<EnergyLine> lines;
  for (std::size_t line = 0; line < harmonics.size(); ++line) {
    Vector each(periods);
    for (Index b = 0; b < periods; ++b) each[b] = absorbed[static_cast<std::size_t>(b)][line];
    const double half = quantile * std::sqrt(static_cast<double>(periods) * numeric::variance(each)), sum = each.sum();
    lines.push_back({Hertz(static_cast<double>(harmonics[line]) * rate / static_cast<double>(*period)),
                     sum,
                     {sum - half, sum + half}});
  }
  return lines;
}

}  // namespace mbk::analyse
