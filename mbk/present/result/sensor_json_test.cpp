#include "mbk/present/result/sensor_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/schemas.h"

namespace mbk::result {
namespace {

using nlohmann::json;
using testing::HasSubstr;

SensorCalibration calibration() {
  SensorCalibration c;
  c.sources = {{"loads.csv", "CSV", "abc"}};
  c.axes.resize(2);
  c.axes[0].name = "x";
  c.axes[1].name = "y";
  c.axes[0].zero_voltage = 0.063;
  c.axes[0].noise = 0.0012;
  c.axes[1].hysteresis = 0.02;
  c.axes[1].step = 0.0048828125;
  c.axes[0].published = {-8.56, 0.03, 0.54, 0.06, 0.9996};
  c.slope = (Matrix(2, 2) << -8.56, 0.1, 0.2, -8.15).finished();
  c.slope_error = c.crosstalk = c.crosstalk_error = 0.01 * Matrix::Ones(2, 2);
  c.lever_arm = 0.0688;
  c.delay = 0.0086;
  c.zero_voltages = {Eigen::Vector2d(0.063, 0.28)};
  c.rows = 132;
  c.warnings = {{SensorWarningCode::nonlinear, "bent", "look"}};
  c.notes = {"a note"};
  return c;
}

TEST(SensorJson, ReadsBackWhatItWrote) {
  const std::string written = to_json(calibration());
  EXPECT_EQ(schemas::parsed(written)["schema"], "mbk.sensor/1");
  const auto read = sensor_calibration_from_json(written);
  ASSERT_TRUE(read) << read.error().line();
  EXPECT_EQ(to_json(*read), written);
  EXPECT_EQ(read->slope, calibration().slope);
  EXPECT_EQ(read->axes[0].zero_voltage, 0.063);
  EXPECT_EQ(read->warnings[0].code, SensorWarningCode::nonlinear);
  EXPECT_FALSE(read->axes[0].hysteresis);
}

TEST(SensorJson, LeavesOutWhatWasNotFitted) {
  SensorCalibration c = calibration();
  c.crosstalk = c.crosstalk_error = Matrix();
  c.lever_arm.reset();
  const json written = schemas::parsed(to_json(c));
  EXPECT_FALSE(written.contains("crosstalk"));
  EXPECT_FALSE(written.contains("lever_arm"));
  EXPECT_EQ(sensor_calibration_from_json(to_json(c))->crosstalk.size(), 0);
}

TEST(SensorJson, NamesWhatIsWrong) {
  const auto error = [](const std::string& text) { return sensor_calibration_from_json(text).error().line(); };
  EXPECT_THAT(error("{"), HasSubstr("JSON"));
  EXPECT_THAT(error("{\"schema\": \"mbk.result/1\"}"), HasSubstr("mbk.sensor/1"));
  EXPECT_THAT(error("[]"), HasSubstr("calibration"));
  EXPECT_THAT(error("[1e999]"), HasSubstr("number"));
  json document = schemas::parsed(to_json(calibration()));
  const auto with = [&](const char* name, const json& value) {
    json changed = document;
    changed[name] = value;
    return error(changed.dump());
  };
  EXPECT_THAT(with("slope", {{1, 2}}), AllOf(HasSubstr("'slope'"), HasSubstr("2×2")));
  EXPECT_THAT(with("slope", {{1, 2}, {2, 4}}), HasSubstr("'slope'"));
  EXPECT_THAT(with("slope", {{nullptr, 2}, {2, 4}}), HasSubstr("'slope'"));
  EXPECT_THAT(with("axes", json::array()), HasSubstr("'axes'"));
  EXPECT_THAT(with("axes", {1, 2}), HasSubstr("'axes'"));
  EXPECT_THAT(with("lever_arm", -1), HasSubstr("'lever_arm'"));
  document["axes"][0].erase("zero_voltage");
  EXPECT_THAT(error(document.dump()), HasSubstr("'zero_voltage'"));
}

TEST(SensorJson, AWarningOfEachKindIsOneThatTheSchemaKnows) {
  SensorCalibration warned = calibration();
  for (const auto& [code, word] : kWords<SensorWarningCode>) warned.warnings.push_back({code, "so", "again"});
  EXPECT_TRUE(schemas::fits_its_schema(to_json(warned)));
}

}  // namespace
}  // namespace mbk::result
