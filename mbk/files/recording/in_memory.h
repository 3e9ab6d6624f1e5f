#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/recording/read.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/samples.h"

namespace mbk::recording {

/// Signals in the memory of whoever measures them, under the names and in the units that they have there. What they
/// mean is decided where they are read, by the rules and options of a file: x, Fx and "hand_x_mm" are recognised, and a
/// channel map may name any of them. Never changed after it was made, so that threads may share it.
class InMemory {
 public:
  /// One signal, or the time.
  struct Signal {
    std::string name;
    std::string unit;  ///< "mm"; "" where only the name may say it
    Samples values;    ///< of a matrix column by column
    Index rows = 0;    ///< of a matrix; 0: one signal
    Rests rests = {};  ///< what `values` leave of whole numbers above 2^53
  };

  /// @param signals  with "time" [s] among them, or a rate in the options of `read` or here
  /// @param rate_hz  of all of them; 0 where a time is among them, or the rate is said when they are read
  /// @fails  usage: no signals, one without a name, two of one name; data: different lengths, no samples.
  [[nodiscard]] static Result<InMemory> of(std::vector<Signal> signals, double rate_hz = 0.0,
                                           std::map<std::string, std::string> metadata = {},
                                           std::vector<Event> events = {});
  /// What was read from a file: it stays known by the file's name and hash, and its signals are its channels in SI.
  [[nodiscard]] static InMemory of(Recording recording);

  /// @fails  as recording::read
  [[nodiscard]] Result<Recording> read(const ReadOptions& options) const;
  /// The same without a meaning.
  [[nodiscard]] Contents contents() const;

  [[nodiscard]] const std::vector<Signal>& signals() const { return signals_; }
  [[nodiscard]] const std::map<std::string, std::string>& metadata() const { return metadata_; }
  [[nodiscard]] const std::vector<Event>& events() const { return events_; }
  /// By the name of a signal, or of the channel that it is; nullptr: there is none.
  [[nodiscard]] const Signal* find(std::string_view name) const;

 private:
  std::vector<Signal> signals_;
  double rate_hz_ = 0.0;
  std::map<std::string, std::string> metadata_;
  std::vector<Event> events_;
  std::shared_ptr<const Recording> recording_;  ///< that was read from a file; nullptr where there was none
};

/// A Requester that has recordings in memory under names.
class RecordingHolder {
 public:
  virtual ~RecordingHolder() = default;
  /// What `word` stands for where a file would be named; nullptr: it is the name of a file.
  [[nodiscard]] virtual std::shared_ptr<const InMemory> recording(const std::filesystem::path& word) const = 0;
};

/// What `word` stands for with whom this thread works for; nullptr where it is the name of a file.
[[nodiscard]] std::shared_ptr<const InMemory> held_recording(const std::filesystem::path& word);

}  // namespace mbk::recording
