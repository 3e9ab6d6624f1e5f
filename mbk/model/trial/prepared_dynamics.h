#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/prepared_trial.h"

namespace mbk {

/// What stands for the motion without its noise, where a robot's dynamics are found by instruments.
enum class InstrumentMotion {
  none,
  joint_reference,  ///< what the joints were told to do
  hand_reference,   ///< what the hand was told to do, through the kinematics
  smoothed,         ///< the measured motion, low-passed to the band of the torque
};

[[nodiscard]] constexpr auto word_table(InstrumentMotion) {
  using enum InstrumentMotion;
  return std::to_array<Word<InstrumentMotion>>({{none, "none"},
                                                {joint_reference, "joint reference"},
                                                {hand_reference, "hand reference"},
                                                {smoothed, "smoothed motion"}});
}

/// Motor torques beside what a robot's dynamics say they are made of, all filtered alike: τ = W θ.
struct PreparedDynamics {
  double sample_time = 0;           ///< [s] between rows
  Vector time;                      ///< N, [s] from the recording's first sample
  Matrix torque;                    ///< N×n, of the motors [N·m, or N where a joint slides]
  Matrix torque_rate;               ///< N×n [N·m/s]
  std::vector<Matrix> regressors;   ///< W, N×p for each joint
  std::vector<Matrix> instruments;  ///< the same of `instrument_motion`; empty where there is none
  /// The same of the motion up to where its acceleration sinks into noise, which predicts the torque better where the
  /// band is wide; empty where no instruments were asked for.
  std::vector<Matrix> smoothed;
  double smoothed_cutoff = 0;  ///< [Hz]
  InstrumentMotion instrument_motion = InstrumentMotion::none;
  double motion_cutoff = 0;       ///< [Hz] of the smoothed motion, where that is it
  std::vector<bool> stands;       ///< n: the joint did not move beyond the steps of its encoder
  std::vector<Segment> segments;  ///< in order of time
  Preparation preparation;
  std::vector<SourceFile> sources;
  double recording_rate = 0, recording_duration = 0;  ///< [Hz], [s]
  std::vector<std::string> notes;
  std::vector<Warning> warnings;
};

}  // namespace mbk
