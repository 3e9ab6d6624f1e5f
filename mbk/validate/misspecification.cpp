#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <ranges>
#include <string>
#include <utility>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/identify/impedance_fit.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/simulated_trials.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace {

using laboratory::PlanarTrial;
using laboratory::Scenario;
using participant::ArmOptions;

PlanarTrial& planar(Scenario& scenario) {
  return std::get<PlanarTrial>(scenario.trial);
}

ArmOptions& arm(Scenario& scenario) {
  return std::get<ArmOptions>(planar(scenario).load);
}

laboratory::LoadCellOptions<2>& cell(Scenario& scenario) {
  return std::get<laboratory::LoadCellOptions<2>>(planar(scenario).sensors.force);
}

participant::Departures::Options& departures(Scenario& scenario) {
  auto& options = arm(scenario).departures;
  if (!options) options.emplace();
  return *options;
}

perturbation::MultisinePlan& sines(Scenario& scenario) {
  return std::get<perturbation::MultisinePlan>(scenario.perturbation.kind);
}

perturbation::PulseSchedule::Options& train(Scenario& scenario) {
  return std::get<perturbation::PulsePlan>(scenario.perturbation.kind).pulses;
}

/// The same multisine, `speed` times as fast and `size` times as far.
std::function<void(Scenario&)> faster(double speed, double size) {
  return [speed, size](Scenario& s) {
    sines(s).period /= speed;
    sines(s).peak *= size;
  };
}

/// What mbk should do about a condition.
enum class Expected {
  silence,  ///< M, B and K hold: no warning of what they take for granted
  warning,  ///< they do not, and the recording shows it
  nothing,  ///< they do not, and one recording cannot show it, or seldom: only what is found is told
};

/// One way in which a recording comes about.
struct Misspecification {
  std::string name, scenario;
  Expected expected;
  std::function<void(Scenario&)> change = [](Scenario&) {};
};

void stiffness_changes(Scenario& scenario, std::vector<participant::StiffnessAt> schedule) {
  arm(scenario).stiffness_schedule = std::move(schedule);
}

/// ± `amplitude` at a frequency [Hz], by straight lines.
std::vector<participant::StiffnessAt> wave(double amplitude, double frequency, double duration) {
  std::vector<participant::StiffnessAt> schedule;
  for (double t = 0.0; t < duration; t += 0.05 / frequency) {
    schedule.push_back({t, 1.0 + amplitude * std::sin(2.0 * std::numbers::pi * frequency * t)});
  }
  return schedule;
}

