#include "mbk/files/journal/journal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "mbk/files/journal/test_journals.h"

namespace mbk::journal {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;

class JournalFile : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              (std::string("mbk_journal_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    file_ = folder_ / "trial.h5.journal";
  }
  void TearDown() override { fs::remove_all(folder_); }

  static Header header() { return test_header(); }
  static std::vector<Tick> ticks(int from, int to) { return test_ticks(from, to); }

  void write(int blocks, bool end) {
    auto writer = Writer::create(file_, header(), 1000);
    ASSERT_TRUE(writer) << writer.error().line();
    for (int b = 0; b < blocks; ++b) ASSERT_TRUE(writer->append(ticks(50 * b, 50 * b + 50)));
    if (end) {
      ASSERT_TRUE(writer->end({Ending::How::completed, "", 3, 2, static_cast<std::uint64_t>(50 * blocks)}));
    }
  }

  std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  void set_bytes(const std::string& bytes) const { std::ofstream(file_, std::ios::binary | std::ios::trunc) << bytes; }

  fs::path folder_, file_;
};

TEST_F(JournalFile, ComesBackAsItWasWritten) {
  write(5, true);
  const auto journal = read(file_);
  ASSERT_TRUE(journal) << journal.error().line();
  EXPECT_EQ(journal->header.metadata, header().metadata);
  ASSERT_EQ(journal->ticks.size(), 250U);
  EXPECT_EQ(journal->ticks[123].force[0], 123.0);
  ASSERT_TRUE(journal->ending);
  EXPECT_EQ(journal->ending->how, Ending::How::completed);
  EXPECT_EQ(journal->ending->dropped, 3U);
  EXPECT_FALSE(journal->damage.any());
}

TEST_F(JournalFile, IsNeverOverwritten) {
  write(1, false);
  const auto second = Writer::create(file_, header(), 1000);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::usage);
  EXPECT_NE(second.error().line().find("mbk recover"), std::string::npos);
  EXPECT_EQ(read(file_)->ticks.size(), 50U);
}

TEST_F(JournalFile, CutOffAnywhereGivesEveryWholeBlock) {
  const std::string whole = journal_bytes(4);
  const auto blocks = blocks_of(whole);
  for (std::size_t length = blocks[1].at; length < whole.size(); length += 37) {
    std::size_t ticks = 0;
    for (const WholeBlock& block : blocks) ticks += block.at + block.size <= length ? block.ticks.size() : 0;
    const auto journal = decode_text(whole.substr(0, length));
    ASSERT_TRUE(journal) << length;
    EXPECT_EQ(journal->ticks.size(), ticks) << length;
    EXPECT_FALSE(journal->ending);
  }
}

TEST_F(JournalFile, ABitThatFlippedCostsItsBlockAndNoOther) {
  for (std::string spoilt : {journal_bytes(4), journal1_bytes(4)}) {
    const WholeBlock second = blocks_of(spoilt)[2];
    char& bit = spoilt[second.at + 1000];
    bit = static_cast<char>(bit ^ 0x10);
    const auto journal = decode_text(spoilt);
    ASSERT_TRUE(journal) << journal.error().line();
    EXPECT_EQ(journal->ticks.size(), 150U);
    ASSERT_EQ(journal->damage.lost.size(), 1U);
    EXPECT_EQ(journal->damage.lost[0].first, 50U);
    EXPECT_EQ(journal->damage.lost[0].count, 50U);
    EXPECT_EQ(journal->damage.bytes, second.size);
    EXPECT_TRUE(journal->ending);
    EXPECT_TRUE(journal->incomplete());
    EXPECT_EQ(journal->ended(), "completed, but 50 of 200 ticks were lost");
  }
}

