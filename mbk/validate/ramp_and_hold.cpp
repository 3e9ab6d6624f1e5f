#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "mbk/measure/measurement/explore.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/simulated_trials.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace ramp_and_hold {

constexpr std::array kEntries = {"k_xx", "k_xy", "k_yx", "k_yy"};

struct PlateauRun {
  std::array<double, 4> error{};  ///< of the entries of K [N/m]
  std::array<bool, 4> held{};     ///< by their 95 % intervals
  bool area_held = false, shape_held = false, orientation_held = false, antisymmetry_held = false;
  double relative_error = 0.0;  ///< ‖K̂ − K‖/‖K‖, Frobenius [%]
  bool usable = false;
  bool early_refused = false;  ///< a window in which the hand still moves is not called usable
};

bool holds(const Interval& interval, double value) {
  return value >= interval.first && value <= interval.second;
}

/// The ready scenario with holds and pauses no longer than the measurement takes of them.
Result<laboratory::Scenario> short_scenario(std::uint64_t seed) {
  auto scenarios = MBK_TRY(ready("relaxed_ramp_and_hold"));
  laboratory::Scenario scenario = scenarios.front();
  scenario.seed = seed;
  auto& plan = std::get<perturbation::RampPlan>(scenario.perturbation.kind);
  plan.ramps.hold = 0.2;
  plan.ramps.way_back = 0.2;
  plan.ramps.shortest_pause = 0.5;
  plan.ramps.longest_pause = 0.7;
  plan.ramps.quiet = 0.5;
  plan.tail = 0.1;
  return scenario;
}

Result<PlateauRun> plateau_run(std::uint64_t seed) {
  const auto scenario = MBK_TRY(short_scenario(seed));
  const auto performance = MBK_TRY(laboratory::simulate(scenario));
  std::vector<Warning> warnings;
  measurement::ExploreOptions options;
  const auto found = MBK_TRY(measurement::plateau_stiffness({&performance.recording, 1}, options, warnings));
  PlateauRun run;
  const StiffnessRegression& fit = found.fit;
  const Matrix& truth = performance.truth.K;
  for (Index entry = 0; entry < 4; ++entry) {
    const auto at = static_cast<std::size_t>(entry);
    run.error[at] = fit.K(entry / 2, entry % 2) - truth(entry / 2, entry % 2);
    run.held[at] = std::abs(run.error[at]) <= fit.half_width95(entry / 2, entry % 2);
  }
  run.relative_error = 100.0 * (fit.K - truth).norm() / truth.norm();
  const impedance::Ellipse true_ellipse = impedance::ellipse(truth);
  run.area_held = holds(fit.ellipse->area95, true_ellipse.area);
  run.shape_held = holds(fit.ellipse->shape95, true_ellipse.shape);
  const double turn = std::remainder(true_ellipse.orientation - fit.ellipse->ellipse.orientation, std::numbers::pi);
  run.orientation_held = holds(fit.ellipse->orientation95, fit.ellipse->ellipse.orientation + turn);
  run.antisymmetry_held = holds(fit.antisymmetry->value95, impedance::antisymmetric_part(truth));
  run.usable = found.usable;
  options.plateau.from_s = 0.02;
  options.plateau.to_s = 0.08;
  const auto early = measurement::plateau_stiffness({&performance.recording, 1}, options, warnings);
  run.early_refused = !early || !early->usable;
  return run;
}

}  // namespace ramp_and_hold

Result<ValidationTable> ramp_and_hold_study(const StudyOptions& options) {
  using namespace ramp_and_hold;
  const auto ran = MBK_TRY(seeded_runs(options, plateau_run));
  ValidationTable table{
      "ramp-and-hold",
      "does the force on the plateaus of ramps and holds give the stiffness, and do the intervals contain it?", "share",
      options.runs, options.seed};
  constexpr double kAllowedBias = 1.25;  // N/m: 1 % of the largest entry
  for (std::size_t entry = 0; entry < kEntries.size(); ++entry) {
    const std::string name = kEntries[entry];
    Vector errors(options.runs);
    for (Index i = 0; i < errors.size(); ++i) errors[i] = ran[static_cast<std::size_t>(i)].error[entry];
    table.rows.push_back(bias_row(name, errors, kAllowedBias, "N/m"));
    table.rows.push_back(share_row(
        name + ": 95 % interval holds the truth", ran, [entry](const PlateauRun& run) { return run.held[entry]; },
        kNominal));
  }
  Vector relative(options.runs);
  for (Index i = 0; i < relative.size(); ++i) relative[i] = ran[static_cast<std::size_t>(i)].relative_error;
  table.rows.push_back(median_row("median error of K, of its norm", relative, Range{0.0, 5.0}, "%"));
  const auto share = [&](const char* what, bool PlateauRun::*is, std::optional<Range> expected) {
    table.rows.push_back(share_row(
        what, ran, [is](const PlateauRun& run) { return run.*is; }, expected));
  };
  share("antisymmetric part: 95 % interval holds the truth", &PlateauRun::antisymmetry_held, kNominal);
  share("area of the ellipse: 95 % interval holds the truth", &PlateauRun::area_held, kNominal);
  share("shape of the ellipse: 95 % interval holds the truth", &PlateauRun::shape_held, kNominal);
  share("orientation of the ellipse: 95 % interval holds the truth", &PlateauRun::orientation_held, kNominal);
  share("called usable", &PlateauRun::usable, kNearlyAlways);
  share("window of 20 to 80 ms, in which the hand still moves: not called usable", &PlateauRun::early_refused,
        kNearlyAlways);
  return table;
}

}  // namespace mbk::validation
