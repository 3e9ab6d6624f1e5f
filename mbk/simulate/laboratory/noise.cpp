#include "mbk/simulate/laboratory/noise.h"

#include <cmath>

namespace mbk::laboratory {

ColouredNoise::ColouredNoise(double deviation, Hertz bandwidth, double sample_time, numeric::Random random)
    : deviation_(deviation),
      memory_(std::exp(-RadPerSec(bandwidth).value * sample_time)),
      fresh_(deviation * std::sqrt(1.0 - memory_ * memory_)),
      random_(random) {
  if (deviation_ != 0.0) value_ = deviation_ * random_.normal();
}

double ColouredNoise::next() noexcept {
  if (deviation_ == 0.0) return 0.0;
  const double now = value_;
  value_ = memory_ * value_ + fresh_ * random_.normal();
  return now;
}

Drift::Drift(double walk, double rate, double sample_time, numeric::Random random)
    : step_(walk * std::sqrt(sample_time)), slope_(rate * sample_time), random_(random) {}

double Drift::next() noexcept {
  const double now = slope_ * samples_ + walked_;
  samples_ += 1.0;
  if (step_ != 0.0) walked_ += step_ * random_.normal();
  return now;
}

double quantised(double value, double quantum) noexcept {
  return quantum == 0.0 ? value : quantum * std::round(value / quantum);
}

}  // namespace mbk::laboratory
