#include "mbk/study/reliability/retest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mbk/base/numeric/distributions.h"
#include "mbk/study/reliability/heavy_tails.h"

namespace mbk::reliability {
namespace {

Result<void> all_finite(const Matrix& scores) {
  for (Index j = 0; j < scores.cols(); ++j) {
    const Index i = first_non_finite(scores.col(j));
    if (i >= 0) {
      return bad_data(fmt::format("the score of person {} in session {} is not a finite number", i + 1, j + 1),
                      "use the mixed model, which allows missing cells, or omit the person");
    }
  }
  return {};
}

/// (F − 1)/(F + k − 1), 1 where F is infinite.
double icc_of_ratio(double ratio, double k) {
  return std::isinf(ratio) ? 1.0 : (ratio - 1.0) / (ratio + k - 1.0);
}

/// What the mean of k has of what one has (Spearman and Brown); it rises with r, from −∞ at −1/(k − 1). ICC(A,1) and
/// the ends of its interval may be below that.
double of_mean(double r, double k) {
  const double denominator = 1.0 + (k - 1.0) * r;
  return denominator > 0.0 ? k * r / denominator : -std::numeric_limits<double>::infinity();
}

double ratio_of(double numerator, double denominator) {
  return denominator > 0.0 ? numerator / denominator : std::numeric_limits<double>::infinity();
}

/// By the ratio of mean squares, whose distribution is that of F times (1 + (k−1) ρ)/(1 − ρ).
Icc icc_by_ratio(IccForm form, const MeanSquares& squares, double error, double error_degrees) {
  const double ratio = ratio_of(squares.between_people, error), k = squares.sessions;
  const double people_degrees = squares.people - 1;
  return {form,
          1,
          icc_of_ratio(ratio, k),
          {icc_of_ratio(ratio / numeric::f_quantile(1.0 - kTail95, people_degrees, error_degrees), k),
           icc_of_ratio(ratio * numeric::f_quantile(1.0 - kTail95, error_degrees, people_degrees), k)}};
}

/// Satterthwaite's degrees of freedom of a·MSJ + b·MSE.
double satterthwaite(const MeanSquares& squares, double a, double b) {
  const double sessions = a * squares.between_sessions, residual = b * squares.residual;
  const double k = squares.sessions, n = squares.people;
  const double sum = sessions + residual;
  return sum * sum / (sessions * sessions / (k - 1.0) + residual * residual / ((n - 1.0) * (k - 1.0)));
}

Icc icc_of_agreement(const MeanSquares& squares) {
  const double n = squares.people, k = squares.sessions;
  const double MSB = squares.between_people, MSJ = squares.between_sessions, MSE = squares.residual;
  Icc icc{IccForm::agreement, 1, icc_of(IccForm::agreement, squares), {1.0, 1.0}};
  if (icc.value >= 1.0) return icc;
  const double odds = std::max(icc.value, 0.0) / (1.0 - std::max(icc.value, 0.0));
  const double v = satterthwaite(squares, k * odds / n, 1.0 + k * odds * (n - 1.0) / n);
  const double lower = numeric::f_quantile(1.0 - kTail95, n - 1.0, v),
               upper = numeric::f_quantile(1.0 - kTail95, v, n - 1.0);
  const double error = k * MSJ + (k * n - k - n) * MSE;
  icc.interval95 = {n * (MSB - lower * MSE) / (lower * error + n * MSB),
                    n * (upper * MSB - MSE) / (error + n * upper * MSB)};
  return icc;
}

MeasurementError error_of(IccForm form, double variance, double degrees) {
  const double sem = std::sqrt(variance);
  const Interval sem95 =
      widened_for_tails(sem, {sem * std::sqrt(degrees / numeric::chi_square_quantile(1.0 - kTail95, degrees)),
                              sem * std::sqrt(degrees / numeric::chi_square_quantile(kTail95, degrees))});
  constexpr double kChange = kPublishedNormal95 * std::numbers::sqrt2;
  return {form, sem, sem95, kChange * sem, {kChange * sem95.first, kChange * sem95.second}};
}

}  // namespace

double icc_of(IccForm form, const MeanSquares& squares) {
  const double n = squares.people, k = squares.sessions;
  const double MSB = squares.between_people, MSJ = squares.between_sessions, MSE = squares.residual;
  if (form == IccForm::one_way) return icc_of_ratio(ratio_of(MSB, squares.within_people), k);
  if (form == IccForm::consistency) return icc_of_ratio(ratio_of(MSB, MSE), k);
  return (MSB - MSE) / (MSB + (k - 1.0) * MSE + k * (MSJ - MSE) / n);
}

Result<MeanSquares> mean_squares(const Matrix& scores) {
  if (scores.rows() < 2 || scores.cols() < 2) {
    return bad_data(fmt::format("{} people in {} sessions have no mean squares", scores.rows(), scores.cols()),
                    "give two or more of each");
  }
  MBK_TRY(all_finite(scores));
  const auto n = static_cast<double>(scores.rows()), k = static_cast<double>(scores.cols());
  const double mean = scores.mean();
  const Vector of_people = scores.rowwise().mean().array() - mean;
  const Eigen::RowVectorXd of_sessions = scores.colwise().mean().array() - mean;
  Matrix left = scores.array() - mean;
  left.colwise() -= of_people;
  const double within = left.squaredNorm();
  left.rowwise() -= of_sessions;
  MeanSquares squares;
  squares.people = static_cast<int>(scores.rows());
  squares.sessions = static_cast<int>(scores.cols());
  squares.between_people = k * of_people.squaredNorm() / (n - 1.0);
  squares.between_sessions = n * of_sessions.squaredNorm() / (k - 1.0);
  squares.residual = left.squaredNorm() / ((n - 1.0) * (k - 1.0));
  squares.within_people = within / (n * (k - 1.0));
  return squares;
}

Result<TestRetest> test_retest(const Matrix& scores) {
  if (scores.size() == 0) return bad_data("there are no scores", "give one row per person");
  MBK_TRY(all_finite(scores));
  TestRetest result;
  result.mean_squares.people = static_cast<int>(scores.rows());
  result.mean_squares.sessions = static_cast<int>(scores.cols());
  if (scores.cols() < 2) result.support = Support::too_few_sessions;
  if (scores.rows() < kMinPeople) result.support = Support::too_few_people;
  if (scores.rows() < 2 || scores.cols() < 2) return result;
  const auto squares = MBK_TRY(mean_squares(scores));
  result.mean_squares = squares;
  const double rounding = 16.0 * std::numeric_limits<double>::epsilon() * scores.cwiseAbs().maxCoeff();
  if (result.support == Support::enough && squares.within_people + squares.between_people <= rounding * rounding) {
    result.support = Support::no_variation;
  }
  if (result.support != Support::enough) return result;

  const double n = squares.people, k = squares.sessions, residual_degrees = (n - 1.0) * (k - 1.0);
  result.icc = {icc_by_ratio(IccForm::one_way, squares, squares.within_people, n * (k - 1.0)),
                icc_of_agreement(squares),
                icc_by_ratio(IccForm::consistency, squares, squares.residual, residual_degrees)};
  for (std::size_t i = 0; i < 3; ++i) {
    const Icc one = result.icc[i];
    result.icc.push_back({one.form,
                          squares.sessions,
                          of_mean(one.value, k),
                          {of_mean(one.interval95.first, k), of_mean(one.interval95.second, k)}});
  }
  const double agreement = (squares.between_sessions - squares.residual) / n + squares.residual;
  result.error = {error_of(IccForm::agreement, agreement, satterthwaite(squares, 1.0 / n, 1.0 - 1.0 / n)),
                  error_of(IccForm::consistency, squares.residual, residual_degrees)};
  return result;
}

}  // namespace mbk::reliability
