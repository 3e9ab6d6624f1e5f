#pragma once

#include <cstdint>

#include "mbk/base/core/units.h"
#include "mbk/base/numeric/random.h"

namespace mbk::laboratory {

/// w[k] = σ n[k], n independent and standard normal.
class WhiteNoise {
 public:
  /// @param deviation  σ ≥ 0, in the unit of the signal; 0 switches it off
  WhiteNoise(double deviation, numeric::Random random) : deviation_(deviation), random_(random) {}

  double next() noexcept { return deviation_ == 0.0 ? 0.0 : deviation_ * random_.normal(); }

 private:
  double deviation_;
  numeric::Random random_;
};

/// White noise through a first-order low-pass, stationary from the first value (exact at the samples):
///   c[k+1] = a c[k] + √(1 − a²) σ n[k],  a = e^{−2π f_c T}
/// Its correlation over m samples is a^m.
class ColouredNoise {
 public:
  /// @param deviation  σ ≥ 0; 0 switches it off    @param bandwidth  f_c > 0, −3 dB    @param sample_time  T > 0 [s]
  ColouredNoise(double deviation, Hertz bandwidth, double sample_time, numeric::Random random);

  double next() noexcept;

 private:
  double deviation_, memory_, fresh_, value_ = 0.0;
  numeric::Random random_;
};

/// Drift from zero: a random walk and a line, d[k] = r k T + q √T Σ_{i<k} n[i]. Its mean is r t, its variance q² t.
class Drift {
 public:
  /// @param walk  q ≥ 0 [unit/√s]    @param rate  r [unit/s]    @param sample_time  T > 0 [s]
  Drift(double walk, double rate, double sample_time, numeric::Random random);

  double next() noexcept;

 private:
  double step_, slope_, walked_ = 0.0, samples_ = 0.0;
  numeric::Random random_;
};

/// The multiple of q nearest to a value; the value itself for q = 0. The error is at most q/2, over many steps q/√12
/// rms.
[[nodiscard]] double quantised(double value, double quantum) noexcept;

/// The streams of a seed from which the simulated sensors draw: one per noise source and axis, so that enabling one
/// does not change the others.
enum class NoiseSource : std::uint32_t {
  white_force = 100,
  coloured_force = 110,
  force_drift = 120,
  strain_gauge = 130,
  acceleration = 140,
  motor_current = 150,
  clock = 160,
  emg = 170,
  emg_electrodes = 180,
};

/// @param axis  0 … 9
[[nodiscard]] inline numeric::Random noise_stream(std::uint64_t seed, NoiseSource source, std::uint32_t axis = 0) {
  return numeric::Random(seed, static_cast<std::uint32_t>(source) + axis);
}

}  // namespace mbk::laboratory
