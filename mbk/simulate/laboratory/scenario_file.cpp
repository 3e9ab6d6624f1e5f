#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/config/trials.h"
#include "mbk/experiment/protocol/trial_sections.h"
#include "mbk/model/robot_file/planar_keys.h"
#include "mbk/simulate/laboratory/scenario.h"

namespace mbk::laboratory {
namespace {

using config::above;
using config::at_least;
using config::between;
using config::Section;
using perturbation::Quantity;

/// Sections of an experiment file other than the scenario (protocol/experiment.h).
constexpr std::array kSectionsOfExperiments = {"session", "safety", "person", "device"};

/// The test location of the planar robot, where the file does not give one [m].
const Vector2d kHome(0.3, -0.05);

/// From the shoulder to the test location (Dyck 2013, §3.4.2) [m].
constexpr double kShoulderDistance = 0.52;

ClosedLoop<2>::Options read_robot(const Section& s) {
  ClosedLoop<2>::Options options;
  options.robot = robot_file::read_planar_robot(s);
  options.handle_mass = s.number("handle_mass_kg", options.handle_mass, at_least(0));
  options.steps_per_tick = s.integer("steps_per_tick", options.steps_per_tick, 1, 100);
  if (const Section c = s.section("capstan"); c.given()) {
    robot::Capstan capstan;
    capstan.stiffness = c.vector2("stiffness_Nm_per_rad", capstan.stiffness, above(0));
    capstan.damping = c.vector2("damping_Nms_per_rad", capstan.damping, at_least(0));
    capstan.motor_inertia = c.vector2("motor_inertia_kg_m2", capstan.motor_inertia, above(0));
    capstan.backlash = c.vector2("backlash_deg", capstan.backlash, at_least(0));
    options.capstan = capstan;
  }
  return options;
}

participant::TwoLinkArm::Options read_two_links(const Section& s, const Vector2d& home) {
  participant::TwoLinkArm::Options limb;
  participant::ArmGeometry& geometry = limb.geometry;
  geometry.upper_arm = s.number("upper_arm_mm", geometry.upper_arm, above(0));
  geometry.forearm = s.number("forearm_mm", geometry.forearm, above(0));
  geometry.shoulder = s.vector2("shoulder_mm", home - Vector2d(0.0, kShoulderDistance));
  geometry.rotation = s.number("rotation_deg", geometry.rotation);
  limb.equilibrium = s.vector2("equilibrium_mm", home);
  if (s.has("number")) {
    if (const auto person = participant::participant_limb(s.integer("number", 1, 1, 6))) limb.joints = person->joints;
  }
  participant::JointParameters& joints = limb.joints;
  joints.inertia = s.matrix2("inertia_kg_m2", joints.inertia);
  joints.elbow_angle = s.number("inertia_elbow_deg", joints.elbow_angle);
  joints.damping = s.matrix2("damping_Nms_per_rad", joints.damping);
  joints.stiffness = s.matrix2("stiffness_Nm_per_rad", joints.stiffness);
  return limb;
}

impedance::Model read_linear_limb(const Section& s, const Vector2d& home) {
  return {s.required_matrix2("mass_kg"), s.required_matrix2("damping_Ns_per_m"),
          s.required_matrix2("stiffness_N_per_m"), s.vector2("equilibrium_mm", home)};
}

/// Voluntary behaviour in addition to the limb; off unless given in the file.
participant::ArmOptions read_will(const Section& s, const Vector2d& home) {
  participant::ArmOptions arm = participant::relaxed_arm_options();
  const Section c = s.section("correction");
  participant::IntermittentController::Options& voluntary = arm.controller;
  voluntary.position = c.vector2("target_mm", home);
  voluntary.position_gain = c.number("position_gain", voluntary.position_gain, at_least(0));
  voluntary.position_threshold = c.number("threshold_mm", voluntary.position_threshold, at_least(0));
  voluntary.force = c.vector2("target_N", voluntary.force);
  voluntary.force_gain = c.number("force_gain", voluntary.force_gain, at_least(0));
  voluntary.force_threshold = c.number("threshold_N", voluntary.force_threshold, at_least(0));
  voluntary.interval = c.number("interval_ms", voluntary.interval, above(0));
  voluntary.delay = c.number("delay_ms", voluntary.delay, at_least(0));
  voluntary.random_error = c.number("random_error_percent", voluntary.random_error, at_least(0));
  voluntary.largest_increment = c.number("largest_increment_N", voluntary.largest_increment, at_least(0));
  voluntary.ramp = c.number("ramp_ms", voluntary.ramp, above(0));
  voluntary.leak = c.number("leak_s", voluntary.leak, above(0));

  const Section t = s.section("cocontraction");
  participant::Cocontraction::Options& tension = arm.cocontraction;
  tension.rest = t.number("rest", tension.rest, between(0, 1));
  tension.slope = t.number("slope", tension.slope, at_least(0));
  tension.speed = t.number("speed_mm_per_s", tension.speed, above(0));
  tension.time_constant = t.number("time_constant_s", tension.time_constant, above(0));
  tension.stiffness_gain = t.number("stiffness_gain", tension.stiffness_gain, at_least(0));
  tension.damping_gain = t.number("damping_gain", tension.damping_gain, at_least(0));
  tension.voluntary_damping = t.number("voluntary_damping", tension.voluntary_damping, between(0, 1));

  const Section r = s.section("remnant");
  arm.remnant.floor = r.number("floor_N", arm.remnant.floor, at_least(0));
  arm.remnant.per_force = r.number("per_force", arm.remnant.per_force, at_least(0));
  arm.remnant.cutoff = Hertz(r.number("cutoff_hz", arm.remnant.cutoff.value, above(0)));
  return arm;
}

/// Limb forces other than M, B and K; none unless given in the file.
std::optional<participant::Departures::Options> read_departures(const Section& s) {
  if (!s.given()) return std::nullopt;
  participant::Departures::Options o;
  o.dry_friction = s.number("dry_friction_N", o.dry_friction, at_least(0));
  o.dry_friction_speed = s.number("dry_friction_speed_mm_per_s", o.dry_friction_speed, above(0));
  o.cubic_stiffness = s.number("cubic_stiffness_N_per_m3", o.cubic_stiffness);
  o.reflex_gain = s.number("reflex_gain_N_per_m", o.reflex_gain);
  o.reflex_delay = s.number("reflex_delay_ms", o.reflex_delay, at_least(0));
  o.tremor_force = s.number("tremor_N", o.tremor_force, at_least(0));
  o.tremor_frequency = Hertz(s.number("tremor_hz", o.tremor_frequency.value, above(0)));
  o.tremor_width = Hertz(s.number("tremor_width_hz", o.tremor_width.value, at_least(0)));
  o.equilibrium_drift = s.vector2("equilibrium_drift_mm_per_s", o.equilibrium_drift);
  o.relaxing_share = s.number("relaxing_share", o.relaxing_share, at_least(0));
  o.one_sided_share = s.number("one_sided_share", o.one_sided_share);
  return o;
}

/// How a participant reaches where the perturbation is one of reaches: when and where to follows from that.
std::optional<participant::Reaching::Options> read_reaching(const Section& s, const perturbation::Plan& perturbation,
                                                            const Vector2d& home) {
  const auto* plan = std::get_if<perturbation::ReachPlan>(&perturbation.kind);
  if (plan == nullptr) {
    if (s.given()) s.reject("", "the perturbation does not use reaches", "set kind = \"servo_displacement\"");
    return std::nullopt;
  }
  const perturbation::ReachSchedule::Options& r = plan->reaches;
  participant::Reaching::Options o;
  o.start = home;
  o.reach = r.reach;
  o.reaches = r.directions * r.repetitions + r.undisturbed_first + r.undisturbed_between;
  o.first = r.quiet;
  o.interval = r.interval;
  o.latest = s.number("latest_s", o.latest, at_least(0));
  o.duration = s.number("duration_s", r.reach_time, above(0));
  o.duration_spread = s.number("duration_spread_percent", o.duration_spread, at_least(0));
  o.length_spread = s.number("length_spread_percent", o.length_spread, at_least(0));
  o.bend = s.number("bend_mm", o.bend, at_least(0));
  o.end_spread = s.number("end_spread_mm", o.end_spread, at_least(0));
  o.stay = s.number("stay_s", o.stay, at_least(0));
  o.way_back = s.number("way_back_s", o.way_back, above(0));
  o.carried_mass = s.number("carried_mass_kg", o.carried_mass, at_least(0));
  return o;
}

std::optional<participant::GripOptions> read_grip(const Section& s) {
  if (!s.given()) return std::nullopt;
  participant::GripOptions grip;
  grip.stiffness = s.required_number("stiffness_N_per_m", above(0));
  grip.damping_ratio = s.number("damping_ratio", grip.damping_ratio, at_least(0));
  return grip;
}

/// A matrix, or one number for the same in all directions.
Matrix2d read_matrix_or_number(const Section& s, const char* key, const char* scalar_key) {
  if (s.has(key)) return s.matrix2(key, Matrix2d::Zero());
  return s.number(scalar_key, 0.0, at_least(0)) * Matrix2d::Identity();
}

RigPlan read_rig(const Section& s, const Vector2d& home) {
  RigPlan rig;
  rig.mass = s.number("mass_kg", rig.mass, at_least(0));
  rig.damping = read_matrix_or_number(s, "damping_matrix_Ns_per_m", "damping_Ns_per_m");
  const std::vector<Section> springs = s.sections("spring");
  for (const Section& one : springs) {
    rig.springs.push_back({one.required_number("stiffness_N_per_m", above(0)),
                           one.required_number("rest_length_mm", at_least(0)), one.required_vector2("anchor_mm"),
                           one.vector2("hole_mm", Vector2d::Zero())});
  }
  if (springs.empty()) {
    rig.stiffness = s.required_matrix2("stiffness_N_per_m");
    rig.equilibrium = s.vector2("equilibrium_mm", home);
  } else {
    for (const char* key : {"stiffness_N_per_m", "equilibrium_mm"}) {
      if (s.has(key)) s.reject(key, "the springs determine this value", "remove this value or the springs");
    }
  }
  return rig;
}

participant::ToneRobot::Options read_tone(const Section& s, const Vector2d& home) {
  participant::ToneRobot::Options tone;
  tone.inertia = s.number("mass_kg", tone.inertia, at_least(0));
  tone.stiffness = s.matrix2("stiffness_N_per_m", tone.stiffness);
  tone.damping = s.matrix2("damping_Ns_per_m", tone.damping);
  tone.rest = s.vector2("rest_mm", home);
  tone.rigidity = s.number("rigidity_N", tone.rigidity, at_least(0));
  tone.rigidity_speed = s.number("rigidity_speed_mm_per_s", tone.rigidity_speed, above(0));
  tone.catch_gain = s.number("catch_gain_Ns_per_m", tone.catch_gain, at_least(0));
  tone.catch_speed = s.number("catch_speed_mm_per_s", tone.catch_speed, at_least(0));
  tone.stretch_angle = s.number("stretch_angle_deg", tone.stretch_angle);
  tone.release_force = s.number("release_force_N", tone.release_force, above(0));
  tone.motor_lag = s.number("motor_lag_ms", tone.motor_lag, at_least(0));
  tone.largest_force = s.number("largest_force_N", tone.largest_force, above(0));
  return tone;
}

participant::OneAxisJoint::Options read_joint(const Section& s) {
  participant::OneAxisJoint::Options joint;
  if (s.required_text("kind") != "joint") {
    s.reject("kind", "a one-axis machine measures a joint", "write kind = \"joint\", or use a planar robot");
  }
  joint.inertia = s.number("inertia_kg_m2", joint.inertia, above(0));
  joint.viscosity = s.number("viscosity_Nms_per_rad", joint.viscosity, at_least(0));
  joint.stiffness = s.number("stiffness_Nm_per_rad", joint.stiffness, at_least(0));
  joint.rest = s.number("rest_deg", joint.rest);
  const Section r = s.section("reflex");
  joint.reflex.gain = r.number("gain_Nms_per_rad", joint.reflex.gain, at_least(0));
  joint.reflex.delay = r.number("delay_ms", joint.reflex.delay, at_least(0));
  joint.reflex.natural_frequency =
      RadPerSec(Hertz(r.number("natural_frequency_hz", Hertz(joint.reflex.natural_frequency).value, above(0))));
  joint.reflex.damping_ratio = r.number("damping_ratio", joint.reflex.damping_ratio, above(0));
  joint.reflex.stretched_by_positive_velocity =
      r.flag("stretched_by_positive_velocity", joint.reflex.stretched_by_positive_velocity);
  const Section noise = s.section("remnant");
  joint.remnant.floor = noise.number("floor_Nm", joint.remnant.floor, at_least(0));
  joint.remnant.cutoff = Hertz(noise.number("cutoff_hz", joint.remnant.cutoff.value, above(0)));
  return joint;
}

LoadCellOptions<2> read_load_cell(const Section& s) {
  LoadCellOptions<2> cell;
  cell.white_noise = s.number("white_noise_N", cell.white_noise, at_least(0));
  cell.coloured_noise = s.number("coloured_noise_N", cell.coloured_noise, at_least(0));
  cell.coloured_bandwidth = Hertz(s.number("coloured_bandwidth_hz", cell.coloured_bandwidth.value, above(0)));
  cell.gain = s.matrix2("gain", cell.gain);
  cell.offset = s.vector2("offset_N", cell.offset);
  cell.drift_walk = s.number("drift_walk_N_per_sqrt_s", cell.drift_walk, at_least(0));
  cell.drift_rate = s.vector2("drift_rate_N_per_s", cell.drift_rate);
  cell.delay = s.number("delay_ms", cell.delay, at_least(0));
  cell.resolution = s.number("resolution_N", cell.resolution, at_least(0));
  return cell;
}

StrainGaugeOptions read_strain_gauge(const Section& s) {
  StrainGaugeOptions gauge;
  gauge.slope = s.vector2("slope_N_per_V", gauge.slope);
  gauge.offset = s.vector2("offset_N", gauge.offset);
  gauge.calibration_arm = s.number("calibration_arm_mm", gauge.calibration_arm, above(0));
  gauge.arm = s.number("arm_mm", gauge.arm, above(0));
  gauge.crosstalk = s.vector2("crosstalk_percent", gauge.crosstalk, between(-100, 100));
  gauge.bridge_noise = s.number("bridge_noise_V_per_sqrt_hz", gauge.bridge_noise, at_least(0));
  gauge.cutoff = Hertz(s.number("cutoff_hz", gauge.cutoff.value, at_least(0)));
  gauge.filter_order = s.integer("filter_order", gauge.filter_order, 1, 20);
  gauge.converter_bits = s.integer("converter_bits", gauge.converter_bits, 0, 24);
  gauge.converter_range = s.number("converter_range_V", gauge.converter_range, above(0));
  gauge.assumed_arm = s.number("assumed_arm_mm", gauge.assumed_arm, above(0));
  gauge.assumed_offset = s.vector2("assumed_offset_N", gauge.assumed_offset);
  return gauge;
}

AccelerometerOptions<2> read_accelerometer(const Section& s) {
  AccelerometerOptions<2> meter;
  meter.noise = s.number("noise_m_per_s2", meter.noise, at_least(0));
  meter.bias = s.vector2("bias_m_per_s2", meter.bias);
  meter.gain_error = s.vector2("gain_error_percent", meter.gain_error, above(-100));
  meter.misalignment = s.number("misalignment_deg", meter.misalignment);
  meter.bandwidth = Hertz(s.number("bandwidth_hz", meter.bandwidth.value, at_least(0)));
  return meter;
}

SensorOptions<2> read_sensors(const Section& s) {
  enum class Force { load_cell, strain_gauge, perfect };
  enum class Acceleration { accelerometer, perfect };
  SensorOptions<2> sensors;
  sensors.encoder_resolution = s.number("encoder_resolution_rad", sensors.encoder_resolution, at_least(0));

  const Section force = s.section("force");
  switch (force.choice(
      "kind", {{"load_cell", Force::load_cell}, {"strain_gauge", Force::strain_gauge}, {"perfect", Force::perfect}},
      Force::load_cell)) {
    case Force::load_cell:
      sensors.force = read_load_cell(force);
      break;
    case Force::strain_gauge:
      sensors.force = read_strain_gauge(force);
      break;
    case Force::perfect:
      sensors.force = PerfectSensor{};
      break;
  }
  const Section acceleration = s.section("acceleration");
  if (acceleration.choice("kind", {{"accelerometer", Acceleration::accelerometer}, {"perfect", Acceleration::perfect}},
                          Acceleration::accelerometer) == Acceleration::perfect) {
    sensors.acceleration = PerfectSensor{};
  } else {
    sensors.acceleration = read_accelerometer(acceleration);
  }
  if (const Section motor = s.section("motor_current"); motor.given()) {
    MotorCurrentOptions<2> current;
    current.torque_constant = motor.vector2("torque_constant_Nm_per_A", current.torque_constant, above(0));
    current.torque_constant_error =
        motor.vector2("torque_constant_error_percent", current.torque_constant_error, above(-100));
    current.noise = motor.number("noise_A", current.noise, at_least(0));
    sensors.torque = current;
  }
  using Timestamps = ClockOptions::Timestamps;
  const Section clock = s.section("clock");
  sensors.clock.jitter = clock.number("jitter_us", sensors.clock.jitter, at_least(0));
  sensors.clock.timestamps = clock.choice(
      "timestamps", {{"actual", Timestamps::actual}, {"nominal", Timestamps::nominal}}, sensors.clock.timestamps);
  return sensors;
}

SensorOptions<1> read_one_axis_sensors(const Section& s) {
  SensorOptions<1> sensors;
  sensors.encoder_resolution = s.number("position_resolution_rad", sensors.encoder_resolution, at_least(0));
  LoadCellOptions<1> cell;
  cell.white_noise = s.number("reaction_noise_Nm", cell.white_noise, at_least(0));
  cell.coloured_noise = s.number("coloured_noise_Nm", cell.coloured_noise, at_least(0));
  cell.coloured_bandwidth = Hertz(s.number("coloured_bandwidth_hz", cell.coloured_bandwidth.value, above(0)));
  cell.drift_walk = s.number("drift_walk_Nm_per_sqrt_s", cell.drift_walk, at_least(0));
  cell.drift_rate[0] = s.number("drift_rate_Nm_per_s", cell.drift_rate[0]);
  sensors.force = cell;
  AccelerometerOptions<1> meter;
  meter.noise = s.number("acceleration_noise_rad_per_s2", meter.noise, at_least(0));
  sensors.acceleration = meter;
  return sensors;
}

OneAxisTrial read_one_axis(const Section& root, const Section& robot) {
  OneAxisTrial trial;
  double& inertia = trial.robot.robot.inertia.mass;
  inertia = robot.number("inertia_kg_m2", inertia, above(0));
  robot::JointFriction& friction = trial.robot.robot.friction[0];
  friction.viscous = robot.number("viscous_Nms_per_rad", friction.viscous, at_least(0));
  friction.coulomb = robot.number("coulomb_Nm", friction.coulomb, at_least(0));
  friction.smoothing = robot.number("smoothing_rad_per_s", friction.smoothing, above(0));
  trial.robot.steps_per_tick = robot.integer("steps_per_tick", trial.robot.steps_per_tick, 1, 100);
  const Section control = root.section("control");
  if (control.required_choice<Quantity>("kind") == Quantity::position) {
    ServoMode servo;
    servo.proportional = control.number("proportional_Nm_per_rad", servo.proportional, at_least(0));
    servo.derivative = control.number("derivative_Nms_per_rad", servo.derivative, at_least(0));
    servo.velocity_cutoff = Hertz(control.number("velocity_cutoff_hz", servo.velocity_cutoff.value, above(0)));
    trial.control = servo;
  } else {
    trial.control = ForceMode{};
  }
  trial.load = read_joint(root.section("participant"));
  trial.sensors = read_one_axis_sensors(root.section("sensors"));
  return trial;
}

PlanarTrial read_planar(const Section& root, const Section& robot, const perturbation::Plan& perturbation) {
  PlanarTrial trial;
  trial.robot = read_robot(robot);
  trial.home = robot.vector2("home_mm", kHome);
  trial.control = protocol::read_control(root.section("control"));
  trial.sensors = read_sensors(root.section("sensors"));
  const Section person = root.section("participant"), rig = root.section("rig");
  if (person.given() && rig.given()) {
    rig.reject("mass_kg", "a participant and a rig cannot both hold the handle", "keep [participant] or [rig]");
  }
  if (rig.given()) trial.load = read_rig(rig, trial.home);
  if (person.given()) {
    enum class Kind { arm, linear, tone };
    const auto kind =
        person.required_choice<Kind>("kind", {{"arm", Kind::arm}, {"linear", Kind::linear}, {"tone", Kind::tone}});
    if (kind == Kind::tone) {
      trial.load = read_tone(person, trial.home);
    } else {
      participant::ArmOptions arm = read_will(person, trial.home);
      for (const Section& at : person.sections("stiffness_at")) {
        arm.stiffness_schedule.push_back({at.required_number("time_s", at_least(0)),
                                          at.required_number("factor", at_least(0)),
                                          at.number("damping_factor", 1.0, at_least(0))});
      }
      arm.departures = read_departures(person.section("departures"));
      arm.reaching = read_reaching(person.section("reaching"), perturbation, trial.home);
      trial.grip = read_grip(person.section("grip"));
      if (kind == Kind::arm) arm.limb = read_two_links(person, trial.home);
      if (kind == Kind::linear) arm.limb = read_linear_limb(person, trial.home);
      trial.load = arm;
    }
  }
  return trial;
}

Eigen::Vector3d read_vector3(const Section& s, const char* key, const Eigen::Vector3d& fallback) {
  return Eigen::Vector3d(s.numbers(key, {fallback.x(), fallback.y(), fallback.z()}, config::any(), 3).data());
}

participant::SpatialArm::Options read_spatial_arm(const Section& s) {
  participant::SpatialArm::Options arm;
  arm.body_mass = s.number("body_mass_kg", arm.body_mass, above(0));
  arm.upper_arm = s.number("upper_arm_mm", arm.upper_arm, above(0));
  arm.forearm = s.number("forearm_mm", arm.forearm, above(0));
  arm.posture = read_vector3(s, "posture_deg", arm.posture);
  arm.axial_rotation = s.number("axial_rotation_deg", arm.axial_rotation);
  arm.damping = s.matrix3("damping_Nms_per_rad", arm.damping);
  arm.stiffness = s.matrix3("stiffness_Nm_per_rad", arm.stiffness);
  if (s.has("equilibrium_mm")) arm.equilibrium = read_vector3(s, "equilibrium_mm", Eigen::Vector3d::Zero());
  return arm;
}

SpaceTrial read_space(const Section& root, const Section& robot) {
  SpaceTrial trial;
  trial.home = read_vector3(robot, "home_mm", trial.home);
  const Section person = root.section("participant");
  enum class Kind { arm, linear };
  if (person.required_choice<Kind>("kind", {{"arm", Kind::arm}, {"linear", Kind::linear}}) == Kind::linear) {
    trial.limb = impedance::Model{person.required_matrix3("mass_kg"), person.required_matrix3("damping_Ns_per_m"),
                                  person.required_matrix3("stiffness_N_per_m"),
                                  read_vector3(person, "equilibrium_mm", trial.home)};
  } else {
    trial.limb = read_spatial_arm(person);
  }
  const Section s = root.section("sensors");
  PrescribedMotionSensors& sensors = trial.sensors;
  sensors.position_quantum = s.number("position_resolution_mm", sensors.position_quantum, at_least(0));
  sensors.force_noise = s.number("force_noise_N", sensors.force_noise, at_least(0));
  sensors.coloured_force_noise = s.number("coloured_noise_N", sensors.coloured_force_noise, at_least(0));
  sensors.coloured_force_bandwidth =
      Hertz(s.number("coloured_bandwidth_hz", sensors.coloured_force_bandwidth.value, above(0)));
  sensors.acceleration_noise = s.number("acceleration_noise_m_per_s2", sensors.acceleration_noise, at_least(0));
  return trial;
}

participant::StretchedMuscle read_muscle(const Section& s) {
  participant::StretchedMuscle muscle;
  muscle.largest_torque = s.number("largest_Nm", muscle.largest_torque, above(0));
  muscle.background = s.number("background_percent", muscle.background, between(0, 100));
  muscle.threshold = s.optional_number("threshold_deg");
  muscle.threshold_spread = s.number("threshold_spread_deg", muscle.threshold_spread, at_least(0));
  muscle.velocity_gain = s.number("velocity_gain_ms", muscle.velocity_gain, at_least(0));
  muscle.gain = s.number("gain_Nm_per_rad", muscle.gain, at_least(0));
  muscle.latency = s.number("latency_ms", muscle.latency, at_least(0));
  if (muscle.gain > 0.0 && !muscle.threshold) {
    s.reject("gain_Nm_per_rad", "the reflex has no threshold", "add threshold_deg");
  }
  for (const Section& one : s.sections("response")) {
    participant::StretchResponse response;
    response.latency = one.required_number("latency_ms", at_least(0));
    response.duration = one.number("duration_ms", response.duration, above(0));
    response.activation = one.number("activation_percent", response.activation, between(0, 100));
    response.spread = one.number("spread_percent", response.spread, at_least(0));
    response.trigger_speed = one.number("trigger_deg_per_s", response.trigger_speed, above(0));
    muscle.responses.push_back(response);
  }
  return muscle;
}

ElbowTrial read_elbow(const Section& root, const Section& robot) {
  ElbowTrial trial;
  trial.home = robot.number("home_deg", trial.home);
  const Section person = root.section("participant");
  if (person.required_text("kind") != "elbow") {
    person.reject("kind", "the machine moves an elbow", "write kind = \"elbow\", or use another robot");
  }
  participant::ElbowJoint::Options& elbow = trial.elbow;
  elbow.inertia = person.number("inertia_kg_m2", elbow.inertia, above(0));
  elbow.viscosity = person.number("viscosity_Nms_per_rad", elbow.viscosity, at_least(0));
  elbow.stiffness = person.number("stiffness_Nm_per_rad", elbow.stiffness, at_least(0));
  elbow.rest = person.number("rest_deg", trial.home);
  elbow.weight = person.number("weight_Nm", elbow.weight, at_least(0));
  elbow.horizontal = person.number("horizontal_deg", elbow.horizontal);
  elbow.electromechanical_delay =
      person.number("electromechanical_delay_ms", elbow.electromechanical_delay, at_least(0));
  elbow.activation_time = person.number("activation_time_ms", elbow.activation_time, above(0));
  elbow.muscles[participant::ElbowJoint::flexor] = read_muscle(person.section("biceps"));
  elbow.muscles[participant::ElbowJoint::extensor] = read_muscle(person.section("triceps"));

  const Section s = root.section("sensors");
  PrescribedMotionSensors& sensors = trial.sensors;
  sensors.position_quantum = s.number("position_resolution_rad", sensors.position_quantum, at_least(0));
  sensors.force_noise = s.number("reaction_noise_Nm", sensors.force_noise, at_least(0));
  sensors.coloured_force_noise = s.number("coloured_noise_Nm", sensors.coloured_force_noise, at_least(0));
  sensors.coloured_force_bandwidth =
      Hertz(s.number("coloured_bandwidth_hz", sensors.coloured_force_bandwidth.value, above(0)));
  const Section e = s.section("emg");
  SurfaceEmgOptions& emg = trial.emg;
  emg.largest = e.number("largest_uV", emg.largest, at_least(0));
  emg.noise = e.number("noise_uV", emg.noise, at_least(0));
  emg.hum = e.number("hum_uV", emg.hum, at_least(0));
  emg.mains = Hertz(e.number("mains_hz", emg.mains.value, above(0)));
  emg.lowest = Hertz(e.number("lowest_hz", emg.lowest.value, above(0)));
  emg.highest = Hertz(e.number("highest_hz", emg.highest.value, above(0)));
  return trial;
}

/// The machine's axis is the first one of the schedule: everything goes to and fro along it.
void along_one_axis(perturbation::Plan& plan) {
  if (auto* binary = std::get_if<perturbation::RandomBinaryPlan>(&plan.kind)) binary->angle = 0.0;
  if (auto* pulses = std::get_if<perturbation::PulsePlan>(&plan.kind)) {
    perturbation::PulseSchedule::Options& p = pulses->pulses;
    p.repetitions = std::max(1, p.repetitions * p.directions / 2);  // as many as there would be in all directions
    p.directions = 2;
  }
  if (auto* ramps = std::get_if<perturbation::RampPlan>(&plan.kind)) {
    perturbation::RampAndHold::Options& r = ramps->ramps;
    r.repetitions = std::max(1, r.repetitions * r.directions / 2);
    r.directions = 2;
  }
}

}  // namespace

Scenario read_scenario(const Section& root) {
  Scenario scenario;
  static_cast<protocol::TrialPlan&>(scenario) = protocol::read_recording(root.section("recording"));
  const Section robot = root.section("robot");
  const protocol::Machine machine = protocol::read_machine(robot);
  scenario.perturbation = protocol::read_perturbation(root.section("perturbation"), machine);
  switch (machine) {
    case protocol::Machine::planar:
      scenario.trial = read_planar(root, robot, scenario.perturbation);
      break;
    case protocol::Machine::one_axis:
      scenario.trial = read_one_axis(root, robot);
      along_one_axis(scenario.perturbation);
      break;
    case protocol::Machine::space:
      scenario.trial = read_space(root, robot);
      break;
    case protocol::Machine::joint:
      scenario.trial = read_elbow(root, robot);
      along_one_axis(scenario.perturbation);
      break;
  }
  return scenario;
}

Result<std::vector<Scenario>> read_scenarios(std::string_view text, const std::filesystem::path& file) {
  return config::read_trials(text, file, [&](const Section& root, const std::string& name) -> Result<Scenario> {
    for (const char* section : kSectionsOfExperiments) root.leave_to_others(section);
    Scenario scenario = read_scenario(root);
    scenario.protocol = file.stem().string();
    scenario.name = name;
    return scenario;
  });
}

}  // namespace mbk::laboratory
