#include "mbk/files/recording/mat_level4.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "mbk/files/contents/test_files.h"

namespace mbk::recording {
namespace mat_level4_test {

using test::mat4;
using test::raw;
using testing::ElementsAre;
using testing::HasSubstr;

const Matrix kValues = (Matrix(2, 3) << 1, 2, 3, 4, 5, 6.5).finished();

Result<Contents> decode(std::string_view bytes) {
  return decode_mat_level4(std::as_bytes(std::span(bytes)));
}

std::string header(std::uint32_t type, std::uint32_t rows, std::uint32_t columns, std::uint32_t complex,
                   std::string name) {
  return raw(type) + raw(rows) + raw(columns) + raw(complex) + raw(static_cast<std::uint32_t>(name.size() + 1)) + name +
         '\0';
}

TEST(DecodeMatLevel4, ReadsBothByteOrders) {
  for (const bool big : {false, true}) {
    const auto contents = decode(mat4("logs", kValues, big) + mat4("b", kValues, big));
    ASSERT_TRUE(contents) << contents.error().line();
    EXPECT_EQ(contents->format, "MAT v4");
    ASSERT_EQ(contents->arrays.size(), 2u);
    EXPECT_EQ(contents->arrays[0].name, "logs");
    EXPECT_EQ(contents->arrays[1].values, kValues);
  }
}

TEST(DecodeMatLevel4, ReadsEveryNumberFormat) {
  EXPECT_EQ(decode(header(10, 1, 1, 0, "a") + raw(0.5f))->arrays[0].values(0, 0), 0.5);
  EXPECT_EQ(decode(header(20, 1, 1, 0, "a") + raw(std::int32_t{-5}))->arrays[0].values(0, 0), -5);
  EXPECT_EQ(decode(header(30, 1, 1, 0, "a") + raw(std::int16_t{-6}))->arrays[0].values(0, 0), -6);
  EXPECT_EQ(decode(header(40, 1, 1, 0, "a") + raw(std::uint16_t{60000}))->arrays[0].values(0, 0), 60000);
  EXPECT_EQ(decode(header(50, 1, 1, 0, "a") + raw(std::uint8_t{200}))->arrays[0].values(0, 0), 200);
}

TEST(DecodeMatLevel4, LeavesTextSparseAndComplexAside) {
  const auto contents = decode(header(51, 1, 2, 0, "who") + "ab" + header(2, 1, 3, 0, "s") + std::string(24, '\0') +
                               header(0, 1, 1, 1, "c") + std::string(16, '\0'));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_TRUE(contents->arrays.empty());
  EXPECT_THAT(contents->notes,
              ElementsAre(AllOf(HasSubstr("'who'"), HasSubstr("text")), AllOf(HasSubstr("'s'"), HasSubstr("matrix")),
                          AllOf(HasSubstr("'c'"), HasSubstr("complex"))));
}

TEST(DecodeMatLevel4, RefusesAFileCutAnywhere) {
  const std::string whole = mat4("logs", kValues);
  for (std::size_t n = 1; n < whole.size(); ++n) {
    ASSERT_FALSE(decode(std::string_view(whole).substr(0, n))) << "cut to " << n;
  }
}

TEST(DecodeMatLevel4, DoesNotBelieveAbsurdDimensions) {
  const auto contents = decode(header(0, 0xFFFFFFFF, 0xFFFFFFFF, 0, "logs") + raw(1.0));
  ASSERT_FALSE(contents);
  EXPECT_THAT(contents.error().line(), AllOf(HasSubstr("'logs'"), HasSubstr("4294967295×4294967295")));
}

TEST(DecodeMatLevel4, SurvivesFlippedBytes) {
  const std::string whole = mat4("logs", kValues) + mat4("b", kValues);
  std::mt19937 random(20130602);
  for (int i = 0; i < 20000; ++i) {
    std::string file = whole;
    file[random() % file.size()] = static_cast<char>(random());
    const auto contents = decode(file);
    if (contents) {
      for (const Array& array : contents->arrays) ASSERT_LE(array.values.size(), 64);
    }
  }
}

}  // namespace mat_level4_test
}  // namespace mbk::recording
