#include "mbk/files/recording/write.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>
#include <sys/resource.h>

#include <array>
#include <cmath>
#include <csignal>
#include <limits>
#include <random>

#include "mbk/files/contents/test_files.h"
#include "mbk/files/recording/channel_table.h"
#include "mbk/files/recording/read.h"

namespace mbk::recording {
namespace write_test {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

struct Kind {
  Format format;
  const char* file;
};
constexpr std::array<Kind, 4> kKinds{
    {{Format::mat5, "a.mat"}, {Format::mat73, "a73.mat"}, {Format::hdf5, "a.h5"}, {Format::csv, "a.csv"}}};

/// Recordings of every kind that the channel table knows, with everything that their values may be.
class RandomRecording {
 public:
  explicit RandomRecording(unsigned seed) : random_(seed) {}

  Recording make() {
    Recording recording;
    const Index samples = 2 + upto(60);
    recording.time = Vector(samples);
    double time = number() * 1e-300;
    for (double& t : recording.time) t = time += 1e-3 + 1e-6 * upto(1000);
    const int axes = 1 + upto(1);
    while (recording.channels.empty()) {
      for (const ChannelKind& kind : channel_kinds()) {
        if (kind.axes == axes && upto(2) > 0) recording.channels.push_back(channel(kind, samples));
      }
    }
    for (int i = upto(5); i > 0; --i) recording.metadata[fmt::format("key_{}", upto(1000))] = text();
    for (int i = upto(5); i > 0; --i) recording.events.push_back({number(), text(), number()});
    return recording;
  }

 private:
  int upto(int most) { return static_cast<int>(random_() % static_cast<unsigned>(most + 1)); }

  /// Any double there is; NaN and infinities more often than they come by themselves.
  double number() {
    const int kind = upto(12);
    if (kind == 0) return std::numeric_limits<double>::quiet_NaN();
    if (kind == 1) return -std::numeric_limits<double>::infinity();
    if (kind == 2) return -0.0;
    if (kind == 3) return std::ldexp(1.0, -1074 + upto(60));
    const auto any = std::bit_cast<double>(std::uint64_t{random_()} << 32u | random_());
    return std::isfinite(any) ? any : 0.1;
  }

  Channel channel(const ChannelKind& kind, Index samples) {
    Channel channel{std::string(kind.name), std::string(kind.default_unit()), std::string(kind.frame), Vector(samples)};
    if (kind.measures.size() > 1 && upto(4) > 0) {
      channel.unit = si_unit(kind.measures[random_() % kind.measures.size()]);
    }
    const bool absent = upto(6) == 0;
    for (double& value : channel.values) value = absent ? std::nan("") : number();
    return channel;
  }

  std::string text() {
    static const std::array<const char*, 10> parts{"a", " ", "é", "😀", ": ", "#", ",", "\"", "7", ";"};
    std::string made;
    for (int i = upto(9); i > 0; --i) made += parts[random_() % parts.size()];
    return made;
  }

