#include "mbk/experiment/console/live_estimate.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "mbk/base/numeric/statistics.h"
#include "mbk/base/system/temporary_folder.h"
#include "mbk/experiment/session/plan.h"
#include "mbk/experiment/session/session.h"
#include "mbk/measure/identify/impedance_fit.h"
#include "mbk/model/impedance/model.h"
#include "mbk/simulate/laboratory/make_load.h"
#include "mbk/simulate/laboratory/ready_scenarios.h"
#include "mbk/simulate/laboratory/simulation.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"

namespace mbk::validation {
namespace {

constexpr std::array kTimes = {10.0, 15.0, 20.0, 40.0};  // since the perturbation began [s]
constexpr double kJudgedFrom = 15.0;                     // what comes before is a limit that is stated [s]
constexpr Index kNumbers = 12;                           // of M, B and K

/// Which of the twelve intervals hold the truth, and whether the limb was said to have changed.
struct Shown {
  std::array<bool, kNumbers> held{};
  bool changed = false;
};

using ShownAtTimes = std::array<Shown, kTimes.size()>;  // at each time

Result<std::vector<protocol::Trial>> ready_trial() {
  const auto* scenario = laboratory::find_ready_scenario("relaxed_sinusoidal");
  if (scenario == nullptr) return bad_usage("there is no ready scenario 'relaxed_sinusoidal'");
  return protocol::read_experiment(scenario->text, "relaxed_sinusoidal.toml", laboratory::read_simulation);
}

Result<Shown> shown_of(const journal::Journal& journal, const measurement::Options& options, const Vector& truth) {
  const auto now = MBK_TRY(console::estimate_now(journal, options));
  const Identification& identification = now.measured.identification;
  const Vector error = impedance::stacked(identification.model) - truth;
  const Vector reach = numeric::kNormal95 * impedance::stacked(identification.standard_error);
  Shown shown;
  for (Index k = 0; k < kNumbers; ++k) shown.held[static_cast<std::size_t>(k)] = std::abs(error[k]) <= reach[k];
  shown.changed = now.from > 0.0;
  return shown;
}

Result<ShownAtTimes> perform(protocol::Trial trial, std::uint64_t seed, const std::filesystem::path& folder) {
  trial.seed = seed;
  auto robot = MBK_TRY(laboratory::simulated_robot(trial));
  const auto plan = MBK_TRY(session::make_plan(trial));
  const auto scenario = MBK_TRY(laboratory::scenario_of(trial));
  const auto load = MBK_TRY(laboratory::make_load(scenario, std::get<laboratory::PlanarTrial>(scenario.trial)));
  const Vector truth = impedance::stacked(load->impedance(trial.home));
  measurement::Options options;
  options.identify.handle_mass = trial.handle_mass;
  options.passivity = false;

  session::Session session({true, 0.0});
  journal::Journal journal{session::header_of(plan, robot->facts()), {}, {}, {}};
  ShownAtTimes held{};
  std::size_t taken = 0;
  std::optional<Error> failure;
  const auto watch = [&](std::span<const journal::Tick> ticks) {
    for (const journal::Tick& tick : ticks) {  // whichever of them come together
      if (taken == kTimes.size()) return;
      journal.ticks.push_back(tick);
      if (tick.perturbation_time < kTimes[taken]) continue;
      auto now = shown_of(journal, options, truth);
      if (!now) failure = now.error();
      if (now) held[taken] = *now;
      session.flags().end_trial = ++taken == kTimes.size();
    }
  };
  const auto performed = MBK_TRY(session.perform(*robot, plan, folder / fmt::format("{}.h5", seed), watch));
  std::error_code ignored;
  std::filesystem::remove(performed.recording, ignored);
  if (failure) return tl::unexpected(*failure);
  if (taken < kTimes.size())
    return bad_data(fmt::format("the trial of seed {} ended before {:g} s", seed, kTimes[taken]), "");
  return held;
}

}  // namespace

Result<ValidationTable> live_estimate_study(const StudyOptions& options) {
  const auto trials = MBK_TRY(ready_trial());
  const auto folder = MBK_TRY(TemporaryFolder::create("mbk-live-estimate"));
  const auto runs = MBK_TRY(seeded_runs(options, [&](std::uint64_t seed) -> Result<ShownAtTimes> {
    return perform(trials.front(), seed, folder.path());
  }));

  ValidationTable table{"live-estimate", "how often do the 95 % intervals contain the truth during the trial?", "%",
                        options.runs, options.seed};
  const auto count = static_cast<Index>(runs.size());
  const std::vector<std::string> names = identify::parameter_names(2);
  for (std::size_t at = 0; at < kTimes.size(); ++at) {
    Vector share = Vector::Zero(count);  // of the twelve, run by run: those of one run depend on each other
    std::vector<ValidationRow> rows;
    for (std::size_t k = 0; k < static_cast<std::size_t>(kNumbers); ++k) {
      int hits = 0;
      for (Index run = 0; run < count; ++run) {
        const bool one = runs[static_cast<std::size_t>(run)][at].held[k];
        hits += one ? 1 : 0;
        share[run] += one ? 100.0 / kNumbers : 0.0;
      }
      rows.push_back(share_row(fmt::format("{:g} s, {}", kTimes[at], names[k]), hits, options.runs, kNearNominal));
    }
    const std::optional<Range> expected = kTimes[at] >= kJudgedFrom ? std::optional(Range{90.0, 100.0}) : std::nullopt;
    table.rows.push_back(mean_row(fmt::format("{:g} s, mean of M, B and K", kTimes[at]), share, expected, "%"));
    std::ranges::move(rows, std::back_inserter(table.rows));
  }
  const auto said_to_change = [](const ShownAtTimes& held) { return std::ranges::any_of(held, &Shown::changed); };
  table.rows.push_back(share_row("said to have changed, though it did not", runs, said_to_change, kHardlyEver));
  table.notes = {
      "A relaxed arm, sinusoidal position perturbation, from the session's own ticks: the live estimate is what "
      "`mbk measure` would make of the perturbation so far, and of its last 5 s where they have another stiffness. "
      "Times count from the start of the perturbation.",
      "Shown but not judged: the mean after 10 s, when the intervals contain the truth in about nine of ten cases.",
      "The mean's interval takes runs as independent, not the twelve numbers of one run."};
  return table;
}

}  // namespace mbk::validation
