#include "mbk/measure/analyse/decimation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "mbk/base/core/nan.h"

namespace mbk::analyse {
namespace decimation_test {

Vector counting(Index samples) {
  return Vector::LinSpaced(samples, 0.0, static_cast<double>(samples - 1));
}

Matrix noise(Index samples, Index columns, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Matrix values(samples, columns);
  for (double& value : values.reshaped()) value = normal(random);
  return values;
}

TEST(Decimation, KeepsAllOfWhatIsShort) {
  const Vector time = counting(kDrawnRows);
  const Matrix values = noise(kDrawnRows, 2, 1);
  for (const Decimation how : {Decimation::every, Decimation::extremes}) {
    const Series shown = decimated(time, values, {{0, kDrawnRows}}, how);
    EXPECT_EQ(shown.time, time);
    EXPECT_EQ(shown.values, values);
  }
  EXPECT_EQ(decimated(Vector(), Matrix(0, 2), {}, Decimation::extremes).values.cols(), 2);
}

TEST(Decimation, LosesNoExtremeOfAnyColumnWhereverItStands) {
  for (const Index samples : {2001, 2003, 9999, 54321}) {
    for (const Index spike : {Index{0}, Index{1}, samples / 2, samples - 2, samples - 1}) {
      Matrix values = noise(samples, 2, 2);
      values(spike, 0) = 50.0;
      values(samples - 1 - spike, 1) = -60.0;
      const Series shown = decimated(counting(samples), values, {{0, samples}}, Decimation::extremes);
      EXPECT_EQ(shown.values.col(0).maxCoeff(), 50.0);
      EXPECT_EQ(shown.values.col(1).minCoeff(), -60.0);
      EXPECT_EQ(shown.values.col(0).minCoeff(), values.col(0).minCoeff());
      EXPECT_LE(shown.time.size(), kDrawnRows);
      EXPECT_GT(shown.time.size(), kDrawnRows / 3);
      for (Index i = 1; i < shown.time.size(); ++i) ASSERT_GT(shown.time[i], shown.time[i - 1]);
    }
  }
}

TEST(Decimation, KeepsARampInOrder) {
  const Index samples = 10000;
  const Series up = decimated(counting(samples), counting(samples), {{0, samples}}, Decimation::extremes);
  for (Index i = 1; i < up.time.size(); ++i) ASSERT_GT(up.values(i, 0), up.values(i - 1, 0));
}

TEST(Decimation, TakesEverySoManyRowsJustAsTheyAre) {
  const Matrix values = noise(5000, 1, 3);
  const Series shown = decimated(counting(5000), values, {{0, 5000}}, Decimation::every);
  ASSERT_EQ(shown.time.size(), 1667);
  for (Index i = 0; i < shown.time.size(); ++i) {
    EXPECT_EQ(shown.time[i], static_cast<double>(3 * i));
    EXPECT_EQ(shown.values(i, 0), values(3 * i, 0));
  }
}

TEST(Decimation, PutsARowOfNaNBetweenPiecesAndMixesNothingAcross) {
  Matrix values(9000, 1);
  values << Matrix::Constant(4500, 1, 1.0), Matrix::Constant(4500, 1, 2.0);
  const std::vector<Rows> pieces = {{0, 4000}, {4100, 4500}, {5000, 9000}};
  for (const Decimation how : {Decimation::every, Decimation::extremes}) {
    const Series shown = decimated(counting(9000), values, pieces, how);
    EXPECT_EQ(shown.values.array().isNaN().count(), 2);
    EXPECT_EQ(shown.time.array().isNaN().count(), 2);
    EXPECT_FALSE(std::isnan(shown.time[0]));
    EXPECT_FALSE(std::isnan(shown.time[shown.time.size() - 1]));
    for (Index i = 0; i < shown.time.size(); ++i) {
      if (std::isnan(shown.time[i])) continue;
      EXPECT_EQ(shown.values(i, 0), shown.time[i] < 4500.0 ? 1.0 : 2.0);
      EXPECT_FALSE(shown.time[i] >= 4000.0 && shown.time[i] < 4100.0);
    }
  }
}

TEST(Decimation, PassesOverWhatIsNoNumber) {
  Matrix values = noise(10000, 1, 4);
  for (Index i = 0; i < 10000; i += 2) values(i, 0) = kNaN;
  values.middleRows(4000, 2000).setConstant(kNaN);
  const Series shown = decimated(counting(10000), values, {{0, 10000}}, Decimation::extremes);
  for (Index i = 0; i < shown.time.size(); ++i) {
    const double from_hole = std::min(shown.time[i] - 4000.0, 6000.0 - shown.time[i]);  // > 0 inside
    if (std::abs(from_hole) < 20.0) continue;
    EXPECT_EQ(std::isnan(shown.values(i, 0)), from_hole > 0.0) << shown.time[i];
  }
}

TEST(PiecesBetweenGaps, BreakWhereTheClockJumpsVisibly) {
  Vector time = counting(10000) * 0.001;
  time.tail(4000).array() += 2.0;   // a gap
  time.tail(2000).array() -= 5.0;   // a restart
  time.tail(1000).array() += 0.01;  // too short to be seen
  const std::vector<Rows> pieces = pieces_between_gaps(time);
  ASSERT_EQ(pieces.size(), 3U);
  EXPECT_EQ(pieces[0].end, 6000);
  EXPECT_EQ(pieces[1].begin, 6000);
  EXPECT_EQ(pieces[1].end, 8000);
  EXPECT_EQ(pieces[2].end, 10000);
}

TEST(PiecesBetweenGaps, AreOneWhereTheClockOnlyJitters) {
  std::mt19937 random(5);
  std::exponential_distribution<double> wait(1000.0);
  Vector time(100000);
  double now = 0.0;
  for (double& t : time) t = now += wait(random);
  EXPECT_EQ(pieces_between_gaps(time).size(), 1U);
  EXPECT_EQ(pieces_between_gaps(counting(3)).size(), 1U);
  EXPECT_EQ(pieces_between_gaps(counting(1)).size(), 1U);
  EXPECT_TRUE(pieces_between_gaps(Vector()).empty());
}

PreparedTrial trial_of(std::vector<Segment> segments, Index rows) {
  PreparedTrial trial;
  trial.sample_time = 0.01;
  trial.time = counting(rows) * trial.sample_time;
  trial.segments = std::move(segments);
  return trial;
}

TEST(RowsOf, JoinSegmentsThatFollowEachOtherAndNoOthers) {
  PreparedTrial trial = trial_of({{0, 10, Purpose::identification, 7},
                                  {10, 20, Purpose::validation, 107},
                                  {20, 30, Purpose::identification, 500},
                                  {35, 40, Purpose::validation, 900}},
                                 40);
  trial.time.tail(20).array() += 1.0;  // a break between rows 19 and 20
  const std::vector<Rows> all = rows_of(trial);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].end, 20);
  EXPECT_EQ(all[0].first_sample, 7);
  EXPECT_EQ(all[1].first_sample, 500);
  const std::vector<Rows> held_out = rows_of(trial, Purpose::validation);
  ASSERT_EQ(held_out.size(), 2U);
  EXPECT_EQ(held_out[0].begin, 10);
  EXPECT_EQ(held_out[0].first_sample, 107);
}

TEST(DecimationOf, KeepsExtremesWhereEverySoManyRowsWouldMissThem) {
  PreparedTrial trial = trial_of({}, 8000);  // one row in four is drawn: every 0.04 s
  const std::vector<Rows> rows = {{0, 8000}};
  trial.preparation.cutoff = Hertz(6.0);
  EXPECT_EQ(decimation_of(trial, rows), Decimation::every);
  trial.preparation.cutoff = Hertz(6.5);
  EXPECT_EQ(decimation_of(trial, rows), Decimation::extremes);
  trial.preparation.cutoff.reset();
  EXPECT_EQ(decimation_of(trial, rows), Decimation::extremes);
}

}  // namespace decimation_test
}  // namespace mbk::analyse