  std::mt19937 random_;
};

void expect_same(const Vector& a, const Vector& b, const std::string& place) {
  ASSERT_EQ(a.size(), b.size()) << place;
  for (Index k = 0; k < a.size(); ++k) {
    const bool same =
        std::isnan(b[k]) ? std::isnan(a[k]) : std::bit_cast<std::uint64_t>(a[k]) == std::bit_cast<std::uint64_t>(b[k]);
    ASSERT_TRUE(same) << place << " " << k << ": " << a[k] << " for " << b[k];
  }
}

void expect_same(const Recording& read, const Recording& written) {
  expect_same(read.time, written.time, "time");
  ASSERT_EQ(read.channels.size(), written.channels.size());
  for (const Channel& channel : written.channels) {
    const Channel* found = read.find(channel.name);
    ASSERT_NE(found, nullptr) << channel.name;
    EXPECT_EQ(found->unit, channel.unit) << channel.name;
    EXPECT_EQ(found->frame, channel.frame) << channel.name;
    expect_same(found->values, channel.values, channel.name);
  }
  EXPECT_EQ(read.metadata, written.metadata);
  ASSERT_EQ(read.events.size(), written.events.size());
  for (std::size_t k = 0; k < read.events.size(); ++k) {
    EXPECT_EQ(read.events[k].name, written.events[k].name);
    EXPECT_THAT(read.events[k].time, testing::NanSensitiveDoubleEq(written.events[k].time));
    EXPECT_THAT(read.events[k].value, testing::NanSensitiveDoubleEq(written.events[k].value));
  }
}

/// Two axes, metadata and events.
Recording example() {
  Recording recording;
  recording.time = Vector::LinSpaced(200, 0.0, 0.199);
  for (const auto& [name, unit] : {std::pair("hand_x", "m"), std::pair("hand_y", "m"), std::pair("force_x", "N"),
                                   std::pair("force_y", "N"), std::pair("reference_x", "N")}) {
    recording.channels.push_back({name, unit, "base", Vector::Random(200)});
  }
  recording.metadata = {{"participant", "7"}, {"note", "Ánna 😀"}};
  recording.events = {{0.05, "onset", 3.0}, {0.1, "", std::nan("")}};
  return recording;
}

TEST(Write, EveryFormatAfterEveryOtherGivesTheRecordingBack) {
  const test::Folder folder;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Recording original = RandomRecording(seed).make();
    for (const Kind& first : kKinds) {
      const auto one = folder / (std::string("1") + first.file);
      const auto ok = write(original, one, first.format, true);
      ASSERT_TRUE(ok) << ok.error().line();
      EXPECT_THAT(lost_in(original, first.format), ElementsAre());
      const auto between = read(one, {});
      ASSERT_TRUE(between) << between.error().line();
      for (const Kind& second : kKinds) {
        SCOPED_TRACE(fmt::format("seed {}, {} → {}", seed, first.file, second.file));
        const auto other = folder / (std::string("2") + second.file);
        ASSERT_TRUE(write(*between, other, second.format, true));
        const auto last = read(other, {});
        ASSERT_TRUE(last) << last.error().line();
        expect_same(*last, original);
        if (HasFailure()) return;
      }
    }
  }
}

TEST(Write, OneSampleIsARecording) {
  const test::Folder folder;
  Recording one;
  one.time = Vector::Constant(1, 0.25);
  one.channels = {{"hand_x", "m", "base", Vector::Constant(1, 0.1)}, {"force_x", "N", "base", Vector::Constant(1, -2)}};
  for (const Kind& kind : kKinds) {
    SCOPED_TRACE(kind.file);
    ASSERT_TRUE(write(one, folder / kind.file, kind.format, false));
    const auto back = read(folder / kind.file, {});
    ASSERT_TRUE(back) << back.error().line();
    expect_same(*back, one);
  }
}

TEST(Write, ThreeAxesComeBackWithoutAnOption) {
  const test::Folder folder;
  Recording three = example();
  for (const auto& [name, unit] : {std::pair("hand_z", "m"), {"force_z", "N"}, {"reference_z", "N"}}) {
    three.channels.push_back({name, unit, "base", Vector::Random(200)});
  }
  for (const Kind& kind : kKinds) {
    SCOPED_TRACE(kind.file);
    ASSERT_TRUE(write(three, folder / kind.file, kind.format, false));
    const auto back = read(folder / kind.file, {});
    ASSERT_TRUE(back) << back.error().line();
    expect_same(*back, three);
  }
}

TEST(Write, EqualRecordingsGiveEqualBytes) {
  const test::Folder folder;
  const Recording recording = example();
  Recording other = recording;  // as other files have their channels
  std::ranges::reverse(other.channels);
  for (const Kind& kind : kKinds) {
    ASSERT_TRUE(write(recording, folder / kind.file, kind.format, false));
    ASSERT_TRUE(write(other, folder / (std::string("again_") + kind.file), kind.format, false));
    EXPECT_EQ(test::bytes_of(folder / kind.file), test::bytes_of(folder / (std::string("again_") + kind.file)));
  }
}

TEST(Write, LeavesNothingBehindOnAFullDisk) {
  const test::Folder folder;
  const Recording recording = example();
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const struct rlimit small { 1000, before.rlim_max };
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  std::vector<Result<void>> refused;
  for (const Kind& kind : kKinds) refused.push_back(write(recording, folder / kind.file, kind.format, false));
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  for (const auto& one : refused) {
    ASSERT_FALSE(one);
    EXPECT_EQ(one.error().kind, ErrorKind::data);
    EXPECT_THAT(one.error().line(), HasSubstr("disk"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder / ""));
}

TEST(Write, LeavesNothingBehindWhereTheFolderCannotBeWritten) {
  const test::Folder folder;
  for (const Kind& kind : kKinds) {
    EXPECT_FALSE(write(example(), folder / "none" / kind.file, kind.format, false));
    folder.write(kind.file, "precious");
    EXPECT_FALSE(write(example(), folder / kind.file, kind.format, false));
    EXPECT_EQ(test::bytes_of(folder / kind.file), "precious");
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / ""), {}), std::ssize(kKinds));
}

