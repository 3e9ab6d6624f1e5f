#include "mbk/files/recording/write_contents.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "mbk/files/contents/test_files.h"
#include "mbk/files/recording/read.h"

namespace mbk::recording {
namespace write_contents_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

const Matrix kWide =
    (Matrix(2, 4) << 1, 2, 3, 4, 0.1, -0.0, std::numeric_limits<double>::infinity(), 1e-300).finished();

Contents example() {
  Contents contents;
  contents.format = "HDF5";
  contents.arrays.push_back({"trial/gaze", Matrix(kWide), "deg"});
  contents.arrays.push_back({"pressure", Matrix(Vector::LinSpaced(4, 0, 3)), "Pa"});
  contents.arrays.back().rate_hz = 100.0;
  contents.metadata = {{"participant", "7"}};
  contents.events = {{0.5, "onset", 1.0}};
  return contents;
}

std::map<std::string, std::string> units_of(const Contents& contents) {
  std::map<std::string, std::string> units;
  for (const Array& array : contents.arrays) units[array.name] = array.unit;
  return units;
}

const SharedMatrix& values(const Contents& contents, const std::string& name) {
  static const SharedMatrix none;
  const auto found = std::ranges::find(contents.arrays, name, &Array::name);
  EXPECT_NE(found, contents.arrays.end()) << name;
  return found == contents.arrays.end() ? none : found->values;
}

class WriteContents : public testing::Test {
 protected:
  Contents back(const Contents& contents, const std::string& name, Format format, std::vector<std::string>& said) {
    const auto written = write_contents(contents, folder_ / name, format, false);
    EXPECT_TRUE(written) << written.error().line();
    if (!written) return {};
    said = *written;
    auto read = read_contents(*open(folder_ / name).value());
    EXPECT_TRUE(read) << read.error().line();
    return read ? std::move(*read) : Contents{};
  }
  Error refused(const Contents& contents, const std::string& name, Format format) {
    const auto written = write_contents(contents, folder_ / name, format, false);
    EXPECT_FALSE(written);
    EXPECT_FALSE(std::filesystem::exists(folder_ / name));
    return written ? Error{} : written.error();
  }
  test::Folder folder_;
};

TEST_F(WriteContents, KeepsNamesNumbersUnitsAndMetadataInHdf5) {
  std::vector<std::string> said;
  const Contents read = back(example(), "a.h5", Format::hdf5, said);
  EXPECT_THAT(said, IsEmpty());
  EXPECT_EQ(values(read, "trial/gaze"), kWide);
  EXPECT_EQ(values(read, "pressure"), Matrix(Vector::LinSpaced(4, 0, 3)));
  EXPECT_EQ(units_of(read), (std::map<std::string, std::string>{{"trial/gaze", "deg"}, {"pressure", "Pa"}}));
  EXPECT_EQ(read.metadata.at("participant"), "7");
  ASSERT_EQ(read.events.size(), 1u);
  EXPECT_EQ(read.events[0].name, "onset");
}

TEST_F(WriteContents, FindsOtherNamesWhereOneStandsInTheWay) {
  Contents contents = example();
  contents.arrays.push_back({"pressure/left", Matrix(Matrix::Ones(2, 1))});
  contents.arrays.push_back({"pressure", Matrix(Matrix::Ones(3, 1))});
  contents.arrays.push_back({"", Matrix(Matrix::Ones(4, 1))});
  std::vector<std::string> said;
  const Contents read = back(contents, "a.h5", Format::hdf5, said);
  EXPECT_THAT(said, ElementsAre(AllOf(HasSubstr("'pressure/left'"), HasSubstr("'pressure_left'")),
                                AllOf(HasSubstr("'pressure'"), HasSubstr("'pressure_2'"))));
  EXPECT_EQ(values(read, "pressure_left").size(), 2);
  EXPECT_EQ(values(read, "pressure_2").size(), 3);
  EXPECT_EQ(values(read, "column_5").size(), 4);
}

TEST_F(WriteContents, GivesVariablesNamesThatMatlabHas) {
  Contents contents = example();
  contents.arrays.push_back({"signals(1).values", Matrix(Matrix::Ones(3, 3))});
  contents.arrays.push_back({"signals(1)_values", Matrix(Matrix::Ones(5, 1))});
  contents.arrays.push_back({"3rd", Matrix(Matrix::Ones(1, 1))});
  for (const Format format : {Format::mat5, Format::mat73}) {
    std::vector<std::string> said;
    const Contents read = back(contents, format == Format::mat5 ? "a.mat" : "b.mat", format, said);
    EXPECT_THAT(said, ElementsAre(AllOf(HasSubstr("'trial/gaze'"), HasSubstr("'trial_gaze'")),
                                  AllOf(HasSubstr("'signals(1).values'"), HasSubstr("'signals_1__values'")),
                                  AllOf(HasSubstr("'signals(1)_values'"), HasSubstr("'signals_1__values_2'")),
                                  AllOf(HasSubstr("'3rd'"), HasSubstr("'x3rd'"))));
    EXPECT_EQ(values(read, "trial_gaze"), kWide);
    EXPECT_EQ(values(read, "signals_1__values_2").size(), 5);
    EXPECT_EQ(values(read, "rates_hz.pressure")(0, 0), 100.0);
    EXPECT_EQ(read.metadata.at("participant"), "7");
    EXPECT_EQ(read.events.size(), 1u);
    EXPECT_THAT(read.notes, Contains(HasSubstr("'units.pressure'")));
  }
}

TEST_F(WriteContents, MakesOneTableOfSignalsOfOneLength) {
  std::vector<std::string> said;
  Contents contents = example();
  const Contents read = back(contents, "a.csv", Format::csv, said);
  EXPECT_THAT(said, ElementsAre(AllOf(HasSubstr("1 event"), HasSubstr("CSV"))));
  ASSERT_EQ(read.arrays.size(), 3u);
  EXPECT_EQ(read.arrays[0].name, "trial/gaze[1] [deg]");
  EXPECT_EQ(values(read, "trial/gaze[2] [deg]"), Matrix(kWide.row(1).transpose()));
  EXPECT_EQ(values(read, "pressure [Pa]"), Matrix(Vector::LinSpaced(4, 0, 3)));

  contents.arrays.front().rate_hz = 100.0;
  contents.arrays.front().name = "a,b\"";
  const Contents timed = back(contents, "timed.csv", Format::csv, said);
  EXPECT_THAT(said, Contains(AllOf(HasSubstr("time"), HasSubstr("column"))));
  EXPECT_THAT(said, Contains(AllOf(HasSubstr("'a,b\"[1] [deg]'"), HasSubstr("'a_b_[1] [deg]'"))));
  EXPECT_EQ(values(timed, "time_s")(3, 0), 0.03);
}

TEST_F(WriteContents, RefusesATableOfDifferentLengthsOrClocks) {
  Contents contents = example();
  contents.arrays.push_back({"short", Matrix(Matrix::Ones(3, 1))});
  EXPECT_THAT(refused(contents, "a.csv", Format::csv).line(),
              AllOf(HasSubstr("'trial/gaze'"), HasSubstr("4 samples"), HasSubstr("'short'"), HasSubstr(".h5")));
  contents.arrays.pop_back();
  contents.clocks = {{"a", Vector::LinSpaced(4, 0, 1)}, {"b", Vector::LinSpaced(4, 0, 2)}};
  contents.arrays[0].clock = 0;
  contents.arrays[1].clock = 1;
  EXPECT_THAT(refused(contents, "a.csv", Format::csv).message, HasSubstr("clock"));
  contents.arrays.clear();
  for (const Format format : {Format::csv, Format::hdf5, Format::mat5}) {
    EXPECT_THAT(refused(contents, "a", format).message, HasSubstr("array"));
  }
}

TEST_F(WriteContents, KeepsTheStampsOfClocks) {
  Contents contents = example();
  contents.clocks = {{"robot/1", Vector::LinSpaced(4, 5, 8)}};
  for (Array& array : contents.arrays) array.clock = 0;
  std::vector<std::string> said;
  EXPECT_EQ(values(back(contents, "a.h5", Format::hdf5, said), "clocks/robot_1"), Matrix(Vector::LinSpaced(4, 5, 8)));
  EXPECT_EQ(values(back(contents, "a.mat", Format::mat5, said), "clock_robot_1").size(), 4);
  EXPECT_EQ(values(back(contents, "a.csv", Format::csv, said), "time_s")(3, 0), 8.0);
}

TEST_F(WriteContents, ReplacesNothingUnasked) {
  folder_.write("a.h5", "precious");
  EXPECT_EQ(write_contents(example(), folder_ / "a.h5", Format::hdf5, false).error().kind, ErrorKind::usage);
  EXPECT_EQ(test::bytes_of(folder_ / "a.h5"), "precious");
  EXPECT_TRUE(write_contents(example(), folder_ / "a.h5", Format::hdf5, true));
}

}  // namespace write_contents_test
}  // namespace mbk::recording
