#include "mbk/measure/analyse/energy_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

#include "mbk/base/dsp/autocorrelation.h"
#include "mbk/base/dsp/fourier.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/model/trial/filtered_band.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::analyse {
namespace {

constexpr double kSearchRate = 100.0;   ///< [Hz] at which the period is looked for first
constexpr double kNearlyRepeats = 0.1;  ///< of the reference's variance, over the whole window
constexpr double kRepeats = 0.01;       ///< and at the rate of the recording
constexpr double kUnlike = 0.5;         ///< that far a signal has to go from itself before it can come back
constexpr Index kMinPeriods = 3;        ///< with fewer, nothing shows how they differ
constexpr double kHighestLine = 50.0;   ///< [Hz]
constexpr double kShareOfLine = 0.005;  ///< of the variance of an axis
constexpr double kChanceAtLines = 1e-5;
constexpr double kMisfit = 0.04;         ///< of the force at the lines, root mean square
constexpr double kSameFrequency = 1e-6;  ///< relative

/// The window of a recording, sample by sample.
struct Window {
  Columns position, force, reference;  ///< N×n
  double rate = 0;                     ///< [Hz]
};

/// Absent where a channel is missing, a value is not a number, or the clock has a gap.
std::optional<Window> window_of(const Recording& recording, const PreparedTrial& trial) {
  if (trial.preparation.protocol == Protocol::underdamped || trial.segments.empty()) return std::nullopt;
  const Segment &first = trial.segments.front(), &last = trial.segments.back();
  const Index begin = first.first_sample, end = last.first_sample + (last.size() - 1) * trial.preparation.every + 1;
  if (begin < 0 || end > recording.samples() || end - begin < 2) return std::nullopt;
  const auto time = recording.time.segment(begin, end - begin);
  const auto steps = time.tail(time.size() - 1) - time.head(time.size() - 1);
  if (!(steps.minCoeff() > 0.0 && steps.maxCoeff() * trial.recording_rate <= 1.5)) return std::nullopt;
  Window window;
  window.rate = trial.recording_rate;
  for (const auto& [quantity, values] : {std::pair{&kPositionChannels, &window.position},
                                         {&kForceChannels, &window.force},
                                         {&kReferenceChannels, &window.reference}}) {
    const Columns all = channels_of(recording, *quantity, trial.axes);
    if (all.size() == 0) return std::nullopt;
    *values = all.part(begin, end - begin);
    for (Index axis = 0; axis < values->cols(); ++axis) {
      if (!values->col(axis).allFinite()) return std::nullopt;
    }
  }
  return window;
}

double total_variance(const Columns& signal) {
  double sum = 0.0;
  for (Index axis = 0; axis < signal.cols(); ++axis) {
    const auto values = signal.col(axis).array();
    const double mean = values.sum() / static_cast<double>(signal.rows());
    sum += (values - mean).square().sum();
  }
  return sum / static_cast<double>(signal.rows());
}

/// How far a signal is from itself some samples later, for as many lags as asked, one after another: 0 the same, about
/// 1 nothing in common. Every `step`-th sample. All of them in one walk, as a long signal comes from the disk.
Vector unlike_itself(const Columns& signal, Index first_lag, Index lags, Index step, double variance) {
  Vector sums = Vector::Zero(lags), counts = Vector::Zero(lags), distances(lags);
  for (Index i = 0; i + first_lag < signal.rows(); i += step) {
    const Index there = std::min(lags, signal.rows() - first_lag - i);
    std::fill_n(distances.data(), there, 0.0);
    for (Index axis = 0; axis < signal.cols(); ++axis) {
      const double* const later = signal.col(axis).data() + i + first_lag;
      const double now = signal(i, axis);
      for (Index k = 0; k < there; ++k) distances[k] += (later[k] - now) * (later[k] - now);
    }
    for (Index k = 0; k < there; ++k) {
      sums[k] += distances[k];
      counts[k] += 1.0;
    }
  }
  return sums.array() / (2.0 * variance * counts.array());
}

/// The same of every sample for each lag from 0 to `last`: Σ |x(i + l) − x(i)|² is two sums of squares less twice the
/// autocorrelation.
Vector unlike_by_lag(Matrix centred, Index last, double variance) {
  centred.rowwise() -= centred.colwise().mean().eval();
  const Vector squares = centred.rowwise().squaredNorm();
  std::vector<Vector> axes;
  for (Index axis = 0; axis < centred.cols(); ++axis) axes.emplace_back(centred.col(axis));
  centred.resize(0, 0);
  const Vector alike = squares.sum() * dsp::autocorrelation(axes, last);
  Vector unlike(last + 1);
  double earlier = squares.sum(), later = earlier;  // Σ |x(i)|² and Σ |x(i + l)|²
  for (Index lag = 0; lag <= last; ++lag) {
    const Index count = squares.size() - lag;
    unlike[lag] = (earlier + later - 2.0 * alike[lag]) / (2.0 * variance * static_cast<double>(count));
    earlier -= squares[count - 1];
    later -= squares[lag];
  }
  return unlike;
}

/// Whole periods of a signal, one after another.
struct Periods {
  Index begin = 0, length = 0, count = 0;  ///< [samples], [samples]
};

/// The periods of that length, counted from the end of the signal, in which it repeats itself; what comes before, as
/// where the perturbation grows from rest, is left out.
Periods periods_of(const Columns& signal, Index length, double variance) {
  Periods periods{signal.rows() - length, length, 1};
  while (periods.begin >= length) {
    if (unlike_itself(signal.part(periods.begin - length, 2 * length), length, 1, 1, variance)[0] > kRepeats) break;
    periods.begin -= length;
    ++periods.count;
  }
  return periods;
}

/// Absent where the signal does not repeat itself kMinPeriods times.
std::optional<Periods> periods_of(const Columns& reference, double rate) {
  const double variance = total_variance(reference);
  if (!(variance > 0.0)) return std::nullopt;
  const Index step = std::max<Index>(1, static_cast<Index>(rate / kSearchRate));
  const Index longest = reference.rows() / kMinPeriods;
  Matrix some((reference.rows() - 1) / step + 1, reference.cols());
  for (Index axis = 0; axis < some.cols(); ++axis) {
    some.col(axis) = reference.col(axis)(Eigen::seqN(0, some.rows(), step));
  }
  const Vector coarse = unlike_by_lag(std::move(some), longest / step, variance);
  bool went_away = false;
  for (Index lag = step; lag <= longest; lag += step) {
    went_away = went_away || coarse[lag / step] > kUnlike;
    if (!went_away || coarse[lag / step] > kNearlyRepeats) continue;
    Index best = lag, first = lag - step;
    Vector nearby = unlike_itself(reference, first, std::min(3 * step, longest - first) + 1, step, variance);
    double least = nearby[step];
    for (Index near = first; near <= std::min(best + 2 * step, longest); ++near) {  // down to the bottom
      if (near - first == nearby.size()) {
        first = near;
        nearby = unlike_itself(reference, first, std::min(3 * step, longest - first) + 1, step, variance);
      }
      const double here = nearby[near - first];
      if (here < least) std::tie(best, least) = std::pair{near, here};
    }
    const Periods found = periods_of(reference, best, variance);
    if (found.count >= kMinPeriods) return found;
  }
  return std::nullopt;
}

/// Complex amplitudes of the harmonics 0, 1 … (rows) in each column of one period: x = Re(X e^(jωt)).
Eigen::MatrixXcd amplitudes(const Matrix& period) {
  return dsp::fourier_transforms(period) * (2.0 / static_cast<double>(period.rows()));
}

std::vector<Index> harmonics_of(const Columns& whole, const Periods& periods, double rate) {
  const Matrix reference = whole.middle_rows(periods.begin, periods.length);
  const Matrix one = reference.rowwise() - reference.colwise().mean();
  const Eigen::RowVectorXd variance = one.colwise().squaredNorm() / static_cast<double>(periods.length);
  const Eigen::MatrixXcd lines = amplitudes(one);
  const double highest = std::min(kHighestLine, 0.25 * rate);
  std::vector<Index> harmonics;
  for (Index h = 1; static_cast<double>(h) * rate / static_cast<double>(periods.length) <= highest; ++h) {
    bool stands_out = false;
    for (Index axis = 0; axis < one.cols(); ++axis) {
      stands_out |= variance[axis] > 0.0 && 0.5 * std::norm(lines(h, axis)) >= kShareOfLine * variance[axis];
    }
    if (stands_out) harmonics.push_back(h);
  }
  return harmonics;
}

/// −∫ F·v dt of each line over one period: −T/2 Re(F* jωX), summed over the axes; T ω = 2π h.
std::vector<double> absorbed_at(const std::vector<Index>& harmonics, const Eigen::MatrixXcd& X,
                                const Eigen::MatrixXcd& F) {
  std::vector<double> absorbed;
  for (std::size_t line = 0; line < harmonics.size(); ++line) {
    const auto row = static_cast<Index>(line);
    const std::complex<double> work =
        F.row(row).conjugate().cwiseProduct(std::complex<double>(0.0, 1.0) * X.row(row)).sum();
    absorbed.push_back(-std::numbers::pi * static_cast<double>(harmonics[line]) * work.real());
  }
  return absorbed;
}

/// Mean of a line's residual over the periods, and how it scatters.
struct LineResidual {
  double p_value = 1;
  double systematic = 0;  ///< |mean|² beyond what the scatter makes of it [N²]
};

/// Hotelling's test of complex vectors, one of each period: (P − n)/(n (P − 1)) T² is F(2n, 2(P − n)).
/// @param residual P×n
LineResidual judged(const Eigen::MatrixXcd& residual) {
  const Index n = residual.cols();
  const auto periods = static_cast<double>(residual.rows()), axes = static_cast<double>(n);
  const Eigen::VectorXcd mean = residual.colwise().mean().transpose();
  const Eigen::MatrixXcd away = residual.rowwise() - mean.transpose();
  const Eigen::MatrixXcd scatter = (away.transpose() * away.conjugate()) / (periods - 1.0);
  // T² = P meanᴴ S⁻¹ mean
  double square = 0.0;
  if (n > 2) {
    square = (mean.adjoint() * numeric::complex_inverse(scatter) * mean).value().real();
  } else if (n == 1) {
    square = std::norm(mean[0]) / scatter(0, 0).real();
  } else {
    const double determinant = scatter(0, 0).real() * scatter(1, 1).real() - std::norm(scatter(0, 1));
    square = (std::norm(mean[0]) * scatter(1, 1).real() + std::norm(mean[1]) * scatter(0, 0).real() -
              2.0 * (std::conj(mean[0]) * scatter(0, 1) * mean[1]).real()) /
             determinant;
  }
  LineResidual result;
  result.systematic = mean.squaredNorm() - scatter.trace().real() / periods;
  const double statistic = (periods - axes) / (axes * (periods - 1.0)) * periods * square;
  if (std::isfinite(statistic)) {
    result.p_value = numeric::f_probability_above(std::max(0.0, statistic), 2.0 * axes, 2.0 * (periods - axes));
  }
  return result;
}

/// P(χ² > x), 2k degrees of freedom.
double chi_square_above(double x, std::size_t k) {
  double term = std::exp(-0.5 * x), sum = term;
  for (std::size_t i = 1; i < k; ++i) {
    term *= 0.5 * x / static_cast<double>(i);
    sum += term;
  }
  return std::min(1.0, sum);
}

}  // namespace

