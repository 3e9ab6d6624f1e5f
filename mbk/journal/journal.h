#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mbk/core/result.h"
#include "mbk/journal/tick.h"
#include "mbk/robot/kinematics.h"
#include "mbk/trial/recording.h"

namespace mbk::journal {

/// What is known before the first tick.
struct Header {
  std::map<std::string, std::string> metadata;  ///< of the recording: participant, protocol, robot, versions, seed …
  robot::Geometry geometry;                     ///< d₁ and d₂ turn angles into the hand's place
  double rate = 1000.0;                         ///< [Hz]
  std::string reference_unit = "m";             ///< "m" or "N"
  bool has_force = true, has_acceleration = true;
  int force_latency = 0;      ///< ticks by which force and acceleration are older than the angles beside them
  std::vector<Event> events;  ///< of the schedule, on its own clock
};

/// How a trial ended.
struct Ending {
  std::string how;             ///< "completed", "stopped by the operator", "safety stop", "interrupted"
  std::string detail;          ///< a sentence; may be empty
  std::uint64_t dropped = 0;   ///< ticks that did not reach the file
  std::uint64_t overruns = 0;  ///< ticks that went by without a wake-up
  std::string trip;            ///< code of the safety stop; empty without one
  std::string motors;          ///< what is known of the motors after it: safety::sentence; empty: nothing
};

/// Writes a trial tick by tick to a file that is only ever appended to: blocks of ticks, each with a checksum, so that
/// what was written before a crash can be read after it. The format is native to machines with the low byte first:
///   "MBKJRNL1", then blocks of  kind, bytes, CRC-32 of kind, bytes and payload, 0  (four 32-bit numbers)  and payload;
///   kind 1: the header as JSON, kind 2: ticks, kind 3: the ending as JSON
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

  /// One block. What is not written whole is cut off again.   @fails  data: the disk does not take it.
  [[nodiscard]] Result<void> append(std::span<const Tick> ticks);

  /// The last block.   @fails  as append
  [[nodiscard]] Result<void> end(const Ending& ending);

  /// Waits until everything is on the disk; from any thread.   @fails  data: the disk reports an error.
  [[nodiscard]] Result<void> sync() const;

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  Writer(std::filesystem::path file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {}
  [[nodiscard]] Result<void> write_block(std::uint32_t kind, std::span<const std::byte> payload);
  [[nodiscard]] Error failure(const char* what) const;

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::int64_t end_ = 0;  // of the last whole block
  std::vector<std::byte> block_;
};

/// A journal as far as it is whole.
struct Journal {
  Header header;
  std::vector<Tick> ticks;
  std::optional<Ending> ending;  ///< absent: the program or the machine went down
  std::uint64_t bytes_lost = 0;  ///< behind the last whole block
};

/// @fails  data: the file cannot be read; it is no journal; its header is broken.
[[nodiscard]] Result<Journal> read(const std::filesystem::path& file);

/// Whether the file begins as a journal does.
[[nodiscard]] bool is_journal(const std::filesystem::path& file);

/// The recording of a trial: channels hand_x … acceleration_y, joint_1, joint_2, torque_1, torque_2, with the header's
/// metadata, the events perturbation_start and perturbation_end and those of the schedule, and in the metadata how it
/// ended (`ended`, `ended_detail`), what was lost (`ticks_dropped`) and how late ticks were. Force and acceleration
/// stand beside the angles of the tick that they belong to (Header::force_latency).
/// @fails  data: it holds no ticks.
[[nodiscard]] Result<Recording> to_recording(const Journal& journal);

}  // namespace mbk::journal
