#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <cmath>
#include <cstring>

#include "mbk/files/contents/test_files.h"
#include "mbk/files/recording/read.h"
#include "mbk/files/recording/write.h"

namespace mbk::recording {
namespace write_mat_test {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

/// As MAT v5.
Result<void> write_mat(const Recording& recording, const std::filesystem::path& file, bool overwrite) {
  return write(recording, file, Format::mat5, overwrite);
}

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

Recording annotated() {
  Recording recording = example();
  recording.metadata = {{"participant", "7"}, {"name", "Ánna 😀"}, {"empty", ""}, {"truth_K", "[[1, 2], [3, 4]]"}};
  recording.metadata["a" + std::string(62, '9')] = std::string(5000, 'x');
  recording.events = {{0.05, "onset", 3.0}, {0.1, "", std::nan("")}, {0.15, "Aus é", -1e-300}};
  return recording;
}

void expect_same_events(const std::vector<Event>& read, const std::vector<Event>& written) {
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t k = 0; k < read.size(); ++k) {
    EXPECT_EQ(read[k].time, written[k].time) << k;
    EXPECT_EQ(read[k].name, written[k].name) << k;
    EXPECT_THAT(read[k].value, testing::NanSensitiveDoubleEq(written[k].value)) << k;
  }
}

TEST(WriteMat, KeepsMetadataAndEvents) {
  const test::Folder folder;
  const Recording written = annotated();
  const auto ok = write_mat(written, folder / "log.mat", false);
  ASSERT_TRUE(ok) << ok.error().line();
  const auto recording = read(folder / "log.mat", {});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->metadata, written.metadata);
  expect_same_events(recording->events, written.events);
  for (const std::string& note : recording->notes) {
    EXPECT_THAT(note, AllOf(Not(HasSubstr("metadata")), Not(HasSubstr("events"))));
  }
  for (const Channel& channel : written.channels) EXPECT_EQ(recording->find(channel.name)->values, channel.values);
}

TEST(WriteMat, KeepsMetadataAndEventsBesideOneAxis) {
  const test::Folder folder;
  Recording written = annotated();
  written.channels = {{"position", "rad", "", Vector::Random(200)}, {"reaction", "N.m", "", Vector::Random(200)}};
  for (const std::size_t events : {3u, 1u}) {
    written.events.resize(events);
    ASSERT_TRUE(write_mat(written, folder / "trial.mat", true));
    const auto recording = read(folder / "trial.mat", {});
    ASSERT_TRUE(recording) << recording.error().line();
    EXPECT_EQ(recording->metadata, written.metadata);
    EXPECT_EQ(recording->time, written.time);
    EXPECT_EQ(recording->find("position")->unit, "rad");
    EXPECT_EQ(recording->find("reaction")->unit, "N.m");
    expect_same_events(recording->events, written.events);
  }
}

TEST(WriteMat, KeepsUnitsThatThePlaceInTheFileDoesNotSay) {
  const test::Folder folder;
  Recording written = example();
  written.channels.push_back({"reference_x", "N", "base", Vector::Random(200)});
  written.channels.push_back({"reference_y", "m", "base", Vector::Random(200)});
  ASSERT_TRUE(write_mat(written, folder / "log.mat", false));
  const auto recording = read(folder / "log.mat", {});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->find("reference_x")->unit, "N");
  EXPECT_EQ(recording->find("reference_y")->unit, "m");
  EXPECT_EQ(recording->find("reference_x")->values, written.find("reference_x")->values);
  EXPECT_TRUE(recording->metadata.empty());
}

TEST(WriteMat, LeavesAUnitAsideThatAChannelCannotHave) {
  const test::Folder folder;
  Recording written = example();
  written.metadata = {{"unit_hand_x", "V"}};
  ASSERT_TRUE(write_mat(written, folder / "log.mat", false));
  const auto recording = read(folder / "log.mat", {});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->find("hand_x")->unit, "m");
  EXPECT_EQ(recording->metadata, written.metadata);
  EXPECT_THAT(recording->notes, Contains(AllOf(HasSubstr("'unit_hand_x'"), HasSubstr("'V'"))));
}

TEST(WriteMat, WritesEqualRecordingsAsEqualBytes) {
  const test::Folder folder;
  const Recording recording = annotated();
  ASSERT_TRUE(write_mat(recording, folder / "a.mat", false));
  ASSERT_TRUE(write_mat(recording, folder / "b.mat", false));
  EXPECT_EQ(test::bytes_of(folder / "a.mat"), test::bytes_of(folder / "b.mat"));
}

TEST(WriteMat, AddsNothingWhereThereIsNothingToSay) {
  const test::Folder folder;
  Recording plain = annotated();
  plain.metadata.clear();
  plain.events.clear();
  ASSERT_TRUE(write_mat(plain, folder / "plain.mat", false));
  ASSERT_TRUE(write_mat(annotated(), folder / "more.mat", false));
  const std::string bytes = test::bytes_of(folder / "plain.mat");
  std::uint32_t logs_size = 0;
  std::memcpy(&logs_size, bytes.data() + 132, sizeof logs_size);
  EXPECT_EQ(bytes.size(), 136 + logs_size);  // header, and the one compressed variable
}

TEST(WriteMat, RefusesWhatMatlabCannotHold) {
  const test::Folder folder;
  const auto said = [&](const std::string& key, const std::string& value) {
    Recording recording = example();
    recording.metadata[key] = value;
    const auto refused = write_mat(recording, folder / "log.mat", false);
    return refused ? "" : refused.error().line();
  };
  for (const std::string& key : {std::string(), std::string("7a"), std::string("a b"), std::string("_a"),
                                 std::string("é"), "a" + std::string(63, 'b')}) {
    EXPECT_THAT(said(key, "x"), HasSubstr("MATLAB")) << key;
  }
  for (const std::string& value : {std::string("two\nlines"), std::string("\xff"), std::string("a\0b", 3)}) {
    EXPECT_THAT(said("key", value), AllOf(HasSubstr("'key'"), HasSubstr("UTF-8")));
  }
  Recording recording = example();
  recording.events = {{0.0, "\t", 0.0}};
  EXPECT_FALSE(write_mat(recording, folder / "log.mat", false));
  recording.events.clear();
  recording.channels.push_back({"reference_x", "N", "base", Vector::Zero(200)});
  recording.metadata["unit_reference_x"] = "m";
  EXPECT_FALSE(write_mat(recording, folder / "log.mat", false));
  EXPECT_FALSE(std::filesystem::exists(folder / "log.mat"));
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
  EXPECT_THAT(refused.error().message, AllOf(HasSubstr("'joint_1'"), HasSubstr("199 samples")));
}

TEST(WriteMat, RefusesAFolderThatIsNotThere) {
  const test::Folder folder;
  const auto refused = write_mat(example(), folder / "none/log.mat", false);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::data);
}

}  // namespace write_mat_test
}  // namespace mbk::recording
