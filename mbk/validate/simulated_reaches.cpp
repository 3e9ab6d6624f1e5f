#include "mbk/validate/simulated_reaches.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mbk/base/numeric/random.h"
#include "mbk/model/perturbation/minimum_jerk.h"

namespace mbk::validation {
namespace simulated_reaches {

constexpr double kSample = 0.001, kRest = 0.3;  // [s]

/// One undisturbed way.
class Way {
 public:
  Way(const SimulatedReaches& hand, numeric::Random& random)
      : duration_(hand.duration * std::max(0.7, 1.0 + hand.duration_spread * random.normal())),
        distance_(hand.distance * std::max(0.7, 1.0 + hand.distance_spread * random.normal())),
        bend_(hand.bend * random.normal()),
        drift_(hand.drift * random.normal()) {}

  [[nodiscard]] double duration() const { return duration_; }

  /// x_d, ẋ_d or ẍ_d at t [s] after the reach begins; base frame. The bend is 4s(1 − s) of the share s of the way.
  [[nodiscard]] perturbation::Jet<Vector> at(double t) const {
    const perturbation::Jet<double> s = perturbation::MinimumJerk({0, 0, 0}, {1, 0, 0}, duration_).at(t);
    const double x = 4.0 * bend_ * s.value * (1.0 - s.value) + drift_ * s.value;
    const double slope = 4.0 * bend_ * (1.0 - 2.0 * s.value) + drift_, curvature = -8.0 * bend_;
    return {Vector{{x, distance_ * s.value}}, Vector{{slope * s.first, distance_ * s.first}},
            Vector{{slope * s.second + curvature * s.first * s.first, distance_ * s.second}}};
  }

 private:
  double duration_, distance_, bend_, drift_;
};

/// 0 → 1 → 0: out, hold and back by minimum jerk.
double displacement_shape(const SimulatedReaches& hand, double t) {
  const perturbation::MinimumJerk out({0, 0, 0}, {1, 0, 0}, hand.out), back({1, 0, 0}, {0, 0, 0}, hand.back);
  return t < hand.out + hand.hold ? out.at(t).value : back.at(t - hand.out - hand.hold).value;
}

explore::RecordedReach undisturbed_reach(const SimulatedReaches& hand, const Way& way, numeric::Random& random) {
  const double pole = std::exp(-2.0 * std::numbers::pi * 1.5 * kSample);
  const auto rows = static_cast<Index>(std::llround((2.0 * kRest + way.duration()) / kSample));
  explore::RecordedReach reach;
  reach.position = reach.force_hand_on_robot = Matrix::Zero(rows, 2);
  Vector e{{hand.noise * random.normal(), hand.noise * random.normal()}};
  bool passed = false;
  for (Index i = 0; i < rows; ++i) {
    const auto now = way.at(static_cast<double>(i) * kSample - kRest);
    for (double& value : e) value = pole * value + std::sqrt(1.0 - pole * pole) * hand.noise * random.normal();
    reach.position.row(i) = now.value.transpose();
    reach.force_hand_on_robot.row(i) = (hand.robot_mass * now.second + e).transpose();
    if (!passed && now.value[1] >= hand.trigger) {
      reach.trigger = i;
      passed = true;
    }
  }
  return reach;
}

/// The servo takes over at the trigger; what differs from the undisturbed way is differenced once and twice.
Result<void> displace(const SimulatedReaches& hand, const explore::ReachPrediction& prediction, const Vector& direction,
                      explore::RecordedReach& reach) {
  const auto predicted = MBK_TRY(prediction.predict(reach));
  const Index rows = std::min(prediction.future_rows(), reach.position.rows() - reach.trigger);
  Matrix away = Matrix::Zero(rows, 2);
  for (Index i = 0; i < rows; ++i) {
    const double t = static_cast<double>(i) * kSample;
    away.row(i) = predicted.position.row(i) - reach.position.row(reach.trigger + i) +
                  hand.amplitude * displacement_shape(hand, t) * direction.transpose();
  }
  for (Index i = 0; i < rows; ++i) {
    const Index before = std::max<Index>(0, i - 1), after = std::min(rows - 1, i + 1),
                middle = std::clamp<Index>(i, 1, rows - 2);
    const Vector velocity =
        (away.row(after) - away.row(before)).transpose() / (static_cast<double>(after - before) * kSample);
    const Vector acceleration =
        (away.row(middle + 1) - 2.0 * away.row(middle) + away.row(middle - 1)).transpose() / (kSample * kSample);
    reach.position.row(reach.trigger + i) += away.row(i);
    reach.force_hand_on_robot.row(reach.trigger + i) -=
        (hand.M * acceleration + hand.B * velocity + hand.K * away.row(i).transpose()).transpose();
  }
  return {};
}

}  // namespace simulated_reaches

Result<ReachesOfOneRun> simulate_reaches(const SimulatedReaches& hand, std::uint64_t seed) {
  using namespace simulated_reaches;
  numeric::Random random(seed, 21);
  ReachesOfOneRun run;
  run.sample_time = kSample;
  for (int i = 0; i < hand.undisturbed; ++i) {
    const Way way(hand, random);
    run.undisturbed.push_back(undisturbed_reach(hand, way, random));
  }
  const auto prediction =
      MBK_TRY(explore::ReachPrediction::create(run.undisturbed, kSample, {.future = hand.out + hand.hold + hand.back}));
  for (int i = 0; i < hand.directions * hand.repetitions; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i % hand.directions) / hand.directions;
    const Vector direction{{std::cos(angle), std::sin(angle)}};
    const Way way(hand, random);
    explore::RecordedReach reach = undisturbed_reach(hand, way, random);
    MBK_TRY(displace(hand, prediction, direction, reach));
    run.displaced.push_back({std::move(reach), hand.amplitude * direction});
  }
  return run;
}

}  // namespace mbk::validation
