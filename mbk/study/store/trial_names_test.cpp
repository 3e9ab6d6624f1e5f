#include "mbk/study/store/trial_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "mbk/study/store/identifying.h"
#include "mbk/study/store/store.h"
#include "mbk/study/store/study_summary.h"

namespace mbk::store {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(APattern, TakesWhatItsPlaceholdersStandFor) {
  const NamePattern pattern = NamePattern::of("p{participant}_s{session}_{condition}_{trial}*.mat").value();
  const KnownFacts facts = pattern.match("p07_s2_eyes-closed_13_Jane Doe.mat").value();
  EXPECT_EQ(facts.participant, 7);
  EXPECT_EQ(facts.session, 2);
  EXPECT_EQ(facts.condition, "eyes-closed");
  EXPECT_EQ(facts.trial, 13);
  for (const char* name : {"p07_s2_relaxed_13.h5", "pX_s2_relaxed_13.mat", "p07_s2__13.mat", "p0_s2_relaxed_1.mat",
                           "p99999999999999999999_s2_relaxed_1.mat", ""}) {
    EXPECT_FALSE(pattern.match(name)) << name;
  }
}

TEST(APattern, IsTakenBackWhereItsLongestReadingDoesNotFit) {
  const KnownFacts facts = NamePattern::of("*{participant}{condition}.h5")->match("x12ab.h5").value();
  EXPECT_TRUE(facts.participant);
  EXPECT_TRUE(facts.condition);
}

TEST(APattern, IsRefusedWhereItIsNone) {
  for (const char* pattern : {"{name}.mat", "{participant}{participant}", "{session}.mat", "{participant"}) {
    EXPECT_FALSE(NamePattern::of(pattern)) << pattern;
  }
}

TEST(ARater, IsACodeAndNoName) {
  for (const auto& [text, code] : std::map<std::string, std::string>{
           {"2", "2"}, {"07", "7"}, {"a", "A"}, {"R2", "R2"}, {"pt02", "PT2"}, {"ABC999999999", "ABC999999999"}}) {
    EXPECT_EQ(rater_code(text), code) << text;
  }
  for (const char* text : {"", "0", "Jo", "JD", "Jane", "Jane2", "A 1", "R-2", "R0", "2A", "é1", "A1000000000"}) {
    EXPECT_FALSE(rater_code(text)) << text;
  }
}

TEST(ARater, IsTakenFromNamesSheetsAndMetadata) {
  const NamePattern pattern = NamePattern::of("p{participant}_{rater}_{trial}.h5").value();
  EXPECT_EQ(pattern.match("p07_r02_3.h5")->rater, "R2");
  EXPECT_FALSE(pattern.match("p07_Jane_3.h5"));
  const Sheet sheet = read_sheet("file,participant,rater\na.h5,7,b\nb.h5,7,\n", "").value();
  EXPECT_EQ(sheet.rows[0].facts.rater, "B");
  EXPECT_FALSE(sheet.rows[1].facts.rater);
  const Error refused = read_sheet("file,participant,rater\na.h5,7,Jane\n", "").error();
  EXPECT_THAT(refused.where, HasSubstr("row 2"));
  EXPECT_THAT(refused.line(), testing::Not(HasSubstr("Jane")));
  EXPECT_EQ(facts_of({{"participant", "7"}, {"rater", "A"}}).rater, "A");
  const KnownFacts bids = facts_of_bids("sub-07_ses-2_task-reach_acq-raterB_run-1").value();
  EXPECT_EQ(bids.rater, "B");
  EXPECT_EQ(bids.condition, "reach");
  EXPECT_EQ(facts_of_bids("sub-07_task-reach_acq-raterjane")->condition, "reach-raterjane");
}

TEST(ARater, IdentifiesAPersonUnlessItIsACode) {
  EXPECT_THAT(identifying_entries({{"rater", "Jane Doe"}}), ElementsAre("rater"));
  EXPECT_THAT(identifying_entries({{"rater_name", "x"}}), ElementsAre("rater_name"));
  EXPECT_THAT(identifying_entries({{"rater", "R2"}}), IsEmpty());
  EXPECT_THAT(identifying_entries({{"rater", ""}}), IsEmpty());
}

TEST(ASheet, SaysWhoseEachFileIs) {
  const Sheet sheet = read_sheet(
                          "\xef\xbb\xbf"
                          "File;Participant;Condition;Name;Trial\r\n"
                          "a.mat;7;\"relaxed; seated\";Jane;\r\n"
                          "\"b \"\"2\"\".mat\";8;;Joe;3\r\n",
                          "/data")
                          .value();
  ASSERT_EQ(sheet.rows.size(), 2U);
  EXPECT_EQ(sheet.rows[0].file, "/data/a.mat");
  EXPECT_EQ(sheet.rows[0].facts.participant, 7);
  EXPECT_EQ(sheet.rows[0].facts.condition, "relaxed; seated");
  EXPECT_FALSE(sheet.rows[0].facts.trial);
  EXPECT_EQ(sheet.rows[1].file, "/data/b \"2\".mat");
  EXPECT_EQ(sheet.rows[1].facts.trial, 3);
  EXPECT_THAT(sheet.ignored, ElementsAre("name"));
}

TEST(ASheet, IsRefusedWithItsRow) {
  EXPECT_THAT(read_sheet("file,participant\na.mat,seven\n", "").error().where, HasSubstr("row 2"));
  EXPECT_THAT(read_sheet("file,participant\na.mat,1\nb.mat\n", "").error().where, HasSubstr("row 3"));
  EXPECT_FALSE(read_sheet("file,subject\na.mat,1\n", ""));
  EXPECT_FALSE(read_sheet("", ""));
}

TEST(FactsOfARecording, AreTakenFromItsMetadata) {
  const KnownFacts facts =
      facts_of({{"participant", "12"}, {"condition", "relaxed"}, {"trial", "hold still"}, {"session", "2"}});
  EXPECT_EQ(facts.participant, 12);
  EXPECT_EQ(facts.session, 2);
  EXPECT_EQ(facts.condition, "relaxed");
  EXPECT_FALSE(facts.trial) << "a name is no number";
  EXPECT_FALSE(facts_of({}).complete());
}

TEST(MetadataThatIdentify, AreFoundByTheirNames) {
  for (const char* key : {"name", "Name", "patient_name", "PatientName", "SUBJECT/NAME", "firstName", "last name",
                          "Date of Birth", "birthdate", "DOB", "e-mail", "Subject ID", "patient", "operator_name"}) {
    EXPECT_THAT(identifying_entries({{key, "x"}}), ElementsAre(key));
  }
  for (const char* key : {"participant", "condition", "trial_name", "robot_name", "name_of_robot", "rate_hz",
                          "protocol", "truth_x0", "upper_arm_m", "software", "handedness"}) {
    EXPECT_THAT(identifying_entries({{key, "x"}}), IsEmpty()) << key;
  }
  EXPECT_THAT(identifying_entries({{"name", ""}}), IsEmpty()) << "an empty entry says nothing";
}

TEST(Outcomes, AreTheNumbersOfAResult) {
  const auto outcomes =
      outcomes_of(
          R"({"axes":2,"units":{"K":"N/m","M":"kg"},"model":{"M":[[1,2],[3,null]],"K":[[10,20],[30,40]]},
          "standard_error":{"K":[[1,2],[3,4]]},"fit":{"VAF":[99,98]},
          "ellipses":{"stiffness":{"area":5,"shape":2,"orientation_deg":170}},
          "passivity":{"trial":{"absorbed_J":1.5}}})")
          .value();
  std::map<std::string, Outcome> by_name;
  for (const Outcome& one : outcomes) by_name[one.name] = one;
  EXPECT_EQ(by_name.at("K_yx").value, 30);
  EXPECT_EQ(by_name.at("K_yx").standard_error, 3);
  EXPECT_EQ(by_name.at("K_yx").unit, "N/m");
  EXPECT_EQ(by_name.count("M_yy"), 0U) << "what is undefined is no number";
  EXPECT_FALSE(by_name.at("M_xx").standard_error);
  EXPECT_EQ(by_name.at("VAF_y").value, 98);
  EXPECT_EQ(by_name.at("stiffness_orientation").unit, "°");
  EXPECT_EQ(by_name.at("absorbed_energy").value, 1.5);
  EXPECT_FALSE(outcomes_of("[]"));
  EXPECT_FALSE(outcomes_of("{\"model\":"));
}

