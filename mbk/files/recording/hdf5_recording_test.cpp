#include "mbk/files/recording/hdf5_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "mbk/files/hdf5/test_hdf5_files.h"
#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/assemble.h"
#include "mbk/files/recording/hdf5_tree.h"
#include "mbk/files/recording/mat_hdf5.h"

namespace mbk::recording {
namespace hdf5_recording_test {

using hdf5::Attributes;
using hdf5::Dataset;
using hdf5::Group;
using hdf5::Numbers;
using hdf5::Texts;
using hdf5::Value;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

Dataset numbers(const Vector& values, std::vector<std::uint64_t> shape = {}, const std::string& unit = "") {
  if (shape.empty()) shape = {static_cast<std::uint64_t>(values.size())};
  Dataset dataset{{std::move(shape), Numbers{values}}, {}};
  if (!unit.empty()) dataset.attributes["unit"] = {{}, Texts{unit}};
  return dataset;
}

/// The layout that mbk writes.
Group own() {
  const Vector time = Vector::LinSpaced(5, 0.0, 0.004);
  Group root;
  root.attributes = {{"participant", {{}, Texts{"Ánna"}}}, {"age", {{}, Numbers{Vector::Constant(1, 31)}}}};
  root.datasets["time"] = numbers(time, {}, "s");
  root.groups["channels"].datasets = {{"hand_x", numbers(time * 1000, {}, "mm")},
                                      {"force_x", numbers(time * 3, {}, "N")},
                                      {"reference_x", numbers(time, {}, "N")}};
  root.groups["events"].datasets = {{"time", numbers((Vector(2) << 0.001, 0.003).finished())},
                                    {"value", numbers((Vector(2) << 1, -1).finished())},
                                    {"name", Dataset{{{2}, Texts{"onset", "offset"}}, {}}}};
  return root;
}

Result<Recording> recorded(Group root, const std::string& map = "", const std::string& variable = "") {
  Contents contents = contents_of_hdf5(std::move(root));
  take_annotations(contents);
  ReadOptions options;
  if (!map.empty()) options.channels = parse_channel_map(map).value();
  options.variable = variable;
  return assemble(contents, options);
}

TEST(ContentsOfHdf5, ReadsTheLayoutThatMbkWrites) {
  const auto recording = recorded(own());
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->time, Vector::LinSpaced(5, 0.0, 0.004));
  EXPECT_TRUE(recording->find("hand_x")->values.isApprox(Vector::LinSpaced(5, 0.0, 0.004), 1e-15));
  EXPECT_EQ(recording->find("hand_x")->unit, "m");
  EXPECT_EQ(recording->find("reference_x")->unit, "N");
  EXPECT_THAT(recording->metadata, ElementsAre(Pair("age", "31"), Pair("participant", "Ánna")));
  ASSERT_EQ(recording->events.size(), 2u);
  EXPECT_EQ(recording->events[1].time, 0.003);
  EXPECT_EQ(recording->events[1].name, "offset");
  EXPECT_EQ(recording->events[1].value, -1);
  EXPECT_THAT(recording->notes, IsEmpty());
}

TEST(ContentsOfHdf5, TakesTheUnitOfTheMapBeforeThatOfTheFile) {
  EXPECT_EQ(recorded(own(), "x=hand_x:m,Fx=force_x")->find("hand_x")->values[4], 4.0);
  EXPECT_DOUBLE_EQ(recorded(own(), "x=hand_x,Fx=force_x")->find("hand_x")->values[4], 0.004);
}

TEST(ContentsOfHdf5, RefusesAUnitThatTheChannelCannotHave) {
  Group root = own();
  root.groups["channels"].datasets["hand_x"].attributes["unit"] = {{}, Texts{"furlong"}};
  EXPECT_THAT(recorded(root).error().line(), HasSubstr("'hand_x' is in 'furlong', which channel hand_x cannot be in"));
  EXPECT_THAT(recorded(root, "x=hand_x").error().line(), HasSubstr("'furlong'"));
  EXPECT_TRUE(recorded(root, "x=hand_x:cm"));
  root = own();
  root.datasets["time"].attributes["unit"] = {{}, Texts{"seconds since 1970"}};
  EXPECT_THAT(recorded(root).error().line(), HasSubstr("--channels time=time:UNIT; possible are s, ms"));
  EXPECT_THAT(recorded(root, "x=hand_x").error().line(), HasSubstr("--channels time=time:UNIT"));
}

TEST(ContentsOfHdf5, SaysWhereTheFileNamesAnotherFrame) {
  Group root = own();
  root.groups["channels"].datasets["hand_x"].attributes["frame"] = {{}, Texts{"tool"}};
  EXPECT_THAT(recorded(root)->notes, ElementsAre("'hand_x' says that its frame is 'tool'; mbk takes it in the frame "
                                                 "'base'"));
}

Group other() {
  Group root;
  Group& trial = root.groups["trial"];
  trial.datasets["clock"] = numbers(Vector::LinSpaced(4, 0, 3), {}, "ms");
  trial.datasets["pos"] = numbers(Vector::LinSpaced(8, 0, 7), {4, 2});
  trial.datasets["pos"].attributes["units"] = {{}, Texts{"mm"}};
  trial.datasets["force"] = numbers(Vector::LinSpaced(4, 0, 9));
  root.datasets["rate"] = Dataset{{{}, Numbers{Vector::Constant(1, 1000.0)}}, {}};
  root.datasets["cube"] = numbers(Vector::Zero(8), {2, 2, 2});
  root.datasets["label"] = Dataset{{{1}, Texts{"x"}}, {}};
  root.datasets["table"].value.data = hdf5::Unread{"of a compound type"};
  return root;
}

TEST(ContentsOfHdf5, ListsOtherFilesByTheirPaths) {
  Contents contents = contents_of_hdf5(other());
  take_annotations(contents);
  ASSERT_EQ(contents.arrays.size(), 3u);
  EXPECT_EQ(contents.arrays[0].name, "trial/clock");
  EXPECT_EQ(contents.arrays[2].name, "trial/pos");
  EXPECT_EQ(contents.arrays[2].values, (Matrix(4, 2) << 0, 1, 2, 3, 4, 5, 6, 7).finished());  // as h5py shows it
  EXPECT_THAT(contents.notes,
              ElementsAre("'cube' is an array of 3 dimensions; ignored", "'rate' is a single number; ignored",
                          "'table' is of a compound type; ignored", "variable 'label' is text; ignored"));
}

TEST(ContentsOfHdf5, LetsAPathBeSaidWithSlashesOrDots) {
  for (const char* force : {"trial/force", "trial.force", "/trial/force"}) {
    const auto recording = recorded(other(), std::string("t=trial/clock,Fx=") + force);
    ASSERT_TRUE(recording) << recording.error().line();
    EXPECT_EQ(recording->find("force_x")->values[3], 9);
    EXPECT_DOUBLE_EQ(recording->time[3], 0.003);
  }
  Group root = other();
  root.datasets["trial.force"] = numbers(Vector::Zero(4));
  EXPECT_EQ(recorded(root, "t=trial/clock,Fx=trial.force")->find("force_x")->values[3], 0);
  EXPECT_EQ(recorded(root, "t=trial/clock,Fx=trial/force")->find("force_x")->values[3], 9);
}

TEST(ContentsOfHdf5, CountsColumnsOfTheNamedMatrixInItsUnit) {
  for (const char* variable : {"trial/pos", "trial.pos"}) {
    const auto recording = recorded(other(), "t=trial/clock,x=1,y=2", variable);
    ASSERT_TRUE(recording) << recording.error().line();
    EXPECT_DOUBLE_EQ(recording->find("hand_y")->values[3], 0.007);
  }
}

TEST(ContentsOfHdf5, SaysWhatIsThereWhereNothingIsRecognised) {
  EXPECT_THAT(recorded(other()).error().line(),
              HasSubstr("no channel is recognised; it has the variables trial/clock (4×1), trial/force (4×1), "
                        "trial/pos (4×2)"));
  Group texts;
  texts.datasets["label"] = Dataset{{{1}, Texts{"x"}}, {}};
  EXPECT_THAT(recorded(texts).error().line(), HasSubstr("it has no numeric variable; variable 'label' is text"));
}

TEST(DecodeHdf5, NamesTheObjectThatIsDamaged) {
  std::string bytes = hdf5::test::written(
      hdf5::test::Writer::earliest,
      [](hid_t file) {
        hdf5::test::put_numbers(file, "x", Vector::Constant(8, 1.5), {{8}, {}, {8}}, H5T_IEEE_F64LE,
                                [](hid_t properties) { H5Pset_fletcher32(properties); });
      },
      512);
  const double value = 1.5;
  bytes[bytes.find(std::string(reinterpret_cast<const char*>(&value), sizeof value))] = 1;
  EXPECT_THAT(decode_hdf5(std::as_bytes(std::span(bytes))).error().line(),
              HasSubstr("/x: a chunk has a wrong checksum"));
  bytes.replace(0, 10, "MATLAB 7.3");
  EXPECT_THAT(decode_hdf5(std::as_bytes(std::span(bytes))).error().line(),
              HasSubstr("variable 'x': a chunk has a wrong checksum"));
}

TEST(TakeColumns, BearASideThatNoNumberCanHoldBesideOneOfZero) {
  constexpr auto kLargest = std::numeric_limits<std::uint64_t>::max();
  hdf5::Numbers none;
  EXPECT_EQ(take_columns(none, kLargest, 0).size(), 0);
  EXPECT_GE(take_columns(none, 0, kLargest).cols(), 0);
  EXPECT_GE(take_rows(none, kLargest, 0).rows(), 0);
}

TEST(DecodeHdf5, KnowsMatlabsFilesByTheirAttributesToo) {
  Group root;
  root.datasets["logs"] = numbers(Vector::Zero(4), {2, 2});
  EXPECT_FALSE(is_mat_hdf5({}, root));
  root.datasets["logs"].attributes["MATLAB_class"] = {{}, Texts{"double"}};
  EXPECT_TRUE(is_mat_hdf5({}, root));
}

}  // namespace hdf5_recording_test
}  // namespace mbk::recording
