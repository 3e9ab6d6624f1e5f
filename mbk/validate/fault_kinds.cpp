#include "mbk/validate/fault_kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "mbk/experiment/control/trial_control.h"
#include "mbk/model/robot/workspace.h"
#include "mbk/validate/fault_words.h"

namespace mbk::validation {
namespace {

using device::Command;
using device::State;
using numeric::Random;
using Make = std::function<void(FaultRun&, Random&)>;

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

/// The gains of the whole trial, as an experiment file sets them.
void set_gains(FaultRun& run, const std::function<void(control::JointPositionControl::Gains&)>& change) {
  if (auto* position = std::get_if<control::PositionMode>(&run.trial.control)) change(position->gains);
  change(run.trial.sequence.hold);
}

/// What the robot reads and reports of itself.
constexpr std::array kFields = {
    MBK_FAULT_FIELD(State, "time", time),           MBK_FAULT_FIELD(State, "answered", answered),
    MBK_FAULT_FIELD(State, "motors", motors),       MBK_FAULT_FIELD(State, "stop", stop),
    MBK_FAULT_FIELD(State, "has_force", has_force), MBK_FAULT_FIELD(State, "watchdog_expired", watchdog_expired),
    MBK_FAULT_FIELD(State, "fault", fault)};

double safety::Limits::*limit_of(const std::string& name) {
  static const std::map<std::string_view, double safety::Limits::*> kLimits = {
      {"speed", &safety::Limits::speed},
      {"acceleration", &safety::Limits::acceleration},
      {"excursion", &safety::Limits::excursion},
      {"joint_margin", &safety::Limits::joint_margin},
      {"tracking", &safety::Limits::tracking},
      {"measured_force", &safety::Limits::measured_force},
      {"max_saturation_time", &safety::Limits::max_saturation_time}};
  return kLimits.at(name);
}

Make reads(const Change<State>& change) {
  return [=](FaultRun& run, Random&) {
    run.fault.reading = [=](State& state, int k) mutable {
      change(state, k);
      return true;
    };
  };
}

Make drives(const std::function<bool(Command&, int k)>& change) {
  return [=](FaultRun& run, Random&) { run.fault.driving = change; };
}

/// Verbs, beside those of fault_words.h. V and A..B may be followed by those of a trial of forces.
const std::map<std::string_view, std::function<Make(const Statement&)>>& verbs() {
  static const std::map<std::string_view, std::function<Make(const Statement&)>> kVerbs = {
      {"unreadable",
       [](const Statement&) -> Make {
         return [](FaultRun& run, Random&) { run.fault.reading = [](State&, int) { return false; }; };
       }},
      {"unwritable",  // and the robot's own watch over its link switches off
       [](const Statement&) { return drives([](Command& command, int) { return command.enabled = false; }); }},
      {"silent",
       [](const Statement&) {
         return reads([last = State()](State& state, int k) mutable {
           if (k == 0) last = state;
           state = last;
         });
       }},
      {"stall_clock",  // A..B ticks
       [](const Statement& one) -> Make {
         return [span = one.span(1)](FaultRun& run, Random& random) {
           run.outside = Outside::stalled_clock;
           run.stall = static_cast<std::uint64_t>(span.drawn_whole(random));
         };
       }},
      {"operator_stop",
       [](const Statement&) -> Make { return [](FaultRun& run, Random&) { run.outside = Outside::operator_stop; }; }},
      {"stall_recorder",
       [](const Statement&) -> Make {
         return [](FaultRun& run, Random&) { run.outside = Outside::stalled_recorder; };
       }},
      {"hold_torque",  // that of the first tick
       [](const Statement&) {
         return drives([held = Vector2d(0.0, 0.0)](Command& command, int k) mutable {
           held = command.torque = k == 0 ? command.torque : held;
           command.enabled = true;
           return true;
         });
       }},
      {"torque",  // A..B: times a factor
       [](const Statement& one) -> Make {
         const Span position = one.span(1), force = one.span(one.words.size() - 1);
         return [=](FaultRun& run, Random& random) {
           const double factor = (run.kind == TrialKind::position ? position : force).drawn(random);
           run.fault.driving = [=](Command& command, int) {
             command.torque *= factor;
             return true;
           };
         };
       }},
      {"undamped_gains",  // A..B: the proportional ones times a factor, no damping
       [](const Statement& one) -> Make {
         return [span = one.span(1)](FaultRun& run, Random& random) {
           set_gains(run, [gain = span.drawn(random)](control::JointPositionControl::Gains& gains) {
             gains.proportional *= gain;
             gains.derivative.setZero();
           });
         };
       }},
      {"damping",  // A..B: times a factor
       [](const Statement& one) -> Make {
         return [span = one.span(1)](FaultRun& run, Random& random) {
           set_gains(run, [gain = span.drawn(random)](control::JointPositionControl::Gains& gains) {
             gains.derivative *= gain;
           });
         };
       }},
      {"limit",  // NAME V: that limit is met before all others
       [](const Statement& one) -> Make {
         return [limit = limit_of(one.word(1)), position = one.number(2), force = one.number(one.words.size() - 1)](
                    FaultRun& run, Random&) { only(run).*limit = run.kind == TrialKind::position ? position : force; };
       }},
      {"workspace",  // V: within so much of the home position [m]
       [](const Statement& one) -> Make {
         return [reach = one.number(1)](FaultRun& run, Random&) {
           safety::Limits& limits = only(run);
           limits.workspace_low = run.trial.home - Vector2d(reach, reach);
           limits.workspace_high = run.trial.home + Vector2d(reach, reach);
         };
       }},
      {"push",  // A..B C..D: a force [N] that rises so long [s]
       [](const Statement& one) -> Make {
         return [force = one.span(1), rise = one.span(2)](FaultRun& run, Random& random) {
           push(run, force.drawn(random) * direction_by_lot(random), rise.drawn(random));
         };
       }},
      {"push_to_joint_limits",  // V W
       [](const Statement& one) -> Make {
         return [force = one.number(1), rise = one.number(2)](FaultRun& run, Random&) {
           push(run, force * towards_joint_limits(run.trial), rise);
         };
       }},
      {"knock",  // A..B [N]
       [](const Statement& one) -> Make {
         return [span = one.span(1)](FaultRun& run, Random& random) {
           const Vector2d force = span.drawn(random) * direction_by_lot(random);
           run.fault.push = [=](int k) {
             return Vector2d(k < 20 ? std::sin(std::numbers::pi * (k + 0.5) / 20.0) * force : Vector2d(0.0, 0.0));
           };
         };
       }},
  };
  return kVerbs;
}

Make make_of(const Statement& one) {
  if (one.is_assignment()) return reads(assignment<State>(one, kFields));
  if (const auto channel = channel_fault(one)) {
    return [channel = *channel](FaultRun& run, Random& random) { reads(channel(random))(run, random); };
  }
  return verbs().at(one.word(0))(one);
}

}  // namespace

const std::vector<FaultKind>& fault_kinds() {
  static const std::vector<FaultKind> kKinds = [] {
    const config::Document document = fault_table("faults");
    const config::Section words = document.root().section("words");
    std::vector<FaultKind> all;
    for (const config::Section& row : document.root().section("faults").sections("rows")) {
      FaultKind kind;
      kind.name = row.required_text("name");
      kind.onset = row.required_choice<Onset>("onset");
      const Vector2d within = row.required_vector2("within");
      kind.detection = {static_cast<int>(within[0]), static_cast<int>(within[1])};
      kind.reasons = reasons_of(with_words(row.required_text("reasons"), words));
      std::vector<Make> parts;
      for (const Statement& one : statements_of(row.required_text("does"))) parts.push_back(make_of(one));
      kind.make = [parts, keeps_time = row.flag("keeps_time", false)](FaultRun& run, Random& random) {
        run.keeps_time = keeps_time;
        for (const Make& part : parts) part(run, random);
      };
      all.push_back(std::move(kind));
    }
    require_read(document);
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
