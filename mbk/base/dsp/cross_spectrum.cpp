#include "mbk/base/dsp/cross_spectrum.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/FFT>

#include "mbk/base/dsp/spectrum.h"
#include "mbk/base/numeric/dense.h"

namespace mbk::dsp {
namespace {

/// Below this 1 − γ² between two inputs of unit power is rounding.
constexpr double kToldApart = 1e-12;

}  // namespace

Result<CrossSpectra> cross_spectra(const std::vector<Matrix>& pieces, Hertz sample_rate, Index segment) {
  if (!(sample_rate.value > 0.0)) {
    return bad_usage(fmt::format("a sample rate of {:g} Hz is not positive", sample_rate.value));
  }
  if (segment < 8 || segment % 2 != 0) {
    return bad_usage(fmt::format("a segment of {} samples is odd or too short for a spectrum", segment));
  }
  Index longest = 0;
  for (const Matrix& piece : pieces) {
    if (piece.cols() != pieces.front().cols()) return bad_data("pieces of different signals have no common spectrum");
    longest = std::max(longest, piece.rows());
  }
  if (longest < segment) return bad_data(fmt::format("{} samples are too few for a segment of {}", longest, segment));

  const Vector window = hann_window(segment);
  const Index lines = segment / 2 + 1, signals = pieces.front().cols();
  CrossSpectra spectra;
  spectra.frequency =
      Vector::LinSpaced(lines, 0.0, sample_rate.value * static_cast<double>(lines - 1) / static_cast<double>(segment));
  spectra.density.assign(static_cast<std::size_t>(lines), Eigen::MatrixXcd::Zero(signals, signals));
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  Vector tapered(segment);
  Eigen::VectorXcd transform(lines);
  Eigen::MatrixXcd transforms(signals, lines);
  Index overlaps = 0;
  for (const Matrix& piece : pieces) {
    for (Index start = 0; start + segment <= piece.rows(); start += segment / 2, ++spectra.segments) {
      if (start > 0) ++overlaps;
      for (Index k = 0; k < signals; ++k) {
        tapered = piece.col(k).segment(start, segment);
        tapered = (tapered.array() - tapered.mean()) * window.array();
        fft.fwd(transform, tapered);
        transforms.row(k) = transform.head(lines).transpose();
      }
      for (Index line = 0; line < lines; ++line) {
        spectra.density[static_cast<std::size_t>(line)] += transforms.col(line) * transforms.col(line).adjoint();
      }
    }
  }
  const double scale = 1.0 / (sample_rate.value * window.squaredNorm() * static_cast<double>(spectra.segments));
  for (Index line = 0; line < lines; ++line) {
    spectra.density[static_cast<std::size_t>(line)] *= line == 0 || line == lines - 1 ? scale : 2.0 * scale;
  }
  const auto count = static_cast<double>(spectra.segments);
  spectra.independent_segments = count / (1.0 + 2.0 / 36.0 * static_cast<double>(overlaps) / count);
  return spectra;
}

Matrix multiple_coherence(const CrossSpectra& spectra, Index inputs) {
  const auto lines = static_cast<Index>(spectra.density.size());
  const Index outputs = lines > 0 ? spectra.density.front().rows() - inputs : 0;
  Matrix coherence(lines, outputs);
  for (Index line = 0; line < lines; ++line) {
    Eigen::MatrixXcd S = spectra.density[static_cast<std::size_t>(line)];
    const Vector size = S.diagonal().real().cwiseSqrt();
    if (!(size.minCoeff() > 0.0)) {
      coherence.row(line).setConstant(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    S = size.cwiseInverse().asDiagonal() * S * size.cwiseInverse().asDiagonal();  // of signals of unit power
    const numeric::HermitianPivotedCholesky Sxx(S.topLeftCorner(inputs, inputs));
    const bool apart = Sxx.pivots().minCoeff() > kToldApart;
    for (Index j = 0; j < outputs; ++j) {
      const Eigen::VectorXcd Sxy = S.col(inputs + j).head(inputs);
      coherence(line, j) =
          apart ? std::clamp(Sxy.dot(Sxx.solve(Sxy)).real(), 0.0, 1.0) : std::numeric_limits<double>::quiet_NaN();
    }
  }
  return coherence;
}

double significant_coherence(double independent_segments, Index inputs) {
  const double n = independent_segments;
  if (!(n > static_cast<double>(inputs))) return 1.0;
  constexpr double kChance = 0.05;
  const auto exceeded = [&](double c) {
    double sum = 0.0, binomial = 1.0;  // C(n − 1, k)
    for (Index k = 0; k < inputs; ++k) {
      const auto power = static_cast<double>(k);
      sum += binomial * std::pow(c, power) * std::pow(1.0 - c, n - 1.0 - power);
      binomial *= (n - 1.0 - power) / (power + 1.0);
    }
    return sum;
  };
  double low = 0.0, high = 1.0;
  while (high - low > 1e-12) {
    const double middle = 0.5 * (low + high);
    (exceeded(middle) > kChance ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace mbk::dsp
