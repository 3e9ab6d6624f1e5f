#include "mbk/base/dsp/autocorrelation.h"

#include <algorithm>
#include <limits>

#include "mbk/base/dsp/complex_transform.h"
#include "mbk/base/dsp/spectrum.h"

namespace mbk::dsp {

Vector autocorrelation(const std::vector<Vector>& pieces, Index last) {
  Index longest = 0;
  for (const Vector& piece : pieces) longest = std::max(longest, piece.size());
  const Index length = fast_length_above(longest + last);
  ComplexTransform transform(length);
  Vector &real = transform.real(), &imaginary = transform.imaginary();
  Vector power = Vector::Zero(length);
  const auto place = [length](const Vector& piece, Vector& to) {
    to.head(piece.size()) = piece;
    to.tail(length - piece.size()).setZero();
  };
  for (std::size_t k = 0; k < pieces.size(); k += 2) {  // two at a time: of their sum only |A|² + |B|² is needed
    place(pieces[k], real);
    place(k + 1 < pieces.size() ? pieces[k + 1] : Vector(), imaginary);
    transform.run();
    power += real.cwiseAbs2() + imaginary.cwiseAbs2();
  }
  // |Z_k|² and |Z_{n−k}|² of a pair differ, but only their mean matters, and an even sum uses the mean.
  real = power;
  imaginary.setZero();
  transform.run();
  const Vector& sums = real;
  if (!(sums[0] > 0.0)) return Vector::Constant(last + 1, std::numeric_limits<double>::quiet_NaN());
  return sums.head(last + 1) / sums[0];
}

}  // namespace mbk::dsp
