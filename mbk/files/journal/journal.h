#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"
#include "mbk/files/journal/tick.h"
#include "mbk/model/robot/kinematics.h"
#include "mbk/model/trial/readers.h"
#include "mbk/model/trial/recording.h"

namespace mbk::journal {

/// Data known before the first tick.
struct Header {
  std::map<std::string, std::string> metadata;  ///< of the recording: participant, protocol, robot, versions, seed …
  robot::Geometry geometry;                     ///< d₁ and d₂ convert angles to the hand position
  double rate = 1000.0;                         ///< [Hz]
  std::string reference_unit = "m";             ///< "m" or "N"
  bool has_force = true, has_acceleration = true;
  int force_latency = 0;             ///< ticks by which force and acceleration are older than the angles beside them
  std::vector<Event> events;         ///< of the schedule, on its own clock
  Readers readers = Readers::owner;  ///< of the journal and of its recording
};

/// How a trial ended.
struct Ending {
  enum class How {
    completed,
    ended_early,  ///< by the operator
    safety_stop,
    interrupted,  ///< the program or the machine went down
    other,        ///< a word of a newer version of mbk, unknown to this one
  };
  How how = How::completed;
  std::string detail;          ///< a sentence; may be empty
  std::uint64_t dropped = 0;   ///< ticks that did not reach the file
  std::uint64_t overruns = 0;  ///< ticks without a wake-up
  std::uint64_t ticks = 0;     ///< ticks made by the loop, including dropped ones; 0: not stated
  std::string trip;            ///< code of the safety stop; empty without one
  std::string motors;          ///< state of the motors afterwards: safety::sentence; empty: unknown
  std::string other;           ///< that word, where `how` is `other`

  /// "completed": of `how`, or that of a newer version.
  [[nodiscard]] std::string_view word() const;
};

[[nodiscard]] constexpr auto word_table(Ending::How) {
  using enum Ending::How;
  return std::to_array<Word<Ending::How>>({{completed, "completed"},
                                           {ended_early, "ended early by the operator"},
                                           {safety_stop, "safety stop"},
                                           {interrupted, "interrupted"},
                                           {other, "other"}});
}

/// Writes a trial tick by tick to an append-only file, in blocks with a checksum each, so that data written before a
/// crash, and every intact block of a damaged file, can be read. The format is little-endian: "MBKJRNL2", then blocks
/// (blocks.h) of the header as JSON, of ticks, and of the ending as JSON; the header is repeated every 64 blocks and
/// before the ending.
class Writer {
 public:
  /// @param expected  number of ticks for which disk space is reserved
  /// @fails  usage: the file exists. data: the folder cannot be written; there is not enough space.
  [[nodiscard]] static Result<Writer> create(const std::filesystem::path& file, const Header& header,
                                             std::uint64_t expected);

  Writer(Writer&& other) noexcept;
  Writer& operator=(Writer&& other) noexcept;
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer();

  /// Why no journal can start under an existing name: usage.
  [[nodiscard]] static Error already_there(const std::filesystem::path& file);

  /// One block of at most `kLongest` ticks, whose numbers rise from one to the next. An incomplete block is overwritten
  /// by the next.   @fails  data: the disk rejects it.
  [[nodiscard]] Result<void> append(std::span<const Tick> ticks);
  static constexpr std::size_t kLongest = 4096;

  /// The last block.   @fails  as append
  [[nodiscard]] Result<void> end(const Ending& ending);

  /// Waits until everything is on the disk.   @fails  data: the disk reports an error.
  [[nodiscard]] Result<void> sync() const;

  /// The same from any thread, concurrently.
  [[nodiscard]] bool reaches_disk() const noexcept;

  /// Where the open file is.
  enum class Place {
    here,  ///< under its name
    gone,  ///< it was removed, renamed or replaced: written data have no name
    cut,   ///< it was truncated
  };
  [[nodiscard]] Place place() const;

