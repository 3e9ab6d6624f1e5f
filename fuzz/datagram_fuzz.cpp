#include <algorithm>

#include "fuzz/fuzz.h"
#include "mbk/experiment/drivers/datagram.h"

namespace mbk::fuzz {
namespace {

template <class Bytes>
std::string text_of(const Bytes& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// An accepted datagram consists of exactly these bytes, except for undefined flags.
template <class Datagram>
void check(std::span<const std::byte> bytes) {
  Datagram datagram;
  if (drivers::decode(bytes, datagram) != drivers::Refusal::none) return;
  const auto again = drivers::encode(datagram);
  constexpr std::size_t kFlags = 6, kBehindFlags = 8, kChecksum = 4;
  require(again.size() == bytes.size(), "a datagram has its length");
  require(std::equal(again.begin(), again.begin() + kFlags, bytes.begin()), "magic and version are preserved");
  require(std::equal(again.begin() + kBehindFlags, again.end() - kChecksum, bytes.begin() + kBehindFlags),
          "the numbers are preserved");
}

}  // namespace

std::vector<std::string> seeds() {
  drivers::StateDatagram state;
  state.raw = {3, 0.5, {1.0, -2.0}, {0.1, 0.2}, {9.8, 0.0}, true};
  drivers::StateDatagram second = state;
  second.version = 2;
  second.drives_measure = true;
  second.measured = {0.5, -0.5};
  second.fault = 7;
  return {text_of(drivers::encode(state)), text_of(drivers::encode(second)),
          text_of(drivers::encode(drivers::CommandDatagram{5, 50, 9, {0.5, 1.0}, true, true, true}))};
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mbk::fuzz::check<mbk::drivers::StateDatagram>(mbk::fuzz::bytes_of(data, size));
  mbk::fuzz::check<mbk::drivers::CommandDatagram>(mbk::fuzz::bytes_of(data, size));
  return 0;
}
