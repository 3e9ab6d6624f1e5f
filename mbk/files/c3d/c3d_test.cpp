#include "mbk/files/c3d/c3d.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

#include "mbk/files/c3d/test_c3d.h"
#include "mbk/files/contents/test_files.h"

namespace mbk::recording {
namespace c3d_test {

using test::C3d;
using test::small_c3d;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

constexpr int kProcessors[] = {84, 85, 86};

Result<Contents> decode(std::string_view bytes) {
  return decode_c3d(std::as_bytes(std::span(bytes)));
}

Contents good(const std::string& bytes) {
  auto contents = decode(bytes);
  EXPECT_TRUE(contents) << contents.error().line();
  return contents.value_or(Contents{});
}

std::string refusal(const std::string& bytes) {
  const auto contents = decode(bytes);
  EXPECT_FALSE(contents);
  return contents ? "" : contents.error().line();
}

const Array& array(const Contents& contents, std::string_view name) {
  static const Array none;
  for (const Array& one : contents.arrays) {
    if (one.name == name) return one;
  }
  ADD_FAILURE() << "there is no " << name;
  return none;
}

/// The largest difference of two arrays; infinite where they are not NaN at the same places.
double difference(const Array& a, const Array& b) {
  if (a.values.rows() != b.values.rows()) return INFINITY;
  double largest = 0.0;
  for (Index i = 0; i < a.values.rows(); ++i) {
    const double one = a.values(i, 0), other = b.values(i, 0);
    if (std::isnan(one) != std::isnan(other)) return INFINITY;
    if (!std::isnan(one)) largest = std::max(largest, std::abs(one - other));
  }
  return largest;
}

// ---- what a file holds ----

TEST(DecodeC3d, GivesPointsAndChannelsWithUnitsAndRates) {
  const Contents contents = good(small_c3d().bytes());
  EXPECT_EQ(contents.format, "C3D");
  std::vector<std::string> names;
  for (const Array& one : contents.arrays) names.push_back(one.name);
  EXPECT_THAT(names,
              ElementsAre("HAND.x", "HAND.y", "HAND.z", "ELBOW.x", "ELBOW.y", "ELBOW.z", "Force X", "Angle", "EMG"));
  const Array& hand = array(contents, "HAND.y");
  EXPECT_EQ(hand.unit, "mm");
  EXPECT_EQ(hand.rate_hz, 100.0);
  EXPECT_EQ(hand.values, small_c3d().coordinates.col(1));
  const Array& force = array(contents, "Force X");
  EXPECT_EQ(force.unit, "N");
  EXPECT_EQ(force.rate_hz, 200.0);
  EXPECT_EQ(force.values, Matrix((small_c3d().analog.col(0).array() - 2048.0) * 0.25));
  EXPECT_EQ(array(contents, "EMG").values, Matrix((small_c3d().analog.col(2).array() + 3.0) * 2.0));
}

TEST(DecodeC3d, EveryProcessorAndKindOfNumberReadsEqual) {
  const Contents intel = good(small_c3d().bytes());
  for (const int processor : kProcessors) {
    for (const bool real : {true, false}) {
      const Contents other = good(small_c3d(processor, real).bytes());
      ASSERT_EQ(other.arrays.size(), intel.arrays.size());
      for (std::size_t k = 0; k < intel.arrays.size(); ++k) {
        EXPECT_EQ(other.arrays[k].name, intel.arrays[k].name);
        EXPECT_EQ(other.arrays[k].unit, intel.arrays[k].unit);
        EXPECT_EQ(difference(other.arrays[k], intel.arrays[k]), 0.0) << processor << " " << real;
      }
      ASSERT_EQ(other.events.size(), 2u);
      EXPECT_EQ(other.events[1].name, "STOP");
      EXPECT_FLOAT_EQ(static_cast<float>(other.events[1].time), 0.05f);
    }
  }
}

TEST(DecodeC3d, VaxRealsKeepTheirDigits) {
  C3d file = small_c3d(85);
  const double values[] = {1.0, -1.0, 0.1f, -123456.789f, 1.5e-38, 1.0e38, 0.0, 3.14159274};
  for (Index k = 0; k < 6; ++k) file.coordinates(k, 0) = values[k];
  const Array hand = array(good(file.bytes()), "HAND.x");
  for (Index k = 0; k < 6; ++k) EXPECT_EQ(hand.values(k, 0), static_cast<double>(static_cast<float>(values[k])));
}

TEST(DecodeC3d, AReservedVaxOperandIsNotANumber) {
  std::string bytes = small_c3d(85).bytes();
  const std::size_t data = bytes.size() - 512;
  ASSERT_EQ(good(bytes).arrays[0].values(0, 0), 0.0);
  bytes.replace(data, 4, std::string("\x00\x80\x00\x00", 4));  // sign 1, exponent 0
  EXPECT_TRUE(std::isnan(good(bytes).arrays[0].values(0, 0)));
}

TEST(DecodeC3d, PointsMarkedInvalidAreNotNumbers) {
  const Contents contents = good(small_c3d(84, false).bytes());
  const Matrix& elbow = array(contents, "ELBOW.z").values;
  for (Index f = 0; f < elbow.rows(); ++f) EXPECT_EQ(std::isnan(elbow(f, 0)), f % 3 == 1) << f;
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("1 of 2"), HasSubstr("point"))));
}

