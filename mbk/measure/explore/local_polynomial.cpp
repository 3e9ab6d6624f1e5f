#include "mbk/measure/explore/local_polynomial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mbk/base/dsp/fourier.h"
#include "mbk/base/dsp/spectrum.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/measure/explore/alike.h"
#include "mbk/measure/explore/response_intervals.h"

namespace mbk::explore {
namespace {

constexpr Index kPolynomialOrder = 2;
constexpr Index kTerms = kPolynomialOrder + 1;
constexpr Index kMinFreedom = 8;      ///< of the residual: its variance is known to about a third
constexpr double kNotExcited = 1e-9;  ///< of the strongest line: a window without one more than that is not excited
constexpr double kMaxChance = 1.0;    ///< power that noise alone would seem to explain, of its own
constexpr double kTold = 1e-4;        ///< least pivot of the regressors, of columns of length 1

/// Spectra of the signals of a trial: rows are outputs, inputs and, behind them, the reference; column k is line k.
Eigen::MatrixXcd record_spectra(const ExplorationTrial& trial, Index samples, Index lines, bool with_reference) {
  const Index n = trial.input.cols();
  Eigen::MatrixXcd spectra(trial.output.cols() + n * (with_reference ? 2 : 1), lines);
  const auto transform = [&](const Matrix& signals, Index row) {
    const Matrix x = signals.topRows(samples).rowwise() - signals.topRows(samples).colwise().mean();
    spectra.middleRows(row, x.cols()) =
        dsp::fourier_transforms(x).topRows(lines).transpose() / std::sqrt(static_cast<double>(samples));
  };
  transform(trial.output, 0);
  transform(trial.input, trial.output.cols());
  if (with_reference) transform(trial.reference, trial.output.cols() + n);
  return spectra;
}

/// The strongest line of each input, or of its reference.
Vector strongest_lines(const std::vector<Eigen::MatrixXcd>& spectra, Index first, Index inputs) {
  Vector strongest = Vector::Zero(inputs);
  for (const Eigen::MatrixXcd& X : spectra) {
    strongest = strongest.cwiseMax(Vector(X.middleRows(first, inputs).cwiseAbs().rowwise().maxCoeff()));
  }
  return strongest;
}

/// What the lines around one say.
struct LocalFit {
  Eigen::MatrixXcd response;    ///< of Z to X at the line
  Eigen::MatrixXcd input_part;  ///< (KᴴK)⁻¹ of the response, n_x×n_x
  Eigen::MatrixXcd residual;    ///< covariance of V
  bool determined = false;
};

/// @param strongest  line of each input
LocalFit local_fit(const std::vector<Eigen::MatrixXcd>& spectra, const Vector& strongest, Index outputs,
                   bool by_reference, Index line, Index low, Index width) {
  const Index inputs = strongest.size();
  const auto trials = static_cast<Index>(spectra.size());
  const Index first = by_reference ? outputs + inputs : outputs, z = by_reference ? outputs + inputs : outputs;
  const Index shared = kTerms * inputs, unknowns = shared + kTerms * trials, rows = trials * width;
  const double scale = 1.0 / (0.5 * static_cast<double>(width));
  Eigen::MatrixXcd K = Eigen::MatrixXcd::Zero(rows, unknowns), Z(rows, z);
  for (Index m = 0; m < trials; ++m) {
    const Eigen::MatrixXcd& X = spectra[static_cast<std::size_t>(m)];
    for (Index i = 0; i < width; ++i) {
      const Index row = m * width + i;
      const double r = static_cast<double>(low + i - line) * scale;
      double power = 1.0;
      for (Index s = 0; s < kTerms; ++s, power *= r) {
        K.block(row, s * inputs, 1, inputs) = power * X.col(low + i).segment(first, inputs).transpose();
        K(row, shared + m * kTerms + s) = power;
      }
      Z.row(row) = X.col(low + i).head(z).transpose();
    }
  }
  LocalFit fit;
  const Vector length = K.colwise().norm().transpose();
  if (!(length.minCoeff() > 0.0) || (length.head(inputs).array() <= kNotExcited * strongest.array()).any()) return fit;
  K = K * length.cwiseInverse().asDiagonal();
  const numeric::ComplexPivotedQr qr(K);
  if (!(qr.min_pivot() > kTold)) return fit;
  const Eigen::MatrixXcd theta = qr.solve(Z);
  const Eigen::MatrixXcd V = Z - K * theta;
  const Eigen::MatrixXcd scaled = length.head(inputs).cwiseInverse().asDiagonal() * theta.topRows(inputs);
  fit.response = scaled.transpose();
  fit.residual = V.transpose() * V.conjugate() / static_cast<double>(rows - unknowns);
  const Eigen::MatrixXcd top = length.head(inputs).cwiseInverse().asDiagonal() * qr.inverse_root().topRows(inputs);
  fit.input_part = top * top.adjoint();
  fit.determined = true;
  return fit;
}

}  // namespace

Result<FrequencyResponseEstimate> local_polynomial_response(std::span<const ExplorationTrial> trials,
                                                            const LocalPolynomialOptions& options) {
  MBK_TRY(check_alike(trials));
  if (!(options.bandwidth_hz > 0.0 && options.max_frequency_hz > 0.0)) {
    return bad_usage("bandwidth and highest frequency must be above 0");
  }
  const ExplorationTrial& first = trials.front();
  const Index inputs = first.input.cols(), outputs = first.output.cols(), both = outputs + inputs;
  const auto count = static_cast<Index>(trials.size());
  const bool by_reference = all_have_reference(trials);
  Index samples = first.samples();
  for (const ExplorationTrial& trial : trials) samples = std::min(samples, trial.samples());
  samples = dsp::fast_length_below(samples);
  const double spacing = 1.0 / (static_cast<double>(samples) * first.sample_time);
  const Index unknowns = kTerms * (inputs + count);
  const Index least = (unknowns + kMinFreedom + count - 1) / count;
  Index width = std::max(static_cast<Index>(std::llround(options.bandwidth_hz / spacing)), least);
  width += 1 - width % 2;
  const Index last = std::min<Index>(
      samples / 2 - 1, static_cast<Index>(std::floor(options.max_frequency_hz / spacing * (1.0 + 1e-12))));
  if (last < 1 + width) {
    return bad_data(fmt::format("{:.3g} s are too short for local polynomials of {} lines up to {:g} Hz",
                                static_cast<double>(samples) * first.sample_time, width, options.max_frequency_hz),
                    "record longer, or use --method welch");
  }
  const Index lines = std::min(samples / 2, last + width);
  std::vector<Eigen::MatrixXcd> spectra;
  for (const ExplorationTrial& trial : trials) spectra.push_back(record_spectra(trial, samples, lines, by_reference));

  const Vector strongest = strongest_lines(spectra, by_reference ? both : outputs, inputs);

  FrequencyResponseEstimate found;
  found.method = FrequencyResponseMethod::local_polynomial;
  found.by_reference = by_reference;
  found.inputs = first.input_labels;
  found.outputs = first.output_labels;
  found.assumes =
      by_reference ? "noise that is unrelated to the reference and equally strong at neighbouring frequencies"
                   : "noise on the output alone, unrelated to the input and equally strong at neighbouring frequencies";
  const auto freedom = static_cast<double>(count * width - unknowns);
  found.averages = freedom;
  std::vector<double> frequencies, coherences;
  Index tried = 0;
  const Index step = std::max<Index>(1, width / 2);
  for (Index line = 1 + width / 2; line <= last; line += step, ++tried) {
    const Index low = std::clamp<Index>(line - width / 2, 1, lines - width);
    const LocalFit fit = local_fit(spectra, strongest, outputs, by_reference, line, low, width);
    if (!fit.determined) continue;
    Eigen::MatrixXcd driving = Eigen::MatrixXcd::Zero(inputs, inputs);  // mean power of X
    for (const Eigen::MatrixXcd& X : spectra) {
      const auto lines_of_X = X.block(by_reference ? both : outputs, low, inputs, width);
      driving += lines_of_X * lines_of_X.adjoint() / static_cast<double>(count * width);
    }
    const double chance = fit.input_part.cwiseProduct(driving).sum().real();
    if (!(chance < kMaxChance)) continue;  // few lines of the window are excited: told by their leakage alone
    Eigen::MatrixXcd G = fit.response, residual = fit.residual, part = fit.input_part;
    if (by_reference) {
      const Eigen::MatrixXcd inverse = numeric::complex_inverse(fit.response.bottomRows(inputs));
      G = fit.response.topRows(outputs) * inverse;
      if (!G.allFinite()) continue;
      Eigen::MatrixXcd T(outputs, both);
      T << Eigen::MatrixXcd::Identity(outputs, outputs), -G;
      residual = T * fit.residual * T.adjoint();
      part = inverse.transpose() * fit.input_part * inverse.conjugate();
    }
    Eigen::MatrixXcd covariance(outputs * inputs, outputs * inputs);
    for (Index j = 0; j < inputs; ++j) {
      for (Index l = 0; l < inputs; ++l) {
        covariance.block(j * outputs, l * outputs, outputs, outputs) = part(j, l) * residual;
      }
    }
    for (Index i = 0; i < outputs; ++i) {
      const double noise = fit.residual(i, i).real();
      const double all = (fit.response.row(i) * driving * fit.response.row(i).adjoint())(0, 0).real();
      const double power = std::max(0.0, all - chance * noise);  // without what noise alone would explain
      coherences.push_back(power / (power + noise));
    }
    frequencies.push_back(static_cast<double>(line) * spacing);
    found.response.push_back(std::move(G));
    found.covariance.push_back(std::move(covariance));
  }
  const auto kept = static_cast<Index>(frequencies.size());
  if (2 * kept < tried || kept == 0) {
    return bad_data("most frequencies are not excited, so the local polynomial method cannot be used",
                    "use --method welch, which suits any perturbation, or record several trials with different phases");
  }
  found.frequency = Eigen::Map<const Vector>(frequencies.data(), kept);
  found.multiple_coherence = Eigen::Map<const Matrix>(coherences.data(), outputs, kept).transpose();
  found.degrees_of_freedom = Vector::Constant(kept, freedom);
  add_intervals(found);
  return found;
}

}  // namespace mbk::explore
