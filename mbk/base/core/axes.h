#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace mbk {

/// What each axis of a robot has: a position, a velocity, a force. One axis or two.
template <int Axes>
using AxisVector = Eigen::Matrix<double, Axes, 1>;

/// From axes to axes: an inertia, a stiffness, a Jacobian.
template <int Axes>
using AxisMatrix = Eigen::Matrix<double, Axes, Axes>;

/// For each axis 0, 1, … what `make` makes for it.
template <int Axes, class Make>
[[nodiscard]] auto per_axis(const Make& make) {
  return [&]<std::size_t... axis>(std::index_sequence<axis...>) {
    return std::array{make(static_cast<std::uint32_t>(axis))...};
  }
  (std::make_index_sequence<static_cast<std::size_t>(Axes)>{});
}

}  // namespace mbk