TEST(DecodeC3d, UnsignedAnalogNumbersAndOffsets) {
  C3d file = small_c3d(86, false);
  file.format = "UNSIGNED";
  file.analog(3, 0) = 65000;
  file.analog_offset[0] = 40000;
  EXPECT_EQ(array(good(file.bytes()), "Force X").values(3, 0), 25000 * 0.25);
  file.format = "SIGNED";
  EXPECT_EQ(array(good(file.bytes()), "Force X").values(3, 0), (65000 - 65536 - (40000 - 65536)) * 0.25);
}

TEST(DecodeC3d, AGeneralScaleHoldsForEveryChannel) {
  C3d file = small_c3d();
  file.general_scale = 4.0;
  EXPECT_EQ(array(good(file.bytes()), "Angle").values(1, 0), (file.analog(1, 1) - 0) * 0.5 * 4.0);
}

TEST(DecodeC3d, ChannelsWithoutScaleAreNamedAndLoseTheirUnit) {
  C3d file = small_c3d();
  file.analog_scale.resize(1);
  const Contents contents = good(file.bytes());
  EXPECT_EQ(array(contents, "EMG").values(1, 0), file.analog(1, 2) + 3);
  EXPECT_EQ(array(contents, "EMG").unit, "");
  EXPECT_EQ(array(contents, "Force X").unit, "N");
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("2 of 3"), HasSubstr("SCALE"))));
}

TEST(DecodeC3d, PointsOrChannelsAlone) {
  C3d analog = small_c3d();
  analog.points.clear();
  EXPECT_EQ(good(analog.bytes()).arrays.size(), 3u);
  C3d points = small_c3d();
  points.channels.clear();
  EXPECT_EQ(good(points.bytes()).arrays.size(), 6u);
  points.points.clear();
  points.analog.resize(12, 0);
  EXPECT_THAT(refusal(points.bytes()), AllOf(HasSubstr("points"), HasSubstr("analog channels")));
}

TEST(DecodeC3d, MoreThan255PointsAndChannels) {
  C3d file;
  for (int k = 1; k <= 600; ++k) {
    file.points.push_back("P" + std::to_string(k));
    file.channels.push_back("C" + std::to_string(k));
    file.analog_scale.push_back(k);
    file.analog_offset.push_back(-k);
    file.analog_units.push_back("u" + std::to_string(k));
  }
  file.coordinates = Matrix::Constant(2, 2400, 3.0);
  file.analog = Matrix::Constant(2, 600, 5.0);
  const Contents contents = good(file.bytes());
  EXPECT_EQ(contents.arrays.size(), 3 * 600u + 600u);
  EXPECT_EQ(array(contents, "P600.z").values(1, 0), 3.0);
  EXPECT_EQ(array(contents, "C599").values(1, 0), (5.0 + 599.0) * 599.0);
  EXPECT_EQ(array(contents, "C599").unit, "u599");
}

TEST(DecodeC3d, RepeatedAndMissingLabelsBecomeUnique) {
  C3d file = small_c3d();
  file.points = {"*", "*"};
  file.channels = {"EMG", "", "*.x"};
  const Contents contents = good(file.bytes());
  std::vector<std::string> names;
  for (const Array& one : contents.arrays) names.push_back(one.name);
  // Neither keeps a label that repeats: whoever asks for it has to say which one.
  EXPECT_THAT(names, ElementsAre("*#1.x", "*#1.y", "*#1.z", "*#2.x", "*#2.y", "*#2.z", "EMG", "analog_2", "*.x"));
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("point"), HasSubstr("label"), HasSubstr("'*#1'"))));
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("1 of 3"), HasSubstr("label"))));
}

TEST(DecodeC3d, NumbersOfRepeatedLabelsAvoidLabelsThatAreThere) {
  C3d file = small_c3d();
  file.points = {"A", "B"};
  file.channels = {"B.x", "E", "E"};
  const auto names = [&] {
    const Contents contents = good(file.bytes());
    std::vector<std::string> found;
    for (std::size_t k = 3; k < contents.arrays.size(); ++k) found.push_back(contents.arrays[k].name);
    return found;
  };
  EXPECT_THAT(names(), ElementsAre("B.x", "B.y", "B.z", "B.x#2", "E#1", "E#2"));
  file.channels = {"E#1", "E ", "E"};  // blanks around a label are none of it
  EXPECT_THAT(names(), ElementsAre("B.x", "B.y", "B.z", "E#1", "E#2", "E#3"));
}

TEST(DecodeC3d, PointsOfAModelHaveTheUnitOfTheirType) {
  C3d file = small_c3d();
  file.records = file.numbers().texts(C3d::kPoint, "ANGLES", {"ELBOW"}) +
                 file.numbers().texts(C3d::kPoint, "ANGLE_UNITS", {"deg"});
  const Contents contents = good(file.bytes());
  EXPECT_EQ(array(contents, "ELBOW.y").unit, "deg");
  EXPECT_EQ(array(contents, "HAND.y").unit, "mm");
  file.records = file.numbers().texts(C3d::kPoint, "MOMENTS", {"ELBOW"});  // in no known unit, and not in mm
  EXPECT_EQ(array(good(file.bytes()), "ELBOW.y").unit, "");
  file.point_units = "";
  EXPECT_THAT(good(file.bytes()).notes, Contains(HasSubstr("x=HAND.x:mm")));
}

// ---- events ----

