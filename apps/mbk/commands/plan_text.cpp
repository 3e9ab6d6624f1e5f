#include "apps/mbk/commands/plan_text.h"

#include <fmt/format.h>

#include "mbk/present/report/schedule_text.h"

namespace mbk::app {
namespace {

std::string limit_line(const char* what, double value, double limit, const char* unit) {
  return fmt::format("  {:<34}{:>8.3g} {:<4} of {:>5.3g}{}\n", what, value, unit, limit,
                     value > 0.8 * limit ? "   close to the limit" : "");
}

}  // namespace

std::string plan_text(const session::Plan& plan, const session::Rehearsal& rehearsal) {
  const protocol::Trial& trial = plan.trial;
  const safety::Limits& limits = plan.limits;
  const double perturbation = plan.schedule.duration();
  std::string text = fmt::format("{}{}{}\n", trial.protocol, trial.name.empty() ? "" : ", trial " + trial.name,
                                 trial.condition.empty() ? "" : ": " + trial.condition);
  const bool tripped = rehearsal.trip.reason != safety::Reason::none;
  if (tripped) text += fmt::format("  SAFETY STOP in the rehearsal: {}\n", safety::sentence(rehearsal.trip));
  text += fmt::format(
      "  {}    {:.1f} s{}: soft start {:g} s, move to the test location, {:g} s of rest,\n"
      "                perturbation {:.1f} s, move back, soft stop {:g} s\n",
      tripped ? "stopped at" : "total     ", rehearsal.duration, tripped ? "; planned" : "", trial.sequence.soft_start,
      trial.sequence.settle, perturbation, trial.sequence.soft_start);
  text += report::schedule_text(plan.schedule);
  text += "  peaks in a simulated rehearsal, and the safety limits\n";
  text += limit_line("force of the motors at the handle", rehearsal.handle_force, limits.handle_force, "N");
  text += limit_line("torque of joint 1", rehearsal.joint_torque[0], limits.joint_torque[0], "N·m");
  text += limit_line("torque of joint 2", rehearsal.joint_torque[1], limits.joint_torque[1], "N·m");
  text += limit_line("measured force", rehearsal.measured_force, limits.measured_force, "N");
  text += limit_line("speed of the hand", 1e3 * rehearsal.speed, 1e3 * limits.speed, "mm/s");
  if (limits.excursion > 0.0) {
    text += limit_line("distance from the test location", 1e3 * rehearsal.excursion, 1e3 * limits.excursion, "mm");
  }
  for (const std::string& one : safety::weakened(limits)) text += fmt::format("  ! {}\n", one);
  return text;
}

}  // namespace mbk::app
