#pragma once

#include <array>
#include <cstdint>

#include "mbk/base/core/axes.h"
#include "mbk/base/core/result.h"
#include "mbk/simulate/laboratory/noise.h"

namespace mbk::laboratory {

/// A load cell on the last link (Dyck 2013, §3.4.1). Zero switches a part off. With one axis that turns, N·m.
template <int Axes>
struct LoadCellOptions {
  double white_noise = 0.02;                               ///< standard deviation of each axis [N] ≥ 0
  double coloured_noise = 0.0;                             ///< standard deviation of each axis [N] ≥ 0
  Hertz coloured_bandwidth{1.5};                           ///< of the coloured noise, −3 dB, first order > 0
  AxisMatrix<Axes> gain = AxisMatrix<Axes>::Identity();    ///< G: gain errors and, off its diagonal, crosstalk
  AxisVector<Axes> offset = AxisVector<Axes>::Zero();      ///< o [N]
  double drift_walk = 0.0;                                 ///< random walk of the offset [N/√s] ≥ 0
  AxisVector<Axes> drift_rate = AxisVector<Axes>::Zero();  ///< steady drift of the offset [N/s]
};

/// f_read = G f + o + d[k] + w[k] + c[k], in the sensor's axes: drift d, white noise w and coloured noise c.
template <int Axes>
class LoadCell {
 public:
  using Options = LoadCellOptions<Axes>;

  /// @fails  usage: a deviation or the walk is negative; the bandwidth is not above zero; a number is not finite.
  [[nodiscard]] static Result<LoadCell> create(const Options& options, double sample_time, std::uint64_t seed);

  /// What the next reading adds to the true force, (G − 1) f + o + d + w + c [N].
  AxisVector<Axes> added(const AxisVector<Axes>& force) noexcept;

 private:
  LoadCell(const Options& options, double sample_time, std::uint64_t seed);

  struct AxisNoise {
    WhiteNoise white;
    ColouredNoise coloured;
    Drift drift;
  };

  AxisMatrix<Axes> gain_error_;
  AxisVector<Axes> offset_;
  std::array<AxisNoise, Axes> noise_;
};

extern template class LoadCell<1>;
extern template class LoadCell<2>;

}  // namespace mbk::laboratory
