#include "mbk/present/report/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <regex>
#include <sstream>
#include <utility>

#include "mbk/base/core/nan.h"
#include "mbk/present/report/picture.h"

namespace mbk::report {
namespace text_test {

using testing::HasSubstr;
using testing::Not;

Identification identification(int axes = 2) {
  Identification id;
  const Index n = axes;
  id.axes = axes;
  id.model = {Matrix::Constant(n, n, 1.20021), Matrix::Constant(n, n, -6.5), Matrix::Constant(n, n, 120.0),
              Vector::Constant(n, 0.304)};
  id.standard_error = {Matrix::Constant(n, n, 0.0011 / 1.96), Matrix::Constant(n, n, 0.1), Matrix::Constant(n, n, 10.0),
                       Vector::Constant(n, 0.001)};
  id.fit = {Vector::Constant(n, 97.123), Vector::Constant(n, 0.3141), Vector::Constant(n, 98.765), true};
  id.preparations.emplace_back();
  id.preparations[0].protocol_rule = "the reference varies continuously";
  id.preparations[0].window_rule = "12 s to 62 s";
  id.preparations[0].cutoff = Hertz(5.0);
  id.preparations[0].cutoff_rule = "given";
  id.sources.push_back({"a.mat", "MAT v7", "abc"});
  id.durations = {62.0};
  id.rates = {1000.0};
  id.excitation.duration = 40.0;
  return id;
}

Findings findings() {
  Findings all;
  for (EllipseFinding& finding : all.ellipses) {
    finding.ellipse = {2.0, 1.0, 6.28, 2.0, 0.5};
    finding.area95 = {6.0, 6.6};
    finding.shape95 = {1.9, 2.1};
    finding.orientation95 = {0.45, 0.55};
  }
  all.antisymmetry[1] = {7.7, {5.0, 10.0}, 11.5, {7.0, 15.0}};
  return all;
}

SpatialFindings spatial_findings() {
  SpatialFindings all;
  for (EllipsoidFinding& finding : all.ellipsoids) {
    finding.symmetric = Matrix::Identity(3, 3);
    finding.principal = {{{412.34, {398.2, 426.4}, Eigen::Vector3d(0.6, -0.8, 0.0), 0.1},
                          {120.0, {100.0, 140.0}, Eigen::Vector3d(0.8, 0.6, 0.0), 0.5 * std::numbers::pi},
                          {100.0, {80.0, 120.0}, Eigen::Vector3d::UnitZ(), 0.5 * std::numbers::pi}}};
    finding.volume = 2.07e7;
    finding.volume95 = {1.9e7, 2.3e7};
    finding.shape = 4.1234;
    finding.shape95 = {3.3, 5.2};
    finding.closed = true;
  }
  for (CirculationFinding& finding : all.antisymmetry) {
    finding.vector = Eigen::Vector3d(0.0, 0.0, -7.7);
    finding.size = 7.7;
    finding.size95 = {5.0, 10.4};
    finding.significant = true;
    finding.percent = 4.5;
  }
  return all;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string line_with(const std::string& text, const std::string& what) {
  for (const std::string& line : lines_of(text)) {
    if (line.find(what) != std::string::npos) return line;
  }
  return "";
}

TEST(ResultText, ShowsEveryMatrixWithItsUnit) {
  const std::string text = result_text(identification(), std::nullopt);
  EXPECT_THAT(line_with(text, "inertia M"), testing::EndsWith("kg"));
  EXPECT_THAT(line_with(text, "damping B"), testing::EndsWith("N·s/m"));
  EXPECT_THAT(line_with(text, "stiffness K"), testing::EndsWith("N/m"));
  EXPECT_THAT(line_with(text, "equilibrium"), testing::EndsWith("mm"));
  EXPECT_THAT(line_with(text, "equilibrium"), HasSubstr("x 304.0 ± 2.0"));
}

TEST(ResultText, UnitsFollowWhatMoves) {
  Identification rotation = identification(1);
  rotation.motion = Motion::rotation;
  const std::string text = result_text(rotation, std::nullopt);
  EXPECT_THAT(line_with(text, "inertia M"), testing::EndsWith("kg·m²"));
  EXPECT_THAT(line_with(text, "stiffness K"), testing::EndsWith("N·m/rad"));
  EXPECT_THAT(line_with(text, "equilibrium x0"), testing::EndsWith("rad"));
  EXPECT_THAT(text, HasSubstr("RMSE 0.314 N·m"));
  rotation.motion = Motion::unknown;
  EXPECT_THAT(result_text(rotation, std::nullopt), HasSubstr("kg or kg·m²"));
}

TEST(ResultText, TheIntervalIs196StandardErrorsToTwoDigits) {
  const std::string text = result_text(identification(), std::nullopt);
  EXPECT_THAT(text, HasSubstr("1.2002 ± 0.0011"));
  EXPECT_THAT(text, HasSubstr("-6.50 ± 0.20"));
  EXPECT_THAT(text, HasSubstr("120 ± 20"));
  EXPECT_THAT(text, HasSubstr("95 %"));
}

TEST(ResultText, WhatIsUndefinedIsCalledSo) {
  Identification id = identification();
  id.model.x0[1] = kNaN;
  id.standard_error.K(0, 0) = kNaN;
  const std::string text = result_text(id, std::nullopt);
  EXPECT_NE(line_with(text, "equilibrium"), line_with(result_text(identification(), std::nullopt), "equilibrium"));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
}

TEST(ResultText, AnErrorThatIsNoneIsNotShown) {
  Identification id = identification();
  id.standard_error.B(0, 0) = 0.0;
  id.standard_error.B(0, 1) = -0.1;  // as a file could claim
  EXPECT_THAT(line_with(result_text(id, std::nullopt), "damping B"), testing::ContainsRegex("-6.5 +-6.5 +-6.50 ±"));
}

TEST(ResultText, AFitThatIsUndefinedIsCalledSo) {
  Identification id = identification();
  id.fit.vaf[1] = kNaN;
  EXPECT_THAT(result_text(id, std::nullopt), Not(HasSubstr("nan")));
}

TEST(ResultText, ColumnsBeginWhereTheirHeadingDoes) {
  const auto lines = lines_of(result_text(identification(), std::nullopt));
  for (std::size_t k = 0; k + 3 < lines.size(); ++k) {
    if (lines[k].find("xx") == std::string::npos) continue;
    const std::size_t yy = columns(lines[k].substr(0, lines[k].find("yy")));
    for (std::size_t row = 1; row <= 3; ++row) {
      const std::size_t begin = lines[k + row].rfind("  ", lines[k + row].rfind("±")) + 2;  // of the fourth value
      EXPECT_EQ(columns(lines[k + row].substr(0, begin)), yy) << lines[k + row];
    }
    return;
  }
  FAIL() << "no heading";
}

TEST(ResultText, ThreeAxesHaveATableOfThreeRowsForEachMatrix) {
  Identification id = identification(3);
  id.model.K(2, 0) = -33.0;
  id.model.x0[2] = 0.5;
  const auto lines = lines_of(result_text(id, std::nullopt));
  const auto first = std::ranges::find_if(lines, [](const std::string& line) { return line.find("inertia M") == 2; });
  ASSERT_NE(first, lines.end());
  ASSERT_GE(lines.end() - first, 10);
  const auto matches = [&](std::ptrdiff_t line, const std::string& pattern) {
    EXPECT_TRUE(std::regex_match(first[line], std::regex(pattern))) << first[line];
  };
  matches(-1, " +x +y +z");
  matches(0, "  inertia M +x( +1\\.2002 ± 0\\.0011){3} +kg");
  matches(5, " +z( +-6\\.50 ± 0\\.20){3} +N·s/m");
  matches(6, "  stiffness K +x( +120 ± 20){3} +N/m");
  matches(8, " +z +-33 ± 20( +120 ± 20){2} +N/m");
  matches(9, "  equilibrium( +304\\.0 ± 2\\.0){2} +500\\.0 ± 2\\.0 +mm");
}

TEST(ResultText, ThreeAxesNameEachFitAndStayWithinTheTerminal) {
  Identification id = identification(3);
  id.warnings.push_back({WarningCode::fit_poor, "poor", "again"});
  const std::string text = result_text(id, std::nullopt, spatial_findings());
  EXPECT_THAT(text, HasSubstr("VAF x 97.12, y 97.12, z 97.12 %"));
  EXPECT_THAT(text, HasSubstr("ellipsoid"));
  for (const std::string& line : lines_of(text)) {
    EXPECT_LE(columns(line), kLineColumns) << line;
    EXPECT_FALSE(line.ends_with(' ')) << '"' << line << '"';
  }
  id.usable = false;
  EXPECT_THAT(result_text(id, std::nullopt, spatial_findings()), Not(HasSubstr("ellipsoid")));
}

/// The mean of three of four trials.
SeveralTrials together(const Identification& id) {
  Summary summary;
  summary.trials = 3;
  summary.omitted = {{"fourth.mat", "not usable"}};
  summary.mean = id.model;
  summary.between_trial_standard_error = id.standard_error;
  summary.half_width95 = id.standard_error;
  summary.half_width95.K *= 4.302653;
  return {summary, "", {}};
}

TEST(ResultText, HasNoTrailingBlanks) {
  Identification id = identification();
  id.warnings.push_back({WarningCode::fit_poor, "poor", "again"});
  id.notes.push_back("row 9 ignored");
  id.decimation.emplace();
  for (const std::string& text : {result_text(id, findings()), result_text(identification(1), std::nullopt),
                                  ellipses_text(findings()), summary_text(together(id))}) {
    for (const std::string& line : lines_of(text)) EXPECT_FALSE(line.ends_with(' ')) << '"' << line << '"';
  }
}

TEST(ResultText, EveryWarningSaysWhatToTry) {
  Identification id = identification();
  id.warnings.push_back({WarningCode::band_too_narrow, "the filter cuts", "raise --cutoff"});
  EXPECT_THAT(result_text(id, std::nullopt),
              HasSubstr("  ! band-too-narrow: the filter cuts\n    try: raise --cutoff\n"));
  EXPECT_THAT(result_text(identification(), std::nullopt), Not(HasSubstr("try:")));
}

TEST(ResultText, WhatIsNotUsableSaysSo) {
  Identification id = identification();
  EXPECT_THAT(result_text(id, std::nullopt), Not(HasSubstr("NOT USABLE")));
  id.usable = false;
  const std::string text = result_text(id, findings());
  EXPECT_THAT(text, HasSubstr("NOT USABLE"));
  for (const char* number : {"±", "inertia M", "damping B", "stiffness K", "equilibrium", "ellipse"}) {
    EXPECT_THAT(text, Not(HasSubstr(number)));
  }
}

TEST(ResultText, NamesTheMethodAndWhy) {
  Identification id = identification();
  EXPECT_THAT(line_with(result_text(id, std::nullopt), "method"), testing::EndsWith("least squares"));
  id.method = Method::instrumental_variables;
  id.method_rule = "the reference is a force";
  EXPECT_THAT(line_with(result_text(id, std::nullopt), "method"),
              AllOf(HasSubstr("instrumental variables"), HasSubstr("the reference is a force")));
}

/// Least squares beside instrumental variables that hold.
struct Pair {
  Identification ls = identification(1), iv = identification(1);
  Disagreement difference{"k", -30.0, 10.0, 120.0, false};
  Pair() {
    iv.method = Method::instrumental_variables;
    iv.instrument = InstrumentCheck{ReferenceQuantity::force, Vector::Constant(3, 500.0), Vector::Zero(1)};
  }
};

std::string on_one_line(const std::string& text) {
  return std::regex_replace(text, std::regex("\\s+"), " ");
}

TEST(AlternativeText, ADifferenceIsPrintedWithItsSizeAndNeverCalledAgreement) {
  Pair two;
  const std::string text = alternative_text(two.ls, two.iv, two.difference);
  EXPECT_THAT(text, Not(HasSubstr("agree")));
  const std::string flat = on_one_line(text);
  for (const char* words : {"120", "30 ± 20", "25 %", "less by instrumental"}) EXPECT_THAT(flat, HasSubstr(words));
  EXPECT_THAT(text, Not(HasSubstr("DIFFER")));
  EXPECT_THAT(text, Not(HasSubstr("stiffness K")));
  two.difference.significant = true;
  EXPECT_THAT(alternative_text(two.ls, two.iv, two.difference), HasSubstr("DIFFER significantly"));
  EXPECT_THAT(alternative_text(two.ls, two.iv, two.difference), HasSubstr("stiffness K"));
}

TEST(AlternativeText, InstrumentsThatDoNotHoldShowNoModelAndSayWhy) {
  Pair two;
  two.difference.significant = true;
  two.iv.usable = false;
  two.iv.warnings.push_back({WarningCode::invalid_instruments, "the limb responds to each pulse", "use --method ls"});
  const std::string text = alternative_text(two.ls, two.iv, two.difference);
  EXPECT_THAT(on_one_line(text), HasSubstr("the limb responds to each"));
  EXPECT_THAT(text, Not(HasSubstr("stiffness K")));
  EXPECT_THAT(alternative_text(two.iv, two.ls, two.difference), HasSubstr("least squares, VAF"));
  two.ls.usable = false;
  EXPECT_THAT(alternative_text(two.iv, two.ls, two.difference), Not(HasSubstr("stiffness K")));
}

TEST(ResultText, TheFitSaysOnWhatItIsJudged) {
  Identification id = identification();
  EXPECT_THAT(result_text(id, std::nullopt), AllOf(HasSubstr("held-out"), HasSubstr("VAF x 97.12, y 97.12 %")));
  id.fit.held_out = false;
  EXPECT_THAT(result_text(id, std::nullopt), Not(HasSubstr("held-out")));
}

TEST(ResultText, SaysHowItWasMade) {
  Identification id = identification();
  id.handle_mass = 0.194;
  id.structure = Structure::symmetric;
  id.preparations[0].mode = Mode::reference;
  const std::string text = result_text(id, std::nullopt);
  EXPECT_THAT(text, HasSubstr("a.mat   62.0 s at 1000 Hz   MAT v7"));
  EXPECT_THAT(text, AllOf(HasSubstr("reference"), HasSubstr("chapter3")));
  EXPECT_THAT(text, HasSubstr("free (the reference varies continuously)"));
  EXPECT_THAT(text, AllOf(HasSubstr("Savitzky–Golay"), HasSubstr("101"), HasSubstr("Butterworth 5 Hz")));
  EXPECT_THAT(text, HasSubstr("0.194 kg"));
  EXPECT_THAT(text, HasSubstr("symmetric"));
  id.preparations[0].cutoff.reset();
  EXPECT_THAT(result_text(id, std::nullopt), Not(HasSubstr("Butterworth")));
}

TEST(EllipsesText, ShowsAreaShapeOrientationAndAntisymmetry) {
  const std::string text = ellipses_text(findings());
  const std::string stiffness = line_with(text, "stiffness");
  EXPECT_THAT(stiffness, HasSubstr("6.28 [6.00, 6.60]"));
  EXPECT_THAT(stiffness, HasSubstr("2.00 [1.90, 2.10]"));
  EXPECT_THAT(stiffness, HasSubstr("28.6°"));  // 0.5 rad
  EXPECT_THAT(stiffness, HasSubstr("11.5 % [7.0, 15.0]"));
}

TEST(EllipsesText, AnIndefiniteMatrixShowsItsEigenvaluesInstead) {
  Findings none = findings();
  none.ellipses[0].ellipse = {2.0, -0.25, kNaN, kNaN, 0.5};
  EXPECT_THAT(line_with(ellipses_text(none), "inertia"), HasSubstr("(λ -0.25, 2)"));
}

TEST(EllipsoidsText, ShowsPrincipalValuesDirectionsVolumeShapeAndAntisymmetry) {
  const std::string text = ellipsoids_text(spatial_findings());
  const std::string largest = line_with(text, "stiffness");
  EXPECT_THAT(largest, HasSubstr("412 [398, 426] N/m"));
  EXPECT_THAT(largest, HasSubstr("0.60 -0.80  0.00"));
  EXPECT_THAT(largest, HasSubstr("5.7°"));  // 0.1 rad
  const std::size_t sizes = text.find("volume");
  EXPECT_THAT(line_with(text.substr(sizes), "stiffness"),
              AllOf(HasSubstr("2.07e+07 [1.9e+07, 2.3e+07]"), HasSubstr("4.12 [3.30, 5.20]")));
  const std::size_t circulations = text.find("z_mean");
  EXPECT_THAT(line_with(text.substr(circulations), "stiffness"),
              AllOf(HasSubstr("7.7 [5.0, 10.4] N/m"), HasSubstr("4.5 %"), HasSubstr("0.00  0.00 -1.00")));
}

TEST(EllipsoidsText, ADirectionWhoseValueMayEqualAnotherIsAny) {
  const std::string second = line_with(ellipsoids_text(spatial_findings()), "120 [100, 140] N/m");
  EXPECT_THAT(second, AllOf(HasSubstr("any"), Not(HasSubstr("0.80")), Not(HasSubstr("90"))));
}

TEST(EllipsoidsText, AMatrixThatMayBeIndefiniteHasNoVolume) {
  SpatialFindings open = spatial_findings();
  open.ellipsoids[2].closed = false;
  open.antisymmetry[1].significant = false;
  const std::string text = ellipsoids_text(open);
  const std::string sizes = line_with(text.substr(text.find("volume")), "stiffness");
  EXPECT_THAT(sizes, AllOf(HasSubstr("not positive beyond its interval"), Not(HasSubstr("2.07"))));
  EXPECT_THAT(line_with(text.substr(text.find("z_mean")), "stiffness"),
              AllOf(HasSubstr("not significant"), Not(HasSubstr("-1.00"))));
}

TEST(SummaryText, ShowsThe95PercentIntervalAndWhatIsNoPartOfTheMean) {
  SeveralTrials all = together(identification());
  const std::string text = summary_text(all);
  EXPECT_THAT(text, AllOf(HasSubstr("3 of 4 trials"), HasSubstr("least squares")));
  EXPECT_THAT(text, HasSubstr("120 ± 43"));  // Student's t of two degrees of freedom times 10
  EXPECT_THAT(text, HasSubstr("±: half of the 95 % interval of the mean"));
  EXPECT_THAT(text, HasSubstr("omitted  fourth.mat: not usable"));
  all.summary->omitted.clear();
  EXPECT_THAT(summary_text(all), HasSubstr(" 3 trials"));
}

TEST(SummaryText, SaysWhyThereIsNone) {
  EXPECT_THAT(summary_text({std::nullopt, "the recordings differ in condition", {}}),
              HasSubstr("the recordings differ in condition"));
}

TEST(InfoText, NamesEveryProblem) {
  Recording recording;
  recording.sources.push_back({"a.csv", "CSV", "0123456789abcdef0123"});
  recording.notes.push_back("a comma too many");
  Inspection facts;
  facts.samples = 100;
  facts.interval_median = 0.001;
  facts.gaps.push_back({49, 0.049, 0.5});
  facts.duplicated_times = 1;
  facts.first_duplicated = 10;
  facts.backward_times = 3;
  facts.first_backward = 20;
  facts.non_finite.push_back({"force_x", 2, 30});
  facts.channels.push_back({"force_x", "N", -1.0, 1.0, false, true, 0.01});
  const std::string text = info_text(recording, facts);
  EXPECT_THAT(text, testing::ContainsRegex("0.5 s [^\n]*sample 50 [^\n]*0.049 s"));
  EXPECT_THAT(line_with(text, "sample 11"), HasSubstr("time"));
  EXPECT_THAT(line_with(text, "sample 21"), AllOf(HasSubstr("time"), HasSubstr(" 3 ")));
  EXPECT_THAT(line_with(text, "sample 31"), AllOf(HasSubstr("force_x"), HasSubstr(" 2 ")));
  EXPECT_THAT(text, HasSubstr("clip"));
  EXPECT_THAT(text, HasSubstr("note: a comma too many"));
}

ValidationTable validation() {
  ValidationTable table;
  table.study = "springs";
  table.question = "does the fit give the springs?";
  table.unit = "N/m";
  table.runs = 20;
  table.rows.push_back({"k_xx", 431.5, std::pair{429.0, 434.0}, std::pair{420.0, 440.0}});
  return table;
}

TEST(ValidationText, ShowsARowWithItsIntervalAndVerdict) {
  ValidationTable table = validation();
  EXPECT_THAT(line_with(validation_text(table), "k_xx"),
              testing::ContainsRegex("431.50 +.429.00, 434.00. +.420, 440. +met$"));
  table.rows[0].expected = {430.0, 440.0};
  EXPECT_THAT(line_with(validation_text(table), "k_xx"), testing::EndsWith("not shown"));
  table.rows[0].expected = {435.0, 440.0};
  EXPECT_THAT(line_with(validation_text(table), "k_xx"), HasSubstr("FALLS SHORT"));
  EXPECT_FALSE(table.met());
}

TEST(ValidationText, ARowThatIsNotJudgedIsInformative) {
  ValidationTable table = validation();
  table.rows.push_back({"k_yx", 900.0, std::pair{899.0, 901.0}, std::nullopt});
  EXPECT_THAT(line_with(validation_text(table), "k_yx"), testing::EndsWith("informative"));
  EXPECT_TRUE(table.met());
  EXPECT_THAT(validation_text(table), AllOf(HasSubstr("1 met"), HasSubstr("1 informative")));
}

TEST(ValidationText, AnUnboundedIntervalSaysSo) {
  ValidationTable table = validation();
  table.rows[0].interval95 = {429.0, std::numeric_limits<double>::infinity()};
  EXPECT_THAT(line_with(validation_text(table), "k_xx"), HasSubstr("[429.00, inf]"));
  table.rows[0].interval95 = {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  EXPECT_THAT(line_with(validation_text(table), "k_xx"), Not(HasSubstr("inf")));
}

TEST(ValidationText, SpreadAndUnitStandWhereARowHasThem) {
  ValidationTable table = validation();
  EXPECT_THAT(validation_text(table), Not(HasSubstr("spread")));
  table.rows.push_back({"m_xx", 1.3264, std::pair{1.31, 1.34}, std::nullopt, "kg", 0.0123});
  const std::string text = validation_text(table);
  EXPECT_THAT(text, HasSubstr("spread"));
  EXPECT_THAT(line_with(text, "m_xx"), HasSubstr("1.326 kg"));
  EXPECT_THAT(line_with(text, "m_xx"), HasSubstr("0.012"));
}

TEST(ValidationText, AWishWithOneEndIsWords) {
  const double infinity = std::numeric_limits<double>::infinity();
  ValidationTable table = validation();
  table.rows[0].expected = {400.0, infinity};
  EXPECT_THAT(line_with(validation_text(table), "k_xx"), AllOf(HasSubstr(" 400"), Not(HasSubstr("inf"))));
  table.rows[0].expected = {-infinity, 500.0};
  EXPECT_THAT(line_with(validation_text(table), "k_xx"), AllOf(HasSubstr(" 500"), Not(HasSubstr("inf"))));
}

TEST(ValidationText, NotesAndChartsFollowTheTable) {
  ValidationTable table = validation();
  table.notes.emplace_back("The springs are those of the maker.");
  Chart chart;
  chart.title = "Springs, found and made";
  table.charts.push_back(chart);
  const std::string text = validation_text(table);
  EXPECT_LT(text.find("k_xx"), text.find("  The springs are those"));
  EXPECT_LT(text.find("The springs are those"), text.find("Springs, found and made"));
}

TEST(BySensorText, HasTheSensorsModelAndWhatTheComputedForceMakesOfIt) {
  Identification computed = identification(1), sensed = identification(1);
  computed.preparations[0].force_source = ForceSource::observer;
  computed.model.K(0, 0) = 123.5;  // of 120
  const ForceAgreement none{0, Vector::Zero(1), Vector::Zero(1)};
  ForceComparison comparison{.all = none, .reversals = none, .rest = none, .motion = none};
  for (Vector* part : {&comparison.measured_rms, &comparison.vaf, &comparison.correlation, &comparison.gain,
                       &comparison.lag, &comparison.correlation_at_lag}) {
    *part = Vector::Ones(1);
  }
  const std::string text = by_sensor_text(computed, sensed, comparison);
  EXPECT_THAT(text, AllOf(HasSubstr("momentum observer"), HasSubstr("force sensor")));
  const std::size_t sensed_stiffness = text.find("stiffness K"), difference = text.rfind("stiffness K");
  ASSERT_LT(sensed_stiffness, difference);
  EXPECT_THAT(line_with(text.substr(sensed_stiffness), "stiffness K"), HasSubstr("120"));
  EXPECT_THAT(line_with(text.substr(difference), "stiffness K"), HasSubstr("3.5"));
}

}  // namespace text_test
}  // namespace mbk::report
