#include "mbk/files/recording/mat_level5.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <random>
#include <span>
#include <utility>

#include "mbk/files/contents/test_files.h"

namespace mbk::recording {
namespace mat_level5_test {

using test::compressed5;
using test::double5;
using test::element5;
using test::header5;
using test::matrix5;
using test::raw;
using test::struct5;
using testing::ElementsAre;
using testing::HasSubstr;

const Matrix kValues = (Matrix(2, 3) << 1, 2, 3, 4, 5, 6.5).finished();

/// By a copy of the numbers; where they stand in the bytes they must be the same, and stay when the file is let go.
Result<Contents> decode(std::string_view bytes) {
  auto copied = decode_mat_level5(std::as_bytes(std::span(bytes)));
  auto file = std::make_shared<Buffer>(bytes.size());
  std::memcpy(file->data.get(), bytes.data(), bytes.size());
  const auto standing = decode_mat_level5(std::move(file));
  EXPECT_EQ(standing.has_value(), copied.has_value());
  if (!standing || !copied) {
    if (!standing && !copied) {
      EXPECT_EQ(standing.error().line(), copied.error().line());
    }
    return copied;
  }
  EXPECT_EQ(standing->format, copied->format);
  EXPECT_EQ(standing->notes, copied->notes);
  EXPECT_EQ(standing->arrays.size(), copied->arrays.size());
  for (std::size_t k = 0; k < std::min(standing->arrays.size(), copied->arrays.size()); ++k) {
    const SharedMatrix &a = standing->arrays[k].values, &b = copied->arrays[k].values;
    EXPECT_TRUE(a.rows() == b.rows() && a.cols() == b.cols());
    EXPECT_TRUE(a.rows() != b.rows() || a.cols() != b.cols() ||
                std::equal(a.data(), a.data() + a.size(), b.data(),
                           [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); }));
  }
  return copied;
}

TEST(SharedMatrix, KeepsWhatItsNumbersStandIn) {
  auto numbers = std::make_shared<Vector>(Vector::LinSpaced(6, 1.0, 6.0));
  const std::weak_ptr<Vector> watched = numbers;
  SharedMatrix matrix(numbers->data(), 2, 3, numbers);
  numbers.reset();
  const SharedMatrix copy = matrix;
  EXPECT_NE(copy.data(), matrix.data());
  EXPECT_EQ(copy, matrix);
  SharedMatrix moved = std::move(matrix);
  EXPECT_FALSE(watched.expired());
  EXPECT_EQ(moved, copy);
  moved.conservativeResize(2, 2);  // into memory of its own
  EXPECT_TRUE(watched.expired());
  EXPECT_EQ(moved, copy.leftCols(2));
  moved.resize(0, 0);
  EXPECT_EQ(moved.size(), 0);
  EXPECT_EQ(copy(1, 2), 6.0);
}

std::string error_of(std::string_view bytes) {
  const auto contents = decode(bytes);
  EXPECT_FALSE(contents);
  return contents ? "" : contents.error().line();
}

TEST(DecodeMatLevel5, ReadsUncompressedMatrices) {
  const auto contents = decode(header5() + double5("z", kValues) + double5("name_longer_than_four", kValues));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->format, "MAT v5");
  ASSERT_EQ(contents->arrays.size(), 2u);
  EXPECT_EQ(contents->arrays[0].name, "z");
  EXPECT_EQ(contents->arrays[0].values, kValues);
  EXPECT_EQ(contents->arrays[1].values, kValues);
}

TEST(DecodeMatLevel5, ReadsCompressedMatrices) {
  const auto contents = decode(header5() + compressed5(double5("z", kValues)));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->format, "MAT v7");
  EXPECT_EQ(contents->arrays[0].values, kValues);
}

TEST(DecodeMatLevel5, ReadsBigEndianFiles) {
  const auto contents = decode(header5(true) + double5("z", kValues, true));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->arrays[0].values, kValues);
}

