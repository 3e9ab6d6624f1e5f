#include "mbk/simulate/laboratory/truth_text.h"

#include <gtest/gtest.h>

namespace mbk::laboratory {
namespace {

TEST(TruthText, NumbersHaveTwelveDigitsAndNoMoreThanTheyNeed) {
  EXPECT_EQ(exact_text(0.1), "0.1");
  EXPECT_EQ(exact_text(1.0 / 3.0), "0.333333333333");
  EXPECT_EQ(exact_text(-2.5e-7), "-2.5e-07");
}

TEST(TruthText, MatricesAreRowsOfJson) {
  EXPECT_EQ(exact_text(Vector(Eigen::Vector3d(1.0, -2.0, 0.5))), "[1, -2, 0.5]");
  EXPECT_EQ(exact_text((Matrix(2, 2) << 1.0, 2.0, 3.0, 4.0).finished()), "[[1, 2], [3, 4]]");
  EXPECT_EQ(exact_text(Matrix(Matrix::Constant(1, 1, 45.0))), "[[45]]");
}

TEST(TruthText, MetadataNameTheWholeModel) {
  const impedance::Model model{Matrix::Constant(1, 1, 1.0), Matrix::Constant(1, 1, 2.0), Matrix::Constant(1, 1, 3.0),
                               Vector::Constant(1, 4.0)};
  const std::map<std::string, std::string> expected = {{"rate_hz", "500"},   {"truth_M", "[[1]]"},
                                                       {"truth_B", "[[2]]"}, {"truth_K", "[[3]]"},
                                                       {"truth_x0", "[4]"},  {"truth_energy_absorbed_J", "-0.25"}};
  EXPECT_EQ(truth_metadata(model, Hertz(500.0), -0.25), expected);
}

}  // namespace
}  // namespace mbk::laboratory
