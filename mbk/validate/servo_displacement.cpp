#include "mbk/measure/explore/servo_displacement.h"

#include <array>
#include <cmath>
#include <string>

#include "mbk/measure/measurement/explore.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/seeded_runs.h"
#include "mbk/validate/simulated_reaches.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace servo_displacement {

constexpr std::array kEntries = {"k_xx", "k_xy", "k_yx", "k_yy"};

struct ReachStiffness {
  std::array<double, 4> error{};  ///< [N/m]
  std::array<bool, 4> held{};
  double relative_error = 0.0;    ///< ‖K̂ − K‖/‖K‖ [%]
  double prediction_error = 0.0;  ///< [mm]
  bool area_held = false, usable = false;
};

struct ServoRun {
  ReachStiffness own_past, mean_of_undisturbed;
};

Result<ReachStiffness> measured(const ReachesOfOneRun& reaches, const Matrix& truth, int components) {
  explore::ServoDisplacementOptions options;
  options.prediction.max_components = components;
  auto found = MBK_TRY(
      explore::servo_displacement_stiffness(reaches.undisturbed, reaches.displaced, reaches.sample_time, options));
  measurement::add_ellipse(found.by.fit);
  ReachStiffness one;
  for (Index entry = 0; entry < 4; ++entry) {
    const auto at = static_cast<std::size_t>(entry);
    one.error[at] = found.by.fit.K(entry / 2, entry % 2) - truth(entry / 2, entry % 2);
    one.held[at] = std::abs(one.error[at]) <= found.by.fit.half_width95(entry / 2, entry % 2);
  }
  one.relative_error = 100.0 * (found.by.fit.K - truth).norm() / truth.norm();
  const auto& [low, high] = found.by.fit.ellipse->area95;
  const double area = impedance::ellipse(truth).area;
  one.area_held = low <= area && area <= high;
  one.usable = found.verdict.usable;
  one.prediction_error = 1e3 * found.by.prediction_error;
  return one;
}

Result<ServoRun> servo_run(std::uint64_t seed) {
  const SimulatedReaches hand;
  const auto reaches = MBK_TRY(simulate_reaches(hand, seed));
  const auto own = MBK_TRY(measured(reaches, hand.K, explore::ReachPredictionOptions{}.max_components));
  const auto mean = MBK_TRY(measured(reaches, hand.K, 0));
  return ServoRun{own, mean};
}

}  // namespace servo_displacement

Result<ValidationTable> servo_displacement_study(const StudyOptions& options) {
  using namespace servo_displacement;
  const auto ran = MBK_TRY(seeded_runs(options, servo_run));
  ValidationTable table{"servo-displacement",
                        "does a displacement relative to the predicted reach give the stiffness of a moving hand?",
                        "share", options.runs, options.seed};
  const auto values_of = [&](const auto& value) {
    Vector values(options.runs);
    for (Index i = 0; i < values.size(); ++i) values[i] = value(ran[static_cast<std::size_t>(i)]);
    return values;
  };
  const auto add = [&](const std::string& how, ReachStiffness ServoRun::*of, bool judged) {
    const auto range = [&](Range expected) { return judged ? std::optional(expected) : std::nullopt; };
    for (std::size_t entry = 0; entry < kEntries.size(); ++entry) {
      const std::string name = how + ": " + kEntries[entry];
      const Vector errors = values_of([&](const ServoRun& run) { return (run.*of).error[entry]; });
      constexpr double kAllowedBias = 6.6;  // N/m: 2 % of the largest entry
      table.rows.push_back(mean_row(name, errors, range({-kAllowedBias, kAllowedBias}), "N/m"));
      table.rows.push_back(share_row(
          name + ": 95 % interval holds the truth", ran, [&](const ServoRun& run) { return (run.*of).held[entry]; },
          range(kNominal)));
    }
    table.rows.push_back(median_row(how + ": median error of K, of its norm",
                                    values_of([&](const ServoRun& run) { return (run.*of).relative_error; }),
                                    range({0.0, 10.0}), "%"));
    table.rows.push_back(share_row(
        how + ": area of the ellipse: 95 % interval holds the truth", ran,
        [&](const ServoRun& run) { return (run.*of).area_held; }, range(kNearNominal)));
    table.rows.push_back(share_row(
        how + ": called usable", ran, [&](const ServoRun& run) { return (run.*of).usable; }, range(kNearlyAlways)));
    table.rows.push_back(mean_row(how + ": error of the predicted place",
                                  values_of([&](const ServoRun& run) { return (run.*of).prediction_error; }),
                                  std::nullopt, "mm"));
  };
  add("own past", &ServoRun::own_past, true);
  add("mean of undisturbed reaches", &ServoRun::mean_of_undisturbed, false);
  return table;
}

}  // namespace mbk::validation
