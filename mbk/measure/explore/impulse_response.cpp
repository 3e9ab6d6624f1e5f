#include "mbk/measure/explore/impulse_response.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mbk/base/numeric/column_products.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/explore/lagged_regression.h"
#include "mbk/measure/explore/response_model.h"

namespace mbk::explore {
namespace {

constexpr std::array kMemories = {0.02, 0.04, 0.06, 0.08, 0.12, 0.16, 0.2};  // [s]
constexpr Index kFolds = 8;
constexpr Index kRowsOfResponse = 20;

/// The lagged motion and what stands for it, in the directions in which that varies.
struct Basis {
  Index memory = 0;   ///< L
  Matrix X, R;        ///< N×p, centred
  Matrix directions;  ///< p×r
};

Basis basis_of(const LimbSignals& signals, Index memory, const std::vector<RowRange>& rows) {
  Basis basis;
  basis.memory = memory;
  basis.X = centred(lagged(signals.position, -memory, memory, rows));
  basis.R = signals.explained.size() == 0
                ? basis.X
                : centred(lagged(signals.explained.leftCols(signals.axes), -memory, memory, rows));
  basis.directions = principal_directions(basis.R);
  return basis;
}

/// A memory and a rank, and the errors that chose them, fold by fold.
struct Choice {
  Index memory = 0, rank = 0;
  Vector errors;
};

/// @param moments  of lags −longest … longest
Choice best_rank(const std::vector<Moments>& moments, Index n, Index memory, Index longest,
                 std::optional<Index> requested) {
  std::vector<Index> columns;
  for (Index axis = 0; axis < n; ++axis) {
    for (Index lag = -memory; lag <= memory; ++lag) columns.push_back(axis * (2 * longest + 1) + longest + lag);
  }
  const auto kept = of_columns(moments, columns);
  Matrix products = Matrix::Zero(std::ssize(columns), std::ssize(columns));
  for (const Moments& fold : kept) products += fold.ZZ;
  const Matrix errors = cross_validated_errors(in_directions(kept, principal_directions_of_products(products)), 0);
  Index best = 0;
  errors.colwise().mean().minCoeff(&best);
  if (requested) best = std::min(*requested, errors.cols() - 1);
  return {memory, best, errors.col(best)};
}

/// The first that is not significantly worse than the best.
Choice shortest(const std::vector<Choice>& choices) {
  const auto best = std::ranges::min_element(
      choices, [](const Choice& a, const Choice& b) { return a.errors.mean() < b.errors.mean(); });
  for (const Choice& choice : choices) {
    const Vector excess = choice.errors - best->errors;
    const double error = std::sqrt(numeric::variance(excess) / static_cast<double>(excess.size()));
    if (excess.mean() <= error) return choice;
  }
  return *best;
}

std::vector<ExplainedForce> judged(const Matrix& Y, const Matrix& predicted, const std::vector<RowRange>& rows,
                                   double sample_time) {
  std::vector<ExplainedForce> explained;
  for (Index i = 0; i < Y.cols(); ++i) {
    const AccountedFor one = accounted_for(Y.col(i), Y.col(i) - predicted.col(i), rows, sample_time);
    explained.push_back({one.percent, one.half_width, one.rmse});
  }
  return explained;
}

}  // namespace

Result<ImpulseResponseEstimate> impulse_response(const LimbSignals& signals, const ImpulseResponseOptions& options) {
  const Index n = signals.axes;
  const double T = signals.sample_time;
  std::vector<Index> memories;
  const auto add = [&](double seconds) {
    const Index memory = std::max<Index>(1, std::llround(seconds / T));
    if (memories.empty() || memory > memories.back()) memories.push_back(memory);
  };
  if (options.memory_s) {
    add(*options.memory_s);
  } else {
    for (const double seconds : kMemories) add(seconds);
  }
  const auto rows_of_memory = [&](Index memory) {
    return rows_inside(signals.identification, signals.pieces, memory, memory);
  };
  while (memories.size() > 1 &&
         row_count(rows_of_memory(memories.back())) < kRowsOfResponse * n * (2 * memories.back() + 1)) {
    memories.pop_back();
  }
  const auto rows = rows_of_memory(memories.back());
  const Index needed = kRowsOfResponse * n * (2 * memories.back() + 1);
  if (row_count(rows) < needed) {
    return bad_data(fmt::format("an impulse response of ±{:.0f} ms needs {} rows, but there are {}",
                                1e3 * T * static_cast<double>(memories.back()), needed, row_count(rows)),
                    "record longer");
  }
  const Matrix Y = centred(rows_of(signals.resistance, rows));
  const Matrix motion = rows_of(signals.position, rows);
  for (Index i = 0; i < n; ++i) {
    if (!(Y.col(i).squaredNorm() > 0.0)) return bad_data("the force is constant; no response can be estimated");
    if (!(numeric::variance(motion.col(i)) > 0.0))
      return bad_data("the motion is constant; no response can be estimated");
  }

  std::vector<Choice> choices;
  const Index longest = memories.back();
  const Matrix stands_for = signals.explained.size() == 0 ? signals.position : Matrix(signals.explained.leftCols(n));
  const auto moments = lagged_moments({{stands_for, -longest, longest}}, signals.resistance, folds_of(rows, kFolds));
  for (const Index memory : memories) choices.push_back(best_rank(moments, n, memory, longest, options.rank));
  const Choice chosen = shortest(choices);
  if (chosen.rank == 0) {
    return fail(ErrorKind::not_usable, "the motion does not predict the force better than its mean does",
                "move the limb more, or record longer");
  }

  const Index L = chosen.memory, lags = 2 * L + 1;
  const auto own_rows = rows_of_memory(L);
  const Basis basis = basis_of(signals, L, own_rows);
  const Matrix V = basis.directions.leftCols(std::min(chosen.rank, basis.directions.cols()));
  const Matrix own = centred(rows_of(signals.resistance, own_rows));
  const Matrix Z = basis.X * V, R = basis.R * V;
  const LaggedFit fit = fit_lagged(Z, R, own, own_rows);

  ImpulseResponseEstimate result;
  result.axes = signals.axes;
  result.sample_time = T;
  result.memory = T * static_cast<double>(L);
  result.memory_at_limit = !options.memory_s && L == std::llround(kMemories.back() / T);
  result.memory_rule = options.memory_s ? "given" : "cross-validation";
  result.lag = Vector::LinSpaced(lags, -result.memory, result.memory);
  result.rank = V.cols();
  result.directions = basis.X.cols();
  result.instruments = signals.explained.size() > 0;
  result.response.resize(lags, n * n);
  result.half_width.resize(lags, n * n);
  result.excited.resize(lags, n);
  const Vector excited = V.rowwise().squaredNorm();
  for (Index j = 0; j < n; ++j) {
    result.excited.col(j) = excited.segment(j * lags, lags);
    for (Index i = 0; i < n; ++i) {
      const Matrix part = V.middleRows(j * lags, lags);
      result.response.col(i + j * n) = part * fit.coefficients.col(i) / T;
      const Matrix& C = fit.covariance[static_cast<std::size_t>(i)];
      result.half_width.col(i + j * n) =
          numeric::kNormal95 * (part * C).cwiseProduct(part).rowwise().sum().cwiseMax(0.0).cwiseSqrt() / T;
    }
  }

  // [ẍ ẋ x] through the same estimator
  Matrix derivatives(signals.position.rows(), 3 * n);
  derivatives << signals.acceleration, signals.velocity, signals.position;
  const Matrix motions = centred(rows_of(derivatives, own_rows));
  const Matrix D = numeric::Lu(numeric::products_of(R, Z)).solve(numeric::products_of(R, motions));
  result.model = fit_response_model(D, fit, n);

  // M, B, K directly, on the same rows
  Matrix instruments = motions;
  if (result.instruments) {
    Matrix explained(signals.position.rows(), 3 * n);
    explained << signals.explained.rightCols(n), signals.explained.middleCols(n, n), signals.explained.leftCols(n);
    instruments = centred(rows_of(explained, own_rows));
  }
  const LaggedFit direct = fit_lagged(motions, instruments, own, own_rows);

  result.held_out = !signals.validation.empty();
  const auto judged_rows =
      rows_inside(result.held_out ? signals.validation : signals.identification, signals.pieces, L, L);
  const Matrix force = rows_of(signals.resistance, judged_rows);
  const Matrix response = V * fit.coefficients;
  result.explained = judged(force, lagged(signals.position, -L, L, judged_rows) * response, judged_rows, T);
  result.explained_by_model = judged(force, rows_of(derivatives, judged_rows) * direct.coefficients, judged_rows, T);
  return result;
}

}  // namespace mbk::explore
