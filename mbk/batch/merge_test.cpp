#include "mbk/batch/merge.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "mbk/batch/test_jobs.h"

namespace mbk::batch {
namespace {

class Merge : public JobTest {};

/// MBK_MERGE_RESULTS says how many (50000). Figures are printed for one million.
TEST_F(Merge, OfManyResultsTakesLittleTimeAndMemory) {
  const char* const asked = std::getenv("MBK_MERGE_RESULTS");
  const int results = asked != nullptr ? std::atoi(asked) : 50'000;
  constexpr int kOfChunk = 1000;
  constexpr std::size_t kBytes = 200;
  {
    const JobFolder folder = job(results, kOfChunk);
    for (std::int64_t chunk = 0; chunk < folder.job().chunks; ++chunk) {
      ASSERT_TRUE(work(folder, chunk, [&](std::int64_t number, const std::string&) -> Result<std::string> {
        return fmt::format("{:0{}}", number, kBytes);
      }));
    }
  }
  const pid_t child = ::fork();  // whose memory is weighed
  ASSERT_GE(child, 0);
  if (child == 0) {
    const auto folder = JobFolder::open(folder_ / "job");
    std::int64_t next = 0;
    std::size_t bytes = 0;
    const auto report = merge(*folder, [&](MergedUnit unit) -> Result<void> {
      if (unit.number != next++) return bad_data("not in order");
      bytes += unit.payload.size();
      return {};
    });
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const double megabytes = static_cast<double>(usage.ru_maxrss) / 1024.0;
    fmt::print("{} results of {} bytes: {:.0f} MB at most\n", results, kBytes, megabytes);
    const bool good = report && report->results == results && bytes == kBytes * static_cast<std::size_t>(results) &&
                      megabytes < 300.0;
    std::fflush(stdout);
    ::_exit(good ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace mbk::batch
