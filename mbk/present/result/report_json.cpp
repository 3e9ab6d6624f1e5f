#include "mbk/present/result/report_json.h"

#include <variant>

#include "mbk/present/result/result_document.h"
#include "mbk/present/result/schemas.h"

namespace mbk {

using document::Fields;
using document::Json;
using document::kDigits;
using document::kTimeDigits;
using document::through;

void describe(Fields<ForcePrediction>& fields) {
  fields.add("held_out", &ForcePrediction::held_out);
  fields.add_rounded("time_s", &ForcePrediction::time, kTimeDigits, "[s]");
  fields.add_rounded("measured", &ForcePrediction::measured);
  fields.add_rounded("predicted", &ForcePrediction::predicted);
  fields.add_rounded("residual", &ForcePrediction::residual);
}

void describe(Fields<Autocorrelation>& fields) {
  fields.type("", "Autocorrelation of the residual.");
  fields.add_rounded("lag_s", &Autocorrelation::lag, kTimeDigits, "[s]");
  fields.add_rounded("value", &Autocorrelation::value);
  fields.add_rounded("white95", &Autocorrelation::white95, kDigits, "white noise stays within ± this");
  fields.add_rounded("time_constant_s", &Autocorrelation::time_constant, kDigits, "[s]");
}

void describe(Fields<Spectra>& fields) {
  fields.add_rounded("frequency_hz", &Spectra::frequency, kTimeDigits, "[Hz]");
  fields.add_rounded("position", &Spectra::position);
  fields.add_rounded("force", &Spectra::force);
  fields.add_rounded("residual", &Spectra::residual);
  fields.add_rounded("coherence", &Spectra::coherence);
  fields.add_rounded("coherence_significant", &Spectra::coherence_significant, kDigits, "significance limit (95 %)");
  fields.add("segments", &Spectra::segments);
}

void describe(Fields<FilterResponse>& fields) {
  fields.type("", "Gains of the filters.");
  fields.add_rounded("frequency_hz", &FilterResponse::frequency, kTimeDigits, "[Hz]");
  fields.add_rounded("smoothing", &FilterResponse::smoothing);
  fields.add_rounded("first", &FilterResponse::first, kDigits, "derivative");
  fields.add_rounded("second", &FilterResponse::second, kDigits, "derivative");
  fields.add_rounded("first_ideal", &FilterResponse::first_ideal);
  fields.add_rounded("second_ideal", &FilterResponse::second_ideal);
}

void describe(Fields<DoubleIntegral>& fields) {
  fields.type("", "Of the acceleration, against the position.");
  fields.add_rounded("rms_difference", &DoubleIntegral::rms_difference);
  fields.add_rounded("VAF", &DoubleIntegral::vaf, kDigits, "[%]");
}

void describe(Fields<AccelerationAgreement>& fields) {
  fields.type("", "Where the recording has both.");
  fields.add_rounded("time_s", &AccelerationAgreement::time, kTimeDigits, "[s]");
  fields.add_rounded("derivative", &AccelerationAgreement::derivative);
  fields.add_rounded("sensor", &AccelerationAgreement::sensor);
  fields.add_rounded("rms_difference", &AccelerationAgreement::rms_difference);
  fields.add_rounded("VAF", &AccelerationAgreement::vaf, kDigits, "[%]");
}

void describe(Fields<Diagnostics>& fields) {
  fields.type("Diagnostics", "Forces and positions in the units of the result.");
  fields.add("prediction", &Diagnostics::prediction);
  fields.add("autocorrelation", &Diagnostics::autocorrelation);
  fields.add("spectra", &Diagnostics::spectra);
  fields.add("filters", &Diagnostics::filters);
  fields.add("double_integral", &Diagnostics::double_integral);
  fields.group("recording", [](Fields<Diagnostics>& part) {
    part.add_rounded("time_s", &Diagnostics::time, kTimeDigits, "[s]");
    part.add_rounded("position", &Diagnostics::position);
    part.add_rounded("force", &Diagnostics::force);
    part.add_rounded("reference", &Diagnostics::reference);
  });
  fields.add("acceleration", &Diagnostics::acceleration);
}

void describe(Fields<ArmPosture>& fields) {
  fields.type("Posture", "Positions of the joints, seen from above.");
  fields.add("of", &ArmPosture::of, "shoulder, elbow, hand; base, elbow, hand; or the hand alone");
  fields.add_form<std::vector<std::array<document::Number, 2>>>(
      "points_m",
      [](const ArmPosture& posture) {
        Json points = Json::array();
        for (const Eigen::Vector2d& point : posture.points) points.push_back(document::rounded(point));
        return points;
      },
      "base frame [m]; the hand is the last");
  fields.add_unless_empty("note", &ArmPosture::note, "why not more is known");
}

namespace result {

void describe(Fields<RecordingFacts>& fields) {
  fields.type("RecordingFacts");
  fields.add("metadata", &RecordingFacts::metadata);
  fields.add("posture", &RecordingFacts::posture);
}

void describe(Fields<ReportedResult>& fields) {
  fields.type("ReportedTrial", "Data for the drawings of one result.");
  fields.add("recordings", &ReportedResult::recordings);
  fields.add_unless_empty("energy", through(&ReportedResult::measured, &Measurement::energies),
                          "one for each recording");
  fields.add("diagnostics", &ReportedResult::diagnostics);
}

namespace {

Results together(const Report& report) {
  Results all{{}, &*report.together};
  for (const ReportedResult& one : report.results) all.results.push_back(&one.measured);
  return all;
}

/// Without blanks, but for the result, which stands there as in a file of its own.
std::string with_plain_result(Json json) {
  const Json result = std::move(json["result"]);
  json.erase("result");
  std::string text = document::compact(json);
  text.pop_back();  // the closing brace
  return text + ",\"result\":" + document::dumped(result) + "}\n";
}

}  // namespace

void describe(Fields<Report>& fields) {
  fields.type("Report",
              "Data of the page that `mbk measure --report` writes. Data for display have six digits, times nine; "
              "`result` has every digit.");
  fields.header("mbk.report/1");
  fields.add("command", &Report::command, "command line");
  fields.add_unless_empty("note", &Report::note);
  fields.add("trials", &Report::results, "one for each result");
  fields.add("result", [](const Report& report) -> std::variant<const Measurement*, Results> {
    if (report.together) return together(report);
    return &report.results.front().measured;
  });
}

void describe(Fields<ComparisonReport>& fields) {
  const auto of = [](auto member) { return through(&ComparisonReport::compared, member); };
  fields.type("ComparisonReport", "Data of the page that `mbk compare --report` writes.");
  fields.header("mbk.compare_report/1");
  fields.add("command", of(&Report::command), "command line");
  fields.add_unless_empty("note", of(&Report::note));
  fields.add("names", &ComparisonReport::names, "of the results");
  fields.add(
      "comparisons",
      [](const ComparisonReport& report) {
        const auto sources = [&](std::size_t k) { return report.compared.results[k].measured.identification.sources; };
        std::vector<Comparison> all;
        for (const WidthFindings& widths : report.widths) all.push_back({sources(0), sources(all.size() + 1), widths});
        return all;
      },
      "of each further result with the first");
  fields.add("trials", of(&Report::results), "one for each result");
  fields.add("result", of(together));
}

std::string to_json(const Report& report) {
  return with_plain_result(document::written(report));
}

std::string to_json(const ComparisonReport& report) {
  return with_plain_result(document::written(report));
}

void add_report_schemas(document::Schemas& schemas) {
  schemas["report"] = document::schema_of<Report>();
  schemas["compare_report"] = document::schema_of<ComparisonReport>();
}

}  // namespace result
}  // namespace mbk
