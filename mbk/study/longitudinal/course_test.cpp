#include "mbk/study/longitudinal/course.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "mbk/study/longitudinal/study_report.h"

namespace mbk::longitudinal {
namespace {

/// People in sessions with trials; `value` gives each result.
template <class Value>
store::OutcomeColumns study_of(int people, int sessions, int trials, const std::string& outcome, Value value) {
  store::OutcomeColumns columns{{"relaxed"}, {}, {{outcome, "N/m", {}, {}}}};
  std::int64_t recording = 0;
  for (int p = 1; p <= people; ++p) {
    for (int s = 1; s <= sessions; ++s) {
      for (int t = 1; t <= trials; ++t) {
        columns.trials.push_back({++recording, p, s, t, 0});
        columns.outcomes[0].values.push_back(value(p, s, t));
      }
    }
  }
  return columns;
}

/// The same scatter each time: a session's in −5 … 5, a trial's in −2 … 2.
double scatter(int p, int s, int t) {
  return 5.0 * std::sin(12.9 * p + 78.2 * s) + 2.0 * std::sin(3.7 * p + 9.1 * s + 31.7 * t);
}

std::vector<OutcomeCourses> courses_of(const store::OutcomeColumns& columns, std::optional<std::int64_t> who = {}) {
  const auto statistics = statistics::study_statistics(columns);
  EXPECT_TRUE(statistics) << statistics.error().message;
  return courses(columns, *statistics, who);
}

TEST(Courses, ChangeBeyondErrorIsToldFromOneThatIsNot) {
  const auto columns = study_of(12, 2, 3, "K_xx", [](int p, int s, int t) {
    return 100.0 + 10.0 * p + scatter(p, s, t) + (p == 7 && s == 2 ? 60.0 : 0.0);
  });
  const auto all = courses_of(columns);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].why_unknown, "");
  EXPECT_EQ(all[0].repeated_participants, 12);
  ASSERT_EQ(all[0].courses.size(), 12U);
  for (const Course& one : all[0].courses) {
    ASSERT_EQ(one.changes.size(), 1U);
    const Change& change = one.changes[0];
    EXPECT_EQ(change.verdict, one.participant == 7 ? ChangeVerdict::beyond_error : ChangeVerdict::within_error)
        << one.participant << ": " << change.difference << " of " << change.mdc;
    EXPECT_LT(change.mdc95.first, change.mdc);
    EXPECT_GT(change.mdc95.second, change.mdc);
    EXPECT_LT(one.interval95.first, one.mean);
  }
}

TEST(Courses, LargeChangeAmongFewPeopleDoesNotHideItself) {
  const auto columns = study_of(6, 2, 2, "K_xx", [](int p, int s, int t) {
    return 100.0 + 10.0 * p + scatter(p, s, t) + (p == 3 && s == 2 ? 80.0 : 0.0);
  });
  const auto all = courses_of(columns);
  for (const Course& one : all.at(0).courses) {
    const Change& change = one.changes.at(0);
    EXPECT_EQ(change.by_others, one.participant == 3) << one.participant;
    EXPECT_EQ(change.verdict, one.participant == 3 ? ChangeVerdict::beyond_error : ChangeVerdict::within_error);
  }
  EXPECT_LT(all[0].courses[2].changes[0].mdc, 0.5 * all[0].courses[0].changes[0].mdc);
}

TEST(Courses, NothingIsCertainWhereErrorsHaveHeavyTails) {
  // Two people's sessions are far off, so that neither of them is judged by people without heavy tails.
  const auto of_study = [](double off) {
    return study_of(14, 2, 1, "K_xx", [=](int p, int s, int t) {
      const double error = (p == 5 || p == 9) && s == 2 ? (p == 5 ? off : -off) : 0.0;
      return 100.0 + 10.0 * p + scatter(p, s, t) + error;
    });
  };
  for (const Course& one : courses_of(of_study(0.0)).at(0).courses) EXPECT_FALSE(one.changes.at(0).heavy_tails);
  const auto all = courses_of(of_study(200.0));
  for (const Course& one : all.at(0).courses) {
    const Change& change = one.changes.at(0);
    EXPECT_TRUE(change.heavy_tails) << one.participant;
    EXPECT_NE(change.verdict, ChangeVerdict::beyond_error) << one.participant;
  }
}