TEST(Outcomes, OfStretchesAndEmgAreThoseOfAnExploration) {
  const auto by_name = [](std::string_view document) {
    std::map<std::string, Outcome> all;
    const auto outcomes = outcomes_of(document);
    for (const Outcome& one : outcomes.value()) all[one.name] = one;
    return all;
  };
  const auto stretch = by_name(R"({"units":{"K":"N·m/rad","B":"N·m·s/rad"},"stretch":{"directions":[
      {"direction":1,"slope":{"value":0.1,"interval95":[0.08,0.12]},
       "speeds":[{"mean_torque":{"value":0.4}},{"mean_torque":{"value":0.8},"catch_angle":{"value":2}}]}]}})");
  EXPECT_EQ(stretch.at("stretch_increasing_slope").value, 0.1);
  EXPECT_NEAR(*stretch.at("stretch_increasing_slope").standard_error, 0.02 / 1.96, 1e-5);
  EXPECT_EQ(stretch.at("stretch_increasing_slope").unit, "N·m·s/rad");
  EXPECT_EQ(stretch.at("stretch_increasing_torque").value, 0.8) << "of the fastest";
  EXPECT_NEAR(stretch.at("stretch_increasing_catch").value, 114.592, 1e-3);
  EXPECT_EQ(stretch.count("stretch_increasing_work"), 0U);
  const auto emg = by_name(R"({"emg":{"windows":[{"name":"short latency"}],"channels":[{"name":"emg_biceps",
      "directions":[{"latency":{"value_s":0.025},"windows":[{"ratio":1.5}]},{"latency":null,"windows":[{"ratio":1.0}]}]}]}})");
  EXPECT_EQ(emg.at("emg_biceps_direction1_latency").value, 25.0);
  EXPECT_EQ(emg.at("emg_biceps_direction1_short_latency").value, 1.5);
  EXPECT_EQ(emg.count("emg_biceps_direction2_latency"), 0U);
}

