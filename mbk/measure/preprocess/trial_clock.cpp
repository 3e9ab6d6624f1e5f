#include "mbk/measure/preprocess/trial_clock.h"

namespace mbk::preprocess {

double Clock::seconds(Index sample) const {
  if (sample < samples()) return time_[sample] - time_[0];
  return time_[samples() - 1] - time_[0] + static_cast<double>(sample - samples() + 1) / rate_.value;
}

Index Clock::sample(double seconds) const {
  const double earliest = seconds - 0.5 / rate_.value;
  Index i = 0;  // a search by halves would want a time that only rises
  while (this->seconds(i) < earliest) ++i;
  return i;
}

}  // namespace mbk::preprocess
