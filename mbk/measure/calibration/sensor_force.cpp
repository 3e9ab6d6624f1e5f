#include "mbk/measure/calibration/sensor_force.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mbk/base/core/units.h"
#include "mbk/model/robot/kinematics.h"

namespace mbk::calibration {
namespace {

Result<void> check(const SensorUse& use) {
  const SensorCalibration& c = use.calibration;
  if (use.lever_arm && !(*use.lever_arm > 0.0 && std::isfinite(*use.lever_arm))) {
    return bad_usage(fmt::format("the lever arm of {:g} m is not above 0", *use.lever_arm));
  }
  if (use.lever_arm && !c.lever_arm) {
    return bad_usage(fmt::format("{} does not contain the lever arm of its calibration", use.name),
                     "calibrate with --lever-arm-mm, or omit it here");
  }
  if (use.zero_voltage && use.zero_from_s) return bad_usage("the zero is given in two ways", "give it in one way");
  if (use.zero_voltage && use.zero_voltage->size() != std::ssize(c.axes)) {
    return bad_usage(fmt::format("{} zero voltages were given for {} axes", use.zero_voltage->size(), c.axes.size()));
  }
  return {};
}

/// N×n [V]
Result<Matrix> voltages_of(const Recording& recording, const SensorCalibration& calibration) {
  Matrix voltage(recording.samples(), std::ssize(calibration.axes));
  for (Index k = 0; k < voltage.cols(); ++k) {
    const std::string name = "voltage_" + calibration.axes[static_cast<std::size_t>(k)].name;
    const Channel* const channel = recording.find(name);
    if (channel == nullptr) {
      return bad_data(fmt::format("{} is missing, but the calibration needs it", name),
                      "name it, as in --channels Vx=NAME,Vy=NAME,…, or omit --sensor");
    }
    for (Index i = 0; i < channel->values.size(); ++i) {
      if (std::isfinite(channel->values[i])) continue;
      return bad_data(fmt::format("{} is not a number at sample {}", name, i + 1), "correct the recording");
    }
    voltage.col(k) = channel->values;
  }
  return voltage;
}

Result<Vector> zero_of(const Recording& recording, const Matrix& voltage, const SensorUse& use) {
  if (use.zero_voltage) return *use.zero_voltage;
  if (!use.zero_from_s) {
    Vector zero(voltage.cols());
    for (Index k = 0; k < zero.size(); ++k) zero[k] = use.calibration.axes[static_cast<std::size_t>(k)].zero_voltage;
    return zero;
  }
  const double end = recording.time[0] + *use.zero_from_s;
  Index count = 0;
  while (count < recording.samples() && recording.time[count] < end) ++count;
  if (!(*use.zero_from_s > 0.0) || count == recording.samples()) {
    return bad_usage(
        fmt::format("the time for the zero, {:g} s, is not above 0 and within the recording", *use.zero_from_s),
        "give the time without load at the start, as in --sensor-zero auto:2");
  }
  return Vector(voltage.topRows(count).colwise().mean().transpose());
}

Result<void> turn_to_base(const Recording& recording, Matrix& force) {
  const Channel* const joint = recording.find("joint_2");
  if (joint == nullptr || joint->unit != "rad") {
    return bad_data("joint_2 is not recorded, so the sensor's axes are not known",
                    "name it, as in --channels q2=NAME, or pass --sensor-frame base");
  }
  if (force.cols() < 2) {
    return bad_data("the sensor turns with the last link, but was calibrated on one axis only",
                    "calibrate both axes, or pass --sensor-frame base");
  }
  for (Index i = 0; i < force.rows(); ++i) {
    if (!std::isfinite(joint->values[i])) {
      return bad_data(fmt::format("joint_2 is not a number at sample {}", i + 1), "correct the recording");
    }
    force.row(i) = force.row(i) * robot::link_axes(joint->values[i]).transpose();
  }
  return {};
}

/// Forces as they were at the time of each sample, and how many samples are left.
Index undo_delay(const Vector& time, double delay, Matrix& force) {
  Index next = 0, left = 0;
  for (; left < time.size(); ++left) {
    const double at = time[left] + delay;
    while (next < time.size() && time[next] < at) ++next;
    if (next == time.size()) break;
    if (next == 0) continue;
    const double step = time[next] - time[next - 1];
    const double share = step > 0.0 ? std::clamp((at - time[next - 1]) / step, 0.0, 1.0) : 1.0;
    force.row(left) = (1.0 - share) * force.row(next - 1) + share * force.row(next);
  }
  return left;
}

void put(Recording& recording, const std::string& name, Vector values) {
  std::erase_if(recording.channels, [&](const Channel& channel) { return channel.name == name; });
  recording.channels.push_back({name, "N", "base", std::move(values)});
}

}  // namespace

Result<Recording> force_from_voltage(Recording recording, const SensorUse& use) {
  MBK_TRY(check(use));
  const SensorCalibration& calibration = use.calibration;
  const auto voltage = MBK_TRY(voltages_of(recording, calibration));
  const auto zero = MBK_TRY(zero_of(recording, voltage, use));
  const double arm = use.lever_arm ? *calibration.lever_arm / *use.lever_arm : 1.0;
  Matrix force = (voltage.rowwise() - zero.transpose()) * (arm * calibration.slope).transpose();

  std::vector<std::string>& notes = recording.notes;
  std::vector<std::string> names, zeros;
  bool replaced = false;
  for (Index k = 0; k < force.cols(); ++k) {
    const std::string& axis = calibration.axes[static_cast<std::size_t>(k)].name;
    names.push_back("force_" + axis);
    zeros.push_back(fmt::format("{:.5g}", zero[k]));
    replaced = replaced || recording.find(names.back()) != nullptr;
  }
  notes.push_back(fmt::format(
      "{} from the voltages by {}; zero at {} V{}{}", fmt::join(names, " and "), use.name, fmt::join(zeros, " and "),
      use.zero_from_s    ? fmt::format(", the mean of the first {:g} s", *use.zero_from_s)
      : use.zero_voltage ? ", as given"
                         : "",
      use.lever_arm ? fmt::format("; slope times {:.4g}, for a lever arm of {:g} mm after {:g} mm", arm,
                                  kMillimetres * *use.lever_arm, kMillimetres * *calibration.lever_arm)
                    : ""));
  if (replaced) notes.emplace_back("the recorded force was ignored");
  if (use.undo_delay && calibration.delay != 0.0) {
    const Index left = undo_delay(recording.time, calibration.delay, force);
    if (left < 2) return bad_data("the recording is shorter than the sensor's delay", "record longer");
    notes.push_back(fmt::format("the force was shifted earlier by {:.3g} ms, and the last {} samples ignored",
                                kMilliseconds * calibration.delay, recording.samples() - left));
    force.conservativeResize(left, Eigen::NoChange);
    recording.time.conservativeResize(left);
    for (Channel& channel : recording.channels) channel.values.conservativeResize(left);
  } else if (calibration.delay != 0.0) {
    notes.push_back(
        fmt::format("the sensor is {:.3g} ms late, which biases the damping: --sensor-delay undo corrects it",
                    kMilliseconds * calibration.delay));
  }
  const bool link = use.frame == SensorFrame::link ||
                    (use.frame == SensorFrame::automatic && recording.find("joint_2") != nullptr && force.cols() > 1);
  if (link) {
    MBK_TRY(turn_to_base(recording, force));
    notes.emplace_back("the force was rotated from the axes of the last link into the base frame (eq. E.4)");
  }
  for (Index k = 0; k < force.cols(); ++k) put(recording, names[static_cast<std::size_t>(k)], force.col(k));
  return recording;
}

}  // namespace mbk::calibration