TEST_F(JournalFile, ALostTailIsKnownByTheEnding) {
  std::string bytes = journal_bytes(4);
  const auto blocks = blocks_of(bytes);
  bytes.erase(blocks[4].at, blocks[4].size);
  const auto journal = decode_text(bytes);
  ASSERT_TRUE(journal);
  EXPECT_EQ(journal->ended(), "completed, but 50 of 200 ticks were lost");
  EXPECT_EQ(journal->damage.blocks, 1U);
  EXPECT_EQ(journal->damage.bytes, 0U);
  EXPECT_EQ(to_recording(*journal)->samples(), 200);
}

TEST_F(JournalFile, WhoKnowsTheEndingKnowsTheTail) {
  std::string bytes = journal_bytes(4);
  bytes.resize(blocks_of(bytes)[4].at + 100);
  auto journal = decode_text(bytes);
  ASSERT_TRUE(journal);
  EXPECT_TRUE(journal->incomplete());
  EXPECT_TRUE(journal->damage.lost.empty());
  journal->end_with({Ending::How::completed, "", 0, 0, 200});
  EXPECT_EQ(journal->ended(), "completed, but 50 of 200 ticks were lost");
}

TEST_F(JournalFile, BlocksThatAreDoubledOrMovedLoseNothingAndAreSaid) {
  const std::string whole = journal_bytes(4);
  const auto blocks = blocks_of(whole);
  const auto block = [&](std::size_t k) { return whole.substr(blocks[k].at, blocks[k].size); };
  const auto doubled = decode_text(whole + block(2));
  ASSERT_TRUE(doubled);
  EXPECT_EQ(doubled->ticks.size(), 200U);
  EXPECT_EQ(doubled->damage.doubled, 1U);
  EXPECT_FALSE(doubled->incomplete());
  const auto swapped =
      decode_text(whole.substr(0, 8) + block(0) + block(1) + block(3) + block(2) + whole.substr(blocks[4].at));
  ASSERT_TRUE(swapped);
  EXPECT_TRUE(identical(swapped->ticks, test_ticks(0, 200)));
  EXPECT_EQ(swapped->damage.moved, 1U);
  EXPECT_TRUE(swapped->damage.any());
  EXPECT_FALSE(swapped->incomplete());
}

TEST_F(JournalFile, TwoVersionsOfATickAreBothRefused) {
  const std::string whole = journal1_bytes(3), other = journal1_bytes(3, 60);
  const auto stale = blocks_of(other)[2];  // ticks 60 to 119, the same: taken once
  const auto written = [&] {
    auto ticks = test_ticks(0, 150);
    ticks.back().phase = 6;
    return ticks;
  }();
  auto journal = decode_text(whole + other.substr(stale.at, stale.size));
  ASSERT_TRUE(journal);
  EXPECT_TRUE(identical(journal->ticks, written));
  auto ticks = test_ticks(60, 70);
  ticks[3].force[1] += 1.0;
  std::string changed(reinterpret_cast<const char*>(ticks.data()), ticks.size() * sizeof(Tick));
  std::uint32_t head[4] = {2, static_cast<std::uint32_t>(changed.size()), 0, 0};
  auto sum = crc32(0, reinterpret_cast<const Bytef*>(head), 8);
  head[2] = static_cast<std::uint32_t>(crc32(sum, reinterpret_cast<const Bytef*>(changed.data()), head[1]));
  journal = decode_text(whole + std::string(reinterpret_cast<const char*>(head), sizeof(head)) + changed);
  ASSERT_TRUE(journal);
  EXPECT_EQ(journal->ticks.size(), 149U);
  EXPECT_EQ(journal->damage.contradictory, 1U);
  ASSERT_EQ(journal->damage.lost.size(), 1U);
  EXPECT_EQ(journal->damage.lost[0].first, 63U);
}

TEST_F(JournalFile, BlocksOfAnotherTrialAreNotTaken) {
  const std::string whole = journal_bytes(4), other = journal_bytes(3, 60);
  const auto stale = blocks_of(other);
  const auto journal = decode_text(whole + other.substr(stale[3].at, stale[3].size));
  ASSERT_TRUE(journal);
  EXPECT_TRUE(identical(journal->ticks, test_ticks(0, 200)));
  EXPECT_EQ(journal->damage.foreign, 1U);
}

