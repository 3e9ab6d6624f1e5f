#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/lti/rational.h"
#include "mbk/base/numeric/random.h"
#include "mbk/experiment/control/passivity_control.h"
#include "mbk/simulate/laboratory/axis_loads.h"
#include "mbk/simulate/laboratory/closed_loop.h"
#include "mbk/simulate/laboratory/simulate_teleoperation.h"
#include "mbk/simulate/participant/load.h"
#include "mbk/teleop/llewellyn.h"
#include "mbk/teleop/sampled.h"
#include "mbk/teleop/worst_terminations.h"
#include "mbk/validate/each_run.h"
#include "mbk/validate/robot_trials.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/simulated_trials.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace {

using laboratory::MassSpringDamper;
using laboratory::TeleoperationSetup;
using numeric::Random;
using teleop::Architecture;
using teleop::Port;
using teleop::Rational;
using teleop::Teleoperator;

constexpr std::array kArchitectures = {Architecture::position_position, Architecture::position_force,
                                       Architecture::three_channel, Architecture::four_channel};
constexpr double kSamplingPeriod = 1e-3;  // [s]
constexpr Port kOperator = Port::one;

double log_uniform(Random& random, double low, double high) {
  return low * std::pow(high / low, random.uniform());
}

/// Of three digits, so that the fractions stay short.
Rational rounded(double value) {
  return Rational(static_cast<long>(std::lround(1e3 * value)), 1000);
}

Teleoperator random_design(Architecture architecture, Random& random) {
  Teleoperator design;
  design.architecture = architecture;
  const auto set = [&](const char* name, double value) {
    if (teleop::need(architecture, name) != teleop::Need::none) design.values[name] = rounded(value);
  };
  for (const std::string robot : {"master", "slave"}) {
    set((robot + ".m").c_str(), random.uniform(0.3, 1.5));
    set((robot + ".b").c_str(), log_uniform(random, 1.0, 20.0));
    set((robot + ".d").c_str(), log_uniform(random, 5.0, 40.0));
    set((robot + ".k").c_str(), log_uniform(random, 20.0, 600.0));
    set((robot + ".local_force_gain").c_str(), random.uniform(0.0, 0.5));
  }
  set("channels.force_to_master", random.uniform(0.0, 0.9));
  set("channels.force_to_slave", random.uniform(0.0, 0.9));
  if (random.uniform() < 0.5) {
    set("delay.to_slave", kSamplingPeriod * static_cast<double>(1 + random.below(20)));
    set("delay.to_master", kSamplingPeriod * static_cast<double>(1 + random.below(20)));
  }
  return design;
}

/// A mass, a damper and a spring, each there or not: passive.
Termination random_passive(Random& random) {
  Termination passive;
  if (random.uniform() < 0.7) passive.mass = log_uniform(random, 0.01, 10.0);
  if (random.uniform() < 0.5) passive.damping = log_uniform(random, 0.1, 100.0);
  if (random.uniform() < 0.7) passive.stiffness = log_uniform(random, 1.0, 1e4);
  return passive;
}

/// What became of one construction.
struct Shown {
  bool grew = false;
  double expected_frequency = 0.0, frequency = 0.0;  ///< [rad/s]
  double expected_growth = 0.0, growth = 0.0;        ///< [1/s]
  std::optional<bool> grew_with_controller;          ///< passivity controller at the master
};

/// One design and one operator.
struct Case {
  bool stable = false, stable_sampled = false;  ///< as the criterion says
  int simulated = 0, grew = 0;                  ///< random terminations of a stable one
  int hard = 0, grew_hard = 0;                  ///< the hardest of a stable one
  int grew_sampled = 0;                         ///< of both, those that grow at 1 kHz only
  int late = 0, grew_late = 0;                  ///< the same over a line that loses packets
  std::optional<Shown> shown;                   ///< of one that is not
};