TEST(Outcomes, OfThreeAxesHaveNineElementsAndTheEllipsoid) {
  const auto outcomes = outcomes_of(
                            R"({"axes":3,"units":{"K":"N/m","M":"kg","x0":"m"},
          "model":{"K":[[11,12,13],[21,22,23],[31,32,33]],"x0":[1,2,3]},
          "standard_error":{"K":[[1,2,3],[4,5,6],[7,8,9]]},"fit":{"VAF":[99,98,97]},
          "ellipsoids":{"inertia":{"volume":null,"shape":null},"stiffness":{"volume":5,"shape":2}},
          "antisymmetry_vectors":{"stiffness":{"vector":[0,0,1],"size":1,"percent":4.5}}})")
                            .value();
  std::map<std::string, Outcome> by_name;
  for (const Outcome& one : outcomes) by_name[one.name] = one;
  EXPECT_EQ(by_name.at("K_xz").value, 13);
  EXPECT_EQ(by_name.at("K_zz").value, 33);
  EXPECT_EQ(by_name.at("K_zy").standard_error, 8);
  EXPECT_EQ(by_name.at("x0_z").value, 3);
  EXPECT_EQ(by_name.at("VAF_z").value, 97);
  EXPECT_EQ(by_name.at("stiffness_ellipsoid_volume").value, 5);
  EXPECT_EQ(by_name.at("stiffness_ellipsoid_volume").unit, "(N/m)³");
  EXPECT_EQ(by_name.at("stiffness_ellipsoid_shape").value, 2);
  EXPECT_EQ(by_name.at("stiffness_zmean").value, 4.5);
  EXPECT_EQ(by_name.count("inertia_ellipsoid_volume") + by_name.count("stiffness_area"), 0U);
}

TEST(Outcomes, HaveNoOrientationOfAnEllipseThatMayBeRound) {
  const auto has = [](const std::string& interval) {
    const auto outcomes = outcomes_of(
        R"({"axes":2,"model":{"K":[[1,0],[0,1]]},"ellipses":{"stiffness":{"shape":1,"orientation_deg":30,"interval95":)"
        R"({"orientation_deg":)" +
        interval + "}}}}");
    EXPECT_TRUE(outcomes);
    return std::ranges::any_of(*outcomes, [](const Outcome& one) { return one.name == "stiffness_orientation"; });
  };
  EXPECT_TRUE(has("[10, 50]"));
  EXPECT_TRUE(has("[-20, 150]"));
  EXPECT_TRUE(has("null"));
  EXPECT_FALSE(has("[-60, 120]"));
}

