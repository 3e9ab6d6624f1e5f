#include "mbk/files/recording/sensor_orientation.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "mbk/model/trial/quantity_channels.h"

namespace mbk::recording {
namespace {

constexpr std::array kOrientation = {"sensor_qx", "sensor_qy", "sensor_qz", "sensor_qw"};

Vector* values_of(Recording& recording, const char* name) {
  const auto found = std::ranges::find(recording.channels, name, &Channel::name);
  return found == recording.channels.end() ? nullptr : &found->values;
}

}  // namespace

Result<void> turn_force_to_base(Recording& recording) {
  constexpr double kRounded = 0.01;  // of the length of a quaternion
  const auto given =
      std::ranges::count_if(kOrientation, [&](const char* name) { return recording.find(name) != nullptr; });
  if (given == 0) return {};
  std::array<Vector*, 4> q{};
  std::array<Vector*, 3> force{};
  for (std::size_t k = 0; k < q.size(); ++k) {
    q.at(k) = values_of(recording, kOrientation.at(k));
    if (q.at(k) == nullptr) {
      return bad_data(fmt::format("{} of the four channels of the sensor's orientation are named; {} is missing", given,
                                  kOrientation.at(k)),
                      "name sensor_qx, sensor_qy, sensor_qz and sensor_qw: a unit quaternion");
    }
  }
  for (std::size_t axis = 0; axis < force.size(); ++axis) {
    const char* const name = kForceChannels.several.at(axis);
    force.at(axis) = values_of(recording, name);
    if (force.at(axis) == nullptr) {
      return bad_data(fmt::format("the force cannot be turned by the sensor's orientation: {} is missing", name),
                      "name all three forces, Fx, Fy and Fz, also to measure in a plane");
    }
  }
  for (Index i = 0; i < recording.samples(); ++i) {
    const Eigen::Quaterniond turn((*q[3])[i], (*q[0])[i], (*q[1])[i], (*q[2])[i]);
    if (!(std::abs(turn.norm() - 1.0) <= kRounded)) {
      return bad_data(
          fmt::format("the sensor's orientation at sample {} is not a unit quaternion: its length is {:.3g}", i + 1,
                      turn.norm()),
          "name the columns of x, y, z and w in this order: sensor_qx, sensor_qy, sensor_qz, sensor_qw");
    }
    const Eigen::Vector3d F = turn.normalized() * Eigen::Vector3d((*force[0])[i], (*force[1])[i], (*force[2])[i]);
    for (Index axis = 0; axis < 3; ++axis) (*force.at(static_cast<std::size_t>(axis)))[i] = F[axis];
  }
  std::erase_if(recording.channels,
                [](const Channel& channel) { return std::ranges::count(kOrientation, channel.name) > 0; });
  recording.notes.emplace_back(
      "the force was turned from the frame of the sensor to that of the position by sensor_qx to sensor_qw");
  return {};
}

}  // namespace mbk::recording
