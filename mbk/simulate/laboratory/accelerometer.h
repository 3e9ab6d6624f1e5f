#pragma once

#include <array>
#include <cstdint>

#include "mbk/base/core/axes.h"
#include "mbk/base/core/result.h"
#include "mbk/base/dsp/causal_filter.h"
#include "mbk/simulate/laboratory/noise.h"

namespace mbk::laboratory {

/// An accelerometer on the last link, at the hand (Dyck 2013, §5.1.2). Zero disables a part. The robot moves in a
/// horizontal plane: gravity in a tilted sensor is a bias. For a rotating axis, rad/s².
template <int Axes>
struct AccelerometerOptions {
  double noise = 0.02;                                     ///< white, standard deviation of each axis [m/s²] ≥ 0
  AxisVector<Axes> bias = AxisVector<Axes>::Zero();        ///< b, in the sensor's axes [m/s²]
  AxisVector<Axes> gain_error = AxisVector<Axes>::Zero();  ///< e, 0.01 for 1 %; above −1
  double misalignment = 0.0;  ///< δ: rotation of the sensor from the axes of the link, +: left [rad]
  Hertz bandwidth{0.0};       ///< first-order low-pass, −3 dB; 0 for none
};

/// a_read = H (1 + diag e) turn(−δ) a + b + w[k], in the sensor's axes: low-pass H, then white noise w. With one
/// axis turn(−δ) = cos δ.
template <int Axes>
class Accelerometer {
 public:
  using Options = AccelerometerOptions<Axes>;

  /// @fails  usage: noise is negative; a gain error is not above −1; the bandwidth is not below Nyquist; a number is
  ///         not finite.
  [[nodiscard]] static Result<Accelerometer> create(const Options& options, double sample_time, std::uint64_t seed);

  /// Error of the next reading, a_read − a, in the axes of the link [m/s²].
  AxisVector<Axes> added(const AxisVector<Axes>& acceleration) noexcept;

 private:
  Accelerometer(const Options& options, const dsp::SectionCascade& filter, std::uint64_t seed);

  AxisMatrix<Axes> gain_;
  AxisVector<Axes> bias_;
  std::array<WhiteNoise, Axes> noise_;
  std::array<dsp::CausalFilter, Axes> filters_;
  bool settled_ = false;
};

extern template class Accelerometer<1>;
extern template class Accelerometer<2>;

}  // namespace mbk::laboratory