LineSpectra line_spectra(std::span<const Recording* const> recordings, std::span<const PreparedTrial> trials) {
  LineSpectra found;
  Index length = 0;
  double rate = 0.0;
  for (std::size_t k = 0; k < recordings.size(); ++k) {
    const auto window = window_of(*recordings[k], trials[k]);
    if (!window) return {};
    const auto periods = periods_of(window->reference, window->rate);
    if (!periods) return {};
    auto own = harmonics_of(window->reference, *periods, window->rate);
    if (own.empty() || (k > 0 && (periods->length != length || window->rate != rate || own != found.harmonics))) {
      return {};
    }
    length = periods->length;
    rate = window->rate;
    found.harmonics = std::move(own);
    for (Index one = 0; one < periods->count; ++one) {
      const Index begin = periods->begin + one * length;
      found.position.emplace_back(amplitudes(window->position.middle_rows(begin, length))(found.harmonics, Eigen::all));
      found.force.emplace_back(amplitudes(window->force.middle_rows(begin, length))(found.harmonics, Eigen::all));
    }
  }
  if (found.periods() < kMinPeriods) return {};
  found.period_s = static_cast<double>(length) / rate;
  return found;
}

std::vector<EnergyLine> energy_lines(const LineSpectra& spectra) {
  const std::vector<Index>& harmonics = spectra.harmonics;
  if (harmonics.empty()) return {};
  const Index periods = spectra.periods();
  std::vector<std::vector<double>> absorbed;  // of each period, line by line
  for (std::size_t b = 0; b < spectra.force.size(); ++b) {
    absorbed.push_back(absorbed_at(harmonics, spectra.position[b], spectra.force[b]));
  }
  const double quantile =
      numeric::student_quantile(1.0 - 0.025 / static_cast<double>(harmonics.size()), static_cast<int>(periods) - 1);
  std::vector<EnergyLine> lines;
  for (std::size_t line = 0; line < harmonics.size(); ++line) {
    Vector each(periods);
    for (Index b = 0; b < periods; ++b) each[b] = absorbed[static_cast<std::size_t>(b)][line];
    const double half = quantile * std::sqrt(static_cast<double>(periods) * numeric::variance(each)), sum = each.sum();
    lines.push_back(
        {spectra.frequency(line), static_cast<double>(periods) * spectra.period_s, sum, {sum - half, sum + half}});
  }
  return lines;
}

