#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mbk/files/bids/encode_run.h"
#include "mbk/files/bids/read_run.h"
#include "mbk/files/bids/run_name.h"
#include "mbk/files/contents/test_files.h"

namespace mbk::recording {
namespace bids_test {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

Recording recording() {
  Recording one;
  one.time = (Vector(3) << 0.1, 0.2003, 0.3).finished();
  one.channels = {{"hand_x", "m", "base", (Vector(3) << 0.1 + 0.2, 1e-300, -0.0).finished()},
                  {"force_x", "N", "base", (Vector(3) << 1, 2, 3).finished()}};
  one.events = {{0.2, "go", 1.0}};
  one.metadata = {{"condition", "relaxed"}, {"age", "90"}, {"name", "Erika"}, {"participant", "Max"}};
  return one;
}

/// The files of a recording, by the ends of their names.
std::map<std::string, std::string> encoded(const Recording& one, const std::map<std::string, std::string>& there = {}) {
  const auto existing = [&](const std::string& path) -> std::optional<std::string> {
    const auto file = there.find(path);
    return file == there.end() ? std::nullopt : std::optional(file->second);
  };
  const auto files = encode_bids(one, parse_bids_name("sub-1_task-a").value(), existing);
  EXPECT_TRUE(files) << files.error().line();
  std::map<std::string, std::string> texts;
  for (const BidsFile& file : *files) texts[file.path.substr(file.path.rfind('_') + 1)] = file.text;
  return texts;
}

TEST(EncodeBids, NamesTheDataSetByItsTitleAndRoundsOnsets) {
  const auto none = [](const std::string&) -> std::optional<std::string> { return std::nullopt; };
  const auto files = encode_bids(recording(), parse_bids_name("sub-1_task-a").value(), none, "Arms at rest").value();
  const auto text = [&](std::string_view end) {
    return std::ranges::find_if(files, [&](const BidsFile& file) { return file.path.ends_with(end); })->text;
  };
  EXPECT_THAT(text("dataset_description.json"), HasSubstr("\"Name\": \"Arms at rest\""));
  EXPECT_THAT(text("_events.tsv"), HasSubstr("\n0.1\t"));
}

TEST(ParseBidsName, PutsEntitiesInOrder) {
  const BidsName name = parse_bids_name("run-01_task-reach_sub-07_ses-2").value();
  EXPECT_EQ(name.text(), "sub-07_ses-2_task-reach_tracksys-robot_run-01");
  EXPECT_EQ(name.session(), "sub-07_ses-2");
  EXPECT_EQ(name.session_folder(), "sub-07/ses-2");
  for (const char* wrong : {"", "sub-1", "task-a", "sub-1_task-", "sub-1_task-a_run-x", "sub-1_task-a_echo-1",
                            "sub-1_sub-2_task-a", "sub-../x_task-a"}) {
    EXPECT_FALSE(parse_bids_name(wrong)) << wrong;
  }
}

TEST(EncodeBids, GivesBackEveryBit) {
  const Recording one = recording();
  auto texts = encoded(one);
  const auto back = decode_bids({texts["motion.tsv"],
                                 texts["channels.tsv"],
                                 {texts["motion.json"]},
                                 texts["events.tsv"],
                                 texts["channels.json"],
                                 "1"});
  ASSERT_TRUE(back) << back.error().line();
  ASSERT_EQ(back->arrays.size(), 3U);
  EXPECT_EQ(back->arrays[0].means, "time");
  EXPECT_EQ(back->arrays[0].values, one.time);
  EXPECT_EQ(back->arrays[1].values, one.channels[0].values);
  EXPECT_TRUE(std::signbit(back->arrays[1].values(2, 0)));
  EXPECT_EQ(back->arrays[2].unit, "N");
  ASSERT_EQ(back->events.size(), 1U);
  EXPECT_EQ(back->events.front().time, 0.2);
  EXPECT_EQ(back->events.front().name, "go");
  EXPECT_EQ(back->metadata, (std::map<std::string, std::string>{{"condition", "relaxed"}, {"age", "89+"}}));
}

TEST(EncodeBids, KeepsTheNamesOfJoints) {
  Recording one = recording();
  for (Channel& channel : one.channels)
    channel = {"joint_" + std::to_string(&channel - one.channels.data() + 1), "rad", "joint", channel.values};
  one.channels[0].origin.joint = "elbow_joint";
  auto texts = encoded(one);
  const auto back = decode_bids({texts["motion.tsv"], texts["channels.tsv"], {texts["motion.json"]}, "", "", "1"});
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->arrays[1].joint, "elbow_joint");
  EXPECT_EQ(back->arrays[2].joint, "");
}

TEST(EncodeBids, LeavesOutTheTimeThatARateSays) {
  Recording one = recording();
  one.time = Vector::LinSpaced(3, 0.0, 2.0) / 30.0;
  one.time_from_rate = true;
  auto texts = encoded(one);
  EXPECT_THAT(texts["channels.tsv"], Not(HasSubstr("LATENCY")));
  const auto back = decode_bids({texts["motion.tsv"], texts["channels.tsv"], {texts["motion.json"]}, "", "", "1"});
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->arrays[0].rate_hz, 30.0);
}

