#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mbk/base/core/nan.h"
#include "mbk/files/contents/test_files.h"
#include "mbk/files/recording/encode.h"
#include "mbk/files/recording/read.h"
#include "mbk/files/recording/write.h"

namespace mbk::recording {
namespace encode_c3d_test {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kSingle = 6e-8;         ///< relative error
constexpr double kEventRounding = 2e-6;  ///< [s]

/// A plane hand that begins at 12.5 s, with EMG, metadata and events.
Recording example(Index samples = 200) {
  Recording recording;
  recording.time = (12.5 + Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1)).array() / 1000.0).matrix();
  for (const auto& [name, unit, frame] : {std::tuple("hand_x", "m", "base"),
                                          {"hand_y", "m", "base"},
                                          {"force_x", "N", "base"},
                                          {"force_y", "N", "base"},
                                          {"reference_x", "N", "base"},
                                          {"reference_y", "N", "base"},
                                          {"emg_biceps", "V", ""}}) {
    recording.channels.push_back({name, unit, frame, Vector::Random(samples)});
  }
  recording.channels.back().values *= 1e-6;
  recording.metadata = {
      {"participant", "7"}, {"Note 2", " Ánna 😀 "}, {"none", ""}, {"long", std::string(1000, 'x') + "é"}};
  recording.events = {{12.55, "onset", 0.1}, {12.6, "onset", -1e300}, {85.0, "Ende ä", kNaN}, {85.0, "before", 3.0}};
  recording.events.push_back({12.4, "early", 0.0});
  std::ranges::stable_sort(recording.events, {}, &Event::time);
  return recording;
}

std::string refusal(const Recording& recording) {
  const auto bytes = encode_c3d(recording);
  EXPECT_FALSE(bytes);
  return bytes ? "" : bytes.error().line();
}

Recording written_and_read(const Recording& recording) {
  const test::Folder folder;
  ReadOptions options;
  options.own_samples = false;
  options.emg = EmgReading::same_clock;
  const auto ok = write(recording, folder / "a.c3d", Format::c3d, false);
  EXPECT_TRUE(ok) << ok.error().line();
  const auto back = read(folder / "a.c3d", options);
  EXPECT_TRUE(back) << back.error().line();
  return back.value_or(Recording{});
}

void expect_same(const Recording& read, const Recording& written) {
  ASSERT_EQ(read.samples(), written.samples());
  EXPECT_LE((read.time - written.time).cwiseAbs().maxCoeff(), 1e-12);
  ASSERT_EQ(read.channels.size(), written.channels.size());
  for (const Channel& channel : written.channels) {
    const Channel* const found = read.find(channel.name);
    ASSERT_NE(found, nullptr) << channel.name;
    EXPECT_EQ(found->unit, channel.unit) << channel.name;
    EXPECT_EQ(found->frame, channel.frame) << channel.name;
    for (Index k = 0; k < channel.values.size(); ++k) {
      const double value = channel.values[k];
      if (std::isfinite(value)) {
        ASSERT_LE(std::abs(found->values[k] - value), kSingle * std::abs(value)) << channel.name << " " << k;
      } else {
        ASSERT_TRUE(std::isnan(found->values[k])) << channel.name << " " << k;
      }
    }
  }
  EXPECT_EQ(read.metadata, written.metadata);
  ASSERT_EQ(read.events.size(), written.events.size());
  for (std::size_t k = 0; k < read.events.size(); ++k) {
    EXPECT_EQ(read.events[k].name, written.events[k].name);
    EXPECT_NEAR(read.events[k].time, written.events[k].time, kEventRounding);
    EXPECT_THAT(read.events[k].value, testing::NanSensitiveDoubleEq(written.events[k].value));
  }
}

TEST(EncodeC3d, GivesTheRecordingBackInSinglePrecision) {
  const Recording recording = example();
  expect_same(written_and_read(recording), recording);
  EXPECT_THAT(lost_in(recording, Format::c3d), ElementsAre());
}

TEST(EncodeC3d, OneAxisWithoutEventsAndMetadata) {
  Recording recording;
  recording.time = Vector::LinSpaced(50, 0.0, 49.0) / 333.3;
  recording.channels = {{"position", "rad", "", Vector::Random(50)}, {"reaction", "N.m", "", Vector::Random(50)}};
  expect_same(written_and_read(recording), recording);
}

TEST(EncodeC3d, MoreThan255ChannelsAndEvents) {
  Recording recording = example(3);
  recording.events.clear();
  for (int k = 0; k < 300; ++k) {
    recording.channels.push_back({fmt::format("emg_{}", k), "V", "", Vector::Random(3)});
    recording.events.push_back({12.5 + 0.25 * k, fmt::format("e{}", k), 1.0 * k});
  }
  expect_same(written_and_read(recording), recording);
}

