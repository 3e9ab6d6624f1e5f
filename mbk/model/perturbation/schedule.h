#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/base/core/words.h"
#include "mbk/model/perturbation/jet.h"
#include "mbk/model/perturbation/minimum_jerk.h"
#include "mbk/model/perturbation/multisine.h"
#include "mbk/model/perturbation/ramp_and_hold.h"
#include "mbk/model/perturbation/random_binary.h"
#include "mbk/model/perturbation/reach_schedule.h"
#include "mbk/model/perturbation/stretches.h"
#include "mbk/model/perturbation/underdamped_pulse.h"

namespace mbk::perturbation {

enum class Quantity { position, force };  ///< commanded quantity: a displacement from home, or a force

[[nodiscard]] constexpr auto word_table(Quantity) {
  using enum Quantity;
  return std::to_array<Word<Quantity>>({{position, "position"}, {force, "force"}});
}

enum class Space { hand, joint };  ///< hand: base frame, Cartesian [m | N]; joint: [rad | N·m]

/// The unit of a commanded value: "m", "rad", "N" or "N·m".
[[nodiscard]] std::string_view unit(Quantity quantity, Space space);

/// An event of a schedule.
struct ScheduleEvent {
  double time = 0.0;   ///< [s] from the start of the schedule
  std::string name;    ///< "onset" or "offset" of a pulse, ramp or stretch
  double value = 0.0;  ///< its angle from +x [rad]
};

/// Demands of a schedule over its whole duration, including moving in and pauses. u is the unit of its value. Peaks are
/// those of the continuous signal, not of its samples.
struct Facts {
  double peak = 0.0;                    ///< largest |r| of all axes together [u]
  double peak_time = 0.0;               ///< where [s]
  double rms = 0.0;                     ///< √(mean of |r|²) [u]
  double peak_speed = 0.0;              ///< largest |ṙ| [u/s]
  double peak_speed_time = 0.0;         ///< where [s]
  double peak_acceleration = 0.0;       ///< largest |r̈| [u/s²], also that after a jump
  double peak_acceleration_time = 0.0;  ///< where [s]
  AxesVector axis_peak;                 ///< largest |rᵢ| of each axis [u]
  AxesVector axis_rms;                  ///< of each axis [u]
  AxesVector crest_factor;              ///< axis_peak/axis_rms; 0 for an axis at rest
  Hertz lowest_frequency;               ///< sines: lowest line; else 0
  Hertz highest_frequency;  ///< sines: highest line. Pulses: −3 dB of G, eq. 3.5. Binary: of sinc·G. Ramps, stretches:
                            ///< of the velocity. Rest: 0
};

/// Limits of a schedule; empty ones are not checked. u is the unit of its value.
struct Limits {
  std::optional<double> peak;          ///< of |r| [u]
  std::optional<double> speed;         ///< of |ṙ| [u/s]
  std::optional<double> acceleration;  ///< of |r̈| [u/s²]
  std::optional<Hertz> bandwidth;      ///< of Facts::highest_frequency
  /// Whether a displacement from home [m or rad] can be reached. Checked along the whole path of a position schedule;
  /// not for a force schedule, whose path is unknown beforehand.
  std::function<Result<void>(const Eigen::Vector2d& displacement)> reachable;
};

/// A signal r(t) of one to three axes with its facts: all commands to a robot in one trial. It begins at rest;
/// after its duration sines continue, a binary sequence keeps its last value, everything else rests.
class Schedule {
 public:
  static constexpr double kLongest = 3600.0;  ///< [s]; split longer trials into several schedules
  static constexpr double kMaxCycles = 1e5;   ///< of the highest frequency within the duration

  /// One multisine for each axis, r = g(t) [s₁(t), s₂(t), …], g from 0 to 1 by minimum jerk. The periods may differ.
  /// @param moving_in  time in which g grows [s]
  /// @fails  not 1 to 3 axes; moving in ≤ 0 or longer than the duration; duration ≤ 0, above kLongest, not finite; over
  /// kMaxCycles of the highest line.
  [[nodiscard]] static Result<Schedule> multisine(std::vector<Multisine> axes, Quantity quantity, Space space,
                                                  double duration, double moving_in);

  /// Underdamped pulses; in Space::joint, direction +x is the first joint's.
  /// @param tail  from the last offset to the end [s]; not shorter than the return
  /// @fails  as PulseSchedule::create; the tail is too short or not finite; the whole is longer than kLongest; more
  /// than kMaxCycles of the filter's bandwidth.
  [[nodiscard]] static Result<Schedule> pulses(const PulseSchedule::Options& options, Quantity quantity, double tail,
                                               Space space = Space::hand);