TEST(DecodeC3d, EventsOfTheHeaderAndOfTheGroupStandOnceInOrder) {
  C3d file = small_c3d();
  const auto n = file.numbers();
  file.records = n.words(C3d::kEvent, "USED", {3}) + n.texts(C3d::kEvent, "CONTEXTS", {"Left", "", "Right"}) +
                 n.texts(C3d::kEvent, "LABELS", {"Strike", "PUSH", "Off"}) +
                 n.parameter(C3d::kEvent, "TIMES", 4, {2, 3},
                             n.real(1) + n.real(2.5) + n.real(0) + n.real(0.02) + n.real(0) + n.real(0.01));
  const Contents contents = good(file.bytes());
  std::vector<std::string> names;
  for (const Event& event : contents.events) names.push_back(event.name);
  EXPECT_THAT(names, ElementsAre("Right Off", "PUSH", "STOP", "Left Strike"));
  EXPECT_EQ(contents.events.back().time, 62.5);
}

TEST(DecodeC3d, EventsOfTheGroupCountFromFrameOneAndThoseOfTheHeaderFromTheFirst) {
  C3d file = small_c3d();
  const auto n = file.numbers();
  file.first = 301;  // 3 s at 100 Hz
  file.records = n.words(C3d::kEvent, "USED", {1}) + n.texts(C3d::kEvent, "LABELS", {"GO"}) +
                 n.parameter(C3d::kEvent, "TIMES", 4, {2, 1}, n.real(0) + n.real(3.25));
  const Contents contents = good(file.bytes());
  ASSERT_EQ(contents.events.size(), 3u);
  EXPECT_EQ(contents.events[2].name, "GO");
  EXPECT_EQ(contents.events[2].time, 0.25);
  EXPECT_FLOAT_EQ(static_cast<float>(contents.events[0].time), 0.02f);
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("frame"), HasSubstr("301"))));
}

/// Times of the events of the group `name`, in a file of 100 s.
std::vector<double> times_of_events(const std::string& name, const std::vector<int>& dimensions,
                                    const std::vector<double>& values, int labels, std::string* notes = nullptr) {
  constexpr int kGroup = 30;
  C3d file = small_c3d();
  const auto n = file.numbers();
  file.rate = 0.06;
  file.events.clear();
  std::string times;
  for (const double value : values) times += n.real(value);
  file.records = n.group(kGroup, name) + n.words(kGroup, "USED", {static_cast<double>(labels)}) +
                 n.texts(kGroup, "LABELS", std::vector<std::string>(static_cast<std::size_t>(labels), "GO")) +
                 n.parameter(kGroup, "TIMES", 4, dimensions, times);
  const Contents contents = good(file.bytes());
  std::vector<double> found;
  for (const Event& event : contents.events) found.push_back(event.time);
  for (const std::string& note : contents.notes) {
    if (notes != nullptr) *notes += note + "\n";
  }
  return found;
}

TEST(DecodeC3d, TimesOfEventsAreMinutesAndSecondsInEitherGroup) {
  for (const char* group : {"EVENT", "EVENTS"}) {
    EXPECT_THAT(times_of_events(group, {2, 2}, {1, 2.5, 0, 8}, 2), ElementsAre(8.0, 62.5)) << group;
    EXPECT_THAT(times_of_events(group, {4}, {1, 2.5, 0, 8}, 2), ElementsAre(8.0, 62.5)) << group;  // as Vicon had it
    EXPECT_THAT(times_of_events(group, {3, 2}, {1, 0, 0, 2.5, 8, 9}, 3), ElementsAre(8.0, 9.0, 62.5)) << group;
    EXPECT_THAT(times_of_events(group, {2}, {2.5, 8}, 2), ElementsAre(2.5, 8.0)) << group;  // seconds alone
    EXPECT_THAT(times_of_events(group, {1, 2}, {2.5, 8}, 2), ElementsAre(2.5, 8.0)) << group;
    EXPECT_THAT(times_of_events(group, {4}, {2.5, 8, 0, 0}, 2), ElementsAre(2.5, 8.0)) << group;  // room for four
  }
}

TEST(DecodeC3d, TheRowThatDexteritEDoesNotUseIsIgnoredWhereItIsNoMinutes) {
  std::string notes;
  EXPECT_THAT(times_of_events("EVENTS", {2, 2}, {7, 2.5, 7, 8}, 2, &notes), ElementsAre(2.5, 8.0));
  EXPECT_THAT(notes, AllOf(HasSubstr("EVENTS:TIMES"), HasSubstr("minutes")));
  EXPECT_THAT(times_of_events("EVENT", {2, 2}, {7, 2.5, 7, 8}, 2), ElementsAre(422.5, 428.0));
}

// ---- how many frames ----

/// One channel of one sample for each of so many frames.
C3d long_file(Index frames) {
  C3d file;
  file.real = false;
  file.channels = {"F"};
  file.analog_scale = {1.0};
  file.analog_offset = {0.0};
  file.analog_units = {"N"};
  file.analog.resize(frames, 1);
  for (Index k = 0; k < frames; ++k) file.analog(k, 0) = static_cast<double>(k % 30000);
  return file;
}

