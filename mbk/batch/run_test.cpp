#include "mbk/batch/run.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <deque>
#include <functional>
#include <random>
#include <set>

#include "mbk/batch/shard.h"
#include "mbk/batch/test_jobs.h"

namespace mbk::batch {
namespace {

/// Does a chunk at every look, in an order drawn by lot, and loses some.
class UnreliableEngine : public Engine {
 public:
  UnreliableEngine(const JobFolder& folder, double lost, unsigned seed) : folder_(folder), lost_(lost), lot_(seed) {}

  Result<std::int64_t> max_chunks() override { return 1000; }
  Result<void> submit(std::span<const std::int64_t> chunks) override {
    for (const std::int64_t chunk : chunks) ++handed_out[chunk];
    waiting_.insert(waiting_.end(), chunks.begin(), chunks.end());
    std::shuffle(waiting_.begin(), waiting_.end(), lot_);
    return {};
  }
  Result<std::map<std::int64_t, Alive>> alive() override {
    if (!waiting_.empty() && !hangs) {
      const std::int64_t chunk = waiting_.back();
      waiting_.pop_back();
      if (std::uniform_real_distribution<double>()(lot_) >= lost_) {
        EXPECT_TRUE(work(folder_, chunk, compute));
        if (std::uniform_real_distribution<double>()(lot_) < lost_) waiting_.push_back(chunk);  // and once more
      }
    }
    std::map<std::int64_t, Alive> all;
    for (const std::int64_t chunk : waiting_) all[chunk] = {hangs, ""};
    return all;
  }
  void cancel(std::span<const std::int64_t> chunks) override {
    for (const std::int64_t chunk : chunks) {
      ++cancelled;
      std::erase(waiting_, chunk);
    }
    hangs = false;
  }
  void cancel_all() override { waiting_.clear(); }
  std::string why_ended(std::int64_t) override { return "lost by lot"; }
  double interval_s() const override { return 0.001; }
  double settle_s() const override { return 0.0; }

  std::map<std::int64_t, int> handed_out;
  int cancelled = 0;
  bool hangs = false;
  UnitFunction compute = [](std::int64_t number, const std::string& key) -> Result<std::string> {
    return fmt::format("{} of {}", number * number, key);
  };

 private:
  const JobFolder& folder_;
  double lost_;
  std::mt19937 lot_;
  std::deque<std::int64_t> waiting_;
};

class RunOfJob : public JobTest {};

TEST_F(RunOfJob, SameResultsWhateverIsLostAndInWhateverOrder) {
  std::string first;
  for (const unsigned seed : {1U, 2U, 3U}) {
    for (const int of_chunk : {1, 3, 10}) {
      const JobFolder folder = job(30, of_chunk, fmt::format("job{}-{}", seed, of_chunk));
      UnreliableEngine engine(folder, seed == 1 ? 0.0 : 0.3, seed);
      RunOptions options;
      options.attempts = 100;
      const auto report = run(folder, engine, options);
      ASSERT_TRUE(report) << report.error().line();
      EXPECT_EQ(report->end, RunEnd::finished);
      EXPECT_EQ(report->state.finished_units, 30);
      MergeReport merge_report;
      const std::string text = merged(folder, &merge_report);
      EXPECT_EQ(merge_report.results, 30) << "none lost, none counted twice";
      if (first.empty()) first = text;
      EXPECT_EQ(text, first);
    }
  }
}

TEST_F(RunOfJob, GoesOnWithWhatIsFinished) {
  const JobFolder folder = job(12, 2);
  for (const int chunk : {0, 3, 5}) ASSERT_TRUE(work(folder, chunk, answer));
  UnreliableEngine engine(folder, 0.0, 1);
  const auto report = run(folder, engine, {});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->end, RunEnd::finished);
  EXPECT_EQ(engine.handed_out, (std::map<std::int64_t, int>{{1, 1}, {2, 1}, {4, 1}}));
}

TEST_F(RunOfJob, GivesUpAChunkThatIsAlwaysLostAndFinishesTheOthers) {
  const JobFolder folder = job(4, 1);
  UnreliableEngine engine(folder, 1.0, 1);
  ASSERT_TRUE(work(folder, 0, answer));
  RunOptions options;
  options.attempts = 2;
  const auto report = run(folder, engine, options);
  ASSERT_TRUE(report) << report.error().line();
  EXPECT_EQ(report->end, RunEnd::incomplete);
  EXPECT_EQ(report->state.given_up, 3);
  EXPECT_EQ(report->state.losses.at("lost by lot"), 6);
}

TEST_F(RunOfJob, EndsEarlyWhereNothingComesOfIt) {
  const JobFolder folder = job(40, 1);
  UnreliableEngine engine(folder, 1.0, 1);
  const auto report = run(folder, engine, {});
  ASSERT_FALSE(report);
  EXPECT_NE(report.error().message.find("lost by lot"), std::string::npos);
}

TEST_F(RunOfJob, AProcessWithoutASignOfLifeIsGivenToAnother) {
  const JobFolder folder = job(2, 2);
  UnreliableEngine engine(folder, 0.0, 1);
  engine.hangs = true;
  RunOptions options;
  options.silence_s = 0.2;
  const auto report = run(folder, engine, options);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->end, RunEnd::finished);
  EXPECT_EQ(engine.cancelled, 1);
  EXPECT_EQ(engine.handed_out.at(0), 2);
}

