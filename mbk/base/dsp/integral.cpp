#include "mbk/base/dsp/integral.h"

namespace mbk::dsp {

Vector cumulative_integral(const Vector& values, double sample_time) {
  const Index samples = values.size();
  Vector integral = Vector::Zero(samples);
  for (Index i = 1; i < samples; ++i) {
    const double here = values[i - 1] + values[i];
    double over = here / 2.0;
    if (i >= 2 && i + 1 < samples) {
      over = (13.0 * here - values[i - 2] - values[i + 1]) / 24.0;
    } else if (samples > 2) {
      const bool first = i == 1;
      over = first ? (5.0 * values[0] + 8.0 * values[1] - values[2]) / 12.0
                   : (5.0 * values[i] + 8.0 * values[i - 1] - values[i - 2]) / 12.0;
    }
    integral[i] = integral[i - 1] + sample_time * over;
  }
  return integral;
}

}  // namespace mbk::dsp
