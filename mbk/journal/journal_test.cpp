#include "mbk/journal/journal.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace mbk::journal {
namespace {

namespace fs = std::filesystem;

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

  static Header header() {
    Header header;
    header.metadata = {{"participant", "7"}, {"condition", "relaxed, \"quoted\""}};
    header.events = {{0.010, "onset", 1.5}, {99.0, "offset", 0.0}};
    return header;
  }

  /// Approach for 100 ticks, then the perturbation.
  static std::vector<Tick> ticks(int from, int to) {
    std::vector<Tick> ticks;
    for (int i = from; i < to; ++i) {
      Tick tick;
      tick.number = static_cast<std::uint64_t>(i);
      tick.time = 1e-3 * i;
      tick.perturbation_time = i < 100 ? -1.0 : 1e-3 * (i - 100);
      tick.joint = {0.8 + 1e-4 * i, 0.5};
      tick.force = {static_cast<double>(i), 0.0};
      ticks.push_back(tick);
    }
    return ticks;
  }

  void write(int blocks, bool end) {
    auto writer = Writer::create(file_, header(), 1000);
    ASSERT_TRUE(writer) << writer.error().line();
    for (int b = 0; b < blocks; ++b) ASSERT_TRUE(writer->append(ticks(50 * b, 50 * b + 50)));
    if (end) {
      ASSERT_TRUE(writer->end({"completed", "", 3, 2}));
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
  EXPECT_EQ(journal->ending->how, "completed");
  EXPECT_EQ(journal->ending->dropped, 3U);
  EXPECT_EQ(journal->bytes_lost, 0U);
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
  write(4, true);
  const std::string whole = bytes();
  const std::size_t block = 16 + 50 * sizeof(Tick);
  const std::size_t ending = whole.size() - whole.rfind("{\"detail\"") + 16;
  const std::size_t begin = whole.size() - ending - 4 * block;
  for (std::size_t length = begin; length < whole.size(); length += 37) {
    set_bytes(whole.substr(0, length));
    const auto journal = read(file_);
    ASSERT_TRUE(journal) << length;
    EXPECT_EQ(journal->ticks.size(), 50 * std::min<std::size_t>(4, (length - begin) / block)) << length;
    EXPECT_FALSE(journal->ending);
  }
}

TEST_F(JournalFile, ABrokenBlockEndsIt) {
  write(4, true);
  std::string spoilt = bytes();
  spoilt[spoilt.size() - 5000] = static_cast<char>(spoilt[spoilt.size() - 5000] ^ 0x10);
  set_bytes(spoilt);
  const auto journal = read(file_);
  ASSERT_TRUE(journal);
  EXPECT_EQ(journal->ticks.size(), 150U);
  EXPECT_GT(journal->bytes_lost, 5000U);
  EXPECT_FALSE(journal->ending);
}

TEST_F(JournalFile, WhatIsNoJournalIsRefused) {
  set_bytes("hello");
  EXPECT_FALSE(is_journal(file_));
  EXPECT_FALSE(read(file_));
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
  EXPECT_NEAR(x[200], robot::hand_position({}, {0.82, 0.5}).x(), 1e-12);
}

TEST_F(JournalFile, WithoutAnEndItWasInterrupted) {
  write(2, false);
  EXPECT_EQ(to_recording(*read(file_))->metadata.at("ended"), "interrupted");
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
