#include "mbk/files/recording/hdf5_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "mbk/files/hdf5/test_hdf5_files.h"
#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/assemble.h"
#include "mbk/files/recording/encode.h"
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

TEST(ContentsOfHdf5, PutsLinesOfMetadataIntoOneAndSaysSo) {
  Group root = own();
  root.attributes["remark"] = {{}, Texts{"first\r\nsecond\x01\n"}};
  const auto recording = recorded(root);
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->metadata.at("remark"), "first; second?");
  EXPECT_THAT(recording->notes, ElementsAre(AllOf(HasSubstr("'remark'"), HasSubstr("2 lines"))));
}

TEST(ContentsOfHdf5, TakesTheUnitOfTheMapBeforeThatOfTheFile) {
  EXPECT_EQ(recorded(own(), "x=hand_x:m,Fx=force_x")->find("hand_x")->values[4], 4.0);
  EXPECT_DOUBLE_EQ(recorded(own(), "x=hand_x,Fx=force_x")->find("hand_x")->values[4], 0.004);
}

TEST(ContentsOfHdf5, RefusesAUnitThatTheChannelCannotHave) {
  Group root = own();
  root.groups["channels"].datasets["hand_x"].attributes["unit"] = {{}, Texts{"furlong"}};
  EXPECT_THAT(recorded(root).error().line(), AllOf(HasSubstr("'hand_x'"), HasSubstr("'furlong'")));
  EXPECT_THAT(recorded(root, "x=hand_x").error().line(), HasSubstr("'furlong'"));
  EXPECT_TRUE(recorded(root, "x=hand_x:cm"));
  root = own();
  root.datasets["time"].attributes["unit"] = {{}, Texts{"fortnight"}};
  EXPECT_THAT(recorded(root).error().line(), AllOf(HasSubstr("--channels time=time:UNIT"), HasSubstr("s, ms")));
  EXPECT_THAT(recorded(root, "x=hand_x").error().line(), HasSubstr("--channels time=time:UNIT"));
}

TEST(ContentsOfHdf5, SaysWhereTheFileNamesAnotherFrame) {
  Group root = own();
  root.groups["channels"].datasets["hand_x"].attributes["frame"] = {{}, Texts{"tool"}};
  EXPECT_THAT(recorded(root)->notes,
              ElementsAre(AllOf(HasSubstr("'hand_x'"), HasSubstr("'tool'"), HasSubstr("'base'"))));
}

Group other() {
  Group root;
  Group& trial = root.groups["trial"];
  trial.datasets["clock"] = numbers(Vector::LinSpaced(4, 0, 3), {}, "ms");
  trial.datasets["pos"] = numbers(Vector::LinSpaced(8, 0, 7), {4, 2});
  trial.datasets["pos"].attributes["units"] = {{}, Texts{"mm"}};
  trial.datasets["force"] = numbers(Vector::LinSpaced(4, 0, 9));
  root.datasets["size"] = Dataset{{{}, Numbers{Vector::Constant(1, 7.0)}}, {}};
  root.datasets["images"] = numbers(Vector::Zero(8), {2, 2, 2});
  std::get<Numbers>(root.datasets["images"].value.data).stored = hdf5::Stored::uint8;
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
  EXPECT_THAT(contents.notes, ElementsAre(AllOf(HasSubstr("'images'"), HasSubstr("3 dimensions")),
                                          AllOf(HasSubstr("'size'"), HasSubstr("number")),
                                          AllOf(HasSubstr("'table'"), HasSubstr("of a compound type")),
                                          AllOf(HasSubstr("'label'"), HasSubstr("text"))));
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
              AllOf(HasSubstr("trial/clock (4×1)"), HasSubstr("trial/force (4×1)"), HasSubstr("trial/pos (4×2)")));
  Group texts;
  texts.datasets["label"] = Dataset{{{1}, Texts{"x"}}, {}};
  EXPECT_THAT(recorded(texts).error().line(), AllOf(HasSubstr("variable"), HasSubstr("'label'")));
}