std::vector<Misspecification> honest() {
  using enum Expected;
  const std::string sine = "relaxed_sinusoidal", pulses = "relaxed_underdamped";
  const auto shoulder = [](double x, double y) {
    return [x, y](Scenario& s) {
      auto& limb = std::get<participant::TwoLinkArm::Options>(arm(s).limb);
      limb.geometry.shoulder = limb.equilibrium + Eigen::Vector2d(x, y);
    };
  };
  const auto pauses = [](double shortest, double longest) {
    return [shortest, longest](Scenario& s) {
      train(s).shortest_pause = shortest;
      train(s).longest_pause = longest;
      train(s).quiet = 2.0;
    };
  };
  std::vector<Misspecification> list = {
      {"multisine", sine, silence},
      {"pulses", pulses, silence},
      {"multisine up to 2 Hz", "relaxed_virtual_sensor", silence},
      {"white force noise of 0.1 N", sine, silence, [](Scenario& s) { cell(s).white_noise = 0.1; }},
      {"white force noise of 0.1 N, pulses", pulses, silence, [](Scenario& s) { cell(s).white_noise = 0.1; }},
      {"slow force noise of 0.1 N", sine, silence,
       [](Scenario& s) {
         cell(s).coloured_noise = 0.1;
         cell(s).coloured_bandwidth = Hertz(0.1);
       }},
      {"force in steps of 0.05 N", sine, silence, [](Scenario& s) { cell(s).resolution = 0.05; }},
      {"position in steps of 20 µm", sine, silence,
       [](Scenario& s) { planar(s).sensors.encoder_resolution = 20e-6 / 0.254; }},
      {"remnant of 0.3 N", sine, silence, [](Scenario& s) { arm(s).remnant.floor = 0.3; }},
      {"2000 Hz", sine, silence, [](Scenario& s) { s.rate = Hertz(2000.0); }},
      {"500 Hz", sine, silence, [](Scenario& s) { s.rate = Hertz(500.0); }},
      {"200 Hz", sine, silence, [](Scenario& s) { s.rate = Hertz(200.0); }},
      {"35 s", sine, silence, [](Scenario& s) { sines(s).duration = 35.0; }},
      {"springs and a mass", "rig_table_5_1", silence},
      {"springs and a mass, pulses", "rig_table_3_1", silence},
      {"shoulder 40 cm behind the hand", sine, silence, shoulder(0.0, -0.40)},
      {"shoulder 58 cm behind the hand", sine, silence, shoulder(0.0, -0.58)},
      {"shoulder 20 cm to the left", sine, silence, shoulder(-0.20, -0.48)},
      {"shoulder 20 cm to the right", sine, silence, shoulder(0.20, -0.48)},
      {"shoulder 40 cm behind the hand, pulses", pulses, silence, shoulder(0.0, -0.40)},
      {"shoulder 20 cm to the left, pulses", pulses, silence, shoulder(-0.20, -0.48)},
      {"half as fast", sine, silence, faster(0.5, 1.0)},
      {"twice as fast, half as far", sine, silence, faster(2.0, 0.5)},
      {"four times as fast, a quarter as far", sine, silence, faster(4.0, 0.25)},
      {"interleaved lines up to 10 Hz", sine, silence,
       [](Scenario& s) {
         sines(s).harmonics = {10, 13, 23, 30, 41, 51, 63, 72, 89, 97};
         sines(s).axes = perturbation::MultisinePlan::Axes::interleaved;
       }},
      {"interleaved lines up to 3 Hz", sine, silence,
       [](Scenario& s) { sines(s).axes = perturbation::MultisinePlan::Axes::interleaved; }},
      {"pulses with pauses of 2 to 3 s", pulses, silence, pauses(2.0, 3.0)},
      {"pulses with pauses of 1 to 1.5 s", pulses, silence, pauses(1.0, 1.5)},
      {"pulses in 16 directions", pulses, silence, [](Scenario& s) { train(s).directions = 16; }},
      {"pulses of damping ratio 0.4", pulses, silence, [](Scenario& s) { train(s).damping_ratio = 0.4; }}};
  return list;
}

