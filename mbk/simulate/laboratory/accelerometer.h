#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "mbk/base/core/result.h"
#include "mbk/base/dsp/causal_filter.h"
#include "mbk/simulate/laboratory/noise.h"

namespace mbk::laboratory {

/// A two-axis accelerometer on the last link, at the hand (Dyck 2013, §5.1.2). Zero switches a part off. The robot
/// moves in a horizontal plane: what gravity adds to a tilted sensor is a bias.
struct AccelerometerOptions {
  double noise = 0.02;                      ///< white, standard deviation of each axis [m/s²] ≥ 0
  Eigen::Vector2d bias = {0.0, 0.0};        ///< b, in the sensor's axes [m/s²]
  Eigen::Vector2d gain_error = {0.0, 0.0};  ///< e, 0.01 for 1 %; above −1
  double misalignment = 0.0;                ///< δ: the sensor is turned by it from the link's axes, +: left [rad]
  Hertz bandwidth{0.0};                     ///< first-order low-pass, −3 dB; 0 for none
};

/// a_read = H (1 + diag e) turn(−δ) a + b + w[k], in the sensor's axes: low-pass H, white noise w behind it.
class Accelerometer {
 public:
  /// @fails  usage: noise is negative; a gain error is not above −1; the bandwidth is not below Nyquist; a number is
  /// not
  ///         finite.
  [[nodiscard]] static Result<Accelerometer> create(const AccelerometerOptions& options, double sample_time,
                                                    std::uint64_t seed);

  /// What the next reading adds to the true acceleration, a_read − a, in the axes of the link [m/s²].
  Eigen::Vector2d added(const Eigen::Vector2d& acceleration) noexcept;

 private:
  Accelerometer(const AccelerometerOptions& options, const dsp::SectionCascade& filter, std::uint64_t seed);

  Eigen::Matrix2d gain_;
  Eigen::Vector2d bias_;
  std::array<WhiteNoise, 2> noise_;
  std::array<dsp::CausalFilter, 2> filters_;
  bool settled_ = false;
};

}  // namespace mbk::laboratory
