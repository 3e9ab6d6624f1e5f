#pragma once

#include <array>
#include <cstdint>

#include "mbk/base/core/words.h"
#include "mbk/experiment/control/trial_control.h"
#include "mbk/model/perturbation/minimum_jerk.h"

namespace mbk::control {

/// What a trial consists of, in its order.
enum class Phase : std::uint8_t {
  starting,    ///< the gains grow while the joints are held where they were found
  moving,      ///< to the test location
  settling,    ///< held there
  perturbing,  ///< what the trial is for
  returning,   ///< back to the test location
  stopping,    ///< the gains fade
  done,        ///< no torque
};

[[nodiscard]] constexpr auto word_table(Phase) {
  using enum Phase;
  return std::to_array<Word<Phase>>({
      {starting, "soft start"},
      {moving, "moving to the test location"},
      {settling, "settling"},
      {perturbing, "perturbing"},
      {returning, "returning"},
      {stopping, "soft stop"},
      {done, "done"},
  });
}

/// How the robot comes to the test location and away from it.
struct SequenceOptions {
  double soft_start = 1.0;           ///< time in which the gains grow, and fade at the end [s] > 0
  double move_speed = 0.1;           ///< largest speed of the hand on the way to the test location [m/s] > 0
  double shortest_move = 1.0;        ///< [s] > 0
  double settle = 1.0;               ///< rest before the perturbation [s] ≥ 0
  double handover = 0.25;            ///< from holding a place to exerting a force [s] > 0
  JointPositionControl::Gains hold;  ///< of the way there and back
};

/// One trial from the first tick to the last: soft start, move to the test location, perturb, return, soft stop. Moves
/// are straight lines in joint angles by minimum jerk, so that between two places inside the joint limits, which are
/// straight lines in these angles, no limit is met. After `create` nothing allocates.
class Sequencer {
 public:
  /// What one tick asks for.
  struct Step {
    Phase phase = Phase::done;
    Vector2d torque = {0.0, 0.0};           ///< [N·m]
    Vector2d reference = {0.0, 0.0};        ///< hand's place [m]; force [N]; of reaches TrialControl::reference
    Vector2d joint_reference = {0.0, 0.0};  ///< [rad]; the joints shall be there where `follows`
    bool follows = false;                   ///< a position is controlled
    bool triggered = false;                 ///< a hand that reaches passed the trigger
    double perturbation_time = -1.0;        ///< of the schedule [s]; negative outside of it
  };

  /// @fails  usage: an option is out of its range; as JointPositionControl.
  [[nodiscard]] static Result<Sequencer> create(const TrialControl& trial, const SequenceOptions& options,
                                                const robot::Geometry& geometry, double sample_time);

  /// The next tick, with the angles as measured [rad]. The first call finds the robot where it stands.
  Step step(const Vector2d& measured) noexcept;

  /// Ends the perturbation at the next tick and goes back; before it, stops where it is.
  void end_early() noexcept { ending_ = true; }

  [[nodiscard]] Phase phase() const { return phase_; }

  /// From the first tick to the last where the hand starts so far from the test location [m]; [s].
  [[nodiscard]] double duration(double distance) const;

 private:
  Sequencer(const TrialControl& trial, const SequenceOptions& options, const robot::Geometry& geometry,
            JointPositionControl hold, double sample_time);
  void enter(Phase phase, const Vector2d& measured) noexcept;
  void plan_move(const Vector2d& measured) noexcept;
  [[nodiscard]] double move_duration(double distance) const;
  [[nodiscard]] double phase_duration() const;
  void hold_along(double t) noexcept;

  TrialControl trial_;
  SequenceOptions options_;
  robot::Geometry geometry_;
  JointPositionControl hold_;
  double sample_time_;
  Phase phase_ = Phase::starting;
  bool found_ = false, ending_ = false;
  std::int64_t ticks_ = 0;  // since the phase began
  Vector2d held_ = {0.0, 0.0}, held_rate_ = {0.0, 0.0};
  std::array<perturbation::MinimumJerk, 2> move_, brake_;  // their sum is the way: from rest to rest, and out of motion
  double move_duration_ = 0.0;
  bool grip_again_ = false;  // on the way back the gains have to grow once more
};

}  // namespace mbk::control
