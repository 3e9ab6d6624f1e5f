#include "mbk/base/dsp/cross_spectrum.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <span>

#include "mbk/base/dsp/complex_transform.h"
#include "mbk/base/dsp/spectrum.h"
#include "mbk/base/numeric/dense.h"

namespace mbk::dsp {
namespace {

/// Below this 1 − γ² between two inputs of unit power is rounding.
constexpr double kToldApart = 1e-12;

/// Σ A_j A_k* over segments, line by line. They are transformed in pairs, the one as real part, the other as imaginary
/// part; with Z = A + j B the lines of both follow from Z_k and Z_{n−k}.
class SumsOverSegments {
 public:
  SumsOverSegments(Index signals, Index segment, Index lines)
      : signals_(signals),
        lines_(lines),
        window_(hann_window(segment)),
        transform_(segment),
        real_{Matrix(lines_, signals), Matrix(lines_, signals)},
        imaginary_{Matrix(lines_, signals), Matrix(lines_, signals)},
        sums_(static_cast<std::size_t>(signals * signals), Eigen::VectorXcd::Zero(lines_)) {}

  /// @param starts where one or two segments of `piece` begin
  void add(const Matrix& piece, std::span<const Index> starts) {
    for (Index j = 0; j < signals_; ++j) {
      taper(piece, j, starts.front(), transform_.real());
      if (starts.size() > 1) {
        taper(piece, j, starts.back(), transform_.imaginary());
      } else {
        transform_.imaginary().setZero();
      }
      transform_.run();
      take_apart(j);
    }
    for (std::size_t which = 0; which < starts.size(); ++which) {
      for (Index k = 0; k < signals_; ++k) {
        for (Index j = 0; j <= k; ++j) {
          const auto a = real_[which].col(j).array(), b = imaginary_[which].col(j).array(),
                     c = real_[which].col(k).array(), d = imaginary_[which].col(k).array();
          Eigen::VectorXcd& sum = sums_[static_cast<std::size_t>(j + signals_ * k)];
          sum.real().array() += a * c + b * d;
          sum.imag().array() += b * c - a * d;
        }
      }
    }
  }

  [[nodiscard]] std::vector<Eigen::MatrixXcd> of_lines() const {
    std::vector<Eigen::MatrixXcd> matrices(static_cast<std::size_t>(lines_), Eigen::MatrixXcd(signals_, signals_));
    for (Index k = 0; k < signals_; ++k) {
      for (Index j = 0; j <= k; ++j) {
        const Eigen::VectorXcd& sum = sums_[static_cast<std::size_t>(j + signals_ * k)];
        for (Index line = 0; line < lines_; ++line) {
          matrices[static_cast<std::size_t>(line)](j, k) = sum[line];
          matrices[static_cast<std::size_t>(line)](k, j) = std::conj(sum[line]);
        }
      }
    }
    return matrices;
  }

 private:
  void taper(const Matrix& piece, Index j, Index start, Vector& to) const {
    const auto part = piece.col(j).segment(start, transform_.length());
    to = (part.array() - part.mean()) * window_.array();
  }

  void take_apart(Index j) {
    const Vector &re = transform_.real(), &im = transform_.imaginary();
    const Index n = transform_.length();
    for (Index k = 0; k < lines_; ++k) {
      const Index mirror = k == 0 ? 0 : n - k;
      real_[0](k, j) = 0.5 * (re[k] + re[mirror]);
      imaginary_[0](k, j) = 0.5 * (im[k] - im[mirror]);
      real_[1](k, j) = 0.5 * (im[k] + im[mirror]);
      imaginary_[1](k, j) = 0.5 * (re[mirror] - re[k]);
    }
  }

  Index signals_, lines_;
  Vector window_;
  ComplexTransform transform_;
  std::array<Matrix, 2> real_, imaginary_;  // lines×signals, of the one segment and of the other
  std::vector<Eigen::VectorXcd> sums_;      // of signals j ≤ k at j + signals·k
};

}  // namespace

Result<CrossSpectra> cross_spectra(const std::vector<Matrix>& pieces, Hertz sample_rate, Index segment, Hertz highest) {
  if (!(sample_rate.value > 0.0)) {
    return bad_usage(fmt::format("a sample rate of {:g} Hz is not positive", sample_rate.value));
  }
  if (segment < 8 || segment % 2 != 0) {
    return bad_usage(fmt::format("a segment of {} samples is odd or too short for a spectrum", segment));
  }
  Index longest = 0;
  for (const Matrix& piece : pieces) {
    if (piece.cols() != pieces.front().cols()) return bad_data("the segments have different numbers of signals");
    longest = std::max(longest, piece.rows());
  }
  if (longest < segment) {
    const double of_segment = static_cast<double>(segment) / sample_rate.value,
                 of_data = static_cast<double>(longest) / sample_rate.value;
    return bad_data(fmt::format("a segment of {:g} s is longer than the data, {:g} s", of_segment, of_data),
                    "choose a shorter segment");
  }

  const double spacing = sample_rate.value / static_cast<double>(segment);
  const Index nyquist = segment / 2, signals = pieces.front().cols();
  const Index lines = 1 + (highest.value < spacing * static_cast<double>(nyquist)
                               ? std::max<Index>(1, static_cast<Index>(highest.value / spacing))
                               : nyquist);
  CrossSpectra spectra;
  spectra.frequency =
      Vector::LinSpaced(lines, 0.0, sample_rate.value * static_cast<double>(lines - 1) / static_cast<double>(segment));
  SumsOverSegments sums(signals, segment, lines);
  Index overlaps = 0;
  for (const Matrix& piece : pieces) {
    std::vector<Index> starts;
    for (Index start = 0; start + segment <= piece.rows(); start += segment / 2) starts.push_back(start);
    for (std::size_t k = 0; k < starts.size(); k += 2) {
      sums.add(piece, std::span(starts).subspan(k, std::min<std::size_t>(2, starts.size() - k)));
    }
    const auto count = static_cast<Index>(starts.size());
    spectra.segments += count;
    overlaps += std::max<Index>(count - 1, 0);
  }
  spectra.density = sums.of_lines();
  const double scale =
      1.0 / (sample_rate.value * hann_window(segment).squaredNorm() * static_cast<double>(spectra.segments));
  for (Index line = 0; line < lines; ++line) {
    spectra.density[static_cast<std::size_t>(line)] *= line == 0 || line == nyquist ? scale : 2.0 * scale;
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
