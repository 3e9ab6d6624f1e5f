#include "mbk/base/dsp/autocorrelation.h"

#include <algorithm>
#include <limits>
#include <unsupported/Eigen/FFT>

#include "mbk/base/dsp/spectrum.h"

namespace mbk::dsp {

Vector autocorrelation(const std::vector<Vector>& pieces, Index last) {
  Index longest = 0;
  for (const Vector& piece : pieces) longest = std::max(longest, piece.size());
  const Index length = fast_length_above(longest + last), lines = length / 2 + 1;
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  Vector padded(length);
  Eigen::VectorXcd transform(lines), power = Eigen::VectorXcd::Zero(lines);
  for (const Vector& piece : pieces) {
    padded.setZero();
    padded.head(piece.size()) = piece;
    fft.fwd(transform, padded);
    power += transform.cwiseAbs2();
  }
  Vector sums(length);
  fft.inv(sums, power, length);
  if (!(sums[0] > 0.0)) return Vector::Constant(last + 1, std::numeric_limits<double>::quiet_NaN());
  return sums.head(last + 1) / sums[0];
}

}  // namespace mbk::dsp
