#include <fmt/format.h>

#include "mbk/base/config/trials.h"
#include "mbk/experiment/protocol/experiment.h"
#include "mbk/experiment/protocol/trial_sections.h"
#include "mbk/model/robot_file/planar_keys.h"

namespace mbk::protocol {
namespace {

using config::above;
using config::at_least;
using config::Section;

/// The way there and back is held with the gains of the trial; of hands that reach, whose servo has to be stiffer than
/// a robot at rest can be held quietly, with those of a trial of forces.
control::SequenceOptions read_sequence(const Section& s, const Trial& trial) {
  control::SequenceOptions options;
  const auto* mode = std::get_if<control::PositionMode>(&trial.control);
  const bool reaches = std::holds_alternative<perturbation::ReachPlan>(trial.perturbation.kind);
  if (mode != nullptr && !reaches) options.hold = mode->gains;
  options.soft_start = s.number("soft_start_s", options.soft_start, above(0));
  options.move_speed = s.number("move_speed_mm_per_s", options.move_speed, above(0));
  options.shortest_move = s.number("shortest_move_s", options.shortest_move, above(0));
  options.settle = s.number("settle_s", options.settle, at_least(0));
  options.handover = s.number("handover_s", options.handover, above(0));
  return options;
}

safety::Limits read_limits(Section s) {
  s.rename("limited_for_ms", "max_saturation_time_ms");
  s.rename("frozen_ms", "frozen_sensor_ms");
  s.rename("frozen_torque_Nm", "frozen_sensor_torque_Nm");
  safety::Limits l;
  l.handle_force = s.number("handle_force_N", l.handle_force, above(0));
  l.joint_torque = s.vector2("joint_torque_Nm", l.joint_torque, above(0));
  l.torque_rate = s.number("torque_rate_Nm_per_s", l.torque_rate, above(0));
  l.max_saturation_time = s.number("max_saturation_time_ms", l.max_saturation_time, above(0));
  l.measured_force = s.number("measured_force_N", l.measured_force, above(0));
  l.force_jump = s.number("force_jump_N", l.force_jump, above(0));
  l.speed = s.number("speed_mm_per_s", l.speed, above(0));
  l.acceleration = s.number("acceleration_m_per_s2", l.acceleration, above(0));
  l.workspace_low = s.vector2("workspace_low_mm", l.workspace_low);
  l.workspace_high = s.vector2("workspace_high_mm", l.workspace_high);
  l.joint_margin = s.number("joint_margin_deg", l.joint_margin, at_least(0));
  l.excursion = s.number("excursion_mm", l.excursion, at_least(0));
  l.tracking = s.number("tracking_deg", l.tracking, above(0));
  l.encoder_jump = s.number("encoder_jump_deg", l.encoder_jump, above(0));
  l.frozen_sensor = s.number("frozen_sensor_ms", l.frozen_sensor, at_least(0));
  l.frozen_sensor_torque = s.number("frozen_sensor_torque_Nm", l.frozen_sensor_torque, above(0));
  l.accelerometer = s.number("accelerometer_m_per_s2", l.accelerometer, at_least(0));
  l.link_silence = s.number("link_silence_ms", l.link_silence, above(0));
  l.lateness = s.number("lateness_ms", l.lateness, at_least(0));
  l.answer_lag = s.number("answer_lag_ms", l.answer_lag, at_least(0));
  l.state_age = s.number("state_age_ms", l.state_age, at_least(0));
  l.motors_reply = s.number("motors_reply_ms", l.motors_reply, above(0));
  l.motors_off = s.number("motors_off_ms", l.motors_off, above(0));
  l.torque_error = s.number("torque_error_Nm", l.torque_error, at_least(0));
  l.off_torque = s.number("off_torque_Nm", l.off_torque, above(0));
  return l;
}

Person read_person(const Section& s) {
  for (const char* key : {"name", "first_name", "last_name", "surname", "initials", "date_of_birth", "birthday"}) {
    if (s.has(key)) {
      s.reject(key, "who the person is has no place in a recording",
               "keep the list of numbers and names elsewhere, under lock; give 'number'");
    }
  }
  Person p;
  p.number = s.integer("number", p.number, 0, 999'999);
  p.age_years = s.number("age_years", p.age_years, config::between(0, 120));
  p.handedness = s.choice<std::string>(
      "handedness", {{"right", "right"}, {"left", "left"}, {"both", "both"}, {"unknown", ""}}, p.handedness);
  p.height = s.number("height_cm", p.height, at_least(0));
  p.weight = s.number("weight_kg", p.weight, at_least(0));
  p.upper_arm = s.number("upper_arm_mm", p.upper_arm, at_least(0));
  p.forearm = s.number("forearm_mm", p.forearm, at_least(0));
  p.consent = s.text("consent", p.consent);
  p.withdrawn = s.flag("withdrawn", p.withdrawn);
  return p;
}

}  // namespace

Result<std::vector<Trial>> read_experiment(std::string_view text, const std::filesystem::path& file,
                                           const ReadSimulation& simulation) {
  return config::read_trials(text, file, [&](const Section& root, const std::string& name) -> Result<Trial> {
    Trial trial;
    static_cast<TrialPlan&>(trial) = read_recording(root.section("recording"));
    trial.name = name;
    trial.protocol = file.stem().string();
    const Section robot = root.section("robot");
    if (read_machine(robot) != Machine::planar) {
      return tl::unexpected(robot.error("kind", "a one-axis machine cannot be run as an experiment yet",
                                        "take a planar robot; 'mbk simulate' makes recordings of one-axis machines"));
    }
    trial.perturbation = read_perturbation(root.section("perturbation"), Machine::planar);
    trial.robot = robot_file::read_planar_robot(robot);
    trial.handle_mass = robot.number("handle_mass_kg", trial.handle_mass, at_least(0));
    trial.home = robot.vector2("home_mm", trial.home);
    trial.control = read_control(root.section("control"));
    if (simulation) {
      auto made = simulation(root, trial);
      if (!made) return tl::unexpected(made.error());
      trial.simulation = std::move(*made);
    } else {
      for (const char* key : {"steps_per_tick", "capstan"}) robot.leave_to_others(key);
      for (const char* key : {"participant", "rig", "sensors"}) root.leave_to_others(key);
    }
    trial.sequence = read_sequence(root.section("session"), trial);
    const Section safety = root.section("safety");
    trial.limits = read_limits(safety);
    trial.from_plan = {!safety.has("speed_mm_per_s"), !safety.has("excursion_mm"), !safety.has("tracking_deg")};
    trial.person = read_person(root.section("person"));
    trial.device = read_device(root.section("device"), file.parent_path());
    return trial;
  });
}

Result<std::unique_ptr<device::Device>> make_device(const Trial& trial) {
  const auto widened = [](auto made) -> Result<std::unique_ptr<device::Device>> {
    if (!made) return tl::unexpected(made.error());
    return std::unique_ptr<device::Device>(std::move(*made));
  };
  if (const auto* udp = std::get_if<drivers::UdpOptions>(&trial.device.kind)) {
    return widened(drivers::UdpDevice::create(*udp, trial.device.fittings));
  }
  if (const auto* plugin = std::get_if<drivers::PluginOptions>(&trial.device.kind)) {
    return widened(drivers::PluginDevice::create(*plugin, trial.device.fittings));
  }
  if (trial.simulation == nullptr) {
    return bad_usage("the experiment names no robot, and there is nothing here that simulates one",
                     "name the robot in [device], or hand read_experiment a simulation");
  }
  return trial.simulation->robot(trial);
}

std::map<std::string, std::string> metadata_of(const Person& person) {
  std::map<std::string, std::string> metadata;
  const auto number = [&](const char* name, double value) {
    if (value > 0.0) metadata[name] = fmt::format("{:g}", value);
  };
  number("participant", person.number);
  number("age_years", person.age_years);
  number("height_m", person.height);
  number("weight_kg", person.weight);
  number("upper_arm_m", person.upper_arm);
  number("forearm_m", person.forearm);
  if (!person.handedness.empty()) metadata["handedness"] = person.handedness;
  if (!person.consent.empty()) metadata["consent"] = person.consent;
  metadata["withdrawn"] = person.withdrawn ? "yes" : "no";
  return metadata;
}

}  // namespace mbk::protocol
