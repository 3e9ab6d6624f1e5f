#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "mbk/base/numeric/statistics.h"
#include "mbk/validate/each_run.h"
#include "mbk/validate/robot_trials.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/simulated_trials.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace {

using robot::PlanarMechanism;

/// One free motion, and what three models make of it.
struct Run {
  RobotIdentification right, printed, without_coulomb;
};

using Runs = std::vector<Run>;

Result<Run> perform(std::uint64_t seed) {
  const auto recording = MBK_TRY(free_motion(seed));
  auto right = MBK_TRY(identified_robot(recording, FrictionModel::full));
  auto printed = MBK_TRY(identified_robot(recording, FrictionModel::full, PlanarMechanism::Coriolis::printed));
  auto without = MBK_TRY(identified_robot(recording, FrictionModel::viscous));
  return Run{std::move(right), std::move(printed), std::move(without)};
}

Vector of_runs(const Runs& runs, const std::function<double(const Run&)>& value) {
  Vector values(static_cast<Index>(runs.size()));
  for (std::size_t i = 0; i < runs.size(); ++i) values[static_cast<Index>(i)] = value(runs[i]);
  return values;
}

/// In how many runs something is so; accepted is nearly always.
ValidationRow nearly_always(std::string what, const Runs& runs, const std::function<bool(const Run&)>& is) {
  return share_row(std::move(what), runs, is, kNearlyAlways);
}

/// Error of a coefficient [%], or as it is where the truth is zero.
double error_of(const RobotCoefficient& found, double truth) {
  return truth == 0.0 ? found.value : 100.0 * (found.value / truth - 1.0);
}

void add_coefficients(const Runs& runs, const Vector& truth, ValidationTable& table) {
  for (Index k = 0; k < truth.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const robot::Coefficient& coefficient = runs.front().right.coefficients[at].coefficient;
    const Vector error = of_runs(runs, [&](const Run& run) { return error_of(run.right.coefficients[at], truth[k]); });
    table.rows.push_back(mean_row(fmt::format("bias of {}", coefficient.name), error, {},
                                  truth[k] == 0.0 ? coefficient.unit : std::string("%")));
    const auto held = [&](const Run& run) {
      const RobotCoefficient& found = run.right.coefficients[at];
      return std::abs(found.value - truth[k]) <= numeric::kNormal95 * found.standard_error;
    };
    table.rows.push_back(
        share_row(fmt::format("95 % interval of {} holds the truth", coefficient.name), runs, held, kNearNominal));
  }
  constexpr double kInertiaError = 0.5;  // [%]
  for (std::size_t k = 0; k < 3; ++k) {
    table.rows.push_back(nearly_always(
        fmt::format("error of {} at most {:g} %", runs.front().right.coefficients[k].coefficient.name, kInertiaError),
        runs, [&](const Run& run) {
          return std::abs(error_of(run.right.coefficients[k], truth[static_cast<Index>(k)])) <= kInertiaError;
        }));
  }
  table.rows.push_back(mean_row("delay of the motors",
                                of_runs(runs, [](const Run& run) { return 1e3 * run.right.model.delay; }), {}, "ms"));
}

void add_fit(const Runs& runs, ValidationTable& table) {
  constexpr double kVaf = 99.0;  // [%]
  for (std::size_t joint = 0; joint < 2; ++joint) {
    const std::string name = fmt::format("joint {}: ", joint + 1);
    table.rows.push_back(nearly_always(fmt::format("{}VAF of held-out torque at least {:g} %", name, kVaf), runs,
                                       [&](const Run& run) { return run.right.fit[joint].vaf >= kVaf; }));
    table.rows.push_back(mean_row(name + "VAF of held-out torque",
                                  of_runs(runs, [&](const Run& run) { return run.right.fit[joint].vaf; }), {}, "%"));
    table.rows.push_back(mean_row(name + "RMSE of held-out torque",
                                  of_runs(runs, [&](const Run& run) { return 1e3 * run.right.fit[joint].rmse; }), {},
                                  "mN·m"));
  }
}

/// RMSE of both joints of a model over that of the right one.
double loss(const RobotIdentification& model, const RobotIdentification& right) {
  return std::hypot(model.fit[0].rmse, model.fit[1].rmse) / std::hypot(right.fit[0].rmse, right.fit[1].rmse);
}

