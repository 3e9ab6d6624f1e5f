#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/nan.h"
#include "mbk/base/core/words.h"
#include "mbk/model/robot/dynamic_model.h"
#include "mbk/model/trial/consistent_robot.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/prepared_dynamics.h"
#include "mbk/model/trial/torque_fit.h"

namespace mbk {

/// Estimation method of the robot coefficients.
enum class RobotMethod {
  least_squares,           ///< equal weights for all joints
  weighted_least_squares,  ///< joints weighted by the noise of their torque
  instrumental_variables,  ///< weighted, with regressors of the commanded or smoothed motion as instruments
};

[[nodiscard]] constexpr auto word_table(RobotMethod) {
  using enum RobotMethod;
  return std::to_array<Word<RobotMethod>>(
      {{weighted_least_squares, "wls"}, {least_squares, "ls"}, {instrumental_variables, "iv"}});
}

/// Result for a coefficient of the robot.
struct RobotCoefficient {
  robot::Coefficient coefficient;
  /// In a free fit 0 if not identified, because its effect is included in those that are; in a consistent fit its own
  /// value.
  double value = 0;
  double standard_error = 0;  ///< NaN if not identified
  bool identified = true;     ///< in a consistent fit: independent of the others
  bool fixed = false;         ///< assumed known
  /// Other coefficients included in the value, as in "+ 0.04·link_2.mass"; empty if none.
  std::string together_with;
};

/// Positive definiteness of the inertia matrix over the postures.
struct InertiaCheck {
  double smallest = 0;         ///< smallest eigenvalue over the postures [kg·m²; kg]
  std::vector<double> where;   ///< the joints there
  double mass_at_hand = kNaN;  ///< smallest apparent mass at the hand over the postures [kg]; NaN if all are singular
};

/// Test of a regressor that a rigid drive does not have.
struct TransmissionColumn {
  double coefficient = 0;
  double errors = 0;         ///< standard errors from 0, with the coefficient's sign
  double errors_beside = 0;  ///< the same with the other regressor included
  double explained = 0;      ///< share of the squares of the joint's residual
  double of_torque = 0;      ///< rms of its contribution relative to that of the joint torque
  bool biases = false;       ///< omitting it changes a robot coefficient by more than its interval
  bool found = false;        ///< it is significant and relevant, and causes a warning
};

/// Evidence in the residual of one joint on the drive between motor and link.
struct TransmissionTest {
  TransmissionColumn elastic;     ///< [s²]
  TransmissionColumn backlash;    ///< [N·m·s², or N·s² where the joint slides]
  double elastic_by_torque = 0;   ///< `errors` of the elastic regressor computed from the torque instead of the motion
  double backlash_by_torque = 0;  ///< the same of the pulses
  int reversals = 0;              ///< of the transmitted torque
};

/// Ratio of the torque of one joint to the torque of the URDF masses and inertias; NaN if that is too small.
struct StatedRatio {
  double ratio = kNaN, standard_error = kNaN;
  double missed = kNaN,
         missed_scaled = kNaN;  ///< residual beyond the fit, for the URDF and for its multiple [N·m or N], rms
};

/// The dynamics of a robot with uncertainty and fit.
struct RobotIdentification {
  robot::DynamicModel model;  ///< with covariance and delay
  std::vector<RobotCoefficient> coefficients;
  RobotMethod method = RobotMethod::weighted_least_squares;
  InstrumentMotion instrument_motion = InstrumentMotion::none;
  double motion_cutoff = 0;    ///< [Hz], if the motion was smoothed
  double smoothed_cutoff = 0;  ///< [Hz] of the motion used for vaf_smoothed, in the first validation recording
  std::optional<double> delay_standard_error;  ///< [s]; absent if the delay was not estimated
  std::vector<TorqueFit> fit;                  ///< of each joint
  bool held_out = true;                        ///< false: vaf and rmse are in-sample
  std::vector<std::string> held_out_files;     ///< names of validation recordings
  int rank = 0;                                ///< number of coefficients identified by the data
  int structural_rank = 0;                     ///< number identifiable by any motion
  double condition = 0;                        ///< of the retained regressors, each scaled to unit length
  std::vector<std::pair<std::string, double>>
      weakest;  ///< the least identifiable combination: coefficients with their shares
  InertiaCheck inertia;
  std::optional<ConsistentRobot>
      consistent;  ///< if a physically possible robot was requested: `model` is then that one
  std::vector<TransmissionTest> transmission;  ///< of each joint; empty if not tested
  std::vector<StatedRatio> stated;             ///< of each joint; empty if no URDF states the masses
  double hac_lag_s = 0;
  Index samples = 0;
  std::string description, urdf;  ///< the unchanged description files of the robot; empty for the thesis robot
  std::vector<Preparation> preparations;
  std::vector<SourceFile> sources;
  std::vector<double> durations, rates;
  std::vector<std::string> notes;
  std::vector<Warning> warnings;
  bool usable = true;
};

}  // namespace mbk
