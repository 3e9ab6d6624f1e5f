#include "mbk/study/reliability/mixed_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/random.h"
#include "mbk/study/reliability/retest.h"

namespace mbk::reliability {
namespace mixed_model_test {

/// participant, session, group, condition, value, known variance
struct Row {
  int participant, session, group, condition;
  double value, variance;
};

/// Nine people in two groups and in three sessions, one of them in one, with trials missing here and there.
constexpr Row kRows[] = {
    {1, 1, 0, 0, 197.473, 22.462}, {1, 1, 0, 1, 185.576, 13.976}, {1, 1, 0, 0, 188.494, 16.486},
    {1, 1, 0, 1, 175.91, 15.674},  {1, 2, 0, 1, 188.608, 4.352},  {1, 2, 0, 1, 191.655, 10.843},
    {1, 2, 0, 0, 199.875, 16.63},  {1, 3, 0, 0, 198.982, 9.832},  {1, 3, 0, 1, 194.328, 22.503},
    {1, 3, 0, 0, 205.827, 18.669}, {2, 1, 0, 0, 203.954, 7.367},  {2, 1, 0, 1, 195.524, 23.009},
    {2, 1, 0, 1, 198.246, 8.288},  {2, 2, 0, 1, 187.416, 19.2},   {2, 2, 0, 0, 202.886, 4.695},
    {2, 2, 0, 1, 191.598, 12.277}, {2, 2, 0, 0, 198.545, 17.405}, {2, 3, 0, 0, 201.07, 22.414},
    {2, 3, 0, 0, 198.772, 7.96},   {2, 3, 0, 1, 195.611, 8.502},  {3, 1, 0, 1, 198.12, 14.604},
    {3, 1, 0, 0, 203.481, 10.523}, {3, 1, 0, 1, 205.31, 23.176},  {3, 2, 0, 1, 200.763, 5.971},
    {3, 2, 0, 0, 208.835, 8.274},  {3, 2, 0, 0, 210.189, 9.96},   {3, 3, 0, 0, 208.054, 22.377},
    {3, 3, 0, 1, 206.691, 18.264}, {3, 3, 0, 0, 221.763, 18.627}, {3, 3, 0, 1, 200.904, 9.289},
    {4, 1, 0, 0, 215.006, 14.459}, {4, 1, 0, 1, 202.397, 4.156},  {4, 1, 0, 0, 207.25, 13.532},
    {5, 1, 1, 0, 202.339, 23.71},  {5, 1, 1, 0, 197.895, 21.397}, {5, 1, 1, 1, 199.804, 6.176},
    {5, 2, 1, 1, 206.25, 11.851},  {5, 2, 1, 0, 205.373, 12.787}, {5, 2, 1, 1, 203.32, 7.256},
    {5, 3, 1, 1, 195.157, 4.001},  {5, 3, 1, 0, 214.793, 18.343}, {5, 3, 1, 1, 204.367, 11.697},
    {6, 1, 1, 0, 229.69, 6.104},   {6, 1, 1, 1, 216.558, 16.516}, {6, 1, 1, 0, 229.126, 15.984},
    {6, 1, 1, 1, 216.597, 23.404}, {6, 2, 1, 1, 199.302, 21.828}, {6, 2, 1, 1, 200.927, 15.144},
    {6, 2, 1, 0, 201.453, 23.952}, {6, 3, 1, 0, 229.063, 19.594}, {6, 3, 1, 1, 215.036, 5.16},
    {6, 3, 1, 0, 227.509, 16.796}, {7, 1, 1, 0, 213.431, 9.593},  {7, 1, 1, 1, 213.946, 13.101},
    {7, 1, 1, 1, 210.235, 13.82},  {7, 2, 1, 1, 209.14, 4.926},   {7, 2, 1, 0, 223.314, 12.743},
    {7, 2, 1, 1, 212.183, 18.335}, {7, 2, 1, 0, 221.428, 9.11},   {7, 3, 1, 0, 221.361, 18.673},
    {7, 3, 1, 0, 219.595, 7.228},  {7, 3, 1, 1, 216.584, 18.247}, {8, 1, 1, 1, 200.664, 7.491},
    {8, 1, 1, 0, 211.949, 21.26},  {8, 1, 1, 1, 196.634, 7.174},  {8, 2, 1, 1, 213.42, 5.403},
    {8, 2, 1, 0, 212.924, 18.005}, {8, 2, 1, 0, 215.951, 16.19},  {8, 3, 1, 0, 197.146, 22.738},
    {8, 3, 1, 1, 200.928, 9.672},  {8, 3, 1, 0, 205.9, 17.997},   {8, 3, 1, 1, 198.648, 8.678},
    {9, 1, 1, 0, 211.247, 11.59},  {9, 1, 1, 1, 203.296, 8.601},  {9, 1, 1, 0, 210.764, 13.398},
    {9, 2, 1, 0, 228.465, 7.252},  {9, 2, 1, 1, 219.658, 9.866},  {9, 2, 1, 0, 224.12, 23.757},
    {9, 3, 1, 0, 228.256, 9.688},  {9, 3, 1, 1, 226.464, 16.302}, {9, 3, 1, 1, 214.247, 11.656},
};

Measurements measurements(bool with_known_variance = false) {
  Measurements m;
  const auto n = static_cast<Index>(std::size(kRows));
  m.values.resize(n);
  m.fixed.resize(n, 3);
  if (with_known_variance) m.known_variance.resize(n);
  for (Index i = 0; i < n; ++i) {
    const Row& row = kRows[i];
    m.values[i] = row.value;
    m.participants.push_back(row.participant);
    m.sessions.push_back(row.session);
    m.fixed.row(i) << 1.0, row.group, row.condition;
    if (with_known_variance) m.known_variance[i] = row.variance;
  }
  m.names = {"intercept", "group", "condition"};
  return m;
}

/// A thousandth of each number, as it was asked for; both are at the maximum to six digits.
void expect_near(double value, double reference) {
  EXPECT_NEAR(value, reference, 1e-4 * std::abs(reference));
}

/// lme4 1.1-31 and lmerTest of Debian 12:
///   lmer(y ~ g + cond + (1|p) + (1|p:s), REML = TRUE,
///        control = lmerControl(optimizer = "bobyqa", optCtrl = list(rhoend = 1e-12)))
TEST(MixedModel, AgreesWithLme4OnMissingCells) {
  const auto model = fit_mixed_model(measurements());
  ASSERT_TRUE(model) << model.error().line();
  EXPECT_EQ(model->participants, 9);
  EXPECT_EQ(model->sessions, 25);
  EXPECT_EQ(model->rows, 81);
  expect_near(model->participant.value, 27.7652522368);
  expect_near(model->session.value, 38.2440542229);
  expect_near(model->residual.value, 16.6873130948);
  expect_near(model->deviance, 507.04557108504);
  const double reference[3][3] = {{204.11583710676, 3.457746314298, 7.76508087878},
                                  {11.63229943634, 4.495945688375, 7.08142413484},
                                  {-7.64784329893, 0.940689475521, 56.19998269535}};
  for (std::size_t k = 0; k < 3; ++k) {
    expect_near(model->effects[k].value, reference[k][0]);
    expect_near(model->effects[k].standard_error, reference[k][1]);
    EXPECT_NEAR(model->effects[k].degrees_of_freedom, reference[k][2],
                2e-3 * reference[k][2]);  // its Hessian is numeric
  }
  expect_near(model->effects[1].p, 3.57295751915e-02);
}

/// metafor 3.8-1: rma.mv(y, v, mods = ~ g + cond, random = list(~1|p, ~1|ps, ~1|o)), o a number for each row.
TEST(MixedModel, AgreesWithMetaforOnKnownVariances) {
  const auto model = fit_mixed_model(measurements(true));
  ASSERT_TRUE(model) << model.error().line();
  expect_near(model->participant.value, 27.39015194610);
  expect_near(model->session.value, 35.61375066064);
  expect_near(model->residual.value, 3.54464130762);
  const double reference[3][2] = {
      {204.05076686201, 3.396241382869}, {11.85123152260, 4.415946473479}, {-7.86872776153, 0.909531852905}};
  for (std::size_t k = 0; k < 3; ++k) {
    expect_near(model->effects[k].value, reference[k][0]);
    expect_near(model->effects[k].standard_error, reference[k][1]);
  }
}

/// −2 ln of the restricted likelihood by the whole covariance of all rows, and β.
std::pair<double, Vector> by_dense_matrices(const Measurements& m, double participant, double session,
                                            double residual) {
  const Index n = m.values.size(), p = m.fixed.cols();
  Matrix V = Matrix::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index k = 0; k < n; ++k) {
      const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(k);
      if (m.participants[a] != m.participants[b]) continue;
      V(i, k) += participant + (m.sessions[a] == m.sessions[b] ? session : 0.0);
    }
    V(i, i) += residual + (m.known_variance.size() > 0 ? m.known_variance[i] : 0.0);
  }
  const Matrix inverse = numeric::inverse(V);
  const Matrix information = m.fixed.transpose() * inverse * m.fixed;
  const Vector beta = numeric::PivotedCholesky(information).solve(m.fixed.transpose() * inverse * m.values);
  const Vector rest = m.values - m.fixed * beta;
  const double log_det_V = 2.0 * numeric::Cholesky(V).upper().diagonal().array().log().sum();
  return {log_det_V + std::log(numeric::determinant(information)) + rest.dot(inverse * rest) +
              static_cast<double>(n - p) * std::log(2.0 * std::numbers::pi),
          beta};
}

