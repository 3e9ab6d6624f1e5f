#include "mbk/experiment/console/live_estimate.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <new>
#include <string>

#include "mbk/experiment/session/plan.h"
#include "mbk/experiment/session/session.h"
#include "mbk/simulate/laboratory/simulation.h"

namespace mbk::console {
namespace live_estimate_test {

using protocol::read_experiment;
using protocol::Trial;
using session::header_of;
using session::make_plan;
using session::Session;

constexpr const char* kExperiment = R"(
[robot]
handle_mass_kg = 0.194
[control]
kind = "position"
[perturbation]
kind = "multisine"
duration_s = 14
moving_in_s = 2
[participant]
kind = "arm"
number = 1
)";

/// The journal of a whole trial.
journal::Journal recorded(const std::string& experiment = kExperiment) {
  const Trial trial = read_experiment(experiment, "experiment.toml", laboratory::read_simulation).value().front();
  const auto robot = laboratory::simulated_robot(trial).value();
  const auto plan = make_plan(trial).value();
  journal::Journal journal{header_of(plan, robot->facts()), {}, {}, {}};
  const auto target = std::filesystem::temp_directory_path() / fmt::format("mbk_live_estimate_{}.h5", getpid());
  std::filesystem::remove(target);
  Session session({true, 0.0});
  const auto outcome = session.perform(*robot, plan, target, [&](std::span<const journal::Tick> ticks) {
    journal.ticks.insert(journal.ticks.end(), ticks.begin(), ticks.end());
  });
  EXPECT_TRUE(outcome) << outcome.error().line();
  std::filesystem::remove(target);
  return journal;
}

/// As far as it had come `seconds` after the perturbation began.
journal::Journal until(journal::Journal journal, double seconds) {
  journal.ticks.erase(
      std::ranges::find_if(journal.ticks, [&](const journal::Tick& tick) { return tick.perturbation_time > seconds; }),
      journal.ticks.end());
  return journal;
}

measurement::Options with_handle() {
  measurement::Options options;
  options.identify.handle_mass = 0.194;
  options.passivity = false;
  return options;
}

bool warns_of(const Measurement& measured, WarningCode code) {
  return std::ranges::count(measured.identification.warnings, code, &Warning::code) > 0;
}

TEST(LiveEstimate, MissedTicksAreBridgedAndSaid) {
  journal::Journal journal = recorded();
  const measurement::Options options = with_handle();
  const auto whole = estimate(journal, options);
  ASSERT_TRUE(whole) << whole.error().line();
  EXPECT_FALSE(warns_of(*whole, WarningCode::resampled));

  std::size_t k = 0;
  std::erase_if(journal.ticks, [&](const journal::Tick&) { return ++k % 1000 < 3; });  // two in a thousand
  std::uint64_t number = 0;
  for (journal::Tick& tick : journal.ticks) tick.number = number++;  // they were never made: none is lost
  const auto with_gaps = estimate(journal, options);
  ASSERT_TRUE(with_gaps) << with_gaps.error().line();
  EXPECT_TRUE(warns_of(*with_gaps, WarningCode::resampled));
  const Identification &one = whole->identification, &other = with_gaps->identification;
  // what is bridged is far shorter than the fastest motion: a small part of the doubt that there is anyway
  for (Index i : {0, 1}) {
    for (Index j : {0, 1}) {
      EXPECT_NEAR(other.model.K(i, j), one.model.K(i, j), 0.2 * one.standard_error.K(i, j));
      EXPECT_NEAR(other.model.M(i, j), one.model.M(i, j), 0.2 * one.standard_error.M(i, j));
    }
  }
}

constexpr const char* kForAWhile = R"(
[robot]
handle_mass_kg = 0.194
[control]
kind = "position"
[perturbation]
kind = "multisine"
duration_s = 40
moving_in_s = 2
[participant]
kind = "linear"
mass_kg = [[1.3, -0.9], [-0.9, 1.9]]
damping_Ns_per_m = [[5.8, -2.1], [-2.1, 10.6]]
stiffness_N_per_m = [[42, -29], [-29, 125]]
)";

