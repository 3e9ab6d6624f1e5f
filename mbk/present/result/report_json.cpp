#include "mbk/present/result/report_json.h"

#include "mbk/present/result/json_parts.h"
#include "mbk/present/result/passivity_json.h"
#include "mbk/present/result/width_json.h"

namespace mbk::result {
namespace {

/// One list for each axis.
Json by_axis(const Matrix& matrix) {
  Json array = Json::array();
  for (Index j = 0; j < matrix.cols(); ++j) array.push_back(rounded(Vector(matrix.col(j))));
  return array;
}

Json acceleration_json(const AccelerationAgreement& acceleration) {
  return {{"time_s", rounded(acceleration.time, kTimeDigits)},
          {"derivative", by_axis(acceleration.derivative)},
          {"sensor", by_axis(acceleration.sensor)},
          {"rms_difference", rounded(acceleration.rms_difference)},
          {"VAF", rounded(acceleration.vaf)}};
}

Json diagnostics_json(const Diagnostics& diagnostics) {
  const ForcePrediction& prediction = diagnostics.prediction;
  const Autocorrelation& correlation = diagnostics.autocorrelation;
  const Spectra& spectra = diagnostics.spectra;
  const FilterResponse& filters = diagnostics.filters;
  Json json = {{"prediction",
                {{"held_out", prediction.held_out},
                 {"time_s", rounded(prediction.time, kTimeDigits)},
                 {"measured", by_axis(prediction.measured)},
                 {"predicted", by_axis(prediction.predicted)},
                 {"residual", by_axis(prediction.residual)}}},
               {"autocorrelation",
                {{"lag_s", rounded(correlation.lag, kTimeDigits)},
                 {"value", by_axis(correlation.value)},
                 {"white95", rounded(correlation.white95, kDigits)},
                 {"time_constant_s", rounded(correlation.time_constant)}}},
               {"spectra",
                {{"frequency_hz", rounded(spectra.frequency, kTimeDigits)},
                 {"position", by_axis(spectra.position)},
                 {"force", by_axis(spectra.force)},
                 {"residual", by_axis(spectra.residual)},
                 {"coherence", by_axis(spectra.coherence)},
                 {"coherence_significant", rounded(spectra.coherence_significant, kDigits)},
                 {"segments", spectra.segments}}},
               {"filters",
                {{"frequency_hz", rounded(filters.frequency, kTimeDigits)},
                 {"smoothing", rounded(filters.smoothing)},
                 {"first", rounded(filters.first)},
                 {"second", rounded(filters.second)},
                 {"first_ideal", rounded(filters.first_ideal)},
                 {"second_ideal", rounded(filters.second_ideal)}}},
               {"double_integral",
                {{"rms_difference", rounded(diagnostics.double_integral.rms_difference)},
                 {"VAF", rounded(diagnostics.double_integral.vaf)}}},
               {"recording",
                {{"time_s", rounded(diagnostics.time, kTimeDigits)},
                 {"position", by_axis(diagnostics.position)},
                 {"force", by_axis(diagnostics.force)},
                 {"reference", by_axis(diagnostics.reference)}}}};
  if (diagnostics.acceleration) json["acceleration"] = acceleration_json(*diagnostics.acceleration);
  return json;
}

Json facts_json(const RecordingFacts& facts) {
  Json json = {{"metadata", Json::object()}};
  for (const auto& [key, value] : facts.metadata) json["metadata"][key] = value;
  if (!facts.posture) return json;
  json["posture"] = {{"of", word_of(facts.posture->of)}, {"points_m", Json::array()}};
  for (const Eigen::Vector2d& point : facts.posture->points) json["posture"]["points_m"].push_back(rounded(point));
  if (!facts.posture->note.empty()) json["posture"]["note"] = facts.posture->note;
  return json;
}

/// @param more  fields beside those of all reports
std::string report_json(const char* schema, const Report& report, const Json& more) {
  std::vector<Measurement> measured;
  Json trials = Json::array();
  for (const ReportedResult& one : report.results) {
    measured.push_back(one.measured);
    Json trial = {{"recordings", Json::array()}};
    for (const RecordingFacts& facts : one.recordings) trial["recordings"].push_back(facts_json(facts));
    for (const Energy& energy : one.measured.energies) trial["energy"].push_back(energy_json(energy));
    if (one.diagnostics) trial["diagnostics"] = diagnostics_json(*one.diagnostics);
    trials.push_back(std::move(trial));
  }
  Json json = header(schema);
  json["command"] = report.command;
  if (!report.note.empty()) json["note"] = report.note;
  json.update(more);
  json["trials"] = std::move(trials);
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.pop_back();  // the closing brace: the result follows as it stands in a file of its own
  return text + ",\"result\":" + (report.together ? to_json(measured, *report.together) : to_json(measured.front())) +
         "}\n";
}

}  // namespace

std::string to_json(const Report& report) {
  return report_json("mbk.report/1", report, Json::object());
}

std::string to_json(const ComparisonReport& report) {
  const auto& results = report.compared.results;
  Json more = {{"names", report.names}, {"comparisons", Json::array()}};
  for (std::size_t k = 0; k < report.widths.size(); ++k) {
    more["comparisons"].push_back(
        Json::parse(width_to_json(results.front().measured.identification.sources,
                                  results[k + 1].measured.identification.sources, report.widths[k])));
  }
  return report_json("mbk.compare_report/1", report.compared, more);
}

}  // namespace mbk::result
