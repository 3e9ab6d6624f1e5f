#include "mbk/dsp/cross_spectrum.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "mbk/dsp/spectrum.h"

namespace mbk::dsp {

Result<CrossSpectra> cross_spectra(const std::vector<Matrix>& pieces, Hertz sample_rate, Hertz resolution) {
  if (!(sample_rate.value > 0.0 && resolution.value > 0.0)) {
    return bad_usage(fmt::format("sample rate {:g} Hz and resolution {:g} Hz must be positive", sample_rate.value,
                                 resolution.value));
  }
  if (pieces.empty()) return bad_data("there is no signal for a spectrum");
  Index shortest = std::numeric_limits<Index>::max();
  for (const Matrix& piece : pieces) {
    if (piece.cols() != pieces.front().cols()) return bad_data("pieces of different signals have no common spectrum");
    shortest = std::min(shortest, piece.rows());
  }
  if (shortest < 8) return bad_data(fmt::format("{} samples are too few for a spectrum", shortest));

  const Index length = segment_length(sample_rate, resolution, shortest);
  const Vector window = hann_window(length);
  const Index lines = length / 2 + 1, signals = pieces.front().cols();
  CrossSpectra spectra;
  spectra.frequency =
      Vector::LinSpaced(lines, 0.0, sample_rate.value * static_cast<double>(lines - 1) / static_cast<double>(length));
  spectra.density.assign(static_cast<std::size_t>(lines), Eigen::MatrixXcd::Zero(signals, signals));
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  Vector tapered(length);
  Eigen::VectorXcd transform(lines);
  Eigen::MatrixXcd transforms(signals, lines);
  for (const Matrix& piece : pieces) {
    for (Index start = 0; start + length <= piece.rows(); start += length / 2, ++spectra.segments) {
      for (Index k = 0; k < signals; ++k) {
        tapered = piece.col(k).segment(start, length);
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
  spectra.independent_segments = count / (1.0 + 2.0 / 36.0 * (1.0 - 1.0 / count));
  return spectra;
}

Matrix multiple_coherence(const CrossSpectra& spectra, Index inputs) {
  const auto lines = static_cast<Index>(spectra.density.size());
  const Index outputs = lines > 0 ? spectra.density.front().rows() - inputs : 0;
  Matrix coherence(lines, outputs);
  for (Index line = 0; line < lines; ++line) {
    const Eigen::MatrixXcd& S = spectra.density[static_cast<std::size_t>(line)];
    const Eigen::LDLT<Eigen::MatrixXcd> Sxx(S.topLeftCorner(inputs, inputs));
    const Eigen::VectorXd pivots = Sxx.vectorD().real();
    const bool apart = pivots.minCoeff() > 1e-12 * pivots.maxCoeff();
    for (Index j = 0; j < outputs; ++j) {
      const Eigen::VectorXcd Sxy = S.col(inputs + j).head(inputs);
      const double power = S(inputs + j, inputs + j).real();
      coherence(line, j) = apart && power > 0.0 ? std::clamp(Sxy.dot(Sxx.solve(Sxy)).real() / power, 0.0, 1.0)
                                                : std::numeric_limits<double>::quiet_NaN();
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

Vector autocorrelation(const std::vector<Vector>& pieces, const std::vector<Index>& lags) {
  double power = 0.0;
  for (const Vector& piece : pieces) power += piece.squaredNorm();
  Vector correlation(static_cast<Index>(lags.size()));
  for (Index k = 0; k < correlation.size(); ++k) {
    const Index lag = lags[static_cast<std::size_t>(k)];
    double sum = 0.0;
    for (const Vector& piece : pieces) {
      const Index pairs = piece.size() - lag;
      if (pairs > 0) sum += piece.head(pairs).dot(piece.tail(pairs));
    }
    correlation[k] = power > 0.0 ? sum / power : std::numeric_limits<double>::quiet_NaN();
  }
  return correlation;
}

}  // namespace mbk::dsp
