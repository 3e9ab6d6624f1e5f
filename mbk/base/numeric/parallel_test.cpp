#include "mbk/base/numeric/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <new>
#include <vector>

namespace mbk::numeric {
namespace {

TEST(ParallelFor, CallsEachIndexOnceOnAnyNumberOfThreads) {
  for (const unsigned threads : {0u, 1u, 2u, 7u}) {
    std::vector<std::atomic<int>> calls(100);
    std::vector<int> done;  // written by one thread at a time
    const auto outcome = parallel_for(
        100, threads,
        [&](int i) -> Result<void> {
          ++calls[static_cast<std::size_t>(i)];
          return {};
        },
        [&](int i) { done.push_back(i); });
    EXPECT_TRUE(outcome);
    for (const auto& count : calls) EXPECT_EQ(count, 1);
    EXPECT_EQ(done.size(), 100u);
  }
}

TEST(ParallelFor, GivesTheErrorAndBeginsNothingAfterIt) {
  std::atomic<int> calls = 0;
  const auto outcome = parallel_for(1000, 1, [&](int i) -> Result<void> {
    ++calls;
    if (i == 3) return bad_data("three");
    return {};
  });
  ASSERT_FALSE(outcome);
  EXPECT_EQ(outcome.error().message, "three");
  EXPECT_EQ(calls, 4);
}

TEST(ParallelFor, AnExceptionReachesTheCallerFromAnyThread) {
  for (const unsigned threads : {1u, 4u}) {
    const auto throwing = [&] {
      return parallel_for(1000, threads, [](int i) -> Result<void> {
        if (i >= 3) throw std::bad_alloc();
        return {};
      });
    };
    EXPECT_THROW((void)throwing(), std::bad_alloc);
  }
}

TEST(ParallelFor, DoesNothingWhereThereIsNothing) {
  EXPECT_TRUE(parallel_for(0, 4, [](int) -> Result<void> { return bad_data("called"); }));
}

}  // namespace
}  // namespace mbk::numeric
