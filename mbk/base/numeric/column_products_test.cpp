#include "mbk/base/numeric/column_products.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace mbk::numeric {
namespace column_products_test {

constexpr double kTolerance = 1e-13;

TEST(ColumnProducts, AreThoseOfThePlainProductForAnyShape) {
  for (const Index rows : {1, 3, 7, 8, 255, 256, 257, 1000, 5003}) {
    for (const Index columns : {1, 2, 3, 4, 6, 7, 10}) {
      const Matrix A = Matrix::Random(rows, columns), B = Matrix::Random(rows, 5), C = Matrix::Random(rows, 1);
      Matrix all(rows, columns + 6);
      all << A, B, C;
      const Matrix gram = all.transpose() * all;
      EXPECT_LE((gram_of({A, B, C}) - gram).cwiseAbs().maxCoeff(), kTolerance * gram.maxCoeff());
      EXPECT_LE((products_of(A, B) - A.transpose() * B).cwiseAbs().maxCoeff(), kTolerance * gram.maxCoeff());
      const Matrix theta = Matrix::Random(columns, 5);
      const Matrix want = A.transpose() * (B - A * theta);
      EXPECT_LE((projected_residuals(A, B, theta) - want).cwiseAbs().maxCoeff(), 10 * kTolerance * gram.maxCoeff());
    }
  }
}

TEST(ColumnProducts, AddUpOverBlocks) {
  for (const Index columns : {1, 2, 3, 4, 5, 6, 14, 28}) {
    const Matrix A = Matrix::Random(777, columns);
    GramSum sum(columns);
    Index begin = 0;
    for (const Index rows : {1, 0, 256, 500, 20}) {
      sum.add(A.middleRows(begin, rows));
      begin += rows;
    }
    EXPECT_LE((sum.gram() - A.transpose() * A).cwiseAbs().maxCoeff(), kTolerance * 777.0);
  }
}

TEST(ColumnProducts, LeaveTheResidualsOfThePlainProduct) {
  for (const Index rows : {1, 7, 8, 300, 1001}) {
    for (const Index outputs : {1, 2, 3, 4, 8}) {
      const Matrix Z = Matrix::Random(rows + 3, 7), Y = Matrix::Random(rows + 3, outputs),
                   theta = Matrix::Random(7, outputs);
      const Matrix want = Y - Z * theta;
      EXPECT_LE((residuals_of({Z}, Y, theta) - want).cwiseAbs().maxCoeff(), kTolerance);
      const auto part = Z.topRows(rows);
      EXPECT_LE((residuals_of({part.leftCols(3), part.rightCols(4)}, Y.topRows(rows), theta) - want.topRows(rows))
                    .cwiseAbs()
                    .maxCoeff(),
                kTolerance);
    }
  }
}

TEST(ColumnProducts, OfASignalWithItselfTakeEveryPairOnce) {
  for (const Index samples : {1, 2, 5, 11, 12, 40, 257, 1003}) {
    const Vector e = Vector::Random(samples);
    for (const Index first : {Index{0}, Index{1}, samples / 2}) {
      for (const Index count : {Index{1}, Index{2}, Index{9}, Index{10}, Index{64}, samples - first}) {
        if (count < 1 || first + count > samples) continue;
        const Vector sums = lagged_products(e, first, count);
        ASSERT_EQ(sums.size(), count);
        for (Index k = 0; k < count; ++k) {
          const Index pairs = samples - first - k;
          EXPECT_NEAR(sums[k], e.head(pairs).dot(e.tail(pairs)), kTolerance * static_cast<double>(samples))
              << samples << " samples, lag " << first + k;
        }
      }
    }
  }
}

TEST(ColumnProducts, TakePartsOfMatrices) {
  const Matrix all = Matrix::Random(900, 8);
  const auto part = all.block(13, 2, 700, 4);
  const Matrix copy = part;
  EXPECT_EQ(gram_of({part}), gram_of({copy}));
  EXPECT_EQ(products_of(part, all.block(100, 0, 700, 2)), products_of(copy, Matrix(all.block(100, 0, 700, 2))));
}

TEST(ColumnProducts, OfNothingAreNothing) {
  EXPECT_EQ(gram_of({Matrix(10, 0)}).size(), 0);
  EXPECT_EQ(products_of(Matrix(0, 2), Matrix(0, 3)), Matrix::Zero(2, 3));
}

TEST(ColumnProducts, ShowAValueThatIsNoNumber) {
  Matrix A = Matrix::Ones(300, 2);
  A(299, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(gram_of({A})(0, 1)));
}

}  // namespace column_products_test
}  // namespace mbk::numeric
