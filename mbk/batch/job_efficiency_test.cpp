#include "mbk/batch/job_efficiency.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mbk/batch/job_events.h"
#include "mbk/batch/run.h"
#include "mbk/batch/test_jobs.h"

namespace mbk::batch {
namespace job_efficiency_test {

class Efficiency : public JobTest {
 protected:
  static void note(const JobFolder& folder, const std::string& lines) {
    write(folder.folder() / "events.jsonl", lines);
  }
};

TEST_F(Efficiency, OfAJobThatNobodyLookedAfterIsThatOfItsShards) {
  const JobFolder folder = job(6, 2);
  ASSERT_TRUE(work(folder, 1, answer));
  const auto found = job_efficiency(folder);
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_EQ(found->engine, "");
  EXPECT_EQ(found->finished_chunks, 1);
  EXPECT_EQ(found->finished_units, 2);
  EXPECT_EQ(found->elapsed_s, 0.0);
  EXPECT_EQ(found->units_per_s(), 0.0);
}

TEST_F(Efficiency, TimeIsWorkingOrWaiting) {
  const JobFolder folder = job(4, 2);
  ASSERT_TRUE(work(folder, 0, answer));
  ASSERT_TRUE(work(folder, 1, answer));
  note(folder,
       "{\"at_s\":0,\"is\":\"taken up\",\"why\":\"slurm\"}\n"
       "{\"at_s\":1,\"is\":\"handed out\",\"chunk\":0}\n{\"at_s\":1,\"is\":\"handed out\",\"chunk\":1}\n"
       "{\"at_s\":3,\"is\":\"begun\",\"chunk\":0}\n{\"at_s\":4,\"is\":\"begun\",\"chunk\":1}\n"
       "{\"at_s\":6,\"is\":\"lost\",\"chunk\":1,\"why\":\"killed by signal 9\"}\n"
       "{\"at_s\":7,\"is\":\"handed out\",\"chunk\":1}\n"
       "{\"at_s\":8,\"is\":\"finished\",\"chunk\":0}\n"
       "{\"at_s\":9,\"is\":\"begun\",\"chunk\":1}\n{\"at_s\":12,\"is\":\"finished\",\"chunk\":1}\n"
       "{\"at_s\":12.5,\"is\":\"left\"}\n{\"at_s\":12.5,\"is\":\"merged\",\"took_s\":0.25}\n");
  const auto found = job_efficiency(folder);
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_EQ(found->engine, "slurm");
  EXPECT_DOUBLE_EQ(found->elapsed_s, 12.5);
  EXPECT_DOUBLE_EQ(found->working_s, 8.0) << "3 to 8 s and 9 to 12 s";
  EXPECT_DOUBLE_EQ(found->waiting_s, 4.5);
  EXPECT_DOUBLE_EQ(found->lost_s, 2.0);
  EXPECT_DOUBLE_EQ(found->merge_s, 0.25);
  EXPECT_EQ(found->most_at_a_time, 2);
  EXPECT_EQ(found->losses.at("killed by signal 9"), 1);
  ASSERT_EQ(found->tasks.size(), 2U);
  EXPECT_DOUBLE_EQ(found->tasks[0].waited_s, 2.0);
  EXPECT_EQ(found->tasks[0].attempts, 1);
  EXPECT_DOUBLE_EQ(found->tasks[1].waited_s, 2.0);
  EXPECT_EQ(found->tasks[1].attempts, 2);
  EXPECT_DOUBLE_EQ(found->units_per_s(), 4.0 / 12.5);
}

TEST_F(Efficiency, WhatASecondProcessSeesAgainCountsOnce) {
  const JobFolder folder = job(2, 1);
  ASSERT_TRUE(work(folder, 0, answer));
  ASSERT_TRUE(work(folder, 1, answer));
  note(folder,
       "{\"at_s\":0,\"is\":\"taken up\",\"why\":\"local\"}\n{\"at_s\":0,\"is\":\"handed out\",\"chunk\":0}\n"
       "{\"at_s\":0,\"is\":\"begun\",\"chunk\":0}\n{\"at_s\":2,\"is\":\"finished\",\"chunk\":0}\n"
       "{\"at_s\":2.5,\"is\":\"hand\n"
       "{\"at_s\":2.5,\"is\":\"taken up\",\"why\":\"slurm\"}\n{\"at_s\":2.5,\"is\":\"finished\",\"chunk\":0}\n"
       "{\"at_s\":2.5,\"is\":\"handed out\",\"chunk\":1}\n{\"at_s\":3,\"is\":\"begun\",\"chunk\":1}\n"
       "{\"at_s\":4,\"is\":\"finished\",\"chunk\":1}\n{\"at_s\":4,\"is\":\"left\"}\n");
  const auto found = job_efficiency(folder);
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_DOUBLE_EQ(found->elapsed_s, 4.0);
  EXPECT_DOUBLE_EQ(found->working_s, 3.0);
  EXPECT_EQ(found->engine, "slurm");
  EXPECT_EQ(found->tasks[0].attempts, 1);
}

TEST_F(Efficiency, SaysWhyUnitsGaveNothing) {
  const JobFolder folder = job(5, 5);
  ASSERT_TRUE(work(folder, 0, [](std::int64_t number, const std::string&) -> Result<std::string> {
    if (number % 2 == 0) return bad_data("no force");
    return "fine";
  }));
  const auto found = job_efficiency(folder);
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_EQ(found->failed_units, 3);
  EXPECT_EQ(found->failures.at("no force"), 3);
  const auto json = nlohmann::json::parse(to_json(*found));
  EXPECT_EQ(json.at("failures").at("no force"), 3);
  EXPECT_EQ(json.at("hosts").size(), 1U);
  EXPECT_NE(to_text(*found).find("failed: 3 × no force"), std::string::npos);
}

}  // namespace job_efficiency_test
}  // namespace mbk::batch