TEST(DecodeC3d, MoreFramesThan65535) {
  constexpr Index kFrames = 70000;
  C3d file = long_file(kFrames);
  const auto n = file.numbers();
  const std::string ways[] = {n.reals(C3d::kPoint, "LONG_FRAMES", {kFrames}), n.reals(C3d::kPoint, "FRAMES", {kFrames}),
                              n.words(C3d::kTrial, "ACTUAL_START_FIELD", {1, 0}) +
                                  n.words(C3d::kTrial, "ACTUAL_END_FIELD", {kFrames % 65536, kFrames / 65536})};
  for (const std::string& way : ways) {
    file.records = way;
    const Contents contents = good(file.bytes());
    ASSERT_EQ(contents.arrays.size(), 1u);
    ASSERT_EQ(contents.arrays[0].values.rows(), kFrames);
    EXPECT_EQ(contents.arrays[0].values(kFrames - 1, 0), (kFrames - 1) % 30000);
  }
}

/// Rows and notes of a file of 70000 frames with these records and this last frame in its header.
std::pair<Index, std::string> frames_and_notes(const C3d& file, int last_in_header = 65535) {
  std::string bytes = file.bytes();
  bytes.replace(8, 2, file.numbers().word(last_in_header));
  const Contents contents = good(bytes);
  std::string notes;
  for (const std::string& note : contents.notes) notes += note + "\n";
  return {contents.arrays.empty() ? 0 : contents.arrays[0].values.rows(), notes};
}

TEST(DecodeC3d, ACountThatLostItsUpperWordIsCorrectedAndSaid) {
  constexpr int kFrames = 70000, kLower = kFrames % 65536;
  C3d file = long_file(kFrames);
  const auto n = file.numbers();
  const std::string field =
      n.words(C3d::kTrial, "ACTUAL_START_FIELD", {1, 0}) + n.words(C3d::kTrial, "ACTUAL_END_FIELD", {kLower, 1});
  file.records = n.words(C3d::kPoint, "FRAMES", {kLower}) + field;
  auto [frames, notes] = frames_and_notes(file);
  EXPECT_EQ(frames, kFrames);
  EXPECT_THAT(notes, AllOf(HasSubstr("70000"), HasSubstr("TRIAL:ACTUAL_END_FIELD"), HasSubstr("POINT:FRAMES"),
                           HasSubstr("4464")));
  std::tie(frames, notes) = frames_and_notes(file, kLower);
  EXPECT_EQ(frames, kFrames);
  EXPECT_THAT(notes, AllOf(HasSubstr("POINT:FRAMES"), HasSubstr("4464"), HasSubstr("header")));
  file.records = n.words(C3d::kPoint, "FRAMES", {kLower});  // every count lost it
  std::tie(frames, notes) = frames_and_notes(file, kLower);
  EXPECT_EQ(frames, kFrames);
  EXPECT_THAT(notes, AllOf(HasSubstr("70000"), HasSubstr("file size"), HasSubstr("POINT:FRAMES"), HasSubstr("4464")));
  // Something else stands behind the frames: the size does not decide, but what is lost does.
  file.records = n.words(C3d::kPoint, "FRAMES", {kLower}) + field;
  EXPECT_EQ(good(file.bytes() + std::string(3000, 'x')).arrays[0].values.rows(), kFrames);
  // A file cut short does not become one of 4464 frames.
  EXPECT_THAT(refusal(file.bytes().substr(0, 100000)), AllOf(HasSubstr("70000 frames"), HasSubstr("2 bytes")));
}

TEST(DecodeC3d, AFullCountGivesWayToWhatTheFileHolds) {
  C3d file = long_file(70000);
  for (Index k = 0; k < 70000; ++k) file.analog(k, 0) += 1.0;
  auto [frames, notes] = frames_and_notes(file);  // POINT:FRAMES and the header say 65535, as Vicon and ezc3d write it
  EXPECT_EQ(frames, 70000);                       // and not the padding of the last block
  EXPECT_THAT(notes, AllOf(HasSubstr("65535 frames"), HasSubstr("70000")));
  std::tie(frames, notes) = frames_and_notes(long_file(65535));
  EXPECT_EQ(frames, 65535);
  EXPECT_THAT(notes, Not(HasSubstr("65535 frames")));
  const auto n = file.numbers();  // rotations begin in their own section
  constexpr int kRotation = 40;
  file.records = n.group(kRotation, "ROTATION") + n.words(kRotation, "DATA_START", {260});
  EXPECT_EQ(frames_and_notes(file).first, (259 - 2) * 512 / 2);
  file.records =
      n.words(C3d::kTrial, "ACTUAL_START_FIELD", {1, 0}) + n.words(C3d::kTrial, "ACTUAL_END_FIELD", {80000 % 65536, 1});
  EXPECT_THAT(refusal(file.bytes()), AllOf(HasSubstr("80000 frames"), HasSubstr("2 bytes")));
}

TEST(DecodeC3d, NeverReadsBehindTheFile) {
  C3d file = long_file(3000);
  const auto n = file.numbers();
  file.records = n.words(C3d::kPoint, "FRAMES", {4000});
  const auto [frames, notes] = frames_and_notes(file, 3000);
  EXPECT_EQ(frames, 3000);
  EXPECT_THAT(notes, AllOf(HasSubstr("3000"), HasSubstr("header"), HasSubstr("POINT:FRAMES"), HasSubstr("4000")));
  std::string bytes = file.bytes();
  bytes.replace(8, 2, n.word(4000));  // nothing says 3000
  EXPECT_THAT(refusal(bytes), AllOf(HasSubstr("4000 frames"), HasSubstr("2 bytes")));
}

