#include "mbk/files/recording/trial_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mbk::recording {
namespace trial_files_test {

using testing::ElementsAre;
using testing::HasSubstr;

Result<std::vector<std::filesystem::path>> files(const char* pattern, std::vector<std::string> trials) {
  return files_of_trials(pattern, trials);
}

TEST(FilesOfTrials, PutsTheNameOfEachTrialIntoTheFiles) {
  EXPECT_THAT(files("out/exam_{trial}.h5", {"1", "2", "10"}).value(),
              ElementsAre("out/exam_1.h5", "out/exam_2.h5", "out/exam_10.h5"));
  EXPECT_THAT(files("{trial}.csv", {"sub-07_task-reach_run-1"}).value(), ElementsAre("sub-07_task-reach_run-1.csv"));
  EXPECT_THAT(files("one.h5", {"3"}).value(), ElementsAre("one.h5"));
  EXPECT_THAT(files("one.h5", {""}).value(), ElementsAre("one.h5"));
}

TEST(FilesOfTrials, LeavesTheFolderByNoName) {
  EXPECT_THAT(files("out/{trial}", {"../../etc/x", "a b\n", ".."}).value(),
              ElementsAre("out/.._.._etc_x", "out/a_b?", "out/_"));
  EXPECT_FALSE(files("{trial}/out.h5", {"1", "2"}));  // no folders are made
}

TEST(FilesOfTrials, RefusesToWriteTrialsOverEachOther) {
  const auto many = files("out/all.h5", {"1", "2", "3"});
  ASSERT_FALSE(many);
  EXPECT_EQ(many.error().kind, ErrorKind::usage);
  EXPECT_THAT(many.error().line(), AllOf(HasSubstr("3 trials"), HasSubstr("out/all_{trial}.h5"), HasSubstr("--trial")));
  EXPECT_THAT(files("{trial}.h5", {"a b", "a_b"}).error().message, HasSubstr("a_b.h5"));
  EXPECT_THAT(files("{trial}.h5", {""}).error().line(), HasSubstr("{trial}"));
}

}  // namespace trial_files_test
}  // namespace mbk::recording
