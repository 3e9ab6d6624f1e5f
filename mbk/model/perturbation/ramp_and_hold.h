#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/perturbation/jet.h"
#include "mbk/model/perturbation/minimum_jerk.h"

namespace mbk::perturbation {

/// Servo displacements of the hand (Mussa-Ivaldi, Hogan & Bizzi 1985): out on a minimum-jerk ramp, a hold, and back on
/// another ramp, in directions spaced evenly around a circle, each repeated, in random order and with random pauses.
class RampAndHold {
 public:
  static constexpr int kMaxRamps = 10000;

  struct Options {
    double amplitude = 0.006;     ///< A [m or rad]; > 0. Mussa-Ivaldi et al. (1985): 5 to 8 mm
    double ramp = 0.12;           ///< duration of the outward ramp [s]; > 0
    double hold = 0.5;            ///< at A [s]; > 0
    double way_back = 0.3;        ///< duration of the return [s]; > 0
    int directions = 8;           ///< evenly around the circle, the first along +x; 2 gives ±x
    int repetitions = 10;         ///< ramps in each direction; at most kMaxRamps in all
    double shortest_pause = 1.0;  ///< from the end of `quiet`, or of the previous return, to the onset [s]; ≥ 0
    double longest_pause = 2.0;   ///< [s]
    double quiet = 2.0;           ///< before the first pause [s]
    std::uint64_t seed = 1;
  };

  struct Ramp {
    double onset = 0.0;                        ///< start of the outward ramp [s]
    double offset = 0.0;                       ///< start of the return [s]
    int direction = 0;                         ///< 0 … directions − 1
    double angle = 0.0;                        ///< from +x [rad]
    Eigen::Vector2d direction_B = {1.0, 0.0};  ///< unit vector, base frame
  };

  /// @fails  usage: a limit stated in Options is violated; a value is not finite.
  [[nodiscard]] static Result<RampAndHold> create(const Options& options);

  /// Displacement and its two derivatives at t [s]; base frame. Exactly A along the direction while it is held, exactly
  /// zero between the end of a return and the next onset. Does not allocate.
  [[nodiscard]] Jet<Eigen::Vector2d> at(double t) const;

  [[nodiscard]] const std::vector<Ramp>& ramps() const { return ramps_; }
  [[nodiscard]] const Options& options() const { return options_; }

  /// End of the last return [s].
  [[nodiscard]] double end() const { return ramps_.back().offset + options_.way_back; }

  /// −3 dB of the faster ramp: the spectrum of the velocity of a minimum-jerk path of duration D is
  /// A · 15 j₂(πfD)/(πfD)², which falls to 1/√2 at f = 0.6874/D.
  [[nodiscard]] Hertz bandwidth() const;

 private:
  explicit RampAndHold(const Options& options);

  Options options_;
  MinimumJerk out_, back_;
  std::vector<Ramp> ramps_;  // in time order
};

}  // namespace mbk::perturbation