TEST(DecodeC3d, SaysWhereHeaderAndParametersCountDifferentFrames) {
  C3d file = small_c3d();
  for (const int said : {4, 5, 7, 8}) {  // the last block has room for as many
    file.records = file.numbers().words(C3d::kPoint, "FRAMES", {static_cast<double>(said)});
    const Contents contents = good(file.bytes());
    EXPECT_EQ(contents.arrays[0].values.rows(), 6) << said;  // followed by zeros
    EXPECT_THAT(contents.notes,
                Contains(AllOf(HasSubstr("header"), HasSubstr("POINT:FRAMES"), HasSubstr(" " + std::to_string(said)))));
  }
  std::string bytes = file.bytes();
  bytes.back() = 'x';  // the padding does not decide: POINT:FRAMES goes first
  EXPECT_EQ(good(bytes).arrays[0].values.rows(), 8);
}

// ---- where the data begin, and how ----

/// A file of 300 frames, whose size says how it is laid out.
C3d longer_c3d(bool real = true) {
  C3d file = small_c3d(84, real);
  file.coordinates = Matrix::Constant(300, 8, 2.0);
  file.analog = Matrix::Constant(600, 3, 7.0);
  for (Index k = 0; k < 300; ++k) file.coordinates(k, 0) = static_cast<double>(k);
  return file;
}

TEST(DecodeC3d, SaysWhereHeaderAndParametersBeginTheDataDifferently) {
  const Contents before = good(small_c3d().bytes());
  ASSERT_EQ(before.notes.size(), 2u);
  std::string bytes = small_c3d().bytes();
  bytes[16] = static_cast<char>(bytes[16] + 1);
  const Contents contents = good(bytes);
  EXPECT_EQ(difference(contents.arrays[6], before.arrays[6]), 0.0);
  EXPECT_THAT(contents.notes, Contains(HasSubstr("POINT:DATA_START")));
}

TEST(DecodeC3d, ADataStartThatCannotBeGivesWayToTheHeader) {
  C3d file = longer_c3d();
  const Contents before = good(file.bytes());
  const int right = file.bytes()[16];
  for (const double block : {0.0, 1.0, 2.0, 3.0, right - 1.0, right + 1.0, right + 7.0, 60000.0}) {
    file.records = file.numbers().words(C3d::kPoint, "DATA_START", {block});
    std::string bytes = file.bytes();  // the record that was added may need a block
    if (static_cast<double>(bytes[16]) == block) continue;
    const Contents contents = good(bytes);
    ASSERT_EQ(contents.arrays.size(), before.arrays.size()) << block;
    for (std::size_t k = 0; k < before.arrays.size(); ++k) {
      EXPECT_EQ(difference(contents.arrays[k], before.arrays[k]), 0.0) << block << " " << before.arrays[k].name;
    }
    EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("header"), HasSubstr("POINT:DATA_START"), HasSubstr("block"))))
        << block;
  }
}

TEST(DecodeC3d, AHeaderThatPointsIntoTheParametersLosesNone) {
  C3d file = longer_c3d();
  for (int k = 0; k < 100; ++k) file.records += file.numbers().reals(C3d::kTrial, "P" + std::to_string(k), {1.0, 2.0});
  const Contents before = good(file.bytes());
  for (const char block : {0, 1, 2, 3, 4}) {
    std::string bytes = file.bytes();
    ASSERT_GT(bytes[16], 5);
    bytes[16] = block;
    const Contents contents = good(bytes);
    ASSERT_EQ(contents.arrays.size(), before.arrays.size()) << int{block};
    for (std::size_t k = 0; k < before.arrays.size(); ++k) {
      EXPECT_EQ(contents.arrays[k].name, before.arrays[k].name);
      EXPECT_EQ(contents.arrays[k].unit, before.arrays[k].unit);
      EXPECT_EQ(difference(contents.arrays[k], before.arrays[k]), 0.0) << int{block} << " " << before.arrays[k].name;
    }
    EXPECT_THAT(contents.notes, Contains(HasSubstr("POINT:DATA_START"))) << int{block};
  }
}

TEST(DecodeC3d, TheSizeOfTheFileDecidesBetweenHeaderAndParameters) {
  const C3d right = longer_c3d();
  const auto n = right.numbers();
  const Contents before = good(right.bytes());
  const auto same = [&](const std::string& bytes, std::string_view said) {
    const Contents contents = good(bytes);
    ASSERT_EQ(contents.arrays.size(), before.arrays.size()) << said;
    for (std::size_t k = 0; k < before.arrays.size(); ++k) {
      EXPECT_EQ(difference(contents.arrays[k], before.arrays[k]), 0.0) << said << " " << before.arrays[k].name;
    }
    EXPECT_THAT(contents.notes, Contains(HasSubstr(std::string(said))));
  };
  const auto in_header = [&](std::size_t at, const std::string& number) {
    std::string bytes = right.bytes();
    return bytes.replace(at, number.size(), number);
  };
  same(in_header(2, n.word(3)), "3 points");
  same(in_header(4, n.word(3)), "3 analog values");
  same(in_header(18, n.word(1)), "analog samples");
  same(in_header(12, n.real(0.5)), "-0.5");
  C3d wrong = right;
  wrong.records = n.words(C3d::kPoint, "USED", {3});
  same(wrong.bytes(), "2 points");
  wrong.records = n.reals(C3d::kPoint, "SCALE", {0.5});
  same(wrong.bytes(), "scale");
  wrong.records = n.reals(C3d::kPoint, "SCALE", {0.0});  // no scale is 0: the header's sign is the one there is
  EXPECT_EQ(good(wrong.bytes()).arrays[0].values, before.arrays[0].values);
  wrong.records = n.reals(C3d::kAnalog, "RATE", {300.0});  // the frame holds two samples, whatever the rate is
  EXPECT_THAT(refusal(wrong.bytes()), AllOf(HasSubstr("ANALOG:RATE"), HasSubstr("300 Hz"), HasSubstr("2 samples")));
}