std::vector<Misspecification> broken() {
  using enum Expected;
  const std::string sine = "relaxed_sinusoidal", pulses = "relaxed_underdamped";
  const auto late = [](double delay) { return [delay](Scenario& s) { cell(s).delay = delay; }; };
  const auto reflex = [](double gain, double delay) {
    return [gain, delay](Scenario& s) {
      departures(s).reflex_gain = gain;
      departures(s).reflex_delay = delay;
    };
  };
  const auto grip = [](double stiffness) {
    return [stiffness](Scenario& s) { planar(s).grip = participant::GripOptions{.stiffness = stiffness}; };
  };
  const auto friction = [](double force) { return [force](Scenario& s) { departures(s).dry_friction = force; }; };
  const auto cubic = [](double k3) { return [k3](Scenario& s) { departures(s).cubic_stiffness = k3; }; };
  const auto tremor = [](double force, double hz) {
    return [force, hz](Scenario& s) {
      departures(s).tremor_force = force;
      departures(s).tremor_frequency = Hertz(hz);
    };
  };
  const auto stiffer = [](std::vector<participant::StiffnessAt> schedule) {
    return [schedule](Scenario& s) { stiffness_changes(s, schedule); };
  };
  const auto damped = stiffer;
  const auto turned = [](double degrees) {
    return [degrees](Scenario& s) {
      const double angle = degrees / kDegrees;
      cell(s).gain << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    };
  };
  const auto relaxing = [](double share) { return [share](Scenario& s) { departures(s).relaxing_share = share; }; };
  const auto one_sided = [](double share) { return [share](Scenario& s) { departures(s).one_sided_share = share; }; };
  std::vector<Misspecification> list = {
      {"both joints moved alike", sine, warning,
       [](Scenario& s) { sines(s).phases = perturbation::MultisinePlan::Phases::schroeder; }},
      {"moved along one line", sine, warning, perturb_along_a_diagonal},
      {"force late by 1 ms", sine, nothing, late(0.001)},
      {"force late by 3 ms", sine, nothing, late(0.003)},
      {"force late by 10 ms", sine, warning, late(0.010)},
      {"force late by 10 ms, pulses", pulses, nothing, late(0.010)},
      {"force late by 20 ms", sine, warning, late(0.020)},
      {"reflex of 30 N/m after 60 ms", sine, nothing, reflex(30.0, 0.060)},
      {"reflex of 60 N/m after 100 ms", sine, nothing, reflex(60.0, 0.100)},
      {"reflex of 60 N/m after 150 ms", sine, warning, reflex(60.0, 0.150)},
      {"reflex of 60 N/m after 150 ms, pulses", pulses, nothing, reflex(60.0, 0.150)},
      {"grip of 3 kN/m", sine, warning, grip(3000.0)},
      {"grip of 3 kN/m, pulses", pulses, nothing, grip(3000.0)},
      {"grip of 10 kN/m", sine, nothing, grip(10000.0)},
      {"dry friction of 0.5 N", sine, warning, friction(0.5)},
      {"dry friction of 0.5 N, pulses", pulses, nothing, friction(0.5)},
      {"dry friction of 0.2 N", sine, nothing, friction(0.2)},
      {"cubic stiffness of 10⁶ N/m³", sine, warning, cubic(1e6)},
      {"cubic stiffness of 10⁶ N/m³, pulses", pulses, nothing, cubic(1e6)},
      {"cubic stiffness of 2·10⁵ N/m³", sine, nothing, cubic(2e5)},
      {"tremor of 1 N at 4.5 Hz", sine, nothing, tremor(1.0, 4.5)},
      {"tremor of 1 N at 9 Hz", sine, nothing, tremor(1.0, 9.0)},
      {"tremor of 1 N at 9 Hz, pulses", pulses, nothing, tremor(1.0, 9.0)},
      {"stiffness × 1.5 from half time", sine, warning, stiffer({{30.0, 1.0}, {31.0, 1.5}})},
      {"stiffness × 3 from half time", sine, warning, stiffer({{30.0, 1.0}, {31.0, 3.0}})},
      {"stiffness × 5 for 10 s", sine, warning, stiffer({{30.0, 1.0}, {30.5, 5.0}, {40.0, 5.0}, {40.5, 1.0}})},
      {"stiffness ± 50 % at 0.1 Hz", sine, warning, stiffer(wave(0.5, 0.1, 70.0))},
      {"stiffness from 1 to 2 times", sine, warning, stiffer({{0.0, 1.0}, {62.0, 2.0}})},
      {"stiffness × 1.5 from half time, pulses", pulses, nothing, stiffer({{60.0, 1.0}, {61.0, 1.5}})},
      {"force zero drifting by 0.02 N/s", sine, warning, [](Scenario& s) { cell(s).drift_rate.setConstant(0.02); }},
      {"equilibrium drifting by 0.2 mm/s", sine, warning,
       [](Scenario& s) { departures(s).equilibrium_drift.setConstant(2e-4); }},
      {"force zero walking by 0.05 N/√s", sine, nothing, [](Scenario& s) { cell(s).drift_walk = 0.05; }},
      {"force off by 2 N", sine, nothing, [](Scenario& s) { cell(s).offset.setConstant(2.0); }},
      {"force gain 10 % too high", sine, nothing, [](Scenario& s) { cell(s).gain *= 1.1; }},
      {"5 % of crosstalk", sine, nothing, [](Scenario& s) { cell(s).gain << 1.0, 0.05, 0.05, 1.0; }},
      {"ticks that jitter by 5 %, times as planned", sine, nothing,
       [](Scenario& s) {
         planar(s).sensors.clock.jitter = 5e-5;
         planar(s).sensors.clock.timestamps = laboratory::ClockOptions::Timestamps::nominal;
       }},
      {"force turned by 4°", sine, warning, turned(4.0)},
      {"force turned by 12°", sine, warning, turned(12.0)},
      {"force turned by 12°, pulses", pulses, nothing, turned(12.0)},
      {"gain of one axis of the sensor 20 % too high", sine, nothing,
       [](Scenario& s) { cell(s).gain << 1.0, 0.0, 0.0, 1.2; }},
      {"damping × 2 from half time", sine, warning, damped({{30.0, 1.0, 1.0}, {31.0, 1.0, 2.0}})},
      {"damping × 2 from half time, pulses", pulses, nothing, damped({{60.0, 1.0, 1.0}, {61.0, 1.0, 2.0}})},
      {"three springs of 0.3 K behind dampers", sine, warning, relaxing(0.3)},
      {"three springs of 0.3 K behind dampers, pulses", pulses, nothing, relaxing(0.3)},
      {"stiffness × 1.6 on one side, × 0.4 on the other", sine, warning, one_sided(0.6)},
      {"stiffness × 1.6 on one side, × 0.4 on the other, pulses", pulses, nothing, one_sided(0.6)},
      {"twice as fast, as far", sine, nothing, faster(2.0, 1.0)},
      {"four times as fast, as far", sine, nothing, faster(4.0, 1.0)},
      {"rigid grasp, 6 N multisine", "rigid_sinusoidal_6N", warning},
      {"rigid grasp, 8 N pulses", "rigid_underdamped_8N", warning},
      {"rigid grasp, 2 N pulses", "rigid_underdamped_2N", warning}};
  return list;
}

