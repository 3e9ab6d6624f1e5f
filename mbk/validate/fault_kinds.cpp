#include "mbk/validate/fault_kinds.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "mbk/base/core/nan.h"
#include "mbk/experiment/control/trial_control.h"
#include "mbk/model/robot/workspace.h"

namespace mbk::validation {
namespace {

using device::Command;
using device::State;
using numeric::Random;
using safety::Reason;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

Vector2d direction(Random& random) {
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  return {std::cos(angle), std::sin(angle)};
}

double sign(Random& random) {
  return random.below(2) == 0 ? 1.0 : -1.0;
}

using Pair = Vector2d State::*;
using Make = std::function<void(FaultRun&, Random&)>;

/// One value of a pair, or both, becomes what `spoil` makes of it; `k` counts the ticks.
Make spoiled(std::function<void(State&, int k)> spoil) {
  return [spoil](FaultRun& run, Random&) {
    run.fault.reading = [spoil](State& state, int k) {
      spoil(state, k);
      return true;
    };
  };
}

Make frozen(Pair pair, int axis) {
  return [=](FaultRun& run, Random&) {
    run.fault.reading = [=, held = Vector2d(0.0, 0.0)](State& state, int k) mutable {
      if (k == 0) held = state.*pair;
      for (Eigen::Index i = 0; i < 2; ++i) {
        if (axis < 0 || i == axis) (state.*pair)[i] = held[i];
      }
      return true;
    };
  };
}

/// One axis, drawn by lot, gives this.
Make one_reads(Pair pair, double value) {
  return [=](FaultRun& run, Random& random) {
    const auto axis = static_cast<Eigen::Index>(random.below(2));
    run.fault.reading = [=](State& state, int) {
      (state.*pair)[axis] = value;
      return true;
    };
  };
}

/// The reading is off by so much in a direction drawn by lot; from `least` to `most`.
Make offset(Pair pair, double least, double most) {
  return [=](FaultRun& run, Random& random) {
    const Vector2d by = random.uniform(least, most) * direction(random);
    run.fault.reading = [=](State& state, int) {
      state.*pair += by;
      return true;
    };
  };
}

Make encoder_offset(double least, double most) {
  return [=](FaultRun& run, Random& random) {
    const auto axis = static_cast<Eigen::Index>(random.below(2));
    const double by = sign(random) * random.uniform(least, most);
    run.fault.reading = [=](State& state, int) {
      state.joint[axis] += by;
      return true;
    };
  };
}

/// The hand pushes with a force that grows to `force` [N] in `rise` [s] and stays.
void push(FaultRun& run, const Vector2d& force, double rise) {
  run.fault.push = [=](int k) { return Vector2d(std::min(1.0, (k + 1) * kTick / rise) * force); };
}

/// So that a push meets one limit before all others.
safety::Limits& only(FaultRun& run) {
  safety::Limits& limits = run.trial.limits;
  run.trial.from_plan = {};
  limits.measured_force = limits.force_jump = 1e3;
  limits.max_saturation_time = 10.0;
  limits.speed = 10.0;
  limits.acceleration = 1e3;
  limits.excursion = 0.0;
  limits.tracking = 3.0;
  limits.joint_margin = 0.0;
  return limits;
}

void push_hard(FaultRun& run, Random& random) {
  push(run, random.uniform(60.0, 80.0) * direction(random), random.uniform(0.05, 0.2));
}

/// The direction in which the joints come closest to their limits.
Vector2d towards_joint_limits(const protocol::Trial& trial) {
  const robot::Geometry& geometry = trial.robot.geometry;
  Vector2d worst(1.0, 0.0);
  double least = HUGE_VAL;
  for (int i = 0; i < 16; ++i) {
    const double angle = i * std::numbers::pi / 8.0;
    const Vector2d way(std::cos(angle), std::sin(angle));
    const auto joints = robot::joint_angles(geometry, trial.home + 0.04 * way);
    if (const double margin = joints ? robot::margin(geometry.limits, *joints) : HUGE_VAL; margin < least) {
      least = margin;
      worst = way;
    }
  }
  return worst;
}

std::vector<FaultKind> sensors() {
  const std::vector<Reason> stuck = {Reason::encoder_frozen, Reason::accelerometer_disagrees, Reason::tracking,
                                     Reason::limited_too_long, Reason::torque_disagrees};
  std::vector<FaultKind> kinds = {
      {"encoder 1 stands still", Onset::perturbing, {500, 2500}, stuck, frozen(&State::joint, 0)},
      {"encoder 2 stands still", Onset::perturbing, {500, 2500}, stuck, frozen(&State::joint, 1)},
      {"both encoders stand still", Onset::perturbing, {500, 2500}, stuck, frozen(&State::joint, -1)},
      {"force stands still",
       Onset::anywhere,
       {251, 251},
       {Reason::force_frozen, Reason::torque_disagrees},
       frozen(&State::force, -1)},
      {"acceleration stands still",
       Onset::anywhere,
       {251, 251},
       {Reason::accelerometer_frozen, Reason::accelerometer_disagrees},
       frozen(&State::acceleration, -1)},
      {"encoder gives a non-finite value",
       Onset::anywhere,
       {0, 0},
       {Reason::encoder_not_finite},
       one_reads(&State::joint, kNaN)},
      {"encoder gives infinity",
       Onset::anywhere,
       {0, 0},
       {Reason::encoder_not_finite},
       one_reads(&State::joint, kInfinite)},
      {"force gives a non-finite value",
       Onset::anywhere,
       {0, 0},
       {Reason::force_not_finite},
       one_reads(&State::force, kNaN)},
      {"force gives infinity",
       Onset::anywhere,
       {0, 0},
       {Reason::force_not_finite},
       one_reads(&State::force, -kInfinite)},
      {"acceleration gives a non-finite value",
       Onset::anywhere,
       {0, 0},
       {Reason::accelerometer_not_finite},
       one_reads(&State::acceleration, kNaN)},
      {"acceleration gives infinity",
       Onset::anywhere,
       {0, 0},
       {Reason::accelerometer_not_finite},
       one_reads(&State::acceleration, kInfinite)},
      {"encoder jumps", Onset::anywhere, {0, 0}, {Reason::encoder_jump}, encoder_offset(0.03, 1.0)},
      {"encoder falls to zero", Onset::anywhere, {0, 0}, {Reason::encoder_jump}, one_reads(&State::joint, 0.0)},
      {"encoder changes its sign", Onset::anywhere, {0, 0}, {Reason::encoder_jump}, spoiled([](State& state, int) {
         state.joint = -state.joint;
       })},
      {"force jumps",
       Onset::anywhere,
       {0, 0},
       {Reason::force_jump, Reason::measured_force},
       offset(&State::force, 30.0, 100.0)},
      {"force falls to zero",
       Onset::anywhere,
       {251, 251},
       {Reason::force_frozen, Reason::force_jump, Reason::torque_disagrees},
       spoiled([](State& state, int) { state.force.setZero(); })},
      {"acceleration jumps",
       Onset::anywhere,
       {41, 41},
       {Reason::accelerometer_disagrees},
       offset(&State::acceleration, 6.0, 60.0)},
      {"acceleration falls to zero",
       Onset::anywhere,
       {251, 251},
       {Reason::accelerometer_frozen, Reason::accelerometer_disagrees},
       spoiled([](State& state, int) { state.acceleration.setZero(); })},
      {"force drifts by 20 to 100 N/s",
       Onset::anywhere,
       {500, 500},
       {Reason::measured_force, Reason::torque_disagrees},
       [](FaultRun& run, Random& random) {
         const Vector2d rate = random.uniform(20.0, 100.0) * direction(random);
         run.fault.reading = [=](State& state, int k) {
           state.force += (k + 1) * kTick * rate;
           return true;
         };
       }},
      {"encoder counts backwards",
       Onset::moving,
       {1000, 7000},
       {Reason::tracking, Reason::limited_too_long, Reason::accelerometer_disagrees, Reason::speed,
        Reason::acceleration, Reason::excursion, Reason::encoder_jump, Reason::measured_force,
        Reason::torque_disagrees},
       [](FaultRun& run, Random& random) {
         const auto axis = static_cast<Eigen::Index>(random.below(2));
         run.fault.reading = [=, at = 0.0](State& state, int k) mutable {
           if (k == 0) at = state.joint[axis];
           state.joint[axis] = 2.0 * at - state.joint[axis];
           return true;
         };
       }},
  };
  return kinds;
}

std::vector<FaultKind> link_and_machine() {
  return {
      {"link cannot be read",
       Onset::anywhere,
       {0, 0},
       {Reason::link_lost},
       [](FaultRun& run, Random&) { run.fault.reading = [](State&, int) { return false; }; }},
      {"link cannot be written",
       Onset::anywhere,
       {1, 1},
       {Reason::link_lost},
       [](FaultRun& run, Random&) {
         run.fault.driving = [](Command& command, int) {
           command.enabled = false;  // the robot's own watch over its link
           return false;
         };
       }},
      {"robot falls silent",
       Onset::anywhere,
       {11, 11},
       {Reason::link_lost},
       [](FaultRun& run, Random&) {
         run.fault.reading = [last = State()](State& state, int k) mutable {
           if (k == 0) last = state;
           state = last;
           return true;
         };
       }},
      {"tick comes 21 to 500 ms late",
       Onset::anywhere,
       {1, 1},
       {Reason::late},
       [](FaultRun& run, Random& random) {
         run.outside = Outside::stalled_clock;
         run.stall = 21 + random.below(480);
       }},
      {"stop button", Onset::anywhere, {0, 0}, {Reason::stop_button}, spoiled([](State& state, int) {
         state.stop = true;
       })},
      {"operator's stop, another thread",
       Onset::anywhere,
       {1, 1},
       {Reason::operator_stop},
       [](FaultRun& run, Random&) { run.outside = Outside::operator_stop; }},
      {"recorder takes no more ticks",
       Onset::anywhere,
       {3074, 3074},
       {Reason::recording_failed},
       [](FaultRun& run, Random&) { run.outside = Outside::stalled_recorder; }},
  };
}

/// The robot reports this of itself.
Make reported(std::function<void(State&, int k)> spoil) {
  return [spoil](FaultRun& run, Random& random) {
    run.keeps_time = true;
    spoiled(spoil)(run, random);
  };
}

/// What the robot reports of itself, and what its drives do behind that.
std::vector<FaultKind> reports() {
  using device::Motors;
  return {
      {"robot reports a fault", Onset::anywhere, {0, 0}, {Reason::robot_fault}, reported([](State& state, int) {
         state.fault = 7;
       })},
      {"robot's watchdog has expired",
       Onset::anywhere,
       {0, 0},
       {Reason::robot_watchdog},
       reported([](State& state, int) { state.watchdog_expired = true; })},
      {"robot's clock stands still",
       Onset::anywhere,
       {1, 1},
       {Reason::robot_clock},
       reported([held = 0.0](State& state, int k) mutable { held = state.time = k == 0 ? state.time : held; })},
      {"robot's clock runs backward", Onset::anywhere, {1, 1}, {Reason::robot_clock}, reported([](State& state, int k) {
         state.time -= 2.0 * kTick * k;
       })},
      {"robot's clock gives a non-finite value",
       Onset::anywhere,
       {0, 0},
       {Reason::robot_clock},
       reported([](State& state, int) { state.time = kNaN; })},
      {"states get older by 0.1 ms each",
       Onset::anywhere,
       {230, 230},
       {Reason::state_old},
       reported([](State& state, int k) { state.time -= 0.1 * kTick * k; })},
      {"acknowledgement stands still",
       Onset::anywhere,
       {21, 21},
       {Reason::answer_late},
       reported([held = std::uint64_t{0}](State& state, int k) mutable {
         held = state.answered = k == 0 ? state.answered : held;
       })},
      {"acknowledges what was not sent",
       Onset::anywhere,
       {0, 0},
       {Reason::answer_wrong},
       reported([](State& state, int) { state.answered += 5; })},
      {"says that its motors are off",
       Onset::anywhere,
       {102, 102},
       {Reason::motors_off},
       reported([](State& state, int) { state.motors = Motors::off; })},
      {"says that its motors stay on", Onset::ending, {250, 250}, {Reason::motors_on}, reported([](State& state, int) {
         state.motors = Motors::on;
       })},
      {"force sensor is gone", Onset::anywhere, {0, 0}, {Reason::sensor_missing}, reported([](State& state, int) {
         state.has_force = false;
       })},
      {"drives hold the last torque, and say nothing",
       Onset::perturbing,
       {2500, 3500},
       {Reason::torque_disagrees, Reason::tracking, Reason::limited_too_long, Reason::excursion, Reason::speed},
       [](FaultRun& run, Random&) {
         run.keeps_time = true;
         run.fault.driving = [held = Vector2d(0.0, 0.0)](Command& command, int k) mutable {
           held = command.torque = k == 0 ? command.torque : held;
           command.enabled = true;
           return true;
         };
       }},
  };
}

/// The gains of the whole trial, as an experiment file sets them.
void set_gains(FaultRun& run, const std::function<void(control::JointPositionControl::Gains&)>& change) {
  if (auto* position = std::get_if<control::PositionMode>(&run.trial.control)) change(position->gains);
  change(run.trial.sequence.hold);
}

std::vector<FaultKind> runaways() {
  const std::vector<Reason> runs_away = {Reason::tracking,
                                         Reason::limited_too_long,
                                         Reason::speed,
                                         Reason::acceleration,
                                         Reason::excursion,
                                         Reason::measured_force,
                                         Reason::accelerometer_disagrees,
                                         Reason::encoder_jump,
                                         Reason::force_jump,
                                         Reason::torque_disagrees};
  return {
      {"motors pull the wrong way",
       Onset::moving,
       {1000, 7000},
       runs_away,
       [](FaultRun& run, Random&) {
         run.fault.driving = [](Command& command, int) {
           command.torque = -command.torque;
           return true;
         };
       }},
      {"motors pull the wrong way from the start",
       Onset::beginning,
       {2500, 2500},
       runs_away,
       [](FaultRun& run, Random&) {
         run.fault.driving = [](Command& command, int) {
           command.torque = -command.torque;
           return true;
         };
       }},
      {"motors far too strong",
       Onset::perturbing,
       {1500, 3500},
       runs_away,
       [](FaultRun& run, Random& random) {
         // a place is only held more stiffly by strong motors, until the loop is no longer stable
         const double gain = run.kind == TrialKind::position ? random.uniform(100.0, 300.0) : random.uniform(5.0, 20.0);
         run.fault.driving = [=](Command& command, int) {
           command.torque *= gain;
           return true;
         };
       }},
      {"gains far too high, no damping",
       Onset::beginning,
       {2500, 2500},
       runs_away,
       [](FaultRun& run, Random& random) {
         set_gains(run, [gain = random.uniform(150.0, 400.0)](control::JointPositionControl::Gains& gains) {
           gains.proportional *= gain;
           gains.derivative.setZero();
         });
       }},
      {"damping far too high",
       Onset::beginning,
       {2500, 2500},
       runs_away,
       [](FaultRun& run, Random& random) {
         set_gains(run, [gain = random.uniform(100.0, 300.0)](control::JointPositionControl::Gains& gains) {
           gains.derivative *= gain;
         });
       }},
  };
}

std::vector<FaultKind> pushes() {
  return {
      {"somebody pushes harder and harder",
       Onset::anywhere,
       {1500, 1500},
       {Reason::measured_force, Reason::excursion, Reason::tracking, Reason::limited_too_long, Reason::speed,
        Reason::acceleration, Reason::joint_margin},
       [](FaultRun& run, Random& random) { push(run, 300.0 * direction(random), random.uniform(0.75, 2.0)); }},
      {"a knock of 300 to 600 N",
       Onset::anywhere,
       {40, 40},
       {Reason::force_jump, Reason::measured_force, Reason::acceleration},
       [](FaultRun& run, Random& random) {
         const Vector2d force = random.uniform(300.0, 600.0) * direction(random);
         run.fault.push = [=](int k) {
           return Vector2d(k < 20 ? std::sin(std::numbers::pi * (k + 0.5) / 20.0) * force : Vector2d(0.0, 0.0));
         };
       }},
      {"hand too fast",
       Onset::moving,
       {500, 500},
       {Reason::speed},
       [](FaultRun& run, Random& random) {
         only(run).speed = 0.3;
         push_hard(run, random);
       }},
      {"hand too quickly faster",
       Onset::moving,
       {300, 300},
       {Reason::acceleration},
       [](FaultRun& run, Random& random) {
         only(run).acceleration = 6.0;
         push(run, random.uniform(40.0, 50.0) * direction(random), 0.01);
       }},
      {"hand away from its place",
       Onset::perturbing,
       {1000, 1000},
       {Reason::excursion},
       [](FaultRun& run, Random& random) {
         only(run).excursion = run.kind == TrialKind::position ? 0.04 : 0.08;
         push(run, random.uniform(110.0, 150.0) * direction(random), 0.2);
       }},
      {"hand out of the workspace",
       Onset::moving,
       {1000, 1000},
       {Reason::workspace},
       [](FaultRun& run, Random& random) {
         safety::Limits& limits = only(run);
         limits.workspace_low = run.trial.home - Vector2d(0.03, 0.03);
         limits.workspace_high = run.trial.home + Vector2d(0.03, 0.03);
         push_hard(run, random);
       }},
      {"joint close to its limit",
       Onset::moving,
       {1000, 1000},
       {Reason::joint_margin},
       [](FaultRun& run, Random&) {
         only(run).joint_margin = 0.42;
         push(run, 45.0 * towards_joint_limits(run.trial), 0.2);
       }},
      {"joint away from its reference",
       Onset::moving,
       {1000, -1},
       {Reason::tracking},
       [](FaultRun& run, Random& random) {
         only(run).tracking = 0.0873;
         push_hard(run, random);
       }},
      {"hand pushes more than it may",
       Onset::anywhere,
       {500, 500},
       {Reason::measured_force, Reason::joint_margin},
       [](FaultRun& run, Random& random) {
         only(run).measured_force = 40.0;
         push(run, random.uniform(150.0, 200.0) * direction(random), 0.05);
       }},
      {"controller beyond its limits",
       Onset::moving,
       {1000, -1},
       {Reason::limited_too_long, Reason::joint_margin},
       [](FaultRun& run, Random& random) {
         only(run).max_saturation_time = 0.1;
         push(run, random.uniform(35.0, 45.0) * direction(random), 0.2);
       }},
  };
}

}  // namespace

const std::vector<FaultKind>& fault_kinds() {
  static const std::vector<FaultKind> kKinds = [] {
    std::vector<FaultKind> all;
    for (const auto& some : {sensors(), link_and_machine(), reports(), runaways(), pushes()}) {
      all.insert(all.end(), some.begin(), some.end());
    }
    return all;
  }();
  return kKinds;
}

std::string fault_experiment(TrialKind kind, double perturbed, double moving_in, double peak_force) {
  constexpr std::string_view kPosition = R"(
[recording]
condition = "relaxed, position perturbation"
[robot]
coulomb_Nm = [0.114, 0.114]
handle_mass_kg = 0.194
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 2
duration_s = {:g}
moving_in_s = 1
[participant]
kind = "arm"
number = 1
[participant.remnant]
floor_N = 0.1
cutoff_hz = 1.5
)";
  constexpr std::string_view kForce = R"(
[recording]
condition = "rigid grasp, force perturbation"
[robot]
coulomb_Nm = [0.114, 0.114]
handle_mass_kg = 0.194
[control]
kind = "force"
[perturbation]
kind = "multisine"
peak_N = {:g}
duration_s = {:g}
moving_in_s = {:g}
[participant]
kind = "arm"
number = 1
[participant.correction]
position_gain = 1.4
delay_ms = 150
interval_ms = 280
threshold_mm = 1.5
[participant.cocontraction]
rest = 0.4
slope = 0.6
[participant.remnant]
floor_N = 0.15
per_force = 0.08
cutoff_hz = 1.5
)";
  return kind == TrialKind::position ? fmt::format(kPosition, perturbed)
                                     : fmt::format(kForce, peak_force, perturbed, moving_in);
}

}  // namespace mbk::validation
