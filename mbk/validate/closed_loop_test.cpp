#include <gtest/gtest.h>

#include "mbk/validate/study.h"

namespace mbk::validation {
namespace {

const ValidationRow* find(const ValidationTable& table, std::string_view what) {
  for (const ValidationRow& row : table.rows) {
    if (row.what.find(what) != std::string::npos) return &row;
  }
  return nullptr;
}

TEST(ClosedLoopStudy, FindsThatLeastSquaresCallsAPassiveArmActiveAndInstrumentsAndEnergyDoNot) {
  const auto table = closed_loop_study({.runs = 2, .seed = 1});
  ASSERT_TRUE(table) << table.error().line();
  for (const char* what : {"ls active, theorem 3.2", "iv passive, M_s", "energy passive", "no model explains half",
                           "energy active", "the model predicts nothing"}) {
    const ValidationRow* row = find(*table, what);
    ASSERT_NE(row, nullptr) << what;
    EXPECT_EQ(row->value, 100.0) << what;  // of two runs; twenty and more by command
  }
  const ValidationRow* const inertia = find(*table, "ls: smallest eigenvalue of M");
  ASSERT_NE(inertia, nullptr);
  EXPECT_LT(inertia->value, -100.0);  // its sign is wrong
  const ValidationRow* const active = find(*table, "6 N multisine: prediction active");
  ASSERT_NE(active, nullptr);
  EXPECT_EQ(active->value, 0.0);
}

TEST(ClosedLoopStudy, IsTheSameOnAnyNumberOfThreads) {
  const auto one = closed_loop_study({.runs = 1, .seed = 5, .threads = 1});
  const auto two = closed_loop_study({.runs = 1, .seed = 5, .threads = 2});
  ASSERT_TRUE(one && two);
  for (std::size_t k = 0; k < one->rows.size(); ++k) EXPECT_EQ(one->rows[k].value, two->rows[k].value);
}

TEST(ClosedLoopStudy, RefusesNoRuns) {
  EXPECT_FALSE(closed_loop_study({.runs = 0}));
}

}  // namespace
}  // namespace mbk::validation
