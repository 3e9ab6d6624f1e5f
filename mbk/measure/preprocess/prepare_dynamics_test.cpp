#include "mbk/measure/preprocess/prepare_dynamics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "mbk/base/dsp/savitzky_golay.h"
#include "mbk/measure/preprocess/test_recordings.h"
#include "mbk/model/robot/planar_mechanism.h"
#include "mbk/model/robot/test_models.h"

namespace mbk::preprocess {
namespace prepare_dynamics_test {

constexpr double kRate = 1000.0;  // [Hz]

robot::DynamicModel planar_model(const robot::DriveTerms& drive) {
  robot::DynamicModel model{
      std::make_shared<robot::PlanarMechanism>(robot::PlanarMechanism::Options{{}, {}, {}}), drive, {}, {}};
  model.parameters = Vector::Constant(static_cast<Index>(model.coefficients().size()), 0.03);
  return model;
}

/// A swing of twenty seconds, read by encoders with steps of that size [rad].
Recording swing_recording(double encoder_step) {
  const robot::JointMotion motion = robot::Swing().sampled(20'000, 1.0 / kRate);
  const Matrix torque = planar_model({}).torques(motion);
  const Matrix joint = (motion.position / encoder_step).array().round() * encoder_step;
  Recording recording = testing_support::even_recording(
      motion.samples(), kRate,
      {{"joint_1", joint.col(0)}, {"joint_2", joint.col(1)}, {"torque_1", torque.col(0)}, {"torque_2", torque.col(1)}});
  const char* const units[] = {"rad", "rad", "N.m", "N.m"};
  for (std::size_t k = 0; k < 4; ++k) recording.channels[k].unit = units[k];
  return recording;
}

int window_of(double encoder_step, const robot::DriveTerms& drive, const DynamicsOptions& options = {}) {
  const Recording recording = swing_recording(encoder_step);
  const auto prepared = prepare_dynamics(recording, testing_support::facts_of(recording), planar_model(drive), options);
  EXPECT_TRUE(prepared) << prepared.error().line();
  return prepared ? prepared->preparation.smoothing_window : 0;
}

constexpr double kFine = 1e-5, kCoarse = 1e-4, kCoarsest = 2e-3;  // [rad]

TEST(PrepareDynamics, SmoothesJointsWithDryFrictionNoLongerThanTheirEncodersNeed) {
  const int without = window_of(kFine, {.coulomb = false});
  const int fine = window_of(kFine, {}), coarse = window_of(kCoarse, {});
  EXPECT_LT(fine, 25);
  EXPECT_LT(fine, coarse);
  EXPECT_LT(coarse, without);
  EXPECT_GT(window_of(kCoarsest, {}), coarse);
  EXPECT_EQ(window_of(kCoarsest, {}), window_of(kCoarsest, {.coulomb = false}));
}

TEST(PrepareDynamics, TakesTheShortestWindowWhoseVelocityIsQuietEnough) {
  const robot::DriveTerms drive;
  const int window = window_of(kCoarse, drive);
  const auto noise = [](int of_window) {  // [rad/s], of an even error of rounding
    return kCoarse / std::sqrt(12.0) * kRate * dsp::savitzky_golay_weights({6, of_window}, 1)->norm();
  };
  constexpr double kShare = 0.05, kOfEstimate = 0.05;
  EXPECT_LT(noise(window), kShare * drive.smoothing * (1.0 + kOfEstimate));
  EXPECT_GT(noise(window - 4), kShare * drive.smoothing * (1.0 - kOfEstimate));
}

TEST(PrepareDynamics, LeavesAWindowThatWasChosen) {
  DynamicsOptions options;
  options.signals.smoothing_window = 77;
  EXPECT_EQ(window_of(kFine, {}, options), 77);
}

TEST(PrepareDynamics, LeavesOutTheTorqueOfAJointThatFrictionHolds) {
  Recording recording = swing_recording(kFine);
  testing_support::values_of(recording, "joint_2").setConstant(0.9);
  const auto prepared = [&](const robot::DriveTerms& drive) {
    return prepare_dynamics(recording, testing_support::facts_of(recording), planar_model(drive), {}).value();
  };
  const PreparedDynamics held = prepared({}), loose = prepared({.coulomb = false});
  EXPECT_TRUE(held.torque.col(1).isZero(0.0) && held.regressors[1].isZero(0.0));
  EXPECT_FALSE(held.torque.col(0).isZero(0.0) || held.regressors[0].isZero(0.0));
  EXPECT_NE(held.notes.back().find("joint 2"), std::string::npos) << held.notes.back();
  EXPECT_FALSE(loose.torque.col(1).isZero(0.0) || loose.regressors[1].isZero(0.0));
  EXPECT_TRUE(loose.notes.empty());
}

}  // namespace prepare_dynamics_test
}  // namespace mbk::preprocess
