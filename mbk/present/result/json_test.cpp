#include "mbk/present/result/json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <utility>

#include "mbk/base/core/nan.h"
#include "tests/support/schemas.h"

namespace mbk::result {
namespace json_test {

using Json = nlohmann::json;
using testing::HasSubstr;

/// Numbers that need all of their digits.
Measurement measured(int axes) {
  std::mt19937 random(7);
  const auto number = [&] { return (static_cast<double>(random()) + 0.1) / 3.0e7 - 70.0; };
  const auto fill = [&](Matrix& matrix, Index rows, Index columns) {
    matrix.resize(rows, columns);
    for (double& value : matrix.reshaped()) value = number();
  };
  Measurement result;
  Identification& id = result.identification;
  const Index n = axes;
  for (impedance::Model* model : {&id.model, &id.standard_error}) {
    fill(model->M, n, n);
    fill(model->B, n, n);
    fill(model->K, n, n);
    Matrix x0;
    fill(x0, n, 1);
    model->x0 = x0;
  }
  fill(id.covariance, 3 * n * n + n, 3 * n * n + n);
  id.axes = axes;
  id.parameters.assign(static_cast<std::size_t>(3 * n * n + n), "p");
  id.fit = {Vector::Constant(n, 97.1), Vector::Constant(n, 0.31), Vector::Constant(n, 98.7), true};
  id.preparations.emplace_back();
  id.sources.push_back({"a.mat", "MAT v7", "abc"});
  id.durations = {62.0};
  id.rates = {1000.0};
  id.warnings.push_back({WarningCode::fit_poor, "so \"so\"", "again\n"});
  id.parameters_from = ParametersFrom::identification;
  if (axes == 2) {
    result.findings.emplace();
    result.findings->ellipses[0].ellipse.area = 4.0;
  } else if (axes == 3) {
    result.spatial.emplace();
    for (EllipsoidFinding& finding : result.spatial->ellipsoids) {
      finding.symmetric = Matrix::Identity(3, 3);
      for (PrincipalDirection& one : finding.principal) {
        one = {3.5, {3.0, 4.0}, Eigen::Vector3d::UnitX(), 0.5 * std::numbers::pi};
      }
      finding.volume = finding.shape = kNaN;
    }
    for (CirculationFinding& finding : result.spatial->antisymmetry) {
      finding.vector = Eigen::Vector3d(0.1, 0.2, -0.3);
      finding.vector95[2] = {-0.5, -0.1};
    }
  } else {
    id.motion = Motion::rotation;
  }
  return result;
}

Identification read_back(const std::string& text) {
  auto all = identifications_from_json(text);
  EXPECT_TRUE(all) << all.error().line();
  return all ? all->at(0) : Identification{};
}

class BothAxes : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(All, BothAxes, testing::Values(1, 2, 3));

TEST_P(BothAxes, ModelCovarianceFitWarningsAndInputsComeBackToTheLastBit) {
  const Identification id = measured(GetParam()).identification;
  const Identification back = read_back(to_json(measured(GetParam())));
  EXPECT_EQ(back.axes, id.axes);
  EXPECT_EQ(back.model.M, id.model.M);
  EXPECT_EQ(back.model.B, id.model.B);
  EXPECT_EQ(back.model.K, id.model.K);
  EXPECT_EQ(back.model.x0, id.model.x0);
  EXPECT_EQ(back.standard_error.K, id.standard_error.K);
  EXPECT_EQ(back.covariance, id.covariance);
  EXPECT_EQ(back.parameters, id.parameters);
  EXPECT_EQ(back.fit.vaf, id.fit.vaf);
  EXPECT_EQ(back.fit.rmse, id.fit.rmse);
  EXPECT_EQ(back.fit.vaf_in_sample, id.fit.vaf_in_sample);
  EXPECT_EQ(back.fit.held_out, id.fit.held_out);
  EXPECT_EQ(back.motion, id.motion);
  EXPECT_EQ(back.usable, id.usable);
  ASSERT_EQ(back.warnings.size(), 1u);
  EXPECT_EQ(back.warnings[0].code, WarningCode::fit_poor);
  EXPECT_EQ(back.warnings[0].message, "so \"so\"");
  EXPECT_EQ(back.warnings[0].remedy, "again\n");
  ASSERT_EQ(back.sources.size(), 1u);
  EXPECT_EQ(back.sources[0].sha256, "abc");
  EXPECT_EQ(back.durations, id.durations);
  EXPECT_EQ(back.rates, id.rates);
}

TEST_P(BothAxes, HasEveryFieldOfTheInterfaceInItsShape) {
  const std::size_t n = static_cast<std::size_t>(GetParam());
  const Json json = schemas::parsed(to_json(measured(GetParam())));
  EXPECT_EQ(json.at("schema"), "mbk.result/2");
  EXPECT_THAT(json.at("software").get<std::string>(), testing::StartsWith("mbk "));
  EXPECT_EQ(json.at("inputs").at(0).at("file"), "a.mat");
  EXPECT_EQ(json.at("inputs").at(0).at("sha256"), "abc");
  EXPECT_EQ(json.at("inputs").at(0).at("duration_s"), 62.0);
  EXPECT_EQ(json.at("inputs").at(0).at("rate_hz"), 1000.0);
  EXPECT_EQ(json.at("mode"), "default");
  EXPECT_EQ(json.at("protocol"), "free");
  EXPECT_EQ(json.at("method"), "ls");
  for (const char* part : {"model", "standard_error"}) {
    for (const char* matrix : {"M", "B", "K"}) {
      ASSERT_EQ(json.at(part).at(matrix).size(), n);
      for (const Json& row : json.at(part).at(matrix)) EXPECT_EQ(row.size(), n);
    }
    ASSERT_EQ(json.at(part).at("x0").size(), n);
    EXPECT_TRUE(json.at(part).at("x0").at(0).is_number());
  }
  EXPECT_EQ(json.at("fit").at("VAF").size(), n);
  EXPECT_EQ(json.at("fit").at("RMSE").size(), n);
  EXPECT_EQ(json.at("fit").at("validated_on"), "held-out");
  EXPECT_EQ(json.at("alternatives"), Json::array());
  EXPECT_TRUE(json.at("disagreement").is_null());
  EXPECT_EQ(json.at("warnings").at(0).at("code"), "fit-poor");
  EXPECT_TRUE(json.at("warnings").at(0).contains("message"));
  EXPECT_TRUE(json.at("warnings").at(0).contains("try"));
  EXPECT_EQ(json.at("usable"), true);
  EXPECT_EQ(json.contains("ellipses"), n == 2);
  EXPECT_EQ(json.contains("antisymmetry"), n == 2);
  EXPECT_EQ(json.contains("ellipsoids"), n == 3);
  EXPECT_EQ(json.contains("antisymmetry_vectors"), n == 3);
  EXPECT_EQ(json.at("axes"), n);
}

TEST(ToJson, EllipsoidsHaveTheirPrincipalDirections) {
  const Json json = schemas::parsed(to_json(measured(3)));
  for (const char* matrix : {"inertia", "damping", "stiffness"}) {
    const Json& one = json.at("ellipsoids").at(matrix);
    ASSERT_EQ(one.at("principal").size(), 3u);
    for (const Json& principal : one.at("principal")) {
      EXPECT_EQ(principal.at("value"), 3.5);
      EXPECT_EQ(principal.at("value95"), Json({3.0, 4.0}));
      EXPECT_EQ(principal.at("direction"), Json({1.0, 0.0, 0.0}));
      EXPECT_EQ(principal.at("half_angle95_deg"), 90.0);
    }
    EXPECT_TRUE(one.at("volume").is_null() && one.at("shape").is_null()) << "undefined without an ellipsoid";
    EXPECT_EQ(one.at("closed"), false);
    EXPECT_EQ(one.at("symmetric_part").at(2), Json({0.0, 0.0, 1.0}));
    for (const char* number : {"volume", "shape"}) EXPECT_EQ(one.at("interval95").at(number).size(), 2u);
  }
  for (const char* matrix : {"inertia", "stiffness"}) {
    const Json& one = json.at("antisymmetry_vectors").at(matrix);
    EXPECT_EQ(one.at("vector"), Json({0.1, 0.2, -0.3}));
    EXPECT_EQ(one.at("vector95").at(2), Json({-0.5, -0.1}));
    EXPECT_EQ(one.at("size95").size(), 2u);
    EXPECT_EQ(one.at("significant"), false);
    EXPECT_TRUE(one.contains("size") && one.contains("percent"));
  }
}

TEST(ToJson, TheEllipseDocumentHasTheShapesOfEachNumberOfAxes) {
  const std::vector<Measurement> both = {measured(2), measured(3)};
  const Json json = schemas::parsed(ellipses_json(both));
  EXPECT_EQ(json.at("schema"), "mbk.ellipses/1");
  for (const std::size_t k : {0u, 1u}) {
    const Json& one = json.at("results").at(k);
    EXPECT_EQ(one.at("schema"), "mbk.ellipse/1");
    EXPECT_EQ(one.at("inputs").at(0).at("file"), "a.mat");
    const Json whole = schemas::parsed(to_json(both[k]));
    for (const char* part : {"ellipses", "antisymmetry", "ellipsoids", "antisymmetry_vectors"}) {
      EXPECT_EQ(one.value(part, Json()), whole.value(part, Json())) << part;
    }
  }
}

TEST(ToJson, EllipsesHaveTheirIntervals) {
  const Json json = schemas::parsed(to_json(measured(2)));
  for (const char* matrix : {"inertia", "damping", "stiffness"}) {
    const Json& one = json.at("ellipses").at(matrix);
    for (const char* number : {"area", "shape", "orientation_deg"}) {
      EXPECT_TRUE(one.contains(number));
      EXPECT_EQ(one.at("interval95").at(number).size(), 2u);
    }
  }
  for (const char* matrix : {"inertia", "stiffness"}) {
    const Json& one = json.at("antisymmetry").at(matrix);
    EXPECT_TRUE(one.contains("value") && one.contains("zmean_percent"));
    EXPECT_EQ(one.at("interval95").size(), 2u);
  }
}

TEST(ToJson, MatricesAreWrittenRowByRow) {
  const Measurement two = measured(2);
  const Json json = schemas::parsed(to_json(two));
  EXPECT_EQ(json.at("model").at("M").at(0).at(1).get<double>(), two.identification.model.M(0, 1));
  EXPECT_EQ(json.at("covariance").at("matrix").at(3).at(7).get<double>(), two.identification.covariance(3, 7));
}

TEST(ToJson, WhatIsUndefinedIsNullAndComesBackAsNaN) {
  Measurement undefined = measured(2);
  undefined.identification.model.x0[1] = kNaN;
  undefined.identification.fit.vaf[0] = -std::numeric_limits<double>::infinity();
  const std::string text = to_json(undefined);
  EXPECT_TRUE(schemas::parsed(text).at("model").at("x0").at(1).is_null());
  EXPECT_TRUE(std::isnan(read_back(text).model.x0[1]));
  EXPECT_TRUE(std::isnan(read_back(text).fit.vaf[0]));
}

TEST(ToJson, BytesThatAreNoTextDoNotStopIt) {
  Measurement odd = measured(1);
  odd.identification.sources[0].path = "M\xfcller.csv";  // Latin-1
  odd.identification.notes.push_back("\xff\xfe");
  const std::string text = to_json(odd);
  EXPECT_TRUE(Json::accept(text));
  EXPECT_THAT(text, HasSubstr("ller.csv"));
  Recording recording;
  recording.metadata["name"] = "\x80";
  EXPECT_TRUE(Json::accept(to_json(std::vector{recording}, std::vector{Inspection{}})));
}

TEST(ToJson, SeveralResultsComeBackInTheirOrder) {
  const std::vector<Measurement> both = {measured(1), measured(2)};
  const auto back = identifications_from_json(to_json(both, SeveralTrials{}));
  ASSERT_TRUE(back) << back.error().line();
  ASSERT_EQ(back->size(), 2u);
  EXPECT_EQ(back->at(0).axes, 1);
  EXPECT_EQ(back->at(1).axes, 2);
}

TEST(ToJson, ASummaryHasItsMeanAndError) {
  Summary summary;
  summary.trials = 2;
  summary.omitted = {{"c.mat", "not usable"}};
  summary.mean = summary.between_trial_standard_error = summary.half_width95 = measured(2).identification.model;
  const SeveralTrials together{summary, "", {{ErrorKind::data, "no such file", "check the name", "d.mat"}}};
  const Json json = schemas::parsed(to_json(std::vector<Measurement>{measured(2), measured(2)}, together));
  EXPECT_EQ(json.at("schema"), "mbk.results/1");
  EXPECT_EQ(json.at("results").size(), 2u);
  EXPECT_EQ(json.at("summary").at("trials"), 2);
  EXPECT_EQ(json.at("summary").at("model").at("K").size(), 2u);
  EXPECT_TRUE(json.at("summary").contains("between_trial_standard_error"));
  EXPECT_EQ(json.at("summary").at("omitted").at(0).at("file"), "c.mat");
  EXPECT_EQ(json.at("failed").at(0).at("file"), "d.mat");
  const Json none = schemas::parsed(to_json(std::vector<Measurement>{measured(2), measured(2)}, {{}, "why", {}}));
  EXPECT_FALSE(none.contains("summary"));
  EXPECT_EQ(none.at("no_summary"), "why");
}

TEST(FromJson, WithoutACovarianceTakesTheStandardErrors) {
  Json json = schemas::parsed(to_json(measured(2)));
  json.erase("covariance");
  const Identification back = read_back(json.dump());
  EXPECT_DOUBLE_EQ(back.covariance(1, 1), std::pow(back.standard_error.M(0, 1), 2));
  EXPECT_EQ(back.covariance(0, 1), 0.0);
  json.erase("standard_error");
  EXPECT_TRUE(std::isnan(read_back(json.dump()).covariance(0, 0)));
}

TEST(FromJson, WhatWasReadCanBeWrittenAgain) {
  for (const int axes : {1, 2, 3}) {
    const Identification id = read_back(to_json(measured(axes)));
    const Json again = schemas::parsed(to_json(Measurement{id, std::nullopt}));
    EXPECT_FALSE(again.contains("mode"));
    EXPECT_EQ(again["model"], schemas::parsed(to_json(measured(axes)))["model"]);
  }
}

TEST(FromJson, AModelAloneCanBeWrittenAgain) {
  const Identification id = read_back(R"({"schema": "mbk.result/1", "model": {"M": [[1]], "B": [[2]], "K": [[3]]}})");
  const Identification again = read_back(to_json(Measurement{id, std::nullopt}));
  EXPECT_EQ(again.model.K(0, 0), 3.0);
  EXPECT_TRUE(std::isnan(again.standard_error.K(0, 0)));
}

TEST(FromJson, AModelAloneIsEnough) {
  const Identification back = read_back(R"({"schema": "mbk.result/1", "model": {"M": [[1]], "B": [[2]], "K": [[3]]}})");
  EXPECT_EQ(back.axes, 1);
  EXPECT_EQ(back.model.K(0, 0), 3.0);
  EXPECT_TRUE(std::isnan(back.model.x0[0]));
}

TEST(FromJson, ReadsTheWordsOfTheVersionBefore) {
  const Identification back = read_back(R"({"schema": "mbk.result/1", "model": {"M": [[1]], "B": [[2]], "K": [[3]]},
      "fit": {"VAF": [90], "RMSE": [1], "validated_on": "held-back"},
      "warnings": [{"code": "held-back-fit-poor", "message": "so", "try": "again"}]})");
  EXPECT_TRUE(back.fit.held_out);
  ASSERT_EQ(back.warnings.size(), 1u);
  EXPECT_EQ(back.warnings[0].code, WarningCode::held_out_fit_poor);
  const Json json = Json::parse(to_json(Measurement{back, std::nullopt}));
  EXPECT_EQ(json.at("warnings").at(0).at("code"), "held-out-fit-poor");
  EXPECT_EQ(json.at("warnings").at(0).at("was"), "held-back-fit-poor");
  EXPECT_EQ(json.at("fit").at("validated_on"), "held-out");
}

void expect_one_line(const std::string& text) {
  const auto result = identifications_from_json(text);
  ASSERT_FALSE(result) << text.substr(0, 200);
  EXPECT_EQ(result.error().kind, ErrorKind::data);
  EXPECT_EQ(result.error().line().find('\n'), std::string::npos) << result.error().line();
  EXPECT_LT(result.error().line().size(), 400u) << result.error().line();
  EXPECT_THAT(result.error().remedy, HasSubstr("mbk measure --json"));
}

TEST(FromJson, RefusesWhatIsNoResult) {
  for (const char* text : {"",
                           " ",
                           "null",
                           "[]",
                           "{}",
                           "3",
                           "\"mbk.result/1\"",
                           "{\"schema\": 3}",
                           "{\"schema\": null}",
                           "{\"schema\": \"mbk.info/1\"}",
                           "{\"schema\": \"mbk.result/2\"}",
                           "{\"schema\": \"mbk.result/1\"}",
                           "{\"schema\": \"mbk.results/1\"}",
                           "{\"schema\": \"mbk.results/1\", \"results\": 3}",
                           "{\"schema\": \"mbk.results/1\", \"results\": null}",
                           "{\"schema\": \"mbk.results/1\", \"results\": []}",
                           "{\"schema\": \"mbk.results/1\", \"results\": {}}",
                           "{\"schema\": \"mbk.results/1\", \"results\": [3]}",
                           "\xff\xfe",
                           "{\"schema\": \"\xff\"}"}) {
    SCOPED_TRACE(text);
    expect_one_line(text);
  }
}

TEST(FromJson, RefusesMatricesOfTheWrongShapeByName) {
  const Json good = schemas::parsed(to_json(measured(2)));
  const auto broken = [&](const char* pointer, const Json& value) {
    Json json = good;
    json[Json::json_pointer(pointer)] = value;
    return json.dump();
  };
  EXPECT_THAT(identifications_from_json(broken("/model/B", Json::array({1, 2}))).error().message,
              AllOf(HasSubstr("'B'"), HasSubstr("2×2")));
  for (const char* pointer : {"/model/M", "/model/K", "/standard_error/M", "/covariance/matrix", "/model/M/0",
                              "/model/M/1/1", "/model/x0", "/fit/VAF", "/fit", "/warnings", "/warnings/0",
                              "/warnings/0/code", "/inputs/0", "/inputs/0/file", "/method", "/usable", "/units"}) {
    for (const Json& value : {Json("text"), Json::object(), Json(true), Json::array({Json::array()}), Json(-3)}) {
      if ((std::string(pointer) == "/model/M/1/1" && value.is_number()) || value == good[Json::json_pointer(pointer)] ||
          (value.is_string() && (std::string(pointer) == "/method" || std::string(pointer) == "/inputs/0/file")) ||
          (value.is_object() && (std::string(pointer) == "/inputs/0" || std::string(pointer) == "/units"))) {
        continue;  // these are right, or say less than there could be
      }
      SCOPED_TRACE(std::string(pointer) + " = " + value.dump());
      expect_one_line(broken(pointer, value));
    }
  }
}

TEST(FromJson, RefusesADeepNestThatWouldExhaustTheStack) {
  const std::string deep = std::string(2000000, '[') + std::string(2000000, ']');
  expect_one_line(deep);
  expect_one_line(R"({"schema": "mbk.result/1", "model": {"M": [[)" + deep + ", 1], [1, 1]]}}");
  expect_one_line(R"({"schema": "mbk.result/1", "method": )" + deep + "}");
  expect_one_line(std::string(2000000, '{'));
}

TEST(FromJson, RefusesEveryTruncation) {
  const std::string good = to_json(measured(1));
  const std::size_t end = good.find_last_of('}');
  for (std::size_t length = 0; length <= end; length += 7) expect_one_line(good.substr(0, length));
}

TEST(FromJson, NeverThrowsOnMutatedDocuments) {
  const std::string good = to_json(std::vector<Measurement>{measured(1), measured(2)}, SeveralTrials{});
  const std::vector<std::string> tokens = {"null", "[]", "{}", "1e999", "\"\"",    "-",
                                           "]",    "}",  ",",  "\"",    "\\u0000", "true"};
  std::mt19937 random(11);
  for (int run = 0; run < 20000; ++run) {
    std::string text = good;
    for (unsigned k = 0; k <= random() % 3; ++k) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = static_cast<char>(random() % 256);
          break;
        case 1:
          text.erase(at, 1 + random() % 40);
          break;
        case 2:
          text.insert(at, tokens[random() % tokens.size()]);
          break;
        default: {  // a value is replaced
          const std::size_t colon = text.find(": ", at);
          if (colon == std::string::npos) break;
          const std::size_t stop = text.find_first_of(",\n", colon);
          text.replace(colon + 2, stop - colon - 2, tokens[random() % tokens.size()]);
        }
      }
      if (text.empty()) break;
    }
    try {
      const auto result = identifications_from_json(text);
      if (!result) {
        ASSERT_EQ(result.error().line().find('\n'), std::string::npos) << result.error().line();
        ASSERT_LT(result.error().line().size(), 600u) << result.error().line();
      }
    } catch (...) {
      FAIL() << "run " << run << ":\n" << text;
    }
  }
}

