#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mbk/base/numeric/random.h"
#include "mbk/present/report/picture.h"
#include "mbk/study/statistics/study_statistics.h"
#include "mbk/study/statistics/study_statistics_text.h"
#include "mbk/study/store/study_summary.h"

namespace mbk::statistics {
namespace outcome_raters_test {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// Eight people, two sessions, two trials by each of so many raters; 0: no rater is recorded.
store::OutcomeColumns rated(int raters) {
  numeric::Random random(5);
  store::OutcomeColumns columns;
  columns.conditions = {"relaxed"};
  columns.outcomes = {{"K", "N/m", {}, {}}};
  for (int k = 0; k < raters; ++k) columns.raters.push_back(std::string(1, static_cast<char>('A' + k)));
  const double bias[] = {0.0, 4.0, -3.0};
  for (int person = 1; person <= 8; ++person) {
    const double own = 5.0 * random.normal();
    for (int session = 1; session <= 2; ++session) {
      const double today = random.normal();
      for (int k = 0; k < std::max(raters, 2); ++k) {
        for (int trial = 1; trial <= 2; ++trial) {
          columns.trials.push_back({std::ssize(columns.trials) + 1, person, session, trial, 0, raters > 0 ? k : -1});
          columns.outcomes[0].values.push_back(100.0 + own + today + (raters > 0 ? bias[k] : 0.0) + random.normal());
        }
      }
    }
  }
  return columns;
}

store::StudyList list_of(const store::OutcomeColumns& columns) {
  store::StudyList list;
  list.analysis = store::Analysis{1, "", "{}", "1.0"};
  for (const store::TrialRow& trial : columns.trials) {
    store::ListedRecording& one = list.recordings.emplace_back();
    one.recording.number = trial.recording;
    one.recording.participant = trial.participant;
    one.recording.condition = "relaxed";
    one.state = store::RecordingState::usable;
  }
  return list;
}

StatisticsOptions asking(int raters, int sessions, int trials) {
  StatisticsOptions options;
  options.averaged = reliability::Averaged{raters, sessions, trials};
  return options;
}

TEST(RatersOfAStudy, HaveTheNumbersOfTheModel) {
  const auto columns = rated(3);
  const auto statistics = study_statistics(columns, asking(3, 2, 2)).value();
  const RaterReliability& raters = statistics.reliability.at(0).raters.value();
  EXPECT_EQ(raters.model.rows, 96);
  EXPECT_EQ(raters.model.raters, 3);
  EXPECT_EQ(raters.without_rater, 0);
  ASSERT_EQ(raters.of_numbers.size(), 4U) << "1, 1, 1; the study's own 3, 2, 2, which was asked for too; 1 and 2, 2, 2";
  EXPECT_EQ(raters.of_numbers[1].averaged.raters, 3);
  EXPECT_EQ(raters.of_numbers[3].averaged.raters, 2);
  EXPECT_LT(raters.of_numbers[0].absolute, raters.of_numbers[1].absolute);
  EXPECT_LT(raters.of_numbers[0].same_raters.sem, raters.of_numbers[0].absolute_error.sem)
      << "raters differ, which the same raters do not notice";
}

TEST(RatersOfAStudy, AreInTextJsonAndCsv) {
  const auto columns = rated(2);
  const auto statistics = study_statistics(columns).value();
  const auto list = list_of(columns);
  const auto outcomes = store::summarise_outcomes(columns);
  const auto json = nlohmann::json::parse(to_json(list, outcomes, statistics));
  const auto& raters = json["reliability"][0]["raters"];
  EXPECT_EQ(raters["support"], "enough");
  EXPECT_EQ(raters["session_facet"], "separate");
  EXPECT_EQ(raters["variances"].size(), 8U);
  const auto& one = raters["of_numbers"][0];
  EXPECT_EQ(one["raters"], 1);
  const auto& found = statistics.reliability[0].raters->of_numbers[0];
  EXPECT_EQ(one["absolute"], found.absolute);
  EXPECT_EQ(one["absolute_error"]["mdc95"], found.absolute_error.mdc95);
  for (const bool details : {false, true}) {
    const std::string text = reliability_text(statistics, details);
    EXPECT_THAT(text, HasSubstr(fmt::format("{:.2f}", found.absolute)));
    for (std::size_t begin = 0; begin < text.size();) {
      const std::size_t end = std::min(text.find('\n', begin), text.size());
      EXPECT_LE(report::columns(text.substr(begin, end - begin)), 80U) << text.substr(begin, end - begin);
      begin = end + 1;
    }
  }
  EXPECT_THAT(reliability_text(statistics, true), HasSubstr("participant×rater"));
  const std::string csv = summary_csv(list, outcomes, statistics);
  EXPECT_THAT(csv, HasSubstr(",raters,phi,"));
  EXPECT_THAT(csv, HasSubstr(fmt::format(",2,{},", found.absolute)));
}

TEST(RatersOfAStudy, WithoutAnyChangeNoTextAndNoNumber) {
  const auto columns = rated(0);
  const auto statistics = study_statistics(columns).value();
  EXPECT_FALSE(statistics.reliability.at(0).raters);
  const auto list = list_of(columns);
  const auto outcomes = store::summarise_outcomes(columns);
  EXPECT_THAT(to_json(list, outcomes, statistics), Not(HasSubstr("rater")));
  EXPECT_THAT(reliability_text(statistics, false) + reliability_text(statistics, true), Not(HasSubstr("rater")));
  EXPECT_THAT(summary_csv(list, outcomes, statistics), Not(HasSubstr("rater")));
  EXPECT_FALSE(study_statistics(columns, asking(2, 1, 1)));
}

TEST(RatersOfAStudy, LeaveOutResultsWithoutARaterAndSaySo) {
  auto columns = rated(2);
  columns.trials[0].rater = columns.trials[5].rater = -1;
  const OutcomeReliability one = study_statistics(columns).value().reliability.at(0);
  EXPECT_EQ(one.raters->without_rater, 2);
  EXPECT_EQ(one.raters->model.rows, 62);
  EXPECT_THAT(one.notes, testing::Contains(StartsWith("2 results name no rater")));
}

TEST(RatersOfAStudy, TakeTheSessionsOfAFewPeopleAsTrials) {
  auto columns = rated(2);
  for (store::TrialRow& trial : columns.trials) trial.session = trial.participant <= 4 ? trial.session : 1;
  const OutcomeReliability one = study_statistics(columns).value().reliability.at(0);
  EXPECT_EQ(one.raters->model.session_facet, reliability::SessionFacet::too_few);
  EXPECT_THAT(one.notes, testing::Contains(StartsWith("fewer than 5 people have two sessions")));
}

TEST(RatersOfAStudy, AreTooFewWhereOneMeasuresAll) {
  auto columns = rated(2);
  for (store::TrialRow& trial : columns.trials) trial.rater = 0;
  const auto statistics = study_statistics(columns).value();
  EXPECT_EQ(statistics.reliability.at(0).raters->model.support, Support::too_few_raters);
  EXPECT_THAT(reliability_text(statistics, false), HasSubstr("two raters (0; at least 5 needed)"));
}

}  // namespace outcome_raters_test
}  // namespace mbk::statistics
