#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/perturbation/jet.h"
#include "mbk/model/perturbation/minimum_jerk.h"

namespace mbk::perturbation {

/// Reaches of a hand from home to a target, some of which a servo displaces relative to a prediction of their own way
/// (Burdet et al. 2000): out on a minimum-jerk ramp, a hold, and back on another ramp. The first reaches are
/// undisturbed, since the prediction is learned from them; then displaced and undisturbed ones come in random order.
/// When a reach begins, and so when it is displaced, is the person's choice: the trigger is the hand's passing a place.
/// What is a function of time here is the expected course: a reach by minimum jerk at the beginning of each interval,
/// and the way back from its middle on. It serves to plan and to check limits.
class ReachSchedule {
 public:
  static constexpr int kMaxReaches = 10000;
  static constexpr int kMinUndisturbedFirst = 12;  ///< for 9 coefficients of the prediction (way_prediction.h)

  struct Options {
    double amplitude = 0.008;             ///< A of the displacement, from the predicted way [m] > 0
    double out = 0.1;                     ///< duration of the way out [s] > 0
    double hold = 0.1;                    ///< at A [s] > 0
    double back = 0.1;                    ///< duration of the way back [s] > 0
    int directions = 8;                   ///< evenly around the circle, the first along +x
    int repetitions = 10;                 ///< displaced reaches in each direction
    int undisturbed_first = 20;           ///< ≥ kMinUndisturbedFirst
    int undisturbed_between = 20;         ///< among the displaced ones ≥ 0; at most kMaxReaches in all
    Eigen::Vector2d reach = {0.0, 0.25};  ///< from home to the target, base frame [m]
    double trigger = 0.08;                ///< progress towards the target at which the hand is displaced [m] > 0
    double reach_time = 0.6;              ///< expected duration of a reach [s] > 0
    double interval = 3.0;                ///< for each reach and its way back [s] ≥ 2 reach_time
    double quiet = 3.0;                   ///< before the first interval [s] ≥ 0
    std::uint64_t seed = 1;
  };

  struct Reach {
    bool displaced = false;
    double angle = 0.0;                        ///< of the displacement from +x [rad]; 0 where there is none
    Eigen::Vector2d direction_B = {0.0, 0.0};  ///< unit vector, base frame; zero where there is none
  };

  /// @fails  usage: a limit named at Options is not kept; a value is not finite; the trigger is not before the target;
  ///         a displacement would last beyond an interval.
  [[nodiscard]] static Result<ReachSchedule> create(const Options& options);

  [[nodiscard]] const Options& options() const { return options_; }
  [[nodiscard]] const std::vector<Reach>& reaches() const { return reaches_; }  ///< in their order

  /// Share of the displacement, 0 … 1, and its derivatives at t [s] after the trigger. Does not allocate.
  [[nodiscard]] Jet<double> shape(double t) const;

  /// From the trigger to the end of the way back [s].
  [[nodiscard]] double displaced_for() const { return options_.out + options_.hold + options_.back; }

  /// Expected displacement from the predicted way at t [s], base frame [m]. Does not allocate.
  [[nodiscard]] Jet<Eigen::Vector2d> at(double t) const;

  /// Expected way of the hand from home at t [s], without displacements, base frame [m]. Does not allocate.
  [[nodiscard]] Eigen::Vector2d way(double t) const;

  /// When reach number k is expected to begin, and to pass the trigger [s].
  [[nodiscard]] double begin(std::size_t k) const;
  [[nodiscard]] double trigger_time(std::size_t k) const { return begin(k) + to_trigger_; }

  /// End of the last interval [s].
  [[nodiscard]] double end() const { return begin(reaches_.size()); }

  /// −3 dB of the faster ramp, as RampAndHold::bandwidth.
  [[nodiscard]] Hertz bandwidth() const;

 private:
  ReachSchedule(const Options& options, std::vector<Reach> reaches);
  /// Number of the reach in whose interval t lies; none before the first and after the last.
  [[nodiscard]] std::size_t number_at(double t) const;

  Options options_;
  std::vector<Reach> reaches_;
  MinimumJerk out_, back_, there_;
  double to_trigger_ = 0.0;  // from the beginning of an expected reach [s]
};

}  // namespace mbk::perturbation