TEST(DecodeMatLevel5, ReadsEveryNumberFormat) {
  const std::pair<std::uint32_t, std::string> stored[] = {{1, raw(std::int8_t{-7}) + raw(std::int8_t{8})},
                                                          {2, raw(std::uint8_t{200}) + raw(std::uint8_t{8})},
                                                          {3, raw(std::int16_t{-300}) + raw(std::int16_t{8})},
                                                          {4, raw(std::uint16_t{60000}) + raw(std::uint16_t{8})},
                                                          {5, raw(std::int32_t{-70000}) + raw(std::int32_t{8})},
                                                          {6, raw(std::uint32_t{70000}) + raw(std::uint32_t{8})},
                                                          {7, raw(0.5f) + raw(8.0f)},
                                                          {12, raw(std::int64_t{-9}) + raw(std::int64_t{8})},
                                                          {13, raw(std::uint64_t{9}) + raw(std::uint64_t{8})}};
  const double first[] = {-7, 200, -300, 60000, -70000, 70000, 0.5, -9, 9};
  for (std::size_t i = 0; i < std::size(stored); ++i) {
    const auto contents = decode(header5() + matrix5("z", {1, 2}, element5(stored[i].first, stored[i].second)));
    ASSERT_TRUE(contents) << contents.error().line();
    EXPECT_EQ(contents->arrays[0].values(0, 0), first[i]);
    EXPECT_EQ(contents->arrays[0].values(0, 1), 8);
  }
}

TEST(DecodeMatLevel5, ReadsNumbersWithinStructures) {
  const std::string inner = struct5("", {{"values", double5("", kValues)}});
  const auto contents = decode(header5() + struct5("log", {{"time", double5("", kValues)}, {"signals", inner}}));
  ASSERT_TRUE(contents) << contents.error().line();
  ASSERT_EQ(contents->arrays.size(), 2u);
  EXPECT_EQ(contents->arrays[0].name, "log.time");
  EXPECT_EQ(contents->arrays[1].name, "log.signals.values");
  EXPECT_EQ(contents->arrays[1].values, kValues);
}

TEST(DecodeMatLevel5, KeepsWhatDoublesLeaveOfWholeNumbers) {
  constexpr std::int64_t kOdd = (std::int64_t{1} << 60) + 1;
  for (const bool swapped : {false, true}) {
    const std::string stored = element5(12, raw(kOdd, swapped) + raw(kOdd - 1, swapped), swapped);
    const auto contents = decode(header5(swapped) + matrix5("t", {2, 1}, stored, 14, swapped));
    ASSERT_TRUE(contents) << contents.error().line();
    EXPECT_EQ(contents->arrays[0].rests[0], 1);
    EXPECT_EQ(contents->arrays[0].rests[1], 0);
  }
}

TEST(DecodeMatLevel5, TakesTheSampleRateFromAVariable) {
  const auto contents = decode(
      header5() + double5("fs", Matrix::Constant(1, 1, 500.0)) + double5("force", kValues) +
      struct5("emg", {{"SampleRate", double5("", Matrix::Constant(1, 1, 2000.0))}, {"raw", double5("", kValues)}}));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->arrays[1].rate_hz, 500.0);
  EXPECT_EQ(contents->arrays[3].rate_hz, 2000.0);
}

TEST(DecodeMatLevel5, LeavesAsideWhatIsNotARealMatrixAndSaysSo) {
  const std::string opaque =
      element5(14, element5(6, raw(std::uint32_t{17}) + raw(std::uint32_t{0})) + element5(1, "nlid") +
                       element5(1, "MCOS") + element5(1, "nldat") + double5("", kValues));
  const auto contents = decode(header5() + opaque + matrix5("text", {1, 1}, element5(18, raw(U'a')), 4) +
                               matrix5("sparse", {9, 9}, "", 5) +
                               matrix5("z", {1, 1}, element5(9, raw(1.0)) + element5(9, raw(1.0)), 0x0806) +
                               matrix5("images", {2, 1, 2, 2}, element5(2, std::string(8, '\0')), 9));
  ASSERT_TRUE(contents) << contents.error().line();
  ASSERT_EQ(contents->arrays.size(), 1u);
  EXPECT_TRUE(contents->arrays[0].obstacle);
  EXPECT_THAT(contents->notes, ElementsAre(AllOf(HasSubstr("'nlid'"), HasSubstr("'nldat'")), HasSubstr("'text'"),
                                           AllOf(HasSubstr("'sparse'"), HasSubstr("matrix")),
                                           AllOf(HasSubstr("'z'"), HasSubstr("complex")),
                                           AllOf(HasSubstr("'images'"), HasSubstr("4 dimensions"))));
}

TEST(DecodeMatLevel5, ReadsObjectsOfTheOldKindAsStructures) {
  std::string object = struct5("old", {{"force", double5("", kValues)}});
  const std::string tag = raw(std::uint32_t{2}) + raw(std::uint32_t{0});  // class of a structure, without flags
  object.replace(object.find(tag), 4, raw(std::uint32_t{3}));
  const std::string width = element5(5, raw(std::int32_t{16}));
  object.insert(object.find(width), element5(1, "sensor"));
  std::string size = raw(static_cast<std::uint32_t>(object.size() - 8));
  object.replace(4, 4, size);
  const auto contents = decode(header5() + object);
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->arrays.at(0).name, "old.force");
  EXPECT_EQ(contents->arrays.at(0).values, kValues);
  EXPECT_THAT(contents->notes, ElementsAre(AllOf(HasSubstr("'old'"), HasSubstr("'sensor'"), HasSubstr("structure"))));
}

