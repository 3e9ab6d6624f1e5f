#include "mbk/study/statistics/study_statistics.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "mbk/base/numeric/random.h"
#include "mbk/study/statistics/study_statistics_text.h"

namespace mbk::statistics {
namespace {

using store::OutcomeColumns;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Columns that are made result by result.
class Results {
 public:
  explicit Results(std::vector<std::string> outcomes, std::vector<std::string> conditions = {"relaxed"}) {
    columns_.conditions = std::move(conditions);
    for (std::string& name : outcomes) columns_.outcomes.push_back({std::move(name), "N/m", {}, {}});
  }

  /// NaN: the result lacks the outcome.
  Results& add(int participant, int session, std::vector<double> values, int condition = 0, double error = kNaN) {
    const auto number = std::ssize(columns_.trials) + 1;
    columns_.trials.push_back({number, participant, session, number, condition});
    for (std::size_t k = 0; k < values.size(); ++k) {
      columns_.outcomes[k].values.push_back(values[k]);
      columns_.outcomes[k].standard_errors.push_back(error);
    }
    return *this;
  }

  /// By participant and session, as the store gives them.
  OutcomeColumns columns() const {
    std::vector<std::size_t> order(columns_.trials.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::ranges::stable_sort(order, {}, [&](std::size_t k) {
      return std::pair(columns_.trials[k].participant, columns_.trials[k].session);
    });
    OutcomeColumns sorted = columns_;
    for (std::size_t k = 0; k < order.size(); ++k) {
      sorted.trials[k] = columns_.trials[order[k]];
      for (std::size_t c = 0; c < sorted.outcomes.size(); ++c) {
        sorted.outcomes[c].values[k] = columns_.outcomes[c].values[order[k]];
        sorted.outcomes[c].standard_errors[k] = columns_.outcomes[c].standard_errors[order[k]];
      }
    }
    return sorted;
  }

 private:
  OutcomeColumns columns_;
};

StudyStatistics statistics_of(const Results& results, const StatisticsOptions& options = {}) {
  auto found = study_statistics(results.columns(), options);
  EXPECT_TRUE(found) << found.error().line();
  return found ? std::move(*found) : StudyStatistics();
}

/// People × sessions × trials drawn from variances, mean 100.
Results drawn(int people, int sessions, int trials, double sd_people, double sd_sessions, double sd_trials,
              std::uint32_t seed = 1) {
  numeric::Random random(seed);
  Results results({"K"});
  for (int i = 1; i <= people; ++i) {
    const double own = 100.0 + sd_people * random.normal();
    for (int j = 1; j <= sessions; ++j) {
      const double session = own + sd_sessions * random.normal();
      for (int k = 0; k < trials; ++k) results.add(i, j, {session + sd_trials * random.normal()});
    }
  }
  return results;
}

// Shrout & Fleiss (1979), table 2.
constexpr double kShroutFleiss[6][4] = {{9, 2, 5, 8}, {6, 1, 3, 2},  {8, 4, 6, 8},
                                        {7, 1, 2, 6}, {10, 5, 6, 9}, {6, 2, 4, 7}};

Results shrout_and_fleiss() {
  Results results({"K"});
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 4; ++j) results.add(i + 1, j + 1, {kShroutFleiss[i][j]});
  }
  return results;
}

TEST(Reliability, OfShroutAndFleissIsThePublishedOne) {
  const StudyStatistics found = statistics_of(shrout_and_fleiss());
  ASSERT_EQ(found.reliability.size(), 1U);
  const Repeated& sessions = found.reliability[0].between_sessions;
  ASSERT_EQ(sessions.support, Support::enough);
  EXPECT_NEAR(sessions.test_retest.icc[0].value, 0.165742, 1e-6);
  EXPECT_NEAR(sessions.test_retest.icc[1].value, 0.289764, 1e-6);
  EXPECT_NEAR(sessions.test_retest.icc[2].value, 0.714841, 1e-6);
  EXPECT_NEAR(sessions.test_retest.error[0].mdc95, 6.937342, 1e-6);
  EXPECT_NEAR(sessions.test_retest.error[1].mdc95, 2.798677, 1e-6);
  EXPECT_EQ(found.reliability[0].agreement.size(), 3U);
  EXPECT_EQ(found.reliability[0].within_session.support, Support::too_few_sessions) << "one trial a session";
}

TEST(SummaryTable, WritesTheNumbersOfShroutAndFleissInApaStyle) {
  const Results results = shrout_and_fleiss();
  store::StudyList list;
  list.recordings.resize(25);
  for (store::ListedRecording& one : list.recordings) one.recording.condition = "relaxed";
  const auto outcomes = store::summarise_outcomes(results.columns());
  const StudyStatistics found = statistics_of(results);
  EXPECT_THAT(summary_latex(list, outcomes, found),
              HasSubstr("$K$ & N/m & 6 (24) & $5.3 \\pm 1.7$ & $.29$ & $[.02, .76]$ & $2.5$ & $6.9$ & 1 \\\\\n"));
  EXPECT_THAT(summary_markdown(list, outcomes, found),
              HasSubstr("| $K$ | N/m | 6 (24) | 5.3 ± 1.7 | .29 | [.02, .76] | 2.5 | 6.9 | 1 |"));
  EXPECT_THAT(summary_csv(list, outcomes, found), HasSubstr("\nrelaxed,K,N/m,6,24,1,5.29"));
}

TEST(Reliability, HasOneIntervalOfTheIccEverywhere) {
  Results mirrored({"K"});  // who is high in one session is low in the other: an ICC below 0
  const double first[6] = {3.0, -2.0, 1.0, -1.5, 2.5, -3.1};
  for (int i = 0; i < 6; ++i) mirrored.add(i + 1, 1, {first[i]}).add(i + 1, 2, {0.3 - 0.8 * first[i]});
  for (const Results& results : {shrout_and_fleiss(), mirrored}) {
    const StudyStatistics found = statistics_of(results);
    const auto [low, high] = found.reliability[0].between_sessions.test_retest.icc[1].interval95;
    EXPECT_THAT(reliability_text(found, false), HasSubstr(fmt::format("{:.2f} to {:.2f}", low, high)));
    EXPECT_THAT(reliability_text(found, false), HasSubstr("McGraw and Wong"));
    EXPECT_THAT(reliability_text(found, true), HasSubstr(fmt::format("({:.2f} to {:.2f})", low, high)));
    const auto json = nlohmann::json::parse(to_json({}, {}, found))["reliability"][0]["between_sessions"];
    EXPECT_EQ(json["icc"][1]["interval95"], nlohmann::json({low, high}));
    EXPECT_FALSE(json.contains("agreement_by_large_samples95"));
  }
  EXPECT_LT(statistics_of(mirrored).reliability[0].between_sessions.test_retest.icc[1].interval95.second, 0.3);
}

TEST(Reliability, DoesNotDependOnTheOrderInWhichResultsCame) {
  Results turned({"K"});
  for (int j = 3; j >= 0; --j) {
    for (int i = 5; i >= 0; --i) turned.add(i + 1, j + 1, {kShroutFleiss[i][j]});
  }
  EXPECT_EQ(statistics_of(turned).reliability[0].between_sessions.scores,
            statistics_of(shrout_and_fleiss()).reliability[0].between_sessions.scores);
}

TEST(Reliability, CountsAMissingCellAsMissing) {
  Results results = drawn(12, 3, 2, 20, 3, 5);
  results.add(13, 1, {150.0}).add(13, 2, {kNaN});  // never came a second time with a number
  const OutcomeReliability one = statistics_of(results).reliability[0];
  EXPECT_EQ(one.participants, 13);
  EXPECT_EQ(one.repeated_participants, 12);
  EXPECT_EQ(one.between_sessions.participants.size(), 12U);
  EXPECT_EQ(one.between_sessions.left_out, 1);
  EXPECT_EQ(one.mixed_model.results, 73) << "the mixed model takes what there is";
}

TEST(Reliability, WarnsOfErrorsWithHeavyTailsBetweenSessionsAndBetweenTrials) {
  const auto tails = testing::Contains(ReliabilityWarning::heavy_tails);
  EXPECT_THAT(statistics_of(drawn(12, 2, 3, 20, 5, 5)).reliability[0].warnings, Not(tails));
  for (const bool one_trial : {false, true}) {
    numeric::Random random(2);
    Results results({"K"});
    for (int i = 1; i <= 12; ++i) {
      const double own = 100.0 + 20.0 * random.normal();
      for (int j = 1; j <= 2; ++j) {
        for (int k = 1; k <= 3; ++k) {
          const bool off = i == 4 && j == 2 && (!one_trial || k == 2);
          results.add(i, j, {own + 3.0 * random.normal() + (off ? 50.0 : 0.0)});
        }
      }
    }
    const StudyStatistics found = statistics_of(results);
    EXPECT_THAT(found.reliability[0].warnings, tails);
    EXPECT_THAT(found.reliability[0].notes, testing::Contains(HasSubstr("participant 4")));
    EXPECT_THAT(reliability_text(found, false), HasSubstr("tails"));
    EXPECT_THAT(to_json({}, {}, found), HasSubstr("\"heavy-tails\""));
  }
}

TEST(Reliability, OneTrialASessionDoesNotSeparateSessionsFromTrials) {
  const auto warned = testing::ElementsAre(ReliabilityWarning::sessions_and_trials);
  for (const bool one_more : {false, true}) {
    Results results = drawn(8, 2, 1, 20, 10, 5);
    if (one_more) results.add(3, 2, {100.0});  // one difference between trials says nothing of all
    const StudyStatistics found = statistics_of(results);
    const OutcomeReliability& one = found.reliability[0];
    EXPECT_THAT(one.warnings, warned);
    EXPECT_TRUE(std::isnan(one.mixed_model.session));
    EXPECT_TRUE(std::isnan(one.mixed_model.residual));
    EXPECT_GT(one.mixed_model.within, 0.0);
    ASSERT_EQ(one.mixed_model.of_trials.size(), 1U);
    EXPECT_NEAR(one.mixed_model.of_trials[0].sem_between, std::sqrt(one.mixed_model.within), 1e-9);
    EXPECT_TRUE(std::isnan(one.mixed_model.of_trials[0].mdc95_within));
    const auto json = nlohmann::json::parse(to_json({}, {}, found))["reliability"][0];
    EXPECT_EQ(json["warnings"], nlohmann::json({"sessions-and-trials-not-identifiable"}));
    EXPECT_TRUE(json["mixed_model"]["variance"]["session"].is_null());
    EXPECT_THAT(reliability_text(found, false), HasSubstr("  ! "));
    EXPECT_THAT(reliability_text(found, true), HasSubstr("sessions and trials"));
  }
  const OutcomeReliability two = statistics_of(drawn(8, 2, 2, 20, 10, 5)).reliability[0];
  EXPECT_THAT(two.warnings, IsEmpty());
  EXPECT_NEAR(two.mixed_model.within, two.mixed_model.session + two.mixed_model.residual, 1e-9);
}

TEST(Reliability, WhereASessionHasNoNumbersIsOfTheOthers) {
  numeric::Random random(3);
  Results results({"K"});
  for (int i = 1; i <= 8; ++i) {
    const double own = 20.0 * random.normal();
    for (int j = 1; j <= 3; ++j) results.add(i, j, {j == 2 ? kNaN : own + random.normal()});
  }
  const Repeated sessions = statistics_of(results).reliability[0].between_sessions;
  EXPECT_EQ(sessions.repetitions, (std::vector<std::int64_t>{1, 3}));
  EXPECT_EQ(sessions.support, Support::enough);
}

TEST(Reliability, IsNotStatedOfFourPeople) {
  const StudyStatistics found = statistics_of(drawn(4, 3, 2, 20, 3, 5));
  EXPECT_EQ(found.reliability[0].between_sessions.support, Support::too_few_people);
  EXPECT_THAT(found.reliability[0].between_sessions.test_retest.icc, IsEmpty());
  EXPECT_THAT(found.reliability[0].agreement, IsEmpty());
  EXPECT_THAT(found.reliability[0].mixed_model.of_trials, IsEmpty());
  EXPECT_THAT(reliability_text(found, false), HasSubstr("(4; at least 5 needed)"));
  EXPECT_THAT(reliability_text(found, false), Not(HasSubstr("ICC(A,1)")));
}

TEST(Reliability, IsNotStatedOfOnePersonOrOneSession) {
  EXPECT_EQ(statistics_of(drawn(1, 4, 3, 20, 3, 5)).reliability[0].between_sessions.support, Support::too_few_people);
  const OutcomeReliability once = statistics_of(drawn(9, 1, 3, 20, 0, 5)).reliability[0];
  EXPECT_EQ(once.between_sessions.support, Support::too_few_sessions);
  EXPECT_EQ(once.mixed_model.support, Support::too_few_sessions);
  EXPECT_EQ(once.within_session.support, Support::enough) << "trials repeat all the same";
  EXPECT_EQ(once.session, 1);
}

TEST(Reliability, IsNotPerfectWhereNothingVaries) {
  Results same({"K"}), copied({"K"});
  for (int i = 1; i <= 8; ++i) {
    for (int j = 1; j <= 3; ++j) {
      same.add(i, j, {100.0});
      copied.add(i, j, {100.0 + i});
    }
  }
  for (const Results& results : {same, copied}) {
    const OutcomeReliability one = statistics_of(results).reliability[0];
    EXPECT_EQ(one.between_sessions.support, Support::no_variation);
    EXPECT_THAT(one.between_sessions.test_retest.icc, IsEmpty());
    EXPECT_EQ(one.mixed_model.support, Support::no_variation);
    EXPECT_THAT(one.notes, testing::Contains(HasSubstr("session")));
  }
}

TEST(Reliability, NamesThePersonWhoDecides) {
  Results results = drawn(12, 2, 1, 1, 0, 5);
  results.add(99, 1, {1000.0}).add(99, 2, {1003.0});
  const OutcomeReliability one = statistics_of(results).reliability[0];
  EXPECT_GT(one.between_sessions.test_retest.icc[1].value, 0.95);
  EXPECT_EQ(one.influence.value().participant, 99);
  EXPECT_LT(one.influence->without, 0.6);
  EXPECT_THAT(one.notes, testing::Contains(HasSubstr("participant 99")));
  EXPECT_THAT(statistics_of(drawn(20, 3, 2, 20, 3, 5)).reliability[0].notes, IsEmpty()) << "nobody does";
}

TEST(Reliability, FallsWherePeopleWereSwapped) {
  const Results right = drawn(10, 2, 1, 20, 0, 2);
  OutcomeColumns swapped = right.columns();
  std::swap(swapped.outcomes[0].values[1], swapped.outcomes[0].values[19]);  // session 2 of people 1 and 10
  const double all = statistics_of(right).reliability[0].between_sessions.test_retest.icc[1].value;
  const auto found = study_statistics(swapped);
  ASSERT_TRUE(found);
  EXPECT_GT(all, 0.95);
  EXPECT_LT(found->reliability[0].between_sessions.test_retest.icc[1].value, all);
}

TEST(Reliability, WeightsTrialsByTheirStandardErrors) {
  numeric::Random random(5);
  Results results({"K"});
  for (int i = 1; i <= 15; ++i) {
    const double own = 100.0 + 10.0 * random.normal();
    for (int j = 1; j <= 3; ++j) {
      for (int k = 0; k < 4; ++k) {
        const double error = k == 0 ? 30.0 : 1.0;  // the first one is bad, and says so
        results.add(i, j, {own + error * random.normal()}, 0, error);
      }
    }
  }
  OutcomeColumns unknown = results.columns();
  unknown.outcomes[0].standard_errors.clear();
  const MixedReliability weighted = statistics_of(results).reliability[0].mixed_model;
  const MixedReliability alike = study_statistics(unknown)->reliability[0].mixed_model;
  EXPECT_TRUE(weighted.weighted);
  EXPECT_FALSE(alike.weighted);
  EXPECT_LT(weighted.residual, 0.1 * alike.residual) << "what is known is not counted twice";
  EXPECT_NEAR(weighted.known, (900.0 + 3.0) / 4.0, 1e-9);
}

TEST(Reliability, DoesNotBelieveStandardErrorsThatSayMoreThanThereIs) {
  Results results({"K"});
  const OutcomeColumns drawn_columns = drawn(10, 2, 3, 20, 0, 2).columns();
  for (std::size_t k = 0; k < drawn_columns.trials.size(); ++k) {
    const auto& trial = drawn_columns.trials[k];
    results.add(static_cast<int>(trial.participant), static_cast<int>(trial.session),
                {drawn_columns.outcomes[0].values[k]}, 0, 30.0);
  }
  const OutcomeReliability one = statistics_of(results).reliability[0];
  EXPECT_FALSE(one.mixed_model.weighted);
  EXPECT_LT(one.mixed_model.of_trials.at(0).sem_within, 4.0);
  EXPECT_THAT(one.notes, testing::Contains(HasSubstr("standard errors")));
}

TEST(Orientation, IsTheSameHalfATurnFurther) {
  numeric::Random random(4);
  Results near({"stiffness_orientation"}), turned({"stiffness_orientation"});
  for (int i = 1; i <= 10; ++i) {
    const double own = 10.0 * random.normal();
    for (int j = 1; j <= 2; ++j) {
      const double angle = own + random.normal();
      near.add(i, j, {angle});
      turned.add(i, j, {angle < 0.0 ? angle + 180.0 : angle});
    }
  }
  const StudyStatistics one = statistics_of(near), other = statistics_of(turned);
  EXPECT_TRUE(one.reliability[0].axial);
  EXPECT_NEAR(one.reliability[0].between_sessions.test_retest.icc[1].value,
              other.reliability[0].between_sessions.test_retest.icc[1].value, 1e-9);
}

TEST(Orientation, ThatPointsEverywhereHasNoReliability) {
  Results results({"stiffness_orientation"});
  for (int i = 0; i < 10; ++i) results.add(i + 1, 1, {18.0 * i}).add(i + 1, 2, {18.0 * i + 1.0});
  const OutcomeReliability one = statistics_of(results).reliability[0];
  EXPECT_NE(one.between_sessions.support, Support::enough);
  EXPECT_THAT(one.notes, testing::Contains(HasSubstr("45°")));
}

TEST(MatrixNumbers, AreEigenvaluesAndParts) {
  Results results({"K_xx", "K_xy", "K_yx", "K_yy"});
  results.add(1, 1, {3.0, 1.0, 1.0, 3.0}).add(1, 2, {2.0, 0.5, -0.5, 1.0}).add(1, 3, {2.0, kNaN, 0.0, 1.0});
  OutcomeColumns columns = results.columns();
  add_matrix_numbers(columns);
  std::map<std::string, std::vector<double>> values;
  for (const auto& column : columns.outcomes) values[column.name] = column.values;
  EXPECT_DOUBLE_EQ(values.at("stiffness_lambda_max")[0], 4.0);
  EXPECT_DOUBLE_EQ(values.at("stiffness_lambda_min")[0], 2.0);
  EXPECT_DOUBLE_EQ(values.at("stiffness_symmetric_xy")[1], 0.0);
  EXPECT_DOUBLE_EQ(values.at("stiffness_antisymmetric")[1], 0.5);
  EXPECT_TRUE(std::isnan(values.at("stiffness_lambda_max")[2]));
}

std::vector<std::string> nine_elements() {
  std::vector<std::string> names;
  for (const char row : {'x', 'y', 'z'}) {
    for (const char col : {'x', 'y', 'z'}) names.push_back(fmt::format("K_{}{}", row, col));
  }
  return names;
}

TEST(MatrixNumbers, OfThreeAxesAreThreeEigenvaluesAndAVector) {
  Results results(nine_elements());
  results.add(1, 1, {5.0, 1.0, 0.0, 1.0, 5.0, 0.0, 0.0, 0.0, 3.0})
      .add(1, 2, {1.0, -3.0, 2.0, 3.0, 1.0, -1.0, -2.0, 1.0, 1.0})  // I + [a]×, a = [1 2 3]
      .add(1, 3, {1.0, 0.0, kNaN, 0.0, 1.0, kNaN, kNaN, kNaN, kNaN});
  OutcomeColumns columns = results.columns();
  add_matrix_numbers(columns);
  std::map<std::string, std::vector<double>> values;
  for (const auto& column : columns.outcomes) values[column.name] = column.values;
  const double kRounding = 1e-12;
  EXPECT_NEAR(values.at("stiffness_lambda_max")[0], 6.0, kRounding);
  EXPECT_NEAR(values.at("stiffness_lambda_mid")[0], 4.0, kRounding);
  EXPECT_NEAR(values.at("stiffness_lambda_min")[0], 3.0, kRounding);
  EXPECT_DOUBLE_EQ(values.at("stiffness_symmetric_xy")[0], 1.0);
  EXPECT_DOUBLE_EQ(values.at("stiffness_antisymmetric_x")[1], 1.0);
  EXPECT_DOUBLE_EQ(values.at("stiffness_antisymmetric_y")[1], 2.0);
  EXPECT_DOUBLE_EQ(values.at("stiffness_antisymmetric_z")[1], 3.0);
  EXPECT_EQ(values.count("stiffness_antisymmetric"), 0U);
  EXPECT_TRUE(std::isnan(values.at("stiffness_lambda_max")[2])) << "two axes among three";
}

TEST(MatrixSpread, OfThreeAxesIsThatOfWholeMatrices) {
  numeric::Random random(6);
  Results results(nine_elements());
  for (int i = 1; i <= 8; ++i) {
    const double own = std::abs(200.0 + 60.0 * random.normal()) + 50.0;
    for (int j = 1; j <= 2; ++j) {
      const double zz = i == 1 && j == 1 ? -5.0 : own + random.normal();
      results.add(i, j, {own + random.normal(), 0, 0, 0, own + random.normal(), 0, 0, 0, zz});
    }
  }
  const MatrixSpread spread = statistics_of(results).matrices.at(0);
  EXPECT_EQ(spread.left_out, 1) << "not positive definite along z alone";
  EXPECT_EQ(spread.sessions, 15);
  EXPECT_EQ(spread.between.count, 8 * 7 / 2);
  EXPECT_GT(spread.closer, 0.9);
}

TEST(MatrixSpread, TellsPeopleApartOnlyWhereTheyDiffer) {
  for (const double spread : {0.0, 60.0}) {
    numeric::Random random(6);
    Results results({"K_xx", "K_xy", "K_yx", "K_yy"});
    for (int i = 1; i <= 12; ++i) {
      const double own = std::abs(200.0 + spread * random.normal()) + 50.0;
      for (int j = 1; j <= 3; ++j) {
        results.add(
            i, j,
            {own + 5.0 * random.normal(), 5.0 * random.normal(), 5.0 * random.normal(), own + 5.0 * random.normal()});
      }
    }
    const StudyStatistics found = statistics_of(results);
    ASSERT_EQ(found.matrices.size(), 1U);
    EXPECT_EQ(found.matrices[0].within.count, 12 * 3);
    EXPECT_EQ(found.matrices[0].between.count, 12 * 11 / 2);
    if (spread > 0.0) {
      EXPECT_GT(found.matrices[0].closer, 0.9);
    } else {
      EXPECT_LT(found.matrices[0].closer, 0.6);
    }
  }
}

TEST(MatrixSpread, LeavesOutWhatIsNotPositiveDefinite) {
  Results results({"K_xx", "K_xy", "K_yx", "K_yy"});
  for (int i = 1; i <= 6; ++i) {
    results.add(i, 1, {100.0 + i, 0, 0, 100}).add(i, 2, {i == 1 ? -5.0 : 101.0 + i, 0, 0, 100});
  }
  const MatrixSpread spread = statistics_of(results).matrices.at(0);
  EXPECT_EQ(spread.left_out, 1);
  EXPECT_EQ(spread.sessions, 11);
}

TEST(Duplicates, AreNamed) {
  Results results({"A", "B", "C"});
  numeric::Random random(7);
  for (int i = 1; i <= 6; ++i) results.add(i, 1, {random.normal(), random.normal(), random.normal()});
  EXPECT_THAT(statistics_of(results).notes, IsEmpty());
  const auto first = results.columns();
  results.add(7, 1,
              {first.outcomes[0].values[2] * (1.0 + 1e-13), first.outcomes[1].values[2], first.outcomes[2].values[2]});
  EXPECT_THAT(statistics_of(results).notes, testing::ElementsAre(HasSubstr("recordings 3 and 7")));
}

StatisticsOptions comparing(ComparedBy by, std::vector<std::string> levels = {}) {
  StatisticsOptions options;
  options.comparing = Comparing{by, std::move(levels)};
  return options;
}

/// People under two conditions; the second is `effect` more.
Results two_conditions(int people, double effect, std::uint32_t seed = 8) {
  numeric::Random random(seed);
  Results results({"K"}, {"relaxed", "tensed"});
  for (int i = 1; i <= people; ++i) {
    const double own = 100.0 + 20.0 * random.normal();
    for (int k = 0; k < 3; ++k) {
      results.add(i, 1, {own + random.normal()}, 0);
      results.add(i, 1, {own + effect + random.normal()}, 1);
    }
  }
  return results;
}

TEST(AComparison, OfConditionsPairsPeople) {
  const StudyStatistics found = statistics_of(two_conditions(10, 5.0), comparing(ComparedBy::condition));
  const OutcomeComparison& one = found.comparison.value().outcomes.at(0);
  EXPECT_EQ(one.difference.pairing, reliability::Pairing::paired);
  EXPECT_EQ(one.difference.first_count, 10);
  EXPECT_NEAR(one.difference.value, 5.0, 1.0);
  EXPECT_EQ(one.verdict, DifferenceVerdict::differs);
  EXPECT_NEAR(one.mixed_model.value().difference.value, one.difference.value, 1e-6)
      << "of complete pairs the model is the paired test";
  EXPECT_NEAR(one.mixed_model->difference.p, one.difference.p, 1e-6);
  const StudyStatistics back =
      statistics_of(two_conditions(10, 5.0), comparing(ComparedBy::condition, {"tensed", "relaxed"}));
  EXPECT_DOUBLE_EQ(back.comparison->outcomes[0].difference.value, -one.difference.value);
}

TEST(AComparison, DoesNotCountTrialsAsPeople) {
  // Each of three people changes by another amount, in as many trials as one likes: no difference is shown.
  Results results({"K"}, {"relaxed", "tensed"});
  numeric::Random random(9);
  for (int i = 1; i <= 3; ++i) {
    for (int k = 0; k < 100; ++k) {
      results.add(i, 1, {100.0 + random.normal()}, 0);
      results.add(i, 1, {105.0 + 4.0 * i + random.normal()}, 1);
    }
  }
  const OutcomeComparison one =
      statistics_of(results, comparing(ComparedBy::condition)).comparison.value().outcomes.at(0);
  EXPECT_EQ(one.verdict, DifferenceVerdict::too_few_people);
  EXPECT_GT(one.mixed_model.value().difference.standard_error, 1.0);
  EXPECT_THAT(comparison_text(statistics_of(results, comparing(ComparedBy::condition)), false), HasSubstr("\n? "));
}

TEST(AComparison, OfAlikeConditionsShowsNothing) {
  int differs = 0;
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    const auto found = statistics_of(two_conditions(8, 0.0, seed), comparing(ComparedBy::condition));
    if (found.comparison->outcomes[0].verdict == DifferenceVerdict::differs) ++differs;
  }
  EXPECT_LE(differs, 11);
}