TEST(DecodeC3d, RatesThatContradictEachOtherAreDecidedByAThirdOrByNobody) {
  C3d file = longer_c3d();
  const auto n = file.numbers();
  file.records = n.reals(C3d::kPoint, "RATE", {50.0}) + n.reals(C3d::kAnalog, "RATE", {200.0});
  Contents contents = good(file.bytes());
  EXPECT_EQ(array(contents, "HAND.x").rate_hz, 100.0);
  EXPECT_EQ(array(contents, "EMG").rate_hz, 200.0);
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("100 Hz"), HasSubstr("ANALOG:RATE"))));
  std::string bytes = longer_c3d().bytes();
  bytes.replace(20, 4, n.real(50.0));
  EXPECT_EQ(array(good(bytes), "HAND.x").rate_hz, 100.0);
  file.channels.clear();
  contents = good(file.bytes());
  EXPECT_EQ(array(contents, "HAND.x").rate_hz, 0.0);
  EXPECT_THAT(contents.notes, Contains(HasSubstr("--rate")));
  file.records = n.reals(C3d::kPoint, "RATE", {0.0});
  EXPECT_EQ(array(good(file.bytes()), "HAND.x").rate_hz, 100.0);  // as the header says
}

// ---- scales ----

TEST(DecodeC3d, IntegerPointsOfTwoScalesCannotBeUsed) {
  C3d file = small_c3d(84, false);
  file.records = file.numbers().reals(C3d::kPoint, "SCALE", {0.2});
  const Contents contents = good(file.bytes());
  ASSERT_TRUE(array(contents, "HAND.x").obstacle);
  EXPECT_THAT(array(contents, "HAND.x").obstacle->line(),
              AllOf(HasSubstr("0.5"), HasSubstr("POINT:SCALE"), HasSubstr("0.2")));
  EXPECT_FALSE(array(contents, "Angle").obstacle);
  EXPECT_EQ(array(contents, "Angle").values.rows(), 12);
  EXPECT_THAT(contents.notes, Contains(HasSubstr("POINT:SCALE")));
  C3d real = small_c3d();  // which are scaled already
  real.records = real.numbers().reals(C3d::kPoint, "SCALE", {-0.2});
  EXPECT_EQ(good(real.bytes()).arrays[0].values, good(small_c3d().bytes()).arrays[0].values);
}

TEST(DecodeC3d, AScaleOfZeroIsAnObstacleAndNoChannelOfZeros) {
  C3d file = small_c3d();
  file.analog_scale = {0.25, 0.0, 2.0};
  const Contents contents = good(file.bytes());
  ASSERT_TRUE(array(contents, "Angle").obstacle);
  EXPECT_THAT(array(contents, "Angle").obstacle->line(),
              AllOf(HasSubstr("'Angle'"), HasSubstr("ANALOG:SCALE"), HasSubstr("ANALOG:GEN_SCALE")));
  EXPECT_FALSE(array(contents, "EMG").obstacle);
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("1 of 3"), HasSubstr("GEN_SCALE"))));
  for (const double general : {0.0, std::nan("")}) {
    file.general_scale = general;
    for (const char* channel : {"Force X", "Angle", "EMG"}) {
      EXPECT_TRUE(array(good(file.bytes()), channel).obstacle) << channel << general;
    }
  }
}

TEST(DecodeC3d, SaysWhichScalesAndOffsetsAreMissing) {
  C3d file = small_c3d();
  file.analog_offset.resize(1);
  EXPECT_THAT(good(file.bytes()).notes, Contains(AllOf(HasSubstr("2 of 3"), HasSubstr("OFFSET"))));
}

// ---- signed or unsigned ----

/// One channel of integers about `level`, its OFFSET, what ANALOG:FORMAT says, and values as they are read.
Matrix read_words(const std::vector<double>& words, double offset, const std::string& format, bool* said = nullptr) {
  C3d file = long_file(static_cast<Index>(words.size()));
  for (std::size_t k = 0; k < words.size(); ++k) file.analog(static_cast<Index>(k), 0) = words[k];
  file.analog_offset = {offset};
  file.format = format;
  const Contents contents = good(file.bytes());
  if (said != nullptr) {
    *said = std::ranges::any_of(contents.notes,
                                [](const std::string& note) { return note.find("ANALOG:FORMAT") != note.npos; });
  }
  return contents.arrays.at(0).values;
}

std::vector<double> wave(double middle, double amplitude) {
  std::vector<double> words;
  for (int k = 0; k < 400; ++k) words.push_back(std::round(middle + amplitude * std::sin(0.05 * k)));
  return words;
}

