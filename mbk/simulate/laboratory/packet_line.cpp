#include "mbk/simulate/laboratory/packet_line.h"

#include <fmt/format.h>

#include <cmath>

namespace mbk::laboratory {

Result<PacketLine> PacketLine::create(const PacketLineOptions& options, double sample_time, std::uint64_t seed,
                                      std::uint32_t stream) {
  if (!(sample_time > 0.0)) return bad_usage(fmt::format("sample time {:g} s is not positive", sample_time));
  for (const double time : {options.delay, options.jitter}) {
    if (!(time >= 0.0 && time <= kLongestDelay)) {
      return bad_usage(fmt::format("delay or jitter of {:g} s is not within 0 to {:g} s", time, kLongestDelay));
    }
  }
  if (!(options.loss >= 0.0 && options.loss <= 1.0)) {
    return bad_usage(fmt::format("a loss of {:g} is not a fraction from 0 to 1", options.loss));
  }
  return PacketLine(options, std::lround(options.delay / sample_time), std::lround(options.jitter / sample_time),
                    numeric::Random(seed, stream));
}

PacketLine::PacketLine(const PacketLineOptions& options, long delay, long jitter, const numeric::Random& random)
    : options_(options),
      delay_(delay),
      jitter_(jitter),
      random_(random),
      ring_(static_cast<std::size_t>(delay + jitter + 1)) {}

Packet PacketLine::step(const Packet& sent) {
  const bool arrives = random_.uniform() >= options_.loss;
  const long later = static_cast<long>(random_.below(static_cast<std::uint64_t>(jitter_) + 1));
  if (!arrives) ++lost_;
  ring_[static_cast<std::size_t>(tick_) % ring_.size()] = {sent, tick_, arrives ? tick_ + delay_ + later : -1};
  bool fresh = false;
  for (const UnderWay& one : ring_) {
    if (one.arrives != tick_ || one.sent <= newest_sent_) continue;
    newest_ = one.packet;
    newest_sent_ = one.sent;
    fresh = true;
  }
  ++tick_;
  return fresh || options_.on_loss == OnLoss::hold ? newest_ : Packet{};
}

}  // namespace mbk::laboratory