TEST(Outcomes, AreTheSameWhateverStandsInTheCurvesOfModels) {
  const auto absorbed = [](const std::string& models, const std::string& text) {
    const auto outcomes = outcomes_of(R"({"axes":1,"model":{"K":[[1]]},"passivity":{"models":)" + models +
                                      R"(,"note":")" + text + R"(","trial":{"absorbed_J":1.5}}})");
    return outcomes && outcomes->size() == 2 ? outcomes->back().value : -1.0;
  };
  for (const char* text : {"", "]", R"(\"models\":[)", R"(\"models\":[ \\)"}) {
    for (const char* models : {"[]", "[1,[2,[3]]]", R"([{"name":"]\"[","models":[[]]},"\\"])", "null", "7", "{}"}) {
      EXPECT_EQ(absorbed(models, text), 1.5) << models << ", " << text;
    }
    EXPECT_EQ(absorbed("[[1,2]", text), -1.0) << "a list that never ends";
  }
}

/// Results of one outcome under one condition.
OutcomeColumns table_of(const std::string& outcome, const std::vector<std::pair<int, double>>& values) {
  OutcomeColumns columns{{"relaxed"}, {}, {{outcome, "N/m", {}, {}}}};
  for (const auto& [participant, value] : values) {
    columns.trials.push_back({std::ssize(columns.trials), participant, 1, 1, 0});
    columns.outcomes[0].values.push_back(value);
  }
  return columns;
}

TEST(ASummary, CountsEachParticipantOnce) {
  const auto summaries = summarise_outcomes(table_of("K", {{1, 100}, {1, 110}, {1, 120}, {2, 150}}));
  ASSERT_EQ(summaries.size(), 1U);
  EXPECT_DOUBLE_EQ(summaries[0].mean, 130.0);  // of 110 and 150
  EXPECT_DOUBLE_EQ(summaries[0].standard_deviation, 20.0 * std::sqrt(2.0));
  EXPECT_EQ(summaries[0].results, 4);
  EXPECT_EQ(summaries[0].participants, 2);
  EXPECT_EQ(summaries[0].minimum, 100);
  EXPECT_EQ(summaries[0].maximum, 150);
}

TEST(ASummary, OfAnAxisKnowsThat179IsBeside1) {
  const OutcomeSummary summary = summarise_outcomes(table_of("stiffness_orientation", {{1, 179}, {2, 3}}))[0];
  EXPECT_NEAR(summary.mean, 1.0, 1e-9);
  EXPECT_NEAR(summary.standard_deviation, 2.0, 1e-3);
}

TEST(ASummary, OfOneParticipantHasNoDeviation) {
  EXPECT_TRUE(std::isnan(summarise_outcomes(table_of("K", {{1, 5}, {1, 7}}))[0].standard_deviation));
}

TEST(BidsNames, SayWhoseTrialItIs) {
  const auto facts = facts_of_bids("sub-07_ses-2_task-reach_acq-fast_tracksys-robot_run-01_motion");
  ASSERT_TRUE(facts);
  EXPECT_EQ(facts->participant, 7);
  EXPECT_EQ(facts->session, 2);
  EXPECT_EQ(facts->condition, "reach-fast");
  EXPECT_EQ(facts->trial, 1);
  EXPECT_EQ(facts_of_bids("sub-1_task-unnamed_motion")->condition, "");
  EXPECT_EQ(facts_of_bids("sub-1_motion")->condition, std::nullopt);
  for (const char* name : {"sub-jane_task-x", "sub-0_task-x", "sub-_task-x", "sub-1_ses-pre_task-x", "sub-1_run-a"}) {
    EXPECT_FALSE(facts_of_bids(name)) << name;
  }
}

TEST(BidsNames, LabelsAreLettersAndDigits) {
  EXPECT_EQ(bids_label("stiff_100%"), "stiff100");
  EXPECT_EQ(bids_label(""), "unnamed");
  EXPECT_EQ(bids_label("–"), "other");
  EXPECT_TRUE(is_bids_label("stiff100", "stiff 100"));
  EXPECT_TRUE(is_bids_label("stiff100x2", "stiff 100"));
  EXPECT_FALSE(is_bids_label("stiff100x", "stiff 100"));
  EXPECT_FALSE(is_bids_label("stiff1000", "stiff 100"));
}

}  // namespace
}  // namespace mbk::store