Result<laboratory::MotionVerdict> simulated(const TeleoperationSetup& setup, const std::array<Termination, 2>& ports) {
  MassSpringDamper hand(ports[0].mass, ports[0].damping, ports[0].stiffness),
      environment(ports[1].mass, ports[1].damping, ports[1].stiffness);
  const auto motion = MBK_TRY(laboratory::simulate(setup, hand, environment));
  laboratory::MotionVerdict verdict = laboratory::judge(motion);
  return verdict;
}

bool grows(const laboratory::MotionVerdict& verdict) {
  return verdict.outcome == MotionOutcome::grows;
}

/// What would grow if the operator lacked a little more than the design bears, with an operator who lacks a: the
/// hardest that a stable design can meet. None where no termination at all is too much.
Result<std::optional<WorstTerminations>> hardest(const Teleoperator& design, double a) {
  constexpr double kMore = 0.2;  // [N·s/m]
  constexpr int kPoints = 500;
  const FrequencyGrid grid{RadPerSec(1.0), laboratory::highest_shown(kSamplingPeriod), kPoints};
  const auto largest = MBK_TRY(teleop::largest_shortage_on_grid(design, grid, kOperator));
  const double beyond = std::max(a, largest.value()) + kMore;
  const auto exact = lti::exact(beyond);
  if (!exact) return std::nullopt;
  const auto too_much = MBK_TRY(teleop::llewellyn_on_grid(design, grid, kOperator, *exact, kSamplingPeriod));
  auto worst = teleop::worst_terminations(
      design, teleop::violated_frequencies(too_much, laboratory::highest_shown(kSamplingPeriod)), kSamplingPeriod,
      kOperator, beyond);
  if (worst) worst->at_port[0].damping += beyond - a;
  return worst;
}

/// Two random terminations, the operator's with −a more damping.
std::array<Termination, 2> random_pair(Random& random, double a) {
  std::array<Termination, 2> pair = {random_passive(random), random_passive(random)};
  pair[0].damping -= a;
  return pair;
}

/// Whether a stable design grows. What grows at 1 kHz and not at 8 kHz is the sampling's: a criterion on a grid up to
/// the Nyquist frequency leaves out what is folded down from above it.
Result<void> try_pair(const TeleoperationSetup& setup, const std::array<Termination, 2>& pair, int& grew,
                      int& grew_sampled) {
  auto verdict = simulated(setup, pair);
  if (!verdict) return tl::unexpected(verdict.error());
  if (!grows(*verdict)) return {};
  constexpr double kFaster = 8.0;
  TeleoperationSetup faster = setup;
  faster.sample_time = setup.sample_time / kFaster;
  faster.steps_per_tick = 1;
  verdict = simulated(faster, pair);
  if (!verdict) return tl::unexpected(verdict.error());
  ++(grows(*verdict) ? grew : grew_sampled);
  return {};
}

Result<void> try_stable(const TeleoperationSetup& setup, double a, Random& random, Case& result) {
  constexpr int kPairs = 3;
  for (int i = 0; i < kPairs; ++i) {
    const auto pair = random_pair(random, a);
    ++result.simulated;
    MBK_TRY(try_pair(setup, pair, result.grew, result.grew_sampled));
    TeleoperationSetup losing = setup;
    losing.line.loss = 0.1;
    losing.line.jitter = 5e-3;
    const auto late = MBK_TRY(simulated(losing, pair));
    ++result.late;
    result.grew_late += grows(late) ? 1 : 0;
  }
  const auto hard = MBK_TRY(hardest(setup.teleoperator, a));
  if (!hard) return {};
  ++result.hard;
  // a quarter of the time must hold several of its turns
  constexpr double kTurns = 20.0;
  TeleoperationSetup longer = setup;
  longer.duration = std::max(setup.duration, kTurns * 2.0 * std::numbers::pi / hard->frequency.value);
  return try_pair(longer, hard->at_port, result.grew_hard, result.grew_sampled);
}

