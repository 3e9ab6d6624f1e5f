#include "mbk/files/tables/octave_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <string>

namespace mbk::recording {
namespace octave_text_test {

using testing::Contains;
using testing::HasSubstr;

const std::string kFirst = "# Created by Octave 7.3.0, Mon Jan 01 10:00:00 2024 UTC <me@here>\n";

Contents decoded(const std::string& text) {
  const std::string whole = kFirst + text;
  EXPECT_TRUE(looks_like_octave_text(whole));
  auto contents = decode_octave_text(std::as_bytes(std::span(whole)));
  EXPECT_TRUE(contents) << contents.error().line();
  return contents ? std::move(*contents) : Contents();
}

std::string error_of(const std::string& text) {
  const std::string whole = kFirst + text;
  const auto contents = decode_octave_text(std::as_bytes(std::span(whole)));
  return contents ? "none" : contents.error().line();
}

TEST(DecodeOctaveText, ReadsEveryVariableByItself) {
  const Contents contents = decoded(
      "# name: t\n# type: matrix\n# rows: 2\n# columns: 1\n 0\n 0.5\n\n\n# name: data\n# type: matrix\n# rows: 2\n"
      "# columns: 2\n 1 NA\n -Inf 4\n\n\n# name: k\n# type: int32 matrix\n# ndims: 2\n 1 2\n  3\n  4\n\n\n"
      "# name: ok\n# type: bool\n1\n\n\n# name: r\n# type: range\n# base, limit, increment\n0 1 0.25\n\n\n"
      "# name: who\n# type: string\n# elements: 1\n# length: 5\nP 007\n\n\n");
  ASSERT_EQ(contents.arrays.size(), 5U);
  EXPECT_EQ(contents.arrays[0].values, (Vector(2) << 0, 0.5).finished());
  EXPECT_EQ(contents.arrays[1].name, "data");
  EXPECT_TRUE(std::isnan(contents.arrays[1].values(0, 1)) && std::isinf(contents.arrays[1].values(1, 0)));
  EXPECT_EQ(contents.arrays[2].values, (Matrix(1, 2) << 3, 4).finished());
  EXPECT_EQ(contents.arrays[4].values, Vector::LinSpaced(5, 0, 1).transpose());
  EXPECT_EQ(contents.texts.front().lines.front(), "P 007");
}

TEST(DecodeOctaveText, ReadsStructuresAndPassesOverTheRest) {
  const Contents contents = decoded(
      "# name: trial\n# type: scalar struct\n# ndims: 2\n 1 1\n# length: 2\n# name: x\n# type: scalar\n1.5\n\n\n"
      "# name: in\n# type: scalar struct\n# ndims: 2\n 1 1\n# length: 1\n# name: F\n# type: scalar\n2\n\n\n\n\n\n\n"
      "# name: c\n# type: cell\n# rows: 1\n# columns: 2\n# name: <cell-element>\n# type: scalar\n1\n\n\n"
      "# name: <cell-element>\n# type: scalar struct\n# ndims: 2\n 1 1\n# length: 1\n# name: hidden\n# type: scalar\n"
      "7\n\n\n\n\n\n\n# name: z\n# type: complex matrix\n# rows: 1\n# columns: 1\n (1,2)\n\n\n"
      "# name: last\n# type: scalar\n9\n\n\n");
  ASSERT_EQ(contents.arrays.size(), 3U);
  EXPECT_EQ(contents.arrays[0].name, "trial.x");
  EXPECT_EQ(contents.arrays[1].name, "trial.in.F");
  EXPECT_EQ(contents.arrays[2].name, "last");
  EXPECT_THAT(contents.notes, Contains("variable 'c' is of the kind 'cell', which is not read; ignored"));
  EXPECT_THAT(contents.notes, Contains(HasSubstr("'z' is of the kind 'complex matrix'")));
}

TEST(DecodeOctaveText, RefusesWhatIsCutShortOrDamaged) {
  const std::string begin = "# name: x\n# type: matrix\n# rows: 2\n# columns: 2\n";
  EXPECT_THAT(error_of(begin + " 1.000000 2.000000\n"), HasSubstr("variable 'x': it is cut short"));
  EXPECT_THAT(error_of(begin + " 1 2\n 3\n"), HasSubstr("line 7, variable 'x': 1 numbers where 2 are expected"));
  EXPECT_THAT(error_of(begin + " 1 2\n 3 four\n"), HasSubstr("'four' is not a number"));
  EXPECT_THAT(error_of("# name: x\n# type: matrix\n# rows: 99999999\n# columns: 99999999\n 1\n"),
              HasSubstr("need more than the"));
  EXPECT_THAT(error_of("# name: x\n# type: range\n# base, limit, increment\n0 1 1e-12\n"), HasSubstr("is not read"));
}

}  // namespace octave_text_test
}  // namespace mbk::recording
