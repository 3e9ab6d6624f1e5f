#include "mbk/present/result/exploration_json.h"

#include <complex>
#include <numbers>

#include "mbk/present/result/exploration_parts_json.h"

namespace mbk::result {
namespace exploration {

Json document(const Exploration& found) {
  Json json = header("mbk.explore/1");
  json["inputs"] = Json::array();
  for (const ExploredRecording& one : found.recordings) {
    json["inputs"].push_back({{"file", one.source.path},
                              {"sha256", one.source.sha256},
                              {"format", one.source.format},
                              {"duration_s", number(one.duration_s)},
                              {"rate_hz", number(one.rate_hz)},
                              {"from_s", number(one.from_s)},
                              {"to_s", number(one.to_s)},
                              {"window_rule", one.window_rule}});
    if (!one.source.trial.empty()) json["inputs"].back()["trial"] = one.source.trial;
  }
  json["axes"] = found.axes;
  if (found.motion != Motion::unknown && !found.other_signals) json["units"] = units_json(found.motion);
  if (found.frequency_response) json["frequency_response"] = frequency_response_json(*found.frequency_response);
  if (found.impulse_response) json["impulse_response"] = impulse_response_json(*found.impulse_response);
  if (found.parallel_cascade) json["parallel_cascade"] = parallel_cascade_json(*found.parallel_cascade);
  if (found.plateau_stiffness) json["ramp_and_hold"] = plateau_stiffness_json(*found.plateau_stiffness);
  if (found.reach_stiffness) json["servo_displacement"] = reach_stiffness_json(*found.reach_stiffness);
  if (found.time_course) json["time_course"] = time_course_json(*found.time_course);
  if (found.after_onset) json["after_onset"] = after_onset_json(*found.after_onset);
  json["notes"] = found.notes;
  json["warnings"] = warnings_json(found.warnings);
  json["usable"] = found.usable;
  return json;
}

/// K − Mω² + jωB at each frequency, response by response.
Json model_responses(const ResponseModel& model, const Vector& frequency) {
  Json array = Json::array();
  for (Index j = 0; j < model.K.cols(); ++j) {
    for (Index i = 0; i < model.K.rows(); ++i) {
      Vector magnitude(frequency.size()), phase(frequency.size());
      for (Index k = 0; k < frequency.size(); ++k) {
        const double omega = 2.0 * std::numbers::pi * frequency[k];
        const std::complex<double> D(model.K(i, j) - omega * omega * model.M(i, j), omega * model.B(i, j));
        magnitude[k] = std::abs(D);
        phase[k] = 180.0 / std::numbers::pi * std::arg(D);
      }
      array.push_back({{"magnitude", rounded(magnitude)}, {"phase_deg", rounded(phase)}});
    }
  }
  return array;
}

}  // namespace exploration

std::string to_json(const Exploration& found) {
  return dumped(exploration::document(found));
}

std::string to_json(const std::vector<std::string>& explorations, const std::vector<Error>& failed) {
  Json json = header("mbk.explorations/1");
  json["results"] = Json::array();
  for (const std::string& one : explorations) json["results"].push_back(Json::parse(one, nullptr, false));
  if (!failed.empty()) json["failed"] = Json::array();
  for (const Error& error : failed) {
    json["failed"].push_back({{"file", error.where}, {"message", error.message}, {"try", error.remedy}});
  }
  return dumped(json);
}

std::string report_json(const Exploration& found, const std::string& command, const std::string& note) {
  Json json = header("mbk.explore_report/1");
  json["command"] = command;
  if (!note.empty()) json["note"] = note;
  if (found.frequency_response && found.impulse_response && found.impulse_response->model.identifiable) {
    json["model_responses"] =
        exploration::model_responses(found.impulse_response->model, found.frequency_response->frequency);
  }
  json["result"] = exploration::document(found);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace mbk::result