TEST(EncodeBids, WithholdsWhoItWas) {
  const auto texts = encoded(recording());
  for (const auto& [name, text] : texts) {
    EXPECT_THAT(text, Not(testing::AnyOf(HasSubstr("Erika"), HasSubstr("Max"), HasSubstr("90")))) << name;
  }
  EXPECT_THAT(withheld_from_bids(recording()),
              ElementsAre(HasSubstr("89+"), HasSubstr("'name'"), HasSubstr("'participant'")));
  EXPECT_THAT(texts.at("participants.tsv").substr(0), Not(HasSubstr("90")));
}

TEST(EncodeBids, KeepsTheLinesOfTablesThatAreThere) {
  const auto texts = encoded(recording(), {{"participants.tsv", "participant_id\tgroup\nsub-0\tA"},
                                           {"sub-1/sub-1_scans.tsv", "filename\tacq_time\nmotion/x.tsv\tn/a\n"}});
  EXPECT_EQ(texts.at("participants.tsv"), "participant_id\tgroup\nsub-0\tA\nsub-1\tn/a\n");
  EXPECT_THAT(texts.at("scans.tsv"),
              HasSubstr("motion/x.tsv\tn/a\nmotion/sub-1_task-a_tracksys-robot_motion.tsv\tn/a\n"));
}

TEST(FindBidsRuns, OrdersNumbersByTheirValue) {
  const test::Folder folder;
  const auto motion = folder / "sub-1/motion";
  std::filesystem::create_directories(motion);
  std::filesystem::create_directories(folder / "derivatives/sub-1");
  for (const char* run : {"10", "2", "1"}) {
    std::ofstream(motion / (std::string("sub-1_task-a_tracksys-x_run-") + run + "_motion.tsv")) << "1\n";
  }
  std::ofstream(folder / "derivatives/sub-1/sub-1_task-a_motion.tsv") << "1\n";
  const auto runs = find_bids_runs(folder / "");
  ASSERT_TRUE(runs) << runs.error().line();
  std::vector<std::string> names;
  for (const BidsRun& run : *runs) names.push_back(run.name.name);
  EXPECT_THAT(names, ElementsAre("sub-1_task-a_run-1", "sub-1_task-a_run-2", "sub-1_task-a_run-10"));
}

TEST(DecodeBids, RefusesColumnsThatNobodyDescribes) {
  const auto error = [](std::string_view motion, std::string_view channels, std::string json) {
    const auto contents = decode_bids({motion, channels, {std::move(json)}, "", "", "1"});
    return contents ? std::string("none") : contents.error().line();
  };
  const std::string channels = "name\ttype\tunits\nx\tPOS\tm\n", json = R"({"SamplingFrequency": 10})";
  EXPECT_EQ(error("1\n", channels, json), "none");
  EXPECT_THAT(error("1\t2\n", channels, json), AllOf(HasSubstr("2 columns"), HasSubstr("channels.tsv")));
  EXPECT_THAT(error("one\n", channels, json), HasSubstr("'one'"));
  EXPECT_THAT(error("", channels, json), HasSubstr("no samples"));
  EXPECT_THAT(error("1\n", "name\ttype\n", json), HasSubstr("'units'"));
  EXPECT_THAT(error("1\n", channels, "{"), HasSubstr("JSON"));
  EXPECT_THAT(error("1\n", channels, R"({"SamplingFrequency": "n/a"})"), HasSubstr("SamplingFrequency"));
}

}  // namespace bids_test
}  // namespace mbk::recording
