#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/numeric/random.h"
#include "mbk/model/perturbation/jet.h"
#include "mbk/model/perturbation/minimum_jerk.h"

namespace mbk::participant {

/// Where a hand is meant to be that reaches for a target again and again, each time a little differently: a
/// minimum-jerk path (Flash & Hogan 1985) of its own duration T, length, bend b and end, a stay, and a minimum-jerk way
/// back. With the share s of the way from the start x₀ along the reach r and across it n,
///   x_d = x₀ + s (l r + e n) + 4 s (1 − s) b n
class Reaching {
 public:
  struct Options {
    Eigen::Vector2d start = {0.3, -0.05};  ///< x₀, base frame [m]
    Eigen::Vector2d reach = {0.0, 0.25};   ///< to the target [m]
    int reaches = 120;
    double first = 3.0;             ///< the first one may begin from then on [s]
    double interval = 3.0;          ///< from one to the next [s]
    double latest = 0.3;            ///< a reach begins so late in its interval, at random [s] ≥ 0
    double duration = 0.6;          ///< T on average [s]
    double duration_spread = 0.06;  ///< standard deviations from here on: of T, relative
    double length_spread = 0.05;    ///< of l about 1
    double bend = 0.006;            ///< of b [m]
    double end_spread = 0.006;      ///< of e, the end across the reach [m]
    double stay = 0.3;              ///< at the end [s] ≥ 0
    double way_back = 0.8;          ///< duration [s]
    double carried_mass = 1.0;      ///< that the person takes the robot for: the force for it is exerted too [kg] ≥ 0
  };

  /// @fails  usage: a limit named at Options is not kept; there is no way; a reach and its way back do not fit into an
  ///         interval.
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
