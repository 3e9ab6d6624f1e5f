#include "mbk/experiment/session/plan.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <atomic>
#include <thread>

#include "mbk/experiment/session/loop.h"
#include "mbk/model/robot/workspace.h"
#include "mbk/present/report/schedule_text.h"
#include "mbk/simulate/laboratory/simulated_device.h"

namespace mbk::session {
namespace {

constexpr double kDegree = 0.017453292519943295;
constexpr Eigen::Index kSpeedTicks = 20;

/// One value of the schedule against one limit of the gate.
Result<void> within(const char* what, double value, double limit, double scale, const char* unit, const char* key,
                    double time) {
  if (value <= limit) return {};
  return bad_usage(fmt::format("{} is {:.4g} {} at {:.3f} s, beyond safety.{} = {:.4g} {}", what, scale * value, unit,
                               time, key, scale * limit, unit),
                   "perturb less, or raise the limit if that is safe for this person and this robot");
}

/// What a hand that follows the schedule does at most.
struct PlannedMotion {
  double speed = 0.0;      ///< [m/s]
  double excursion = 0.0;  ///< from home [m]
};

/// Limits that follow from the plan: a hand that is driven the wrong way is stopped before it is fast.
safety::Limits limits_of(const Trial& trial, const PlannedMotion& planned) {
  constexpr double kMore = 1.5, kMoreSpeed = 0.05, kMoreWay = 0.015, kTracking = 4.0 * kDegree;  // [1, m/s, m, rad]
  safety::Limits limits = trial.limits;
  if (!std::holds_alternative<control::PositionMode>(trial.planar().control)) return limits;
  const double speed = std::max(planned.speed, trial.sequence.move_speed);
  if (trial.from_plan.speed) limits.speed = std::min(limits.speed, kMore * speed + kMoreSpeed);
  if (trial.from_plan.excursion) limits.excursion = std::min(limits.excursion, kMore * planned.excursion + kMoreWay);
  if (trial.from_plan.tracking) limits.tracking = std::min(limits.tracking, kTracking);
  return limits;
}

/// What the schedule asks of a hand that follows it.
Result<PlannedMotion> check_path(const control::TrialControl& control, const Trial& trial) {
  const safety::Limits& limits = trial.limits;
  PlannedMotion planned;
  const robot::Geometry& geometry = trial.planar().robot.robot.geometry;
  const Eigen::Vector2d home = trial.planar().home;
  const double step = 1.0 / trial.scenario.rate.value;
  const auto ticks = static_cast<int>(control.schedule().duration() / step);
  Eigen::Vector2d last = control.place(0.0);
  for (int i = 0; i <= ticks; ++i) {
    const double t = i * step;
    const Eigen::Vector2d hand = control.place(t);
    if (limits.excursion > 0.0) {
      if (auto ok = within("the way from home", (hand - home).norm(), limits.excursion, 1e3, "mm", "excursion_mm", t);
          !ok) {
        return tl::unexpected(ok.error());
      }
    }
    if (auto ok =
            within("the hand's speed", (hand - last).norm() / step, limits.speed, 1e3, "mm/s", "speed_mm_per_s", t);
        !ok) {
      return tl::unexpected(ok.error());
    }
    planned.excursion = std::max(planned.excursion, (hand - home).norm());
    planned.speed = std::max(planned.speed, (hand - last).norm() / step);
    const double outside =
        std::max((limits.workspace_low - hand).maxCoeff(), (hand - limits.workspace_high).maxCoeff());
    if (outside > 0.0) {
      return bad_usage(fmt::format("the hand leaves the safety workspace by {:.1f} mm at {:.3f} s", 1e3 * outside, t),
                       "perturb less, move home, or widen safety.workspace_low_mm and workspace_high_mm");
    }
    const auto angles = robot::check_hand(geometry, hand);
    if (!angles) return tl::unexpected(angles.error());
    const double margin = robot::margin(geometry.limits, *angles);
    if (margin < limits.joint_margin) {
      return bad_usage(fmt::format("a joint comes within {:.2f}° of its limit at {:.3f} s, closer than "
                                   "safety.joint_margin_deg = {:.2f}",
                                   margin / kDegree, t, limits.joint_margin / kDegree),
                       "perturb less, or choose another home");
    }
    last = hand;
  }
  return planned;
}

/// Takes the peaks out of the ticks as they come.
class Peaks {
 public:
  Peaks(Rehearsal& rehearsal, const Trial& trial)
      : rehearsal_(rehearsal),
        geometry_(trial.planar().robot.robot.geometry),
        home_(trial.planar().home),
        span_(static_cast<double>(kSpeedTicks) / trial.scenario.rate.value) {}

  void add(const journal::Tick& tick) {
    const Eigen::Vector2d joint(tick.joint[0], tick.joint[1]), torque(tick.torque[0], tick.torque[1]);
    const Eigen::Vector2d hand = robot::hand_position(geometry_, joint);
    const auto raise = [](double& peak, double value) { peak = std::max(peak, value); };
    raise(rehearsal_.handle_force, (robot::jacobian(geometry_, joint).transpose().inverse() * torque).norm());
    raise(rehearsal_.measured_force, std::hypot(tick.force[0], tick.force[1]));
    rehearsal_.joint_torque = rehearsal_.joint_torque.cwiseMax(torque.cwiseAbs());
    if (tick.perturbing()) raise(rehearsal_.excursion, (hand - home_).norm());
    Eigen::Vector2d& before = hands_[tick.number % kSpeedTicks];
    if (tick.number >= kSpeedTicks) raise(rehearsal_.speed, (hand - before).norm() / span_);
    before = hand;
    rehearsal_.duration = tick.time;
  }

