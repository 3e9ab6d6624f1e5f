#include "mbk/experiment/console/frame.h"

#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include "mbk/experiment/control/sequencer.h"

namespace mbk::console {

static_assert(std::endian::native == std::endian::little, "frames are written as the machine holds numbers");

namespace {

template <class Value>
void put(char*& at, const Value& value) {
  std::memcpy(at, &value, sizeof value);
  at += sizeof value;
}

}  // namespace

std::string frame(std::span<const journal::Tick> ticks, const robot::Geometry& geometry, std::uint32_t trial) {
  std::string bytes(kFrameHeader + ticks.size() * kFrameColumns * sizeof(float), '\0');
  char* at = bytes.data();
  const journal::Tick& first = ticks.front();
  put(at, std::array{'M', 'B', 'K', 'F'});
  put(at, std::uint16_t{1});
  put(at, static_cast<std::uint16_t>(kFrameColumns));
  put(at, static_cast<std::uint32_t>(ticks.size()));
  put(at, trial);
  put(at, first.time);
  put(at, static_cast<double>(first.number));
  for (const journal::Tick& tick : ticks) {
    const auto hand = robot::hand_position(geometry, {tick.joint[0], tick.joint[1]});
    const bool asked = tick.reason == 0 && static_cast<control::Phase>(tick.phase) != control::Phase::done;
    const double nothing = std::numeric_limits<double>::quiet_NaN();
    const std::array<double, kFrameColumns> row = {tick.time - first.time,
                                                   hand[0],
                                                   hand[1],
                                                   tick.force[0],
                                                   tick.force[1],
                                                   asked ? tick.reference[0] : nothing,
                                                   asked ? tick.reference[1] : nothing,
                                                   tick.acceleration[0],
                                                   tick.acceleration[1],
                                                   tick.torque[0],
                                                   tick.torque[1],
                                                   1e6 * static_cast<double>(tick.compute),
                                                   1e6 * tick.late};
    for (const double value : row) put(at, static_cast<float>(value));
  }
  return bytes;
}

}  // namespace mbk::console
