#include "mbk/recording/mat_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <cmath>

#include "mbk/recording/read.h"
#include "mbk/recording/test_files.h"

namespace mbk::recording {
namespace {

using testing::HasSubstr;

Recording example() {
  Recording recording;
  recording.time = Vector::LinSpaced(200, 0.0, 0.199);
  for (const char* name : {"hand_x", "hand_y", "force_x", "force_y"}) {
    recording.channels.push_back({name, "", "base", Vector::Random(200)});
  }
  return recording;
}

TEST(WriteMat, IsReadBackBitForBit) {
  const test::Folder folder;
  const Recording written = example();
  ASSERT_TRUE(write_mat(written, folder / "log.mat", false));
  const auto recording = read(folder / "log.mat", {});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->sources[0].format, "MAT v7");
  EXPECT_EQ(recording->time, written.time);
  ASSERT_EQ(recording->channels.size(), written.channels.size());  // rows without a channel do not come back as zeros
  for (const Channel& channel : written.channels) EXPECT_EQ(recording->find(channel.name)->values, channel.values);
}

TEST(WriteMat, IsReadByMatio) {
  const test::Folder folder;
  const Recording written = example();
  ASSERT_TRUE(write_mat(written, folder / "log.mat", false));
  mat_t* mat = Mat_Open((folder / "log.mat").c_str(), MAT_ACC_RDONLY);
  ASSERT_NE(mat, nullptr);
  matvar_t* variable = Mat_VarRead(mat, "logs");
  ASSERT_NE(variable, nullptr);
  ASSERT_EQ(variable->dims[0], 19u);
  ASSERT_EQ(variable->dims[1], 200u);
  const auto* data = static_cast<const double*>(variable->data);
  for (int k = 0; k < 200; ++k) EXPECT_EQ(data[19 * k + 9], written.find("force_x")->values[k]);
  EXPECT_TRUE(std::isnan(data[3]));
  Mat_VarFree(variable);
  Mat_Close(mat);
}

TEST(WriteMat, RefusesToOverwriteUnlessTold) {
  const test::Folder folder;
  const auto file = folder.write("log.mat", "precious");
  const auto refused = write_mat(example(), file, false);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::usage);
  EXPECT_THAT(refused.error().remedy, HasSubstr("--overwrite"));
  EXPECT_EQ(test::bytes_of(file), "precious");
  EXPECT_TRUE(write_mat(example(), file, true));
  EXPECT_TRUE(read(file, {}));
}

TEST(WriteMat, LeavesNothingBehindWhenItFails) {
  const test::Folder folder;
  std::filesystem::create_directory(folder / "log.mat");  // cannot be replaced by a file
  EXPECT_FALSE(write_mat(example(), folder / "log.mat", true));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / ""), {}), 1);
}

TEST(WriteMat, WritesOneAxisAsVariables) {
  const test::Folder folder;
  Recording written;
  written.time = Vector::LinSpaced(200, 0.0, 0.199);
  for (const char* name : {"position", "reaction"}) written.channels.push_back({name, "", "", Vector::Random(200)});
  ASSERT_TRUE(write_mat(written, folder / "trial.mat", false));
  const auto recording = read(folder / "trial.mat", {});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->time, written.time);
  for (const Channel& channel : written.channels) EXPECT_EQ(recording->find(channel.name)->values, channel.values);
}

TEST(WriteMat, RefusesChannelsOfAnotherLength) {
  const test::Folder folder;
  Recording recording = example();
  recording.channels.push_back({"joint_1", "rad", "joint", Vector::Zero(199)});
  const auto refused = write_mat(recording, folder / "log.mat", false);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("'joint_1' has 199 samples, time has 200"));
}

TEST(WriteMat, RefusesAFolderThatIsNotThere) {
  const test::Folder folder;
  const auto refused = write_mat(example(), folder / "none/log.mat", false);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::data);
}

}  // namespace
}  // namespace mbk::recording