TEST(Write, RefusesWhatIsNoRecording) {
  const test::Folder folder;
  const auto said = [&](const Recording& recording) {
    std::vector<std::string> messages;
    for (const Kind& kind : kKinds) {
      const auto ok = write(recording, folder / kind.file, kind.format, false);
      messages.push_back(ok ? std::string() : ok.error().message);
    }
    return messages;
  };
  EXPECT_THAT(said({}), Each(HasSubstr("sample")));
  Recording recording = example();
  recording.channels.clear();
  EXPECT_THAT(said(recording), Each(HasSubstr("channel")));
  recording = example();
  recording.channels.push_back(recording.channels.front());
  EXPECT_THAT(said(recording), Each(HasSubstr("'hand_x'")));
  recording = example();
  recording.channels[1].values.resize(7);
  EXPECT_THAT(said(recording), Each(AllOf(HasSubstr("'hand_y'"), HasSubstr("7 samples"))));
  recording = example();
  recording.metadata["note"] = "two\nlines";
  EXPECT_THAT(said(recording), Each(AllOf(HasSubstr("'note'"), HasSubstr("UTF-8"))));
  recording = example();
  recording.events.front().name = "\xff";
  EXPECT_THAT(said(recording), Each(AllOf(HasSubstr("event"), HasSubstr("UTF-8"))));
  EXPECT_TRUE(std::filesystem::is_empty(folder / ""));
}

TEST(Write, RefusesKeysThatAFormatCannotHold) {
  const test::Folder folder;
  const auto said = [&](const Kind& kind, const std::string& key) {
    Recording recording = example();
    recording.metadata[key] = "x";
    const auto ok = write(recording, folder / kind.file, kind.format, true);
    return ok ? "" : ok.error().line();
  };
  const auto [mat, mat73, hdf5, csv] = kKinds;
  EXPECT_THAT(said(mat, "a b"), AllOf(HasSubstr("'a b'"), HasSubstr("MATLAB")));
  EXPECT_THAT(said(mat73, "a b"), AllOf(HasSubstr("'a b'"), HasSubstr("MATLAB")));
  EXPECT_EQ(said(hdf5, "a b/ü"), "");
  EXPECT_THAT(said(hdf5, ""), HasSubstr("attribute"));
  EXPECT_THAT(said(hdf5, "format"), HasSubstr("'format'"));
  EXPECT_THAT(said(csv, "a b"), AllOf(HasSubstr("'a b'"), HasSubstr("comment")));
  EXPECT_THAT(said(csv, "a:b"), AllOf(HasSubstr("'a:b'"), HasSubstr("colon")));
  EXPECT_EQ(said(csv, "größe"), "");
}

TEST(Write, SaysWhichFramesAreLost) {
  Recording recording = example();
  recording.channels[2].frame = "tool";
  EXPECT_THAT(lost_in(recording, Format::hdf5), ElementsAre());
  for (const Format format : {Format::mat5, Format::mat73, Format::csv}) {
    EXPECT_THAT(lost_in(recording, format), ElementsAre(AllOf(HasSubstr("force_x"), HasSubstr("'tool'"))));
  }
}

