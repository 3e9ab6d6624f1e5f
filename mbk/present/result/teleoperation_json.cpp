#include "mbk/present/result/teleoperation_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "mbk/model/trial/identification.h"
#include "mbk/present/result/described.h"
#include "mbk/present/result/json_reading.h"
#include "mbk/present/result/schemas.h"

namespace mbk {

using document::Fields;
using document::through;

void describe(Fields<ViolatedBand>& fields) {
  const auto is_band = [](const ViolatedBand& band) { return band.detail.empty(); };
  fields.type("ViolatedBand");
  fields.add("from", through(&ViolatedBand::low, &RadPerSec::value), "[rad/s]");
  fields.add("to", through(&ViolatedBand::high, &RadPerSec::value), "[rad/s]");
  fields.add_if(is_band, "worst", through(&ViolatedBand::worst, &RadPerSec::value), "[rad/s]");
  fields.add_if(is_band, "value", &ViolatedBand::value, "value of the condition there");
  fields.add_unless_empty("pole", &ViolatedBand::detail, "matrix entry with this pole");
}

void describe(Fields<StabilityOutcome>& fields) {
  using From = const StabilityOutcome&;
  fields.type("StabilityOutcome");
  fields.add("name", &StabilityOutcome::condition);
  fields.add("condition", [](From outcome) { return std::string(text(outcome.condition)); });
  fields.add("holds", [](From outcome) { return outcome.violated.empty(); });
  fields.add("violated", &StabilityOutcome::violated);
}

void describe(Fields<AbsoluteStability>& fields) {
  using From = const AbsoluteStability&;
  const auto is_marginal = [](From stability) { return stability.verdict == StabilityVerdict::marginal; };
  fields.type("Stability", "Frequencies in rad/s; null: infinite.");
  fields.add_as("form", {{"enum", {"z", "y", "h", "g"}}}, &AbsoluteStability::form, "of the tested immittance matrix");
  fields.add("verdict", &AbsoluteStability::verdict);
  fields.add("absolutely_stable", &AbsoluteStability::holds);
  fields.add("conditions", &AbsoluteStability::conditions);
  fields.add_if(
      is_marginal, "equality_at",
      [](From stability) {
        std::vector<double> touches;
        for (const RadPerSec omega : stability.touches) touches.push_back(omega.value);
        return touches;
      },
      "[rad/s]");
  fields.add_if(is_marginal, "equality_everywhere", &AbsoluteStability::touches_everywhere);
}

void describe(Fields<FrequencyGrid>& fields) {
  fields.type("Grid", "Logarithmically spaced frequencies, unless bounded.");
  fields.add_number("from", through(&FrequencyGrid::low, &RadPerSec::value), "[rad/s]");
  fields.add("to", through(&FrequencyGrid::high, &RadPerSec::value), "[rad/s]; null: no upper limit");
  fields.add("points", &FrequencyGrid::points);
  fields.add("bounded", &FrequencyGrid::bounded,
             "between the points no violation deeper than 1e-6 of the sum of the terms is missed");
}

void describe(Fields<AdmissibleEnd>& fields) {
  fields.type("AdmissibleEnd");
  fields.add("value", &AdmissibleEnd::value, "null: infinite");
  fields.add_or_null("included", &AdmissibleEnd::included, "null: undecided");
  fields.add("end_of_range", &AdmissibleEnd::limit_of_search, "that was asked for");
}

void describe(Fields<AdmissibleInterval>& fields) {
  fields.add("low", &AdmissibleInterval::low);
  fields.add("high", &AdmissibleInterval::high);
}

void describe(Fields<AdmissibleSet>& fields) {
  fields.type("Admissible", "All values of a parameter with which the design is absolutely stable.");
  fields.add("parameter", &AdmissibleSet::parameter);
  fields.add("unit", &AdmissibleSet::unit);
  fields.add(
      "range", [](const AdmissibleSet& set) { return std::pair(set.low, set.high); }, "that was asked for");
  fields.add("intervals", &AdmissibleSet::intervals);
  fields.add("undecided", &AdmissibleSet::undecided);
  fields.add("critical", &AdmissibleSet::critical, "values at which the verdict could change");
}

void describe(Fields<LargestShortage>& fields) {
  using From = const LargestShortage&;
  fields.type("LargestShortage", "The largest shortage of passivity at a port with which the system is stable.");
  fields.add("port", &LargestShortage::port);
  fields.add_or_null(
      "a", [](From largest) { return largest.exists ? std::optional(largest.value()) : std::nullopt; },
      "[N·s/m]; null: none");
  fields.add_if(&LargestShortage::exists, "at_least", &LargestShortage::at_least, "[N·s/m]");
  fields.add_if(&LargestShortage::exists, "at_most", &LargestShortage::at_most, "[N·s/m]");
}

void describe(Fields<Termination>& fields) {
  fields.type("Termination", "Z = m s + b + k/s");
  fields.add("mass", &Termination::mass, "[kg]");
  fields.add("damping", &Termination::damping, "[N·s/m]");
  fields.add("stiffness", &Termination::stiffness, "[N/m]");
}

void describe(Fields<WorstTerminations>& fields) {
  using From = const WorstTerminations&;
  fields.type("WorstTerminations");
  fields.add("frequency", through(&WorstTerminations::frequency, &RadPerSec::value), "[rad/s]");
  fields.add("growth", &WorstTerminations::growth, "[1/s]");
  fields.add("hand", [](From worst) { return worst.at_port[0]; });
  fields.add("environment", [](From worst) { return worst.at_port[1]; });
}

void describe(Fields<TeleoperationRun>& fields) {
  fields.type("TeleoperationRun");
  fields.add("what", &TeleoperationRun::what);
  fields.add("hand", &TeleoperationRun::hand);
  fields.add("environment", &TeleoperationRun::environment);
  fields.add("outcome", &TeleoperationRun::outcome);
  fields.add("ratio", &TeleoperationRun::ratio, "of speeds, last quarter over second");
  fields.add("frequency", through(&TeleoperationRun::frequency, &RadPerSec::value), "[rad/s]");
  fields.add("duration", &TeleoperationRun::duration, "[s]");
  fields.add("ran_away", &TeleoperationRun::ran_away);
  fields.add("largest_position", &TeleoperationRun::largest_position, "[m]");
  fields.add("packets", &TeleoperationRun::sent);
  fields.add("packets_lost", &TeleoperationRun::lost);
  fields.add("lowest_energy", &TeleoperationRun::lowest_energy, "[J]");
  fields.add("expected", &TeleoperationRun::worst);
}

void describe(Fields<TeleoperationSimulation>& fields) {
  fields.type("TeleoperationSimulation");
  fields.add("sample_time", &TeleoperationSimulation::sample_time, "[s]");
  fields.add("grid", &TeleoperationSimulation::grid);
  fields.add("runs", &TeleoperationSimulation::runs);
  fields.add("notes", &TeleoperationSimulation::notes);
  fields.add("llewellyn", &TeleoperationSimulation::sampled);
  fields.add("modified_llewellyn", &TeleoperationSimulation::sampled_with_operator);
}

void describe(Fields<ExcessStep::Felt>& fields) {
  fields.add("free", &ExcessStep::Felt::free, "[N·s/m]");
  fields.add("clamped", &ExcessStep::Felt::clamped, "[N/m]");
}

void describe(Fields<ExcessStep>& fields) {
  fields.type("ExcessStep");
  fields.add("excess", &ExcessStep::excess, "[N·s/m]");
  fields.add("admissible", &ExcessStep::set);
  fields.add("felt", &ExcessStep::felt);
}

void describe(Fields<ExcessSweep>& fields) {
  fields.type("ExcessSweep", "Effect of an excess of passivity of the operator.");
  fields.add("parameter", &ExcessSweep::parameter);
  fields.add("unit", &ExcessSweep::unit);
  fields.add("frequency", through(&ExcessSweep::frequency, &RadPerSec::value), "frequency of `felt` [rad/s]");
  fields.add("steps", &ExcessSweep::steps);
}

namespace {

struct DesignFile {
  std::string file;
};

void describe(Fields<DesignFile>& fields) {
  fields.add("file", &DesignFile::file);
}

struct Curve {
  const ChartSeries* series;
};

void describe(Fields<Curve>& fields) {
  fields.type("TeleoperationCurve");
  fields.add("name", through(&Curve::series, &ChartSeries::name));
  fields.add("frequency", through(&Curve::series, &ChartSeries::x), "[rad/s]");
  fields.add("value", through(&Curve::series, &ChartSeries::y));
}

}  // namespace

void describe(Fields<TeleoperationFinding>& fields) {
  using Finding = TeleoperationFinding;
  using From = const Finding&;
  fields.type("Teleoperation",
              "Output of `mbk teleop --json`: whether a design is absolutely stable. SI units, frequencies in rad/s; "
              "null: infinite.");
  fields.header("mbk.teleop/1");
  fields.add("inputs", [](From finding) { return std::vector{DesignFile{finding.file}}; });
  fields.add("name", &Finding::name);
  fields.add("kind", &Finding::kind);
  fields.add_form<std::map<std::string, double>>("parameters", [](From finding) {
    document::Json parameters = document::Json::object();
    for (const DesignParameter& one : finding.parameters) parameters[one.name] = document::number(one.value);
    return parameters;
  });
  fields.add_as("decided", {{"enum", {"exactly", "on the grid"}}},
                [](From finding) { return finding.grid ? "on the grid" : "exactly"; });
  fields.add("grid", &Finding::grid);
  fields.add("llewellyn", &Finding::stability);
  const auto of_operator = [](Fields<Finding>& part) {
    part.add("port", &Finding::operator_port);
    part.add("a", through(&Finding::operator_shortage, &OperatorShortage::a), "shortage of passivity [N·s/m]");
    part.add("rule", through(&Finding::operator_shortage, &OperatorShortage::rule), "source of the shortage");
    part.add("grid", &Finding::operator_grid, "frequencies to which modified_llewellyn applies; with true delays");
  };
  fields.group("operator", of_operator).only_if([](From finding) { return finding.with_operator.has_value(); });
  fields.add("modified_llewellyn", &Finding::with_operator);
  fields.add("largest_a", &Finding::largest_shortages);
  fields.add("admissible", &Finding::admissible);
  fields.add("excess", &Finding::excess);
  fields.add("simulation", &Finding::simulation);
  fields.add("curves", [](From finding) {
    std::vector<Curve> curves;
    for (const Chart& chart : finding.charts) curves.push_back({&chart.series.front()});
    return curves;
  });
  fields.add("notes", &Finding::notes);
}

namespace result {
namespace {

/// The lowest of the numbers of a list at that place; absent where one is none.
std::optional<double> lowest_at(const Json& json, const char* place) {
  const Json::json_pointer at(place);
  if (!json.contains(at) || !json[at].is_array() || json[at].empty()) return std::nullopt;
  double lowest = std::numeric_limits<double>::infinity();
  for (const Json& one : json[at]) {
    if (!one.is_number()) return std::nullopt;
    lowest = std::min(lowest, one.get<double>());
  }
  return lowest;
}

/// Why the model of a document cannot stand for an operator; empty where it can.
std::string unfit(const Json& json) {
  const auto is = [&](const char* place, const Json& value) {
    const Json::json_pointer at(place);
    return json.contains(at) && json[at] == value;
  };
  if (is("/usable", false) || is("/passivity/prediction/verdict", "none") || is("/passivity/models/0/usable", false)) {
    return "the result is not usable";
  }
  const auto warnings = json.find("warnings");
  const bool warned =
      warnings != json.end() && warnings->is_array() && std::ranges::any_of(*warnings, [](const Json& one) {
        const auto word = one.is_object() ? one.value("code", Json()) : Json();
        if (!word.is_string()) return false;
        const auto code = value_of<WarningCode>(word.get<std::string>());
        return code == WarningCode::fit_poor || code == WarningCode::held_out_fit_poor;
      });
  if (warned || is("/passivity/models/0/fits", false) || is("/passivity/decided_by", "energy")) {
    return "its model explains too little of the force";
  }
  if (is("/passivity/band_hz", nullptr)) return "it has no band in which all axes were excited coherently";
  return "";
}

/// Whether a result or what decides its passivity has a unit of rotation.
bool is_of_rotation(const Json& json) {
  const std::string rotation = units_of(Motion::rotation).damping;
  const Json::json_pointer damping("/units/B"), conditions("/passivity/models/0/conditions");
  if (json.contains(damping)) return json[damping] == rotation;
  if (!json.contains(conditions) || !json[conditions].is_array()) return false;
  return std::ranges::any_of(json[conditions],
                             [&](const Json& one) { return one.is_object() && one.value("unit", Json()) == rotation; });
}

}  // namespace

std::string to_json(const TeleoperationFinding& finding) {
  return document::document(finding);
}

void add_teleop_schema(document::Schemas& schemas) {
  schemas["teleop"] = document::schema_of<TeleoperationFinding>();
}

Result<OperatorShortage> operator_shortage_from_json(std::string_view text) {
  const char* const remedy = "give a file that 'mbk measure --json' or 'mbk passivity --json' wrote";
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& error) {
    return bad_data(fmt::format("it is not valid JSON, byte {}", error.byte), remedy);
  }
  if (has_schema(json, "mbk.results/1") || has_schema(json, "mbk.passivities/1")) {
    const auto results = json.find("results");
    if (results == json.end() || !results->is_array() || results->size() != 1) {
      return bad_data("it contains several results or none", "give a file with the result of one operator");
    }
    json = Json((*results)[0]);
  }
  const auto schemas = {"mbk.result/2", "mbk.passivity/2", "mbk.result/1", "mbk.passivity/1"};
  if (std::ranges::none_of(schemas, [&](const char* one) { return has_schema(json, one); })) {
    return bad_data("it is not a result of mbk: its schema is neither mbk.result/2 nor mbk.passivity/2", remedy);
  }
  if (is_of_rotation(json)) {
    return bad_data("it is of a rotating joint: its excess of passivity is in N·m·s/rad, but the design is in N·s/m",
                    "give the result of an arm that was moved along a line or in a plane");
  }
  if (const std::string why = unfit(json); !why.empty()) {
    return tl::unexpected(Error{ErrorKind::not_usable, why + ", so it cannot be used for a design",
                                "measure again, following the warnings of 'mbk measure' and its --report", ""});
  }
  const auto low = lowest_at(json, "/passivity/models/0/index/lower95"),
             high = lowest_at(json, "/passivity/models/0/index/upper95"),
             from = lowest_at(json, "/passivity/models/0/index/frequency_hz");
  const Json::json_pointer band("/passivity/models/0/band_hz");
  if (!low || !high || !from || !json.contains(band) || !json[band].is_array() || json[band].size() != 2 ||
      !json[band][1].is_number()) {
    return bad_data("it contains no passivity index of the operator",
                    "measure with 'mbk measure --json', which writes the passivity index, or give shortage_N_s_per_m");
  }
  const bool extrapolated = json.value(Json::json_pointer("/passivity/models/0/extrapolated"), false);
  return OperatorShortage{
      0.0 - *low,
      fmt::format("minus the lower end of the 95 % interval of the smallest passivity index, {:.4g} to {:.4g} N·s/m, "
                  "from {:.3g} to {:.3g} Hz, antisymmetric part included; {} is an assumption",
                  *low, *high, *from, json[band][1].get<double>(),
                  extrapolated ? "the behaviour beyond the data, in that band and outside it,"
                               : "that the operator is no less passive outside that band"),
      std::pair{*low, *high}};
}

}  // namespace result
}  // namespace mbk