TEST(DecodeMatLevel5, KeepsArraysOfMoreDimensionsAsTheyStand) {
  const auto contents =
      decode(header5() + matrix5("cube", {2, 1, 3, 2}, element5(9, test::doubles(Vector::LinSpaced(12, 0, 11)))) +
             matrix5("flat", {2, 1, 3}, element5(9, test::doubles(Vector::LinSpaced(6, 0, 5)))));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->arrays.at(0).shape, (std::vector<std::uint64_t>{2, 1, 3, 2}));
  EXPECT_EQ(contents->arrays.at(0).values, Vector::LinSpaced(12, 0, 11));
  EXPECT_EQ(contents->arrays.at(1).values, (Matrix(2, 3) << 0, 2, 4, 1, 3, 5).finished());
}

TEST(DecodeMatLevel5, ReadsCellsThatHoldNumbersAndStructures) {
  const std::string text = matrix5("", {1, 2}, element5(1, "on"), 4);
  const std::string cells = double5("", kValues) + text + struct5("", {{"f", double5("", 2 * kValues)}}) +
                            matrix5("", {1, 1}, double5("", 3 * kValues), 1);
  const auto contents = decode(header5() + matrix5("c", {2, 2}, cells, 1));
  ASSERT_TRUE(contents) << contents.error().line();
  ASSERT_EQ(contents->arrays.size(), 3u);
  EXPECT_EQ(contents->arrays[0].name, "c{1}");
  EXPECT_EQ(contents->arrays[1].name, "c{3}.f");
  EXPECT_EQ(contents->arrays[2].name, "c{4}{1}");
  EXPECT_EQ(contents->arrays[2].values, 3 * kValues);
  EXPECT_TRUE(contents->texts.empty());
  EXPECT_THAT(contents->notes, ElementsAre(AllOf(HasSubstr("text"), HasSubstr("'c'"))));
  const auto many = decode(header5() + matrix5("c", {1025, 1}, double5("", kValues), 1));
  EXPECT_THAT(error_of(header5() + matrix5("c", {2, 1}, double5("", kValues), 1)), HasSubstr("cell"));
  EXPECT_FALSE(many && many->notes.empty());
}

TEST(DecodeMatLevel5, TellsFieldsOfOneNameApart) {
  const auto contents =
      decode(header5() +
             struct5("s", {{"a", double5("", kValues)}, {"b", double5("", kValues)}, {"a", double5("", 2 * kValues)}}));
  ASSERT_TRUE(contents) << contents.error().line();
  ASSERT_EQ(contents->arrays.size(), 3u);
  EXPECT_EQ(contents->arrays[0].name, "s.a");
  EXPECT_EQ(contents->arrays[2].name, "s.a#2");
  EXPECT_EQ(contents->arrays[2].values, 2 * kValues);
  EXPECT_THAT(contents->notes, ElementsAre(AllOf(HasSubstr("'s'"), HasSubstr("'a'"), HasSubstr("'a#2'"))));
}

TEST(DecodeMatLevel5, TakesUnsignedDimensions) {
  std::string variable = double5("z", kValues);
  const std::string requested = raw(std::uint32_t{5}) + raw(std::uint32_t{8});  // int32, 8 bytes
  const std::size_t at = variable.find(requested);
  ASSERT_NE(at, variable.npos);
  variable.replace(at, 4, raw(std::uint32_t{6}));
  const auto contents = decode(header5() + variable);
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->arrays.at(0).values, kValues);
  variable.replace(at, 4, raw(std::uint32_t{7}));
  EXPECT_THAT(error_of(header5() + variable), HasSubstr("dimensions"));
}

TEST(DecodeMatLevel5, LeavesSidesOfOneOut) {
  std::string bytes;
  for (double v = 1; v <= 6; ++v) bytes += raw(v);
  const auto contents = decode(header5() + matrix5("p", {3, 1, 2}, element5(9, bytes)));
  ASSERT_TRUE(contents) << contents.error().line();
  EXPECT_EQ(contents->arrays.at(0).values, (Matrix(3, 2) << 1, 4, 2, 5, 3, 6).finished());
  EXPECT_THAT(contents->notes, ElementsAre(AllOf(HasSubstr("'p'"), HasSubstr("3×1×2"), HasSubstr("3×2"))));
}

