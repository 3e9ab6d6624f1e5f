#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <utility>

#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/simulated_trials.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace {

using laboratory::Scenario;

/// A ready scenario, and how its arm is perturbed.
struct Drive {
  const char* name;
  const char* scenario;
  bool relaxed;  ///< the limb can only absorb energy; otherwise it gives some, by its voluntary controller
  void (*change)(Scenario&);
};

void as_it_is(Scenario& /*scenario*/) {}

void make_small(Scenario& scenario) {
  std::get<perturbation::MultisinePlan>(scenario.perturbation.kind).peak /= 8.0;
}

/// The joints at one frequency alone.
void make_sine(Scenario& scenario) {
  std::get<perturbation::MultisinePlan>(scenario.perturbation.kind).harmonics = {10};
}

constexpr std::array kDrives = {Drive{"multisine", "relaxed_sinusoidal", true, as_it_is},
                                Drive{"small multisine", "relaxed_sinusoidal", true, make_small},
                                Drive{"one sine", "relaxed_sinusoidal", true, make_sine},
                                Drive{"random binary", "relaxed_sinusoidal", true, perturb_along_a_diagonal},
                                Drive{"pulses", "relaxed_underdamped", true, as_it_is},
                                Drive{"2 N pulses", "rigid_underdamped_2N", false, as_it_is}};

/// What was said of one trial, and what is true.
struct Said {
  double absorbed = 0.0;         ///< by the limb [J], in truth
  bool trial_spoken = false;     ///< a statement on the trial is made at all
  Verdict trial{};               ///< by the energy
  std::optional<Verdict> model;  ///< predicted
};

using SaidInRun = std::array<Said, kDrives.size()>;

Result<Said> said_of(const Drive& drive, std::uint64_t seed) {
  auto scenarios = MBK_TRY(ready(drive.scenario));
  auto scenario = MBK_TRY(with_limb(std::move(scenarios.front()), kArms[seed % kArms.size()]));
  scenario.seed = seed;
  drive.change(scenario);
  const auto performance = MBK_TRY(laboratory::simulate(scenario));
  const auto measured = measurement::measure({&performance.recording, 1}, measurement::Options());
  if (!measured) return tl::unexpected(measured.error());
  const Passivity& passivity = *measured->passivity;
  Said said{performance.energy_absorbed, passivity.trial.has_value(), {}, passivity.prediction.verdict};
  if (passivity.trial) said.trial = passivity.trial->energy.verdict;
  return said;
}

}  // namespace

Result<ValidationTable> passivity_study(const StudyOptions& options) {
  const auto runs = MBK_TRY(seeded_runs(options, [](std::uint64_t seed) -> Result<SaidInRun> {
    SaidInRun run;
    for (std::size_t k = 0; k < kDrives.size(); ++k) {
      const auto said = said_of(kDrives[k], seed);
      if (!said) return tl::unexpected(said.error().in(kDrives[k].name));
      run[k] = *said;
    }
    return run;
  }));

  ValidationTable table{"passivity", "are mbk's verdicts on a limb's passivity true for every perturbation?",
                        "% of the trials", options.runs, options.seed};
  for (std::size_t k = 0; k < kDrives.size(); ++k) {
    const Drive& drive = kDrives[k];
    const auto share = [&](const char* what, std::optional<Range> expected,
                           const std::function<bool(const Said&)>& is) {
      table.rows.push_back(share_row(
          fmt::format("{}, {}: {}", drive.relaxed ? "relaxed" : "rigid", drive.name, what), runs,
          [&](const SaidInRun& run) { return is(run[k]); }, expected));
    };
    const auto trial = [](Verdict verdict) {
      return [verdict](const Said& said) { return said.trial_spoken && said.trial == verdict; };
    };
    const auto model = [](Verdict verdict) { return [verdict](const Said& said) { return said.model == verdict; }; };
    if (drive.relaxed) {
      share("gave energy in truth", {}, [](const Said& said) { return said.absorbed < 0.0; });
      share("absorbed, called active", kNever,
            [&](const Said& said) { return said.absorbed >= 0.0 && trial(Verdict::active)(said); });
      share("trial called passive", {}, trial(Verdict::passive));
      share("model called active", kNever, model(Verdict::active));
      share("model called passive", {}, model(Verdict::passive));
    } else {
      share("gave energy in truth", kAlways, [](const Said& said) { return said.absorbed < 0.0; });
      share("trial called active", kAlways, trial(Verdict::active));
      share("model called passive", kNever, model(Verdict::passive));
    }
  }
  table.notes = {
      "The trial is judged by its energy, the model by its prediction within the band of the perturbation; each is "
      "passive, active, undecided or absent. Arms 1, 4 and 5 of Dyck (2013) in turn.",
      "The position of relaxed arms is perturbed: by a multisine of ±2°, by an eighth of it, by one of its lines "
      "alone, "
      "by a random binary sequence along a diagonal, by pulses. Rigid arms are perturbed by pulses of the force.",
      "The model of a relaxed arm is passive, so 'active' is always wrong; if the perturbation is as small "
      "as "
      "the arm's own noise, the arm may still deliver energy in a trial. The rigid arm corrects for 2 N pulses and "
      "delivers energy."};
  return table;
}

}  // namespace mbk::validation
