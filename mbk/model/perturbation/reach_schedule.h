#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/perturbation/jet.h"
#include "mbk/model/perturbation/minimum_jerk.h"

namespace mbk::perturbation {

/// Reaches of a hand from home to a target, some of which a servo displaces relative to a prediction of their own path
/// (Burdet et al. 2000): out on a minimum-jerk ramp, a hold, and back on another ramp. The first reaches are
/// undisturbed, because the prediction is learned from them; then displaced and undisturbed ones follow in random
/// order. The participant decides when a reach begins, and so when it is displaced: the trigger is the hand passing a
/// position. Functions of time here describe the expected course: a minimum-jerk reach at the beginning of each
/// interval, and the return from its middle. It is used for planning and for checking limits.
class ReachSchedule {
 public:
  static constexpr int kMaxReaches = 10000;
  static constexpr int kMinUndisturbedFirst = 12;  ///< for 9 coefficients of the prediction (way_prediction.h)

  struct Options {
    double amplitude = 0.008;             ///< A of the displacement, from the predicted path [m] > 0
    double out = 0.1;                     ///< duration of the outward ramp [s] > 0
    double hold = 0.1;                    ///< at A [s] > 0
    double back = 0.1;                    ///< duration of the return [s] > 0
    int directions = 8;                   ///< evenly around the circle, the first along +x
    int repetitions = 10;                 ///< displaced reaches in each direction
    int undisturbed_first = 20;           ///< ≥ kMinUndisturbedFirst
    int undisturbed_between = 20;         ///< among the displaced ones ≥ 0; at most kMaxReaches in all
    Eigen::Vector2d reach = {0.0, 0.25};  ///< from home to the target, base frame [m]
    double trigger = 0.08;                ///< progress towards the target at which the hand is displaced [m] > 0
    double reach_time = 0.6;              ///< expected duration of a reach [s] > 0
    double interval = 3.0;                ///< for each reach and its return [s] ≥ 2 reach_time
    double quiet = 3.0;                   ///< before the first interval [s] ≥ 0
    std::uint64_t seed = 1;
  };

  struct Reach {
    bool displaced = false;
    double angle = 0.0;                        ///< of the displacement from +x [rad]; 0 without one
    Eigen::Vector2d direction_B = {0.0, 0.0};  ///< unit vector, base frame; zero without one
  };

  /// @fails  usage: a limit stated in Options is violated; a value is not finite; the trigger is not before the target;
  ///         a displacement would last beyond an interval.
  [[nodiscard]] static Result<ReachSchedule> create(const Options& options);

  [[nodiscard]] const Options& options() const { return options_; }
  [[nodiscard]] const std::vector<Reach>& reaches() const { return reaches_; }  ///< in their order

  /// Share of the displacement, 0 … 1, and its derivatives at t [s] after the trigger. Does not allocate.
  [[nodiscard]] Jet<double> shape(double t) const;

  /// From the trigger to the end of the return [s].
  [[nodiscard]] double displaced_for() const { return options_.out + options_.hold + options_.back; }

  /// Expected displacement from the predicted path at t [s], base frame [m]. Does not allocate.
  [[nodiscard]] Jet<Eigen::Vector2d> at(double t) const;

  /// Expected position of the hand relative to home at t [s], without displacements, base frame [m]. Does not allocate.
  [[nodiscard]] Eigen::Vector2d way(double t) const;

  /// Expected start of reach k, and its expected passing of the trigger [s].
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
