#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "mbk/base/core/result.h"
#include "mbk/simulate/laboratory/noise.h"

namespace mbk::laboratory {

/// A load cell on the last link (Dyck 2013, §3.4.1). Zero switches a part off.
struct LoadCellOptions {
  double white_noise = 0.02;                           ///< standard deviation of each axis [N] ≥ 0
  double coloured_noise = 0.0;                         ///< standard deviation of each axis [N] ≥ 0
  Hertz coloured_bandwidth{1.5};                       ///< of the coloured noise, −3 dB, first order > 0
  Eigen::Matrix2d gain = Eigen::Matrix2d::Identity();  ///< G: gain errors and, off its diagonal, crosstalk
  Eigen::Vector2d offset = {0.0, 0.0};                 ///< o [N]
  double drift_walk = 0.0;                             ///< random walk of the offset [N/√s] ≥ 0
  Eigen::Vector2d drift_rate = {0.0, 0.0};             ///< steady drift of the offset [N/s]
};

/// f_read = G f + o + d[k] + w[k] + c[k], in the sensor's axes: drift d, white noise w and coloured noise c.
class LoadCell {
 public:
  /// @fails  usage: a deviation or the walk is negative; the bandwidth is not above zero; a number is not finite.
  [[nodiscard]] static Result<LoadCell> create(const LoadCellOptions& options, double sample_time, std::uint64_t seed);

  /// What the next reading adds to the true force, (G − 1) f + o + d + w + c [N].
  Eigen::Vector2d added(const Eigen::Vector2d& force) noexcept;

 private:
  LoadCell(const LoadCellOptions& options, double sample_time, std::uint64_t seed);

  struct Axis {
    WhiteNoise white;
    ColouredNoise coloured;
    Drift drift;
  };
  static Axis axis(const LoadCellOptions& options, double sample_time, std::uint64_t seed, std::uint32_t number);

  Eigen::Matrix2d gain_error_;
  Eigen::Vector2d offset_;
  std::array<Axis, 2> axes_;
};

}  // namespace mbk::laboratory