TEST(WriteMat, KeepsAChannelThatIsNoNumberThroughout) {
  const test::Folder folder;
  Recording recording = example();
  recording.channels[1].values.setConstant(std::nan(""));
  for (const Kind& kind : {kKinds[0], kKinds[1]}) {
    ASSERT_TRUE(write(recording, folder / kind.file, kind.format, false));
    const auto back = read(folder / kind.file, {});
    ASSERT_TRUE(back) << back.error().line();
    expect_same(*back, recording);
  }
}

TEST(WriteMat, RefusesMoreThanAV5FileHolds) {
  const test::Folder folder;
  Recording recording;
  recording.time = Vector::Zero((Index{1} << 31) / (19 * 8) + 1);
  recording.channels = {{"hand_x", "m", "base", recording.time}};
  const auto refused = write(recording, folder / "a.mat", Format::mat5, false);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().line(), AllOf(HasSubstr("14128182 samples"), HasSubstr("MAT v5"), HasSubstr("MAT v7.3")));
}

using MatVariable = std::unique_ptr<matvar_t, void (*)(matvar_t*)>;

std::string text_of(const matvar_t* variable) {
  if (variable == nullptr) return "(none)";
  const auto* units = static_cast<const std::uint16_t*>(variable->data);
  std::string text;
  for (std::size_t i = 0; i < variable->nbytes / 2; ++i) text += static_cast<char>(units[i]);
  return text;
}

TEST(WriteMat, BothVersionsAreReadByMatio) {
  const test::Folder folder;
  Recording recording = example();
  recording.metadata["note"] = "plain";
  recording.events[1].name = "offset";
  for (const Kind& kind : {kKinds[0], kKinds[1]}) {
    SCOPED_TRACE(kind.file);
    ASSERT_TRUE(write(recording, folder / kind.file, kind.format, false));
    const std::unique_ptr<mat_t, int (*)(mat_t*)> mat(Mat_Open((folder / kind.file).c_str(), MAT_ACC_RDONLY),
                                                      Mat_Close);
    ASSERT_NE(mat, nullptr);
    EXPECT_EQ(Mat_GetVersion(mat.get()), kind.format == Format::mat5 ? MAT_FT_MAT5 : MAT_FT_MAT73);
    const MatVariable logs(Mat_VarRead(mat.get(), "logs"), Mat_VarFree);
    ASSERT_NE(logs, nullptr);
    EXPECT_EQ(logs->class_type, MAT_C_DOUBLE);
    ASSERT_EQ(logs->dims[0], 19u);
    ASSERT_EQ(logs->dims[1], 200u);
    const Eigen::Map<const Matrix> values(static_cast<const double*>(logs->data), 19, 200);
    EXPECT_EQ(values.row(9).transpose(), recording.find("force_x")->values);
    EXPECT_TRUE(values.row(3).array().isNaN().all());
    const MatVariable metadata(Mat_VarRead(mat.get(), "metadata"), Mat_VarFree);
    ASSERT_NE(metadata, nullptr);
    EXPECT_EQ(metadata->class_type, MAT_C_STRUCT);
    EXPECT_EQ(text_of(Mat_VarGetStructFieldByName(metadata.get(), "participant", 0)), "7");
    EXPECT_EQ(text_of(Mat_VarGetStructFieldByName(metadata.get(), "note", 0)), "plain");
    const MatVariable events(Mat_VarRead(mat.get(), "events"), Mat_VarFree);
    ASSERT_NE(events, nullptr);
    matvar_t* const names = Mat_VarGetStructFieldByName(events.get(), "name", 0);
    ASSERT_NE(names, nullptr);
    EXPECT_EQ(names->class_type, MAT_C_CELL);
    EXPECT_EQ(text_of(Mat_VarGetCell(names, 0)), "onset");
    EXPECT_EQ(text_of(Mat_VarGetCell(names, 1)), "offset");
    const matvar_t* times = Mat_VarGetStructFieldByName(events.get(), "time", 0);
    ASSERT_NE(times, nullptr);
    EXPECT_EQ(static_cast<const double*>(times->data)[1], 0.1);
  }
}