  /// Copies the contents of the open file and continues there: trial_saved.h5.journal beside the old name, or _saved_2
  /// …; if that folder is also gone, in the nearest writable parent folder, or in the folder for temporary files.
  /// @fails  data: the disk rejects it; nothing is changed.
  [[nodiscard]] Result<void> save_elsewhere();

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  Writer(std::filesystem::path file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {}
  [[nodiscard]] Result<void> write_block(std::uint32_t kind, std::span<const std::byte> payload);
  [[nodiscard]] Error failure(const char* what) const;
  void lock() const;

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::int64_t end_ = 0;  // of the last whole block
  std::uint64_t trial_ = 0, next_tick_ = 0;
  std::uint32_t blocks_ = 0;
  std::string header_;
  Readers readers_ = Readers::owner;
  std::vector<std::byte> block_;
};

/// Ticks that follow each other.
struct TickRange {
  std::uint64_t first = 0, count = 0;
};

/// Missing parts and other damage of a journal.
struct Damage {
  std::vector<TickRange> lost;      ///< ticks that are missing before one that is there, or before a known end
  std::uint64_t bytes = 0;          ///< bytes that belong to no complete block
  std::uint64_t blocks = 0;         ///< that are missing before one that is there; format 1 does not say
  std::uint64_t doubled = 0;        ///< duplicate blocks, which were ignored
  std::uint64_t moved = 0;          ///< blocks that were out of order and were reordered
  std::uint64_t foreign = 0;        ///< blocks of another trial, ignored
  std::uint64_t contradictory = 0;  ///< conflicting ticks with equal numbers: all ignored and counted as lost
  bool header = false;              ///< no header block is complete: only the data in the ticks are known

  [[nodiscard]] std::uint64_t ticks_lost() const;

  /// Whether the journal differs from what was written.
  [[nodiscard]] bool any() const;

  /// In sentences.
  [[nodiscard]] std::vector<std::string> sentences() const;

  /// The missing ticks: "1200 to 1249, 3000"; the first 20 ranges.
  [[nodiscard]] std::string gaps() const;
};

/// The readable part of a journal.
struct Journal {
  Header header;
  std::vector<Tick> ticks;       ///< by number, each once
  std::optional<Ending> ending;  ///< absent: the program or the computer stopped, or its block is damaged
  Damage damage;

  /// Whether measured data are missing from `ticks`, or may be: a part is damaged and the number of ticks is unknown.
  [[nodiscard]] bool incomplete() const;

  /// "completed", or "completed, but 50 of 67101 ticks were lost".
  [[nodiscard]] std::string ended() const;

  /// Sets a known ending and counts ticks missing before it as lost.
  void end_with(const Ending& known);
};

/// The process that is currently recording into a journal; 0: none visible.
[[nodiscard]] int recorded_by(const std::filesystem::path& file);

/// Reads every intact block of a journal, wherever it is. Damaged parts are omitted and reported: all returned data are
/// exactly as written, as far as CRC-32, the trial number in each block (format 2) and the tick numbers can verify.
/// Time and memory grow linearly with the file size, whatever it contains.
/// @fails  data: no complete block; written by another version of mbk; headers of two trials in format 1, which does
/// not assign blocks to trials.
[[nodiscard]] Result<Journal> decode(std::span<const std::byte> bytes);

/// @fails  data: the file cannot be read; as decode.
[[nodiscard]] Result<Journal> read(const std::filesystem::path& file);

/// Whether the file has the signature of a journal, or at least its name.
[[nodiscard]] bool is_journal(const std::filesystem::path& file);

/// The recording of a trial: channels hand_x … acceleration_y, joint_1, joint_2, torque_1, torque_2, with the header's
/// metadata, the events perturbation_start and perturbation_end and those of the schedule, and in the metadata its
/// ending (`ended`, `ended_detail`), losses (`ticks_dropped`) and tick delays. Force and acceleration are aligned with
/// the angles of their tick (Header::force_latency).
///   A lost tick is a row of NaN, at the time that its number has on the ticks' clock; where the loop missed ticks in
/// the same gap, one period after the row before. The metadata then says `ended` "…, but N of M ticks were lost",
/// `ticks_lost`, `gaps` and `journal_damage`. Gaps of more than 100 times as many ticks as there are, and 100,000, are
/// not filled and are reported. Without a header there is neither hand nor reference.
/// @fails  data: it contains no ticks.
[[nodiscard]] Result<Recording> to_recording(const Journal& journal);

}  // namespace mbk::journal
