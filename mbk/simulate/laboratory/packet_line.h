#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/numeric/random.h"

namespace mbk::laboratory {

/// The packet that one robot sends to the other each tick.
struct Packet {
  double position = 0.0, velocity = 0.0, acceleration = 0.0;  ///< of the sender's robot [m, m/s, m/s²]
  double force = 0.0;                                         ///< on the sender's robot from outside [N]
};

/// Reaction of a receiver in a tick without a newer packet.
enum class OnLoss {
  hold,  ///< keeps the last packet
  zero,  ///< takes zeros
};

struct PacketLineOptions {
  double delay = 0.0;   ///< [s] ≥ 0, rounded to whole ticks
  double jitter = 0.0;  ///< maximum additional delay of a packet, uniformly distributed [s] ≥ 0, in whole ticks
  double loss = 0.0;    ///< probability that a packet is lost, 0 to 1, independent
  OnLoss on_loss = OnLoss::hold;
};

/// A line that carries one packet per tick, with delay and losses. Packets may overtake each other; one that is older
/// than the newest received packet is dropped. Before the first packet the values are zero.
class PacketLine {
 public:
  /// @param sample_time  T [s] > 0   @param stream  of the seed: lines of one seed are independent
  /// @fails  usage: a limit stated in PacketLineOptions is violated; the delay is longer than kLongestDelay.
  [[nodiscard]] static Result<PacketLine> create(const PacketLineOptions& options, double sample_time,
                                                 std::uint64_t seed, std::uint32_t stream);

  /// One tick: sends a packet and returns the packet at the receiver. Without delay that is the same packet.
  Packet step(const Packet& sent);

  [[nodiscard]] long sent() const { return tick_; }  ///< packets so far
  [[nodiscard]] long lost() const { return lost_; }  ///< of these, lost packets

  static constexpr double kLongestDelay = 60.0;  ///< [s]

 private:
  PacketLine(const PacketLineOptions& options, long delay, long jitter, const numeric::Random& random);

  struct UnderWay {
    Packet packet;
    long sent = 0, arrives = -1;  // ticks; −1: never
  };
  PacketLineOptions options_;
  long delay_, jitter_;
  numeric::Random random_;
  std::vector<UnderWay> ring_;  // one place for each tick within delay and jitter
  Packet newest_;
  long newest_sent_ = -1, tick_ = 0, lost_ = 0;
};

}  // namespace mbk::laboratory