void add_printed_sign(const Runs& runs, const Vector& truth, ValidationTable& table) {
  constexpr double kClearly = 2.0;
  const char* const what = "printed Coriolis sign: RMSE of held-out torque, over the right one's";
  table.rows.push_back(nearly_always(fmt::format("{}, at least {:g}", what, kClearly), runs,
                                     [&](const Run& run) { return loss(run.printed, run.right) >= kClearly; }));
  table.rows.push_back(
      mean_row(what, of_runs(runs, [](const Run& run) { return loss(run.printed, run.right); }), {}, ""));
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector error = of_runs(
        runs, [&](const Run& run) { return error_of(run.printed.coefficients[k], truth[static_cast<Index>(k)]); });
    table.rows.push_back(mean_row(
        fmt::format("printed Coriolis sign: error of {}", runs.front().printed.coefficients[k].coefficient.name), error,
        {}, "%"));
  }
}

void add_without_coulomb(const Runs& runs, const Vector& truth, ValidationTable& table) {
  const char* const what = "Coulomb friction left out";
  for (Index k = 0; k < truth.size(); ++k) {
    const auto at = static_cast<std::size_t>(k);
    const Vector error =
        of_runs(runs, [&](const Run& run) { return error_of(run.without_coulomb.coefficients[at], truth[k]); });
    table.rows.push_back(
        mean_row(fmt::format("{}: error of {}", what, runs.front().without_coulomb.coefficients[at].coefficient.name),
                 error, {}, "%"));
  }
  for (std::size_t joint = 0; joint < 2; ++joint) {
    const Vector vaf = of_runs(runs, [joint](const Run& run) { return run.without_coulomb.fit[joint].vaf; });
    table.rows.push_back(mean_row(fmt::format("{}: VAF of joint {}", what, joint + 1), vaf, {}, "%"));
  }
  table.rows.push_back(mean_row(fmt::format("{}: RMSE of held-out torque, over that of the full model", what),
                                of_runs(runs, [](const Run& run) { return loss(run.without_coulomb, run.right); }), {},
                                ""));
}

}  // namespace

Result<ValidationTable> robot_study(const StudyOptions& options) {
  if (options.runs < 1) return no_runs(options.runs);
  if (options.elsewhere) return only_here();
  const auto ran = MBK_TRY(each_run_here(options, options.runs,
                                         [&](int i) { return perform(options.seed + static_cast<std::uint64_t>(i)); }));
  const Runs& runs = ran;
  const auto truth = MBK_TRY(true_parameters(FrictionModel::full));
  const auto viscous_truth = MBK_TRY(true_parameters(FrictionModel::viscous));

  ValidationTable table{"robot", "how accurate are the dynamics that mbk identifies of a freely moving robot?", "value",
                        options.runs, options.seed};
  add_coefficients(runs, truth, table);
  add_fit(runs, table);
  add_printed_sign(runs, truth, table);
  add_without_coulomb(runs, viscous_truth, table);
  table.notes.emplace_back(
      "The robot of table A.1 with 0.03 N·m of Coulomb friction at each joint, in the closed loop of the laboratory "
      "(ready scenario free_motion); each run has other phases and other noise.");
  table.notes.emplace_back(
      fmt::format("Encoders of 2 µm at the end of the first link; torques from motor currents with white noise of {:g} "
                  "mN·m and a torque constant that is known. An error of that constant by 1 % would be one of every "
                  "coefficient by 1 %, and no recording of the robot alone could show it.",
                  1e3 * kTorqueNoise));
  table.notes.emplace_back(
      "Identified as mbk robot identify does by default: viscous and Coulomb friction and an offset of each joint, the "
      "delay of the motors found too. A torque that is held over each tick acts half a sample late.");
  table.notes.emplace_back(
      "The printed Coriolis sign is that of (A.6) in Dyck (2013), fitted to the same data. Coulomb friction left out: "
      "viscous friction alone, as in (A.6).");
  table.notes.emplace_back("The friction of the laboratory has the form of the model. That of a real drive has not.");
  return table;
}

}  // namespace mbk::validation
