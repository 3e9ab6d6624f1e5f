#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/base/system/files.h"
#include "mbk/files/journal/blocks.h"
#include "mbk/files/journal/journal.h"

namespace mbk::journal {
namespace {

using Json = nlohmann::json;
using Bytes = std::span<const std::byte>;

constexpr std::uint64_t kLargestNumber = std::uint64_t{1} << 48U;  // of a tick: 8900 years at 1 kHz

/// CRC-32 of any part of the bytes, from those of their beginnings: crc(AB) = x^{8|B|}·crc(A) + crc(B) modulo the
/// polynomial. However many parts are asked for, and however they overlap, each byte is read a bounded number of times
/// for each.
class Checksums {
 public:
  explicit Checksums(Bytes bytes) : bytes_(bytes) {}

  std::uint32_t of(std::size_t from, std::size_t to) {
    return to_of(to) ^ static_cast<std::uint32_t>(crc32_combine(to_of(from), 0, static_cast<z_off_t>(to - from)));
  }

 private:
  static constexpr std::size_t kStep = 256;

  std::uint32_t to_of(std::size_t end) {
    while (beginnings_.size() <= end / kStep) {
      beginnings_.push_back(append(beginnings_.back(), (beginnings_.size() - 1) * kStep, kStep));
    }
    return append(beginnings_[end / kStep], end - end % kStep, end % kStep);
  }
  [[nodiscard]] std::uint32_t append(std::uint32_t sum, std::size_t from, std::size_t count) const {
    const auto* const bytes = reinterpret_cast<const Bytef*>(bytes_.data() + from);
    return static_cast<std::uint32_t>(crc32(sum, bytes, static_cast<uInt>(count)));
  }

  Bytes bytes_;
  std::vector<std::uint32_t> beginnings_ = {static_cast<std::uint32_t>(crc32(0, nullptr, 0))};
};

/// A block whose checksum is right.
struct Block {
  std::size_t at = 0;       ///< of its payload
  std::uint32_t bytes = 0;  ///< of its payload
  std::uint32_t kind = 0;
  std::uint64_t trial = 0;
  std::uint64_t order = 0;  ///< number of the block; in format 1 by the ticks' own numbers
  std::uint64_t next_tick = 0;
};

template <class Value>
Value value_at(Bytes bytes, std::size_t at) {
  Value value;
  std::memcpy(&value, bytes.data() + at, sizeof(value));
  return value;
}

bool possible(std::uint32_t kind, std::uint32_t bytes, std::size_t room) {
  return kind >= kHeader && kind <= kEnding && bytes > 0 && bytes <= kLargestBlock && bytes <= room &&
         (kind != kTicks || bytes % sizeof(Tick) == 0);
}

/// Whether the block that begins at `at` is whole.
bool take_block(Bytes bytes, std::size_t at, Checksums& checksums, Block& block) {
  const auto head = value_at<BlockHead>(bytes, at);
  block.at = at + sizeof(head);
  if (!possible(head.kind, head.bytes, bytes.size() - block.at) || head.next_tick > kLargestNumber) return false;
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(&head), offsetof(BlockHead, checksum));
  const auto of_payload = checksums.of(block.at, block.at + head.bytes);
  if (crc32_combine(sum, of_payload, static_cast<z_off_t>(head.bytes)) != head.checksum) return false;
  block.bytes = head.bytes;
  block.kind = head.kind;
  block.trial = head.trial;
  block.order = head.number;
  block.next_tick = head.next_tick;
  return true;
}

std::vector<Block> blocks_of(Bytes bytes, Checksums& checksums) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string_view mark(BlockHead::kMark.data(), BlockHead::kMark.size());
  std::vector<Block> blocks;
  Block block;
  for (std::size_t at = text.find(mark); at != text.npos && bytes.size() - at > sizeof(BlockHead);) {
    const bool whole = take_block(bytes, at, checksums, block);
    if (whole) blocks.push_back(block);
    at = text.find(mark, whole ? block.at + block.bytes : at + 1);
  }
  return blocks;
}

/// The same in format 1, whose heads have no mark.
bool take_block1(Bytes bytes, std::size_t at, Checksums& checksums, Block& block) {
  const auto head = value_at<BlockHead1>(bytes, at);
  block.at = at + sizeof(head);
  if (head.zero != 0 || !possible(head.kind, head.bytes, bytes.size() - block.at)) return false;
  const auto sum = crc32(0, reinterpret_cast<const Bytef*>(&head), offsetof(BlockHead1, checksum));
  const auto of_payload = checksums.of(block.at, block.at + head.bytes);
  if (crc32_combine(sum, of_payload, static_cast<z_off_t>(head.bytes)) != head.checksum) return false;
  block.bytes = head.bytes;
  block.kind = head.kind;
  block.next_tick = head.kind == kTicks ? value_at<Tick>(bytes, block.at).number : 0;
  block.order = head.kind == kHeader  ? 0
                : head.kind == kTicks ? std::min(block.next_tick, kLargestNumber) + 1
                                      : std::numeric_limits<std::uint64_t>::max();
  return true;
}

