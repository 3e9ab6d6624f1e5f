#pragma once

#include "mbk/base/core/result.h"
#include "mbk/experiment/control/sequencer.h"
#include "mbk/experiment/protocol/experiment.h"
#include "mbk/experiment/safety/gate.h"

namespace mbk::session {

/// What a trial will do, found to keep its limits. Made once, before anything moves, and handed on: to a rehearsal, to
/// the session, to whoever shows it.
struct Plan {
  protocol::Trial trial;
  safety::Limits limits;  ///< of the gate: those of the trial, with what follows from the plan
  perturbation::Schedule schedule;
  control::Sequencer sequence;  ///< before its first tick

  /// From one tick to the next [s].
  [[nodiscard]] double sample_time() const { return 1.0 / trial.rate.value; }

  /// A new gate with these limits.   @fails  as Gate::create, of which make_plan has made sure
  [[nodiscard]] Result<safety::Gate> gate() const;
};

/// In a trial of positions a limit that the experiment does not give follows from the plan, where that is lower than
/// the one by default: speed 1.5 times the planned one + 50 mm/s, way from home 1.5 times + 15 mm, tracking error 4°.
/// @fails  usage: the schedule asks for more than the gate allows (force, speed, excursion, workspace, joint margin),
///         with value, limit and time; as perturbation::make_schedule, TrialControl, Sequencer and Gate.
[[nodiscard]] Result<Plan> make_plan(protocol::Trial trial);

/// The largest values of a rehearsal, each with the limit of the gate.
struct Rehearsal {
  double handle_force = 0.0;                  ///< commanded, |J⁻ᵀτ| [N]
  double measured_force = 0.0;                ///< [N]
  Eigen::Vector2d joint_torque = {0.0, 0.0};  ///< commanded [N·m]
  double speed = 0.0;                         ///< of the hand, over 20 ticks [m/s]
  double excursion = 0.0;                     ///< of the hand from home while it is perturbed [m]
  double duration = 0.0;                      ///< of the whole trial [s]
  safety::Trip trip;                          ///< Reason::none where nothing tripped
};

/// Runs the trial on the simulated robot with whoever the experiment describes at its handle, through the same loop and
/// gate; nothing is recorded.
/// @fails  usage: the trial has no simulation; as Simulation::robot
[[nodiscard]] Result<Rehearsal> rehearse(const Plan& plan);

}  // namespace mbk::session