Result<std::optional<Shown>> show(TeleoperationSetup setup, const AbsoluteStability& stability, double a) {
  const auto worst = teleop::worst_terminations(
      setup.teleoperator, teleop::violated_frequencies(stability, laboratory::highest_shown(kSamplingPeriod)),
      kSamplingPeriod, kOperator, a);
  // what needs longer than is simulated is too near the boundary to be seen on either side of it
  constexpr double kSlowest = 0.16;  // [1/s]
  if (!worst || worst->growth < kSlowest) return std::nullopt;
  setup.duration = laboratory::duration_to_show(*worst);
  const auto verdict = MBK_TRY(simulated(setup, worst->at_port));
  Shown shown{grows(verdict), worst->frequency.value, verdict.frequency.value, worst->growth, verdict.growth, {}};
  if (a == 0.0) {
    setup.passivity_controller = 0.5 * lti::to_double(setup.teleoperator.values.at("master.m")) / kSamplingPeriod;
    const auto controlled = MBK_TRY(simulated(setup, worst->at_port));
    shown.grew_with_controller = grows(controlled);
  }
  return std::optional(shown);
}

Result<Case> perform(const Teleoperator& design, double a, Random& random) {
  const auto exact = MBK_TRY(lti::exact(a));
  const auto network = MBK_TRY(design.equations().with_shortage(kOperator, teleop::Polynomial{exact}).at(0));
  const AbsoluteStability decided = teleop::llewellyn(network);
  constexpr int kPoints = 1000;
  const FrequencyGrid grid{RadPerSec(1e-2), RadPerSec(std::numbers::pi / kSamplingPeriod), kPoints};
  const auto sampled = MBK_TRY(teleop::llewellyn_on_grid(design, grid, kOperator, exact, kSamplingPeriod));

  Case result{decided.holds(), sampled.holds()};
  TeleoperationSetup setup;
  setup.teleoperator = design;
  setup.sample_time = kSamplingPeriod;
  if (result.stable && result.stable_sampled) {
    MBK_TRY(try_stable(setup, a, random, result));
    return result;
  }
  auto shown = MBK_TRY(show(setup, result.stable ? sampled : decided, a));
  result.shown = shown;
  return result;
}

/// Who holds the master.
struct Operator {
  const char* name;
  double lowest, highest;  ///< a [N·s/m]
};
constexpr std::array kOperators = {Operator{"passive operator", 0.0, 0.0},
                                   Operator{"operator with an excess of 1 to 8 N·s/m", -8.0, -1.0},
                                   Operator{"operator with a shortage of 0.1 to 3 N·s/m", 0.1, 3.0}};

using Cases = std::vector<Case>;

/// Numbers of the cases that meet a condition.
struct Counted {
  int cases = 0, grew = 0;
};

Counted count(const Cases& cases, const std::function<bool(const Case&)>& which) {
  Counted counted;
  for (const Case& one : cases) {
    if (!which(one) || !one.shown) continue;
    ++counted.cases;
    counted.grew += one.shown->grew ? 1 : 0;
  }
  return counted;
}

/// What the criterion excludes: hardly ever by its share, and by the count of these cases never.
void add_excluded(const std::string& what, int value, int of, ValidationTable& table) {
  table.rows.push_back(share_row(what, value, of, kHardlyEver));
  table.rows.push_back(exact_row(what + ": cases", value, Range{0.0, 0.0}, fmt::format("of {}", of)));
}

ValidationRow count_row(std::string what, int value, int of) {
  return exact_row(std::move(what), value, {}, fmt::format("of {}", of));
}