std::vector<Block> blocks_of1(Bytes bytes, Checksums& checksums) {
  std::vector<Block> blocks;
  Block block;
  for (std::size_t at = 0; at + sizeof(BlockHead1) < bytes.size();) {
    // Most places are dismissed by their first word.
    if (value_at<std::uint32_t>(bytes, at) - kHeader <= kEnding - kHeader && take_block1(bytes, at, checksums, block)) {
      blocks.push_back(block);
      at = block.at + block.bytes;
    } else {
      ++at;
    }
  }
  return blocks;
}

/// Ticks of an intact block that the program does not write are rejected.
bool numbers_rise(Bytes bytes, const Block& block) {
  std::uint64_t next = block.next_tick;
  for (std::size_t at = block.at; at < block.at + block.bytes; at += sizeof(Tick)) {
    const auto number = value_at<Tick>(bytes, at).number;
    if (number < next || number >= kLargestNumber || (at == block.at && number != next)) return false;
    next = number + 1;
  }
  return true;
}

/// Whose blocks they are: what most of them say, and of as many the first in the file.
std::uint64_t trial_of(const std::vector<Block>& blocks) {
  std::vector<std::uint64_t> trials;
  for (const Block& block : blocks) trials.push_back(block.trial);
  std::ranges::sort(trials);
  const auto count = [&](const Block& block) { return std::ranges::equal_range(trials, block.trial).size(); };
  return std::ranges::max_element(blocks, {}, count)->trial;
}

/// Puts the blocks into their order, each once, and says what was wrong with it.
void put_in_order(Bytes bytes, std::vector<Block>& blocks, Damage& damage) {
  std::uint64_t last = 0;
  std::ranges::sort(blocks, {}, [](const Block& block) { return std::tuple(block.order, block.at); });
  const auto again = [&](const Block& one, const Block& other) {
    return one.order == other.order && one.kind == other.kind && one.bytes == other.bytes &&
           std::memcmp(bytes.data() + one.at, bytes.data() + other.at, one.bytes) == 0;
  };
  const auto rest = std::ranges::unique(blocks, again);
  damage.doubled = rest.size();
  blocks.erase(rest.begin(), rest.end());
  std::vector<std::pair<std::size_t, std::uint64_t>> as_they_stand;
  for (const Block& block : blocks) as_they_stand.emplace_back(block.at, block.order);
  std::ranges::sort(as_they_stand);
  for (const auto& [at, order] : as_they_stand) {
    if (order < last) ++damage.moved;
    last = order;
  }
}

/// Every tick of the blocks, by number and each once.
std::vector<Tick> ticks_of(Bytes bytes, const std::vector<Block>& blocks, Damage& damage) {
  std::size_t count = 0;
  for (const Block& block : blocks) count += block.kind == kTicks ? block.bytes / sizeof(Tick) : 0;
  std::vector<Tick> ticks(count);
  std::size_t taken = 0;
  for (const Block& block : blocks) {
    if (block.kind != kTicks) continue;
    std::memcpy(ticks.data() + taken, bytes.data() + block.at, block.bytes);
    taken += block.bytes / sizeof(Tick);
  }
  const auto not_after = [](const Tick& one, const Tick& other) { return one.number >= other.number; };
  if (std::ranges::adjacent_find(ticks, not_after) == ticks.end()) return ticks;
  std::ranges::sort(ticks, {}, &Tick::number);
  const auto as_written = [](const Tick& tick) { return std::as_bytes(std::span(&tick, 1)); };
  std::size_t kept = 0;
  for (std::size_t begin = 0, end = 0; begin < ticks.size(); begin = end) {
    bool alike = true;
    for (end = begin + 1; end < ticks.size() && ticks[end].number == ticks[begin].number; ++end) {
      alike = alike && std::ranges::equal(as_written(ticks[end]), as_written(ticks[begin]));
    }
    if (alike) ticks[kept++] = ticks[begin];
    if (!alike) ++damage.contradictory;  // nothing says which of them is right
  }
  ticks.resize(kept);
  return ticks;
}

std::vector<TickRange> missing(const std::vector<Tick>& ticks, std::uint64_t end) {
  std::vector<TickRange> ranges;
  std::uint64_t next = 0;
  for (const Tick& tick : ticks) {
    if (tick.number > next) ranges.push_back({next, tick.number - next});
    next = tick.number + 1;
  }
  if (end > next) ranges.push_back({next, end - next});
  return ranges;
}

