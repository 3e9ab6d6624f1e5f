#include "mbk/measure/explore/welch_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "mbk/base/dsp/cross_spectrum.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/measure/explore/alike.h"
#include "mbk/measure/explore/response_intervals.h"

namespace mbk::explore {
namespace {

using Complex = Eigen::MatrixXcd;

/// Inputs and outputs side by side, and the reference behind them.
Matrix side_by_side(const ExplorationTrial& trial, bool with_reference) {
  Matrix signals(trial.samples(), trial.input.cols() + trial.output.cols() + (with_reference ? trial.input.cols() : 0));
  signals.leftCols(trial.input.cols()) = trial.input;
  signals.middleCols(trial.input.cols(), trial.output.cols()) = trial.output;
  if (with_reference) signals.rightCols(trial.input.cols()) = trial.reference;
  return signals;
}

/// γ² of output i and input j without what the other inputs explain of both, from S of [u, y].
double partial_coherence(const Complex& S, Index inputs, Index i, Index j) {
  Complex rest(2, 2), cross(inputs - 1, 2), others(inputs - 1, inputs - 1);
  const Index of[] = {j, inputs + i};
  std::vector<Index> beside;
  for (Index k = 0; k < inputs; ++k) {
    if (k != j) beside.push_back(k);
  }
  for (Index a = 0; a < 2; ++a) {
    for (Index b = 0; b < 2; ++b) rest(a, b) = S(of[a], of[b]);
    for (std::size_t k = 0; k < beside.size(); ++k) cross(static_cast<Index>(k), a) = S(beside[k], of[a]);
  }
  for (std::size_t a = 0; a < beside.size(); ++a) {
    for (std::size_t b = 0; b < beside.size(); ++b) {
      others(static_cast<Index>(a), static_cast<Index>(b)) = S(beside[a], beside[b]);
    }
  }
  if (inputs > 1) {
    const numeric::HermitianPivotedCholesky known(others);
    for (Index b = 0; b < 2; ++b) rest.col(b) -= cross.adjoint() * known.solve(cross.col(b));
  }
  const double power = rest(0, 0).real() * rest(1, 1).real();
  return power > 0.0 ? std::min(1.0, std::norm(rest(0, 1)) / power) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

Result<FrequencyResponseEstimate> welch_response(std::span<const ExplorationTrial> trials,
                                                 const WelchOptions& options) {
  MBK_TRY(check_alike(trials));
  const ExplorationTrial& first = trials.front();
  const Index inputs = first.input.cols(), outputs = first.output.cols();
  const bool by_reference = all_have_reference(trials);
  std::vector<Matrix> pieces;
  for (const ExplorationTrial& trial : trials) pieces.push_back(side_by_side(trial, by_reference));
  const auto requested = static_cast<Index>(std::llround(options.segment_s / first.sample_time));
  const Index segment = requested - requested % 2;
  const auto spectra = MBK_TRY(dsp::cross_spectra(pieces, Hertz(1.0 / first.sample_time), segment));
  const double n = spectra.independent_segments, dof = n - static_cast<double>(inputs);
  if (!(dof >= 1.0)) {
    return bad_data(fmt::format("{} segment{} of {:g} s are too few for the uncertainty of a response to {} input{}",
                                spectra.segments, spectra.segments == 1 ? "" : "s", options.segment_s, inputs,
                                inputs == 1 ? "" : "s"),
                    "record longer, or average shorter segments with --segment");
  }

  FrequencyResponseEstimate found;
  found.method = FrequencyResponseMethod::welch;
  found.by_reference = by_reference;
  found.inputs = first.input_labels;
  found.outputs = first.output_labels;
  found.averages = n;
  found.assumes = by_reference ? "noise that is unrelated to the reference and no leakage between lines"
                               : "noise on the output alone, unrelated to the input, and no leakage between lines";
  const Index last =
      std::min<Index>(static_cast<Index>(spectra.density.size()) - 2,
                      static_cast<Index>(std::floor(options.max_frequency_hz / spectra.frequency[1] * (1.0 + 1e-12))));
  if (last < 1) {
    return bad_usage(
        fmt::format("no line of {:g} s segments lies below {:g} Hz", options.segment_s, options.max_frequency_hz),
        "choose a longer --segment or a higher --max-frequency");
  }
  found.frequency = spectra.frequency.segment(1, last);
  found.degrees_of_freedom = Vector::Constant(last, dof);
  found.multiple_coherence.resize(last, outputs);
  found.partial_coherence.resize(last, outputs * inputs);
  const Matrix multiple = [&] {
    dsp::CrossSpectra without = spectra;
    for (Complex& S : without.density) S = Complex(S.topLeftCorner(inputs + outputs, inputs + outputs));
    return dsp::multiple_coherence(without, inputs);
  }();
  found.multiple_coherence = multiple.middleRows(1, last);
  for (Index line = 1; line <= last; ++line) {
    const Complex& S = spectra.density[static_cast<std::size_t>(line)];
    const Index r = by_reference ? inputs + outputs : 0;
    const Complex Sur = S.block(0, r, inputs, inputs), Syr = S.block(inputs, r, outputs, inputs);
    const Complex Srr = S.block(r, r, inputs, inputs), Suu = S.topLeftCorner(inputs, inputs);
    const Complex Syu = S.block(inputs, 0, outputs, inputs), Syy = S.block(inputs, inputs, outputs, outputs);
    const Complex A = numeric::complex_inverse(Sur);
    const Complex G = Syr * A;
    const Complex Svv = (Syy - G * Syu.adjoint() - Syu * G.adjoint() + G * Suu * G.adjoint()) * (n / dof);
    const Complex W = A.transpose() * Srr.transpose() * A.conjugate() / n;
    Complex covariance(outputs * inputs, outputs * inputs);
    for (Index j = 0; j < inputs; ++j) {
      for (Index l = 0; l < inputs; ++l) covariance.block(j * outputs, l * outputs, outputs, outputs) = W(j, l) * Svv;
      for (Index i = 0; i < outputs; ++i) {
        found.partial_coherence(line - 1, j * outputs + i) = partial_coherence(S, inputs, i, j);
      }
    }
    found.response.push_back(G);
    found.covariance.push_back(std::move(covariance));
  }
  add_intervals(found);
  return found;
}

}  // namespace mbk::explore