void add_rows(const Operator& who, const Cases& cases, ValidationTable& table) {
  int simulated = 0, grew = 0, hard = 0, grew_hard = 0, grew_sampled = 0, late = 0, grew_late = 0, unseen = 0;
  for (const Case& one : cases) {
    simulated += one.simulated;
    grew += one.grew;
    hard += one.hard;
    grew_hard += one.grew_hard;
    grew_sampled += one.grew_sampled;
    late += one.late;
    grew_late += one.grew_late;
    unseen += !one.stable && !one.shown ? 1 : 0;
  }
  const std::string start = fmt::format("{}: ", who.name);
  add_excluded(start + "stable, random terminations that grew", grew, simulated, table);
  add_excluded(start + "stable, hardest terminations that grew", grew_hard, hard, table);
  table.rows.push_back(
      count_row(start + "stable, any of these that grew at 1 kHz and not at 8", grew_sampled, simulated + hard));
  const Counted unstable = count(cases, [](const Case& one) { return !one.stable; });
  add_excluded(start + "not stable, constructed terminations that did not grow", unstable.cases - unstable.grew,
               unstable.cases, table);
  constexpr double kSameFrequency = 5.0;  // [%]
  int elsewhere = 0;
  double furthest = 0.0;
  for (const Case& one : cases) {
    if (one.stable || !one.shown || !one.shown->grew) continue;
    const double distance = 100.0 * std::abs(one.shown->frequency / one.shown->expected_frequency - 1.0);
    elsewhere += distance > kSameFrequency ? 1 : 0;
    furthest = std::max(furthest, distance);
  }
  add_excluded(start + fmt::format("not stable, grew further than {:g} % from the violated frequency", kSameFrequency),
               elsewhere, unstable.grew, table);
  table.rows.push_back(
      exact_row(start + "not stable, largest distance from the violated frequency", furthest, {}, "%"));
  table.rows.push_back(
      count_row(start + "not stable, nothing to construct below 62.5 Hz or too slow", unseen, unstable.cases + unseen));
  const Counted by_sampling = count(cases, [](const Case& one) { return one.stable && !one.stable_sampled; });
  table.rows.push_back(count_row(start + "stable but for the sampling, constructed terminations that grew",
                                 by_sampling.grew, by_sampling.cases));
  table.rows.push_back(
      count_row(start + "stable, over a line with 10 % loss and 5 ms of jitter, grew", grew_late, late));
}

void add_controlled(const Cases& cases, ValidationTable& table) {
  int controlled = 0, grew = 0;
  for (const Case& one : cases) {
    if (!one.shown || !one.shown->grew_with_controller) continue;
    ++controlled;
    grew += *one.shown->grew_with_controller ? 1 : 0;
  }
  table.rows.push_back(count_row("constructed terminations that grow in spite of a passivity controller at the master",
                                 grew, controlled));
}

/// A hand that pushes with a constant force [N].
class Push : public participant::Load<1> {
 public:
  explicit Push(double force) : force_(force) {}
  [[nodiscard]] participant::LoadDynamics<1> dynamics(const participant::HandState<1>& /*hand*/) const override {
    return {AxisMatrix<1>::Zero(), AxisVector<1>(-force_), 0.0};
  }
  [[nodiscard]] impedance::Model impedance(const AxisVector<1>& /*position*/) const override { return {}; }

 private:
  double force_;
};

/// The lowest energy of a virtual wall of 30 kN/m against which a device is pushed [J].
Result<double> wall_energy(bool with_controller) {
  constexpr double kWall = 30e3, kMass = 0.8, kDamping = 0.2, kPush = 2.0, kStart = -0.02, kDuration = 3.0;
  Push hand(kPush);
  laboratory::ClosedLoop<1>::Options device;
  device.robot.inertia.mass = kMass;
  device.robot.friction[0].viscous = kDamping;
  device.steps_per_tick = 4;
  auto loop = MBK_TRY(laboratory::ClosedLoop<1>::create(device, AxisVector<1>(kStart), hand));
  auto controller = MBK_TRY(control::SeriesPassivityController::create(kSamplingPeriod, 0.5 * kMass / kSamplingPeriod));
  control::PassivityObserver observer;
  double lowest = 0.0;
  while (loop.time() <= kDuration) {
    const double x = loop.motor_angle()[0], asked = x > 0.0 ? kWall * x : 0.0;
    const double force = with_controller ? controller.step(x, asked) : asked;
    observer.step(x, force);
    lowest = std::min(lowest, observer.energy());
    loop.hold(AxisVector<1>(-force), kSamplingPeriod);
    loop.advance();
  }
  return lowest;
}

