#include <fmt/format.h>

#include <span>

#include "mbk/base/config/trials.h"
#include "mbk/experiment/protocol/experiment.h"
#include "mbk/experiment/protocol/trial_sections.h"
#include "mbk/files/contents/sha256.h"
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
  for (const safety::LimitKey& one : safety::limit_keys()) {
    const config::Range range = one.may_be_off ? at_least(0) : above(0);
    if (const auto* member = std::get_if<double safety::Limits::*>(&one.member)) {
      l.*(*member) = s.number(one.key, l.*(*member), range);
    } else {
      Eigen::Vector2d& both = l.*std::get<Eigen::Vector2d safety::Limits::*>(one.member);
      both = s.vector2(one.key, both, range);
    }
    if (one.of(l) > one.most) {
      s.reject(one.key, fmt::format("is above {:g}: {}", one.most, one.why), "choose a smaller limit");
    }
  }
  l.workspace_low = s.vector2("workspace_low_mm", l.workspace_low);
  l.workspace_high = s.vector2("workspace_high_mm", l.workspace_high);
  return l;
}

Person read_person(const Section& s) {
  for (const char* key : {"name", "first_name", "last_name", "surname", "initials", "date_of_birth", "birthday"}) {
    if (s.has(key)) {
      s.reject(key, "a recording must not identify the person",
               "give 'number', and keep the list of numbers and names locked away elsewhere");
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
    trial.file_sha256 = recording::sha256(std::as_bytes(std::span(text)));
    const Section robot = root.section("robot");
    const Machine machine = read_machine(robot);
    if (machine == Machine::space) {
      return tl::unexpected(robot.error("kind",
                                        "a hand in space cannot be run as an experiment: mbk drives planar robots",
                                        "use 'mbk simulate', or drive your own robot with the recorded motion"));
    }
    if (machine != Machine::planar) {
      return tl::unexpected(robot.error("kind", "a one-axis machine cannot be run as an experiment yet",
                                        "use a planar robot; 'mbk simulate' makes recordings of one-axis machines"));
    }
    trial.perturbation = read_perturbation(root.section("perturbation"), Machine::planar);
    trial.robot = robot_file::read_planar_robot(robot);
    trial.handle_mass = robot.number("handle_mass_kg", trial.handle_mass, at_least(0));
    trial.home = robot.vector2("home_mm", trial.home);
    trial.control = read_control(root.section("control"));
    if (simulation) {
      trial.simulation = MBK_TRY(simulation(root, trial));
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
    if (!trial.device.simulated()) {
      if (!root.has("robot")) {
        return tl::unexpected(root.error("device", "names a robot, but there is no [robot] to describe it",
                                         "write [robot] with your d1_mm, d2_mm, home_mm, alpha_kg_m2 and friction; "
                                         "docs/guide/own_robot.md draws them"));
      }
      for (const char* key : {"d1_mm", "d2_mm", "home_mm", "theta1_deg", "theta2_deg", "alpha_kg_m2", "coulomb_Nm",
                              "viscous_Nms_per_rad"}) {
        if (!robot.has(key)) trial.assumed.emplace_back(key);
      }
    }
    return trial;
  });
}

std::string assumptions_text(const Trial& trial) {
  if (trial.assumed.empty()) return {};
  return fmt::format("[robot] does not give {}: mbk assumes {} of the robot of Dyck (2013)",
                     fmt::join(trial.assumed, ", "), trial.assumed.size() == 1 ? "that" : "those");
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
    return bad_usage("the experiment names no robot, and no simulation is available",
                     "name the robot in [device], or pass a simulation to read_experiment");
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
