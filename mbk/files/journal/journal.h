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

/// What is known before the first tick.
struct Header {
  std::map<std::string, std::string> metadata;  ///< of the recording: participant, protocol, robot, versions, seed …
  robot::Geometry geometry;                     ///< d₁ and d₂ turn angles into the hand's place
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
    other,        ///< a newer version of mbk has a word for it that this one does not know
  };
  How how = How::completed;
  std::string detail;          ///< a sentence; may be empty
  std::uint64_t dropped = 0;   ///< ticks that did not reach the file
  std::uint64_t overruns = 0;  ///< ticks that went by without a wake-up
  std::uint64_t ticks = 0;     ///< that the loop made, with those that were dropped; 0: not said
  std::string trip;            ///< code of the safety stop; empty without one
  std::string motors;          ///< what is known of the motors after it: safety::sentence; empty: nothing
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

/// Writes a trial tick by tick to a file that is only ever appended to, in blocks with a checksum each, so that
/// what was written before a crash can be read after it, and every whole block of it wherever something is damaged.
/// The format is native to machines with the low byte first: "MBKJRNL2", then blocks (blocks.h) of the header as JSON,
/// of ticks, and of the ending as JSON; the header comes again every 64 blocks and before the ending.
class Writer {
 public:
  /// @param expected  ticks; so much space is reserved on the disk
  /// @fails  usage: the file is there. data: the folder cannot be written; there is less space than needed.
  [[nodiscard]] static Result<Writer> create(const std::filesystem::path& file, const Header& header,
                                             std::uint64_t expected);

  Writer(Writer&& other) noexcept;
  Writer& operator=(Writer&& other) noexcept;
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer();

  /// Why no journal can begin under a name that is taken: usage.
  [[nodiscard]] static Error already_there(const std::filesystem::path& file);

  /// One block of at most `kLongest` ticks, whose numbers rise from one to the next. What is not written whole is
  /// written over by what comes next.   @fails  data: the disk does not take it.
  [[nodiscard]] Result<void> append(std::span<const Tick> ticks);
  static constexpr std::size_t kLongest = 4096;

  /// The last block.   @fails  as append
  [[nodiscard]] Result<void> end(const Ending& ending);

  /// Waits until everything is on the disk.   @fails  data: the disk reports an error.
  [[nodiscard]] Result<void> sync() const;

  /// The same from any thread, beside what the others do.
  [[nodiscard]] bool reaches_disk() const noexcept;

  /// Where the open file is.
  enum class Place {
    here,  ///< under its name
    gone,  ///< somebody removed, renamed or replaced it: what is written goes where no name leads
    cut,   ///< somebody made it shorter
  };
  [[nodiscard]] Place place() const;

  /// Copies what is in the open file, and goes on there: trial_saved.h5.journal beside the old name, or _saved_2 …;
  /// where that folder is gone too, in the nearest one above it that can be written, or among temporary files.
  /// @fails  data: the disk does not take it; everything is then as before.
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

/// What a journal should hold and does not, and what else is wrong with it.
struct Damage {
  std::vector<TickRange> lost;      ///< ticks that are missing before one that is there, or before a known end
  std::uint64_t bytes = 0;          ///< that belong to no whole block
  std::uint64_t blocks = 0;         ///< that are missing before one that is there; format 1 does not say
  std::uint64_t doubled = 0;        ///< blocks that came again; one was taken
  std::uint64_t moved = 0;          ///< blocks that did not stand in their order, and were put into it
  std::uint64_t foreign = 0;        ///< blocks of another trial, not taken
  std::uint64_t contradictory = 0;  ///< ticks of one number that differ: none of them was taken, they count as lost
  bool header = false;              ///< no block of it is whole: only what stands in the ticks is known

  [[nodiscard]] std::uint64_t ticks_lost() const;

  /// Whether the journal is not exactly what was written.
  [[nodiscard]] bool any() const;

  /// In sentences.
  [[nodiscard]] std::vector<std::string> sentences() const;

  /// The missing ticks: "1200 to 1249, 3000"; the first 20 ranges.
  [[nodiscard]] std::string gaps() const;
};

/// What could be read of a journal.
struct Journal {
  Header header;
  std::vector<Tick> ticks;       ///< by number, each once
  std::optional<Ending> ending;  ///< absent: the program or the machine went down, or its block is damaged
  Damage damage;

  /// Whether something that was measured is not in `ticks`, or may not be: where a part is damaged and nothing says how
  /// many ticks there were.
  [[nodiscard]] bool incomplete() const;

  /// "completed", or "completed, but 50 of 67101 ticks were lost".
  [[nodiscard]] std::string ended() const;

  /// Takes the ending from somebody who knows it, and what is missing before it for lost.
  void end_with(const Ending& known);
};

/// The process that is recording into a journal right now; 0: none that can be seen.
[[nodiscard]] int recorded_by(const std::filesystem::path& file);

/// Every whole block of a journal, wherever it stands. What is damaged is left out and said: nothing that comes back
/// differs by a bit from what was written, as far as a CRC-32, the trial's number in each block (format 2) and the
/// ticks' own numbers can tell. Time and memory grow with the file's length, whatever is in it.
/// @fails  data: no whole block; of another version of mbk; headers of two trials in format 1, which cannot say whose a
///         block is.
[[nodiscard]] Result<Journal> decode(std::span<const std::byte> bytes);

/// @fails  data: the file cannot be read; as decode.
[[nodiscard]] Result<Journal> read(const std::filesystem::path& file);

/// Whether the file begins as a journal does, or at least has the name of one.
[[nodiscard]] bool is_journal(const std::filesystem::path& file);

/// The recording of a trial: channels hand_x … acceleration_y, joint_1, joint_2, torque_1, torque_2, with the header's
/// metadata, the events perturbation_start and perturbation_end and those of the schedule, and in the metadata how it
/// ended (`ended`, `ended_detail`), what was lost (`ticks_dropped`) and how late ticks were. Force and acceleration
/// stand beside the angles of the tick that they belong to (Header::force_latency).
///   A lost tick is a row of NaN, at the time that its number has on the ticks' clock; where the loop missed ticks in
/// the same gap, one period after the row before. The metadata then says `ended` "…, but N of M ticks were lost",
/// `ticks_lost`, `gaps` and `journal_damage`. Gaps of more than 100 times as many ticks as there are, and 100,000, are
/// left open and said. Without a header there are neither hand nor reference.
/// @fails  data: it holds no ticks.
[[nodiscard]] Result<Recording> to_recording(const Journal& journal);

}  // namespace mbk::journal
