#include "mbk/present/result/robot_json.h"

#include <cmath>

#include "mbk/model/robot/drive_term_names.h"
#include "mbk/present/result/force_comparison_json.h"
#include "mbk/present/result/json_parts.h"
#include "mbk/present/result/json_reading.h"

namespace mbk::result {
namespace {

constexpr const char* kRobotSchema = "mbk.robot/1";

Json drive_json(const robot::DriveTerms& drive) {
  Json json = {{"terms", Json::array()}, {"smoothing", drive.smoothing}};
  for (const robot::DriveTermName& term : robot::kDriveTermNames) {
    if (drive.*term.wanted) json["terms"].push_back(term.word);
  }
  if (drive.stribeck) json["stribeck_velocity"] = drive.stribeck_velocity;
  return json;
}

robot::DriveTerms drive_from(const Json& json) {
  robot::DriveTerms drive;
  for (const robot::DriveTermName& term : robot::kDriveTermNames) drive.*term.wanted = false;
  for (const Json& name : json.at("terms")) {
    bool known = false;
    for (const robot::DriveTermName& term : robot::kDriveTermNames) {
      if (name != term.word) continue;
      drive.*term.wanted = known = true;
    }
    if (!known) throw Malformed{fmt::format("there is no term {}", name.dump())};
  }
  drive.smoothing = json.value("smoothing", drive.smoothing);
  drive.stribeck_velocity = json.value("stribeck_velocity", drive.stribeck_velocity);
  if (!(drive.smoothing >= 0.0) || !(drive.stribeck_velocity > 0.0))
    throw Malformed{"a velocity of friction is negative"};
  return drive;
}

/// Finite, symmetric and without a negative variance or a correlation above 1, but for rounding.
bool is_covariance(const Matrix& V) {
  constexpr double kRounding = 1e-9;
  if (!V.allFinite() || !(V.diagonal().array() >= 0.0).all()) return false;
  const Vector sigma = V.diagonal().cwiseSqrt();
  const Eigen::ArrayXXd largest = (1.0 + kRounding) * (sigma * sigma.transpose()).array();
  return (V.array().abs() <= largest).all() && ((V - V.transpose()).array().abs() <= kRounding * largest).all();
}

StoredRobot stored_from(const Json& json) {
  if (!has_schema(json, kRobotSchema)) throw Malformed{fmt::format("its schema is not {}", kRobotSchema)};
  StoredRobot stored;
  stored.description = json.value("description", "");
  stored.urdf = json.value("urdf", "");
  stored.drive = drive_from(json.at("drive"));
  const Json& parameters = json.at("parameters");
  const auto count = static_cast<Index>(parameters.size());
  stored.parameters.resize(count);
  for (Index k = 0; k < count; ++k) {
    const Json& one = parameters[static_cast<std::size_t>(k)];
    stored.names.push_back(one.at("name").get<std::string>());
    stored.parameters[k] = number_from(one.at("value"));
  }
  if (!stored.parameters.allFinite()) throw Malformed{"a parameter is not a number"};
  stored.covariance = matrix_from(json, "covariance", count, count);
  if (!is_covariance(stored.covariance)) throw Malformed{"'covariance' is not that of any numbers"};
  stored.delay = number_from(json.at("motor_delay_s"));
  if (!(std::abs(stored.delay) < 1.0)) throw Malformed{"the motor delay is not a number of seconds below 1"};
  stored.usable = json.value("usable", true);
  for (const Json& warning : json.value("warnings", Json::array())) {
    stored.warnings.push_back(warning.at("code").get<std::string>());
  }
  return stored;
}

Json fit_json(const std::vector<TorqueFit>& joints) {
  Json json = Json::array();
  for (const TorqueFit& fit : joints) {
    Json entry = {{"VAF", number(fit.vaf)},
                  {"RMSE", number(fit.rmse)},
                  {"VAF_in_sample", number(fit.vaf_in_sample)},
                  {"RMSE_in_sample", number(fit.rmse_in_sample)}};
    if (fit.vaf_smoothed) entry["VAF_from_smoothed_motion"] = number(*fit.vaf_smoothed);
    json.push_back(std::move(entry));
  }
  return json;
}

Json consistent_json(const ConsistentRobot& consistent) {
  Json json = {{"links", Json::array()}, {"combinations", Json::array()}};
  for (const ConsistentBody& one : consistent.bodies) {
    json["links"].push_back({{"name", one.link},
                             {"mass_kg", number(one.body.mass)},
                             {"centre_m", list(one.body.centre)},
                             {"inertia_about_centre_kg_m2", rows(one.body.inertia)},
                             {"pseudo_inertia_smallest_eigenvalue", number(one.smallest_eigenvalue)}});
  }
  for (const RobotCombination& one : consistent.combinations) {
    Json entry = {{"name", one.name},
                  {"unit", one.unit},
                  {"value", number(one.value)},
                  {"free_value", number(one.free)},
                  {"standard_error", number(one.standard_error)}};
    if (!one.together_with.empty()) entry["together_with"] = one.together_with;
    json["combinations"].push_back(std::move(entry));
  }
  json["free_fit"] = fit_json(consistent.free_fit);
  json["VAF_lost"] = Json::array();
  json["VAF_lost_in_sample"] = Json::array();
  for (const double lost : consistent.vaf_lost) json["VAF_lost"].push_back(number(lost));
  for (const double lost : consistent.vaf_lost_in_sample) json["VAF_lost_in_sample"].push_back(number(lost));
  json["mean_VAF_lost"] = number(consistent.mean_vaf_lost);
  json["loss"] = number(consistent.loss);
  json["loss_gap"] = number(consistent.gap);
  json["newton_steps"] = consistent.newton_steps;
  json["pressing"] = consistent.pressing;
  return json;
}

}  // namespace

std::string to_json(const RobotIdentification& found) {
  Json json = header(kRobotSchema);
  json["inputs"] = inputs_json(found.sources);
  for (std::size_t k = 0; k < found.sources.size() && k < found.durations.size(); ++k) {
    json["inputs"][k]["duration_s"] = found.durations[k];
    json["inputs"][k]["rate_hz"] = found.rates[k];
  }
  json["method"] = word_of(found.method);
  if (found.method == RobotMethod::instrumental_variables) {
    json["instruments"] = word_of(found.instrument_motion);
    if (found.instrument_motion == InstrumentMotion::smoothed) json["motion_cutoff_hz"] = found.motion_cutoff;
  }
  json["parameters"] = Json::array();
  for (const RobotCoefficient& one : found.coefficients) {
    Json entry = {{"name", one.coefficient.name},
                  {"unit", one.coefficient.unit},
                  {"value", number(one.value)},
                  {"standard_error", number(one.standard_error)},
                  {"identified", one.identified}};
    if (one.fixed) entry["fixed"] = true;
    if (!one.together_with.empty()) entry["together_with"] = one.together_with;
    json["parameters"].push_back(std::move(entry));
  }
  json["motor_delay_s"] = found.model.delay;
  if (found.delay_standard_error) json["motor_delay_standard_error_s"] = number(*found.delay_standard_error);
  json["drive"] = drive_json(found.model.drive);
  json["fit"] = fit_json(found.fit);
  if (found.smoothed_cutoff > 0.0) json["smoothed_motion_cutoff_hz"] = found.smoothed_cutoff;
  json["validated_on"] = validated_on(found.held_out);
  if (!found.held_out_files.empty()) json["held_out_files"] = found.held_out_files;
  json["excitation"] = {{"rank", found.rank},
                        {"structural_rank", found.structural_rank},
                        {"condition", number(found.condition)},
                        {"weakest", Json::array()}};
  for (const auto& [name, share] : found.weakest) {
    json["excitation"]["weakest"].push_back({{"name", name}, {"share", number(share)}});
  }
  for (const StatedRatio& one : found.stated) {
    json["stated"].push_back({{"ratio", number(one.ratio)}, {"standard_error", number(one.standard_error)}});
  }
  json["inertia"] = {{"smallest_eigenvalue", number(found.inertia.smallest)}, {"at", found.inertia.where}};
  if (found.consistent) json["consistent"] = consistent_json(*found.consistent);
  json["samples"] = found.samples;
  json["hac_lag_s"] = found.hac_lag_s;
  json["preparation"] = Json::array();
  for (const Preparation& how : found.preparations) {
    Json one = preparation_json(how);
    one.erase("protocol");
    json["preparation"].push_back(std::move(one));
  }
  json["covariance"] = rows(found.model.covariance);
  if (!found.description.empty()) json["description"] = found.description;
  if (!found.urdf.empty()) json["urdf"] = found.urdf;
  json["notes"] = found.notes;
  json["warnings"] = warnings_json(found.warnings);
  json["usable"] = found.usable;
  return dumped(json);
}

std::string to_json(const ForceSummary& force) {
  Json json = header("mbk.force/1");
  json["inputs"] = inputs_json(force.sources);
  json["force_source"] = word_of(force.source);
  json["lag_s"] = number(force.lag);
  json["axes"] = force.axes;
  json["unit"] = force.unit;
  json["RMS"] = list(force.rms);
  json["peak"] = list(force.peak);
  if (force.standard_error.size() > 0) json["standard_error_RMS"] = list(force.standard_error);
  if (force.comparison) json["force_comparison"] = force_comparison_json(*force.comparison);
  json["notes"] = force.notes;
  return dumped(json);
}

Result<StoredRobot> robot_from_json(std::string_view text) {
  const char* const remedy = "give a file that 'mbk robot identify --json' wrote";
  try {
    return stored_from(Json::parse(text));
  } catch (const Malformed& malformed) {
    return bad_data(malformed.message, remedy);
  } catch (const nlohmann::json::parse_error& error) {
    return bad_data(fmt::format("not valid JSON, byte {}", error.byte), remedy);
  } catch (const nlohmann::json::exception& error) {
    return bad_data(fmt::format("not a robot of mbk ({})", error.what()), remedy);
  }
}

}  // namespace mbk::result