TEST(MixedModel, IsTheMaximumOfTheLikelihoodByDenseMatrices) {
  for (const bool known : {false, true}) {
    const Measurements m = measurements(known);
    const auto model = fit_mixed_model(m);
    ASSERT_TRUE(model);
    const double P = model->participant.value, S = model->session.value, E = model->residual.value;
    const auto [deviance, beta] = by_dense_matrices(m, P, S, E);
    EXPECT_NEAR(model->deviance, deviance, 1e-9 * std::abs(deviance));
    for (Index k = 0; k < 3; ++k) EXPECT_NEAR(model->effects[static_cast<std::size_t>(k)].value, beta[k], 1e-8);
    for (const double factor : {0.97, 1.03}) {
      EXPECT_GT(by_dense_matrices(m, factor * P, S, E).first, deviance);
      EXPECT_GT(by_dense_matrices(m, P, factor * S, E).first, deviance);
      EXPECT_GT(by_dense_matrices(m, P, S, factor * E).first, deviance);
    }
    // the standard error of a variance by second differences of the dense likelihood
    constexpr double kStep = 1e-3;
    Matrix information(3, 3);
    const auto at = [&](int i, double a, int k, double b) {
      double variances[] = {P, S, E};
      variances[i] += a * kStep * E;
      variances[k] += b * kStep * E;
      return by_dense_matrices(m, variances[0], variances[1], variances[2]).first;
    };
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        information(i, k) = 0.5 * (at(i, 1, k, 1) - at(i, 1, k, -1) - at(i, -1, k, 1) + at(i, -1, k, -1)) /
                            std::pow(2.0 * kStep * E, 2);
      }
    }
    EXPECT_NEAR(*model->participant.standard_error, std::sqrt(numeric::inverse(information)(0, 0)), 0.01 * P);
  }
}