TEST(ContentsOfHdf5, ReadsTheColumnsOfATableInTheirUnits) {
  const auto table = [](std::vector<std::string> units) {
    Group root;
    Group& log = root.groups["log"];
    log.columns = {"time", "x", "q"};
    log.datasets = {{"time", numbers(Vector::LinSpaced(4, 0, 3))},
                    {"x", numbers(Vector::LinSpaced(4, 0, 3000))},
                    {"q", numbers(Vector::LinSpaced(8, 0, 7), {4, 2})}};
    if (!units.empty()) log.attributes["units"] = {{units.size()}, Texts(std::move(units))};
    return root;
  };
  const auto recording = recorded(table({"s", "mm", "deg"}), "x=log/x,q1=log/q[2]");
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_DOUBLE_EQ(recording->find("hand_x")->values[3], 3.0);
  EXPECT_DOUBLE_EQ(recording->find("joint_1")->values[0], M_PI / 180);
  EXPECT_EQ(recording->time[3], 3.0);
  EXPECT_EQ(recorded(table({}), "x=log/x")->find("hand_x")->values[3], 3000.0);
  EXPECT_THAT(recorded(table({"mm"}), "x=log/x").error().line(), AllOf(HasSubstr("'log/time'"), HasSubstr("'mm'")));
}

TEST(ContentsOfHdf5, LeavesOutWhatIsDamagedUnlessItIsAskedFor) {
  Group root = other();
  root.groups["trial"].datasets["gaze"].value.data = hdf5::Unread{"a chunk has a wrong checksum", true};
  const auto recording = recorded(root, "t=trial/clock,Fx=trial/force");
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_THAT(recording->notes, Contains(AllOf(HasSubstr("'trial/gaze'"), HasSubstr("a chunk has a wrong checksum"))));
  EXPECT_THAT(
      recorded(root, "t=trial/clock,Fx=trial.gaze").error().message,
      AllOf(HasSubstr("channel force_x"), HasSubstr("'trial/gaze'"), HasSubstr("a chunk has a wrong checksum")));
  EXPECT_THAT(recorded(root, "t=trial/clock,Fx=trial.gaze[2]").error().message,
              HasSubstr("a chunk has a wrong checksum"));
  EXPECT_THAT(recorded(root, "x=1", "trial/gaze").error().message, HasSubstr("a chunk has a wrong checksum"));
}

TEST(ContentsOfHdf5, DoesNotTakeADamagedChannelForOneThatIsNotThere) {
  Group root;
  root.datasets["time"] = numbers(Vector::LinSpaced(5, 0, 1));
  root.datasets["force_x"] = numbers(Vector::Zero(5));
  root.datasets["hand_x"] = numbers(Vector::Zero(5));
  ASSERT_TRUE(recorded(root));
  root.groups["raw"].datasets["reference_x"].value.data = hdf5::Unread{"a part of it was never written", true};
  EXPECT_THAT(recorded(root).error().message,
              AllOf(HasSubstr("'raw/reference_x'"), HasSubstr("a part of it was never written")));
  EXPECT_TRUE(recorded(root, "x=hand_x,Fx=force_x"));
}

TEST(ContentsOfHdf5, TakesAChannelThatHasTwoNamesOnce) {
  Group root;
  root.datasets["time"] = numbers(Vector::LinSpaced(5, 0, 1));
  root.datasets["hand_x"] = numbers(Vector::LinSpaced(5, 0, 2));
  root.groups["raw"].datasets["hand_x"] = numbers(Vector::LinSpaced(5, 0, 2));
  const auto recording = recorded(root);
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_THAT(recording->notes, Contains(AllOf(HasSubstr("'raw/hand_x'"), HasSubstr("'hand_x'"))));
  root.groups["raw"].datasets["hand_x"] = numbers(Vector::LinSpaced(5, 0, 3));
  EXPECT_THAT(recorded(root).error().message, AllOf(HasSubstr("'raw/hand_x'"), HasSubstr("'hand_x'")));
}

Value one(double value, hdf5::Stored stored = hdf5::Stored::float64) {
  return {{}, Numbers{Vector::Constant(1, value), stored}};
}

Value text(const std::string& words) {
  return {{}, Texts{words}};
}