TEST(EncodeC3d, MoreThan65535Frames) {
  const Recording recording = example(70000);
  expect_same(written_and_read(recording), recording);
}

TEST(EncodeC3d, WhatAnotherProgramChangedPrecedesWhatMbkAdded) {
  Recording recording = example();
  recording.events.clear();
  recording.time -= Vector::Constant(200, 12.5);
  std::string bytes = encode_c3d(recording).value();
  const auto replace = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = bytes.find(from); at != bytes.npos; at = bytes.find(from, at + 1)) {
      bytes.replace(at, from.size(), to);
    }
  };
  replace(std::string("\0\0\x7a\x44", 4), std::string("\0\0\xfa\x43", 4));  // 1000 Hz → 500 Hz
  const test::Folder folder;
  folder.write("a.c3d", bytes);
  const auto back = read(folder / "a.c3d", {});
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_NEAR(back->time[1] - back->time[0], 0.002, 1e-12);
}

TEST(EncodeC3d, ValuesThatAreNotNumbersAreNaNAndAreReported) {
  Recording recording = example();
  recording.channels[0].values[7] = kNaN;
  recording.channels[2].values[8] = std::numeric_limits<double>::infinity();
  expect_same(written_and_read(recording), recording);
  EXPECT_THAT(lost_in(recording, Format::c3d), ElementsAre(AllOf(HasSubstr("1 of 200"), HasSubstr("hand_x")),
                                                           AllOf(HasSubstr("1 of 200"), HasSubstr("force_x"))));
}

TEST(EncodeC3d, RefusesAClockWithoutARate) {
  const Recording even = example();
  Recording recording = even;
  recording.time[100] += 0.02e-3;
  EXPECT_THAT(refusal(recording), AllOf(HasSubstr("sample 101"), HasSubstr(".h5")));
  recording.time[100] -= 0.015e-3;
  EXPECT_THAT(lost_in(recording, Format::c3d), ElementsAre(AllOf(HasSubstr("times"), HasSubstr("5e-06 s"))));
  expect_same(written_and_read(recording), even);
  recording = example();
  recording.time[3] = kNaN;
  EXPECT_THAT(refusal(recording), HasSubstr("sample 4"));
  recording = example();
  recording.time.reverseInPlace();
  EXPECT_THAT(refusal(recording), HasSubstr("even clock"));
  recording.time.setConstant(1.0);
  EXPECT_THAT(refusal(recording), HasSubstr("even clock"));
  recording.untimed = true;
  EXPECT_THAT(refusal(recording), HasSubstr("no time"));
  EXPECT_THAT(refusal(example(1)), HasSubstr("one sample"));
}

TEST(EncodeC3d, RefusesNumbersAndNamesThatItCannotHold) {
  Recording recording = example();
  recording.channels[2].values[3] = -1e39;
  EXPECT_THAT(refusal(recording), AllOf(HasSubstr("force_x"), HasSubstr("-1e+39"), HasSubstr("sample 4")));
  recording = example();
  recording.channels.back().name = "emg_" + std::string(123, 'x');
  expect_same(written_and_read(recording), recording);
  recording.channels.back().name += 'x';
  EXPECT_THAT(refusal(recording), AllOf(HasSubstr("emg_x"), HasSubstr("127")));
  recording = example();
  recording.metadata[std::string(128, 'k')] = "1";
  EXPECT_THAT(refusal(recording), HasSubstr("kkk"));
  recording = example();
  recording.metadata["long"] = std::string(140000, 'x');
  EXPECT_THAT(refusal(recording), AllOf(HasSubstr("metadata"), HasSubstr("130560"), HasSubstr(".h5")));
}

TEST(EncodeC3d, ReportsEventsThatItCannotHold) {
  Recording recording = example();
  recording.events = {{12.5, "", 1.0}, {12.6, " a", 2.0}, {12.7, std::string(130, 'n'), 3.0}, {kNaN, "never", 4.0}};
  EXPECT_THAT(lost_in(recording, Format::c3d), ElementsAre(HasSubstr("1 event"), HasSubstr("3 event names")));
  const auto back = written_and_read(recording);
  ASSERT_EQ(back.events.size(), 3u);
  EXPECT_EQ(back.events[0].name, "event");
  EXPECT_EQ(back.events[1].name, "a");
  EXPECT_EQ(back.events[2].name, std::string(127, 'n'));
  EXPECT_EQ(back.events[2].value, 3.0);
}

TEST(EncodeC3d, IsOnlyAFormatToConvertTo) {
  EXPECT_EQ(format_of("a.c3d", "").value(), Format::c3d);
  EXPECT_EQ(format_of("a", "c3d").value(), Format::c3d);
  EXPECT_THAT(format_of("a.c3d").error().line(), AllOf(HasSubstr("single precision"), HasSubstr(".h5")));
}

}  // namespace encode_c3d_test
}  // namespace mbk::recording