std::string utf16(std::u16string_view text) {
  std::string bytes;
  for (const char16_t unit : text) bytes += raw(unit);
  return bytes;
}

std::vector<std::string> lines_of(const std::string& variable) {
  const auto contents = decode(header5() + variable);
  EXPECT_TRUE(contents) << contents.error().line();
  if (!contents || contents->texts.size() != 1) return {"not one text"};
  EXPECT_TRUE(contents->notes.empty());
  return contents->texts[0].lines;
}

TEST(DecodeMatLevel5, ReadsTextInEachEncoding) {
  EXPECT_THAT(lines_of(matrix5("t", {1, 4}, element5(4, utf16(u"é😀a")), 4)), ElementsAre("é😀a"));
  EXPECT_THAT(lines_of(matrix5("t", {1, 2}, element5(17, utf16(u"né")), 4)), ElementsAre("né"));
  EXPECT_THAT(lines_of(matrix5("t", {1, 2}, element5(16, "né"), 4)), ElementsAre("né"));
  EXPECT_THAT(lines_of(matrix5("t", {1, 2}, element5(1, "n\xe9"), 4)), ElementsAre("né"));
  EXPECT_THAT(lines_of(matrix5("t", {0, 0}, element5(4, ""), 4)), ElementsAre(""));
  EXPECT_THAT(lines_of(matrix5("t", {1, 2}, element5(4, utf16({u"\xD800\x1B", 2})), 4)), ElementsAre("\uFFFD?"));
  const auto big = decode(header5(true) + matrix5("t", {1, 2}, element5(4, std::string("\0a\0b", 4), true), 4, true));
  ASSERT_TRUE(big) << big.error().line();
  EXPECT_THAT(big->texts.at(0).lines, ElementsAre("ab"));
}

TEST(DecodeMatLevel5, KeepsTheLinesOfATextApart) {
  EXPECT_THAT(lines_of(matrix5("t", {1, 4}, element5(4, utf16(u"a\nb\n")), 4)), ElementsAre("a", "b"));
  const std::string cell = matrix5("", {1, 3}, element5(4, utf16(u"a\nb")), 4);
  EXPECT_THAT(lines_of(matrix5("t", {1, 1}, cell, 1)), ElementsAre("a; b"));
}

TEST(DecodeMatLevel5, ReadsCharMatricesByRowAndCellsOfText) {
  EXPECT_THAT(lines_of(matrix5("t", {2, 3}, element5(4, utf16(u"adb c ")), 4)), ElementsAre("abc", "d"));
  const std::string cells = matrix5("", {1, 2}, element5(4, utf16(u"on")), 4) + matrix5("", {0, 0}, element5(4, ""), 4);
  EXPECT_THAT(lines_of(matrix5("t", {2, 1}, cells, 1)), ElementsAre("on", ""));
}

TEST(DecodeMatLevel5, TakesTextWithoutBytesAsBlanks) {
  EXPECT_THAT(lines_of(matrix5("t", {1, 3}, element5(4, ""), 4)), ElementsAre("   "));
  EXPECT_THAT(lines_of(matrix5("t", {2, 3}, element5(1, ""), 4)), ElementsAre("", ""));
  const auto many = decode(header5() + matrix5("t", {1, 2147483647}, element5(1, ""), 4));
  ASSERT_TRUE(many);
  EXPECT_THAT(many->notes, ElementsAre(AllOf(HasSubstr("'t'"), HasSubstr("text"))));
}

TEST(DecodeMatLevel5, RefusesTextThatDoesNotMatchItsDimensions) {
  EXPECT_THAT(error_of(header5() + matrix5("t", {1, 3}, element5(4, utf16(u"ab")), 4)),
              AllOf(HasSubstr("'t'"), HasSubstr("1×3"), HasSubstr("byte")));
  EXPECT_THAT(error_of(header5() + matrix5("t", {1, 1}, element5(4, "abc"), 4)),
              AllOf(HasSubstr("'t'"), HasSubstr("1×1")));
  EXPECT_THAT(error_of(header5() + matrix5("t", {2, 1}, element5(16, "abc"), 4)),
              AllOf(HasSubstr("'t'"), HasSubstr("2×1")));
  EXPECT_THAT(error_of(header5() + matrix5("t", {3, 1}, matrix5("", {1, 1}, element5(1, "a"), 4), 1)),
              HasSubstr("cell"));
  const auto many = decode(header5() + matrix5("t", {2147483647, 0}, element5(1, ""), 4));
  ASSERT_TRUE(many);
  EXPECT_THAT(many->notes, ElementsAre(AllOf(HasSubstr("'t'"), HasSubstr("text"))));
}

