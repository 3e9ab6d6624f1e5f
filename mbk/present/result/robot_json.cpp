#include "mbk/present/result/robot_json.h"

#include <algorithm>
#include <cmath>

#include "mbk/model/robot/drive_term_names.h"
#include "mbk/present/result/described.h"
#include "mbk/present/result/json_reading.h"
#include "mbk/present/result/schemas.h"

namespace mbk {

using document::Fields;
using document::Json;
using document::through;

constexpr const char* kRobotSchema = "mbk.robot/1";

namespace robot {

void describe(Fields<DriveTerms>& fields) {
  Json words = Json::array();
  for (const DriveTermName& term : kDriveTermNames) words.push_back(term.word);
  fields.add_as("terms", {{"type", "array"}, {"items", {{"enum", std::move(words)}}}}, [](const DriveTerms& drive) {
    Json terms = Json::array();
    for (const DriveTermName& term : kDriveTermNames) {
      if (drive.*term.requested) terms.push_back(term.word);
    }
    return terms;
  });
  fields.add_number("smoothing", &DriveTerms::smoothing, "smoothing of the sign of the velocity [rad/s; m/s]");
}

}  // namespace robot

void describe(Fields<TorqueFit>& fields) {
  fields.type("TorqueFit", "Fit of the torque of one joint.");
  fields.add("VAF", &TorqueFit::vaf, "[%]");
  fields.add("RMSE", &TorqueFit::rmse, "[N·m; N]");
  fields.add("VAF_in_sample", &TorqueFit::vaf_in_sample, "[%]");
  fields.add("RMSE_in_sample", &TorqueFit::rmse_in_sample, "[N·m; N]");
  fields.add("VAF_from_smoothed_motion", &TorqueFit::vaf_smoothed, "[%]");
}

void describe(Fields<ConsistentBody>& fields) {
  const auto body = &ConsistentBody::body;
  fields.type("ConsistentBody");
  fields.add("name", &ConsistentBody::link);
  fields.add("mass_kg", through(body, &robot::RigidBody::mass), "[kg]");
  fields.add("centre_m", through(body, &robot::RigidBody::centre), "of mass [m]");
  fields.add("inertia_about_centre_kg_m2", through(body, &robot::RigidBody::inertia), "[kg·m²]");
  fields.add("pseudo_inertia_smallest_eigenvalue", &ConsistentBody::smallest_eigenvalue, "in SI units; above 0");
}

void describe(Fields<RobotCombination>& fields) {
  fields.type("RobotCombination");
  fields.add("name", &RobotCombination::name);
  fields.add("unit", &RobotCombination::unit);
  fields.add("value", &RobotCombination::value);
  fields.add("free_value", &RobotCombination::free, "of the free fit");
  fields.add("standard_error", &RobotCombination::standard_error, "of the free fit");
  fields.add_unless_empty("together_with", &RobotCombination::together_with,
                          "other coefficients included in the value");
}

void describe(Fields<ConsistentRobot>& fields) {
  fields.type("ConsistentRobot", "Present with `--consistent`; `parameters` and `fit` are then those of this robot.");
  fields.add("links", &ConsistentRobot::bodies,
             "Physically consistent bodies in the frames of their links; not unique: others give the same motion.");
  fields.add("combinations", &ConsistentRobot::combinations, "Identifiable combinations (base parameters).");
  fields.add("free_fit", &ConsistentRobot::free_fit);
  fields.add("VAF_lost", &ConsistentRobot::vaf_lost, "of each joint: free fit minus this fit [percentage points]");
  fields.add("VAF_lost_in_sample", &ConsistentRobot::vaf_lost_in_sample, "[points]");
  fields.add("mean_VAF_lost", &ConsistentRobot::mean_vaf_lost, "mean over the joints [percentage points]");
  fields.add("loss", &ConsistentRobot::loss,
             "half the sum of squared residuals added by the constraints, relative to the variance of the residual");
  fields.add("loss_gap", &ConsistentRobot::gap, "decrease of the loss in the last tenfold step towards its minimum");
  fields.add("newton_steps", &ConsistentRobot::newton_steps);
  fields.add("pressing", &ConsistentRobot::pressing,
             "active constraints, which the free fit would violate, strongest first");
}

void describe(Fields<RobotCoefficient>& fields) {
  const auto coefficient = &RobotCoefficient::coefficient;
  fields.type("RobotParameter");
  fields.add("name", through(coefficient, &robot::Coefficient::name));
  fields.add("unit", through(coefficient, &robot::Coefficient::unit));
  fields.add("value", &RobotCoefficient::value);
  fields.add("standard_error", &RobotCoefficient::standard_error);
  fields.add("identified", &RobotCoefficient::identified,
             "false: it is included in identified ones; in a consistent fit: it is not identifiable alone");
  fields.add_as("fixed", {{"enum", {true}}}, &RobotCoefficient::fixed, "taken as known")
      .only_if(&RobotCoefficient::fixed);
  fields.add_unless_empty("together_with", &RobotCoefficient::together_with,
                          "other coefficients included in the value");
}

void describe(Fields<StatedRatio>& fields) {
  fields.type("StatedRatio");
  fields.add("ratio", &StatedRatio::ratio);
  fields.add("standard_error", &StatedRatio::standard_error);
}

namespace {

struct WeakCoefficient {
  std::string name;
  double share;
};

void describe(Fields<WeakCoefficient>& fields) {
  fields.type("WeakCoefficient");
  fields.add("name", &WeakCoefficient::name);
  fields.add("share", &WeakCoefficient::share);
}

struct RobotPreparation {
  const Preparation* how;
};

void describe(Fields<RobotPreparation>& fields) {
  fields.type("RobotPreparation", "How the signals were prepared.");
  fields.with([](const RobotPreparation& one) -> const Preparation& { return *one.how; }, "protocol");
}

}  // namespace

void describe(Fields<RobotIdentification>& fields) {
  using Found = RobotIdentification;
  using From = const Found&;
  const auto model = &Found::model;
  const auto by_instruments = [](From found) { return found.method == RobotMethod::instrumental_variables; };
  fields.type("Robot", "Output of `mbk robot identify --json`: the dynamics of a robot, complete for later use.");
  fields.header(kRobotSchema);
  fields.add("inputs", [](From found) {
    std::vector<result::TimedInput> inputs;
    for (std::size_t k = 0; k < found.sources.size(); ++k) {
      const bool is_timed = k < found.durations.size();
      inputs.push_back({found.sources[k], is_timed ? found.durations[k] : kNaN, is_timed ? found.rates[k] : kNaN});
    }
    return inputs;
  });
  fields.add("method", &Found::method);
  fields.add_if(by_instruments, "instruments", &Found::instrument_motion);
  fields.add_number("motion_cutoff_hz", &Found::motion_cutoff, "[Hz]").only_if([by_instruments](From found) {
    return by_instruments(found) && found.instrument_motion == InstrumentMotion::smoothed;
  });
  fields.add("parameters", &Found::coefficients);
  fields.add_number("motor_delay_s", through(model, &robot::DynamicModel::delay), "[s]");
  fields.add("motor_delay_standard_error_s", &Found::delay_standard_error,
             "[s]; absent if the delay was not estimated");
  fields.group("drive", [](Fields<Found>& part) {
    const auto drive = through(&Found::model, &robot::DynamicModel::drive);
    part.with(drive);
    part.add_number("stribeck_velocity", through(drive, &robot::DriveTerms::stribeck_velocity), "[rad/s; m/s]")
        .only_if(through(drive, &robot::DriveTerms::stribeck));
  });
  fields.add("fit", &Found::fit);
  fields.add_number("smoothed_motion_cutoff_hz", &Found::smoothed_cutoff, "[Hz]").only_if([](From found) {
    return found.smoothed_cutoff > 0.0;
  });
  result::add_validated_on(fields, &Found::held_out);
  fields.add_unless_empty("held_out_files", &Found::held_out_files);
  fields.group("excitation", [](Fields<Found>& part) {
    part.add("rank", &Found::rank);
    part.add("structural_rank", &Found::structural_rank);
    part.add("condition", &Found::condition);
    part.add("weakest", [](From found) {
      std::vector<WeakCoefficient> weakest;
      for (const auto& [name, share] : found.weakest) weakest.push_back({name, share});
      return weakest;
    });
  });
  fields.add_unless_empty("stated", &Found::stated,
                          "for each joint: ratio of its torque to that for masses and inertias of the URDF, with free "
                          "friction; absent if no URDF states all masses");
  const auto inertia = [](Fields<Found>& part) {
    part.add("smallest_eigenvalue", through(&Found::inertia, &InertiaCheck::smallest), "[kg·m²; kg]");
    part.add("at", through(&Found::inertia, &InertiaCheck::where), "joint positions there [rad; m]");
  };
  fields.group("inertia", inertia, "Whether the inertia matrix is positive definite in every posture.");
  fields.add("consistent", &Found::consistent);
  fields.add("samples", &Found::samples);
  fields.add("hac_lag_s", &Found::hac_lag_s, "[s]");
  fields.add("preparation", [](From found) {
    std::vector<RobotPreparation> all;
    for (const Preparation& how : found.preparations) all.push_back({&how});
    return all;
  });
  fields.add("covariance", through(model, &robot::DynamicModel::covariance), "of the parameters");
  fields.add_unless_empty("description", &Found::description, "TOML: the mechanism");
  fields.add_unless_empty("urdf", &Found::urdf, "the mechanism");
  fields.add("notes", &Found::notes);
  fields.add("warnings", &Found::warnings);
  fields.add("usable", &Found::usable);
}

void describe(Fields<ForceSummary>& fields) {
  fields.type("Force", "Output of `mbk robot force --json`: summary of a computed force.");
  fields.header("mbk.force/1");
  fields.add("inputs", &ForceSummary::sources);
  fields.add("force_source", &ForceSummary::source);
  fields.add("lag_s", &ForceSummary::lag, "of the force [s]");
  fields.add_as("axes", {{"type", "array"}, {"items", {{"enum", {"x", "y", "z"}}}}}, &ForceSummary::axes,
                "axes of the base frame along which the force is given");
  fields.add_as("unit", {{"enum", {"N", "N·m"}}}, &ForceSummary::unit,
                "unit of the force, which is a torque if the hand turns");
  fields.add("RMS", &ForceSummary::rms, "[unit]");
  fields.add("peak", &ForceSummary::peak, "[unit]");
  fields.add_if([](const ForceSummary& force) { return force.standard_error.size() > 0; }, "standard_error_RMS",
                &ForceSummary::standard_error, "[unit]");
  fields.add("force_comparison", &ForceSummary::comparison);
  fields.add("notes", &ForceSummary::notes);
}

namespace result {
namespace {

struct DescribedJoint {
  std::string name;
  bool slides;
  std::pair<double, double> limits;
};

void describe(Fields<DescribedJoint>& fields) {
  fields.type("DescribedJoint");
  fields.add("name", &DescribedJoint::name);
  fields.add("slides", &DescribedJoint::slides);
  fields.add("limits", &DescribedJoint::limits, "[rad; m]");
}

struct DescribedCoefficient {
  robot::Coefficient coefficient;
  std::optional<double> value;
  Json part_of;
};

void describe(Fields<DescribedCoefficient>& fields) {
  const auto coefficient = &DescribedCoefficient::coefficient;
  fields.type("DescribedCoefficient");
  fields.add("name", through(coefficient, &robot::Coefficient::name));
  fields.add("unit", through(coefficient, &robot::Coefficient::unit));
  fields.add_or_null("value", &DescribedCoefficient::value, "null: the description does not state it");
  fields
      .add_form<std::map<std::string, double>>(
          "part_of", &DescribedCoefficient::part_of,
          "identifiable coefficients that include it, with its factor; absent if it is identifiable itself")
      .only_if([](const DescribedCoefficient& one) { return !one.part_of.is_null(); });
}

struct DescribedRobot {
  const robot::RobotDescription& description;
  const numeric::IndependentColumns& base;

