#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "mbk/base/core/words.h"
#include "mbk/experiment/device/wiring.h"

/// @file
/// The two datagrams between mbk and a robot. Whole numbers and IEEE 754 doubles, low byte first, no padding; the last
/// four bytes are the CRC-32 (zlib's, polynomial 0xEDB88320) of all before them. docs/guide/own_robot.md lists the
/// bytes.
namespace mbk::drivers {

inline constexpr std::uint16_t kCommandVersion = 1;
inline constexpr std::uint16_t kNewestStateVersion = 2;  ///< of a state; 1 is accepted too

/// Of the last words of a program that crashes: beyond any sequence that a session reaches, exact as a double, and the
/// highest where a robot keeps the low 31 or 32 bits alone and takes them for a signed number.
inline constexpr std::uint64_t kLastSequence = (std::uint64_t{1} << 52U) + 0x7FFFFFFFU;
inline constexpr int kGoodbyes = 5;  ///< how often "motors off" is said at the end: one may get lost

inline constexpr std::size_t kStateBytes1 = 92, kStateBytes2 = 112, kCommandBytes = 44;

/// From the robot: one sample. Version 2 adds what its drives measure and its own fault code.
struct StateDatagram {
  std::uint16_t version = 1;              ///< 1 or 2
  std::uint32_t session = 0;              ///< of the last greeting; 0 before the first
  std::uint32_t rejected = 0;             ///< datagrams that the robot has not believed since it began
  std::uint64_t answered = 0;             ///< sequence of the newest command that it obeys
  device::RawState raw;                   ///< in the robot's own units, with its own sequence
  bool enabled = false;                   ///< the motors are on
  bool has_force = true;                  ///< a force sensor is fitted
  bool has_acceleration = true;           ///< an accelerometer is fitted
  bool watchdog_expired = false;          ///< no command came in time: the motors stay off until the next greeting
  bool drives_measure = false;            ///< version 2: `measured` is meant
  Eigen::Vector2d measured = {0.0, 0.0};  ///< version 2: what the drives exert, in the unit of the command
  std::uint32_t fault = 0;                ///< version 2: the robot's own fault code; 0: none
};

/// To the robot.
struct CommandDatagram {
  std::uint32_t session = 0;             ///< chosen by mbk at each start ≠ 0
  std::uint32_t watchdog = 0;            ///< without a command for so long the robot switches its motors off [ms]
  std::uint64_t sequence = 0;            ///< from 1, one more with each command
  Eigen::Vector2d command = {0.0, 0.0};  ///< in the robot's own unit
  bool enabled = false;                  ///< motors on
  bool greeting = false;                 ///< a session begins: motors off, an answer is awaited
  bool lock_step = false;                ///< a simulation shall wait for each command
};

/// Why a datagram is not believed.
enum class Refusal : std::uint8_t { none, length, magic, version, checksum };
[[nodiscard]] constexpr auto word_table(Refusal) {
  using enum Refusal;
  return std::to_array<Word<Refusal>>({{none, "believed"},
                                       {length, "wrong length"},
                                       {magic, "no datagram of this kind"},
                                       {version, "another version"},
                                       {checksum, "wrong checksum"}});
}

/// A state as bytes, as many as its version has.
class StateBytes {
 public:
  StateBytes() = default;
  explicit StateBytes(std::size_t size) : size_(size) {}
  [[nodiscard]] std::byte* data() noexcept { return bytes_.data(); }
  [[nodiscard]] const std::byte* data() const noexcept { return bytes_.data(); }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::byte* begin() noexcept { return bytes_.data(); }
  [[nodiscard]] std::byte* end() noexcept { return bytes_.data() + size_; }
  [[nodiscard]] const std::byte* begin() const noexcept { return bytes_.data(); }
  [[nodiscard]] const std::byte* end() const noexcept { return bytes_.data() + size_; }
  std::byte& operator[](std::size_t i) noexcept { return bytes_[i]; }
  bool operator==(const StateBytes&) const = default;

 private:
  std::array<std::byte, kStateBytes2> bytes_{};
  std::size_t size_ = kStateBytes1;
};

[[nodiscard]] StateBytes encode(const StateDatagram& datagram) noexcept;
[[nodiscard]] std::array<std::byte, kCommandBytes> encode(const CommandDatagram& datagram) noexcept;

/// Writes the checksum of what stands before it into the last four bytes.
/// @param bytes  at least 4
void seal(std::span<std::byte> bytes) noexcept;

/// What stands in `into` is meant only where nothing is refused. A number need not be finite.
[[nodiscard]] Refusal decode(std::span<const std::byte> bytes, StateDatagram& into) noexcept;
[[nodiscard]] Refusal decode(std::span<const std::byte> bytes, CommandDatagram& into) noexcept;

}  // namespace mbk::drivers