/// Warnings of what M, B and K take for granted.
constexpr std::array kMisspecified = {WarningCode::missing_dynamics,     WarningCode::nonlinear_stiffness,
                                      WarningCode::dry_friction,         WarningCode::stiffness_changes,
                                      WarningCode::force_drifts,         WarningCode::tremor,
                                      WarningCode::damping_changes,      WarningCode::memory,
                                      WarningCode::even_nonlinearity,    WarningCode::lack_of_fit,
                                      WarningCode::inertia_not_symmetric};

/// What came of one trial under one condition.
struct MisspecifiedTrial {
  bool warned = false, usable = false;
  Vector error;  ///< of the stacked parameters
  Vector half;   ///< half widths of their intervals
  Vector truth;
};

Result<MisspecifiedTrial> trial_under(const Misspecification& condition, std::uint64_t seed) {
  auto scenarios = MBK_TRY(ready(condition.scenario));
  Scenario scenario = std::move(scenarios.front());
  scenario.seed = seed;
  condition.change(scenario);
  const auto performance = MBK_TRY(laboratory::simulate(scenario));
  measurement::Options options;
  options.passivity = false;
  const bool rig = std::holds_alternative<laboratory::RigPlan>(planar(scenario).load);
  if (rig) options.identify.structure = Structure::mass_spring;
  const auto measured = MBK_TRY(measurement::measure({&performance.recording, 1}, options));
  const Identification& id = measured.identification;
  MisspecifiedTrial outcome;
  outcome.usable = id.usable;
  // Of a person who responds, and of a limb that trembles, other warnings tell.
  constexpr std::array kOthers = {WarningCode::fit_poor, WarningCode::held_out_fit_poor,
                                  WarningCode::unmodelled_response, WarningCode::invalid_instruments};
  const auto tells = [&](const Warning& warning) {
    return std::ranges::count(kMisspecified, warning.code) > 0 ||
           (condition.expected != Expected::silence && std::ranges::count(kOthers, warning.code) > 0);
  };
  outcome.warned = !id.usable || std::ranges::any_of(id.warnings, tells);
  outcome.truth = impedance::stacked(performance.truth);
  outcome.error = impedance::stacked(id.model) - outcome.truth;
  outcome.half = numeric::kNormal95 * impedance::stacked(id.standard_error);
  return outcome;
}

