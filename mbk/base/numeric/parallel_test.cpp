#include "mbk/base/numeric/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <new>
#include <tuple>
#include <vector>

#include "mbk/base/core/requester.h"

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

/// Who wants so many turns.
class Impatient : public Requester {
 public:
  explicit Impatient(int turns) : left_(turns) {}
  bool stopped() override { return --left_ < 0; }

 private:
  std::atomic<int> left_;
};

TEST(ParallelFor, StopsWhereTheRequesterNoLongerWantsIt) {
  for (const unsigned threads : {1u, 4u}) {
    Impatient requester(5);
    const Requester::Scope scope(&requester);
    std::atomic<int> calls = 0, for_other = 0;
    const auto work = [&](int) -> Result<void> {
      ++calls;
      if (Requester::current() != &requester) ++for_other;
      return {};
    };
    EXPECT_THROW(std::ignore = parallel_for(1000, threads, work), Stopped);
    EXPECT_EQ(calls, 5);
    EXPECT_EQ(for_other, 0);
  }
  EXPECT_EQ(Requester::current(), nullptr);
}

}  // namespace
}  // namespace mbk::numeric
