#include "mbk/files/contents/disk_pages.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <string>

#include "mbk/files/contents/test_files.h"
#include "mbk/files/contents/test_pages.h"

namespace mbk::recording {
namespace disk_pages_test {

constexpr Index kCount = 1 << 19;     ///< 4 MB
constexpr Index kOfThePage = 4096;    ///< numbers on a page are no more, whatever its size
constexpr Index kPagesAtTheEnds = 2;  ///< which are not whole, and stay

Vector numbers() {
  return Vector::LinSpaced(kCount, -1.0, 7.0);
}

class DiskPagesOf : public testing::Test {
 protected:
  void SetUp() override {
    done_ = DiskPages().take(values_.data(), kCount);
    if (done_ == 0 || !test::pages_in_memory(values_)) GTEST_SKIP() << "no such files here";
  }
  [[nodiscard]] Index in_memory() const { return test::pages_in_memory(values_).value(); }

  Vector values_ = numbers();
  Index done_ = 0;
};

TEST_F(DiskPagesOf, NumbersLeaveThemWhereTheyStood) {
  EXPECT_LE(in_memory(), kPagesAtTheEnds);
  EXPECT_LE(done_, kCount);
  EXPECT_GT(done_, kCount - kOfThePage);
  EXPECT_EQ(values_, numbers());
}

TEST_F(DiskPagesOf, ChangedNumbersKeepTheChange) {
  values_[kCount / 2] = 42.0;
  EXPECT_EQ(values_[kCount / 2], 42.0);
  values_[kCount / 2] = numbers()[kCount / 2];
  EXPECT_EQ(values_, numbers());
}

TEST_F(DiskPagesOf, AColumnThatGrowsKeepsItsNumbers) {
  values_.conservativeResize(3 * kCount);
  EXPECT_EQ(values_.head(kCount), numbers());
  values_.conservativeResize(kCount / 2);
  EXPECT_EQ(values_, numbers().head(kCount / 2));
}

TEST(DiskPages, NumbersStayInMemoryWhereNoFileCanBe) {
  const char* const before = std::getenv("TMPDIR");
  const std::string kept = before == nullptr ? "" : before;
  ASSERT_EQ(::setenv("TMPDIR", "/there/is/no/such/folder", 1), 0);
  Vector values = numbers();
  EXPECT_EQ(DiskPages().take(values.data(), kCount), 0);
  EXPECT_EQ(values, numbers());
  ASSERT_EQ(before == nullptr ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", kept.c_str(), 1), 0);
}

/// The numbers in pieces of which none is whole pages, as if each came from elsewhere.
Vector as_they_come(DiskPages& disk) {
  constexpr Index kPiece = 12'345;
  const Vector all = numbers();
  Vector place(kCount + kPiece);  // more may come than do
  DiskPages::Coming coming = disk.expect(place.data(), place.size());
  for (Index begin = 0; begin < kCount; begin += kPiece) {
    disk.add(coming, all.data() + begin, std::min(kPiece, kCount - begin));
  }
  disk.arrived(coming);
  return place.head(kCount);
}

TEST(DiskPages, NumbersThatComeInPiecesStandWhereTheyAreExpected) {
  DiskPages disk;
  EXPECT_EQ(as_they_come(disk), numbers());
  EXPECT_EQ(as_they_come(disk), numbers());  // behind others in the file
}

TEST(DiskPages, NumbersThatComeStayInMemoryFromWhereTheDiskIsFull) {
  // As a disk that is full: no file may be longer.
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  for (const rlim_t most : {rlim_t{0}, rlim_t{1'000'003}}) {
    const rlimit limit{most, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
    DiskPages disk;
    EXPECT_EQ(as_they_come(disk), numbers()) << most;
    EXPECT_EQ(as_they_come(disk), numbers()) << most;
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  }
  std::signal(SIGXFSZ, handler);
}

TEST(DiskPages, AFewNumbersAreNoPage) {
  Vector values = Vector::Ones(10);
  EXPECT_EQ(DiskPages().take(values.data(), values.size()), 0);
}

}  // namespace disk_pages_test
}  // namespace mbk::recording