TEST(DecodeMatLevel5, RefusesDimensionsThatDoNotMatchTheData) {
  EXPECT_THAT(error_of(header5() + matrix5("z", {2, 3}, element5(9, raw(1.0)))),
              AllOf(HasSubstr("'z'"), HasSubstr("2×3"), HasSubstr("byte")));
  EXPECT_THAT(error_of(header5() + matrix5("z", {2147483647, 2147483647, 2147483647}, element5(9, raw(1.0)))),
              AllOf(HasSubstr("'z'"), HasSubstr("2147483647×2147483647×2147483647")));
  EXPECT_THAT(error_of(header5() + matrix5("z", {-1, 1}, element5(9, raw(1.0)))),
              AllOf(HasSubstr("dimension"), HasSubstr("-1")));
}

TEST(DecodeMatLevel5, RefusesStructuresNestedTooDeeply) {
  std::string inner = double5("", kValues);
  for (int i = 0; i < 40; ++i) inner = struct5("", {{"f", inner}});
  EXPECT_THAT(error_of(header5() + struct5("s", {{"f", inner}})), HasSubstr("structure"));
}

TEST(DecodeMatLevel5, RefusesCompressedDataWhoseChecksumIsWrong) {
  std::string file = header5() + compressed5(double5("z", kValues));
  file.back() = static_cast<char>(file.back() ^ 1);
  EXPECT_THAT(error_of(file), HasSubstr("checksum"));
}

TEST(DecodeMatLevel5, RefusesCompressedDataThatHoldsMoreOrLessThanClaimed) {
  const std::string matrix = double5("z", kValues), claimed = std::to_string(matrix.size()) + " bytes";
  EXPECT_THAT(error_of(header5() + compressed5(matrix + "12345678")), HasSubstr(claimed));
  EXPECT_THAT(error_of(header5() + compressed5(matrix.substr(0, matrix.size() - 8))), HasSubstr(claimed));
}

TEST(DecodeMatLevel5, DoesNotBelieveAnAbsurdClaim) {
  std::string matrix = double5("z", kValues);
  matrix.replace(4, 4, raw(std::uint32_t{0xFFFFFFF0}));
  EXPECT_THAT(error_of(header5() + compressed5(matrix)), HasSubstr("4294967288 bytes"));
}

TEST(DecodeMatLevel5, RefusesAFileCutAnywhere) {
  for (const std::string& variable :
       {double5("logs", kValues), compressed5(double5("logs", kValues)), struct5("s", {{"a", double5("", kValues)}})}) {
    const std::string whole = header5() + variable;
    for (std::size_t n = 0; n < whole.size(); ++n) {
      const auto contents = decode(std::string_view(whole).substr(0, n));
      if (n == 128) {  // a header and no variable
        ASSERT_TRUE(contents && contents->arrays.empty());
      } else {
        ASSERT_FALSE(contents) << "cut to " << n << " of " << whole.size();
      }
    }
  }
}

TEST(DecodeMatLevel5, SurvivesFlippedBytes) {
  const std::string plain =
      header5() + double5("logs", kValues) +
      struct5("s", {{"a", double5("", kValues)}, {"b", struct5("", {{"c", double5("", kValues)}})}}) +
      matrix5("cells", {1, 1}, double5("", kValues), 1) +
      struct5("events", {{"name", matrix5("", {2, 1},
                                          matrix5("", {1, 2}, element5(4, utf16(u"on")), 4) +
                                              matrix5("", {2, 2}, element5(16, "o fé"), 4),
                                          1)},
                         {"text", matrix5("", {2, 3}, element5(17, utf16(u"adb c ")), 4)}});
  const std::string packed = header5() + compressed5(double5("logs", test::logs(20)));
  std::mt19937 random(20130601);
  for (int i = 0; i < 20000; ++i) {
    std::string file = i % 2 == 0 ? plain : packed;
    const std::size_t at = random() % file.size();
    file[at] = static_cast<char>(random());
    const auto contents = decode(file);
    if (contents) {
      for (const Array& array : contents->arrays) ASSERT_LE(array.values.size(), 19 * 20) << "byte " << at;
      for (const Text& text : contents->texts) ASSERT_LE(text.lines.size(), 100'000u) << "byte " << at;
    }
  }
}

}  // namespace mat_level5_test
}  // namespace mbk::recording
