#include "mbk/measure/identify/base_parameters.h"

#include <algorithm>
#include <numbers>

#include "mbk/base/numeric/random.h"

namespace mbk::identify {
namespace {

/// Every joint anywhere, at any velocity and acceleration.
robot::JointMotion random_motion(const robot::Mechanism& mechanism, Index samples) {
  const Index n = mechanism.joints();
  numeric::Random random(1);
  robot::JointMotion motion{Matrix(samples, n), Matrix(samples, n), Matrix(samples, n)};
  for (Index i = 0; i < samples; ++i) {
    for (Index joint = 0; joint < n; ++joint) {
      const double reach = mechanism.slides(static_cast<int>(joint)) ? 1.0 : std::numbers::pi;
      motion.position(i, joint) = random.uniform(-reach, reach);
      motion.velocity(i, joint) = random.uniform(-2.0, 2.0);
      motion.acceleration(i, joint) = random.uniform(-10.0, 10.0);
    }
  }
  return motion;
}

}  // namespace

numeric::IndependentColumns structural_columns(const robot::DynamicModel& model, const std::vector<Index>& fixed) {
  constexpr double kApart = 1e-5, kNegligible = 1e-5;
  const auto p = static_cast<Index>(model.coefficients().size());
  std::vector<Index> free;
  for (Index k = 0; k < p; ++k) {
    if (std::ranges::find(fixed, k) == fixed.end()) free.push_back(k);
  }
  const Index samples = std::max<Index>(20 * p, 100);
  const std::vector<Matrix> W = model.regressors(random_motion(*model.mechanism, samples));
  Matrix all(samples * static_cast<Index>(W.size()), static_cast<Index>(free.size()));
  for (std::size_t joint = 0; joint < W.size(); ++joint) {
    all.middleRows(static_cast<Index>(joint) * samples, samples) = W[joint](Eigen::all, free);
  }
  return numeric::independent_columns(all, kApart, kNegligible);
}

}  // namespace mbk::identify
