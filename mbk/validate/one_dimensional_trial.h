#pragma once

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/transfer_function.h"

namespace mbk::validation::one_dimensional {

/// What is fitted to a rigid grasp along one axis (Dyck 2013, §4.4.2): the order of the source, and its division of a
/// trial. The rate is ours, for a discrete-time model.
inline constexpr Index kPoles = 4, kZeros = 3;
inline constexpr double kFrom = 12.0, kIdentify = 40.0, kValidate = 10.0;  ///< [s]
inline constexpr double kRate = 50.0;                                      ///< [Hz] of the models

/// One axis of a trial, at the rate of the models.
struct Axis {
  SignalPair impedance;   ///< hand's place to the force on the robot
  SignalPair admittance;  ///< commanded force to the hand's place
};

/// @fails  as dsp::decimate
[[nodiscard]] Result<Axis> axis_of(const Recording& recording);

/// The part of a trial that identifies.
[[nodiscard]] SignalPair first_part(const SignalPair& whole);

/// What output error made of the first part of a trial.
struct Attempt {
  Vector f, b;
  bool holds = false;  ///< settled and stable
  double vaf = 0.0;    ///< of the last part, which it has not seen [%]
};

/// @fails  as identify::fit_prediction_error
[[nodiscard]] Result<Attempt> attempted(const SignalPair& whole);

/// Of the last part of any trial [%].
[[nodiscard]] double validation_vaf(const Attempt& attempt, const SignalPair& whole);

/// The last part of a trial, measured and by the model.
struct ValidationOutput {
  Vector time;  ///< [s] from where the trial begins to count
  Vector measured, modelled;
};
[[nodiscard]] ValidationOutput validation_output(const Attempt& attempt, const SignalPair& whole);

}  // namespace mbk::validation::one_dimensional