TEST_F(JournalFile, WithoutItsBeginningItIsReadByACopyOfTheHeader) {
  std::string bytes = journal_bytes(10);
  std::fill_n(bytes.begin(), 4096, '\0');
  const auto journal = decode_text(bytes);
  ASSERT_TRUE(journal) << journal.error().line();
  EXPECT_EQ(journal->header.metadata.at("participant"), "7");
  EXPECT_EQ(journal->damage.lost.front().first, 0U);
  EXPECT_EQ(to_recording(*journal)->time[0], 0.0);
}

TEST_F(JournalFile, WithoutAnyHeaderTheTicksAreStillThere) {
  std::string bytes = journal1_bytes(4);
  bytes[30] = '?';
  const auto journal = decode_text(bytes);
  ASSERT_TRUE(journal);
  EXPECT_TRUE(journal->damage.header);
  const auto recording = to_recording(*journal);
  ASSERT_TRUE(recording);
  EXPECT_EQ(recording->find("hand_x"), nullptr);
  EXPECT_EQ(recording->find("reference_x"), nullptr);
  EXPECT_EQ(recording->find("joint_1")->values[7], test_ticks(7, 8)[0].joint[0]);
  EXPECT_NE(recording->metadata.at("ended").find("header was lost"), std::string::npos);
}

TEST_F(JournalFile, HeadersOfTwoTrialsInFormat1AreRefused) {
  std::string other = journal1_bytes(1);
  other.replace(other.find(R"("participant":"7")"), 17, R"("participant":"8")");
  const auto block = blocks_of(journal1_bytes(1))[0];
  std::uint32_t head[2] = {1, static_cast<std::uint32_t>(block.size - 16)};
  auto sum = crc32(0, reinterpret_cast<const Bytef*>(head), 8);
  sum = crc32(sum, reinterpret_cast<const Bytef*>(other.data() + block.at + 16), head[1]);
  const auto sum32 = static_cast<std::uint32_t>(sum);
  std::memcpy(other.data() + block.at + 8, &sum32, 4);
  const auto journal = decode_text(journal1_bytes(4) + other.substr(8));
  ASSERT_FALSE(journal);
  EXPECT_NE(journal.error().line().find("trials"), std::string::npos);
}

