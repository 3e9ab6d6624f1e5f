#include "mbk/base/dsp/difference_equation.h"

#include <algorithm>

namespace mbk::dsp {

Vector difference_equation(const Vector& b, const Vector& a, const Vector& u) {
  const Index n = a.size() - 1, m = b.size() - 1, total = u.size();
  Vector y = Vector::Zero(total);
  for (Index j = 0; j <= std::min(m, total - 1); ++j) y.tail(total - j) += b[j] * u.head(total - j);
  for (Index k = 0; k < total; ++k) {
    double sum = y[k];
    for (Index j = 1; j <= std::min(n, k); ++j) sum -= a[j] * y[k - j];
    y[k] = sum;
  }
  return y;
}

}  // namespace mbk::dsp
