#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/numeric/random.h"
#include "mbk/model/perturbation/jet.h"
#include "mbk/model/perturbation/minimum_jerk.h"

namespace mbk::participant {

/// Intended position of a hand that reaches repeatedly for a target, each time slightly differently: a minimum-jerk
/// path (Flash & Hogan 1985) with random duration T, length, bend b and end, a dwell, and a minimum-jerk return. With
/// the fraction s of the path from the start x₀ along the reach r and perpendicular to it n,
///   x_d = x₀ + s (l r + e n) + 4 s (1 − s) b n
class Reaching {
 public:
  struct Options {
    Eigen::Vector2d start = {0.3, -0.05};  ///< x₀, base frame [m]
    Eigen::Vector2d reach = {0.0, 0.25};   ///< to the target [m]
    int reaches = 120;
    double first = 3.0;             ///< earliest start of the first reach [s]
    double interval = 3.0;          ///< from one to the next [s]
    double latest = 0.3;            ///< maximum random delay of a reach in its interval [s] ≥ 0
    double duration = 0.6;          ///< T on average [s]
    double duration_spread = 0.06;  ///< standard deviations from here on: of T, relative
    double length_spread = 0.05;    ///< of l about 1
    double bend = 0.006;            ///< of b [m]
    double end_spread = 0.006;      ///< of e, the end perpendicular to the reach [m]
    double stay = 0.3;              ///< at the end [s] ≥ 0
    double way_back = 0.8;          ///< duration [s]
    double carried_mass = 1.0;      ///< mass that the person attributes to the robot and compensates [kg] ≥ 0
  };

  /// @fails  usage: a limit stated in Options is violated; the reach has zero length; a reach and its return do not fit
  /// into an interval.
  [[nodiscard]] static Result<Reaching> create(const Options& options, std::uint64_t seed, std::uint32_t stream);

  /// x_d, ẋ_d, ẍ_d at t [s]; base frame. Does not allocate.
  [[nodiscard]] perturbation::Jet<Eigen::Vector2d> at(double t) const;

  [[nodiscard]] const Options& options() const { return options_; }

 private:
  struct One {
    double begin = 0.0;
    perturbation::MinimumJerk out;
    Eigen::Vector2d way, across;  // l r + e n, b n
    double duration = 0.0;
  };
  explicit Reaching(const Options& options);

  Options options_;
  perturbation::MinimumJerk back_;
  std::vector<One> all_;  // in time order
};

}  // namespace mbk::participant
