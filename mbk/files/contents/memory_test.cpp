#include "mbk/files/contents/memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "mbk/base/system/mapping.h"

namespace mbk::recording {
namespace {

TEST(Memory, OfTheMachineIsMoreThanNothingAndLessThanAll) {
  EXPECT_GT(system::available_memory(), std::uint64_t{1} << 20);
  EXPECT_TRUE(check_memory(1000));
  EXPECT_FALSE(check_memory(std::uint64_t{1} << 60));
}

TEST(Memory, ThatIsNotThereIsRefusedWithBothSizes) {
  const auto refused = check_memory(std::uint64_t{1} << 50);
  ASSERT_FALSE(refused);
  const std::string& said = refused.error().message;
  EXPECT_NE(said.find("1048576.00 GiB"), std::string::npos) << said;
  EXPECT_NE(said.find("GiB"), said.rfind("GiB")) << said;
}

TEST(Memory, KeepsToTheLimitOfTheAddressSpace) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the sanitizer's shadow takes the whole address space";
#endif
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
  const rlimit small{std::uint64_t{1} << 30, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_AS, &small), 0);
  EXPECT_LE(system::available_memory(), std::uint64_t{1} << 30);
  EXPECT_FALSE(check_memory(std::uint64_t{2} << 30));
  ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
}

}  // namespace
}  // namespace mbk::recording
