// Journals that were damaged at random: every whole block comes back, every loss is reported, and no row is wrong.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

#include "mbk/files/journal/test_journals.h"

namespace mbk::journal {
namespace {

using namespace testing_support;

constexpr std::size_t kPage = 4096;
constexpr unsigned kSeed = 20;

/// How many journals are damaged; MBK_DAMAGED_JOURNALS asks for more.
unsigned how_many() {
  const char* const asked = std::getenv("MBK_DAMAGED_JOURNALS");
  return asked != nullptr ? static_cast<unsigned>(std::strtoul(asked, nullptr, 10)) : 1500;
}

/// Does to a journal what disks, cables, power cuts and people do.
class Vandal {
 public:
  Vandal(unsigned seed, const std::vector<WholeBlock>& blocks, std::string other)
      : random_(seed), blocks_(blocks), other_(std::move(other)) {}

  std::string damage(std::string bytes) {
    did_.clear();
    for (std::size_t k = 1 + below(4); k > 0; --k) once(bytes);
    return bytes;
  }
  [[nodiscard]] const std::string& did() const { return did_; }

 private:
  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }
  const WholeBlock& any_block() { return blocks_[below(blocks_.size())]; }

  /// Where a block stands after what was done so far; nothing where it was cut off.
  std::string take(const std::string& bytes, const WholeBlock& block) {
    return block.at < bytes.size() ? bytes.substr(block.at, block.size) : std::string();
  }

  void once(std::string& bytes) {
    const std::size_t at = below(bytes.size());
    switch (below(12)) {
      case 0:
        say("bits flipped");
        for (std::size_t k = 1 + below(5); k > 0 && !bytes.empty(); --k) {
          char& one = bytes[below(bytes.size())];
          one = static_cast<char>(one ^ (1 << below(8)));
        }
        break;
      case 1: {
        say("block lost");
        const WholeBlock& block = any_block();
        if (block.at < bytes.size()) bytes.erase(block.at, block.size);
        break;
      }
      case 2: {
        say("block doubled");
        const WholeBlock &block = any_block(), &where = any_block();
        bytes.insert(std::min(where.at, bytes.size()), take(bytes, block));
        break;
      }
      case 3: {
        say("blocks swapped");
        const WholeBlock *one = &any_block(), *other = &any_block();
        if (one->at > other->at) std::swap(one, other);
        if (one == other || other->at + other->size > bytes.size()) break;
        const std::string first = take(bytes, *one), second = take(bytes, *other);
        const std::string between = bytes.substr(one->at + one->size, other->at - one->at - one->size);
        bytes.replace(one->at, other->at + other->size - one->at, second + between + first);
        break;
      }
      case 4: {
        say("block torn");
        const WholeBlock& block = any_block();
        const std::size_t from = block.at + below(block.size);
        if (from < bytes.size()) bytes.erase(from, below(block.at + block.size - from) + 1);
        break;
      }
      case 5:
        say("page zeroed");
        for (std::size_t k = at / kPage * kPage; k < std::min(bytes.size(), at / kPage * kPage + kPage); ++k) {
          bytes[k] = 0;
        }
        break;
      case 6: {
        say("pages swapped");
        const std::size_t pages = bytes.size() / kPage;
        if (pages < 2) break;
        const std::size_t one = below(pages) * kPage, other = below(pages) * kPage;
        for (std::size_t k = 0; k < kPage; ++k) std::swap(bytes[one + k], bytes[other + k]);
        break;
      }
      case 7:
        say("cut off");
        bytes.resize(bytes.size() - below(bytes.size() / 3 + 1));
        break;
      case 8: {
        say("noise inserted");
        std::string noise(below(3000) + 1, '\0');
        for (char& one : noise) one = static_cast<char>(random_());
        bytes.insert(at, noise);
        break;
      }
      case 9: {
        say("noise over it");
        const std::size_t end = std::min(bytes.size(), at + below(9000));
        for (std::size_t k = at; k < end; ++k) bytes[k] = static_cast<char>(random_());
        break;
      }
      case 10:
        say("zeros behind it");
        bytes.append(below(20000), '\0');
        break;
      default: {
        if (other_.empty()) break;
        say("page of another journal");
        const std::size_t page = at / kPage * kPage;
        if (page + kPage <= std::min(bytes.size(), other_.size())) {
          bytes.replace(page, kPage, other_, page, kPage);
        } else {
          bytes += other_.substr(0, 2 * kPage);
        }
      }
    }
  }
  void say(const char* what) { did_ += did_.empty() ? what : std::string(", ") + what; }

