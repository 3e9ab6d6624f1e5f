#include "mbk/present/result/exploration_json.h"

#include <complex>
#include <numbers>

#include "mbk/base/core/units.h"
#include "mbk/present/result/exploration_parts_json.h"
#include "mbk/present/result/schemas.h"

namespace mbk {

using document::Fields;
using document::Json;

void describe(Fields<ExploredRecording>& fields) {
  fields.type("ExploredInput", "A recording that was explored.");
  fields.with(&ExploredRecording::source, "trial");
  fields.add("duration_s", &ExploredRecording::duration_s, "[s]");
  fields.add("rate_hz", &ExploredRecording::rate_hz, "sample rate [Hz]");
  fields.add("from_s", &ExploredRecording::from_s, "start of the analysed interval [s]");
  fields.add("to_s", &ExploredRecording::to_s, "its end [s]");
  fields.add("window_rule", &ExploredRecording::window_rule, "how the interval was chosen");
  fields.add_unless_empty("trial", document::through(&ExploredRecording::source, &SourceFile::trial),
                          "trial within the file; absent if the file contains one only");
}

void describe(Fields<Exploration>& fields) {
  using From = const Exploration&;
  fields.type("Exploration",
              "Output of `mbk explore --json`: exploration of recordings without assuming a model of M, B and K. Each "
              "part is present if the data allow it. SI units.");
  fields.header("mbk.explore/1");
  fields.add("inputs", &Exploration::recordings);
  fields.add("axes", &Exploration::axes);
  fields.add(
      "units", [](From found) { return found.other_signals ? std::nullopt : result::known_units(found.motion); },
      "absent if the recording does not state the kind of motion, and for signals other than motion and force");
  fields.add("frequency_response", &Exploration::frequency_response);
  fields.add("impulse_response", &Exploration::impulse_response);
  fields.add("parallel_cascade", &Exploration::parallel_cascade);
  fields.add("ramp_and_hold", &Exploration::plateau_stiffness);
  fields.add("servo_displacement", &Exploration::reach_stiffness);
  fields.add("time_course", &Exploration::time_course);
  fields.add("after_onset", &Exploration::after_onset);
  fields.add("emg", &Exploration::emg);
  fields.add("stretch", &Exploration::stretch);
  fields.add("notes", &Exploration::notes);
  fields.add("warnings", &Exploration::warnings);
  fields.add("usable", &Exploration::usable);
}

namespace result {
namespace {

struct Explorations {
  const std::vector<std::string>& texts;
  const std::vector<Error>& failed;
};

void describe(Fields<Explorations>& fields) {
  using From = const Explorations&;
  fields.type("Explorations", "What `mbk explore --each --json` writes.");
  fields.header("mbk.explorations/1");
  fields.add_form<std::vector<Exploration>>("results", [](From all) {
    Json results = Json::array();
    for (const std::string& text : all.texts) results.push_back(Json::parse(text, nullptr, false));
    return results;
  });
  fields.add_unless_empty(
      "failed", [](From all) { return all.failed; }, "recordings that could not be explored");
}

/// K − Mω² + jωB over frequency.
struct ModelResponse {
  Vector magnitude, phase;
};

void describe(Fields<ModelResponse>& fields) {
  fields.type("ModelResponse");
  fields.add_rounded("magnitude", &ModelResponse::magnitude, document::kDigits);
  fields.add_rounded("phase_deg", &ModelResponse::phase, document::kDigits);
}

std::vector<ModelResponse> model_responses(const Exploration& found) {
  const ResponseModel& model = found.impulse_response->model;
  const Vector& frequency = found.frequency_response->frequency;
  std::vector<ModelResponse> responses;
  for (Index j = 0; j < model.K.cols(); ++j) {
    for (Index i = 0; i < model.K.rows(); ++i) {
      ModelResponse one = {Vector(frequency.size()), Vector(frequency.size())};
      for (Index k = 0; k < frequency.size(); ++k) {
        const double omega = 2.0 * std::numbers::pi * frequency[k];
        const std::complex<double> D(model.K(i, j) - omega * omega * model.M(i, j), omega * model.B(i, j));
        one.magnitude[k] = std::abs(D);
        one.phase[k] = kDegrees * std::arg(D);
      }
      responses.push_back(std::move(one));
    }
  }
  return responses;
}

struct ExplorationReport {
  const Exploration& found;
  std::string command, note;
};

void describe(Fields<ExplorationReport>& fields) {
  using From = const ExplorationReport&;
  fields.type("Exploration report", "Data of the page that `mbk explore --report` writes.");
  fields.header("mbk.explore_report/1");
  fields.add("command", &ExplorationReport::command, "command line");
  fields.add_unless_empty("note", &ExplorationReport::note);
  const auto has_model = [](From report) {
    const Exploration& found = report.found;
    return found.frequency_response && found.impulse_response && found.impulse_response->model.identifiable;
  };
  fields.add_if(
      has_model, "model_responses", [](From report) { return model_responses(report.found); },
      "K − Mω² + jωB from M, B and K fitted to the impulse response, at the frequencies and in the order of the "
      "responses; six digits, for display");
  fields.add("result", [](From report) -> const Exploration& { return report.found; });
}

}  // namespace

std::string to_json(const Exploration& found) {
  return document::document(found);
}

std::string to_json(const std::vector<std::string>& explorations, const std::vector<Error>& failed) {
  return document::document(Explorations{explorations, failed});
}

std::string report_json(const Exploration& found, const std::string& command, const std::string& note) {
  return document::compact(document::written(ExplorationReport{found, command, note})) + "\n";
}

void add_explore_schemas(document::Schemas& schemas) {
  schemas["explore"] = document::schema_of<Exploration>();
  schemas["explorations"] = document::schema_of<Explorations>();
  schemas["explore_report"] = document::schema_of<ExplorationReport>();
}

}  // namespace result
}  // namespace mbk
