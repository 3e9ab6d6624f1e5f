#include "mbk/files/archive/gzip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <span>
#include <string>

#include "mbk/files/archive/test_gzip.h"

namespace mbk::recording {
namespace gzip_test {

using test::gzip;
using testing::HasSubstr;

Result<std::string> unpacked(const std::string& file) {
  const auto bytes = gunzip(std::as_bytes(std::span(file)));
  if (!bytes) return tl::unexpected(bytes.error());
  return std::string(reinterpret_cast<const char*>(bytes->data.get()), bytes->size);
}

TEST(Gunzip, GivesBackWhatWasPacked) {
  for (const std::size_t size : {1, 4096, 4097, 3'000'000}) {
    std::string text(size, 'a');
    for (std::size_t k = 0; k < size; k += 3) text[k] = static_cast<char>(k * k % 251);
    EXPECT_EQ(unpacked(gzip(text)), text);
  }
}

TEST(Gunzip, JoinsMembers) {
  EXPECT_EQ(unpacked(gzip("one ") + gzip("") + gzip(std::string(9000, 'x'))), "one " + std::string(9000, 'x'));
}

TEST(Gunzip, RefusesDamage) {
  const std::string whole = gzip("a recording of some length, a recording of some length");
  for (std::size_t size = 18; size < whole.size(); ++size) {
    EXPECT_FALSE(unpacked(whole.substr(0, size))) << size;
  }
  std::string wrong_sum = whole;
  wrong_sum[wrong_sum.size() - 6] ^= 1;
  EXPECT_THAT(unpacked(wrong_sum).error().message, HasSubstr("incorrect data check"));
  EXPECT_FALSE(unpacked(whole + "more"));
  EXPECT_FALSE(unpacked(gzip("")));
  EXPECT_FALSE(unpacked("no gzip, but longer than its header"));
}

TEST(Gunzip, DoesNotBelieveASizeThatCannotBe) {
  std::string file = gzip("short");
  for (std::size_t k = file.size() - 4; k < file.size(); ++k) file[k] = '\x7F';
  EXPECT_THAT(unpacked(file).error().message, HasSubstr("incorrect length check"));
}

}  // namespace gzip_test
}  // namespace mbk::recording
