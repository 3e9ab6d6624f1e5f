#include "mbk/simulate/laboratory/record_elbow.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mbk/simulate/laboratory/truth_text.h"

namespace mbk::laboratory {
namespace {

using participant::ElbowJoint;
using participant::StretchedMuscle;
using participant::StretchResponse;
using perturbation::AxesVector;
using perturbation::Jet;
using perturbation::Schedule;
using perturbation::Stretches;

constexpr std::array kMuscles = {"biceps", "triceps"};  // as ElbowJoint::Muscle

void add_muscle(const StretchedMuscle& muscle, const std::string& name, std::map<std::string, std::string>& truth) {
  const std::string key = "truth_" + name;
  truth[key + "_torque_Nm"] = exact_text(muscle.largest_torque);
  truth[key + "_background"] = exact_text(muscle.background);
  if (muscle.threshold) {
    truth[key + "_threshold_rad"] = exact_text(*muscle.threshold);
    truth[key + "_spread_rad"] = exact_text(muscle.threshold_spread);
    truth[key + "_velocity_gain_s"] = exact_text(muscle.velocity_gain);
    truth[key + "_reflex_gain_Nm_per_rad"] = exact_text(muscle.gain);
    truth[key + "_latency_s"] = exact_text(muscle.latency);
  }
  if (muscle.responses.empty()) return;
  const auto listed = [&](double StretchResponse::*value) {
    std::vector<std::string> entries;
    for (const StretchResponse& response : muscle.responses) entries.push_back(exact_text(response.*value));
    return fmt::format("[{}]", fmt::join(entries, ", "));
  };
  truth[key + "_response_latency_s"] = listed(&StretchResponse::latency);
  truth[key + "_response_duration_s"] = listed(&StretchResponse::duration);
  truth[key + "_response_activation"] = listed(&StretchResponse::activation);
}

/// When the stretched muscle crosses its threshold, unless it was beyond before the motion or never is [s].
std::optional<double> crossing(const Schedule& schedule, const Stretches::Stretch& stretch, double home,
                               const StretchedMuscle& muscle, double direction) {
  constexpr double kStep = 1e-4;  // [s]; 300 °/s is 0.03°
  const auto beyond = [&](double t) {
    const Jet<AxesVector> joint = schedule.at(t);
    return direction * (home + joint.value[0] + muscle.velocity_gain * joint.first[0] - *muscle.threshold);
  };
  double before = beyond(stretch.onset);
  if (before > 0.0) return std::nullopt;
  const int steps = static_cast<int>(std::ceil((stretch.still - stretch.onset) / kStep));
  for (int i = 1; i <= steps; ++i) {
    const double t = stretch.onset + i * kStep, after = beyond(t);
    if (after > 0.0) return t - kStep * after / (after - before);
    before = after;
  }
  return std::nullopt;
}

void add_stretches(const ElbowTrial& trial, const Schedule& schedule, std::map<std::string, std::string>& truth) {
  const Stretches* const stretches = schedule.stretches();
  if (stretches == nullptr) return;
  const bool extends = stretches->options().amplitude > 0.0;
  const StretchedMuscle& muscle = trial.elbow.muscles[extends ? ElbowJoint::flexor : ElbowJoint::extensor];
  if (!muscle.threshold) return;
  std::map<double, const Stretches::Stretch*> by_speed;
  for (const Stretches::Stretch& one : stretches->stretches()) by_speed.emplace(one.speed, &one);
  std::vector<std::string> speeds, thresholds, onsets, catches;
  for (const auto& [speed, stretch] : by_speed) {
    const auto time = crossing(schedule, *stretch, trial.home, muscle, extends ? 1.0 : -1.0);
    const auto angle = [&](double later) {
      return time ? exact_text(trial.home + schedule.at(*time + later).value[0]) : std::string("null");
    };
    speeds.push_back(exact_text(speed));
    thresholds.push_back(angle(0.0));
    onsets.push_back(angle(muscle.latency));
    catches.push_back(angle(muscle.latency + trial.elbow.electromechanical_delay));
  }
  for (const auto& [name, values] : {std::pair{"speed_rad_per_s", &speeds}, std::pair{"threshold_rad", &thresholds},
                                     std::pair{"emg_rad", &onsets}, std::pair{"catch_rad", &catches}}) {
    truth[fmt::format("truth_stretch_{}", name)] = fmt::format("[{}]", fmt::join(*values, ", "));
  }
}

std::map<std::string, std::string> reflex_truth(const ElbowTrial& trial, const Schedule& schedule) {
  const ElbowJoint::Options& elbow = trial.elbow;
  std::map<std::string, std::string> truth = {
      {"truth_weight_Nm", exact_text(elbow.weight)},
      {"truth_horizontal_rad", exact_text(elbow.horizontal)},
      {"truth_electromechanical_delay_s", exact_text(elbow.electromechanical_delay)},
      {"truth_activation_time_s", exact_text(elbow.activation_time)},
      {"truth_emg_largest_V", exact_text(trial.emg.largest)},
      {"truth_emg_noise_V", exact_text(trial.emg.noise)}};
  for (std::size_t i = 0; i < kMuscles.size(); ++i) add_muscle(elbow.muscles[i], kMuscles[i], truth);
  add_stretches(trial, schedule, truth);
  return truth;
}

}  // namespace

Result<Performance> record_elbow(const ElbowTrial& trial, const Schedule& schedule, std::uint64_t seed, Hertz rate) {
  ElbowJoint::Options options = trial.elbow;
  options.seed = seed;
  auto elbow = ElbowJoint::create(options, trial.home, 1.0 / rate.value);
  if (!elbow) return tl::unexpected(elbow.error().in("participant"));

  Performance result;
  std::array<std::vector<double>, kMuscles.size()> activations;
  const double interval = 1.0 / rate.value;
  const auto torque = [&](const Jet<AxesVector>& joint) -> AxesVector {
    const ElbowJoint::Output output = elbow->step({joint.value[0], joint.first[0], joint.second[0]});
    for (std::size_t i = 0; i < kMuscles.size(); ++i) activations[i].push_back(output.activation[i]);
    const double power = output.torque * joint.first[0];  // of the limb on the machine [W]
    result.energy_absorbed -= power * interval;
    result.energy_exchanged += std::abs(power) * interval;
    return AxesVector::Constant(1, output.torque);
  };
  const PrescribedMotion motion(Vector::Constant(1, trial.home), schedule);
  result.recording = MBK_TRY(record(motion, torque, trial.sensors, seed, rate));
  for (std::size_t i = 0; i < kMuscles.size(); ++i) {
    auto electrodes = SurfaceEmg::create(trial.emg, rate, seed, static_cast<std::uint32_t>(i));
    if (!electrodes) return tl::unexpected(electrodes.error().in("sensors.emg"));
    Vector voltage(result.recording.samples());
    for (Index k = 0; k < voltage.size(); ++k)
      voltage[k] = electrodes->step(activations[i][static_cast<std::size_t>(k)]);
    result.recording.channels.push_back({std::string("emg_") + kMuscles[i], "V", "", std::move(voltage)});
  }
  result.truth = elbow->impedance();
  result.recording.metadata.merge(truth_metadata(result.truth, rate, result.energy_absorbed));
  result.recording.metadata.merge(reflex_truth(trial, schedule));
  return result;
}

}  // namespace mbk::laboratory
