#include "mbk/batch/work.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "mbk/batch/test_jobs.h"

namespace mbk::batch {
namespace {

class Work : public JobTest {
 protected:
  /// A process that begins a chunk and ends at a unit, as kill −9 ends it.
  static void end_within(const JobFolder& folder, std::int64_t chunk, std::int64_t at) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      std::ignore = work(folder, chunk,
                         [&](std::int64_t number, const std::string& key) -> Result<std::string> {
                           if (number == at) {
                             ::usleep(700'000);  // what was done before reaches the file with the next sign of life
                             ::raise(SIGKILL);
                           }
                           return answer(number, key);
                         },
                         {0.3});
      ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
  }
};

TEST_F(Work, LeavesOneShardForEachChunk) {
  const JobFolder folder = job(10, 3);
  EXPECT_EQ(folder.job().chunks, 4);
  for (int chunk = 3; chunk >= 0; --chunk) {
    const auto done = work(folder, chunk, answer);
    ASSERT_TRUE(done) << done.error().line();
    EXPECT_EQ(done->units, chunk == 3 ? 1 : 3);
  }
  MergeReport report;
  const std::string text = merged(folder, &report);
  EXPECT_EQ(report.results, 10);
  EXPECT_TRUE(text.starts_with("0 key 0 gave 0 of key 0\n1 key 1 gave 1 of key 1\n2 key 2 gave 4 of key 2\n")) << text;
  EXPECT_EQ(shards_of(folder, ShardFile::State::part).size(), 0u);
}

TEST_F(Work, SameResultsInAnyChunksAndAnyOrder) {
  std::string first;
  for (const int of_chunk : {1, 4, 17}) {
    const JobFolder folder = job(17, of_chunk, fmt::format("job{}", of_chunk));
    for (std::int64_t chunk = folder.job().chunks; chunk-- > 0;) ASSERT_TRUE(work(folder, chunk, answer));
    const std::string text = merged(folder);
    if (first.empty()) first = text;
    EXPECT_EQ(text, first);
  }
}

TEST_F(Work, AUnitThatFailsCostsNoOther) {
  const JobFolder folder = job(4, 4);
  const auto done = work(folder, 0, [](std::int64_t number, const std::string& key) -> Result<std::string> {
    if (number == 2) return bad_data("is torn", "", key);
    return answer(number, key);
  });
  ASSERT_TRUE(done);
  EXPECT_EQ(done->failed, 1);
  MergeReport report;
  EXPECT_NE(merged(folder, &report).find("2 key 2 failed key 2: is torn\n3 key 3 gave"), std::string::npos);
  EXPECT_EQ(report.failed, 1);
}

TEST_F(Work, TakesOverWhatAKilledProcessHadDone) {
  const JobFolder folder = job(6, 6);
  end_within(folder, 0, 4);
  ASSERT_EQ(shards_of(folder, ShardFile::State::part).size(), 1u);
  int computed = 0;
  const auto done = work(folder, 0, [&](std::int64_t number, const std::string& key) {
    ++computed;
    return answer(number, key);
  });
  ASSERT_TRUE(done) << done.error().line();
  EXPECT_EQ(done->found, 4);
  EXPECT_EQ(computed, 2);
  MergeReport report;
  merged(folder, &report);
  EXPECT_EQ(report.results, 6);
}

TEST_F(Work, AUnitThatEndsEveryProcessIsLeftOutInTheEnd) {
  const JobFolder folder = job(6, 6);
  for (int attempt = 0; attempt < 4; ++attempt) end_within(folder, 0, 4);
  const auto done = work(folder, 0, answer);
  ASSERT_TRUE(done);
  EXPECT_EQ(done->failed, 1);
  EXPECT_NE(merged(folder).find("4 key 4 failed "), std::string::npos);
}

TEST_F(Work, RefusesAJobOfAnotherProgram) {
  const JobFolder folder = job(2, 2);
  const auto file = folder.folder() / "job.json";
  std::string text = bytes_of(file);
  const auto at = text.find(program_identity());
  ASSERT_NE(at, std::string::npos);
  write(file, text.replace(at, 5, "0.0.9"));
  const auto other = JobFolder::open(folder.folder());
  ASSERT_TRUE(other);
  const auto done = work(*other, 0, answer);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().message.find("0.0.9"), std::string::npos) << done.error().line();
}

TEST_F(Work, AFullDiskIsSaidAndLeavesNothingWhole) {
  const JobFolder folder = job(40, 40);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{20'000, 20'000};  // as a disk that takes no more
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const auto done = work(folder, 0, [](std::int64_t, const std::string&) { return std::string(30'000, 'x'); });
    ::_exit(done ? 0 : 7);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_EQ(shards_of(folder, ShardFile::State::whole).size(), 0u);
  ASSERT_TRUE(work(folder, 0, answer));
}

TEST_F(Work, ShardsThatDifferAreBothNamed) {
  const JobFolder folder = job(3, 3);
  ASSERT_TRUE(work(folder, 0, answer));
  ASSERT_TRUE(work(folder, 0, answer));
  MergeReport report;
  merged(folder, &report);
  EXPECT_EQ(report.results, 3) << "equal ones are no conflict";
  ASSERT_TRUE(work(folder, 0, [](std::int64_t number, const std::string& key) -> Result<std::string> {
    return number == 1 ? Result<std::string>("other") : answer(number, key);
  }));
  std::vector<std::filesystem::path> differing;
  const auto found = merge(folder, [&](MergedUnit unit) -> Result<void> {
    if (unit.number == 1) differing = unit.differing;
    return {};
  });
  ASSERT_TRUE(found);
  EXPECT_EQ(found->conflicts, 1);
  EXPECT_EQ(found->results, 2);
  EXPECT_GE(differing.size(), 2u);
}

TEST_F(Work, EveryCutAndEveryFlippedBitOfAShardIsSeen) {
  const JobFolder folder = job(3, 3);
  ASSERT_TRUE(work(folder, 0, answer));
  const auto chunk = folder.chunk(0);
  ASSERT_TRUE(chunk);
  const auto file = shards_of(folder, ShardFile::State::whole).at(0);
  const std::string whole = bytes_of(file);
  ASSERT_TRUE(check_shard(folder, *chunk, file));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write(file, whole.substr(0, size));
    EXPECT_FALSE(check_shard(folder, *chunk, file)) << size;
  }
  int passed = 0;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    write(file, flipped);
    passed += check_shard(folder, *chunk, file) ? 1 : 0;
  }
  // The four bytes of each record that nothing reads.
  EXPECT_LE(passed, 4 * 5);
}

}  // namespace
}  // namespace mbk::batch
