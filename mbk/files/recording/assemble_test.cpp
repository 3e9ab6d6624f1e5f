#include "mbk/files/recording/assemble.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mbk::recording {
namespace {

using testing::HasSubstr;

TEST(Assemble, SaysThatANamedLogsMatrixHoldsNoSample) {
  for (const auto& [rows, columns] : {std::pair<Index, Index>{19, 0}, {0, 19}, {0, 0}}) {
    Contents contents;
    contents.format = "MAT v5";
    contents.arrays.push_back({"logs", Matrix(rows, columns)});
    ReadOptions options;
    options.variable = "logs";
    const auto recording = assemble(contents, options);
    ASSERT_FALSE(recording);
    EXPECT_THAT(recording.error().line(), AllOf(HasSubstr("'logs'"), HasSubstr("sample")));
  }
}

}  // namespace
}  // namespace mbk::recording
