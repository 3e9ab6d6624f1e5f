#include "mbk/measure/preprocess/joint_smoothing.h"

#include <algorithm>
#include <cmath>

#include "mbk/measure/preprocess/joint_signals.h"

namespace mbk::preprocess {
namespace {

/// Root mean square of the velocity of the slowest joint that moves at all, by differences over the window.
double usual_velocity(const Matrix& position, const std::vector<Cut>& cuts, const dsp::SavitzkyGolay& plan,
                      Hertz rate) {
  const Index reach = 2 * plan.half_window();
  Vector squares = Vector::Zero(position.cols());
  Index count = 0;
  for (const Cut& cut : cuts) {
    const Index rows = cut.end - cut.begin - reach;
    if (rows < 1) continue;
    squares += (position.middleRows(cut.begin + reach, rows) - position.middleRows(cut.begin, rows))
                   .colwise()
                   .squaredNorm()
                   .transpose();
    count += rows;
  }
  double slowest = 0.0;
  for (const double sum : squares) {
    if (sum > 0.0 && (slowest == 0.0 || sum < slowest)) slowest = sum;
  }
  return std::sqrt(slowest / static_cast<double>(std::max<Index>(count, 1))) * rate.value / static_cast<double>(reach);
}

/// @param turn  over which friction changes its sign [rad/s or m/s]
Result<int> window_for_dry_friction(const dsp::SavitzkyGolay& plan, double noise, double turn, Hertz rate) {
  constexpr double kShare = 0.05;
  const double most = kShare * turn / (rate.value * noise);  // of the weights' length
  int shortest = (plan.order + 3) | 1, longest = plan.window;
  while (shortest < longest) {
    const int middle = (shortest + (longest - shortest) / 2) | 1;
    const int tried = middle < longest ? middle : shortest;
    const auto weights = MBK_TRY(dsp::savitzky_golay_weights({plan.order, tried}, 1));
    if (weights.norm() <= most) {
      longest = tried;
    } else {
      shortest = tried + 2;
    }
  }
  return longest;
}

}  // namespace

Result<dsp::SavitzkyGolay> smoothing_of_joints(const dsp::SavitzkyGolay& plan, const Matrix& position,
                                               const std::vector<Cut>& cuts, const robot::DriveTerms& drive,
                                               Hertz rate) {
  if (!drive.coulomb && !drive.stribeck) return plan;
  const double turn = drive.smoothing > 0.0 ? drive.smoothing : 0.05 * usual_velocity(position, cuts, plan, rate);
  const auto window = MBK_TRY(window_for_dry_friction(plan, position_noise(position, cuts).maxCoeff(), turn, rate));
  return dsp::SavitzkyGolay{plan.order, window};
}

}  // namespace mbk::preprocess
