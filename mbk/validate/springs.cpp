#include <fmt/format.h>

#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/simulated_trials.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace {

/// A file of rigs, what its trials are called in the table, and what is expected of a mean error.
struct RigFile {
  const char* file;
  const char* name;
  double stiffness_error;  ///< [N/m]
};

/// A linear field leaves only the error of the method. That of real springs bends over the motion, and as the disc
/// turns with the last link, moving the hand also winds the springs around it: there K differs from −∂F/∂x by up to a
/// few percent.
constexpr RigFile kFiles[] = {{"rig_table_3_1", "3.1 linear", 2.0},
                              {"rig_table_5_1", "5.1 linear", 2.0},
                              {"rig_springs_table_3_1", "3.1 springs", 8.0},
                              {"rig_springs_table_5_1", "5.1 springs", 8.0}};
constexpr double kMassError = 0.02;  // [kg]

/// One number of a rig: identified and true, trial by trial.
struct Errors {
  std::vector<double> identified, truth;
  std::string unit = "N/m";
  double expected = 0.0;

  void add(double value, double true_value) {
    identified.push_back(value);
    truth.push_back(true_value);
  }
};

ValidationRow row_of(const std::string& what, const Errors& errors) {
  const auto count = static_cast<Index>(errors.identified.size());
  const Vector error =
      Eigen::Map<const Vector>(errors.identified.data(), count) - Eigen::Map<const Vector>(errors.truth.data(), count);
  return bias_row(what, error, errors.expected, errors.unit);
}

using NamedErrors = std::vector<std::pair<std::string, Errors>>;

/// Identified against true, one point for each row of that unit (figs 3.8 and 5.4 in form).
ChartSeries series_of(const char* name, const NamedErrors& all, const std::string& unit) {
  ChartSeries marks;
  marks.name = name;
  for (const auto& [what, errors] : all) {
    if (errors.unit != unit) continue;
    const auto count = static_cast<Index>(errors.truth.size());
    marks.x.push_back(errors.truth.front());
    marks.y.push_back(Eigen::Map<const Vector>(errors.identified.data(), count).mean());
  }
  return marks;
}

Result<void> add_file(const RigFile& file, const StudyOptions& options, std::vector<TrialPlan>& plans) {
  const auto scenarios = MBK_TRY(ready(file.file));
  for (const laboratory::Scenario& scenario : scenarios) {
    for (int run = 0; run < options.runs; ++run) {
      plans.push_back({scenario, mass_and_springs()});
      plans.back().scenario.seed = scenario.seed + 1000 * (options.seed + static_cast<std::uint64_t>(run));
    }
  }
  return {};
}

}  // namespace

Result<ValidationTable> springs_study(const StudyOptions& options) {
  if (options.runs < 1) return no_runs(options.runs);
  std::vector<TrialPlan> plans;
  for (const RigFile& file : kFiles) {
    MBK_TRY(add_file(file, options, plans));
  }
  const auto trials = MBK_TRY(run_trials(plans, options));

  ValidationTable table{"springs", "how accurate are the stiffness and mass that mbk identifies for a rig of springs?",
                        "error", options.runs, options.seed};
  Chart stiffnesses = identified_against_true("Stiffness of the rigs: k_xx, k_yy and k_s", "N/m");
  Chart masses = identified_against_true("Mass of the rigs", "kg");
  for (const RigFile& file : kFiles) {
    NamedErrors all;  // in the order of the file
    const auto errors_of = [&](const std::string& what) -> Errors& {
      for (auto& [name, errors] : all) {
        if (name == what) return errors;
      }
      return all.emplace_back(what, Errors{}).second;
    };
    for (std::size_t i = 0; i < plans.size(); ++i) {
      if (plans[i].scenario.protocol != file.file) continue;
      const auto [stiffness, mass] = rig_names(plans[i].scenario.name);
      const impedance::Model& truth = trials[i].truth;
      const impedance::Model& model = trials[i].identification.model;
      const std::pair<const char*, std::pair<Index, Index>> elements[] = {
          {"k_xx", {0, 0}}, {"k_yy", {1, 1}}, {"k_s", {0, 1}}};
      for (const auto& [name, at] : elements) {
        Errors& element = errors_of(fmt::format("{} {} {}", file.name, stiffness, name));
        element.expected = file.stiffness_error;
        element.add(model.K(at.first, at.second), truth.K(at.first, at.second));
      }
      Errors& payload = errors_of(fmt::format("{} {} m", file.name, mass));
      payload.unit = "kg";
      payload.expected = kMassError;
      payload.add(model.M(0, 0), truth.M(0, 0));
    }
    for (const auto& [what, errors] : all) table.rows.push_back(row_of(what, errors));
    stiffnesses.series.push_back(series_of(file.name, all, "N/m"));
    masses.series.push_back(series_of(file.name, all, "kg"));
  }
  table.charts = {stiffnesses, masses};
  table.notes = {
      "Errors are identified − true, the sign of the thesis's text, not of its printed table 5.4.",
      "Each stiffness of table 5.1 is the mean over its five masses, and each mass over its five stiffnesses.",
      "The arrays of real springs were found for these K (mbk springs find); the thesis does not specify its "
      "springs. Their field is not linear, and the disc turns with the robot's last link."};
  return table;
}

}  // namespace mbk::validation
