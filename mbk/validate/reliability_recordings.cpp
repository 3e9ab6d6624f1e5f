#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "mbk/base/numeric/random.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/study/statistics/study_statistics.h"
#include "mbk/study/store/store_values.h"
#include "mbk/validate/rows.h"
#include "mbk/validate/simulated_trials.h"
#include "mbk/validate/study.h"

namespace mbk::validation {
namespace recorded_reliability {

constexpr int kRecordedPeople = 20, kRecordedSessions = 3;
/// Standard deviations of a person's stiffness, and of it from session to session, as shares of the arm's.
constexpr double kOfPeople = 0.2, kOfSessions = 0.1;
constexpr double kRecordedSeconds = 14.0;
constexpr const char* kOutcomes[] = {"K_xx", "K_yy", "stiffness_lambda_max"};

/// The trials of one study: the same arm with joints that are stiffer or softer.
std::vector<TrialPlan> trials_of_study(const laboratory::Scenario& scenario, std::uint64_t seed) {
  std::vector<TrialPlan> plans;
  numeric::Random random(seed, 1);
  for (int person = 0; person < kRecordedPeople; ++person) {
    const double own = 1.0 + kOfPeople * random.normal();
    for (int session = 0; session < kRecordedSessions; ++session) {
      constexpr double kSoftest = 0.2;  // four standard deviations away
      const double scale = std::max(kSoftest, own + kOfSessions * random.normal());
      plans.push_back({scenario, measurement::Options()});
      plans.back().scenario.seed = 1000 * seed + plans.size();
      auto& arm =
          std::get<participant::ArmOptions>(std::get<laboratory::PlanarTrial>(plans.back().scenario.trial).load);
      std::get<participant::TwoLinkArm::Options>(arm.limb).joints.stiffness *= scale;
    }
  }
  return plans;
}

/// Elements of a stiffness with their standard errors as a study stores them.
store::OutcomeColumns columns_of_study(std::span<const SimulatedTrial> trials, bool truth) {
  store::OutcomeColumns columns;
  columns.conditions = {"relaxed"};
  for (const char* name : {"K_xx", "K_xy", "K_yx", "K_yy"}) columns.outcomes.push_back({name, "N/m", {}, {}});
  for (std::size_t k = 0; k < trials.size(); ++k) {
    const auto number = static_cast<std::int64_t>(k);
    const SimulatedTrial& trial = trials[k];
    if (!trial.identification.usable) continue;  // as in the store
    columns.trials.push_back({number + 1, number / kRecordedSessions + 1, number % kRecordedSessions + 1, 1, 0});
    for (Index at = 0; at < 4; ++at) {
      store::OutcomeColumn& column = columns.outcomes[static_cast<std::size_t>(at)];
      column.values.push_back((truth ? trial.truth : trial.identification.model).K(at / 2, at % 2));
      if (!truth) column.standard_errors.push_back(trial.identification.standard_error.K(at / 2, at % 2));
    }
  }
  statistics::add_matrix_numbers(columns);
  return columns;
}

/// What one study says of one outcome, and what is known of its people and of the errors of its measurements.
struct RecordedAnswer {
  double icc = 0, mdc = 0;
  reliability::Interval icc95;
  double true_icc = 0, true_variance = 0;    ///< ICC(A,1) of the true stiffness, and its squared SEM
  double error_variance = 0, true_mean = 0;  ///< of measured − true; of the true stiffness

