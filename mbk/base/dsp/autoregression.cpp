#include "mbk/base/dsp/autoregression.h"

#include <algorithm>
#include <cmath>

namespace mbk::dsp {

Vector autoregression(const std::vector<Vector>& pieces, Index most) {
  Vector r = Vector::Zero(most + 1);
  Index samples = 0;
  for (const Vector& e : pieces) {
    samples += e.size();
    for (Index lag = 0; lag <= std::min(most, e.size() - 1); ++lag) {
      r[lag] += e.head(e.size() - lag).dot(e.tail(e.size() - lag));
    }
  }
  Vector c = Vector::Ones(1), best = c;
  if (!(r[0] > 0.0)) return best;
  const auto count = static_cast<double>(samples);
  double variance = r[0], least = count * std::log(variance);
  for (Index p = 1; p <= most; ++p) {
    const double reflection = -c.dot(r.segment(1, p).reverse()) / variance;
    Vector longer(p + 1);
    longer << c, 0.0;
    longer += reflection * longer.reverse().eval();
    c = longer;
    variance *= 1.0 - reflection * reflection;
    if (!(variance > 0.0)) break;
    const double bic = count * std::log(variance) + static_cast<double>(p) * std::log(count);
    if (bic < least) {
      least = bic;
      best = c;
    }
  }
  return best;
}

}  // namespace mbk::dsp