/// Time, position and force under the names of channels, the force with such attributes.
Group with_force(const Vector& force, Attributes attributes, hdf5::Stored stored = hdf5::Stored::float64) {
  Group root;
  root.datasets["time"] = numbers(Vector::LinSpaced(force.size(), 0.0, 0.001 * static_cast<double>(force.size() - 1)));
  root.datasets["hand_x"] = numbers(Vector::LinSpaced(force.size(), 0.0, 1.0));
  root.datasets["force_x"] = numbers(force);
  std::get<Numbers>(root.datasets["force_x"].value.data).stored = stored;
  root.datasets["force_x"].attributes = std::move(attributes);
  return root;
}

const Vector kForce = (Vector(4) << 1, 2, -99, 4).finished();

Vector force_of(Group root) {
  const auto recording = recorded(std::move(root));
  EXPECT_TRUE(recording) << recording.error().line();
  return recording ? recording->find("force_x")->values : Vector();
}

std::string error_of(Group root, const std::string& map = "") {
  const auto recorded_there = recorded(std::move(root), map);
  return recorded_there ? "none" : recorded_there.error().line();
}

TEST(AttributesOfHdf5, ScaleNumbersAsNwbAndCfDefineThem) {
  const auto nwb = with_force(kForce, {{"conversion", one(2.0)}, {"offset", one(0.5)}, {"unit", text("newtons")}});
  EXPECT_EQ(force_of(nwb), (2.0 * kForce.array() + 0.5).matrix());
  EXPECT_THAT(recorded(nwb)->notes,
              ElementsAre(AllOf(HasSubstr("conversion = 2"), HasSubstr("offset = 0.5"), HasSubstr("'force_x'"))));
  const auto cf = with_force(kForce, {{"scale_factor", one(0.5)}, {"add_offset", text("-1")}, {"units", text("mN")}});
  EXPECT_EQ(force_of(cf), ((0.5 * kForce.array() - 1.0) / 1000).matrix());
  const auto plain = with_force(kForce, {{"conversion", one(1.0)}, {"offset", one(0.0)}, {"resolution", one(-1.0)}});
  EXPECT_EQ(force_of(plain), kForce);
  EXPECT_THAT(recorded(plain)->notes, IsEmpty());
  const auto both = with_force(kForce, {{"conversion", one(2.0)}, {"scale_factor", one(2.0)}});
  EXPECT_EQ(force_of(both), 2.0 * kForce);
}

TEST(AttributesOfHdf5, AreRefusedWhereTheyDoNotSayWhatIsToBeDone) {
  const std::vector<Attributes> unclear = {{{"gain", one(4.448)}},
                                           {{"Scaling", one(3.0)}},
                                           {{"offset", one(0.3)}},
                                           {{"conversion", one(2.0)}, {"scale_factor", one(3.0)}},
                                           {{"scale_factor", one(2.0)}, {"gain", one(10.0)}},
                                           {{"conversion", text("ask Anna")}},
                                           {{"conversion", one(0.0)}},
                                           {{"scale_factor", {{2}, Numbers{Vector::Constant(2, 3.0)}}}}};
  for (const Attributes& attributes : unclear) {
    const Group root = with_force(kForce, attributes);
    EXPECT_THAT(error_of(root), AllOf(HasSubstr("'force_x'"), HasSubstr(attributes.begin()->first + " = ")));
    EXPECT_EQ(recorded(root, "x=hand_x,Fx=force_x*1")->find("force_x")->values, kForce);
    EXPECT_EQ(recorded(root, "x=hand_x,Fx=force_x*2")->find("force_x")->values, 2.0 * kForce);
    EXPECT_TRUE(recorded(root, "x=hand_x"));
  }
  EXPECT_THAT(error_of(with_force(kForce, {{"gain", one(4.448)}}), "x=hand_x,Fx=-force_x"),
              AllOf(HasSubstr("--channels Fx=force_x*GAIN"), HasSubstr("Fx=force_x*1")));
  for (const Attributes& attributes : {Attributes{{"gain", one(1.0)}, {"offset", one(0.0)}},
                                       Attributes{{"calibration", text("2024-03-01")}, {"filter_delay", one(0.004)}}}) {
    EXPECT_EQ(force_of(with_force(kForce, attributes)), kForce);
  }
  EXPECT_THAT(recorded(with_force(kForce, {{"filter_delay", one(0.004)}}))->notes,
              ElementsAre(AllOf(HasSubstr("filter_delay = 0.004"), HasSubstr("'force_x'"))));
}