TEST(WriteCsv, NamesColumnsWithTheirUnits) {
  const test::Folder folder;
  Recording recording = example();
  recording.time = Vector{{0.0, 0.001}};
  recording.channels = {{"hand_x", "m", "base", Vector{{0.1, std::nan("")}}},
                        {"torque_1", "N.m", "joint", Vector{{1e-30, -std::numeric_limits<double>::infinity()}}},
                        {"reference_x", "", "base", Vector{{1.0 / 3.0, 1e22}}}};
  ASSERT_TRUE(write(recording, folder / "a.csv", Format::csv, false));
  const std::string text = test::bytes_of(folder / "a.csv");
  EXPECT_EQ(text.substr(text.find('\n') + 1),
            "# note: Ánna 😀\n# participant: 7\n# event 0.05 3 onset\n# event 0.1 NaN \n"
            "time_s,hand_x_m,reference_x,torque_1_N.m\n"
            "0,0.1,0.3333333333333333,1e-30\n0.001,NaN,1e+22,-Inf\n");
}

TEST(WriteCsv, CommentsOfOtherFilesSayNothing) {
  const test::Folder folder;
  const auto file = folder.write("a.csv", "# participant: 7\n# event 0.1 2 onset\ntime_s,hand_x_m\n0,1\n0.1,2\n");
  const auto recording = read(file, {});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_TRUE(recording->metadata.empty());
  EXPECT_TRUE(recording->events.empty());
}

TEST(WriteCsv, CommentsThatWereChangedAreOnlyComments) {
  const test::Folder folder;
  const auto file =
      folder.write("a.csv",
                   "# mbk.recording/1\r\n# lost\r\n# participant: 7\r\n# event\n# event x 3 a\n# event 1\n"
                   "# event 0.5 2\r\n#\ntime_s,hand_x_m\r\n0,1\r\n0.1,2\r\n# late: comment\r\n");
  const auto recording = read(file, {});
  ASSERT_TRUE(recording) << recording.error().line();
  EXPECT_EQ(recording->metadata, (std::map<std::string, std::string>{{"participant", "7"}}));
  ASSERT_EQ(recording->events.size(), 1u);
  EXPECT_EQ(recording->events[0].time, 0.5);
  EXPECT_EQ(recording->events[0].value, 2.0);
  EXPECT_EQ(recording->events[0].name, "");
}

TEST(FormatOf, GoesByTheNameThatIsGivenThenByTheEndOfTheFile) {
  EXPECT_EQ(format_of("a.mat"), Format::mat5);
  EXPECT_EQ(format_of("a.h5"), Format::hdf5);
  EXPECT_EQ(format_of("a.hdf5"), Format::hdf5);
  EXPECT_EQ(format_of("x.y/a.csv"), Format::csv);
  EXPECT_EQ(format_of("a.mat", "mat73"), Format::mat73);
  EXPECT_EQ(format_of("a", "csv"), Format::csv);
  EXPECT_EQ(format_of("a.dat", "mat"), Format::mat5);
}

TEST(FormatOf, RefusesAFormatThatTheExtensionContradicts) {
  for (const auto& [file, name] : {std::pair("a.csv", "mat"), {"a.mat", "csv"}, {"a.h5", "mat73"}}) {
    const auto format = format_of(file, name);
    ASSERT_FALSE(format) << file;
    EXPECT_EQ(format.error().kind, ErrorKind::usage);
    EXPECT_THAT(format.error().line(), HasSubstr("extension"));
  }
}

TEST(FormatOf, RefusesWhatItDoesNotKnow) {
  const auto said = [](const char* file, const char* name) {
    const auto format = format_of(file, name);
    EXPECT_TRUE(!format && format.error().kind == ErrorKind::usage);
    return format ? "" : format.error().line();
  };
  EXPECT_THAT(said("a.xls", ""), AllOf(HasSubstr("'.xls'"), HasSubstr(".h5"), HasSubstr(".mat"), HasSubstr(".csv")));
  EXPECT_THAT(said("a", ""), AllOf(HasSubstr(".h5"), HasSubstr(".mat"), HasSubstr(".csv")));
  EXPECT_THAT(said("a.mat", "mat4"),
              AllOf(HasSubstr("'mat4'"), HasSubstr("mat5"), HasSubstr("mat73"), HasSubstr("hdf5"), HasSubstr("csv")));
}

}  // namespace write_test
}  // namespace mbk::recording
