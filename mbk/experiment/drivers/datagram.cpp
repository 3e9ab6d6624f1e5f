#include "mbk/experiment/drivers/datagram.h"

#include <zlib.h>

#include <bit>
#include <type_traits>

namespace mbk::drivers {
namespace {

constexpr std::uint32_t kStateMagic = 0x534B424D, kCommandMagic = 0x434B424D;  // "MBKS", "MBKC"
constexpr std::size_t kChecksumBytes = 4;
constexpr std::array kStateLengths = {kStateBytes1, kStateBytes2};
constexpr std::array kCommandLengths = {kCommandBytes};

constexpr std::uint16_t kStop = 1, kMotorsOn = 2, kForce = 4, kAcceleration = 8, kExpired = 16,
                        kDrivesMeasure = 32;                         // of a state
constexpr std::uint16_t kEnabled = 1, kGreeting = 2, kLockStep = 4;  // of a command

template <class Number>
using Bits = std::conditional_t<sizeof(Number) == 8, std::uint64_t,
                                std::conditional_t<sizeof(Number) == 4, std::uint32_t, std::uint16_t>>;

class Writing {
 public:
  explicit Writing(std::span<std::byte> bytes) noexcept : bytes_(bytes) {}

  template <class Number>
  void put(Number value) noexcept {
    auto bits = static_cast<std::uint64_t>(std::bit_cast<Bits<Number>>(value));
    for (std::size_t i = 0; i < sizeof(Number); ++i, bits >>= 8U) bytes_[at_++] = static_cast<std::byte>(bits & 0xFFU);
  }
  void put(const Eigen::Vector2d& pair) noexcept {
    put(pair[0]);
    put(pair[1]);
  }

 private:
  std::span<std::byte> bytes_;
  std::size_t at_ = 0;
};

class Reading {
 public:
  explicit Reading(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {}

  template <class Number>
  Number get() noexcept {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(Number); ++i) bits |= std::to_integer<std::uint64_t>(bytes_[at_++]) << (8U * i);
    return std::bit_cast<Number>(static_cast<Bits<Number>>(bits));
  }
  Eigen::Vector2d get_pair() noexcept {
    const double first = get<double>();
    return {first, get<double>()};
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

std::uint32_t checksum_of(std::span<const std::byte> bytes) noexcept {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size() - kChecksumBytes)));
}

/// What can be said before a field is read. Wrong versions come before wrong checksums: another version may be longer.
/// @param lengths  of version 1, 2, …
Refusal check(std::span<const std::byte> bytes, std::span<const std::size_t> lengths, std::uint32_t magic) noexcept {
  constexpr std::size_t kHead = sizeof(std::uint32_t) + sizeof(std::uint16_t);
  if (bytes.size() < kHead) return Refusal::length;
  Reading head(bytes);
  if (head.get<std::uint32_t>() != magic) return Refusal::magic;
  const auto version = head.get<std::uint16_t>();
  if (version < 1 || version > lengths.size()) return Refusal::version;
  if (bytes.size() != lengths[version - 1U]) return Refusal::length;
  if (Reading(bytes.last(kChecksumBytes)).get<std::uint32_t>() != checksum_of(bytes)) return Refusal::checksum;
  return Refusal::none;
}

std::uint16_t flag(bool set, std::uint16_t bit) noexcept {
  return set ? bit : std::uint16_t{0};
}

/// Behind magic and version, which `check` has read.
Reading body_of(std::span<const std::byte> bytes) noexcept {
  return Reading(bytes.subspan(sizeof(std::uint32_t) + sizeof(std::uint16_t)));
}

}  // namespace

void seal(std::span<std::byte> bytes) noexcept {
  Writing(bytes.last(kChecksumBytes)).put(checksum_of(bytes));
}

StateBytes encode(const StateDatagram& d) noexcept {
  StateBytes bytes(kStateLengths[d.version >= kNewestStateVersion ? 1 : 0]);
  Writing out(bytes);
  out.put(kStateMagic);
  out.put(d.version);
  out.put(static_cast<std::uint16_t>(flag(d.raw.stop, kStop) | flag(d.enabled, kMotorsOn) | flag(d.has_force, kForce) |
                                     flag(d.has_acceleration, kAcceleration) | flag(d.watchdog_expired, kExpired) |
                                     flag(d.version >= 2 && d.drives_measure, kDrivesMeasure)));
  out.put(d.session);
  out.put(d.rejected);
  out.put(d.raw.sequence);
  out.put(d.answered);
  out.put(d.raw.time);
  out.put(d.raw.encoder);
  out.put(d.raw.force);
  out.put(d.raw.acceleration);
  if (d.version >= 2) {
    out.put(d.measured);
    out.put(d.fault);
  }
  seal(bytes);
  return bytes;
}

std::array<std::byte, kCommandBytes> encode(const CommandDatagram& d) noexcept {
  std::array<std::byte, kCommandBytes> bytes{};
  Writing out(bytes);
  out.put(kCommandMagic);
  out.put(kCommandVersion);
  out.put(static_cast<std::uint16_t>(flag(d.enabled, kEnabled) | flag(d.greeting, kGreeting) |
                                     flag(d.lock_step, kLockStep)));
  out.put(d.session);
  out.put(d.watchdog);
  out.put(d.sequence);
  out.put(d.command);
  seal(bytes);
  return bytes;
}

Refusal decode(std::span<const std::byte> bytes, StateDatagram& into) noexcept {
  if (const Refusal refusal = check(bytes, kStateLengths, kStateMagic); refusal != Refusal::none) return refusal;
  into.version = Reading(bytes.subspan(sizeof(std::uint32_t))).get<std::uint16_t>();
  Reading in = body_of(bytes);
  const auto flags = in.get<std::uint16_t>();
  into.raw.stop = (flags & kStop) != 0;
  into.enabled = (flags & kMotorsOn) != 0;
  into.has_force = (flags & kForce) != 0;
  into.has_acceleration = (flags & kAcceleration) != 0;
  into.watchdog_expired = (flags & kExpired) != 0;
  into.session = in.get<std::uint32_t>();
  into.rejected = in.get<std::uint32_t>();
  into.raw.sequence = in.get<std::uint64_t>();
  into.answered = in.get<std::uint64_t>();
  into.raw.time = in.get<double>();
  into.raw.encoder = in.get_pair();
  into.raw.force = in.get_pair();
  into.raw.acceleration = in.get_pair();
  into.drives_measure = into.version >= 2 && (flags & kDrivesMeasure) != 0;
  into.measured = into.version >= 2 ? in.get_pair() : Eigen::Vector2d(0.0, 0.0);
  into.fault = into.version >= 2 ? in.get<std::uint32_t>() : 0;
  return Refusal::none;
}

Refusal decode(std::span<const std::byte> bytes, CommandDatagram& into) noexcept {
  if (const Refusal refusal = check(bytes, kCommandLengths, kCommandMagic); refusal != Refusal::none) return refusal;
  Reading in = body_of(bytes);
  const auto flags = in.get<std::uint16_t>();
  into.enabled = (flags & kEnabled) != 0;
  into.greeting = (flags & kGreeting) != 0;
  into.lock_step = (flags & kLockStep) != 0;
  into.session = in.get<std::uint32_t>();
  into.watchdog = in.get<std::uint32_t>();
  into.sequence = in.get<std::uint64_t>();
  into.command = in.get_pair();
  return Refusal::none;
}

}  // namespace mbk::drivers