TEST(MixedModel, DoesNotDependOnTheOrderOfRowsOrTheirUnit) {
  const Measurements m = measurements(true);
  Measurements other = m;
  const auto n = static_cast<std::size_t>(m.values.size());
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t from = (i * 37) % n;  // 81 and 37 have no common divisor
    const auto a = static_cast<Index>(i), b = static_cast<Index>(from);
    other.values[a] = 1e6 * m.values[b];
    other.known_variance[a] = 1e12 * m.known_variance[b];
    other.participants[i] = 100 - m.participants[from];
    other.sessions[i] = 7 * m.sessions[from];
    other.fixed.row(a) = m.fixed.row(b);
  }
  const auto one = fit_mixed_model(m), two = fit_mixed_model(other);
  ASSERT_TRUE(one && two);
  EXPECT_NEAR(two->participant.value, 1e12 * one->participant.value, 1e6 * one->participant.value);
  EXPECT_NEAR(two->effects[1].value, 1e6 * one->effects[1].value, 1.0);
  EXPECT_NEAR(two->effects[1].degrees_of_freedom, one->effects[1].degrees_of_freedom, 1e-4);
}

/// lme4 1.1-31 on the values less their participant's mean: (1|p) is singular.
TEST(MixedModel, HasAVarianceOfZeroWhereTheLikelihoodHasItsMaximumThere) {
  Measurements m = measurements();
  for (int participant = 1; participant <= 9; ++participant) {
    double sum = 0.0;
    int count = 0;
    for (const Row& row : kRows) {
      if (row.participant != participant) continue;
      sum += row.value;
      ++count;
    }
    for (std::size_t i = 0; i < m.participants.size(); ++i) {
      if (m.participants[i] == participant) m.values[static_cast<Index>(i)] -= sum / count;
    }
  }
  m.fixed = m.fixed.leftCols(2).eval();
  const auto model = fit_mixed_model(m);
  ASSERT_TRUE(model) << model.error().line();
  EXPECT_EQ(model->participant.value, 0.0);
  EXPECT_TRUE(model->participant.present);
  EXPECT_FALSE(model->participant.standard_error);
  expect_near(model->session.value, 21.5685668556);
  expect_near(model->residual.value, 35.6222219723);
  expect_near(model->deviance, 538.69713040729);
  expect_near(model->effects[1].standard_error, 2.33156859007);
  EXPECT_NEAR(model->effects[1].degrees_of_freedom, 22.5081429706, 0.1);
}