TEST(AttributesOfHdf5, MarkMissingNumbersBeforeTheyAreScaled) {
  const auto root = with_force(kForce, {{"_FillValue", one(-99.0)}, {"scale_factor", one(0.5)}});
  const Vector force = force_of(root);
  EXPECT_TRUE(std::isnan(force[2]));
  EXPECT_EQ(force[3], 2.0);
  EXPECT_THAT(recorded(root)->notes,
              Contains(AllOf(HasSubstr("_FillValue"), HasSubstr("-99"), HasSubstr("NaN"), HasSubstr("'force_x'"))));
  // -99.9 stands in the file as the nearest float32.
  Vector real = kForce;
  real[2] = static_cast<double>(-99.9F);
  EXPECT_TRUE(std::isnan(force_of(with_force(real, {{"missing_value", one(-99.9)}}, hdf5::Stored::float32))[2]));
  // A valid range of the type of the file is in its numbers, any other in those that they stand for.
  const Value range{{2}, Numbers{(Vector(2) << 0, 3).finished(), hdf5::Stored::int16}};
  const Value real_range{{2}, Numbers{(Vector(2) << 0, 3).finished()}};
  const auto count = [&](const Value& valid) {
    return force_of(with_force(kForce, {{"valid_range", valid}, {"scale_factor", one(0.5)}}, hdf5::Stored::int16))
        .array()
        .isNaN()
        .count();
  };
  EXPECT_EQ(count(range), 2);
  EXPECT_EQ(count(real_range), 1);
}

TEST(AttributesOfHdf5, SayThatBytesHaveNoSign) {
  const auto root = with_force(kForce, {{"_Unsigned", text("true")}, {"_FillValue", one(-99.0)}}, hdf5::Stored::int8);
  EXPECT_TRUE(std::isnan(force_of(root)[2]));
  EXPECT_EQ(force_of(with_force(kForce, {{"_Unsigned", text("true")}}, hdf5::Stored::int8))[2], 157.0);
}

TEST(AttributesOfHdf5, NameUnitsInWordsAndTimesSinceADate) {
  Group root = with_force(kForce, {});
  root.datasets["hand_x"].attributes["Units"] = text("Millimeters");
  root.datasets["time"].attributes["units"] = text("milliseconds since 2024-01-01 00:00:00");
  const auto recording = recorded(root);
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->find("hand_x")->values[3], 0.001);
  EXPECT_DOUBLE_EQ(recording->time[3], 3e-6);
  root.datasets["hand_x"].attributes["unit"] = text("m");
  EXPECT_THAT(error_of(root), AllOf(HasSubstr("'hand_x'"), HasSubstr("'Millimeters, m'")));
}

TEST(AttributesOfHdf5, HoldForEachColumnOfAMatrix) {
  Group root = with_force(kForce, {});
  root.datasets["data"] = numbers(Vector::LinSpaced(8, 1, 8), {4, 2});
  root.datasets["data"].attributes = {{"scale_factor", {{2}, Numbers{(Vector(2) << 1, 10).finished()}}},
                                      {"units", {{2}, Texts{"mm", "N"}}}};
  EXPECT_THAT(error_of(root, "x=data[1],Fx=data[2]"), AllOf(HasSubstr("'data'"), HasSubstr("'mm, N'")));
  const auto recording = recorded(root, "x=data[1]:mm,Fx=data[2]:N");
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->find("hand_x")->values[1], 0.003);
  EXPECT_EQ(recording->find("force_x")->values[1], 40.0);
}

/// A TimeSeries of NWB with a force of two columns.
Group series(double begin_s) {
  Group group;
  group.attributes["neurodata_type"] = text("TimeSeries");
  group.datasets["data"] = numbers(Vector::LinSpaced(8, 1, 8), {4, 2});
  group.datasets["data"].attributes = {{"conversion", one(2.0)}, {"unit", text("newtons")}};
  group.datasets["channel_conversion"] = numbers((Vector(2) << 1, 10).finished());
  group.datasets["starting_time"] = Dataset{one(begin_s), {{"rate", one(1000.0, hdf5::Stored::float32)}}};
  return group;
}

