#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/files/kinarm/exam_parameters.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

// The binary members of a `.kinarm` exam: little-endian; a string is the count of its UTF-16 code units in 32 bits,
// then these. Every count is checked against the available bytes before memory is allocated.

/// header.bin
struct KinarmHeader {
  std::int64_t frames = 0;
  std::int64_t events = 0, video_frames = 0;  ///< counts in examevents.bin and videoack.bin
  double rate_hz = 0.0;
  std::vector<std::string> kinematics, positions;  ///< labels
};

/// LABEL.kinematics
struct KinarmSignal {
  std::string label, unit;
  Vector values;  ///< f32 as doubles; of a status the 32 bits as a whole number
};

/// Whether a signal is the status of a force sensor: an f32 in which only the bits are meaningful.
[[nodiscard]] bool is_status(std::string_view label);

/// LABEL.position
struct KinarmPosition {
  std::string label;
  Vector x, y;  ///< [m], f32 as doubles
};

/// @fails  data: another version; it ends early; a count is negative; the rate is not positive.
[[nodiscard]] Result<KinarmHeader> read_kinarm_header(std::span<const std::byte> bytes);

/// @fails  data: another version; it ends early; a count is negative; an unknown type of value.
[[nodiscard]] Result<ExamParameters> read_kinarm_parameters(std::span<const std::byte> bytes);

/// @fails  data: another version; it ends early; a count is negative.
[[nodiscard]] Result<KinarmSignal> read_kinarm_signal(std::span<const std::byte> bytes);
[[nodiscard]] Result<KinarmPosition> read_kinarm_position(std::span<const std::byte> bytes);

/// examevents.bin: times are [s] from the first frame of the trial.   @fails  as above
[[nodiscard]] Result<std::vector<Event>> read_kinarm_events(std::span<const std::byte> bytes);

/// videoack.bin: delay between sending and acknowledgement of each video frame [s].   @fails  as above
[[nodiscard]] Result<Vector> read_kinarm_video_delays(std::span<const std::byte> bytes);

}  // namespace mbk::recording