/// A column of ones.
Measurements of_scores(const Matrix& scores) {
  Measurements m;
  m.values.resize(scores.size());
  m.fixed = Matrix::Ones(scores.size(), 1);
  for (Index i = 0, at = 0; i < scores.rows(); ++i) {
    for (Index j = 0; j < scores.cols(); ++j, ++at) {
      m.values[at] = scores(i, j);
      m.participants.push_back(static_cast<int>(i));
      m.sessions.push_back(static_cast<int>(j));
    }
  }
  return m;
}

Matrix simulated_scores(numeric::Random& random, Index people, Index sessions, double participant, double residual) {
  Matrix scores(people, sessions);
  for (Index i = 0; i < people; ++i) {
    const double own = participant * random.normal();
    for (Index j = 0; j < sessions; ++j) scores(i, j) = own + residual * random.normal();
  }
  return scores;
}

TEST(ModelReliability, IsTheOneWayCoefficientWhereNothingIsMissing) {
  numeric::Random random(4);
  const Matrix scores = simulated_scores(random, 20, 3, 2.0, 1.0);
  const auto by_model = model_reliability(of_scores(scores));
  const auto by_squares = test_retest(scores);
  ASSERT_TRUE(by_model && by_squares) << by_model.error().line();
  const Icc& one_way = by_squares->icc.front();
  EXPECT_NEAR(by_model->icc, one_way.value, 1e-6);
  EXPECT_NEAR(by_model->sem_between, std::sqrt(by_squares->mean_squares.within_people), 1e-6);
  // The exact interval by F against that of the likelihood: alike, not the same.
  EXPECT_NEAR(by_model->icc95.first, one_way.interval95.first, 0.03);
  EXPECT_NEAR(by_model->icc95.second, one_way.interval95.second, 0.03);
  EXPECT_DOUBLE_EQ(by_model->mdc95_between, 1.96 * std::sqrt(2.0) * by_model->sem_between);
}