Header header_of(const Json& json) {
  Header header;
  for (const auto& [key, value] : json.at("metadata").get<std::map<std::string, std::string>>()) {
    header.metadata[printable(key)] = printable(value);
  }
  header.geometry.d1 = json.at("d1_m").get<double>();
  header.geometry.d2 = json.at("d2_m").get<double>();
  header.rate = json.at("rate_hz").get<double>();
  header.reference_unit = printable(json.at("reference_unit").get<std::string>());
  header.has_force = json.at("has_force").get<bool>();
  header.has_acceleration = json.at("has_acceleration").get<bool>();
  header.force_latency = json.at("force_latency_ticks").get<int>();
  if (json.at("tick_bytes").get<std::size_t>() != sizeof(Tick))
    throw std::runtime_error("ticks of a different version");
  if (header.force_latency < 0) throw std::runtime_error("a negative force latency");
  if (!(header.rate > 0.0)) throw std::runtime_error("a rate that is not positive");
  const auto readers = value_of<Readers>(json.value("readable_by", std::string()));
  if (readers) header.readers = *readers;
  for (const Json& event : json.at("events")) {
    header.events.push_back({event.at("time").get<double>(), printable(event.at("name").get<std::string>()),
                             event.at("value").get<double>()});
  }
  return header;
}

Ending ending_of(const Json& json) {
  Ending ending;
  const auto word = printable(json.at("how").get<std::string>());
  ending.how = value_of<Ending::How>(word).value_or(Ending::How::other);
  ending.detail = printable(json.at("detail").get<std::string>());
  ending.dropped = json.at("dropped").get<std::uint64_t>();
  ending.overruns = json.at("overruns").get<std::uint64_t>();
  ending.ticks = json.value("ticks", std::uint64_t{0});
  ending.trip = printable(json.value("trip", std::string()));
  ending.motors = printable(json.value("motors", std::string()));
  if (ending.how == Ending::How::other) ending.other = word;
  if (ending.ticks > kLargestNumber) throw std::runtime_error("an impossible number of ticks");
  return ending;
}

/// Header and ending.   @throws  what JSON throws at a text that is none
void read_texts(Bytes bytes, const std::vector<Block>& blocks, Journal& journal) {
  const auto json = [&](const Block& block) {
    const auto* const text = reinterpret_cast<const char*>(bytes.data() + block.at);
    return Json::parse(text, text + block.bytes);
  };
  const auto first = std::ranges::find(blocks, kHeader, &Block::kind);
  journal.damage.header = first == blocks.end();
  if (first != blocks.end()) journal.header = header_of(json(*first));
  const auto last = std::find_if(blocks.rbegin(), blocks.rend(), [](const Block& b) { return b.kind == kEnding; });
  if (last != blocks.rend()) journal.ending = ending_of(json(*last));
}

/// Whether a tick is a trial's last one, where nothing says how many there are (format 1): the sequence is done, and
/// after a stop the drives are off.
bool is_last(const Tick& tick) {
  constexpr std::uint8_t kDone = 6;  // control::Phase::done
  return tick.phase == kDone && (tick.reason == 0 || tick.enabled == 0);
}

std::string range_text(const TickRange& range) {
  return range.count == 1 ? std::to_string(range.first)
                          : fmt::format("{} to {}", range.first, range.first + range.count - 1);
}

std::string plural(std::uint64_t count, std::string_view one, std::string_view more) {
  return fmt::format("{} {}", count, count == 1 ? one : more);
}

}  // namespace

std::string_view Ending::word() const {
  return how == How::other ? std::string_view(other) : word_of(how);
}

std::uint64_t Damage::ticks_lost() const {
  std::uint64_t sum = 0;
  for (const TickRange& range : lost) sum += range.count;
  return sum;
}

bool Damage::any() const {
  return !lost.empty() || bytes > 0 || blocks > 0 || doubled > 0 || moved > 0 || foreign > 0 || contradictory > 0 ||
         header;
}

std::string Damage::gaps() const {
  constexpr std::size_t kShown = 20;
  std::string text;
  for (std::size_t k = 0; k < lost.size() && k < kShown; ++k) text += (k > 0 ? ", " : "") + range_text(lost[k]);
  if (lost.size() > kShown) text += fmt::format(" and {} more", lost.size() - kShown);
  return text;
}

std::vector<std::string> Damage::sentences() const {
  std::vector<std::string> said;
  const auto say = [&](std::uint64_t count, std::string_view one, std::string_view more) {
    if (count > 0) said.push_back(plural(count, one, more));
  };
  if (!lost.empty()) said.push_back(plural(ticks_lost(), "tick is", "ticks are") + " missing: " + gaps());
  say(bytes, "byte belongs to no complete block", "bytes belong to no complete block");
  say(blocks, "block is missing", "blocks are missing");
  say(doubled, "duplicate block was ignored", "duplicate blocks were ignored");
  say(moved, "block was out of order and was reordered", "blocks were out of order and were reordered");
  say(foreign, "block of another trial was ignored", "blocks of another trial were ignored");
  say(contradictory, "tick has two conflicting versions and was ignored",
      "ticks have two conflicting versions and were ignored");
  if (header) {
    said.emplace_back(
        "no header is complete: robot, participant, unit of the reference and latency of the force are unknown");
  }
  return said;
}

