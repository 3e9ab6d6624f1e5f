#include "mbk/model/perturbation/directions.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace mbk::perturbation {

Eigen::Vector2d direction_on_circle(int k, int n) {
  constexpr double kCosine[] = {1.0, 0.0, -1.0, 0.0};
  if (4 * k % n == 0) {
    const int quarter = 4 * k / n;
    return {kCosine[quarter % 4], kCosine[(quarter + 3) % 4]};
  }
  const double angle = 2.0 * std::numbers::pi * k / n;
  return {std::cos(angle), std::sin(angle)};
}

Eigen::Vector3d direction_in_space(int k) {
  const int cell = k < kDirectionsInSpace / 2 ? k : k + 1;  // of 27; the one in the middle is zero
  return Eigen::Vector3d(cell % 3 - 1, cell / 3 % 3 - 1, cell / 9 - 1).normalized();
}

std::vector<int> shuffled_directions(int directions, int repetitions, numeric::Random& random) {
  std::vector<int> order;
  for (int i = 0; i < directions * repetitions; ++i) order.push_back(i % directions);
  for (std::size_t i = order.size() - 1; i > 0; --i) std::swap(order[i], order[random.below(i + 1)]);
  return order;
}

}  // namespace mbk::perturbation
