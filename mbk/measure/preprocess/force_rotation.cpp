#include "mbk/measure/preprocess/force_rotation.h"

#include <algorithm>
#include <cmath>

#include "mbk/model/trial/quantity_channels.h"

namespace mbk::preprocess {

Result<Recording> turn_force(const Recording& recording, const RotationVector& rotation) {
  if (!std::ranges::all_of(rotation, [](double one) { return std::isfinite(one); })) {
    return bad_usage("the rotation angle of the force must be finite");
  }
  Recording result = recording;
  const auto channel = [&](std::size_t axis) {
    return std::ranges::find(result.channels, kForceChannels.several[axis], &Channel::name);
  };
  const auto x = channel(0), y = channel(1);
  if (x == result.channels.end() || y == result.channels.end()) {
    return bad_data("only a force with two axes can be rotated", "omit --force-rotation-deg, or name both axes");
  }
  const double angle = rotation[2], c = std::cos(angle), s = std::sin(angle);
  if (rotation[0] != 0.0 || rotation[1] != 0.0) {
    const auto z = channel(2);
    if (z == result.channels.end()) {
      return bad_data("only a force with three axes can be rotated about x or y",
                      "pass --force-rotation-deg with one angle, from x to y, or name force_z");
    }
    Eigen::Vector3d k(rotation[0], rotation[1], rotation[2]);
    const double theta = k.norm();
    k /= theta;
    Eigen::Matrix3d cross;  // k × F
    cross << 0.0, -k[2], k[1], k[2], 0.0, -k[0], -k[1], k[0], 0.0;
    const Eigen::Matrix3d R =
        Eigen::Matrix3d::Identity() + std::sin(theta) * cross + (1.0 - std::cos(theta)) * cross * cross;
    for (Index i = 0; i < x->values.size(); ++i) {
      const Eigen::Vector3d F = R * Eigen::Vector3d(x->values[i], y->values[i], z->values[i]);
      x->values[i] = F[0];
      y->values[i] = F[1];
      z->values[i] = F[2];
    }
    return result;
  }
  const Vector turned = c * x->values - s * y->values;
  y->values = s * x->values + c * y->values;
  x->values = turned;
  return result;
}

}  // namespace mbk::preprocess
