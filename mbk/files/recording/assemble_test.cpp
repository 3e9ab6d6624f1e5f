#include "mbk/files/recording/assemble.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mbk::recording {
namespace {

using testing::HasSubstr;

TEST(Assemble, SaysThatANamedLogsMatrixHoldsNoSample) {
  for (const auto& [rows, columns] : {std::pair<Index, Index>{19, 0}, {0, 19}, {0, 0}}) {
    Contents contents;
    contents.format = "MAT v5";
    contents.arrays.push_back({"logs", Matrix(rows, columns)});
    ReadOptions options;
    options.variable = "logs";
    const auto recording = assemble(contents, options);
    ASSERT_FALSE(recording);
    EXPECT_THAT(recording.error().line(), AllOf(HasSubstr("'logs'"), HasSubstr("sample")));
  }
}

Array column(std::string name, Index samples, double rate_hz, double slope = 1.0) {
  Array array{.name = std::move(name), .values = SharedMatrix::of_column(Vector::LinSpaced(samples, 0.0, slope))};
  array.rate_hz = rate_hz;
  array.signal = true;
  return array;
}

/// Angle and torque at 100 Hz, two muscles at 1 kHz.
Contents elbow_with_emg() {
  Contents contents;
  contents.format = "C3D";
  contents.table = true;
  contents.arrays = {column("position_rad", 101, 100.0), column("reaction_Nm", 101, 100.0, 2.0),
                     column("EMG1", 1001, 1000.0, 3.0), column("Triceps EMG [mV]", 1001, 1000.0, 4.0)};
  return contents;
}

TEST(Assemble, LeavesEmgAsideUnlessItIsAskedForAndSaysSo) {
  const auto recording = assemble(elbow_with_emg(), {.axes = 1});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->samples(), 101);
  EXPECT_EQ(recording->channels.size(), 2);
  EXPECT_THAT(recording->notes, testing::Contains(HasSubstr("EMG was found but not read: EMG1, Triceps EMG [mV]")));
}

TEST(Assemble, PutsMotionOnTheClockOfTheEmg) {
  ReadOptions options;
  options.axes = 1;
  options.emg = EmgReading::all;
  const auto recording = assemble(elbow_with_emg(), options);
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->samples(), 1001);
  ASSERT_NE(recording->find("emg_1"), nullptr);
  ASSERT_NE(recording->find("emg_triceps"), nullptr);
  EXPECT_EQ(recording->find("emg_1")->unit, "");
  EXPECT_EQ(recording->find("emg_1")->values[1000], 3.0);
  EXPECT_EQ(recording->find("emg_triceps")->unit, "V");
  EXPECT_NEAR(recording->find("emg_triceps")->values[1000], 4e-3, 1e-15);
  EXPECT_NEAR(recording->find("position")->values[505], 0.505, 1e-12);
}

TEST(Assemble, ReadsEmgBesideAMapAndUnderTheNameThatTheMapGives) {
  ReadOptions options;
  options.axes = 1;
  options.emg = EmgReading::all;
  options.channels = {{"x", "position_rad", "", false}, {"F", "2", "", false}, {"emg_biceps", "EMG1", "uV", false}};
  const auto recording = assemble(elbow_with_emg(), options);
  ASSERT_TRUE(recording) << recording.error().line();
  ASSERT_NE(recording->find("emg_biceps"), nullptr);
  EXPECT_NEAR(recording->find("emg_biceps")->values[1000], 3e-6, 1e-15);
  EXPECT_EQ(recording->find("emg_1"), nullptr);
  EXPECT_NE(recording->find("emg_triceps"), nullptr);
}

TEST(Assemble, TakesEachColumnOfAMatrixCalledEmg) {
  Contents contents;
  contents.format = "MAT v5";
  contents.arrays = {
      {"time", SharedMatrix(Matrix(Vector::LinSpaced(50, 0.0, 0.49)))},
      {"position", SharedMatrix(Matrix(Vector::LinSpaced(50, 0.0, 1.0)))},
      {"emg", SharedMatrix(Matrix(Vector::LinSpaced(50, 0.0, 1.0) * Vector{{1.0, 2.0, 3.0}}.transpose()))}};
  ReadOptions options;
  options.axes = 1;
  options.emg = EmgReading::same_clock;
  const auto recording = assemble(contents, options);
  ASSERT_TRUE(recording) << recording.error().line();
  ASSERT_NE(recording->find("emg_3"), nullptr);
  EXPECT_EQ(recording->find("emg_3")->values[49], 3.0);
}

TEST(Assemble, MicrovoltsAreEmgWhateverTheirName) {
  Contents contents = elbow_with_emg();
  contents.arrays[2].name = "Vastus medialis";
  contents.arrays[2].unit = "uV";
  contents.arrays[3].name = "EMG1";
  contents.arrays.push_back(contents.arrays[3]);
  ReadOptions options;
  options.axes = 1;
  options.emg = EmgReading::all;
  const auto recording = assemble(contents, options);
  ASSERT_TRUE(recording) << recording.error().line();
  ASSERT_NE(recording->find("emg_vastus_medialis"), nullptr);
  EXPECT_NEAR(recording->find("emg_vastus_medialis")->values[1000], 3e-6, 1e-15);
  EXPECT_NE(recording->find("emg_1"), nullptr);
  EXPECT_NE(recording->find("emg_1_2"), nullptr);
}

TEST(Assemble, EmgOfAnotherRateIsNotMixedWithTheOtherChannels) {
  ReadOptions options;
  options.axes = 1;
  options.emg = EmgReading::same_clock;
  const auto recording = assemble(elbow_with_emg(), options);
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->samples(), 101);
  EXPECT_EQ(recording->find("emg_1"), nullptr);
}

}  // namespace
}  // namespace mbk::recording