Matrix less(const std::vector<double>& words, double offset) {
  Matrix values(static_cast<Index>(words.size()), 1);
  for (std::size_t k = 0; k < words.size(); ++k) values(static_cast<Index>(k), 0) = words[k] - offset;
  return values;
}

TEST(DecodeC3d, WordsAreReadAsTheirNumbersShowWhereTheFormatIsWrong) {
  bool said = false;
  for (const char* format : {"SIGNED", ""}) {
    for (const auto& words : {wave(32768, 40), wave(33000, 20000), wave(20000, 500), std::vector<double>(9, 32768)}) {
      EXPECT_EQ(read_words(words, 32768, format, &said), less(words, 32768)) << format;
    }
    EXPECT_EQ(read_words(wave(33000, 20000), 0, format, &said), less(wave(33000, 20000), 0)) << format;
    EXPECT_TRUE(said);
    EXPECT_EQ(read_words(wave(32700, 300), 32700, format, &said), less(wave(32700, 300), 32700)) << format;
    EXPECT_TRUE(said);
  }
  EXPECT_EQ(read_words(wave(0, 3000), -3, "UNSIGNED", &said), less(wave(0, 3000), -3));
  EXPECT_TRUE(said);
  EXPECT_EQ(read_words(wave(0, 20000), 0, "UNSIGNED", &said), less(wave(0, 20000), 0));
  EXPECT_TRUE(said);
}

TEST(DecodeC3d, WordsAreReadAsTheFormatSaysWhereTheyMayBe) {
  const std::vector<double> rails = {-32768, -32760, 32767, 32760, -32768}, unsigned_rails = {0, 3, 65535, 65530, 0};
  std::vector<double> counter;
  for (int k = 0; k < 1000; ++k) counter.push_back(k * 97 % 65536);
  bool said = true;
  EXPECT_EQ(read_words(wave(0, 32000), 0, "SIGNED", &said), less(wave(0, 32000), 0));
  EXPECT_FALSE(said);
  EXPECT_EQ(read_words(wave(-9000, 20000), 2000, "SIGNED", &said), less(wave(-9000, 20000), 2000));
  EXPECT_FALSE(said);
  EXPECT_EQ(read_words(wave(30000, 500), -5000, "SIGNED", &said), less(wave(30000, 500), -5000));
  EXPECT_FALSE(said);
  EXPECT_EQ(read_words(rails, 0, "SIGNED", &said), less(rails, 0));  // a switch, at either end of the range
  EXPECT_FALSE(said);
  EXPECT_EQ(read_words(wave(32768, 30000), 32768, "UNSIGNED", &said), less(wave(32768, 30000), 32768));
  EXPECT_FALSE(said);
  EXPECT_EQ(read_words(wave(2048, 2000), 2048, "UNSIGNED", &said), less(wave(2048, 2000), 2048));
  EXPECT_FALSE(said);
  EXPECT_EQ(read_words(unsigned_rails, 0, "UNSIGNED", &said), less(unsigned_rails, 0));
  EXPECT_FALSE(said);
  EXPECT_EQ(read_words(counter, 0, "UNSIGNED", &said), less(counter, 0));  // which starts anew at 65536
  EXPECT_FALSE(said);
}

TEST(DecodeC3d, TheOffsetOfRealsIsReadAsTheirNumbersShow) {
  C3d file = small_c3d();
  file.analog.col(0).setConstant(32768.0);
  file.analog_offset = {32768, 0, 0};
  const Contents contents = good(file.bytes());
  EXPECT_EQ(array(contents, "Force X").values.norm(), 0.0);
  EXPECT_THAT(contents.notes, Contains(AllOf(HasSubstr("1 of 3"), HasSubstr("unsigned"))));
  file.analog.col(0).setConstant(5.0);
  file.analog_offset = {-3, 0, 0};
  file.format = "UNSIGNED";
  EXPECT_EQ(array(good(file.bytes()), "Force X").values(0, 0), 8.0 * 0.25);
}

// ---- refusals ----

TEST(DecodeC3d, RefusesWhereHeaderAndParametersContradictEachOther) {
  const auto n = small_c3d().numbers();
  const auto with = [](const std::string& record) {
    C3d file = small_c3d();
    file.records = record;
    return refusal(file.bytes());
  };
  // The file is short: its last block has room for either.
  EXPECT_THAT(with(n.words(C3d::kPoint, "USED", {3})), AllOf(HasSubstr("header"), HasSubstr("2 points")));
  EXPECT_THAT(with(n.words(C3d::kAnalog, "USED", {4})), AllOf(HasSubstr("header"), HasSubstr("6 analog values")));
  EXPECT_THAT(with(n.reals(C3d::kPoint, "SCALE", {0.5})), HasSubstr("scale"));
  EXPECT_THAT(with(n.reals(C3d::kAnalog, "RATE", {300.0})),
              AllOf(HasSubstr("2 analog samples"), HasSubstr("ANALOG:RATE"), HasSubstr("300 Hz"),
                    HasSubstr("POINT:RATE"), HasSubstr("100 Hz")));
  const auto with_both = [&](const std::string& record, std::size_t at, const std::string& number) {
    C3d file = small_c3d();
    file.records = record;
    return refusal(file.bytes().replace(at, number.size(), number));
  };
  EXPECT_THAT(with_both(n.reals(C3d::kPoint, "SCALE", {0.0}), 12, n.real(0.0)),
              AllOf(HasSubstr("POINT:SCALE"), HasSubstr("integers"), HasSubstr("reals")));
  EXPECT_THAT(with_both(n.words(C3d::kPoint, "FRAMES", {0}), 6, n.word(7) + n.word(6)), HasSubstr("0 frames"));
  EXPECT_THAT(with_both(n.words(C3d::kPoint, "FRAMES", {60000}), 8, n.word(60000)),
              AllOf(HasSubstr("60000 frames"), HasSubstr("56 bytes")));
  EXPECT_THAT(with_both(n.words(C3d::kPoint, "DATA_START", {0}), 16, n.word(0)),
              AllOf(HasSubstr("block 0"), HasSubstr("POINT:DATA_START")));
  EXPECT_THAT(with_both(n.words(C3d::kPoint, "DATA_START", {2}), 16, n.word(2)),
              AllOf(HasSubstr("block 2"), HasSubstr("POINT:DATA_START"), HasSubstr("512")));
}