TEST(TimeSeriesOfNwb, HaveTheTimeThatTheirStartAndRateSay) {
  Group root;
  root.groups["a"] = series(0.5);
  const auto recording = recorded(root, "Fx=a/data[1],Fy=a/data[2]");
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->time, (Vector(4) << 0.5, 0.501, 0.502, 0.503).finished());
  EXPECT_EQ(recording->find("force_x")->values[1], 6.0);
  EXPECT_EQ(recording->find("force_y")->values[1], 80.0);
  ReadOptions options;
  options.channels = parse_channel_map("Fx=a/data[1]").value();
  options.rate = Hertz(500);
  EXPECT_THAT(assemble(contents_of_hdf5(root), options).error().line(),
              AllOf(HasSubstr("500 Hz"), HasSubstr("1000 Hz")));
}

TEST(TimeSeriesOfNwb, AreNotTakenForSimultaneousWhereTheyStartAtOtherTimes) {
  Group root;
  root.groups["a"] = series(0.5);
  root.groups["b"] = series(0.5);
  EXPECT_TRUE(recorded(root, "Fx=a/data[1],Fy=b/data[1]"));
  root.groups["b"] = series(0.6);
  EXPECT_THAT(error_of(root, "Fx=a/data[1],Fy=b/data[1]"), HasSubstr("--clock"));
  root.groups["b"].datasets.erase("starting_time");
  root.groups["b"].datasets["timestamps"] = numbers((Vector(4) << 500, 501, 502, 503).finished(), {}, "ms");
  EXPECT_TRUE(recorded(root, "Fx=a/data[1],Fy=b/data[1]"));
}

TEST(ContentsOfHdf5, TakesDifferencesOfTimesBeforeTheyAreRounded) {
  constexpr std::int64_t kBegin = 1709288130'000000001;
  Group root = with_force(kForce, {});
  Group matrix = root;
  hdf5::Numbers stamps{Vector(4), hdf5::Stored::int64}, table{Vector(8), hdf5::Stored::int64};
  for (std::size_t k = 0; k < 4; ++k) {
    const std::int64_t stamp = kBegin + 1000000 * static_cast<std::int64_t>(k);
    stamps.values[static_cast<Index>(k)] = table.values[static_cast<Index>(2 * k + 1)] = static_cast<double>(stamp);
    table.values[static_cast<Index>(2 * k)] = 7.0;
    stamps.rests.put(k, rest_of(stamp));
    table.rests.put(2 * k + 1, rest_of(stamp));
  }
  root.datasets["time"] = Dataset{{{4}, stamps}, {{"unit", text("ns")}}};
  root.datasets["hand_x"] = Dataset{{{4}, stamps}, {}};
  matrix.datasets["log"] = Dataset{{{4, 2}, table}, {}};
  for (const auto& recording : {recorded(root), recorded(matrix, "time=log[2]:ns,x=hand_x")}) {
    ASSERT_TRUE(recording) << recording.error().line();
    EXPECT_EQ(recording->time, (Vector(4) << 0, 0.001, 0.002, 0.003).finished());
    EXPECT_THAT(recording->notes, Contains(HasSubstr("1709288130000000001 ns")));
    EXPECT_NEAR(recording->time_zero, 1709288130.0, 1e-6);
  }
  EXPECT_THAT(recorded(root)->notes, Contains(AllOf(HasSubstr("'hand_x'"), HasSubstr("2^53"))));
}

TEST(ContentsOfHdf5, TakesSlicesOfArraysOfMoreDimensions) {
  Group root;
  root.datasets["data"] = numbers(Vector::LinSpaced(2 * 9 * 3, 0, 53), {2, 9, 3});  // trials, samples, channels
  root.datasets["data"].attributes["scale_factor"] = {{3}, Numbers{(Vector(3) << 1, 1, 10).finished()}};
  root.attributes["fs"] = one(1000.0);
  ReadOptions options;
  options.channels = parse_channel_map("x=data[trial,:,1],Fx=data[:,:,3]").value();
  Contents contents = contents_of_hdf5(root);
  EXPECT_EQ(trials_of_map(contents, options.channels).size(), 2U);
  options.trial = "2";
  const auto recording = assemble(std::move(contents), options);
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->find("hand_x")->values, Vector::LinSpaced(9, 27, 51));
  EXPECT_EQ(recording->find("force_x")->values, 10 * Vector::LinSpaced(9, 29, 53));
  EXPECT_THAT(recording->notes, Contains(AllOf(HasSubstr("'data'"), HasSubstr("2×9×3"), HasSubstr("2 trials"),
                                               HasSubstr("dimension 1"), HasSubstr("dimension 2"))));
}

