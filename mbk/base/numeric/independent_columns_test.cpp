#include "mbk/base/numeric/independent_columns.h"

#include <gtest/gtest.h>

namespace mbk::numeric {
namespace {

TEST(IndependentColumns, GivesWhatTheOthersAreMadeOf) {
  Matrix Z = Matrix::Random(50, 5);
  Z.col(2) = 2.0 * Z.col(0) - 3.0 * Z.col(1);
  Z.col(4).setZero();
  const IndependentColumns found = independent_columns(Z, 1e-9);
  EXPECT_EQ(found.kept, (std::vector<Index>{0, 1, 3}));
  EXPECT_LT((Z(Eigen::all, found.kept) * found.combination - Z).norm(), 1e-12);
  EXPECT_NEAR(found.combination(0, 2), 2.0, 1e-12);
  EXPECT_NEAR(found.combination(1, 2), -3.0, 1e-12);
}

TEST(IndependentColumns, DoesNotDependOnTheScaleOfAColumn) {
  Matrix Z = Matrix::Random(40, 4);
  Z.col(3) = Z.col(0) + Z.col(2);
  Z.col(1) *= 1e-9;
  Z.col(0) *= 1e7;
  EXPECT_EQ(independent_columns(Z, 1e-6).kept, (std::vector<Index>{0, 1, 2}));
}

TEST(IndependentColumns, KeepsTheFirstOfTwins) {
  Matrix Z = Matrix::Random(10, 1).replicate(1, 3);
  EXPECT_EQ(independent_columns(Z, 1e-9).kept, std::vector<Index>{0});
  EXPECT_TRUE(independent_columns(Matrix::Zero(3, 2), 1e-9).kept.empty());
}

TEST(IndependentColumns, DoesNotKeepWhatRoundingLeavesOfZeros) {
  Matrix Z = Matrix::Random(40, 3);
  Z.col(1) *= 1e-16;
  EXPECT_EQ(independent_columns(Z, 1e-6).kept.size(), 3U);
  EXPECT_EQ(independent_columns(Z, 1e-6, 1e-9).kept, (std::vector<Index>{0, 2}));
}

}  // namespace
}  // namespace mbk::numeric
