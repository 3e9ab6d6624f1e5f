#include "mbk/measure/preprocess/trial_clock.h"

namespace mbk::preprocess {

Index Clock::sample(double seconds) const {
  const double earliest = seconds - 0.5 / rate_.value;
  Index i = 0;  // a search by halves would want a time that only rises
  while (this->seconds(i) < earliest) ++i;
  return i;
}

}  // namespace mbk::preprocess