TEST(SampleRates, AreTakenFromTheFileAndHeldAgainstTime) {
  const auto without_time = [] {
    Group root = with_force(kForce, {});
    root.datasets.erase("time");
    return root;
  };
  const auto time_of = [&](Group root) {
    const auto recording = recorded(std::move(root));
    return recording ? recording->time[1] : 0.0;
  };
  Group attribute = without_time(), number = without_time(), of_one = without_time(), two = without_time();
  EXPECT_THAT(error_of(without_time()), AllOf(HasSubstr("time"), HasSubstr("--rate")));
  attribute.attributes["Sampling rate"] = one(500.0);
  EXPECT_EQ(time_of(attribute), 0.002);
  number.datasets["fs_khz"] = Dataset{one(0.5), {}};
  EXPECT_EQ(time_of(number), 0.002);
  of_one.datasets["force_x"].attributes["SampleRate"] = one(500.0);
  EXPECT_EQ(time_of(of_one), 0.002);
  two.attributes = {{"fs", one(500.0)}, {"sampling_rate", one(1000.0)}};
  EXPECT_THAT(error_of(two), AllOf(HasSubstr("time"), HasSubstr("--rate")));

  Group timed = with_force(kForce, {});
  timed.attributes["fs"] = one(1030.0);  // nominal
  EXPECT_EQ(time_of(timed), 0.001);
  timed.datasets["fs"] = Dataset{one(1.0), {}};
  timed.attributes.clear();
  EXPECT_THAT(error_of(timed), AllOf(HasSubstr("1 Hz"), HasSubstr("'time'"), HasSubstr("1000 Hz")));
  EXPECT_EQ(recorded(timed, "x=hand_x,time=time:s")->time[1], 0.001);
}

TEST(ContentsOfHdf5, LeavesSidesOfOneOut) {
  Group root;
  root.datasets["p"] = numbers(Vector::LinSpaced(8, 0, 7), {4, 1, 2});
  const Contents contents = contents_of_hdf5(std::move(root));
  EXPECT_EQ(contents.arrays.at(0).values, (Matrix(4, 2) << 0, 1, 2, 3, 4, 5, 6, 7).finished());
  EXPECT_THAT(contents.notes, ElementsAre(AllOf(HasSubstr("'p'"), HasSubstr("4×1×2"), HasSubstr("4×2"))));
}

TEST(DecodeHdf5, RefusesARecordingOfMbkOfWhichAnythingIsDamaged) {
  std::string bytes = encode_hdf5([] {
                        Recording recording;
                        recording.time = Vector::LinSpaced(5, 0, 1);
                        recording.channels.push_back({"hand_x", "m", "base", Vector::Constant(5, 1.5), {}});
                        return recording;
                      }())
                          .value();
  ASSERT_TRUE(decode_hdf5(std::as_bytes(std::span(bytes))));
  const std::size_t name = bytes.find("hand_x");
  ASSERT_NE(name, bytes.npos);
  // The layout of a dataset of 40 bytes: made longer than the file.
  const std::string size("\x28\0\0\0\0\0\0\0", 8);
  std::size_t at = bytes.find(size);
  int refused = 0;
  for (; at != bytes.npos; at = bytes.find(size, at + 1)) {
    std::string changed = bytes;
    changed[at + 4] = 1;
    const auto contents = decode_hdf5(std::as_bytes(std::span(changed)));
    if (contents) continue;
    ++refused;
    EXPECT_EQ(contents.error().kind, ErrorKind::data);
  }
  EXPECT_GT(refused, 0);
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
  EXPECT_THAT(decode_hdf5(std::as_bytes(std::span(bytes)))->notes,
              ElementsAre(AllOf(HasSubstr("'x'"), HasSubstr("checksum"))));
  bytes.replace(0, 10, "MATLAB 7.3");
  EXPECT_THAT(decode_hdf5(std::as_bytes(std::span(bytes)))->notes,
              ElementsAre(AllOf(HasSubstr("'x'"), HasSubstr("checksum"))));
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
