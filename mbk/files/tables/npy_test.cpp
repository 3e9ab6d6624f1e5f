#include "mbk/files/tables/npy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <string>

#include "mbk/files/tables/test_npy.h"

namespace mbk::recording {
namespace npy_test {

using test::npy;
using test::raw;
using testing::Contains;
using testing::HasSubstr;

Result<Contents> decoded(const std::string& bytes) {
  return decode_npy(std::as_bytes(std::span(bytes)));
}

SharedMatrix values_of(const std::string& bytes) {
  auto contents = decoded(bytes);
  EXPECT_TRUE(contents) << contents.error().line();
  return contents ? std::move(contents->arrays.front().values) : SharedMatrix();
}

std::string error_of(const std::string& bytes) {
  const auto contents = decoded(bytes);
  return contents ? "none" : contents.error().line();
}

const Matrix kThreeByTwo = (Matrix(3, 2) << 1, 2, 3, 4, 5, 6).finished();

std::string reals() {
  std::string data;
  for (const double value : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0}) data += raw(value);
  return data;
}

TEST(DecodeNpy, ReadsEveryFormatAndOrder) {
  for (const char major : {1, 2, 3}) {
    EXPECT_EQ(values_of(npy("'<f8'", "(3, 2)", reals(), false, major)), kThreeByTwo);
    EXPECT_EQ(values_of(npy("'<f8'", "(2, 3)", reals(), true, major)), kThreeByTwo.transpose());
  }
  EXPECT_EQ(values_of(npy("'<f8'", "(3L, 1L, 2L)", reals())), kThreeByTwo);
  EXPECT_EQ(values_of(npy("'<f8'", "()", raw(7.5))), Matrix::Constant(1, 1, 7.5));
  EXPECT_EQ(values_of(npy("'<f8'", "(6,)", reals())), Vector::LinSpaced(6, 1, 6));
}

TEST(DecodeNpy, ReadsEveryNumber) {
  const Vector two = (Vector(2) << 1, -2).finished();
  EXPECT_EQ(values_of(npy("'>i2'", "(2,)", std::string("\0\1\xff\xfe", 4))), two);
  EXPECT_EQ(values_of(npy("'<i4'", "(2,)", raw(1) + raw(-2))), two);
  EXPECT_EQ(values_of(npy("'<i8'", "(2,)", raw(std::int64_t{1}) + raw(std::int64_t{-2}))), two);
  EXPECT_EQ(values_of(npy("'|i1'", "(2,)", "\x01\xfe")), two);
  EXPECT_EQ(values_of(npy("'>f4'", "(2,)", std::string("\x3f\x80\0\0\xc0\0\0\0", 8))), two);
  EXPECT_EQ(values_of(npy("'<f2'", "(2,)", std::string("\0\x3c\0\xc0", 4))), two);
  EXPECT_EQ(values_of(npy("'|u1'", "(2,)", "\x01\xfe")), (Vector(2) << 1, 254).finished());
  EXPECT_EQ(values_of(npy("'|b1'", "(2,)", std::string("\0\5", 2))), (Vector(2) << 0, 1).finished());
}

TEST(DecodeNpy, KeepsWhatDoublesLeaveOfWholeNumbers) {
  const std::int64_t odd = (std::int64_t{1} << 60) + 1;
  const auto contents = decoded(npy("'<i8'", "(2, 2)", raw(odd) + raw(std::int64_t{5}) + raw(-odd) + raw(odd - 1)));
  ASSERT_TRUE(contents) << contents.error().line();
  const Rests& rests = contents->arrays.front().rests;  // column by column
  EXPECT_EQ((std::vector<int>{rests[0], rests[1], rests[2], rests[3]}), (std::vector<int>{1, -1, 0, 0}));
}

TEST(DecodeNpy, KeepsArraysOfMoreDimensionsAsTheyStand) {
  std::string data;
  for (std::int16_t k = 0; k < 8; ++k) data += raw(k);
  for (const bool fortran : {false, true}) {
    const auto contents = decoded(npy("'<i2'", "(2, 2, 2)", data, fortran));
    ASSERT_TRUE(contents) << contents.error().line();
    EXPECT_EQ(contents->arrays[0].values, Vector::LinSpaced(8, 0, 7));
    EXPECT_EQ(contents->arrays[0].row_major, !fortran);
    EXPECT_TRUE(contents->arrays[0].is_block());
  }
}

TEST(DecodeNpy, TakesFieldsAsColumns) {
  const std::string data = raw(0.5) + raw(3.0F) + raw(4.0F) + std::string("\xb5\0\0\0x\0\0\0", 8) + raw(1.5) +
                           raw(5.0F) + raw(6.0F) + std::string("\0\0\0\0\0\0\0\0", 8);
  const auto contents =
      decoded(npy("[('time', '<f8'), ('', '|V4'), (('long', 'x'), '<f4'), ('who', '<U2')]", "(2,)", data));
  ASSERT_TRUE(contents) << contents.error().line();
  ASSERT_EQ(contents->arrays.size(), 2U);
  EXPECT_EQ(contents->arrays[0].name, "time");
  EXPECT_EQ(contents->arrays[0].values, (Vector(2) << 0.5, 1.5).finished());
  EXPECT_EQ(contents->arrays[1].name, "x");
  EXPECT_EQ(contents->arrays[1].values, (Vector(2) << 4, 6).finished());
  EXPECT_EQ(contents->texts.front().lines, (std::vector<std::string>{"\xc2\xb5x", ""}));
  const auto nested = decoded(npy("[('a', [('t', '<f8')]), ('f', '<f4', (2,))]", "(2,)",
                                  raw(0.5) + raw(3.0F) + raw(4.0F) + raw(1.5) + raw(5.0F) + raw(6.0F)));
  ASSERT_TRUE(nested) << nested.error().line();
  EXPECT_EQ(nested->arrays[0].name, "a.t");
  EXPECT_EQ(nested->arrays[1].values, (Matrix(2, 2) << 3, 4, 5, 6).finished());
}

TEST(DecodeNpy, TakesDatesAndDurationsWithoutLosingDigits) {
  const std::int64_t begin = 1709337599'500000000;  // 2024-03-01T23:59:59.5
  const auto dates =
      decoded(npy("'<M8[ns]'", "(3,)", raw(begin) + raw(begin + 1'000'000'001) + raw(std::int64_t{1} << 63)));
  ASSERT_TRUE(dates) << dates.error().line();
  const auto& values = dates->arrays.front().values;
  EXPECT_EQ(values(0, 0), 86399.5);
  EXPECT_NEAR(values(1, 0) - values(0, 0), 1.000000001, 2e-11);
  EXPECT_TRUE(std::isnan(values(2, 0)));
  EXPECT_THAT(dates->notes, Contains(HasSubstr("2024-03-01 00:00")));
  const auto durations = decoded(npy("'<m8[us]'", "(1,)", raw(std::int64_t{1500})));
  EXPECT_EQ(durations->arrays.front().unit, "us");
  EXPECT_EQ(durations->arrays.front().values(0, 0), 1500.0);
}

TEST(DecodeNpy, RefusesWhatIsNotReadAndSaysWhatToDo) {
  EXPECT_THAT(error_of(npy("'|O'", "(2,)", "\x80\x03]q")), HasSubstr("Python"));
  EXPECT_THAT(error_of(npy("'<c16'", "(1,)", std::string(16, 'x'))), HasSubstr("'<c16'"));
  EXPECT_THAT(error_of(npy("'<f8'", "(1, 2, 3)", reals())), "none");
  EXPECT_THAT(error_of(npy("'|u1'", "(2, 2, 2)", std::string(8, 'x'))), HasSubstr("3 dimensions"));
}

TEST(DecodeNpy, RefusesWhatIsCutShortOrDamaged) {
  const std::string whole = npy("'<f8'", "(3, 2)", reals());
  for (std::size_t n = 6; n < whole.size(); ++n) EXPECT_NE(error_of(whole.substr(0, n)), "none") << n;
  EXPECT_THAT(error_of(whole.substr(0, whole.size() - 1)),
              AllOf(HasSubstr("3×2"), HasSubstr("8 bytes"), HasSubstr("47 bytes")));
  EXPECT_THAT(error_of(npy("'<f8'", "(4294967296, 4294967296)", "")), HasSubstr("4294967296×4294967296"));
  EXPECT_THAT(error_of(npy("'<f8'", "(-1,)", "")), HasSubstr("header"));
  EXPECT_THAT(error_of(npy("'<f8", "(1,)", "")), HasSubstr("header"));
  EXPECT_THAT(error_of(npy("'<f8'", "(1,)", reals(), false, 4)), HasSubstr("4.0"));
  EXPECT_THAT(error_of(npy(std::string(1000, '['), "(1,)", "")), HasSubstr("header"));
}

TEST(DecodeNpz, ReadsArraysByTheirNames) {
  const std::string bytes = test::npz(
      {{"time.npy", npy("'<f8'", "(6,)", reals())}, {"odd.npy", npy("'|O'", "(1,)", "x")}, {"read.me", "text"}});
  const auto archive = ZipArchive::open(std::as_bytes(std::span(bytes)));
  ASSERT_TRUE(archive) << archive.error().line();
  ASSERT_TRUE(looks_like_npz(*archive));
  const auto contents = decode_npz(*archive);
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->arrays[0].name, "time");
  EXPECT_EQ(contents->arrays[0].values, Vector::LinSpaced(6, 1, 6));
  ASSERT_TRUE(contents->arrays[1].obstacle);
  EXPECT_THAT(contents->arrays[1].obstacle->line(), AllOf(HasSubstr("'odd'"), HasSubstr("Python")));
  EXPECT_THAT(contents->notes, Contains(HasSubstr("'read.me'")));
}

}  // namespace npy_test
}  // namespace mbk::recording