TEST(ModelReliability, SessionsOfOneRowArePartOfTheResidual) {
  numeric::Random random(6);
  const auto model = fit_mixed_model(of_scores(simulated_scores(random, 8, 3, 1.0, 1.0)));
  ASSERT_TRUE(model);
  EXPECT_FALSE(model->session.present);
  EXPECT_EQ(model->session.value, 0.0);
  EXPECT_TRUE(model->residual.present);
}

TEST(ModelReliability, SaysWhatItLacks) {
  numeric::Random random(7);
  EXPECT_EQ(model_reliability(of_scores(simulated_scores(random, 4, 3, 1.0, 1.0)))->support, Support::too_few_people);
  EXPECT_EQ(model_reliability(of_scores(simulated_scores(random, 8, 1, 1.0, 1.0)))->support, Support::too_few_sessions);
  EXPECT_FALSE(model_reliability(of_scores(simulated_scores(random, 8, 3, 1.0, 1.0)), 0));
}

TEST(MixedModel, CountsMissingCellsAndRefusesWhatIsWrong) {
  Measurements m = measurements();
  m.values[3] = NAN;
  const auto model = fit_mixed_model(m);
  ASSERT_TRUE(model);
  EXPECT_EQ(model->missing, 1);
  EXPECT_EQ(model->rows, 80);

  Measurements dependent = measurements();
  dependent.fixed.col(2) = 2.0 * dependent.fixed.col(1) - dependent.fixed.col(0);
  const auto refused = fit_mixed_model(dependent);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("'condition'"), std::string::npos) << refused.error().message;

  Measurements constant = measurements();
  constant.values.setConstant(3.3);
  EXPECT_FALSE(fit_mixed_model(constant));
  Measurements copied = measurements();
  copied.fixed = copied.fixed.leftCols(1).eval();
  for (std::size_t i = 0; i < copied.participants.size(); ++i) {
    copied.values[static_cast<Index>(i)] = copied.participants[i] + 0.1 * copied.sessions[i];
  }
  EXPECT_FALSE(fit_mixed_model(copied)) << "nothing varies within sessions";
  Measurements negative = measurements(true);
  negative.known_variance[5] = -1.0;
  EXPECT_FALSE(fit_mixed_model(negative));
  Measurements shorter = measurements();
  shorter.sessions.pop_back();
  EXPECT_FALSE(fit_mixed_model(shorter));
  Measurements infinite = measurements();
  infinite.values[0] = INFINITY;
  EXPECT_FALSE(fit_mixed_model(infinite));
}

TEST(MixedModel, FindsItsVariancesInManyRows) {
  numeric::Random random(12);
  Measurements m;
  const Index people = 400, sessions = 5, trials = 5, rows = people * sessions * trials;
  m.values.resize(rows);
  m.fixed.resize(rows, 2);
  m.known_variance.resize(rows);
  Index at = 0;
  for (int i = 0; i < people; ++i) {
    const double own = 3.0 * random.normal();
    for (int j = 0; j < sessions; ++j) {
      const double of_session = 2.0 * random.normal();
      for (int k = 0; k < trials; ++k, ++at) {
        m.known_variance[at] = 0.5 + random.uniform();
        m.values[at] = own + of_session + std::sqrt(1.0 + m.known_variance[at]) * random.normal();
        m.fixed.row(at) << 1.0, i % 2;
        m.participants.push_back(i);
        m.sessions.push_back(j);
      }
    }
  }
  const auto model = fit_mixed_model(m);
  ASSERT_TRUE(model) << model.error().line();
  for (const auto& [component, truth] :
       {std::pair(model->participant, 9.0), std::pair(model->session, 4.0), std::pair(model->residual, 1.0)}) {
    EXPECT_NEAR(component.value, truth, 4.0 * *component.standard_error);
  }
}

}  // namespace mixed_model_test
}  // namespace mbk::reliability
