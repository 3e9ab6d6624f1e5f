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

/// How a robot's coefficients are found.
enum class RobotMethod {
  least_squares,           ///< every joint alike
  weighted_least_squares,  ///< each joint by the noise of its torque
  instrumental_variables,  ///< weighted, on what the commanded or smoothed motion makes of the regressors
};

[[nodiscard]] constexpr auto word_table(RobotMethod) {
  using enum RobotMethod;
  return std::to_array<Word<RobotMethod>>(
      {{weighted_least_squares, "wls"}, {least_squares, "ls"}, {instrumental_variables, "iv"}});
}

/// What a coefficient of the robot turned out to be.
struct RobotCoefficient {
  robot::Coefficient coefficient;
  /// Of a free fit 0 where it is not identified, since its share is in those that are; of a consistent one its own.
  double value = 0;
  double standard_error = 0;  ///< NaN where it is not identified
  bool identified = true;     ///< of a consistent fit: stands by itself
  bool fixed = false;         ///< taken as known
  /// What the value holds besides the coefficient itself, as in "+ 0.04·link_2.mass"; empty where it stands for itself.
  std::string together_with;
};

/// Whether the inertia matrix is one in every posture.
struct InertiaCheck {
  double smallest = 0;         ///< eigenvalue over the postures [kg·m²; kg]
  std::vector<double> where;   ///< the joints there
  double mass_at_hand = kNaN;  ///< the least that the hand feels over the postures [kg]; NaN where all are singular
};

/// A column that a rigid drive does not have.
struct TransmissionColumn {
  double coefficient = 0;
  double errors = 0;         ///< standard errors from 0, with the coefficient's sign
  double errors_beside = 0;  ///< the same beside the other column
  double explained = 0;      ///< share of the squares of the joint's residual
  double of_torque = 0;      ///< root mean square of what it adds, over that of the joint's torque
  bool biases = false;       ///< left out, it moves a coefficient of the robot by more than its interval
  bool found = false;        ///< it is there beyond chance, matters, and the user is warned
};

/// What the residual of one joint says of the drive between motor and link.
struct TransmissionTest {
  TransmissionColumn elastic;     ///< [s²]
  TransmissionColumn backlash;    ///< [N·m·s², or N·s² where the joint slides]
  double elastic_by_torque = 0;   ///< `errors` of the elastic column that is made of the torque instead of the motion
  double backlash_by_torque = 0;  ///< the same of the pulses
  int reversals = 0;              ///< of the torque that is transmitted
};

/// The torque of one joint over what the masses and inertias of the URDF take; NaN where they take too little of it.
struct StatedRatio {
  double ratio = kNaN, standard_error = kNaN;
  double missed = kNaN, missed_scaled = kNaN;  ///< beyond the fit, by the URDF and by its multiple [N·m or N], rms
};

/// The dynamics of a robot, how sure they are and how well they hold.
struct RobotIdentification {
  robot::DynamicModel model;  ///< with covariance and delay
  std::vector<RobotCoefficient> coefficients;
  RobotMethod method = RobotMethod::weighted_least_squares;
  InstrumentMotion instrument_motion = InstrumentMotion::none;
  double motion_cutoff = 0;    ///< [Hz], where the motion was smoothed for it
  double smoothed_cutoff = 0;  ///< [Hz] of the motion behind vaf_smoothed, in the first recording that judges
  std::optional<double> delay_standard_error;           ///< [s]; absent where the delay was not estimated
  std::vector<TorqueFit> fit;                           ///< of each joint
  bool held_out = true;                                 ///< false: vaf and rmse are in-sample
  std::vector<std::string> held_out_files;              ///< where whole recordings were
  int rank = 0;                                         ///< coefficients that the data identify
  int structural_rank = 0;                              ///< that any motion could
  double condition = 0;                                 ///< of the regressors kept, each scaled to unit length
  std::vector<std::pair<std::string, double>> weakest;  ///< what is hardest to identify: coefficients with their shares
  InertiaCheck inertia;
  std::optional<ConsistentRobot> consistent;   ///< where a robot that can exist was asked for: `model` is then that one
  std::vector<TransmissionTest> transmission;  ///< of each joint; empty where it was not tested
  std::vector<StatedRatio> stated;             ///< of each joint; empty where no URDF states the masses
  double hac_lag_s = 0;
  Index samples = 0;
  std::string description, urdf;  ///< the files that say what robot it is, as they were; empty for the thesis's
  std::vector<Preparation> preparations;
  std::vector<SourceFile> sources;
  std::vector<double> durations, rates;
  std::vector<std::string> notes;
  std::vector<Warning> warnings;
  bool usable = true;
};

}  // namespace mbk