 private:
  Rehearsal& rehearsal_;
  robot::Geometry geometry_;
  Eigen::Vector2d home_;
  double span_;
  std::array<Eigen::Vector2d, kSpeedTicks> hands_{};
};

std::string limit_line(const char* what, double value, double limit, const char* unit) {
  return fmt::format("  {:<34}{:>8.3g} {:<4} of {:>5.3g}{}\n", what, value, unit, limit,
                     value > 0.8 * limit ? "   close to the limit" : "");
}

}  // namespace

Result<Plan> make_plan(const Trial& trial) {
  auto schedule = laboratory::make_schedule(trial.scenario.perturbation, trial.scenario.seed);
  if (!schedule) return tl::unexpected(schedule.error());
  const laboratory::PlanarTrial& planar = trial.planar();
  const robot::Geometry& geometry = planar.robot.robot.geometry;
  const double sample_time = 1.0 / trial.scenario.rate.value;
  auto control = control::TrialControl::create(planar.control, *schedule, geometry, planar.home, sample_time);
  if (!control) return tl::unexpected(control.error());
  auto sequence = control::Sequencer::create(*control, trial.sequence, geometry, sample_time);
  if (!sequence) return tl::unexpected(sequence.error());
  if (auto ok = safety::check(trial.limits); !ok) return tl::unexpected(ok.error());
  if (schedule->quantity() == perturbation::Quantity::force) {
    const perturbation::Facts facts = schedule->facts();
    if (auto ok =
            within("the force", facts.peak, trial.limits.handle_force, 1.0, "N", "handle_force_N", facts.peak_time);
        !ok) {
      return tl::unexpected(ok.error());
    }
  }
  const auto planned = check_path(*control, trial);
  if (!planned) return tl::unexpected(planned.error());
  const safety::Limits limits = limits_of(trial, *planned);
  auto gate = safety::Gate::create(limits, planar.robot.robot, planar.home, sample_time);
  if (!gate) return tl::unexpected(gate.error());
  return Plan{limits, std::move(*schedule), std::move(*control), std::move(*sequence), std::move(*gate)};
}

Result<Rehearsal> rehearse(const Trial& trial) {
  auto plan = make_plan(trial);
  if (!plan) return tl::unexpected(plan.error());
  auto robot = laboratory::SimulatedDevice::create(trial.scenario);
  if (!robot) return tl::unexpected(robot.error());
  Rehearsal rehearsal;
  realtime::BoundedRing<journal::Tick> ring(4096);
  std::atomic<bool> over{false};
  Peaks peaks(rehearsal, trial);
  std::vector<journal::Tick> ticks(1024);  // here, as no exception may leave the thread
  std::thread looking([&] {
    for (bool last = false; !last;) {
      last = over;
      for (std::size_t came = 1; came > 0;) {
        came = ring.pop(ticks.data(), ticks.size());
        for (std::size_t i = 0; i < came; ++i) peaks.add(ticks[i]);
      }
      if (!last) std::this_thread::yield();
    }
  });
  realtime::VirtualClock clock(1.0 / trial.scenario.rate.value);
  Signals signals;
  LoopTimes times;
  run_loop(**robot, plan->sequence, plan->gate, clock, ring, signals, times);
  over = true;
  looking.join();
  rehearsal.trip = plan->gate.trip();
  return rehearsal;
}

std::string plan_text(const Trial& trial, const Plan& plan, const Rehearsal& rehearsal) {
  const safety::Limits& limits = plan.limits;
  const double perturbation = plan.schedule.duration();
  std::string text = fmt::format("{}{}{}\n", trial.protocol, trial.name.empty() ? "" : ", trial " + trial.name,
                                 trial.scenario.condition.empty() ? "" : ": " + trial.scenario.condition);
  text += fmt::format(
      "  in all        {:.1f} s: soft start {:g} s, way to the test location, {:g} s of rest,\n"
      "                perturbation {:.1f} s, way back, soft stop {:g} s\n",
      rehearsal.duration, trial.sequence.soft_start, trial.sequence.settle, perturbation, trial.sequence.soft_start);
  text += report::schedule_text(plan.schedule);
  text += "  peaks in a rehearsal on the simulated robot, and the gate's limits\n";
  text += limit_line("force of the motors at the handle", rehearsal.handle_force, limits.handle_force, "N");
  text += limit_line("torque of joint 1", rehearsal.joint_torque[0], limits.joint_torque[0], "N·m");
  text += limit_line("torque of joint 2", rehearsal.joint_torque[1], limits.joint_torque[1], "N·m");
  text += limit_line("measured force", rehearsal.measured_force, limits.measured_force, "N");
  text += limit_line("speed of the hand", 1e3 * rehearsal.speed, 1e3 * limits.speed, "mm/s");
  if (limits.excursion > 0.0) {
    text += limit_line("way from the test location", 1e3 * rehearsal.excursion, 1e3 * limits.excursion, "mm");
  }
  if (rehearsal.trip.reason != safety::Reason::none) {
    text += fmt::format("  the rehearsal ended in a safety stop: {}\n", safety::sentence(rehearsal.trip));
  }
  return text;
}

}  // namespace mbk::session