TEST(AComparison, OfGroupsTakesWhoIsInThem) {
  StatisticsOptions options = comparing(ComparedBy::group);
  options.groups = {{"patients", {1, 2, 3, 4, 5, 77}}, {"controls", {6, 7, 8, 9, 10}}};
  Results results = drawn(11, 2, 2, 5, 1, 1);
  const StudyStatistics found = statistics_of(results, options);
  const OutcomeComparison& one = found.comparison.value().outcomes.at(0);
  EXPECT_EQ(one.difference.pairing, reliability::Pairing::unpaired);
  EXPECT_EQ(one.difference.first_count, 5);
  EXPECT_EQ(one.difference.second_count, 5);
  EXPECT_THAT(found.notes, testing::UnorderedElementsAre(HasSubstr("participant 11"), HasSubstr("participant 77")));
  options.groups[1].participants.push_back(2);
  EXPECT_FALSE(study_statistics(results.columns(), options)) << "in two groups";
}

TEST(AComparison, SaysWhereItRestsOnOnePerson) {
  // Seven people change by one nearly alike, weakly; the eighth makes it significant.
  Results results({"K"}, {"relaxed", "tensed"});
  const double change[8] = {1.0, -0.6, 0.9, -0.5, 1.1, -0.4, 1.2, 1.15};
  for (int i = 1; i <= 8; ++i) results.add(i, 1, {100.0 + i}, 0).add(i, 1, {100.3 + i + change[i - 1]}, 1);
  const OutcomeComparison one =
      statistics_of(results, comparing(ComparedBy::condition)).comparison.value().outcomes.at(0);
  ASSERT_EQ(one.verdict, DifferenceVerdict::differs);
  ASSERT_GT(one.influence.value().without, 0.05);
  EXPECT_THAT(one.notes, testing::Contains(HasSubstr("participant")));
  EXPECT_THAT(statistics_of(two_conditions(10, 5.0), comparing(ComparedBy::condition)).comparison->outcomes[0].notes,
              IsEmpty());
}

