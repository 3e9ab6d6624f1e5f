#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk {

/// Instrument for the motion in the identification of robot dynamics.
enum class InstrumentMotion {
  none,
  joint_reference,  ///< the commanded joint motion
  hand_reference,   ///< the commanded hand motion, through the kinematics
  smoothed,         ///< the measured motion, low-passed to the band of the torque
};

[[nodiscard]] constexpr auto word_table(InstrumentMotion) {
  using enum InstrumentMotion;
  return std::to_array<Word<InstrumentMotion>>({{none, "none"},
                                                {joint_reference, "joint reference"},
                                                {hand_reference, "hand reference"},
                                                {smoothed, "smoothed motion"}});
}

/// Motor torques and the regressors of the robot dynamics, equally filtered: τ = W θ.
struct PreparedDynamics {
  double sample_time = 0;           ///< [s] between rows
  Vector time;                      ///< N, [s] from the recording's first sample
  Matrix torque;                    ///< N×n, of the motors [N·m, or N where a joint slides]
  Matrix torque_rate;               ///< N×n [N·m/s]
  std::vector<Matrix> regressors;   ///< W, N×p for each joint
  std::vector<Matrix> instruments;  ///< the same for `instrument_motion`; empty if there is none
  /// The same for the motion up to the frequency where its acceleration disappears in noise, which predicts the torque
  /// better in a wide band; empty without instruments.
  std::vector<Matrix> smoothed;
  double smoothed_cutoff = 0;  ///< [Hz]
  InstrumentMotion instrument_motion = InstrumentMotion::none;
  double motion_cutoff = 0;       ///< [Hz] of the smoothed motion, if that is the instrument
  std::vector<bool> stands;       ///< n: the joint did not move more than its encoder resolution
  std::vector<Segment> segments;  ///< in order of time
  Preparation preparation;
  std::vector<SourceFile> sources;
  double recording_rate = 0, recording_duration = 0;  ///< [Hz], [s]
  std::vector<std::string> notes;
  std::vector<Warning> warnings;
};

}  // namespace mbk
