#include "mbk/present/result/report_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mbk/base/core/nan.h"
#include "tests/support/schemas.h"

namespace mbk::result {
namespace report_json_test {

using Json = nlohmann::json;

Measurement measured() {
  Identification id;
  id.axes = 1;
  id.motion = Motion::rotation;
  const Matrix one = Matrix::Constant(1, 1, 1.0);
  id.model = {one, 2.0 * one, kNaN * one, Vector::Constant(1, 0.1)};
  id.standard_error = {0.1 * one, 0.2 * one, kNaN * one, Vector::Constant(1, 0.01)};
  id.covariance = Matrix::Identity(4, 4);
  id.parameters = {"m", "b", "k", "x0"};
  id.fit.vaf = id.fit.rmse = id.fit.vaf_in_sample = Vector::Constant(1, 90.0);
  id.sources = {{"a </script> b.mat", "MAT v7", "00"}};
  id.durations = {10.0};
  id.rates = {1000.0};
  return {id, std::nullopt};
}

Diagnostics diagnostics() {
  Diagnostics d;
  d.prediction.time = (Vector(3) << 1.0, kNaN, 1234.567891).finished();
  d.prediction.measured = (Matrix(3, 1) << 1.23456789, kNaN, 1e-9).finished();
  d.prediction.predicted = d.prediction.residual = Matrix::Zero(3, 1);
  d.spectra.segments = 11;
  d.double_integral = {Vector::Constant(1, 2e-5), Vector::Constant(1, 99.97654321)};
  d.spectra.position = (Matrix(2, 2) << 1, 2, 3, 4).finished();
  return d;
}

TEST(ReportJson, HoldsTheResultJustAsItIsWrittenAlone) {
  const std::string alone = to_json(measured());
  const std::string text = to_json(Report{{{measured(), {}, std::nullopt}}, std::nullopt, "mbk measure", ""});
  EXPECT_NE(text.find("\"result\":" + alone), std::string::npos);
  const Json json = schemas::parsed(text);
  EXPECT_EQ(json["schema"], "mbk.report/1");
  EXPECT_EQ(json["result"], Json::parse(alone));
  EXPECT_EQ(json["command"], "mbk measure");
  EXPECT_FALSE(json.contains("note"));
}

TEST(ReportJson, HoldsSeveralResultsJustAsTheyAreWrittenAlone) {
  Summary summary;
  summary.trials = 2;
  summary.mean = measured().identification.model;
  summary.between_trial_standard_error = summary.half_width95 = measured().identification.standard_error;
  const SeveralTrials together{summary, "", {}};
  const Report report{{{measured(), {}, std::nullopt}, {measured(), {}, std::nullopt}}, together, "", "by A. B."};
  const Json json = schemas::parsed(to_json(report));
  EXPECT_EQ(json["result"], schemas::parsed(to_json(std::vector<Measurement>{measured(), measured()}, together)));
  EXPECT_EQ(json["trials"].size(), 2U);
  EXPECT_EQ(json["note"], "by A. B.");
}

TEST(ReportJson, WritesSignalsByAxisWithSixDigitsAndUndefinedNumbersAsNull) {
  const Json json = schemas::parsed(to_json(Report{{{measured(), {}, diagnostics()}}, std::nullopt, "", ""}));
  const Json& d = json["trials"][0]["diagnostics"];
  EXPECT_EQ(d["prediction"]["measured"], Json::parse("[[1.23457, null, 1e-9]]"));
  EXPECT_EQ(d["prediction"]["time_s"], Json::parse("[1, null, 1234.56789]"));
  EXPECT_EQ(d["spectra"]["position"], Json::parse("[[1, 3], [2, 4]]"));
  EXPECT_EQ(d["spectra"]["segments"], 11);
  EXPECT_EQ(d["double_integral"], Json::parse("{\"rms_difference\": [2e-5], \"VAF\": [99.9765]}"));
  EXPECT_EQ(d["recording"]["reference"], Json::array());
  EXPECT_FALSE(d.contains("acceleration"));
}

TEST(ReportJson, WritesAnAccelerometerWhereThereIsOne) {
  Diagnostics with = diagnostics();
  with.acceleration = AccelerationAgreement{Vector::Zero(1), Matrix::Ones(1, 2), Matrix::Zero(1, 2),
                                            Vector::Constant(2, 0.5), Vector::Constant(2, kNaN)};
  const Json json = schemas::parsed(to_json(Report{{{measured(), {}, with}}, std::nullopt, "", ""}));
  const Json& a = json["trials"][0]["diagnostics"]["acceleration"];
  EXPECT_EQ(a["derivative"], Json::parse("[[1], [1]]"));
  EXPECT_EQ(a["rms_difference"], Json::parse("[0.5, 0.5]"));
  EXPECT_EQ(a["VAF"], Json::parse("[null, null]"));
}

TEST(ReportJson, WritesMetadataAndPosture) {
  const ArmPosture posture{ArmPosture::Of::arm, {{0.0, -0.5}, {0.24, -0.32}, {0.0, 0.0}}, "a note"};
  const RecordingFacts facts{{{"participant", "P1"}, {"bad", "\xff"}}, posture};
  const Json json = schemas::parsed(to_json(Report{{{measured(), {facts}, std::nullopt}}, std::nullopt, "", ""}));
  const Json& one = json["trials"][0]["recordings"][0];
  EXPECT_EQ(one["metadata"]["participant"], "P1");
  EXPECT_EQ(one["metadata"]["bad"], "\uFFFD");
  EXPECT_EQ(one["posture"]["of"], "arm");
  EXPECT_EQ(one["posture"]["points_m"], Json::parse("[[0, -0.5], [0.24, -0.32], [0, 0]]"));
  EXPECT_EQ(one["posture"]["note"], "a note");
}

}  // namespace report_json_test
}  // namespace mbk::result
