#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "mbk/batch/engine.h"
#include "mbk/batch/merge.h"
#include "mbk/batch/work.h"

/// Jobs for tests, in a folder that goes with the test.
namespace mbk::batch {

class JobTest : public testing::Test {
 protected:
  ~JobTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  /// A job of units "key 0" … in chunks of so many.
  JobFolder job(int units, int of_chunk, const std::string& name = "job") const {
    std::vector<std::string> keys;
    for (int k = 0; k < units; ++k) keys.push_back(fmt::format("key {}", k));
    const std::vector<double> costs(keys.size(), 1.0);
    Job job;
    job.kind = "test";
    job.specification = "{}";
    job.title = "a test";
    auto made = JobFolder::create(folder_ / name, std::move(job), keys, cut_into_chunks(costs, of_chunk, units), costs);
    EXPECT_TRUE(made) << made.error().line();
    return *made;
  }

  static Result<std::string> answer(std::int64_t number, const std::string& key) {
    return fmt::format("{} of {}", number * number, key);
  }

  /// Everything that the shards hold, one unit a line.
  static std::string merged(const JobFolder& folder, MergeReport* report = nullptr) {
    std::string text;
    const auto found = merge(folder, [&](MergedUnit unit) -> Result<void> {
      text += fmt::format("{} {} {} {}\n", unit.number, unit.key, unit.failed ? "failed" : "gave", unit.payload);
      return {};
    });
    EXPECT_TRUE(found) << found.error().line();
    if (found && report != nullptr) *report = *found;
    return text;
  }

  static std::vector<std::filesystem::path> shards_of(const JobFolder& folder, ShardFile::State state) {
    std::vector<std::filesystem::path> files;
    const auto listed = list_shards(folder);
    EXPECT_TRUE(listed);
    for (const ShardFile& file : *listed) {
      if (file.state == state) files.push_back(file.path);
    }
    return files;
  }

  static std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  static void write(const std::filesystem::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() /
      fmt::format("mbk-{}-{}", testing::UnitTest::GetInstance()->current_test_info()->name(), ::getpid());

  void SetUp() override { std::filesystem::create_directories(folder_); }
};

}  // namespace mbk::batch
