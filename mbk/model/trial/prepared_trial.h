#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/units.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/protocol.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/warning.h"

namespace mbk {

/// Type of motion, which determines the units of M, B and K.
enum class Motion {
  translation,  ///< m and N: kg, N·s/m, N/m
  rotation,     ///< rad and N·m: kg·m², N·m·s/rad, N·m/rad
  unknown,      ///< one axis, unit not stated in the file
};

/// Purpose of a segment of samples.
enum class Purpose { identification, validation };

/// Rows [begin, end) of a PreparedTrial, consecutive in time; a perturbation or a part of one.
struct Segment {
  Index begin = 0, end = 0;
  Purpose purpose = Purpose::identification;
  Index first_sample = 0;  ///< sample of the recording that corresponds to row `begin`
  [[nodiscard]] Index size() const { return end - begin; }
};

/// Order of the zero-phase low-pass (Dyck 2013 §3.5.1).
inline constexpr int kLowpassOrder = 5;

/// Source of ẍ.
enum class AccelerationSource { derivative, sensor };

[[nodiscard]] constexpr auto word_table(AccelerationSource) {
  using enum AccelerationSource;
  return std::to_array<Word<AccelerationSource>>({{sensor, "sensor"}, {derivative, "derivative"}});
}

/// Source of the force at the hand.
enum class ForceSource {
  sensor,          ///< measured
  virtual_sensor,  ///< from motion, torques and a model of the robot, not causal (Dyck 2013, §5.2.2, method 1)
  observer,        ///< from the same, causal, as available in real time
};

[[nodiscard]] constexpr auto word_table(ForceSource) {
  using enum ForceSource;
  return std::to_array<Word<ForceSource>>({{sensor, "sensor"}, {virtual_sensor, "virtual"}, {observer, "observer"}});
}

/// How the signals of a PreparedTrial were made, so that any number can be traced and reproduced.
struct Preparation {
  Mode mode = Mode::default_mode;
  Procedure procedure = Procedure::chapter3;  ///< meaningful in reference mode
  Protocol protocol = Protocol::free;
  std::string protocol_rule;      ///< reason for that protocol, in words
  std::string window_rule;        ///< analysed samples, in words
  double from_s = 0, to_s = 0;    ///< [s] from the recording's first sample: first and last analysed sample
  std::optional<double> split_s;  ///< [s] where identification ends and validation begins
  int perturbations = 1;          ///< number of extracted segments
  int smoothing_order = 6;        ///< Savitzky–Golay N
  int smoothing_window = 101;     ///< Savitzky–Golay W [samples]
  std::optional<Hertz> cutoff;    ///< zero-phase Butterworth low-pass of kLowpassOrder; none = not applied
  std::string cutoff_rule;        ///< reason for the cutoff, in words
  Hertz band_low, band_high;      ///< excited band that the filters let through
  bool acceleration_from_sensor = false;
  ForceSource force_source = ForceSource::sensor;
  bool cut_before_filter = true;
  Index every = 1;  ///< decimation: every Nth filtered sample is kept
};

/// Quantity of the perturbation reference, from the unit of its channel.
enum class ReferenceQuantity { position, force, unknown };

[[nodiscard]] constexpr auto word_table(ReferenceQuantity) {
  using enum ReferenceQuantity;
  return std::to_array<Word<ReferenceQuantity>>({{position, "position"}, {force, "force"}, {unknown, "unknown"}});
}

/// Participant and condition as stated in the recording; empty if not stated. Recordings that are averaged or pooled
/// must agree in these.
struct TrialConditions {
  std::string participant, condition, posture;
};

/// Evenly sampled signals, equally filtered, ready for a fit. SI units or radians, base frame. Decimated if the
/// low-pass permits it without loss.
struct PreparedTrial {
  int axes = 2;  ///< n, 1, 2 or 3
  Motion motion = Motion::translation;
  double sample_time = 0;      ///< T [s], between rows
  double recording_rate = 0;   ///< [Hz]
  Vector time;                 ///< N, [s] from the recording's first sample
  Matrix position;             ///< N×n, x [m]
  Matrix velocity;             ///< N×n, ẋ [m/s]
  Matrix acceleration;         ///< N×n, ẍ [m/s²]
  Matrix force_hand_on_robot;  ///< N×n, F_h [N]: force of the limb on the machine
  Matrix
      force_sensitivity;  ///< N×(n·p), ∂F_h/∂θ by the p coefficients of the robot; empty if F_h does not depend on them
  Matrix robot_covariance;  ///< p×p, of those coefficients
  Matrix reference;         ///< N×n, unfiltered; empty where none was recorded
  Matrix reference_motion;  ///< N×3n, [r̈ ṙ r] of the reference, filtered like the position; empty unless requested
  ReferenceQuantity reference_quantity = ReferenceQuantity::unknown;
  std::vector<Segment> segments;  ///< in order of time; rows outside them are ignored
  /// n, variance of F_h [N²] while the reference rests before its displacements, equally filtered; empty if it never
  /// rests. A lower bound of the limb's own force variance during the perturbation.
  Vector force_variance_at_rest;
  Preparation preparation;
  std::optional<double> recorded_handle_mass;  ///< [kg] beyond the force sensor, as stated in the recording
  TrialConditions conditions;
  std::vector<SourceFile> sources;
  double recording_duration = 0;   ///< [s]
  std::vector<std::string> notes;  ///< notes of the reader
  std::vector<Warning> warnings;   ///< about the recording and its preparation
};

}  // namespace mbk