  std::mt19937_64 random_;
  const std::vector<WholeBlock>& blocks_;
  std::string other_, did_;
};

/// What a slow reader finds that knows the undamaged journal: a block is whole where its bytes stand somewhere.
struct Expected {
  std::map<std::uint64_t, Tick> ticks;
  std::uint64_t end = 0;
  bool any = false, header = false, ending = false;
};

Expected expected(const std::string& bytes, const std::string& whole, const std::vector<WholeBlock>& blocks,
                  bool second) {
  Expected found;
  for (const WholeBlock& block : blocks) {
    if (bytes.find(whole.substr(block.at, block.size)) == bytes.npos) continue;
    found.any = true;
    found.header = found.header || block.kind == 1;
    found.ending = found.ending || block.kind == 3;
    for (const Tick& tick : block.ticks) found.ticks[tick.number] = tick;
    if (second) found.end = std::max(found.end, block.next_tick);
  }
  if (!found.ticks.empty()) found.end = std::max(found.end, found.ticks.rbegin()->first + 1);
  return found;
}

std::vector<std::uint64_t> numbers(const std::vector<TickRange>& ranges) {
  std::vector<std::uint64_t> all;
  for (const TickRange& range : ranges) {
    for (std::uint64_t k = 0; k < range.count; ++k) all.push_back(range.first + k);
  }
  return all;
}

/// Row k of the recording is tick k, or NaN.
void check_rows(const Journal& journal, const std::vector<Tick>& written) {
  const auto recording = to_recording(journal);
  ASSERT_TRUE(recording) << recording.error().line();
  ASSERT_EQ(static_cast<std::uint64_t>(recording->samples()), journal.ticks.size() + journal.damage.ticks_lost());
  std::vector<bool> there(written.size(), false);
  for (const Tick& tick : journal.ticks) there[tick.number] = true;
  for (Index k = 0; k < recording->samples(); ++k) {
    const Tick& tick = written[static_cast<std::size_t>(k)];
    const double angle = recording->find("joint_2")->values[k], torque = recording->find("torque_1")->values[k];
    if (there[static_cast<std::size_t>(k)]) {
      ASSERT_EQ(recording->time[k], tick.time) << k;
      ASSERT_EQ(angle, tick.joint[1]) << k;
      ASSERT_EQ(torque, tick.torque[0]) << k;
    } else {
      ASSERT_NEAR(recording->time[k], tick.time, 1e-9) << k;
      for (const Channel& channel : recording->channels) ASSERT_TRUE(std::isnan(channel.values[k])) << channel.name;
    }
  }
  if (!journal.damage.lost.empty()) {
    EXPECT_EQ(recording->metadata.at("ticks_lost"), std::to_string(journal.damage.ticks_lost()));
    EXPECT_NE(recording->metadata.at("ended").find("ticks were lost"), std::string::npos);
  }
}

void try_journals(const std::string& whole, const std::string& other, int ticks, unsigned count) {
  const bool second = whole.starts_with("MBKJRNL2");
  const auto blocks = blocks_of(whole);
  const auto written = test_ticks(0, ticks);
  Vandal vandal(kSeed, blocks, other);
  unsigned incomplete = 0, unreadable = 0;
  for (unsigned k = 0; k < count; ++k) {
    const std::string bytes = vandal.damage(whole);
    SCOPED_TRACE(::testing::Message() << "journal " << k << ": " << vandal.did());
    const Expected should = expected(bytes, whole, blocks, second);
    const auto journal = decode_text(bytes);
    if (!should.any) {
      EXPECT_FALSE(journal);
      ++unreadable;
      continue;
    }
    ASSERT_TRUE(journal) << journal.error().line();
    std::vector<Tick> kept;
    std::vector<std::uint64_t> missing;
    for (std::uint64_t number = 0; number < should.end; ++number) {
      const auto found = should.ticks.find(number);
      if (found != should.ticks.end()) kept.push_back(found->second);
      if (found == should.ticks.end()) missing.push_back(number);
    }
    ASSERT_TRUE(identical(journal->ticks, kept)) << journal->ticks.size() << " instead of " << kept.size();
    ASSERT_EQ(numbers(journal->damage.lost), missing);
    EXPECT_EQ(journal->damage.header, !should.header);
    EXPECT_EQ(journal->ending.has_value(), should.ending);
    // Where nothing is said to be wrong, the journal is what was written, as far as it goes.
    if (!journal->damage.any()) {
      EXPECT_TRUE(whole.starts_with(bytes));
      EXPECT_TRUE(journal->ending || bytes.size() < whole.size());
    }
    if (should.ticks.size() < written.size()) {
      EXPECT_TRUE(journal->incomplete() || !journal->ending) << "a loss that is not said";
      ++incomplete;
    }
    if (!kept.empty()) check_rows(*journal, written);
    if (::testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GT(incomplete, count / 3);
  EXPECT_LT(unreadable, count / 20);
}

TEST(DamagedJournals, GiveEveryWholeBlockAndSayEveryLoss) {
  const std::string stale = journal_bytes(25, 40);
  try_journals(journal_bytes(20, 40), stale, 800, how_many());
}

TEST(DamagedJournals, WithHeadersInBetween) {
  try_journals(journal_bytes(140, 5), "", 700, how_many() / 3);
}

/// A block that was lost before the ending is only seen by the phase of the last tick that is left.
TEST(DamagedJournals, OfFormat1GiveEveryWholeBlockToo) {
  try_journals(journal1_bytes(20, 40), "", 800, how_many());
}

}  // namespace
}  // namespace mbk::journal