TEST(AComparison, OfValuesThatDoNotVaryIsNotMade) {
  Results results({"K"}, {"relaxed", "tensed"});
  for (int i = 1; i <= 8; ++i) results.add(i, 1, {100.0}, 0).add(i, 1, {101.0}, 1);
  const OutcomeComparison one =
      statistics_of(results, comparing(ComparedBy::condition)).comparison.value().outcomes.at(0);
  EXPECT_EQ(one.verdict, DifferenceVerdict::no_variation);
}

TEST(AComparison, IsAdjustedForAllItsTests) {
  Results results({"K", "B"}, {"a", "b", "c"});
  numeric::Random random(10);
  for (int i = 1; i <= 9; ++i) {
    for (int c = 0; c < 3; ++c) results.add(i, 1, {random.normal(), random.normal()}, c);
  }
  const Comparison comparison = statistics_of(results, comparing(ComparedBy::condition)).comparison.value();
  EXPECT_EQ(comparison.tests, 6);
  double smallest = 1.0, smallest_holm = 1.0;
  for (const OutcomeComparison& one : comparison.outcomes) {
    smallest = std::min(smallest, one.difference.p);
    smallest_holm = std::min(smallest_holm, one.p_holm);
  }
  EXPECT_NEAR(smallest_holm, std::min(1.0, 6.0 * smallest), 1e-12);
}

