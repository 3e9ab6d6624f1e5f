#include "mbk/files/contents/said_rates.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mbk::recording {
namespace said_rates_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Optional;

TEST(RateCalled, KnowsTheNamesAndUnitsOfRates) {
  for (const char* name : {"fs", "Fs", "rate", "sampling_rate", "SamplingRate", "Sampling rate", "SampleRate_Hz"}) {
    EXPECT_THAT(rate_called(name, 1000.0, ""), Optional(1000.0)) << name;
  }
  EXPECT_THAT(rate_called("fs", 2.0, "kHz"), Optional(2000.0));
  EXPECT_THAT(rate_called("fs_khz", 2.0, ""), Optional(2000.0));
  EXPECT_THAT(rate_called("dt", 0.001, ""), Optional(1000.0));
  EXPECT_THAT(rate_called("sample_time", 2.0, "ms"), Optional(500.0));
}

TEST(RateCalled, TakesNothingElseForARate) {
  for (const char* name : {"heart_rate", "offset", "frequency", "rate_limit", "", "hz", "date"}) {
    EXPECT_EQ(rate_called(name, 1000.0, ""), std::nullopt) << name;
  }
  EXPECT_EQ(rate_called("fs", 1000.0, "N"), std::nullopt);
  EXPECT_EQ(rate_called("fs", 0.0, ""), std::nullopt);
  EXPECT_EQ(rate_called("fs", -std::numeric_limits<double>::infinity(), ""), std::nullopt);
  EXPECT_EQ(rate_called("dt", 1.0, ""), std::nullopt);  // seconds or milliseconds
}

Array array(const char* name, Index rows, double value) {
  return {name, Matrix(Matrix::Constant(rows, 1, value))};
}

std::vector<double> rates(const Contents& contents) {
  std::vector<double> all;
  for (const Array& one : contents.arrays) all.push_back(one.rate_hz);
  return all;
}

TEST(GiveRates, TakesTheNearest) {
  Contents contents;
  contents.arrays = {array("x", 3, 0.0), array("emg.raw", 3, 0.0), array("emg2", 3, 0.0), array("fs", 1, 1000.0),
                     array("emg.fs", 1, 2000.0)};
  give_rates(contents);
  EXPECT_THAT(rates(contents), ElementsAre(1000.0, 2000.0, 1000.0, 0.0, 0.0));
  EXPECT_THAT(contents.notes, ElementsAre(AllOf(HasSubstr("1000 Hz"), HasSubstr("'fs'")),
                                          AllOf(HasSubstr("'emg'"), HasSubstr("2000 Hz"), HasSubstr("'emg.fs'"))));
}

TEST(GiveRates, TakesNoneOfTwoThatDiffer) {
  Contents contents;
  contents.arrays = {array("x", 3, 0.0), array("y", 3, 0.0), array("fs", 1, 1000.0), array("rate", 1, 50.0)};
  give_rates(contents);
  EXPECT_THAT(rates(contents), ElementsAre(0.0, 0.0, 0.0, 0.0));
  EXPECT_THAT(contents.notes,
              ElementsAre(AllOf(HasSubstr("'fs'"), HasSubstr("1000 Hz"), HasSubstr("'rate'"), HasSubstr(" 50 Hz"))));
}

}  // namespace said_rates_test
}  // namespace mbk::recording
