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

/// Signals in the memory of the caller, with the caller's names and units. Their meaning is decided on reading, by the
/// rules and options of files: x, Fx and "hand_x_mm" are recognised, and a channel map may name any of them. Immutable,
/// so threads may share it.
class InMemory {
 public:
  /// One signal, or the time.
  struct Signal {
    std::string name;
    std::string unit;  ///< "mm"; "" if only the name may give it
    Samples values;    ///< of a matrix column by column
    Index rows = 0;    ///< of a matrix; 0: one signal
    Rests rests = {};  ///< remainders of integers above 2^53
  };

  /// @param signals  including "time" [s], unless a rate is given in the options of `read` or here
  /// @param rate_hz  of all signals; 0 if they include a time, or if the rate is given on reading
  /// @fails  usage: no signals, one without a name, two of one name; data: different lengths, no samples.
  [[nodiscard]] static Result<InMemory> of(std::vector<Signal> signals, double rate_hz = 0.0,
                                           std::map<std::string, std::string> metadata = {},
                                           std::vector<Event> events = {});
  /// A recording read from a file: it keeps the file's name and hash; its signals are its channels in SI units.
  [[nodiscard]] static InMemory of(Recording recording);

  /// @fails  as recording::read
  [[nodiscard]] Result<Recording> read(const ReadOptions& options) const;
  /// The same without assigning channels.
  [[nodiscard]] Contents contents() const;

  [[nodiscard]] const std::vector<Signal>& signals() const { return signals_; }
  [[nodiscard]] const std::map<std::string, std::string>& metadata() const { return metadata_; }
  [[nodiscard]] const std::vector<Event>& events() const { return events_; }
  /// Of `of(Recording)`; otherwise nullptr.
  [[nodiscard]] const std::shared_ptr<const Recording>& recording() const { return recording_; }
  /// By the name of a signal or of its channel; nullptr if there is none.
  [[nodiscard]] const Signal* find(std::string_view name) const;

 private:
  std::vector<Signal> signals_;
  double rate_hz_ = 0.0;
  std::map<std::string, std::string> metadata_;
  std::vector<Event> events_;
  std::shared_ptr<const Recording> recording_;  ///< read from a file; nullptr if there was none
};

/// A Requester that has recordings in memory under names.
class RecordingHolder {
 public:
  virtual ~RecordingHolder() = default;
  /// The recording that `word` names instead of a file; nullptr: it is the name of a file.
  [[nodiscard]] virtual std::shared_ptr<const InMemory> recording(const std::filesystem::path& word) const = 0;
};

/// The recording that `word` names for the requester of this thread; nullptr if it is the name of a file.
[[nodiscard]] std::shared_ptr<const InMemory> held_recording(const std::filesystem::path& word);

}  // namespace mbk::recording
