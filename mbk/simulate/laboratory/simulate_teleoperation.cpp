#include "mbk/simulate/laboratory/simulate_teleoperation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <variant>

#include "mbk/base/lti/rational.h"
#include "mbk/experiment/control/passivity_control.h"
#include "mbk/simulate/laboratory/axis_loads.h"
#include "mbk/simulate/laboratory/closed_loop.h"
#include "mbk/simulate/participant/arm.h"
#include "mbk/teleop/sampled.h"
#include "mbk/teleop/worst_terminations.h"

namespace mbk::laboratory {
namespace {

/// The motor command from a reading: k x + d ẋ + m ẍ + g f.
struct Gains {
  double position = 0.0, velocity = 0.0, acceleration = 0.0, force = 0.0;

  [[nodiscard]] double of(const Packet& reading) const {
    return position * reading.position + velocity * reading.velocity + acceleration * reading.acceleration +
           force * reading.force;
  }
};

struct Robot {
  double mass = 0.0, damping = 0.0;
  Gains own, other;  ///< of its own reading, and of what the line brings
};

double coefficient(const teleop::ParametricPolynomial& p, std::size_t power) {
  const auto& c = p.coefficients();
  return power < c.size() ? lti::to_double(c[power](0)) : 0.0;
}

double value(const teleop::Teleoperator& teleoperator, std::string_view name) {
  const auto found = teleoperator.values.find(name);
  return found == teleoperator.values.end() ? 0.0 : lti::to_double(found->second);
}

/// From its equation, which is g f + (k + d s + m s²)/s v, times s, of the four variables.
Robot robot(const teleop::Teleoperator& teleoperator, std::size_t which) {
  const auto row = teleoperator.without_delay().rows[which];
  const auto gains = [&](std::size_t effort) {
    const auto &force = row[effort], &motion = row[effort + 2];
    return Gains{coefficient(motion, 0), coefficient(motion, 1), coefficient(motion, 2), coefficient(force, 1)};
  };
  const std::string name = which == 0 ? "master" : "slave";
  Robot result{value(teleoperator, name + ".m"), value(teleoperator, name + ".b"), gains(which), gains(1 - which)};
  // the robot itself moves physically: f − (m s + b) v is not a command
  result.own.force -= 1.0;
  result.own.velocity += result.damping;
  result.own.acceleration += result.mass;
  return result;
}

Packet packet(const ClosedLoop<1>& loop) {
  const TrueState<1> now = loop.state();
  return {now.position[0], now.velocity[0], now.acceleration[0], now.force_hand_on_robot[0]};
}

Result<void> check(const TeleoperationSetup& setup, const std::array<Robot, 2>& robots) {
  if (!(setup.sample_time > 0.0 && std::isfinite(setup.sample_time))) {
    return bad_usage(fmt::format("sample time {:g} s is not positive", setup.sample_time));
  }
  if (!(setup.duration >= setup.sample_time && std::isfinite(setup.duration))) {
    return bad_usage(fmt::format("a duration of {:g} s contains no sample", setup.duration));
  }
  if (!std::isfinite(setup.kick)) return bad_usage("the kick is not finite");
  for (const Robot& robot : robots) {
    if (robot.mass > 0.0 && robot.damping >= 0.0) continue;
    return bad_usage(fmt::format("a robot of {:g} kg and {:g} N·s/m cannot be simulated", robot.mass, robot.damping),
                     "give master and slave a positive mass_kg and a non-negative damping_N_s_per_m");
  }
  return {};
}

}  // namespace

Result<TeleoperationMotion> simulate(const TeleoperationSetup& setup, participant::Load<1>& hand,
                                     participant::Load<1>& environment) {
  const double T = setup.sample_time;
  const std::array<Robot, 2> robots = {robot(setup.teleoperator, 0), robot(setup.teleoperator, 1)};
  MBK_TRY(check(setup, robots));
  const auto loop_of = [&](const Robot& robot, participant::Load<1>& load) {
    ClosedLoop<1>::Options options;
    options.robot.inertia.mass = robot.mass;
    options.robot.friction[0].viscous = robot.damping;
    options.steps_per_tick = setup.steps_per_tick;
    return ClosedLoop<1>::create(options, AxisVector<1>(0.0), load);
  };
  auto master = MBK_TRY(loop_of(robots[0], hand));
  auto slave = MBK_TRY(loop_of(robots[1], environment));
  const auto line = [&](const char* delay, std::uint32_t stream) {
    PacketLineOptions options = setup.line;
    options.delay = value(setup.teleoperator, delay);
    return PacketLine::create(options, T, setup.seed, stream);
  };
  auto to_slave = MBK_TRY(line("delay.to_slave", 1));
  auto to_master = MBK_TRY(line("delay.to_master", 2));
  std::optional<control::SeriesPassivityController> controller;
  if (setup.passivity_controller) {
    controller = MBK_TRY(control::SeriesPassivityController::create(T, *setup.passivity_controller));
  }

  TeleoperationMotion motion;
  if (controller) motion.lowest_energy = 0.0;
  const auto ticks = static_cast<long>(std::lround(setup.duration / T));
  for (long n = 0; n < ticks; ++n) {
    const Packet at_master = packet(master), at_slave = packet(slave);
    motion.time.push_back(T * static_cast<double>(n));
    motion.master_position.push_back(at_master.position);
    motion.slave_position.push_back(at_slave.position);
    motion.master_velocity.push_back(at_master.velocity);
    motion.slave_velocity.push_back(at_slave.velocity);
    // written so that a position that is not finite counts as far away
    if (!(std::abs(at_master.position) < kFurthest && std::abs(at_slave.position) < kFurthest)) {
      motion.ran_away = true;
      break;
    }
    const double u_slave = robots[1].own.of(at_slave) + robots[1].other.of(to_slave.step(at_master));
    double u_master = robots[0].own.of(at_master) + robots[0].other.of(to_master.step(at_slave));
    if (controller) {
      u_master = -controller->step(at_master.position, -u_master);
      motion.lowest_energy = std::min(*motion.lowest_energy, controller->energy());
    }
    if (n == 0) u_master += setup.kick / T;
    master.hold(AxisVector<1>(u_master), T);
    slave.hold(AxisVector<1>(u_slave), T);
    master.advance();
    slave.advance();
  }
  motion.sent = to_slave.sent() + to_master.sent();
  motion.lost = to_slave.lost() + to_master.lost();
  return motion;
}

namespace {

/// Root mean square of both robots' speed over [from, to).
double speed(const TeleoperationMotion& motion, std::size_t from, std::size_t to) {
  double sum = 0.0;
  for (std::size_t i = from; i < to; ++i) {
    sum += motion.master_velocity[i] * motion.master_velocity[i] + motion.slave_velocity[i] * motion.slave_velocity[i];
  }
  return to > from ? std::sqrt(sum / static_cast<double>(to - from)) : 0.0;
}

/// From the times at which a signal changes sign, by linear interpolation.
RadPerSec swing(const std::vector<double>& time, const std::vector<double>& signal, std::size_t from) {
  std::vector<double> crossings;
  for (std::size_t i = std::max<std::size_t>(from, 1); i < signal.size(); ++i) {
    const double before = signal[i - 1], now = signal[i];
    if ((before < 0.0) == (now < 0.0)) continue;
    crossings.push_back(time[i - 1] + (time[i] - time[i - 1]) * before / (before - now));
  }
  if (crossings.size() < 3) return RadPerSec(0.0);
  return RadPerSec(std::numbers::pi * static_cast<double>(crossings.size() - 1) /
                   (crossings.back() - crossings.front()));
}

}  // namespace

MotionVerdict judge(const TeleoperationMotion& motion) {
  constexpr double kGrows = 2.0, kStill = 1e-9;  // the second: of the largest speed, no motion any more
  const std::size_t size = motion.time.size(), quarter = size / 4, last = 3 * quarter;
  MotionVerdict verdict;
  const double second = speed(motion, quarter, 2 * quarter), late = speed(motion, last, size);
  const double all = speed(motion, 0, size);
  verdict.ratio = late > kStill * all ? late / std::max(second, kStill * all) : 0.0;
  verdict.outcome = motion.ran_away || verdict.ratio > kGrows ? MotionOutcome::grows
                    : verdict.ratio < 1.0 / kGrows            ? MotionOutcome::dies_out
                                                              : MotionOutcome::bounded;
  if (verdict.ratio > 0.0) verdict.growth = std::log(verdict.ratio) / (motion.time[last] - motion.time[quarter]);
  const auto largest = [&](const std::vector<double>& velocity) {
    double most = 0.0;
    for (std::size_t i = last; i < size; ++i) most = std::max(most, std::abs(velocity[i]));
    return most;
  };
  const bool slave = largest(motion.slave_velocity) > largest(motion.master_velocity);
  verdict.frequency = swing(motion.time, slave ? motion.slave_velocity : motion.master_velocity, last);
  return verdict;
}

namespace {

using teleop::SimulatedArm;

std::string words(const Termination& termination) {
  return fmt::format("{:.4g} kg, {:.4g} N·s/m, {:.4g} N/m", termination.mass, termination.damping,
                     termination.stiffness);
}

/// An arm that holds a port, and what it is in words.
struct HeldBy {
  std::unique_ptr<participant::Arm> arm;  ///< that `load` leads along a line
  std::unique_ptr<participant::Load<1>> load;
  std::string words;
};

HeldBy held_by(const Termination& termination) {
  return {nullptr, std::make_unique<MassSpringDamper>(termination.mass, termination.damping, termination.stiffness),
          words(termination)};
}

Result<HeldBy> held_by(const SimulatedArm& arm, double sample_time, std::uint64_t seed) {
  if (arm.kind == SimulatedArm::Kind::impedance) return held_by(arm.impedance);
  const bool rigid = arm.kind == SimulatedArm::Kind::rigid;
  auto limb = MBK_TRY(participant::participant_limb(arm.participant));
  participant::ArmOptions options = rigid ? participant::rigid_arm_options() : participant::relaxed_arm_options();
  options.limb = limb;
  options.seed = seed;
  if (!rigid) options.remnant.floor = 0.0;  // whether a motion dies out is seen without noise only
  auto created = MBK_TRY(participant::Arm::create(options, sample_time));
  HeldBy held;
  held.arm = std::make_unique<participant::Arm>(std::move(created));
  held.load = std::make_unique<AlongLine>(*held.arm, limb.equilibrium, arm.direction);
  held.words = fmt::format("{} arm of participant {}, along {:g}°", rigid ? "rigid" : "relaxed", arm.participant,
                           arm.direction * 180.0 / std::numbers::pi);
  return held;
}

/// A few hundred points of both positions.
Chart positions(const TeleoperationMotion& motion, std::string title) {
  constexpr std::size_t kPoints = 2000;
  const std::size_t step = std::max<std::size_t>(1, motion.time.size() / kPoints);
  const auto series = [&](const char* name, const std::vector<double>& position) {
    ChartSeries drawn{name, {}, {}, {}, ChartSeries::Drawn::line};
    for (std::size_t i = 0; i < position.size(); i += step) {
      drawn.x.push_back(motion.time[i]);
      drawn.y.push_back(1e3 * position[i]);
    }
    return drawn;
  };
  Chart chart;
  chart.title = std::move(title);
  chart.x = {"time", "s"};
  chart.y = {"position", "mm"};
  chart.series = {series("master", motion.master_position), series("slave", motion.slave_position)};
  return chart;
}

double furthest(const TeleoperationMotion& motion) {
  double most = 0.0;
  for (const auto* positions : {&motion.master_position, &motion.slave_position}) {
    for (const double x : *positions) most = std::max(most, std::abs(x));
  }
  return most;
}

Result<TeleoperationRun> run(const TeleoperationSetup& setup, std::string what, const HeldBy& hand,
                             const HeldBy& environment) {
  const auto motion = MBK_TRY(simulate(setup, *hand.load, *environment.load));
  const MotionVerdict verdict = judge(motion);
  TeleoperationRun result;
  result.what = what;
  result.hand = hand.words;
  result.environment = environment.words;
  result.outcome = verdict.outcome;
  result.ratio = verdict.ratio;
  result.frequency = verdict.frequency;
  result.duration = setup.sample_time * static_cast<double>(motion.time.size());
  result.ran_away = motion.ran_away;
  result.largest_position = furthest(motion);
  result.sent = motion.sent;
  result.lost = motion.lost;
  result.lowest_energy = motion.lowest_energy;
  result.positions = positions(motion, "Simulated positions: " + what);
  return result;
}

/// Against the terminations that a violated condition gives, over as long as they need to show it.
Result<std::optional<TeleoperationRun>> run_against_worst(const TeleoperationSetup& setup,
                                                          const AbsoluteStability& stability, teleop::Port port,
                                                          double a, std::string what) {
  const auto worst = teleop::worst_terminations(
      setup.teleoperator, teleop::violated_frequencies(stability, highest_shown(setup.sample_time)), setup.sample_time,
      port, a);
  if (!worst) return std::nullopt;
  TeleoperationSetup longer = setup;
  longer.duration = duration_to_show(*worst);
  auto shown = MBK_TRY(run(longer, std::move(what), held_by(worst->at_port[0]), held_by(worst->at_port[1])));
  shown.worst = worst;
  return std::optional(std::move(shown));
}

}  // namespace

RadPerSec highest_shown(double sample_time) {
  return RadPerSec(0.125 * std::numbers::pi / sample_time);
}

double duration_to_show(const WorstTerminations& worst) {
  constexpr double kGrowths = 16.0, kShortest = 5.0, kLongest = 100.0;
  return std::clamp(kGrowths / worst.growth, kShortest, kLongest);
}

Result<TeleoperationSimulation> simulate(const teleop::Design& design, std::optional<double> a,
                                         const std::function<void(double)>& progress) {
  if (!design.is_architecture()) {
    return bad_usage("a design given as [two_port] has no robots to simulate", "write an [architecture]");
  }
  const teleop::SimulationPlan& plan = design.simulation;
  TeleoperationSetup setup;
  setup.teleoperator = std::get<teleop::Teleoperator>(design.network);
  setup.sample_time = plan.sample_time;
  setup.duration = plan.duration;
  setup.kick = plan.kick;
  setup.line = {0.0, plan.jitter, plan.loss, plan.zero_on_loss ? OnLoss::zero : OnLoss::hold};
  setup.seed = plan.seed;
  setup.passivity_controller = plan.passivity_controller;

  TeleoperationSimulation simulation;
  simulation.sample_time = plan.sample_time;
  constexpr int kPoints = 3000;
  constexpr double kLowest = 1e-2;  // [rad/s]
  simulation.grid = {RadPerSec(kLowest), RadPerSec(std::numbers::pi / plan.sample_time), kPoints};
  const auto sampled = [&](double shortage) -> Result<AbsoluteStability> {
    const auto exact = MBK_TRY(lti::exact(shortage));
    return teleop::llewellyn_on_grid(setup.teleoperator, simulation.grid, design.operator_port, exact,
                                     plan.sample_time);
  };
  if (auto passive = sampled(0.0)) {
    simulation.sampled = std::move(*passive);
  } else {
    simulation.notes.push_back("the sampled-data criterion was not evaluated: " + passive.error().message);
  }
  if (a && simulation.sampled) {
    simulation.sampled_with_operator = MBK_TRY(sampled(*a));
  }

  const auto therapist = MBK_TRY(held_by(plan.therapist, plan.sample_time, plan.seed));
  const auto patient = MBK_TRY(held_by(plan.patient, plan.sample_time, plan.seed + 1));
  auto arms = MBK_TRY(run(setup, "the two arms", therapist, patient));
  simulation.runs.push_back(std::move(arms));
  if (progress) progress(0.5);

  const auto add_worst = [&](const std::optional<AbsoluteStability>& stability, double shortage,
                             const char* what) -> Result<void> {
    if (!stability || stability->holds()) return {};
    auto worst = MBK_TRY(run_against_worst(setup, *stability, design.operator_port, shortage, what));
    if (worst) {
      simulation.runs.push_back(std::move(*worst));
    } else {
      simulation.notes.push_back(
          fmt::format("{}: none was constructed, because only a pole or frequencies above {:.4g} rad/s violate the "
                      "condition, which a controller of {:g} Hz cannot reproduce",
                      what, highest_shown(plan.sample_time).value, 1.0 / plan.sample_time));
    }
    return {};
  };
  MBK_TRY(add_worst(simulation.sampled, 0.0, "the worst passive pair"));
  if (a) {
    MBK_TRY(add_worst(simulation.sampled_with_operator, *a, "the worst pair with that operator"));
  }
  if (progress) progress(1.0);
  return simulation;
}

}  // namespace mbk::laboratory
