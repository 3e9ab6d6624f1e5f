#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/numeric/random.h"

namespace mbk::laboratory {

/// What one robot tells the other each tick.
struct Packet {
  double position = 0.0, velocity = 0.0, acceleration = 0.0;  ///< of the sender's robot [m, m/s, m/s²]
  double force = 0.0;                                         ///< on the sender's robot from outside [N]
};

/// What a receiver does in a tick in which nothing newer has arrived.
enum class OnLoss {
  hold,  ///< keeps the last packet
  zero,  ///< takes zeros
};

struct PacketLineOptions {
  double delay = 0.0;   ///< [s] ≥ 0, rounded to whole ticks
  double jitter = 0.0;  ///< each packet takes up to so much longer, evenly distributed [s] ≥ 0, in whole ticks
  double loss = 0.0;    ///< share of the packets that never arrive, 0 to 1, each by itself
  OnLoss on_loss = OnLoss::hold;
};

/// A line that carries one packet each tick, late and not always. Packets may overtake each other; one that is older
/// than what has arrived already is of no use and is dropped. Until the first arrives there are zeros.
class PacketLine {
 public:
  /// @param sample_time  T [s] > 0   @param stream  of the seed: lines of one seed are independent
  /// @fails  usage: a limit named at PacketLineOptions is not kept; the delay is longer than kLongestDelay.
  [[nodiscard]] static Result<PacketLine> create(const PacketLineOptions& options, double sample_time,
                                                 std::uint64_t seed, std::uint32_t stream);

  /// One tick: sends a packet, and gives what the receiver has. Without delay that is the packet itself.
  Packet step(const Packet& sent);

  [[nodiscard]] long sent() const { return tick_; }  ///< packets so far
  [[nodiscard]] long lost() const { return lost_; }  ///< of these, those that never arrive

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
