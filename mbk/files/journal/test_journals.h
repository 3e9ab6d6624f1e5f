#pragma once

// For tests: journals of both formats, and where their blocks are.

#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "mbk/files/journal/journal.h"

namespace mbk::journal::testing_support {

inline std::string file_bytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

inline Header test_header() {
  Header header;
  header.metadata = {{"participant", "7"}, {"condition", "relaxed, \"quoted\""}};
  header.events = {{0.010, "onset", 1.5}, {99.0, "offset", 0.0}};
  return header;
}

/// Ticks that are all different in every member that is looked at; the perturbation begins with tick 100.
inline std::vector<Tick> test_ticks(int from, int to) {
  std::vector<Tick> ticks;
  for (int i = from; i < to; ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    std::normal_distribution<double> noise(0.0, 1.0);
    Tick tick;
    tick.number = static_cast<std::uint64_t>(i);
    tick.time = 1e-3 * i;
    tick.perturbation_time = i < 100 ? -1.0 : 1e-3 * (i - 100);
    tick.joint = {0.8 + 1e-4 * i, 0.5 + 1e-3 * noise(random)};
    tick.force = {static_cast<double>(i), noise(random)};
    tick.acceleration = {noise(random), noise(random)};
    tick.torque = {noise(random), noise(random)};
    tick.sequence = random();
    ticks.push_back(tick);
  }
  return ticks;
}

/// A journal of so many blocks of `per_block` ticks.
inline std::string journal_bytes(int blocks, int per_block = 50, bool end = true) {
  const auto file = std::filesystem::temp_directory_path() / ("mbk_journal_bytes_" + std::to_string(::getpid()));
  std::filesystem::remove(file);
  {
    auto writer = Writer::create(file, test_header(), 0).value();
    for (int b = 0; b < blocks; ++b) {
      EXPECT_TRUE(writer.append(test_ticks(per_block * b, per_block * b + per_block)));
    }
    Ending ending{Ending::How::completed, "", 0, 2, static_cast<std::uint64_t>(blocks * per_block)};
    if (end) {
      EXPECT_TRUE(writer.end(ending));
    }
  }
  std::string bytes = file_bytes(file);
  std::filesystem::remove(file);
  return bytes;
}

/// The same as mbk 0.x wrote it.
inline std::string journal1_bytes(int blocks, int per_block = 50, bool end = true) {
  std::string bytes = "MBKJRNL1";
  const auto add = [&](std::uint32_t kind, const std::string& payload) {
    std::uint32_t head[4] = {kind, static_cast<std::uint32_t>(payload.size()), 0, 0};
    auto sum = crc32(0, reinterpret_cast<const Bytef*>(head), 8);
    sum = crc32(sum, reinterpret_cast<const Bytef*>(payload.data()), static_cast<uInt>(payload.size()));
    head[2] = static_cast<std::uint32_t>(sum);
    bytes.append(reinterpret_cast<const char*>(head), sizeof(head)).append(payload);
  };
  add(1, R"({"metadata":{"participant":"7"},"d1_m":0.34,"d2_m":0.27,"rate_hz":1000.0,"reference_unit":"m",)"
         R"("has_force":true,"has_acceleration":true,"force_latency_ticks":0,"tick_bytes":144,"events":[]})");
  for (int b = 0; b < blocks; ++b) {
    auto ticks = test_ticks(per_block * b, per_block * b + per_block);
    if (b + 1 == blocks) ticks.back().phase = 6;  // done
    add(2, {reinterpret_cast<const char*>(ticks.data()), ticks.size() * sizeof(Tick)});
  }
  if (end) add(3, R"({"how":"completed","detail":"","dropped":0,"overruns":2})");
  return bytes;
}

/// A block as a string of bytes, and what it holds.
struct WholeBlock {
  std::size_t at = 0, size = 0;
  std::uint32_t kind = 0;
  std::vector<Tick> ticks;
  std::uint64_t next_tick = 0;  ///< format 2
};

/// The blocks of an undamaged journal, one after the other as their lengths say.
inline std::vector<WholeBlock> blocks_of(const std::string& bytes) {
  const bool second = bytes.starts_with("MBKJRNL2");
  const std::size_t head = second ? 40 : 16;
  std::vector<WholeBlock> blocks;
  for (std::size_t at = 8; at < bytes.size();) {
    WholeBlock block;
    std::uint32_t payload = 0;
    std::memcpy(&block.kind, bytes.data() + at + (second ? 24 : 0), 4);
    std::memcpy(&payload, bytes.data() + at + (second ? 28 : 4), 4);
    if (second) std::memcpy(&block.next_tick, bytes.data() + at + 16, 8);
    block.at = at;
    block.size = head + payload;
    if (block.kind == 2) {
      block.ticks.resize(payload / sizeof(Tick));
      std::memcpy(block.ticks.data(), bytes.data() + at + head, payload);
    }
    at += block.size;
    blocks.push_back(std::move(block));
  }
  return blocks;
}

inline Result<Journal> decode_text(const std::string& bytes) {
  return decode(std::as_bytes(std::span(bytes.data(), bytes.size())));
}

inline bool identical(const std::vector<Tick>& one, const std::vector<Tick>& other) {
  return one.size() == other.size() &&
         (one.empty() || std::memcmp(one.data(), other.data(), one.size() * sizeof(Tick)) == 0);
}

}  // namespace mbk::journal::testing_support
