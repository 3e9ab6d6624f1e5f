#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mman.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "mbk/base/realtime/bounded_ring.h"
#include "mbk/base/realtime/clock.h"
#include "mbk/base/realtime/cycle_record.h"
#include "mbk/base/realtime/rest.h"
#include "mbk/base/realtime/signal_stack.h"
#include "mbk/base/realtime/thread_setup.h"
#include "mbk/base/realtime/wake_up.h"
#include "tests/support/allocations.h"

namespace mbk::realtime {
namespace {

/// Without an end. NOLINTNEXTLINE(misc-no-recursion)
int overflow(const volatile char* before, int depth) {
  std::array<volatile char, 4096> some;  // NOLINT(cppcoreguidelines-pro-type-member-init)
  some[0] = *before;
  return depth < 0 ? 0 : overflow(some.data(), depth + 1) + some[0];
}

TEST(SignalStackDeathTest, AHandlerRunsWhereTheStackOfAThreadHasOverflowed) {
  const auto overflow_in_a_thread = [](bool with_a_stack) {
    struct sigaction action {};
    action.sa_handler = [](int) { std::_Exit(7); };
    action.sa_flags = SA_ONSTACK;
    sigaction(SIGSEGV, &action, nullptr);
    std::thread([=] {
      std::optional<SignalStack> stack;
      if (with_a_stack) stack.emplace();
      const char first = 0;
      overflow(&first, 0);
    }).join();
  };
  EXPECT_EXIT(overflow_in_a_thread(true), testing::ExitedWithCode(7), "");
#if !defined(__SANITIZE_ADDRESS__)  // which brings a stack of its own
  EXPECT_EXIT(overflow_in_a_thread(false), testing::KilledBySignal(SIGSEGV), "");
#endif
}

TEST(SignalStack, ThatOfBeforeIsThereAfterIt) {
  stack_t before{}, after{};
  sigaltstack(nullptr, &before);
  { const SignalStack stack; }
  sigaltstack(nullptr, &after);
  EXPECT_EQ(before.ss_sp, after.ss_sp);
  EXPECT_EQ(before.ss_flags, after.ss_flags);
}

TEST(BoundedRing, KeepsOrderAndCountsWhatDoesNotFit) {
  BoundedRing<int> ring(4);
  for (int i = 0; i < 6; ++i) ring.push(i);
  EXPECT_EQ(ring.dropped(), 2U);
  EXPECT_EQ(ring.room(), 0U);
  std::vector<int> out(10);
  ASSERT_EQ(ring.pop(out.data(), 10), 4U);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(out[static_cast<std::size_t>(i)], i);
  EXPECT_EQ(ring.room(), 4U);
}

TEST(BoundedRing, LosesNothingBetweenTwoThreadsThatWaitForEachOther) {
  BoundedRing<int> ring(64);
  constexpr int kItems = 200'000;
  std::thread producer([&] {
    for (int i = 0; i < kItems; ++i) {
      while (ring.room() == 0) std::this_thread::yield();
      ring.push(i);
    }
  });
  std::vector<int> out(16);
  for (int next = 0; next < kItems;) {
    const std::size_t count = ring.pop(out.data(), out.size());
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(out[i], next++);
  }
  producer.join();
  EXPECT_EQ(ring.dropped(), 0U);
}

TEST(WakeUp, LosesNothingThatIsAsked) {
  constexpr int kRounds = 10000;
  WakeUp there, back;
  int rounds = 0;
  std::thread asked([&] {
    for (bool over = false; !over;) {
      const int what = there.wait();
      if ((what & 1) != 0) ++rounds;
      over = (what & 2) != 0;
      back.ask(4);
    }
  });
  for (int round = 0; round < kRounds; ++round) {
    there.ask(1);
    EXPECT_EQ(back.wait(), 4);
  }
  there.ask(1);
  there.ask(2);
  asked.join();
  EXPECT_EQ(rounds, kRounds + 1);
}

TEST(Rest, IsOverWithItsTimeOrWhenItIsDone) {
  int asked = 0;
  EXPECT_FALSE(rest(std::chrono::milliseconds(12), [&] { return ++asked > 100; }));
  EXPECT_EQ(asked, 4);  // at 0, 5, 10 and 12 ms
  EXPECT_TRUE(rest(std::chrono::hours(1), [&] { return ++asked > 6; }));
  EXPECT_EQ(asked, 7);
  EXPECT_TRUE(rest(std::chrono::hours(1), [] { return true; }));
}

TEST(VirtualClock, MovesOnByOnePeriodATick) {
  VirtualClock clock(1e-3);
  clock.start();
  for (int i = 1; i <= 1000; ++i) {
    EXPECT_EQ(clock.wait(), 0.0);
    EXPECT_NEAR(clock.now(), 1e-3 * i, 1e-12);
  }
  EXPECT_EQ(clock.missed(), 0U);
}

TEST(VirtualClock, AStallIsLateAndMissesTicks) {
  VirtualClock clock(1e-3);
  clock.start();
  clock.wait();
  clock.stall(5);
  EXPECT_NEAR(clock.wait(), 5e-3, 1e-12);
  EXPECT_NEAR(clock.now(), 7e-3, 1e-12);
  EXPECT_EQ(clock.missed(), 5U);
  EXPECT_EQ(clock.wait(), 0.0);
}

TEST(WallClock, NeverWakesEarlyAndDoesNotMakeUpForWhatItMissed) {
  WallClock clock(1e-3);
  clock.start();
  for (int i = 0; i < 50; ++i) EXPECT_GE(clock.wait(), 0.0);
  EXPECT_GE(clock.now(), 0.050);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const auto before = clock.missed();
  clock.wait();
  EXPECT_GE(clock.missed(), before + 15);
  const double at = clock.now();
  clock.wait();
  clock.wait();
  EXPECT_GE(clock.now(), at + 0.5e-3);  // no burst of ticks
}

TEST(CycleRecord, QuantilesAreRightToFivePercent) {
  CycleRecord record;
  for (int i = 1; i <= 100'000; ++i) record.add(i * 10);
  for (const double share : {0.1, 0.5, 0.9, 0.999}) {
    EXPECT_NEAR(record.quantile(share), share * 1e6, 0.05 * share * 1e6);
  }
  EXPECT_EQ(record.worst(), 1'000'000);
  EXPECT_EQ(record.count(), 100'000U);
  EXPECT_LE(record.quantile(1.0), 1e6);
}

TEST(CycleRecord, TakesAnythingWithoutAllocating) {
  CycleRecord record;
  const long before = testing_support::allocations();
  record.add(0);
  record.add(-5);
  record.add(std::int64_t{1} << 62U);
  EXPECT_EQ(testing_support::allocations(), before);
  EXPECT_EQ(record.count(), 3U);
  EXPECT_EQ(CycleRecord().quantile(0.5), 0.0);
}

/// What of the process is locked [kB], by /proc/self/status.
long locked() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmLck:")) return std::stol(line.substr(6));
  }
  return -1;
}

TEST(LockMemory, LocksAtThePriorityOfTheCallerWhatAThreadInRealTimeFindsLocked) {
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "a sanitizer lets nothing be locked, and says that it was";
#endif
  const int scheduled = sched_getscheduler(0);
  const bool said = lock_memory();
  EXPECT_EQ(said, locked() > 0);
  EXPECT_EQ(sched_getscheduler(0), scheduled);
  const long before = locked();
  ThreadSetup setup;
  std::thread([&] { setup = prepare_thread(); }).join();
  EXPECT_EQ(before > 0, setup.locked_memory) << setup.refused;
  munlockall();
}

}  // namespace
}  // namespace mbk::realtime