TEST(Courses, WhoDidNotChangeIsSeldomSaidToHave) {
  constexpr int kStudies = 150, kPeople = 8;
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  int beyond = 0, more = 0;
  for (int k = 0; k < kStudies; ++k) {
    std::map<std::pair<int, int>, double> drawn;
    const auto all = courses_of(study_of(kPeople, 2, 2, "K_xx", [&](int p, int s, int) {
      if (!drawn.contains({p, 0})) drawn[{p, 0}] = 30.0 * normal(random);
      if (!drawn.contains({p, s})) drawn[{p, s}] = 10.0 * normal(random);
      return 200.0 + drawn[{p, 0}] + drawn[{p, s}] + 5.0 * normal(random);
    }));
    for (const Course& one : all.at(0).courses) {
      beyond += one.changes.at(0).verdict == ChangeVerdict::beyond_error ? 1 : 0;
      more += std::abs(one.changes[0].difference) > one.changes[0].mdc ? 1 : 0;
    }
  }
  EXPECT_LT(beyond, 0.025 * kStudies * kPeople);
  EXPECT_GT(more, beyond);
  EXPECT_LT(more, 0.1 * kStudies * kPeople);
}

TEST(Courses, LastSessionIsAlsoComparedWithTheOneBefore) {
  const auto value = [](int p, int s, int t) {
    return 100.0 + 10.0 * p + scatter(p, s, t) + (p == 3 && s == 3 ? 80.0 : 0.0);
  };
  const auto all = courses_of(study_of(8, 3, 2, "K_xx", value));
  for (const Course& one : all.at(0).courses) {
    ASSERT_TRUE(one.latest);
    EXPECT_EQ(one.latest->first_session, 2);
    EXPECT_EQ(one.latest->last_session, 3);
    EXPECT_DOUBLE_EQ(one.latest->difference, one.sessions[2].mean - one.sessions[1].mean);
    EXPECT_EQ(one.latest->by_others, one.changes[1].by_others);
    if (one.participant == 3) {
      EXPECT_EQ(one.latest->verdict, ChangeVerdict::beyond_error);
    }
  }
  EXPECT_FALSE(courses_of(study_of(8, 2, 2, "K_xx", value)).at(0).courses.at(0).latest);
}

TEST(Courses, DetectableChangeFollowsFromVariances) {
  const auto columns =
      study_of(10, 3, 2, "K_xx", [](int p, int s, int t) { return 100.0 + 10.0 * p + scatter(p, s, t); });
  const auto statistics = statistics::study_statistics(columns);
  ASSERT_TRUE(statistics);
  const auto& model = statistics->reliability[0].mixed_model;
  const DetectableChange error = detectable_change(statistics->reliability[0]);
  ASSERT_TRUE(error.known());
  // of two equal numbers of trials it is the published 1.96 √2 SEM
  EXPECT_NEAR(error.between(2, 2), model.of_trials.back().mdc95_between, 1e-9 * error.between(2, 2));
  EXPECT_NEAR(error.between(1, 4), 1.96 * std::sqrt(2.0 * model.session + 1.25 * (model.residual + model.known)), 1e-9);
  EXPECT_GT(error.between(1, 1), error.between(2, 2));
}

TEST(Courses, NothingIsSaidOfErrorWherePeopleAreTooFew) {
  for (const int people : {1, 2, 4}) {
    const auto all = courses_of(study_of(people, 2, 3, "K_xx", [](int p, int s, int t) {
      return 100.0 + scatter(p, s, t) + (s == 2 ? 1000.0 * p : 0.0);
    }));
    ASSERT_EQ(all.size(), 1U);
    EXPECT_NE(all[0].why_unknown, "");
    for (const Course& one : all[0].courses) {
      EXPECT_EQ(one.changes.at(0).verdict, ChangeVerdict::unknown);
      EXPECT_TRUE(std::isnan(one.changes[0].mdc));
      EXPECT_TRUE(std::isnan(one.interval95.first));
    }
  }
}

TEST(Courses, ManyPeopleOfWhomFewCameAgainAreTooFew) {
  auto columns = study_of(20, 2, 2, "K_xx", [](int p, int s, int t) { return 100.0 + 5.0 * p + scatter(p, s, t); });
  for (std::size_t k = columns.trials.size(); k-- > 0;) {
    if (columns.trials[k].participant <= 4 || columns.trials[k].session == 1) continue;
    columns.outcomes[0].values[k] = kNaN;
  }
  const auto all = courses_of(columns);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_NE(all[0].why_unknown.find("4 people"), std::string::npos) << all[0].why_unknown;
  EXPECT_EQ(all[0].courses[0].changes.at(0).verdict, ChangeVerdict::unknown);
  EXPECT_TRUE(all[0].courses[19].changes.empty());
}