std::optional<AssumptionTest> test_lines(const LineSpectra& spectra, std::span<const PreparedTrial> trials,
                                         const Identification& id) {
  if (spectra.periods() <= id.axes + 1 || !id.model.M.allFinite() || !id.model.K.allFinite()) return std::nullopt;
  double top = std::numeric_limits<double>::infinity();
  for (const PreparedTrial& trial : trials) top = std::min(top, passed_band(trial.preparation));
  const Matrix inertia = id.model.M + id.handle_mass * Matrix::Identity(id.axes, id.axes);
  AssumptionTest result{Assumption::fits_at_lines};
  double fisher = 0.0, systematic = 0.0, force = 0.0;
  std::size_t lines = 0;
  for (std::size_t line = 0; line < spectra.harmonics.size(); ++line) {
    const double hz = spectra.frequency(line).value, omega = 2.0 * std::numbers::pi * hz;
    if (hz > top * (1.0 + kSameFrequency)) continue;
    const auto row = static_cast<Index>(line);
    const Eigen::MatrixXcd Z = (id.model.K - omega * omega * inertia).cast<std::complex<double>>() +
                               std::complex<double>(0.0, omega) * id.model.B.cast<std::complex<double>>();
    Eigen::MatrixXcd residual(spectra.periods(), id.axes);
    for (Index b = 0; b < spectra.periods(); ++b) {
      const auto period = static_cast<std::size_t>(b);
      residual.row(b) = spectra.force[period].row(row) + spectra.position[period].row(row) * Z.transpose();
      force += spectra.force[period].row(row).squaredNorm() / static_cast<double>(spectra.periods());
    }
    const LineResidual found = judged(residual);
    fisher -= 2.0 * std::log(found.p_value);
    systematic += found.systematic;
    ++lines;
  }
  if (lines == 0 || !(force > 0.0)) return std::nullopt;
  result.p_value = std::isfinite(fisher) ? chi_square_above(fisher, lines) : 0.0;
  result.size = std::sqrt(std::max(0.0, systematic) / force);
  result.contradicted = result.p_value < kChanceAtLines && result.size > kMisfit;
  return result;
}

void warn_of_lines(const AssumptionTest& test, Identification& identification) {
  identification.assumptions.push_back(test);
  if (!test.contradicted) return;
  identification.warnings.push_back(
      {WarningCode::lack_of_fit,
       fmt::format("at the frequencies of the perturbation, M, B and K miss {:.0f} % of the force (root mean square) "
                   "in the same way in every period: the impedance of the limb has a different frequency dependence",
                   100.0 * test.size),
       "do not use M, B and K at single frequencies; 'mbk explore' shows the frequency response of the limb"});
}

}  // namespace mbk::analyse