  [[nodiscard]] const robot::Mechanism& mechanism() const { return *description.model.mechanism; }
};

std::vector<DescribedJoint> joints_of(const DescribedRobot& described) {
  const robot::Mechanism& mechanism = described.mechanism();
  std::vector<DescribedJoint> joints;
  for (int joint = 0; joint < mechanism.joints(); ++joint) {
    const robot::JointRange range = mechanism.joint_range(joint);
    joints.push_back({mechanism.joint_name(joint), mechanism.slides(joint), {range.low, range.high}});
  }
  return joints;
}

std::vector<DescribedCoefficient> coefficients_of(const DescribedRobot& described) {
  const auto& [description, base] = described;
  const std::vector<robot::Coefficient> coefficients = description.model.coefficients();
  std::vector<DescribedCoefficient> all;
  for (std::size_t j = 0; j < coefficients.size(); ++j) {
    const auto column = static_cast<Index>(j);
    DescribedCoefficient one = {coefficients[j], std::nullopt, nullptr};
    if (std::ranges::find(description.unstated, one.coefficient.name) == description.unstated.end()) {
      one.value = description.model.parameters[column];
    }
    if (std::ranges::find(base.kept, column) == base.kept.end()) {
      constexpr double kNone = 1e-6;
      one.part_of = Json::object();
      for (std::size_t k = 0; k < base.kept.size(); ++k) {
        const double factor = base.combination(static_cast<Index>(k), column);
        if (std::abs(factor) < kNone) continue;
        one.part_of[coefficients[static_cast<std::size_t>(base.kept[k])].name] = document::number(factor);
      }
    }
    all.push_back(std::move(one));
  }
  return all;
}

void describe(Fields<DescribedRobot>& fields) {
  using From = const DescribedRobot&;
  fields.type("Robot description", "Output of `mbk robot describe --json`: the description of a robot as understood.");
  fields.header("mbk.robot_description/1");
  fields.add("file", [](From robot) { return robot.description.source; });
  fields.add("joints", joints_of);
  fields.add("hand_axes", [](From robot) { return robot.mechanism().hand_axes(); });
  fields.add(
      "hand_at_zero",
      [](From robot) -> Vector {
        return robot.mechanism().hand_position(robot::JointVector::Zero(robot.mechanism().joints()));
      },
      "[m]");
  fields.group("drive", [](Fields<DescribedRobot>& part) {
    part.with([](From robot) -> const robot::DriveTerms& { return robot.description.model.drive; });
    part.add(
        "stribeck_velocity", [](From robot) { return robot.description.model.drive.stribeck_velocity; },
        "[rad/s; m/s]");
    part.add(
        "delay", [](From robot) { return robot.description.model.delay; }, "[s]");
  });
  fields.add("structural_rank", [](From robot) { return robot.base.kept.size(); });
  fields.add("coefficients", coefficients_of);
  fields.add(
      "impossible", [](From robot) { return robot.description.impossible; },
      "physically impossible values in the files");
}

robot::DriveTerms drive_from(const Json& json) {
  robot::DriveTerms drive;
  for (const robot::DriveTermName& term : robot::kDriveTermNames) drive.*term.requested = false;
  for (const Json& name : json.at("terms")) {
    bool known = false;
    for (const robot::DriveTermName& term : robot::kDriveTermNames) {
      if (name != term.word) continue;
      drive.*term.requested = known = true;
    }
    if (!known) throw Malformed{fmt::format("unknown term {}", name.dump())};
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
  if (!is_covariance(stored.covariance)) throw Malformed{"'covariance' is not a covariance matrix"};
  stored.delay = number_from(json.at("motor_delay_s"));
  if (!(std::abs(stored.delay) < 1.0)) throw Malformed{"the motor delay is not a number of seconds below 1"};
  stored.usable = json.value("usable", true);
  for (const Json& warning : json.value("warnings", Json::array())) {
    stored.warnings.push_back(warning.at("code").get<std::string>());
  }
  return stored;
}

}  // namespace

std::string to_json(const RobotIdentification& found) {
  return document::document(found);
}

std::string to_json(const ForceSummary& force) {
  return document::document(force);
}

std::string to_json(const robot::RobotDescription& description, const numeric::IndependentColumns& base) {
  return document::document(DescribedRobot{description, base});
}

void add_robot_schemas(document::Schemas& schemas) {
  schemas["robot"] = document::schema_of<RobotIdentification>();
  schemas["force"] = document::schema_of<ForceSummary>();
  schemas["robot_description"] = document::schema_of<DescribedRobot>();
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

}  // namespace result
}  // namespace mbk
