#include "mbk/experiment/session/plan.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <atomic>
#include <thread>

#include "mbk/base/core/units.h"
#include "mbk/experiment/session/loop.h"
#include "mbk/model/robot/workspace.h"

namespace mbk::session {
namespace {

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
safety::Limits limits_of(const protocol::Trial& trial, const PlannedMotion& planned) {
  constexpr double kMore = 1.5, kMoreSpeed = 0.05, kMoreWay = 0.015, kTracking = 4.0 * kDegree;  // [1, m/s, m, rad]
  safety::Limits limits = trial.limits;
  if (!std::holds_alternative<control::PositionMode>(trial.control)) return limits;
  const double speed = std::max(planned.speed, trial.sequence.move_speed);
  if (trial.from_plan.speed) limits.speed = std::min(limits.speed, kMore * speed + kMoreSpeed);
  if (trial.from_plan.excursion) limits.excursion = std::min(limits.excursion, kMore * planned.excursion + kMoreWay);
  if (trial.from_plan.tracking) limits.tracking = std::min(limits.tracking, kTracking);
  return limits;
}

/// What the schedule asks of a hand that follows it.
Result<PlannedMotion> check_path(const control::TrialControl& control, const protocol::Trial& trial) {
  const safety::Limits& limits = trial.limits;
  PlannedMotion planned;
  const robot::Geometry& geometry = trial.robot.geometry;
  const Eigen::Vector2d home = trial.home;
  const double step = 1.0 / trial.rate.value;
  const auto ticks = static_cast<int>(control.schedule().duration() / step);
  Eigen::Vector2d last = control.place(0.0);
  for (int i = 0; i <= ticks; ++i) {
    const double t = i * step;
    const Eigen::Vector2d hand = control.place(t);
    if (limits.excursion > 0.0) {
      if (auto ok =
              within("the distance from home", (hand - home).norm(), limits.excursion, 1e3, "mm", "excursion_mm", t);
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
    const auto angles = MBK_TRY(robot::check_hand(geometry, hand));
    const double margin = robot::margin(geometry.limits, angles);
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
  Peaks(Rehearsal& rehearsal, const protocol::Trial& trial)
      : rehearsal_(rehearsal),
        geometry_(trial.robot.geometry),
        home_(trial.home),
        span_(static_cast<double>(kSpeedTicks) / trial.rate.value) {}

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

}  // namespace

Result<safety::Gate> Plan::gate() const {
  return safety::Gate::create(limits, trial.robot, trial.home, sample_time());
}

Result<Plan> make_plan(protocol::Trial trial) {
  auto schedule = MBK_TRY(perturbation::make_schedule(trial.perturbation, trial.seed));
  const robot::Geometry& geometry = trial.robot.geometry;
  const double sample_time = 1.0 / trial.rate.value;
  auto control = control::TrialControl::create(trial.control, schedule, geometry, trial.home, sample_time);
  if (!control) return tl::unexpected(control.error());
  auto sequence = MBK_TRY(control::Sequencer::create(*control, trial.sequence, geometry, sample_time));
  MBK_TRY(safety::check(trial.limits));
  if (schedule.quantity() == perturbation::Quantity::force) {
    const perturbation::Facts facts = schedule.facts();
    if (auto ok =
            within("the force", facts.peak, trial.limits.handle_force, 1.0, "N", "handle_force_N", facts.peak_time);
        !ok) {
      return tl::unexpected(ok.error());
    }
  }
  const auto planned = MBK_TRY(check_path(*control, trial));
  const safety::Limits limits = limits_of(trial, planned);
  Plan plan{std::move(trial), limits, std::move(schedule), std::move(sequence)};
  MBK_TRY(plan.gate());
  return plan;
}

Result<Rehearsal> rehearse(const Plan& plan) {
  const protocol::Trial& trial = plan.trial;
  if (!trial.simulation) return bad_usage("this robot has no simulation to rehearse with", "run the trial itself");
  auto robot = MBK_TRY(trial.simulation->robot(trial));
  auto gate = MBK_TRY(plan.gate());
  control::Sequencer sequence = plan.sequence;
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
  realtime::VirtualClock clock(plan.sample_time());
  LoopFlags flags;
  LoopTimes times;
  run_loop(*robot, sequence, gate, clock, ring, flags, times);
  over = true;
  looking.join();
  rehearsal.trip = gate.trip();
  return rehearsal;
}

}  // namespace mbk::session