Result<void> add_wall(ValidationTable& table) {
  constexpr double kLastDigit = 0.0005;  // [J]
  for (const auto& [with, known] : {std::pair{false, -0.237}, {true, -0.007}}) {
    const auto energy = MBK_TRY(wall_energy(with));
    table.rows.push_back(exact_row(
        fmt::format("wall of 30 kN/m at 1 kHz, lowest energy {} passivity controller", with ? "with" : "without"),
        energy, Range{known - kLastDigit, known + kLastDigit}, "J"));
  }
  return {};
}

Chart growth_chart(const std::vector<Cases>& of_operators) {
  Chart chart = identified_against_true("Growth of constructed oscillations", "1/s");
  chart.x.label = "expected, log10";
  chart.y.label = "simulated, log10";
  for (std::size_t k = 0; k < of_operators.size(); ++k) {
    ChartSeries series{kOperators[k].name, {}, {}, {}, ChartSeries::Drawn::marks};
    for (const Case& one : of_operators[k]) {
      if (!one.shown || !one.shown->grew) continue;
      series.x.push_back(std::log10(one.shown->expected_growth));
      series.y.push_back(std::log10(one.shown->growth));
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

}  // namespace

Result<ValidationTable> teleoperation_study(const StudyOptions& options) {
  if (options.runs < 1) return no_runs(options.runs);
  constexpr int kDesigns = static_cast<int>(kArchitectures.size());
  const int designs = kDesigns * options.runs;
  const auto ran = MBK_TRY(each_run(options, designs, [&](int i) -> Result<Cases> {
    Random random(options.seed, static_cast<std::uint32_t>(i));
    const Teleoperator design =
        random_design(kArchitectures[static_cast<std::size_t>(i) % kArchitectures.size()], random);
    Cases of_design;
    for (const auto& with : kOperators) {
      const double a = lti::to_double(rounded(random.uniform(with.lowest, with.highest)));
      auto one = MBK_TRY(perform(design, a, random));
      of_design.push_back(one);
    }
    return of_design;
  }));
  std::vector<Cases> of_operators(kOperators.size());
  for (const Cases& of_design : ran) {
    for (std::size_t k = 0; k < kOperators.size(); ++k) of_operators[k].push_back(of_design[k]);
  }

  ValidationTable table{"teleoperation",
                        "do simulated teleoperators behave as Llewellyn's and the modified criterion predict?", "value",
                        options.runs, options.seed};
  for (std::size_t k = 0; k < kOperators.size(); ++k) add_rows(kOperators[k], of_operators[k], table);
  add_controlled(of_operators.front(), table);
  MBK_TRY(add_wall(table));
  table.charts.push_back(growth_chart(of_operators));
  table.notes.emplace_back(
      "Random designs of position–position, position–force, three and four channels, half of them with 1 to 20 ms of "
      "delay each way; robots of 0.3 to 1.5 kg; controllers at 1 kHz whose forces are held. Stable means: by the exact "
      "criterion, with delays by Padé of order 2, and on a grid with the sampling and true delays up to 500 Hz.");
  table.notes.emplace_back(
      "Random terminations are masses, dampers and springs, each there or not, the operator's with −a of damping more. "
      "Constructed ones: mbk/teleop/worst_terminations.h; the hardest for a stable design are those that would grow if "
      "the "
      "operator lacked 0.2 N·s/m more than the design bears. What grows at 1 kHz and not at 8 is not held against a "
      "criterion: what sampling folds down from above 500 Hz is in none of them. It grows where the speed of the last "
      "quarter of the time "
      "is "
      "twice that of the second.");
  table.notes.emplace_back(
      "The wall: a device of 0.8 kg and 0.2 N·s/m is pushed with 2 N from rest 20 mm ahead of it, for 3 s; the "
      "controller adds 400 N·s/m at most.");
  return table;
}

}  // namespace mbk::validation
