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

/// Where a channel stands in its file, in the words of --channels, so that a message can say how to read it otherwise.
struct ChannelOrigin {
  std::string alias;   ///< the channel's short name: "x", "Fx", "xr", "time"
  std::string source;  ///< "10", "-10", "force_x*8.1"; "" where the channel was not read from a file
  std::string unit;    ///< in which the file was taken to be: "mm"; "" where nothing said it and SI was assumed
  std::string called;  ///< channel that the file itself calls this column, where that is another one: "reference_x"
  std::string joint =
      {};  ///< of a joint's channel: the name of the joint in the file, "elbow_joint"; "" where it says none
};

/// Why samples of a channel are no measurements of their own.
enum class Staleness {
  none,         ///< every sample is one, as far as the values show
  held,         ///< the channel is updated at a lower rate than the recording, and each value repeats until the next
  repeated,     ///< values repeat now and then, as where updates are lost
  frozen,       ///< the channel stands still for a while in the midst of motion or noise
  placeholder,  ///< one value, such as 0 or -1, stands where nothing was measured
};

[[nodiscard]] constexpr auto word_table(Staleness) {
  using enum Staleness;
  return std::to_array<Word<Staleness>>(
      {{none, "none"}, {held, "held"}, {repeated, "repeated"}, {frozen, "frozen"}, {placeholder, "placeholder"}});
}

/// How often a channel was measured, where that is not once a sample.
struct Updates {
  Staleness staleness = Staleness::none;
  double interval = 1.0;     ///< [samples] from one measurement to the next, on average
  double share = 0.0;        ///< of the samples, those that are no measurement
  double placeholder = 0.0;  ///< the value, in the unit of the channel
};

/// One measured signal, as recorded, in SI units and radians.
struct Channel {
  std::string name;   ///< as in the channel table of the documentation: hand_x, force_y, joint_1, reaction, …
  std::string unit;   ///< SI: "m", "N", "rad", "N.m", "m/s2"; "" where the file does not say
  std::string frame;  ///< "base" for hand_*, force_*, reference_*, acceleration_*; "joint" for joint_*, torque_*
  Vector values;      ///< one value per sample of Recording::time
  ChannelOrigin origin = {};
  Updates updates = {};  ///< as `recording::find_stale` found them when the recording was read
};

/// Something that happened at an instant: the onset of a perturbation, its offset, its direction.
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
  std::string trial = {};  ///< which of its records; "" where it holds one

  /// For people: "exam.kinarm, trial 3".
  [[nodiscard]] std::string label() const { return trial.empty() ? path : path + ", trial " + trial; }
};

/// What was measured, sample by sample, exactly as it was recorded: never resampled, padded, sorted or cleaned.
/// Gaps, jitter, backward time and non-finite values stay in it; recording::inspect reports them.
struct Recording {
  Vector time;                  ///< [s], as recorded; not necessarily even or increasing
  ChannelOrigin time_origin;    ///< of `time`
  bool time_from_rate = false;  ///< true where the file holds no time, but it or the user gave the rate
  double time_zero = 0.0;       ///< [s] of the file's own clock where `time` counts from; 0 where `time` is that clock
  bool untimed = false;  ///< true where the rows are no samples but loads or places by themselves: `time` counts them
  std::vector<Channel> channels;  ///< each as long as `time`
  std::vector<Event> events;
  std::map<std::string, std::string> metadata;  ///< participant number, posture, protocol, robot, …
  std::vector<SourceFile> sources;              ///< one, or several for numbered parts
  std::vector<std::string> notes;               ///< what the reader wants its user to know, in words
  std::vector<Warning> warnings;                ///< what makes results of it doubtful, whatever is computed

  [[nodiscard]] Index samples() const { return time.size(); }
  /// What the metadata say of it; "" where they say nothing.
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
