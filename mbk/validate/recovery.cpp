#include <fmt/format.h>

#include <cmath>

#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/identify/impedance_fit.h"
#include "mbk/model/impedance/model.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/simulated_trials.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace {

using Trials = std::span<const SimulatedTrial>;

/// How far the mean may be from the truth.
constexpr double kShareOfMatrix = 0.05, kShiftOfRest = 0.002;

/// The bias that is allowed for each of the stacked parameters.
Vector allowed_bias(const impedance::Model& truth) {
  const auto share = [](const Matrix& matrix) {
    return Matrix(Matrix::Constant(2, 2, kShareOfMatrix * matrix.cwiseAbs().maxCoeff()));
  };
  return impedance::stacked({share(truth.M), share(truth.B), share(truth.K), Vector::Constant(2, kShiftOfRest)});
}

const char* unit_of(std::size_t parameter) {
  const Units units = units_of(Motion::translation);
  const char* of_matrix[] = {units.inertia, units.damping, units.stiffness};
  return parameter < 12 ? of_matrix[parameter / 4] : units.position;
}

void add_rows(const char* condition, Trials trials, ValidationTable& table) {
  const std::vector<std::string> names = identify::parameter_names(2);
  const auto runs = static_cast<Index>(trials.size());
  const Vector allowed = allowed_bias(trials.front().truth);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto at = static_cast<Index>(k);
    Vector error(runs);
    int held = 0;
    for (Index i = 0; i < runs; ++i) {
      const SimulatedTrial& trial = trials[static_cast<std::size_t>(i)];
      error[i] = impedance::stacked(trial.identification.model)[at] - impedance::stacked(trial.truth)[at];
      const double reach = numeric::kNormal95 * impedance::stacked(trial.identification.standard_error)[at];
      held += std::abs(error[i]) <= reach ? 1 : 0;
    }
    const std::string name = fmt::format("{} {}", condition, names[k]);
    table.rows.push_back(bias_row(name, error, allowed[at], unit_of(k)));
    table.rows.push_back(
        share_row(name + ": 95 % interval holds the truth", held, static_cast<int>(runs), kNearNominal));
  }
}

}  // namespace

Result<ValidationTable> recovery_study(const StudyOptions& options) {
  if (options.runs < 1) return no_runs(options.runs);
  const std::pair<const char*, const char*> conditions[] = {{"sinusoidal", "relaxed_sinusoidal"},
                                                            {"underdamped", "relaxed_underdamped"}};
  std::vector<TrialPlan> plans;
  for (const auto& [name, file] : conditions) {
    const auto scenarios = MBK_TRY(ready(file));
    for (int run = 0; run < options.runs; ++run) {
      plans.push_back({scenarios.front(), measurement::Options()});
      plans.back().scenario.seed = options.seed + static_cast<std::uint64_t>(run);
    }
  }
  const auto trials = MBK_TRY(run_trials(plans, options));

  ValidationTable table{"recovery", "how accurate are mbk's measurements of a relaxed arm in the closed loop?", "error",
                        options.runs, options.seed};
  Trials left = trials;
  for (const auto& [name, file] : conditions) {
    add_rows(name, left.first(static_cast<std::size_t>(options.runs)), table);
    left = left.subspan(static_cast<std::size_t>(options.runs));
  }
  table.notes = {
      "The value of a parameter is its mean error over the runs (bias); accepted is less than 5 % of the matrix's "
      "largest element, and 2 mm for x0.",
      "The truth is the arm's linear impedance at the test location. The arm's force noise acts back on its motion "
      "through the robot, which biases least squares towards the negative robot impedance; how much depends on the "
      "robot's gains."};
  return table;
}

}  // namespace mbk::validation
