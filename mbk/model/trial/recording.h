#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/words.h"
#include "mbk/model/trial/warning.h"

namespace mbk {

/// Source of a channel in its file, in the syntax of --channels, so that a message can state how to read it
/// differently.
struct ChannelOrigin {
  std::string alias;       ///< the channel's short name: "x", "Fx", "xr", "time"
  std::string source;      ///< "10", "-10", "force_x*8.1"; "" if the channel was not read from a file
  std::string unit;        ///< assumed unit in the file: "mm"; "" if none was stated and SI was assumed
  std::string called;      ///< channel name of this column in the file, if different: "reference_x"
  std::string joint = {};  ///< for a joint channel: name of the joint in the file, "elbow_joint"; "" if none
};

/// Why samples of a channel are not separate measurements.
enum class Staleness {
  none,         ///< every sample appears to be a measurement
  held,         ///< the channel is updated at a lower rate than the recording, and each value repeats until the next
  repeated,     ///< values repeat occasionally, as when updates are lost
  frozen,       ///< the channel freezes for a while during motion or noise
  placeholder,  ///< one value, such as 0 or -1, marks missing measurements
};

[[nodiscard]] constexpr auto word_table(Staleness) {
  using enum Staleness;
  return std::to_array<Word<Staleness>>(
      {{none, "none"}, {held, "held"}, {repeated, "repeated"}, {frozen, "frozen"}, {placeholder, "placeholder"}});
}

/// Updates of a channel that was not measured at every sample.
struct Updates {
  Staleness staleness = Staleness::none;
  double interval = 1.0;     ///< [samples] from one measurement to the next, on average
  double share = 0.0;        ///< share of samples that are not measurements
  double placeholder = 0.0;  ///< the value, in the unit of the channel
};

/// One measured signal, as recorded, in SI units and radians.
struct Channel {
  std::string name;   ///< as in the channel table of the documentation: hand_x, force_y, joint_1, reaction, …
  std::string unit;   ///< SI: "m", "N", "rad", "N.m", "m/s2"; "" if not stated
  std::string frame;  ///< "base" for hand_*, force_*, reference_*, acceleration_*; "joint" for joint_*, torque_*
  Vector values;      ///< one value per sample of Recording::time
  ChannelOrigin origin = {};
  Updates updates = {};  ///< result of `recording::find_stale` on reading
};

/// An event: the onset of a perturbation, its offset, its direction.
struct Event {
  double time = 0.0;  ///< [s], on the clock of Recording::time
  std::string name;
  double value = 0.0;
};

/// A file that a recording came from.
struct SourceFile {
  std::string path;
  std::string format;      ///< "MAT v7", "CSV", …
  std::string sha256;      ///< 64 hexadecimal digits, of the file's bytes
  std::string trial = {};  ///< record in the file; "" if it has only one

  /// For messages: "exam.kinarm, trial 3".
  [[nodiscard]] std::string label() const { return trial.empty() ? path : path + ", trial " + trial; }
};

/// A recording, sample by sample, exactly as recorded: never resampled, padded, sorted or cleaned. Gaps, jitter,
/// backward time and non-finite values remain; recording::inspect reports them.
struct Recording {
  Vector time;                  ///< [s], as recorded; not necessarily even or increasing
  ChannelOrigin time_origin;    ///< of `time`
  bool time_from_rate = false;  ///< true if the file has no time, but it or the user gave the rate
  double time_zero = 0.0;       ///< [s] zero of `time` on the clock of the file; 0 if `time` is that clock
  bool untimed = false;  ///< true if the rows are not samples but separate loads or positions: `time` counts them
  std::vector<Channel> channels;  ///< each as long as `time`
  std::vector<Event> events;
  std::map<std::string, std::string> metadata;  ///< participant number, posture, protocol, robot, …
  std::vector<SourceFile> sources;              ///< one, or several for numbered parts
  std::vector<std::string> notes;               ///< notes for the user, in words
  std::vector<Warning> warnings;                ///< reasons for caution, whatever is computed

  [[nodiscard]] Index samples() const { return time.size(); }
  /// The metadata entry; "" if there is none.
  [[nodiscard]] std::string noted(const std::string& key) const {
    const auto found = metadata.find(key);
    return found == metadata.end() ? std::string() : found->second;
  }

  /// The channel of that name, or nullptr.
  [[nodiscard]] const Channel* find(std::string_view name) const {
    for (const Channel& channel : channels) {
      if (channel.name == name) return &channel;
    }
    return nullptr;
  }
};

}  // namespace mbk