TEST(LiveEstimate, AStiffnessThatTriplesIsFollowedWithinFiveSeconds) {
  const journal::Journal steady = recorded(kForAWhile);
  const auto before = estimate_now(steady, with_handle());
  ASSERT_TRUE(before) << before.error().line();
  EXPECT_EQ(before->from, 0.0);
  EXPECT_FALSE(warns_of(before->measured, WarningCode::stiffness_changes));
  const Matrix K = before->measured.identification.model.K;

  const journal::Journal changed = recorded(std::string(kForAWhile) + R"(
[[participant.stiffness_at]]
time_s = 22
factor = 1
[[participant.stiffness_at]]
time_s = 22.1
factor = 3
)");
  const auto change = std::ranges::find_if(changed.ticks, [](const journal::Tick& tick) { return tick.time >= 22.1; });
  ASSERT_NE(change, changed.ticks.end());
  const double at = change->perturbation_time;
  for (double later : {5.0, 10.0, 15.0}) {
    const auto now = estimate_now(until(changed, at + later), with_handle());
    ASSERT_TRUE(now) << now.error().line();
    EXPECT_TRUE(warns_of(now->measured, WarningCode::stiffness_changes)) << later;
    EXPECT_NEAR(now->from, at + later - 5.0, 0.1);
    for (Index i : {0, 1}) {
      EXPECT_NEAR(now->measured.identification.model.K(i, i), 3.0 * K(i, i), 0.2 * 3.0 * K(i, i)) << later;
    }
  }
}

TEST(LiveEstimate, ADampingThatGrowsIsFollowedWithinFiveSeconds) {
  constexpr double kFactor = 2.5, kTruth = 10.56;
  const journal::Journal changed = recorded(std::string(kForAWhile) + R"(
[[participant.stiffness_at]]
time_s = 22
factor = 1
[[participant.stiffness_at]]
time_s = 22.1
factor = 1
damping_factor = 2.5
)");
  const auto change = std::ranges::find_if(changed.ticks, [](const journal::Tick& tick) { return tick.time >= 22.1; });
  ASSERT_NE(change, changed.ticks.end());
  const double at = change->perturbation_time;
  for (double later : {5.0, 10.0, 15.0}) {
    const auto now = estimate_now(until(changed, at + later), with_handle());
    ASSERT_TRUE(now) << now.error().line();
    EXPECT_TRUE(warns_of(now->measured, WarningCode::damping_changes)) << later;
    EXPECT_NEAR(now->from, at + later - 5.0, 0.1);
    EXPECT_NEAR(now->measured.identification.model.B(1, 1), kFactor * kTruth, 0.2 * kFactor * kTruth) << later;
  }
}

TEST(LiveEstimate, AnExceptionIsShownAndEndsNothing) {
  const journal::Journal journal = recorded();
  std::vector<std::string> why;
  LiveEstimate live([&](const LiveEstimate::Estimate& estimate) {
    if (estimate.measured) throw std::bad_alloc();  // as the console's own text of it may
    why.push_back(estimate.measured.error().line());
  });
  for (int trial = 0; trial < 2; ++trial) {
    live.begin(journal.header, {});
    live.add(journal.ticks);
    live.finish();
  }
  ASSERT_GE(why.size(), 2U);
  EXPECT_NE(why.back().find("bad_alloc"), std::string::npos) << why.back();

  LiveEstimate hopeless([](const LiveEstimate::Estimate&) { throw 3; });
  hopeless.begin(journal.header, {});
  hopeless.add(journal.ticks);
  hopeless.finish();
}

TEST(LiveEstimate, WaitsForThePerturbation) {
  journal::Journal journal = recorded();
  std::erase_if(journal.ticks, [](const journal::Tick& tick) { return tick.perturbing(); });
  const auto nothing = estimate(journal, {});
  ASSERT_FALSE(nothing);
  EXPECT_NE(nothing.error().line().find("perturb"), std::string::npos);
}

}  // namespace live_estimate_test
}  // namespace mbk::console
