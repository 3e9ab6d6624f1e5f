#include "mbk/measure/preprocess/force_rotation.h"

#include <algorithm>
#include <cmath>

#include "mbk/model/trial/quantity_channels.h"

namespace mbk::preprocess {

Result<Recording> turn_force(const Recording& recording, double angle) {
  if (!std::isfinite(angle)) return bad_usage("the rotation angle of the force must be finite");
  Recording result = recording;
  const auto channel = [&](std::size_t axis) {
    return std::ranges::find(result.channels, kForceChannels.several[axis], &Channel::name);
  };
  const auto x = channel(0), y = channel(1);
  if (x == result.channels.end() || y == result.channels.end()) {
    return bad_data("only a force with two axes can be rotated", "omit --force-rotation-deg, or name both axes");
  }
  const double c = std::cos(angle), s = std::sin(angle);
  const Vector turned = c * x->values - s * y->values;
  y->values = s * x->values + c * y->values;
  x->values = turned;
  return result;
}

}  // namespace mbk::preprocess
