#include "mbk/study/reliability/mixed_model.h"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace mixed_model_test
}  // namespace mbk::reliability