TEST(WhatIsNotThere, IsRefused) {
  const OutcomeColumns columns = drawn(6, 2, 1, 5, 1, 1).columns();
  StatisticsOptions wrong;
  wrong.outcomes = {"stifness"};
  EXPECT_FALSE(study_statistics(columns, wrong));
  EXPECT_FALSE(study_statistics(columns, comparing(ComparedBy::condition))) << "there is one";
  EXPECT_FALSE(study_statistics(columns, comparing(ComparedBy::session, {"1", "9"})));
  EXPECT_FALSE(study_statistics(columns, comparing(ComparedBy::session, {"1", "1"})));
  EXPECT_FALSE(study_statistics(columns, comparing(ComparedBy::group)));
  EXPECT_TRUE(study_statistics(columns, comparing(ComparedBy::session, {"1", "2"})));
}

TEST(TheNumbers, AreTheSameForAnyNumberOfThreads) {
  StatisticsOptions one = comparing(ComparedBy::session), two = one;
  one.threads = 1;
  two.threads = 2;
  const Results results = drawn(14, 3, 3, 20, 3, 5);
  EXPECT_EQ(to_json({}, {}, statistics_of(results, one)), to_json({}, {}, statistics_of(results, two)));
}

TEST(TheText, StandsOnLinesOf80Columns) {
  Results results({"K_xx", "K_xy", "K_yx", "K_yy", "stiffness_orientation"}, {"relaxed", "tensed"});
  numeric::Random random(11);
  for (int i = 1; i <= 12; ++i) {
    for (int j = 1; j <= 3; ++j) {
      for (int c = 0; c < 2; ++c) {
        results.add(i, j,
                    {-1234.5 * random.normal(), 1e-5 * random.normal(), random.normal(), 1e6 * random.normal(),
                     30.0 * random.normal()},
                    c, 0.5);
      }
    }
  }
  const StudyStatistics found = statistics_of(results, comparing(ComparedBy::condition));
  for (const bool details : {false, true}) {
    const std::string text = reliability_text(found, details) + comparison_text(found, details);
    std::size_t columns = 0;
    for (const char c : text) {
      columns = c == '\n' ? 0 : columns + ((static_cast<unsigned char>(c) & 0xC0U) != 0x80U ? 1 : 0);
      ASSERT_LE(columns, 80U) << text;
    }
  }
}

}  // namespace
}  // namespace mbk::statistics