/// An hour's worth of bytes that all look like the beginning of a large block.
TEST_F(JournalFile, WhatLooksLikeBlocksEverywhereTakesLinearTime) {
  std::string hostile = "MBKJRNL1";
  const std::uint32_t head[4] = {2, 144 * 100'000, 1, 0};
  while (hostile.size() < 20'000'000) hostile.append(reinterpret_cast<const char*>(head), sizeof(head));
  EXPECT_FALSE(decode_text(hostile));  // byte by byte it would take hours
}

TEST_F(JournalFile, NumbersBeyondReasonClaimNoMemory) {
  auto writer = Writer::create(file_, header(), 0);
  ASSERT_TRUE(writer);
  auto far = ticks(0, 2);
  far[1].number = std::uint64_t{1} << 40U;
  ASSERT_TRUE(writer->append(far));
  const auto journal = read(file_);
  ASSERT_TRUE(journal);
  const auto recording = to_recording(*journal);
  ASSERT_TRUE(recording);
  EXPECT_EQ(recording->samples(), 2);
  EXPECT_NE(recording->metadata.at("journal_damage").find("row"), std::string::npos);
}

TEST_F(JournalFile, GapsAreRowsOfNaNAtTheirTimesAndMissedTicksAreNot) {
  Journal journal;
  journal.header = header();
  journal.ticks = ticks(0, 20);
  for (std::size_t k = 8; k < 20; ++k) journal.ticks[k].time += 0.030;  // the loop missed 30 ticks behind tick 7
  EXPECT_EQ(to_recording(journal)->samples(), 20);
  journal.ticks.erase(journal.ticks.begin() + 6, journal.ticks.begin() + 10);  // lost: 6 to 9
  const auto recording = to_recording(journal);
  ASSERT_EQ(recording->samples(), 20);
  for (Index k = 6; k < 10; ++k) {
    EXPECT_TRUE(std::isnan(recording->find("force_x")->values[k]));
    EXPECT_NEAR(recording->time[k], 1e-3 * static_cast<double>(k), 1e-12);
  }
  EXPECT_NEAR(recording->time[10], 0.040, 1e-12);
}

TEST_F(JournalFile, AForceWhoseAnglesWereLostStandsBesideNoOthers) {
  Journal journal;
  journal.header = header();
  journal.header.force_latency = 2;
  journal.ticks = ticks(0, 10);
  journal.ticks.erase(journal.ticks.begin() + 5);
  const auto recording = to_recording(journal);
  const Vector& force = recording->find("force_x")->values;
  EXPECT_EQ(force[2], 4.0);
  EXPECT_TRUE(std::isnan(force[3]));  // came with tick 5
  EXPECT_EQ(force[4], 6.0);
  EXPECT_TRUE(std::isnan(force[5]));
  EXPECT_EQ(force[6], 8.0);
}

TEST_F(JournalFile, APerturbationThatBeganInAGapBeginsThere) {
  Journal journal;
  journal.header = header();
  journal.ticks = ticks(0, 200);
  journal.ticks.erase(journal.ticks.begin() + 90, journal.ticks.begin() + 130);
  const auto recording = to_recording(journal);
  EXPECT_EQ(recording->events[0].name, "perturbation_start");
  EXPECT_NEAR(recording->events[0].time, 0.100, 1e-12);
}

TEST_F(JournalFile, IsForItsOwnerAloneUnlessAskedOtherwise) {
  const auto mode = [&] { return fs::status(file_).permissions() & fs::perms::all; };
  write(1, false);
  EXPECT_EQ(mode(), fs::perms(0600));
  fs::remove(file_);
  Header shared = header();
  shared.readers = Readers::group;
  { ASSERT_TRUE(Writer::create(file_, shared, 10)); }
  EXPECT_EQ(mode(), fs::perms(0640));
  const auto journal = read(file_);
  ASSERT_TRUE(journal);
  EXPECT_EQ(journal->header.readers, Readers::group);
}

TEST_F(JournalFile, RemovedOrReplacedItGoesOnElsewhereWithAllThatItHeld) {
  for (const bool replaced : {false, true}) {
    auto writer = Writer::create(file_, header(), 1000);
    ASSERT_TRUE(writer);
    ASSERT_TRUE(writer->append(ticks(0, 50)));
    EXPECT_EQ(writer->place(), Writer::Place::here);
    fs::remove(file_);
    if (replaced) set_bytes("another file");
    EXPECT_EQ(writer->place(), Writer::Place::gone);
    ASSERT_TRUE(writer->save_elsewhere());
    EXPECT_EQ(writer->place(), Writer::Place::here);
    ASSERT_TRUE(writer->append(ticks(50, 100)));
    ASSERT_TRUE(writer->end({Ending::How::completed, "", 0, 0, 100}));
    const auto journal = read(writer->file());
    ASSERT_TRUE(journal);
    EXPECT_TRUE(identical(journal->ticks, ticks(0, 100)));
    EXPECT_FALSE(journal->damage.any());
    EXPECT_EQ(writer->file().filename(), replaced ? "trial_saved_2.h5.journal" : "trial_saved.h5.journal");
    if (replaced) {
      EXPECT_EQ(bytes(), "another file");
    }
  }
}

TEST_F(JournalFile, CutShortByAnotherProgramIsSeen) {
  auto writer = Writer::create(file_, header(), 1000);
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->append(ticks(0, 50)));
  fs::resize_file(file_, 100);
  EXPECT_EQ(writer->place(), Writer::Place::cut);
}