TEST(ToJson, AValidationKeepsItsRowsAndAddsWhatTheyHave) {
  ValidationTable table;
  table.study = "springs";
  table.unit = "N/m";
  table.rows.push_back({"k_xx", 431.5, std::pair{429.0, 434.0}, std::pair{420.0, 440.0}});
  table.rows.push_back({"m_xx", 1.3, {}, {}, "kg", 0.01});
  table.rows.push_back({"held", 90.0, std::pair{55.5, 99.7}, std::pair{92.0, 98.0}, "%", {}, 10});
  Json json = schemas::parsed(to_json(table));
  const Json plain = {
      {"what", "k_xx"},   {"value", 431.5}, {"interval95", {429.0, 434.0}}, {"expected", {420.0, 440.0}},
      {"verdict", "met"}, {"met", true}};
  EXPECT_EQ(json.at("rows").at(0), plain);
  const Json& reported = json.at("rows").at(1);
  EXPECT_TRUE(reported.at("interval95").is_null() && reported.at("expected").is_null() && reported.at("met").is_null());
  EXPECT_EQ(reported.at("verdict"), "informative");
  EXPECT_EQ(reported.at("unit"), "kg");
  EXPECT_EQ(reported.at("spread"), 0.01);
  const Json& too_few = json.at("rows").at(2);
  EXPECT_EQ(too_few.at("verdict"), "not shown");
  EXPECT_EQ(too_few.at("trials"), 10);
  EXPECT_EQ(too_few.at("met"), false);
  EXPECT_EQ(json.at("verdict"), "not shown");
  EXPECT_EQ(json.at("met"), false);
  EXPECT_FALSE(json.contains("notes") || json.contains("charts"));
}

TEST(ToJson, AChartKeepsItsNumbers) {
  ValidationTable table;
  table.notes = {"a note"};
  Chart chart;
  chart.title = "K";
  chart.x = {"made", "N/m"};
  chart.series.push_back({"k_xx", {1.0, 2.0}, {1.5, kNaN}, {{1.0, 2.0}, {kNaN, 3.0}}});
  chart.horizontal.push_back({0.5, "limit"});
  chart.identity = true;
  table.charts.push_back(chart);
  const Json json = schemas::parsed(to_json(table));
  EXPECT_EQ(json.at("notes"), Json({"a note"}));
  const Json& one = json.at("charts").at(0);
  EXPECT_EQ(one.at("x"), Json({{"label", "made"}, {"unit", "N/m"}}));
  EXPECT_EQ(one.at("series").at(0).at("y"), Json::array({1.5, nullptr}));
  EXPECT_EQ(one.at("series").at(0).at("intervals"), Json::parse("[[1.0, 2.0], [null, 3.0]]"));
  EXPECT_EQ(one.at("horizontal").at(0).at("value"), 0.5);
  EXPECT_EQ(one.at("identity"), true);
}

}  // namespace json_test
}  // namespace mbk::result