bool Journal::incomplete() const {
  if (!damage.lost.empty() || damage.header) return true;
  if (!ending) return damage.bytes > 0;
  return ending->ticks == 0 && !ticks.empty() && !is_last(ticks.back());
}

Result<Journal> decode(Bytes bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const bool named = text.starts_with(kMagic) || text.starts_with(kMagic1);
  Checksums checksums(bytes);
  auto blocks = blocks_of(bytes, checksums);
  const bool second = !blocks.empty();
  if (!second) blocks = blocks_of1(bytes, checksums);
  Journal journal;
  Damage& damage = journal.damage;
  damage.bytes = bytes.size() - (named ? kMagic.size() : 0);
  const auto strange = [&](const Block& block) { return block.kind == kTicks && !numbers_rise(bytes, block); };
  std::erase_if(blocks, strange);
  for (const Block& block : blocks) damage.bytes -= block.bytes + (second ? sizeof(BlockHead) : sizeof(BlockHead1));
  if (bytes.empty()) return bad_data("the journal is empty", "nothing was recorded");
  if (blocks.empty()) {
    return named ? bad_data("the journal contains neither a complete header nor any complete block",
                            "nothing was recorded yet")
                 : bad_data("the file is not an mbk journal", "name the journal beside the recording: NAME.h5.journal");
  }
  const std::uint64_t trial = trial_of(blocks);
  damage.foreign = std::erase_if(blocks, [&](const Block& block) { return block.trial != trial; });
  put_in_order(bytes, blocks, damage);
  const auto headers = std::ranges::count(blocks, kHeader, &Block::kind);
  if (!second && headers > 1) {
    return bad_data("the journal contains the headers of two trials, and its format does not assign ticks to trials",
                    "use a backup copy");
  }
  if (second) {
    damage.blocks = blocks.back().order + 1;
    for (std::size_t k = 0; k < blocks.size(); ++k) {
      damage.blocks -= k == 0 || blocks[k].order != blocks[k - 1].order ? 1 : 0;
    }
  }
  try {
    read_texts(bytes, blocks, journal);
  } catch (const std::exception& error) {
    return bad_data(fmt::format("the journal cannot be decoded: {}", error.what()),
                    "it may have been written by another version of mbk");
  }
  journal.ticks = ticks_of(bytes, blocks, damage);
  std::uint64_t end = journal.ending ? journal.ending->ticks : 0;
  for (const Block& block : blocks) end = std::max(end, block.next_tick);
  damage.lost = missing(journal.ticks, end);
  return journal;
}

void Journal::end_with(const Ending& known) {
  ending = known;
  const std::uint64_t end = damage.lost.empty() ? 0 : damage.lost.back().first + damage.lost.back().count;
  damage.lost = missing(ticks, std::max(end, known.ticks));
}

bool is_journal(const std::filesystem::path& file) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(file, code)) return false;  // the writer of a pipe might never come
  std::ifstream in(file, std::ios::binary);
  std::array<char, kMagic.size()> begin{};
  in.read(begin.data(), begin.size());
  const std::string_view found(begin.data(), static_cast<std::size_t>(in.gcount()));
  return found == kMagic || found == kMagic1 || (in.is_open() && file.extension() == ".journal");
}

Result<Journal> read(const std::filesystem::path& file) {
  const auto cannot = [&](int code) {
    return bad_data(fmt::format("cannot be read: {}", std::strerror(code)), "check the name and its permissions",
                    file.string());
  };
  const system::OpenFile opened = system::open_to_read(file);
  const auto status = opened ? system::status_of(opened) : std::nullopt;
  using Kind = system::FileStatus::Kind;
  if (!status) return cannot(errno);
  if (status->kind != Kind::regular) return cannot(status->kind == Kind::folder ? EISDIR : EINVAL);
  const auto size = static_cast<std::size_t>(status->size);
  const auto bytes = std::make_unique_for_overwrite<std::byte[]>(size);
  std::size_t done = 0;
  while (done < size) {  // as far as it goes: it may be shorter by now
    const auto got = system::read_some(opened.number(), bytes.get() + done, size - done);
    if (got < 0) return cannot(errno);
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  auto journal = decode({bytes.get(), done});
  if (!journal) return tl::unexpected(journal.error().in(file.string()));
  return journal;
}

}  // namespace mbk::journal
