#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mbk/base/core/axes.h"
#include "mbk/base/core/result.h"
#include "mbk/simulate/laboratory/noise.h"

namespace mbk::laboratory {

/// A load cell on the last link (Dyck 2013, §3.4.1). Zero disables a part. For a rotating axis, N·m.
template <int Axes>
struct LoadCellOptions {
  double white_noise = 0.02;                               ///< standard deviation of each axis [N] ≥ 0
  double coloured_noise = 0.0;                             ///< standard deviation of each axis [N] ≥ 0
  Hertz coloured_bandwidth{1.5};                           ///< of the coloured noise, −3 dB, first order > 0
  AxisMatrix<Axes> gain = AxisMatrix<Axes>::Identity();    ///< G: gain errors and, off its diagonal, crosstalk
  AxisVector<Axes> offset = AxisVector<Axes>::Zero();      ///< o [N]
  double drift_walk = 0.0;                                 ///< random walk of the offset [N/√s] ≥ 0
  AxisVector<Axes> drift_rate = AxisVector<Axes>::Zero();  ///< steady drift of the offset [N/s]
  double delay = 0.0;                                      ///< τ, delay of the amplifier [s] ≥ 0
  double resolution = 0.0;                                 ///< step of the converter [N] ≥ 0; 0 for none
};

/// f_read = G f(t − τ) + o + d[k] + w[k] + c[k], in the sensor's axes and in whole steps: drift d, white noise w and
/// coloured noise c. The force is interpolated linearly between samples.
template <int Axes>
class LoadCell {
 public:
  using Options = LoadCellOptions<Axes>;

  /// @fails  usage: a deviation or the walk is negative; the bandwidth is not above zero; a number is not finite.
  [[nodiscard]] static Result<LoadCell> create(const Options& options, double sample_time, std::uint64_t seed);

  /// Error of the next reading relative to the true force f [N].
  AxisVector<Axes> added(const AxisVector<Axes>& force) noexcept;

  [[nodiscard]] double delay() const { return delay_; }  ///< τ [s]

 private:
  LoadCell(const Options& options, double sample_time, std::uint64_t seed);

  struct AxisNoise {
    WhiteNoise white;
    ColouredNoise coloured;
    Drift drift;
  };

  AxisVector<Axes> late(const AxisVector<Axes>& force) noexcept;

  AxisMatrix<Axes> gain_error_;
  AxisVector<Axes> offset_;
  double resolution_, delay_, behind_;     // behind_: the delay in samples
  std::vector<AxisVector<Axes>> history_;  // ring
  std::size_t next_ = 0;
  bool begun_ = false;
  std::array<AxisNoise, Axes> noise_;
};

extern template class LoadCell<1>;
extern template class LoadCell<2>;

}  // namespace mbk::laboratory
