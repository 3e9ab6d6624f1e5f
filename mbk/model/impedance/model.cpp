#include "mbk/model/impedance/model.h"

namespace mbk::impedance {

Vector stacked(const Model& model) {
  Vector values(3 * model.M.size() + model.x0.size());
  values << Vector(model.M.transpose().reshaped()), Vector(model.B.transpose().reshaped()),
      Vector(model.K.transpose().reshaped()), model.x0;
  return values;
}

Model unstacked(const Vector& values, Index axes) {
  const auto square = [&](Index part) {
    return Matrix(values.segment(part * axes * axes, axes * axes).reshaped(axes, axes).transpose());
  };
  return {square(0), square(1), square(2), values.tail(axes)};
}

}  // namespace mbk::impedance
