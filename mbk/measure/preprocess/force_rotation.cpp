#include "mbk/measure/preprocess/force_rotation.h"

#include <algorithm>
#include <cmath>

#include "mbk/base/numeric/rotation.h"
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
  if (rotation[0] != 0.0 || rotation[1] != 0.0) {
    const auto z = channel(2);
    if (z == result.channels.end()) {
      return bad_data("only a force with three axes can be rotated about x or y",
                      "pass --force-rotation-deg with one angle, from x to y, or name force_z");
    }
    const Eigen::Matrix3d R = numeric::rotation_matrix(Eigen::Vector3d(rotation[0], rotation[1], rotation[2]));
    for (Index i = 0; i < x->values.size(); ++i) {
      const Eigen::Vector3d F = R * Eigen::Vector3d(x->values[i], y->values[i], z->values[i]);
      x->values[i] = F[0];
      y->values[i] = F[1];
      z->values[i] = F[2];
    }
    return result;
  }
  const double c = std::cos(rotation[2]), s = std::sin(rotation[2]);
  const Vector turned = c * x->values - s * y->values;
  y->values = s * x->values + c * y->values;
  x->values = turned;
  return result;
}

}  // namespace mbk::preprocess