TEST(Courses, NothingIsSaidWhereNothingVaries) {
  const auto all =
      courses_of(study_of(8, 2, 2, "K_xx", [](int p, int s, int) { return p == 3 && s == 2 ? 5.0 : 4.0; }));
  const auto same = courses_of(study_of(8, 2, 2, "K_xx", [](int, int, int) { return 4.0; }));
  for (const auto& one : {same.at(0)}) {
    EXPECT_NE(one.why_unknown, "");
    EXPECT_EQ(one.courses.at(0).changes.at(0).verdict, ChangeVerdict::unknown);
  }
  EXPECT_NE(all.at(0).courses.at(0).changes.at(0).verdict, ChangeVerdict::beyond_error);
}

TEST(Courses, VerdictNeedsTheWholeInterval) {
  EXPECT_EQ(verdict_of(11.0, 5.0, {3.0, 10.0}), ChangeVerdict::beyond_error);
  EXPECT_EQ(verdict_of(-11.0, 5.0, {3.0, 10.0}), ChangeVerdict::beyond_error);
  EXPECT_EQ(verdict_of(7.0, 5.0, {3.0, 10.0}), ChangeVerdict::uncertain);
  EXPECT_EQ(verdict_of(4.0, 5.0, {3.0, 10.0}), ChangeVerdict::within_error);
  EXPECT_EQ(verdict_of(7.0, kNaN, {kNaN, kNaN}), ChangeVerdict::unknown);
  EXPECT_EQ(verdict_of(7.0, 5.0, {3.0, std::numeric_limits<double>::infinity()}), ChangeVerdict::unknown);
  EXPECT_EQ(verdict_of(kNaN, 5.0, {3.0, 10.0}), ChangeVerdict::unknown);
  EXPECT_EQ(verdict_of(7.0, 0.0, {0.0, 0.0}), ChangeVerdict::unknown);
}

TEST(Courses, OrientationsAreAxes) {
  const auto all = courses_of(study_of(8, 2, 2, "stiffness_orientation", [](int p, int s, int t) {
    const double angle = (s == 1 ? 178.0 : 181.0) + 0.2 * scatter(p, s, t);
    return std::fmod(angle, 180.0);
  }));
  ASSERT_EQ(all.size(), 1U);
  EXPECT_TRUE(all[0].axial);
  for (const Course& one : all[0].courses) EXPECT_LT(std::abs(one.changes.at(0).difference), 8.0);
}

TEST(ParticipantReport, LeadsWithTheLargestStiffness) {
  const auto first_of = [](std::vector<std::string> names) {
    store::OutcomeColumns columns;
    for (std::string& name : names) columns.outcomes.push_back({std::move(name), "", {}, {}});
    return primary_outcome(columns);
  };
  EXPECT_EQ(first_of({"K_xx", "stiffness_area", "stiffness_lambda_max"}), "stiffness_lambda_max");
  EXPECT_EQ(first_of({"M", "K"}), "K");
  EXPECT_EQ(first_of({}), "");
}

TEST(ParticipantReport, HoldsNoNumbersOfOthers) {
  auto columns = study_of(6, 2, 2, "K_xx", [](int p, int s, int t) { return 1000.0 * p + scatter(p, s, t); });
  store::StudyList list;
  list.analysis = store::Analysis{1, "", "{}", "0.1.0"};
  list.analyses = {*list.analysis};
  for (const store::TrialRow& trial : columns.trials) {
    store::ListedRecording one{.state = store::RecordingState::usable};
    one.recording.number = trial.recording;
    one.recording.participant = trial.participant;
    one.recording.session = trial.session;
    one.recording.sha256 = std::string(64, static_cast<char>('a' + trial.participant));
    list.recordings.push_back(one);
  }
  const auto statistics = statistics::study_statistics(columns);
  ASSERT_TRUE(statistics);
  const auto report = study_report(list, columns, *statistics, 3, "");
  ASSERT_TRUE(report) << report.error().message;
  const auto json = nlohmann::json::parse(participant_report_json(*report, 3));
  EXPECT_EQ(json["study_participants"], 6);
  EXPECT_EQ(json["recordings"].size(), 4U);
  EXPECT_EQ(json["results"].size(), 4U);
  ASSERT_EQ(json["courses"].size(), 1U);
  EXPECT_EQ(json["courses"][0]["participants"].size(), 1U);
  EXPECT_TRUE(json["courses"][0]["mean"].is_null());
  for (const auto& result : json["results"]) EXPECT_NEAR(result["values"][0].get<double>(), 3000.0, 10.0);
  EXPECT_EQ(json.dump().find(std::string(64, 'b')), std::string::npos);
  EXPECT_FALSE(study_report(list, columns, *statistics, 9, ""));
  EXPECT_FALSE(study_report(list, columns, *statistics, 3, "none"));
}

}  // namespace
}  // namespace mbk::longitudinal