TEST_F(JournalFile, WhatIsNoJournalIsRefused) {
  set_bytes("hello");
  EXPECT_FALSE(read(file_));
  EXPECT_TRUE(is_journal(file_));  // by its name: its beginning may be damaged
  fs::rename(file_, folder_ / "trial.h5");
  EXPECT_FALSE(is_journal(folder_ / "trial.h5"));
  EXPECT_FALSE(is_journal(folder_ / "nothing.journal"));
  EXPECT_FALSE(read(folder_ / "nothing"));
}

TEST_F(JournalFile, TheRecordingSaysWhatHappened) {
  write(5, true);
  const auto recording = to_recording(*read(file_));
  ASSERT_TRUE(recording);
  EXPECT_EQ(recording->samples(), 250);
  EXPECT_EQ(recording->metadata.at("ended"), "completed");
  EXPECT_EQ(recording->metadata.at("ticks_dropped"), "3");
  EXPECT_EQ(recording->metadata.at("participant"), "7");
  ASSERT_EQ(recording->events.size(), 2U);  // the offset lies behind the end
  EXPECT_EQ(recording->events[0].name, "perturbation_start");
  EXPECT_NEAR(recording->events[0].time, 0.100, 1e-12);
  EXPECT_EQ(recording->events[1].name, "onset");
  EXPECT_NEAR(recording->events[1].time, 0.110, 1e-12);
  const Vector& x = recording->find("hand_x")->values;
  EXPECT_NEAR(x[200], robot::hand_position({}, {0.82, test_ticks(200, 201)[0].joint[1]}).x(), 1e-12);
}

TEST_F(JournalFile, WithoutAnEndItWasInterrupted) {
  write(2, false);
  EXPECT_EQ(to_recording(*read(file_))->metadata.at("ended"), "interrupted");
}

TEST_F(JournalFile, EveryEndingComesBackAndIsSaid) {
  for (const auto& [how, word] : kWords<Ending::How>) {
    if (how == Ending::How::other) continue;
    fs::remove(file_);
    auto writer = Writer::create(file_, header(), 1000);
    ASSERT_TRUE(writer);
    ASSERT_TRUE(writer->append(ticks(0, 50)));
    ASSERT_TRUE(writer->end({how, "", 0, 0, 50}));
    const auto journal = read(file_);
    ASSERT_TRUE(journal && journal->ending);
    EXPECT_EQ(journal->ending->how, how);
    EXPECT_EQ(to_recording(*journal)->metadata.at("ended"), word);
  }
}

TEST_F(JournalFile, AnEndingOfANewerVersionKeepsItsWordAndIsSaid) {
  auto writer = Writer::create(file_, header(), 1000);
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->append(ticks(0, 50)));
  ASSERT_TRUE(writer->end({.how = Ending::How::other, .detail = "no power", .ticks = 50, .other = "unplugged"}));
  const auto journal = read(file_);
  ASSERT_TRUE(journal && journal->ending);
  EXPECT_EQ(journal->ending->how, Ending::How::other);
  const auto metadata = to_recording(*journal)->metadata;
  EXPECT_EQ(metadata.at("ended"), "unplugged");
  EXPECT_EQ(metadata.at("ended_detail"), "no power; 'unplugged' is unknown to this version of mbk");
}

TEST_F(JournalFile, LateForcesStandBesideTheirOwnAngles) {
  Journal journal;
  journal.header = header();
  journal.header.force_latency = 2;
  journal.ticks = ticks(0, 10);
  const auto recording = to_recording(journal);
  const Vector& force = recording->find("force_x")->values;
  EXPECT_EQ(force[0], 2.0);
  EXPECT_EQ(force[7], 9.0);
  EXPECT_EQ(force[9], 9.0);  // the last ones have not come
}

}  // namespace
}  // namespace mbk::journal
