#include "mbk/present/result/robot_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "mbk/base/core/nan.h"
#include "mbk/model/robot/single_joint.h"
#include "tests/support/schemas.h"

namespace mbk::result {
namespace robot_json_test {

using Json = nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A drive with a mass, viscous friction that is known, Stribeck friction and an offset; numbers need all their digits.
RobotIdentification identified() {
  RobotIdentification found;
  found.model.mechanism = std::make_shared<robot::SingleJoint>(robot::SingleJoint::Options{});
  found.model.drive = {.coulomb = false, .stribeck = true, .smoothing = 0.003, .stribeck_velocity = 0.07};
  found.model.parameters = Eigen::Vector4d(95.1 / 3.0, 203.5, -0.1 / 7.0, 1.0 / 3.0);
  found.model.covariance = Matrix::Zero(4, 4);
  found.model.covariance(0, 0) = 0.01 / 3.0;
  found.model.covariance(0, 3) = found.model.covariance(3, 0) = -0.001 / 3.0;
  found.model.covariance(3, 3) = 0.04;
  found.model.delay = 0.4e-3 / 3.0;
  found.delay_standard_error = 1e-5;
  const std::vector<robot::Coefficient> names = found.model.coefficients();
  for (Index k = 0; k < 4; ++k) {
    found.coefficients.push_back({names[static_cast<std::size_t>(k)], found.model.parameters[k],
                                  std::sqrt(found.model.covariance(k, k)), true, false, ""});
  }
  found.coefficients[0].together_with = "+ 1·motor_inertia_1";
  found.coefficients[1].fixed = true;
  found.coefficients[2].identified = false;
  found.coefficients[2].standard_error = kNaN;
  found.fit.push_back({98.5, 2.3, 99.1, 2.1, 97.5});
  found.smoothed_cutoff = 6.0;
  found.held_out_files = {"judge.csv"};
  found.rank = 2;
  found.structural_rank = 4;
  found.condition = 4.5;
  found.weakest = {{"offset_1", -0.7}};
  found.inertia = {31.7, {0.0}, 31.7};
  found.description = "[robot]\nkind = \"one_axis\"\n# M in \"kg\"\n";
  found.urdf = "<robot/>";
  found.preparations.emplace_back();
  found.sources.push_back({"a.csv", "CSV", "abc"});
  found.durations = {20.0};
  found.rates = {1000.0};
  found.warnings.push_back({WarningCode::torque_unit, "so", "again"});
  found.usable = false;
  return found;
}

TEST(RobotJson, ComesBackDigitForDigit) {
  const RobotIdentification found = identified();
  const auto stored = robot_from_json(to_json(found));
  ASSERT_TRUE(stored) << stored.error().line();
  EXPECT_EQ(stored->parameters, found.model.parameters);
  EXPECT_EQ(stored->covariance, found.model.covariance);
  EXPECT_EQ(stored->delay, found.model.delay);
  EXPECT_THAT(stored->names, ElementsAre("mass", "viscous_1", "stribeck_1", "offset_1"));
  EXPECT_TRUE(stored->drive.viscous && stored->drive.stribeck && stored->drive.offset);
  EXPECT_FALSE(stored->drive.coulomb || stored->drive.cable || stored->drive.motor_inertia);
  EXPECT_EQ(stored->drive.smoothing, 0.003);
  EXPECT_EQ(stored->drive.stribeck_velocity, 0.07);
  EXPECT_EQ(stored->description, found.description);
  EXPECT_EQ(stored->urdf, found.urdf);
  EXPECT_FALSE(stored->usable);
  EXPECT_THAT(stored->warnings, ElementsAre("torque-unit"));
}

TEST(RobotJson, SaysHowEachCoefficientWasFound) {
  const Json json = schemas::parsed(to_json(identified()));
  EXPECT_EQ(json["schema"], "mbk.robot/1");
  const Json& parameters = json["parameters"];
  EXPECT_EQ(parameters[0]["together_with"], "+ 1·motor_inertia_1");
  EXPECT_EQ(parameters[1]["fixed"], true);
  EXPECT_FALSE(parameters[0].contains("fixed"));
  EXPECT_EQ(parameters[2]["identified"], false);
  EXPECT_TRUE(parameters[2]["standard_error"].is_null());
  EXPECT_EQ(json["fit"][0]["VAF_from_smoothed_motion"], 97.5);
  EXPECT_EQ(json["smoothed_motion_cutoff_hz"], 6.0);
  EXPECT_EQ(json["held_out_files"], Json::array({"judge.csv"}));
  EXPECT_EQ(json["excitation"]["weakest"][0]["name"], "offset_1");
  EXPECT_EQ(json["inputs"][0]["rate_hz"], 1000.0);
  EXPECT_EQ(json["warnings"][0]["code"], "torque-unit");
  EXPECT_EQ(json["usable"], false);
  EXPECT_FALSE(json.contains("instruments"));
}

TEST(RobotJson, HoldsTheRobotThatCanExist) {
  RobotIdentification found = identified();
  EXPECT_FALSE(schemas::parsed(to_json(found)).contains("consistent"));
  ConsistentRobot one;
  one.bodies.push_back({"forearm", {1.5, {0.01, 0.0, -0.12}, Eigen::Vector3d(0.02, 0.021, 0.003).asDiagonal()}, 4e-4});
  one.combinations.push_back({"forearm.mass_z", "kg·m", "+ 0.25·hand.mass", 0.31, 0.3, 0.01});
  one.combinations.push_back({"offset_1", "N", "", 0.2, 0.2, kNaN});
  one.free_fit = found.fit;
  one.vaf_lost = {0.125};
  one.vaf_lost_in_sample = {kNaN};
  one.mean_vaf_lost = 0.125;
  one.loss = 1.5;
  one.gap = 0.01;
  one.newton_steps = 12;
  one.pressing = {"forearm"};
  found.consistent = std::move(one);
  const Json json = schemas::parsed(to_json(found))["consistent"];
  EXPECT_EQ(json["links"][0]["mass_kg"], 1.5);
  EXPECT_EQ(json["links"][0]["centre_m"], Json::array({0.01, 0.0, -0.12}));
  EXPECT_EQ(json["links"][0]["inertia_about_centre_kg_m2"][1][1], 0.021);
  EXPECT_EQ(json["links"][0]["pseudo_inertia_smallest_eigenvalue"], 4e-4);
  EXPECT_EQ(json["combinations"][0]["together_with"], "+ 0.25·hand.mass");
  EXPECT_EQ(json["combinations"][0]["free_value"], 0.3);
  EXPECT_FALSE(json["combinations"][1].contains("together_with"));
  EXPECT_TRUE(json["combinations"][1]["standard_error"].is_null());
  EXPECT_EQ(json["free_fit"][0]["VAF"], 98.5);
  EXPECT_EQ(json["VAF_lost"], Json::array({0.125}));
  EXPECT_TRUE(json["VAF_lost_in_sample"][0].is_null());
  EXPECT_EQ(json["loss"], 1.5);
  EXPECT_EQ(json["pressing"], Json::array({"forearm"}));
}

TEST(RobotJson, NamesTheInstrumentsWhereTheyWereUsed) {
  RobotIdentification found = identified();
  found.method = RobotMethod::instrumental_variables;
  found.instrument_motion = InstrumentMotion::smoothed;
  found.motion_cutoff = 5.0;
  const Json smoothed = schemas::parsed(to_json(found));
  EXPECT_EQ(smoothed["instruments"], "smoothed motion");
  EXPECT_EQ(smoothed["motion_cutoff_hz"], 5.0);
  found.instrument_motion = InstrumentMotion::hand_reference;
  EXPECT_FALSE(schemas::parsed(to_json(found)).contains("motion_cutoff_hz"));
}

template <typename Change>
void expect_malformed(const char* says, Change change) {
  Json json = schemas::parsed(to_json(identified()));
  change(json);
  const auto stored = robot_from_json(json.dump());
  ASSERT_FALSE(stored) << says;
  EXPECT_EQ(stored.error().kind, ErrorKind::data);
  EXPECT_THAT(stored.error().line(), HasSubstr(says));
  EXPECT_THAT(stored.error().line(), HasSubstr("mbk robot identify --json"));
}

TEST(RobotJson, NamesWhatIsMalformed) {
  expect_malformed("mbk.robot/1", [](Json& json) { json["schema"] = "mbk.robot/2"; });
  expect_malformed("mbk.robot/1", [](Json& json) { json.erase("schema"); });
  expect_malformed("drive", [](Json& json) { json.erase("drive"); });
  expect_malformed("\"magic\"", [](Json& json) { json["drive"]["terms"].push_back("magic"); });
  expect_malformed("velocity", [](Json& json) { json["drive"]["smoothing"] = -1.0; });
  expect_malformed("name", [](Json& json) { json["parameters"][0].erase("name"); });
  expect_malformed("string", [](Json& json) { json["parameters"][0]["value"] = "7"; });
  expect_malformed("number", [](Json& json) { json["parameters"][0]["value"] = nullptr; });
  expect_malformed("4×4", [](Json& json) { json["covariance"].erase(0); });
  expect_malformed("4×4", [](Json& json) { json["covariance"][2].push_back(0.0); });
  expect_malformed("'covariance'", [](Json& json) { json.erase("covariance"); });
  expect_malformed("delay", [](Json& json) { json["motor_delay_s"] = 40.0; });
  expect_malformed("motor_delay_s", [](Json& json) { json.erase("motor_delay_s"); });
}

TEST(RobotJson, RefusesACovarianceThatNoNumbersHave) {
  expect_malformed("'covariance'", [](Json& json) { json["covariance"][0][0] = -0.1; });
  expect_malformed("'covariance'", [](Json& json) { json["covariance"][0][3] = 0.001; });  // not symmetric
  expect_malformed("'covariance'", [](Json& json) { json["covariance"][0][1] = json["covariance"][1][0] = 0.1; });
  expect_malformed("'covariance'", [](Json& json) { json["covariance"][3][3] = nullptr; });
}

TEST(RobotJson, NamesTheByteWhereTheTextBreaksOff) {
  const std::string whole = to_json(identified());
  const auto stored = robot_from_json(std::string_view(whole).substr(0, 100));
  ASSERT_FALSE(stored);
  EXPECT_THAT(stored.error().line(), AllOf(HasSubstr("JSON"), HasSubstr("byte 101")));
  for (const char* const text : {"", "[]", "7", "null", "{\"schema\": 7}"}) EXPECT_FALSE(robot_from_json(text)) << text;
}

TEST(ForceJson, HasTheSummaryAndOnlyWhatIsKnown) {
  ForceSummary force;
  force.source = ForceSource::observer;
  force.lag = 0.025;
  force.rms = Eigen::Vector2d(1.5, 2.5);
  force.peak = Eigen::Vector2d(4.0, 5.0);
  force.notes = {"so"};
  Json json = schemas::parsed(to_json(force));
  EXPECT_EQ(json["schema"], "mbk.force/1");
  EXPECT_EQ(json["force_source"], "observer");
  EXPECT_EQ(json["RMS"], Json::array({1.5, 2.5}));
  EXPECT_EQ(json["peak"], Json::array({4.0, 5.0}));
  EXPECT_FALSE(json.contains("standard_error_RMS"));
  EXPECT_FALSE(json.contains("force_comparison"));
  force.standard_error = Eigen::Vector2d(0.1, 0.2);
  force.comparison.emplace();
  json = schemas::parsed(to_json(force));
  EXPECT_EQ(json["standard_error_RMS"], Json::array({0.1, 0.2}));
  EXPECT_TRUE(json.contains("force_comparison"));
}

}  // namespace robot_json_test
}  // namespace mbk::result