TEST_F(RunOfJob, ADamagedShardIsSetAsideAndDoneAgain) {
  const JobFolder folder = job(4, 2);
  ASSERT_TRUE(work(folder, 1, answer));
  const auto file = shards_of(folder, ShardFile::State::whole).at(0);
  std::string bytes = bytes_of(file);
  bytes[bytes.size() / 2] ^= 1;
  write(file, bytes);
  UnreliableEngine engine(folder, 0.0, 1);
  const auto report = run(folder, engine, {});
  ASSERT_TRUE(report);
  EXPECT_EQ(report->end, RunEnd::finished);
  EXPECT_EQ(engine.handed_out.size(), 2u);
  EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(file).replace_extension(kDamagedEnd)));
}

TEST_F(RunOfJob, OneProcessLooksAfterAJobAndItsLockEndsWithIt) {
  const JobFolder folder = job(2, 2);
  write(folder.folder() / "keeper", "process 7 on elsewhere");  // left by one that is gone
  UnreliableEngine engine(folder, 0.0, 1);
  const int other = ::open((folder.folder() / "keeper").c_str(), O_RDWR);
  ASSERT_EQ(::flock(other, LOCK_EX), 0);
  const auto refused = run(folder, engine, {});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("process 7 on elsewhere"), std::string::npos) << refused.error().line();
  ::close(other);
  ASSERT_TRUE(run(folder, engine, {}));
}

TEST(Chunks, AreOfOneCostAndNoMoreThanAllowed) {
  std::vector<double> costs;
  for (int k = 0; k < 1000; ++k) costs.push_back(k % 10 == 0 ? 5.0 : 1.0);
  const auto ends = cut_into_chunks(costs, 20.0, 1000);
  EXPECT_EQ(ends.back(), 1000);
  std::int64_t first = 0;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    double cost = 0.0;
    for (std::int64_t unit = first; unit < ends[k]; ++unit) cost += costs[static_cast<std::size_t>(unit)];
    EXPECT_GE(cost, 20.0);
    EXPECT_LT(cost, 25.0);
    first = ends[k];
  }
  EXPECT_LE(std::ssize(cut_into_chunks(costs, 0.001, 7)), 7);
  EXPECT_TRUE(cut_into_chunks({}, 1.0, 5).empty());
}

TEST(Chunks, OfALittleWorkAreAsManyForEachTask) {
  constexpr ChunkLengths kLengths{2.0, 0.2};
  // three of 2 s would leave one of two tasks without work for a third of the time
  EXPECT_DOUBLE_EQ(chunk_length(6.0, 2, kLengths), 1.5);
  EXPECT_DOUBLE_EQ(chunk_length(3.0, 2, kLengths), 1.5);
  for (const double total_s : {0.9, 5.0, 6.0, 41.0}) {
    const std::vector<double> costs(10'000, total_s / 10'000);
    for (const int tasks : {1, 2, 3, 7}) {
      const double length_s = chunk_length(total_s, tasks, kLengths);
      EXPECT_LE(length_s, 300.0);
      if (length_s > 0.2) {
        EXPECT_EQ(cut_into_chunks(costs, length_s, 1'000'000).size() % static_cast<std::size_t>(tasks), 0U)
            << total_s << " s, " << tasks << " tasks";
      }
    }
  }
  EXPECT_DOUBLE_EQ(chunk_length(0.05, 8, kLengths), 0.2);
  EXPECT_DOUBLE_EQ(chunk_length(1e4, 0, {30.0, 2.0}), 30.0);
  EXPECT_DOUBLE_EQ(chunk_length(1e7, 0, {30.0, 2.0}), 300.0);
}

}  // namespace
}  // namespace mbk::batch
