// Damaged journals of sessions: read in bounded time and memory, with increasing tick numbers, each tick once; and a
// second time with corrected checksums, so that damage passes them.

#include <unistd.h>
#include <zlib.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "fuzz/fuzz.h"
#include "mbk/base/core/printable.h"
#include "mbk/files/journal/blocks.h"
#include "mbk/files/journal/journal.h"

namespace mbk::fuzz {
namespace {

using journal::BlockHead;
using journal::BlockHead1;
using journal::Tick;

std::vector<Tick> ticks(std::uint64_t from, std::uint64_t to) {
  std::vector<Tick> made(to - from);
  for (Tick& tick : made) {
    tick.number = from++;
    tick.time = 1e-3 * static_cast<double>(tick.number);
    tick.perturbation_time = tick.number < 3 ? -1.0 : tick.time;
  }
  return made;
}

std::string written_journal() {
  const auto file = std::filesystem::temp_directory_path() / ("mbk_journal_fuzz_" + std::to_string(::getpid()));
  std::filesystem::remove(file);
  journal::Header header;
  header.metadata = {{"participant", "7"}};
  header.events = {{0.001, "onset", 1.0}};
  header.force_latency = 1;
  auto writer = journal::Writer::create(file, header, 0).value();
  for (std::uint64_t k = 0; k < 9; k += 3) require(writer.append(ticks(k, k + 3)).has_value(), "a journal is written");
  require(writer.end({mbk::journal::Ending::How::completed, "", 0, 0, 9}).has_value(), "a journal is ended");
  std::ifstream in(file, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  std::filesystem::remove(file);
  return bytes;
}

/// The checksum of a head up to its checksum field, and of the payload.
template <class Head>
void mend(std::string& bytes, std::size_t at) {
  Head head;
  std::memcpy(&head, bytes.data() + at, sizeof(head));
  const std::size_t payload = at + sizeof(head);
  if (head.bytes > bytes.size() - payload) return;
  auto sum = crc32(0, reinterpret_cast<const Bytef*>(&head), offsetof(Head, checksum));
  sum = crc32(sum, reinterpret_cast<const Bytef*>(bytes.data() + payload), head.bytes);
  head.checksum = static_cast<std::uint32_t>(sum);
  std::memcpy(bytes.data() + at, &head, sizeof(head));
}

/// From the end, so that a head within a payload is corrected before the checksum of that payload.
std::string with_right_checksums(std::string bytes) {
  const std::string_view mark(BlockHead::kMark.data(), BlockHead::kMark.size());
  for (std::size_t end = bytes.size(); end >= sizeof(BlockHead1); --end) {
    const std::size_t at = end - sizeof(BlockHead1);
    if (bytes.compare(at, mark.size(), mark) == 0 && bytes.size() - at >= sizeof(BlockHead)) mend<BlockHead>(bytes, at);
    BlockHead1 head;
    std::memcpy(&head, bytes.data() + at, sizeof(head));
    if (head.kind >= 1 && head.kind <= 3 && head.zero == 0 && head.bytes > 0) mend<BlockHead1>(bytes, at);
  }
  return bytes;
}

std::string format1_journal() {
  std::string bytes(journal::kMagic1);
  const auto add = [&](std::uint32_t kind, std::string_view payload) {
    const BlockHead1 head{kind, static_cast<std::uint32_t>(payload.size()), 0, 0};
    bytes.append(reinterpret_cast<const char*>(&head), sizeof(head)).append(payload);
  };
  add(journal::kHeader, R"({"metadata":{},"d1_m":0.3,"d2_m":0.3,"rate_hz":1000,"reference_unit":"N","has_force":true,)"
                        R"("has_acceleration":false,"force_latency_ticks":0,"tick_bytes":144,"events":[]})");
  const auto some = ticks(0, 4);
  add(journal::kTicks, {reinterpret_cast<const char*>(some.data()), some.size() * sizeof(Tick)});
  add(journal::kEnding, R"({"how":"safety stop","detail":"d","dropped":1,"overruns":0})");
  return with_right_checksums(bytes);
}

void check(std::string_view bytes) {
  const auto read = journal::decode(std::as_bytes(std::span(bytes.data(), bytes.size())));
  if (!read) return require_error(read.error());
  require(read->ticks.size() <= bytes.size() / sizeof(Tick), "there are not more ticks than fit");
  std::uint64_t next = 0;
  for (const Tick& tick : read->ticks) {
    require(tick.number >= next, "numbers increase");
    next = tick.number + 1;
  }
  require(read->damage.bytes <= bytes.size(), "not more bytes are damaged than exist");
  require(read->damage.any() || !read->incomplete() || read->ending, "an incomplete journal is reported");
  for (const std::string& sentence : read->damage.sentences()) require_line(sentence, "the description of the damage");
  const auto recording = journal::to_recording(*read);
  if (!recording) return require_error(recording.error());
  const auto rows = static_cast<std::size_t>(recording->samples());
  require(rows >= read->ticks.size(), "every tick is a row");
  require(rows <= 101 * read->ticks.size() + 100'000, "rows are bounded by the ticks");
  for (const Channel& channel : recording->channels) {
    require(channel.values.size() == recording->samples(), "every channel is as long as the time");
  }
  for (const auto& [key, value] : recording->metadata) {
    require(printable(key) == key && printable(value) == value, "metadata are lines of text");
  }
}

}  // namespace

std::vector<std::string> seeds() {
  return {written_journal(), format1_journal()};
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(mbk::fuzz::text_of(data, size));
  mbk::fuzz::check(bytes);
  mbk::fuzz::check(mbk::fuzz::with_right_checksums(bytes));
  return 0;
}
