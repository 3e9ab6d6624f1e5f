#include "mbk/experiment/drivers/datagram.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace mbk::drivers {
namespace {

StateDatagram some_state() {
  StateDatagram d;
  d.session = 0xDEADBEEF;
  d.rejected = 7;
  d.answered = 41;
  d.raw = {42, 1.5, {0.25, -3.0}, {1e-300, 2.0}, {-0.0, 9.81}, true};
  d.has_force = false;
  d.watchdog_expired = true;
  return d;
}

template <class Bytes>
std::string hex(const Bytes& bytes) {
  std::string text;
  for (const std::byte one : bytes) {
    text += "0123456789abcdef"[std::to_integer<unsigned>(one) >> 4U];
    text += "0123456789abcdef"[std::to_integer<unsigned>(one) & 15U];
  }
  return text;
}

TEST(Datagram, AStateComesBackAsItWas) {
  const StateDatagram sent = some_state();
  StateDatagram came;
  ASSERT_EQ(decode(encode(sent), came), Refusal::none);
  EXPECT_EQ(encode(came), encode(sent));
  EXPECT_EQ(came.raw.sequence, 42U);
  EXPECT_EQ(came.raw.encoder, sent.raw.encoder);
  EXPECT_EQ(came.raw.acceleration[1], 9.81);
  EXPECT_TRUE(came.raw.stop);
  EXPECT_FALSE(came.has_force);
  EXPECT_TRUE(came.watchdog_expired);
}

TEST(Datagram, AStateOfVersionTwoBringsTorqueAndFaultToo) {
  StateDatagram sent = some_state();
  sent.version = 2;
  sent.drives_measure = true;
  sent.measured = {0.5, -1.25};
  sent.fault = 0xE17;
  const StateBytes bytes = encode(sent);
  EXPECT_EQ(bytes.size(), 112U);
  StateDatagram came;
  ASSERT_EQ(decode(bytes, came), Refusal::none);
  EXPECT_EQ(encode(came), bytes);
  EXPECT_EQ(came.measured, sent.measured);
  EXPECT_EQ(came.fault, 0xE17U);
  EXPECT_TRUE(came.drives_measure);
  // one that says version 1 at this length is refused, and so is version 2 cut to the length of version 1
  StateBytes wrong = bytes;
  wrong[4] = std::byte{1};
  EXPECT_EQ(decode(wrong, came), Refusal::length);
  EXPECT_EQ(decode(std::span(bytes).first(kStateBytes1), came), Refusal::length);
}

TEST(Datagram, ACommandComesBackAsItWas) {
  const CommandDatagram sent{3, 50, std::numeric_limits<std::uint64_t>::max(), {0.5, -2.0}, true, false, true};
  CommandDatagram came;
  ASSERT_EQ(decode(encode(sent), came), Refusal::none);
  EXPECT_EQ(encode(came), encode(sent));
  EXPECT_EQ(came.sequence, sent.sequence);
  EXPECT_EQ(came.command, sent.command);
  EXPECT_TRUE(came.enabled && came.lock_step && !came.greeting);
}

/// Written once by Python's struct.pack("<4sHHIIQdd", b"MBKC", 1, 1, 1, 50, 2, 0.5, -2.0) and zlib.crc32.
TEST(Datagram, BytesAreThoseOfTheGuide) {
  const CommandDatagram command{1, 50, 2, {0.5, -2.0}, true, false, false};
  EXPECT_EQ(hex(encode(command)),
            "4d424b4301000100010000003200000002000000000000"
            "00000000000000e03f00000000000000c07bb74a78");
}

// ---- bridge/vectors.txt, to which the bridges in C, Python and MATLAB are held too

std::uint64_t whole(std::istream& words) {
  std::uint64_t value = 0;
  words >> value;
  return value;
}

/// Also nan and inf, which streams do not read.
double number(std::istream& words) {
  std::string word;
  words >> word;
  return std::strtod(word.c_str(), nullptr);
}

Eigen::Vector2d pair(std::istream& words) {
  const double first = number(words);
  return {first, number(words)};
}

CommandDatagram command_of(std::istream& words) {
  CommandDatagram d;
  const std::uint64_t flags = whole(words);
  d.enabled = (flags & 1U) != 0;
  d.greeting = (flags & 2U) != 0;
  d.lock_step = (flags & 4U) != 0;
  d.session = static_cast<std::uint32_t>(whole(words));
  d.watchdog = static_cast<std::uint32_t>(whole(words));
  d.sequence = whole(words);
  d.command = pair(words);
  return d;
}

StateDatagram state_of(std::istream& words) {
  StateDatagram d;
  d.version = static_cast<std::uint16_t>(whole(words));
  const std::uint64_t flags = whole(words);
  d.raw.stop = (flags & 1U) != 0;
  d.enabled = (flags & 2U) != 0;
  d.has_force = (flags & 4U) != 0;
  d.has_acceleration = (flags & 8U) != 0;
  d.watchdog_expired = (flags & 16U) != 0;
  d.drives_measure = (flags & 32U) != 0;
  d.session = static_cast<std::uint32_t>(whole(words));
  d.rejected = static_cast<std::uint32_t>(whole(words));
  d.raw.sequence = whole(words);
  d.answered = whole(words);
  d.raw.time = number(words);
  d.raw.encoder = pair(words);
  d.raw.force = pair(words);
  d.raw.acceleration = pair(words);
  d.measured = pair(words);
  d.fault = static_cast<std::uint32_t>(whole(words));
  return d;
}

std::vector<std::byte> bytes_of(const std::string& text) {
  std::vector<std::byte> bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    bytes.push_back(static_cast<std::byte>(std::stoul(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}

/// Packed and unpacked.
template <class Datagram>
void expect_vector(const Datagram& made, std::istream& words) {
  std::string bytes;
  words >> bytes;
  EXPECT_EQ(hex(encode(made)), bytes);
  Datagram came;
  ASSERT_EQ(decode(bytes_of(bytes), came), Refusal::none);
  EXPECT_EQ(hex(encode(came)), bytes);
}

void expect_refusal(std::istream& words) {
  const std::pair<const char*, Refusal> whys[] = {{"length", Refusal::length},
                                                  {"magic", Refusal::magic},
                                                  {"version", Refusal::version},
                                                  {"checksum", Refusal::checksum}};
  std::string kind, why, bytes;
  words >> kind >> why >> bytes;
  StateDatagram state;
  CommandDatagram command;
  const Refusal refusal = kind == "state" ? decode(bytes_of(bytes), state) : decode(bytes_of(bytes), command);
  for (const auto& [word, expected] : whys) {
    if (why == word) {
      EXPECT_EQ(refusal, expected);
      return;
    }
  }
  ADD_FAILURE() << "no refusal is called " << why;
}

TEST(Datagram, VectorsOfTheBridgesHold) {
  std::ifstream file(MBK_BRIDGE "/vectors.txt");
  std::string line;
  int commands = 0, states = 0, refusals = 0;
  while (std::getline(file, line)) {
    SCOPED_TRACE(line);
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "command") {
      ++commands;
      expect_vector(command_of(words), words);
    } else if (kind == "state") {
      ++states;
      expect_vector(state_of(words), words);
    } else if (kind == "refused") {
      ++refusals;
      expect_refusal(words);
    }
  }
  EXPECT_GE(commands, 5);
  EXPECT_GE(states, 5);
  EXPECT_GE(refusals, 15);
}

TEST(Datagram, EveryFlippedBitIsSeen) {
  const auto good = encode(some_state());
  StateDatagram came;
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    auto bad = good;
    bad[bit / 8] ^= std::byte{1} << (bit % 8);
    EXPECT_NE(decode(bad, came), Refusal::none) << "bit " << bit;
  }
}

TEST(Datagram, EveryOtherLengthIsRefused) {
  const auto good = encode(some_state());
  std::vector<std::byte> bytes(good.begin(), good.end());
  StateDatagram came;
  for (std::size_t length = 0; length < kStateBytes1; ++length) {
    EXPECT_NE(decode(std::span(bytes).first(length), came), Refusal::none) << length;
  }
  bytes.push_back(std::byte{0});
  EXPECT_EQ(decode(bytes, came), Refusal::length);
}

TEST(Datagram, AnotherKindOrVersionIsNamed) {
  StateDatagram came;
  EXPECT_EQ(decode(encode(CommandDatagram{}), came), Refusal::magic);
  auto newer = encode(some_state());
  newer[4] = std::byte{3};
  EXPECT_EQ(decode(newer, came), Refusal::version);
}

}  // namespace
}  // namespace mbk::drivers
