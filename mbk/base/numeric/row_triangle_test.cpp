#include "mbk/base/numeric/row_triangle.h"

#include <gtest/gtest.h>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"

namespace mbk::numeric {
namespace row_triangle_test {

Matrix noise(Index rows, Index columns) {
  Random random(rows + 7 * columns);
  Matrix all(rows, columns);
  for (double& value : all.reshaped()) value = random.normal();
  return all;
}

TEST(RowTriangle, IsThatOfAllRowsAtOnceButForSigns) {
  for (const Index columns : {1, 2, 4, 5, 9, 17, 70}) {
    for (const Index rows : {1, 15, 400, 1001}) {
      const Matrix all = noise(rows, columns);
      RowTriangle triangle(columns);
      triangle.add(all.topRows(rows / 3));
      triangle.add(all.bottomRows(rows - rows / 3));
      EXPECT_EQ(triangle.R(), Matrix(triangle.R().triangularView<Eigen::Upper>()));
      const Matrix gram = all.transpose() * all;
      EXPECT_LT((triangle.R().transpose() * triangle.R() - gram).cwiseAbs().maxCoeff(), 1e-11)
          << rows << "×" << columns;
      if (rows < columns) continue;
      const Matrix expected = householder_triangle(all);
      EXPECT_LT((triangle.R().cwiseAbs() - expected.cwiseAbs()).cwiseAbs().maxCoeff(), 1e-11) << rows << "×" << columns;
    }
  }
}

// Through RᵀR the small direction would be lost: its square is below the rounding of 1.
TEST(RowTriangle, KeepsADirectionThatItsGramMatrixWouldLose) {
  constexpr double kApart = 1e-10;
  Matrix all = noise(600, 2);
  const double apart = all.col(1).norm();
  all.col(1) = all.col(0) + kApart * all.col(1);
  RowTriangle triangle(2);
  triangle.add(all);
  EXPECT_NEAR(std::abs(triangle.R()(1, 1)) / (kApart * apart), 1.0, 0.1);
  EXPECT_NEAR(std::abs(triangle.R()(1, 1)) / std::abs(householder_triangle(all)(1, 1)), 1.0, 1e-4);
}

TEST(RowTriangle, TakesRowsOfZeros) {
  RowTriangle triangle(3);
  triangle.add(Matrix::Zero(40, 3));
  EXPECT_EQ(triangle.R(), Matrix::Zero(3, 3));
  triangle.add(Matrix::Identity(3, 3));
  EXPECT_EQ(triangle.R().cwiseAbs(), Matrix::Identity(3, 3));
}

}  // namespace row_triangle_test
}  // namespace mbk::numeric