  /// A filtered random binary sequence along one direction.
  /// @param angle  of the direction of +A from +x, base frame, or from the first joint's axis in Space::joint [rad]
  /// @fails  as RandomBinary::create; the angle is not finite; duration above kLongest; more than
  /// kMaxCycles of the filter's bandwidth.
  [[nodiscard]] static Result<Schedule> random_binary(const RandomBinaryOptions& options, double angle,
                                                      Quantity quantity, double duration, Space space = Space::hand);

  /// Ramps and holds of the position; in Space::joint, direction +x is the first joint's.
  /// @param tail  from the end of the last return to the end [s]
  /// @fails  as RampAndHold::create; the tail is below 0 or not finite; the whole is longer than kLongest; more than
  /// kMaxCycles of the ramps' bandwidth.
  [[nodiscard]] static Result<Schedule> ramps(const RampAndHold::Options& options, double tail,
                                              Space space = Space::hand);

  /// Stretches at constant velocity along the first axis; position.
  /// @param tail  from the end of the last return to the end [s]
  /// @fails  as Stretches::create; the tail is below 0 or not finite; the whole is longer than kLongest; more than
  /// kMaxCycles of the stretches' bandwidth.
  [[nodiscard]] static Result<Schedule> stretches(const Stretches::Options& options, double tail,
                                                  Space space = Space::joint);

  /// Displacements of a reaching hand relative to its predicted path; position, Space::hand. Its function of time is
  /// the expected course (ReachSchedule): the participant decides when a reach begins.
  /// @param tail  from the end of the last interval to the end [s]
  /// @fails  as ReachSchedule::create; the tail is below 0 or not finite; the whole is longer than kLongest; more than
  /// kMaxCycles of the ramps' bandwidth.
  [[nodiscard]] static Result<Schedule> reaches(const ReachSchedule::Options& options, double tail);

  /// Nothing moves: position, Space::hand, zero.   @fails  duration ≤ 0, above kLongest or not finite.
  [[nodiscard]] static Result<Schedule> rest(double duration);

  [[nodiscard]] Quantity quantity() const { return quantity_; }
  [[nodiscard]] Space space() const { return space_; }
  [[nodiscard]] double duration() const { return duration_; }  ///< [s]

  [[nodiscard]] int axes() const;  ///< entries of its value

  /// The reaches that it displaces; null if it has no reaches.
  [[nodiscard]] const ReachSchedule* reaches() const { return std::get_if<ReachSchedule>(&shape_); }

  /// Its stretches; null if it has none.
  [[nodiscard]] const Stretches* stretches() const { return std::get_if<Stretches>(&shape_); }

  /// r, ṙ, r̈ at t [s]: displacement from home [m or rad] or force [N or N·m]; zero before 0. Does not allocate.
  [[nodiscard]] Jet<AxesVector> at(double t) const;

  /// The reference that a recording stores at t [s], in the unit of the value: for pulses the steps before G, so that
  /// each pulse has an onset and an offset; otherwise the signal itself. Does not allocate.
  [[nodiscard]] AxesVector reference(double t) const;

  /// Onset and offset of every pulse, ramp or stretch, in time order; otherwise empty.
  [[nodiscard]] std::vector<ScheduleEvent> events() const;

  /// Computed on a grid of 64 samples per period of the highest frequency, with refined peaks. Offline: allocates.
  [[nodiscard]] Facts facts() const;

  /// @fails  a limit is exceeded, or is itself not positive; the message gives quantity, value, limit, time and remedy.
  /// Errors of `reachable` get the time added. Offline: allocates.
  [[nodiscard]] Result<void> check(const Limits& limits) const;

 private:
  struct Rest {};
  struct Sines {
    std::vector<Multisine> axes;
    MinimumJerk growth;
    double moving_in;
  };
  struct Binary {
    RandomBinary sequence;
    Eigen::Vector2d direction_B;
  };
  using Shape = std::variant<Rest, Sines, PulseSchedule, Binary, RampAndHold, Stretches, ReachSchedule>;

  Schedule(Shape shape, Quantity quantity, Space space, double duration)
      : shape_(std::move(shape)), quantity_(quantity), space_(space), duration_(duration) {}

  [[nodiscard]] static Result<Schedule> with_countable_cycles(Schedule schedule);
  [[nodiscard]] std::pair<Hertz, Hertz> band() const;
  [[nodiscard]] Hertz fastest() const;
  [[nodiscard]] std::vector<double> breaks() const;
  [[nodiscard]] std::vector<double> grid() const;

  Shape shape_;
  Quantity quantity_;
  Space space_;
  double duration_;
};

}  // namespace mbk::perturbation
