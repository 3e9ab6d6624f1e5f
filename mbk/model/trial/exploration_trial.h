#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/warning.h"

namespace mbk {

/// Name and unit of a signal.
struct SignalLabel {
  std::string name;  ///< "hand_x", "−force_x"
  std::string unit;  ///< "m", "N"; "" where the recording does not say
};

/// Evenly sampled, unfiltered signals for exploration without a model of the limb: motion of the hand and the response
/// force, so that the response from one to the other is the dynamic stiffness D = −F_h/X of the limb, K at rest.
struct ExplorationTrial {
  int axes = 2;  ///< n, 1, 2 or 3
  Motion motion = Motion::translation;
  double sample_time = 0;  ///< T [s]
  double from_s = 0;       ///< of the first row, [s] from the recording's first sample
  Matrix input;            ///< N×n, position x, base frame [m or rad]
  Matrix output;           ///< N×n, −F_h: the force of the robot on the hand [N or N·m]
  Matrix reference;        ///< N×n; empty where none was recorded or it never moves
  ReferenceQuantity reference_quantity = ReferenceQuantity::unknown;
  std::vector<SignalLabel> input_labels, output_labels;  ///< n
  Index split = 0;  ///< rows before it are for identification, the others for validation, if any are held out
  Protocol protocol = Protocol::free;
  std::string protocol_rule, window_rule;  ///< why, in words
  SourceFile source;
  double recording_duration = 0;               ///< [s]
  std::optional<double> recorded_handle_mass;  ///< [kg] beyond the force sensor, as stated in the recording
  Vector scheduling;                           ///< N, of the scheduling channel of M, B and K; empty if none was named
  SignalLabel scheduling_label;
  Matrix muscles;  ///< N×m, rectified EMG of the muscles that were asked for, over that of MVC or their mean
  std::vector<std::string> muscle_names;  ///< m, channels
  std::vector<std::string> muscle_units;  ///< m, "MVC" or "mean"
  std::vector<Event> events;              ///< on the clock of from_s
  std::vector<std::string> notes;
  std::vector<Warning> warnings;
  [[nodiscard]] Index samples() const { return input.rows(); }
  [[nodiscard]] double to_s() const { return from_s + static_cast<double>(samples()) * sample_time; }
};

}  // namespace mbk