/// Rows of one condition.
void add_rows(const Misspecification& condition, const std::vector<MisspecifiedTrial>& outcomes,
              ValidationTable& table) {
  std::optional<Range> expected;
  if (condition.expected == Expected::warning) expected = kNearlyAlways;
  if (condition.expected == Expected::silence) expected = kHardlyEver;
  table.rows.push_back(share_row(condition.name + ": warned", outcomes, &MisspecifiedTrial::warned, expected));
  // Each matrix, and the equilibrium: how many of its numbers the intervals hold, and how far they are off.
  constexpr std::array kParts = {"M", "B", "K", "x0"};
  for (std::size_t part = 0; part < kParts.size(); ++part) {
    const Index size = part < 3 ? 4 : 2;
    int held = 0, all = 0;
    Vector shares(static_cast<Index>(outcomes.size()));
    for (std::size_t k = 0; k < outcomes.size(); ++k) {
      const MisspecifiedTrial& one = outcomes[k];
      const Vector error = one.error.segment(static_cast<Index>(4 * part), size),
                   half = one.half.segment(static_cast<Index>(4 * part), size),
                   truth = one.truth.segment(static_cast<Index>(4 * part), size);
      held += static_cast<int>((error.array().abs() <= half.array()).count());
      all += static_cast<int>(size);
      shares[static_cast<Index>(k)] =
          part < 3 ? 100.0 * error.cwiseAbs().maxCoeff() / truth.cwiseAbs().maxCoeff() : kMillimetres * error.norm();
    }
    table.rows.push_back(share_row(fmt::format("{}: {} held", condition.name, kParts[part]), held, all, {}));
    table.rows.push_back(
        mean_row(fmt::format("{}: {} off", condition.name, kParts[part]), shares, {}, part < 3 ? "%" : "mm"));
  }
}

std::vector<Misspecification> all_conditions() {
  std::vector<Misspecification> conditions = honest();
  for (Misspecification& condition : broken()) conditions.push_back(std::move(condition));
  return conditions;
}

}  // namespace

Result<ValidationTable> misspecification_study(const StudyOptions& options, std::span<const std::string> only) {
  std::vector<Misspecification> conditions = all_conditions();
  for (const std::string& name : only) {
    if (std::ranges::count(conditions, name, &Misspecification::name) > 0) continue;
    const auto names = conditions | std::views::transform(&Misspecification::name);
    return bad_usage(fmt::format("'{}' is not a condition", name),
                     fmt::format("name one of: {}", fmt::join(names, "; ")));
  }
  if (!only.empty()) {
    std::erase_if(conditions, [&](const Misspecification& one) { return std::ranges::count(only, one.name) == 0; });
  }
  const auto runs = MBK_TRY(seeded_runs(options, [&](std::uint64_t seed) -> Result<std::vector<MisspecifiedTrial>> {
    std::vector<MisspecifiedTrial> outcomes;
    for (const Misspecification& condition : conditions) {
      auto outcome = trial_under(condition, seed);
      if (!outcome) return tl::unexpected(outcome.error().in(condition.name));
      outcomes.push_back(std::move(*outcome));
    }
    return outcomes;
  }));

  ValidationTable table{"misspecification", "does mbk warn where M, B and K are invalid, and not where they are valid?",
                        "% of the trials", options.runs, options.seed};
  for (std::size_t k = 0; k < conditions.size(); ++k) {
    std::vector<MisspecifiedTrial> outcomes;
    for (const std::vector<MisspecifiedTrial>& run : runs) outcomes.push_back(run[k]);
    add_rows(conditions[k], outcomes, table);
  }
  table.notes = {
      "'Warned' is a warning of what M, B and K take for granted (where they do not hold, also of a poor fit, of an "
      "unmodelled response or of instruments that do not hold), or a result that is not usable. 'Held' is the share of "
      "a "
      "matrix's numbers, of all trials, that its 95 % intervals hold; 'off' the largest error over the largest element "
      "of the matrix, or the distance of x0, on average.",
      "The truth is the limb's own impedance at the test location, its mean over the trial."};
  return table;
}

}  // namespace mbk::validation