TEST(DecodeC3d, RefusesUnknownProcessorsTypesAndDimensions) {
  C3d file = small_c3d();
  std::string bytes = file.bytes();
  bytes[515] = 87;
  EXPECT_THAT(refusal(bytes), AllOf(HasSubstr("type 87"), HasSubstr("Intel"), HasSubstr("DEC"), HasSubstr("SGI")));
  file.records = file.numbers().parameter(C3d::kPoint, "ODD", 3, {}, "abc");
  EXPECT_THAT(refusal(file.bytes()), AllOf(HasSubstr("ODD"), HasSubstr("type 3")));
  file.records = file.numbers().parameter(C3d::kPoint, "ODD", 1, std::vector<int>(8, 1), "a");
  EXPECT_THAT(refusal(file.bytes()), HasSubstr("8 dimensions"));
  file.records = file.numbers().parameter(C3d::kPoint, "ODD", 4, std::vector<int>(7, 255), "a");
  EXPECT_THAT(refusal(file.bytes()), AllOf(HasSubstr("ODD"), HasSubstr("section")));
}

TEST(DecodeC3d, RefusesARecordThatDoesNotLeadForward) {
  C3d file = small_c3d();
  std::string record = file.numbers().words(C3d::kPoint, "LOOP", {1, 2, 3});
  record[6] = 1;
  file.records = record;
  EXPECT_THAT(refusal(file.bytes()), HasSubstr("record"));
}

TEST(DecodeC3d, RefusesAFileCutAnywhere) {
  for (const bool real : {true, false}) {
    const C3d file = small_c3d(84, real);
    const std::string whole = file.bytes();
    const std::size_t padding = 512 - file.data().size() % 512;
    for (std::size_t n = 2; n < whole.size() - padding; ++n) {
      ASSERT_FALSE(decode(std::string_view(whole).substr(0, n))) << "cut to " << n;
    }
    ASSERT_TRUE(decode(std::string_view(whole).substr(0, whole.size() - padding)));
  }
}

TEST(DecodeC3d, SurvivesChangedBytes) {
  std::vector<std::string> wholes;
  for (const int processor : kProcessors) {
    for (const bool real : {true, false}) wholes.push_back(small_c3d(processor, real).bytes());
  }
  std::mt19937 random(20130602);
  int read = 0;
  for (int i = 0; i < 40000; ++i) {
    std::string file = wholes[random() % wholes.size()];
    const std::size_t used = file.size() - 200;  // the rest is padding
    for (unsigned k = 0; k <= random() % 4; ++k) file[2 + random() % (used - 2)] = static_cast<char>(random());
    const auto contents = decode(file);
    if (!contents) {
      ASSERT_FALSE(contents.error().message.empty());
      continue;
    }
    ++read;
    Index numbers = 0;
    for (const Array& one : contents->arrays) numbers += one.values.size();
    ASSERT_LE(numbers, static_cast<Index>(file.size()));
  }
  EXPECT_GT(read, 1000);  // the changes do not all hit what must be refused
  EXPECT_LT(read, 39000);
}

// ---- files that others made ----

TEST(DecodeC3dRealFiles, TheSameTrialInThreeFormatsReadsEqual) {
  MBK_DATA_OR_SKIP(folder);
  const auto read = [&](std::string_view name) { return good(test::bytes_of(folder / "c3d" / name)); };
  const Contents real = read("Sample01_Eb015pr.c3d");
  const Contents vax = read("Sample01_Eb015vr.c3d");
  const Contents integer = read("Sample01_Eb015pi.c3d");
  ASSERT_EQ(real.arrays.size(), 26 * 3u + 16u);
  EXPECT_EQ(real.events.size(), 3u);
  for (std::size_t k = 0; k < real.arrays.size(); ++k) {
    EXPECT_EQ(vax.arrays.at(k).name, real.arrays[k].name);
    EXPECT_EQ(integer.arrays.at(k).name, real.arrays[k].name);
    EXPECT_EQ(difference(vax.arrays[k], real.arrays[k]), 0.0) << real.arrays[k].name;
    // Integers hold points to half of POINT:SCALE, 1/12 mm, and analog numbers exactly.
    EXPECT_LE(difference(integer.arrays[k], real.arrays[k]), k < 78 ? 0.5 / 12 + 1e-4 : 0.0) << real.arrays[k].name;
  }
}

}  // namespace c3d_test
}  // namespace mbk::recording