  /// What the true stiffness of these people and errors like these come to.
  [[nodiscard]] double expected_icc() const {
    const double between = true_variance * true_icc / (1.0 - true_icc);
    return between / (between + true_variance + error_variance);
  }
  [[nodiscard]] double expected_mdc() const {
    return reliability::kPublishedNormal95 * std::numbers::sqrt2 * std::sqrt(true_variance + error_variance);
  }
};

Vector values_of(const store::OutcomeColumns& columns, const std::string& outcome) {
  const auto& values = std::ranges::find(columns.outcomes, outcome, &store::OutcomeColumn::name)->values;
  return Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
}

Result<std::vector<RecordedAnswer>> answers_of(std::span<const SimulatedTrial> trials) {
  statistics::StatisticsOptions options;
  options.outcomes.assign(std::begin(kOutcomes), std::end(kOutcomes));
  options.threads = 1;
  const store::OutcomeColumns measured_columns = columns_of_study(trials, false);
  const store::OutcomeColumns true_columns = columns_of_study(trials, true);
  const auto measured = statistics::study_statistics(measured_columns, options);
  const auto truth = statistics::study_statistics(true_columns, options);
  if (!measured) return tl::unexpected(measured.error());
  if (!truth) return tl::unexpected(truth.error());
  std::vector<RecordedAnswer> answers;
  for (std::size_t k = 0; k < measured->reliability.size(); ++k) {
    const std::string& name = measured->reliability[k].outcome;
    const auto& found = measured->reliability[k].between_sessions;
    const auto& true_one = truth->reliability[k].between_sessions;
    if (found.support != reliability::Support::enough || true_one.support != reliability::Support::enough) {
      return bad_data(fmt::format("{} of simulated recordings has no reliability", name));
    }
    const Vector true_values = values_of(true_columns, name);
    RecordedAnswer& answer = answers.emplace_back();
    answer.icc = found.test_retest.icc[1].value;
    answer.icc95 = found.test_retest.icc[1].interval95;
    answer.mdc = found.test_retest.error[0].mdc95;
    answer.true_icc = true_one.test_retest.icc[1].value;
    answer.true_variance = std::pow(true_one.test_retest.error[0].sem, 2);
    answer.error_variance = numeric::variance(values_of(measured_columns, name) - true_values);
    answer.true_mean = true_values.mean();
  }
  return answers;
}

}  // namespace recorded_reliability

Result<ValidationTable> recorded_reliability_study(const StudyOptions& options) {
  using namespace recorded_reliability;
  if (options.runs < 1) return bad_usage(fmt::format("{} runs are too few", options.runs), "pass --runs 1 or more");
  const auto scenarios = MBK_TRY(ready("relaxed_sinusoidal"));
  laboratory::Scenario scenario = scenarios.front();
  std::get<perturbation::MultisinePlan>(scenario.perturbation.kind).duration = kRecordedSeconds;
  std::vector<TrialPlan> plans;
  for (int run = 0; run < options.runs; ++run) {
    const auto of_study = trials_of_study(scenario, options.seed + static_cast<std::uint64_t>(run));
    plans.insert(plans.end(), of_study.begin(), of_study.end());
  }
  const auto trials = MBK_TRY(run_trials(plans, options));
  constexpr std::size_t kOfStudy = std::size_t{kRecordedPeople} * kRecordedSessions;
  std::vector<std::vector<RecordedAnswer>> runs;
  for (int run = 0; run < options.runs; ++run) {
    auto answers = MBK_TRY(answers_of(std::span(trials).subspan(static_cast<std::size_t>(run) * kOfStudy, kOfStudy)));
    runs.push_back(std::move(answers));
  }

  ValidationTable table{"recorded-reliability", "does a study of recordings report the true reliability of its people?",
                        "", options.runs, options.seed};
  table.rows.push_back(share_row(
      "recordings that are usable", trials, [](const SimulatedTrial& trial) { return trial.identification.usable; },
      kNearlyAlways));
  const auto all = [&](std::size_t outcome, const auto& number) {
    Vector values(options.runs);
    for (Index i = 0; i < values.size(); ++i) values[i] = number(runs[static_cast<std::size_t>(i)][outcome]);
    return values;
  };
  constexpr double kOfIcc = 0.1, kOfMdc = 10.0;
  for (std::size_t k = 0; k < std::size(kOutcomes); ++k) {
    const std::string name = kOutcomes[k];
    table.rows.push_back(bias_row(name + ": ICC(A,1), less that of the true stiffness and the errors",
                                  all(k, [](const RecordedAnswer& run) { return run.icc - run.expected_icc(); }),
                                  kOfIcc, ""));
    table.rows.push_back(bias_row(
        name + ": MDC, off from that of the true stiffness and the errors by",
        all(k, [](const RecordedAnswer& run) { return 100.0 * (run.mdc / run.expected_mdc() - 1.0); }), kOfMdc, "%"));
    // The errors of all runs, as a share of the arm's stiffness, beside the known shares.
    const double mean = all(k, [](const RecordedAnswer& run) { return run.true_mean; }).mean();
    const double errors = all(k, [](const RecordedAnswer& run) { return run.error_variance; }).mean() / (mean * mean);
    const double people = kOfPeople * kOfPeople;
    const double truth = people / (people + kOfSessions * kOfSessions + errors);
    table.rows.push_back(share_row(
        fmt::format("{}: 95 % interval of ICC(A,1) holds {:.2f}", name, truth), runs,
        [&](const std::vector<RecordedAnswer>& run) {
          return run[k].icc95.first <= truth && truth <= run[k].icc95.second;
        },
        std::nullopt));
  }
  table.notes = {
      fmt::format(
          "A run is one study of {} people in {} sessions, each a simulated recording of {:g} s that is measured "
          "as 'mbk measure' does. People's stiffness differs by {:g} %, that of their sessions by {:g} % more.",
          kRecordedPeople, kRecordedSessions, kRecordedSeconds, 100.0 * kOfPeople, 100.0 * kOfSessions),
      "What is compared is known of each run: the stiffness of the same people, and by how much each measurement is "
      "off. Errors of measurement make sessions of a person differ, so that the ICC of such short recordings is less "
      "than that of the stiffness itself. How often intervals contain the true values takes thousands of studies to "
      "see, which "
      "'mbk validate reliability' draws."};
  return table;
}

}  // namespace mbk::validation
