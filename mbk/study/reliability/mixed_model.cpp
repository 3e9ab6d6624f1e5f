#include "mbk/study/reliability/mixed_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <type_traits>
#include <utility>

#include "mbk/base/core/nan.h"
#include "mbk/base/core/units.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/distributions.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/study/reliability/heavy_tails.h"
#include "mbk/study/reliability/second_order_jet.h"

namespace mbk::reliability {
namespace {

constexpr std::size_t kParticipant = 0, kSession = 1, kResidual = 2;

/// The variables of a search: up to three variances or functions of them.
template <class Scalar>
using Point = std::array<Scalar, 3>;
using Derivatives = Jet<3>;

/// Lower triangle of a symmetric matrix, row by row.
template <class Scalar>
struct Triangle {
  explicit Triangle(std::size_t rows) : order(rows), entries(rows * (rows + 1) / 2, Scalar(0.0)) {}
  Scalar& operator()(std::size_t i, std::size_t k) { return entries[i * (i + 1) / 2 + k]; }
  const Scalar& operator()(std::size_t i, std::size_t k) const { return entries[i * (i + 1) / 2 + k]; }

  std::size_t order;
  std::vector<Scalar> entries;
};

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Rows of one session. Their order within [X y] is kept, so each is a row of `table`.
struct SessionRows {
  Index begin, end;
};

/// Data that are ready to be fitted: rows sorted by participant and session, columns [X y] in which X is orthonormal
/// (X = Q R, R kept) and y is the residual of ordinary least squares over its standard deviation.
struct Prepared {
  Matrix table;  // N×(p + 1)
  Vector known;  // N, over scale²; empty where not known
  std::vector<SessionRows> sessions;
  std::vector<std::size_t> first_session;  // of each participant, and one past the last
  Matrix R;                                // p×p
  Vector least_squares;                    // p: β in the columns of Q that y was freed of, in units of scale
  double scale = 1.0;
  int missing = 0;
  bool has_participant = false, has_session = false;
  Matrix means;          // of each session, a row
  RowMajor about;        // N×(p + 1): of each row, less the mean of its session
  Matrix squares_about;  // the sum of their squares

  [[nodiscard]] std::size_t columns() const { return static_cast<std::size_t>(table.cols()) - 1; }
  [[nodiscard]] Index rows() const { return table.rows(); }
  [[nodiscard]] std::size_t participants() const { return first_session.size() - 1; }
};

/// What the variances make of the data: ln det V, XᵀV⁻¹X and the rest as the triangle of [X y]ᵀV⁻¹[X y].
template <class Scalar>
struct Weighted {
  Scalar log_det_V;
  Triangle<Scalar> products;
};

double value_of(double x) {
  return x;
}
template <std::size_t Variables>
double value_of(const Jet<Variables>& x) {
  return x.value;
}
double logarithm(double x) {
  return std::log(x);
}
template <std::size_t Variables>
Jet<Variables> logarithm(const Jet<Variables>& x) {
  return log(x);
}

/// A group of means, each with its weight 1/variance, whose common part has a variance of its own: their squares about
/// their weighted mean are added to `products`.
template <class Scalar>
class CommonPart {
 public:
  explicit CommonPart(std::size_t width) : mean(width, Scalar(0.0)) {}

  void clear() {
    weight = Scalar(0.0);
    std::ranges::fill(mean, Scalar(0.0));
  }
  /// By West's (1979) update, which subtracts nothing that is large.
  template <class Row>
  void add(const Scalar& of_row, const Row& row, Triangle<Scalar>& products) {
    const Scalar total = weight + of_row;
    const Scalar share = of_row / total, spread = weight * share;
    std::vector<Scalar>& step = step_;
    step.resize(mean.size());
    for (std::size_t i = 0; i < mean.size(); ++i) {
      step[i] = row(i) - mean[i];
      mean[i] += share * step[i];
    }
    weight = total;
    if (value_of(spread) == 0.0) return;
    for (std::size_t i = 0; i < mean.size(); ++i) {
      const Scalar scaled = spread * step[i];
      for (std::size_t k = 0; k <= i; ++k) products(i, k) += scaled * step[k];
    }
  }
  Scalar weight = Scalar(0.0);
  std::vector<Scalar> mean;

 private:
  std::vector<Scalar> step_;
};

/// f of a variance, by f and its two derivatives.
double lifted(double /*variance*/, const std::array<double, 3>& f) {
  return f[0];
}
template <std::size_t Variables>
Jet<Variables> lifted(const Jet<Variables>& variance, const std::array<double, 3>& f) {
  return Jet<Variables>::chain(variance, f[0], f[1], f[2]);
}

/// The rows of one session, each with a weight 1/(known + σ_e²): their weight and weighted mean, and what is added to
/// the products and to ln det V. All depends on one variance, by which it is derived in plain numbers. The sums are
/// about the plain mean, so that nothing large is subtracted.
template <class Scalar>
class SessionSums {
 public:
  explicit SessionSums(std::size_t width) : mean(width, Scalar(0.0)), first_(width), second_(width * (width + 1) / 2) {}

  void add(const Prepared& data, std::size_t s, const Scalar& residual, Triangle<Scalar>& products, Scalar& log_det_V) {
    constexpr std::size_t kOrders = std::is_same_v<Scalar, double> ? 1 : 3;
    const std::size_t width = mean.size();
    std::array<double, 3> total{}, logarithms{};
    std::ranges::fill(first_, std::array<double, 3>{});
    std::ranges::fill(second_, std::array<double, 3>{});
    const auto [begin, end] = data.sessions[s];
    for (Index r = begin; r < end; ++r) {
      const double variance = value_of(residual) + data.known[r], x = 1.0 / variance;
      const std::array<double, 3> weights = {x, -x * x, 2.0 * x * x * x};
      logarithms[0] += std::log(variance);
      logarithms[1] += weights[0];
      logarithms[2] += weights[1];
      const double* row = &data.about(r, 0);
      for (std::size_t order = 0; order < kOrders; ++order) {
        total[order] += weights[order];
        for (std::size_t i = 0, at = 0; i < width; ++i) {
          const double weighted_entry = weights[order] * row[i];
          first_[i][order] += weighted_entry;
          for (std::size_t k = 0; k <= i; ++k, ++at) second_[at][order] += weighted_entry * row[k];
        }
      }
    }
    log_det_V += lifted(residual, logarithms);
    weight = lifted(residual, total);
    const Scalar inverse = Scalar(1.0) / weight;
    for (std::size_t i = 0, at = 0; i < width; ++i) {
      const Scalar off = lifted(residual, first_[i]) * inverse;
      mean[i] = off;
      for (std::size_t k = 0; k <= i; ++k, ++at) {
        products(i, k) += lifted(residual, second_[at]) - weight * off * mean[k];
      }
    }
    for (std::size_t i = 0; i < width; ++i) mean[i] += Scalar(data.means(static_cast<Index>(s), static_cast<Index>(i)));
  }

  Scalar weight = Scalar(0.0);
  std::vector<Scalar> mean;

 private:
  std::vector<std::array<double, 3>> first_, second_;
};

/// The weight of a mean once what its values have in common varies too, and what that adds to ln det V.
template <class Scalar>
Scalar shrunk(const Scalar& weight, const Scalar& variance, Scalar& log_det_V) {
  const Scalar inflation = Scalar(1.0) + variance * weight;
  log_det_V += logarithm(inflation);
  return weight / inflation;
}

/// [X y]ᵀV⁻¹[X y] and ln det V of V = D + σ_s² Z_s Z_sᵀ + σ_p² Z_p Z_pᵀ, D = diag(known + σ_e²). Everything is a sum of
/// squares: within sessions, of their means about the participant's, and of the participants' own.
template <class Scalar>
Weighted<Scalar> weighted(const Prepared& data, const std::array<Scalar, 3>& variances) {
  const std::size_t width = data.columns() + 1;
  Weighted<Scalar> result{Scalar(0.0), Triangle<Scalar>(width)};
  SessionSums<Scalar> session(width);
  CommonPart<Scalar> participant(width);
  const bool equal = data.known.size() == 0;
  const Scalar one_over = equal ? Scalar(1.0) / variances[kResidual] : Scalar(0.0);
  if (equal) {
    for (std::size_t i = 0; i < width; ++i) {
      for (std::size_t k = 0; k <= i; ++k) {
        result.products(i, k) += one_over * data.squares_about(static_cast<Index>(i), static_cast<Index>(k));
      }
    }
    result.log_det_V += logarithm(variances[kResidual]) * static_cast<double>(data.rows());
  }
  for (std::size_t p = 0; p < data.participants(); ++p) {
    participant.clear();
    for (std::size_t s = data.first_session[p]; s < data.first_session[p + 1]; ++s) {
      if (equal) {
        const auto [begin, end] = data.sessions[s];
        const Scalar weight =
            shrunk(one_over * static_cast<double>(end - begin), variances[kSession], result.log_det_V);
        const auto row = [&](std::size_t i) { return data.means(static_cast<Index>(s), static_cast<Index>(i)); };
        participant.add(weight, row, result.products);
        continue;
      }
      session.add(data, s, variances[kResidual], result.products, result.log_det_V);
      const Scalar weight = shrunk(session.weight, variances[kSession], result.log_det_V);
      participant.add(
          weight, [&](std::size_t i) { return session.mean[i]; }, result.products);
    }
    const Scalar weight = shrunk(participant.weight, variances[kParticipant], result.log_det_V);
    for (std::size_t i = 0; i < width; ++i) {
      const Scalar scaled = weight * participant.mean[i];
      for (std::size_t k = 0; k <= i; ++k) result.products(i, k) += scaled * participant.mean[k];
    }
  }
  return result;
}

/// Cholesky factor in place of a positive definite triangle, without square roots: L (unit, below) and the pivots.
/// @returns false where a pivot of the first `order` is not positive
template <class Scalar>
bool factor(Triangle<Scalar>& matrix, std::size_t order) {
  for (std::size_t k = 0; k < order; ++k) {
    if (!(value_of(matrix(k, k)) > 0.0)) return false;
    for (std::size_t i = k + 1; i < matrix.order; ++i) {
      const Scalar multiplier = matrix(i, k) / matrix(k, k);
      for (std::size_t j = k + 1; j <= i; ++j) matrix(i, j) -= multiplier * matrix(j, k);
    }
    for (std::size_t i = k + 1; i < matrix.order; ++i) matrix(i, k) = matrix(i, k) / matrix(k, k);
  }
  return true;
}

/// −2 ln L_R without constants, of the prepared data, and the residual sum of squares yᵀPy in it.
template <class Scalar>
struct Criterion {
  Scalar value;
  Scalar squares;
};

/// @param profiled  the residual variance is 1 in `variances`, and what it should be is found in closed form
template <class Scalar>
Criterion<Scalar> criterion(const Prepared& data, const std::array<Scalar, 3>& variances, bool profiled) {
  Weighted<Scalar> all = weighted(data, variances);
  const std::size_t p = data.columns();
  Triangle<Scalar>& factors = all.products;
  if (!factor(factors, p)) return {Scalar(kInfinity), Scalar(kInfinity)};
  Scalar total = all.log_det_V;
  for (std::size_t i = 0; i < p; ++i) total += logarithm(factors(i, i));
  const Scalar squares = factors(p, p);
  if (!(value_of(squares) > 0.0)) return {Scalar(kInfinity), Scalar(kInfinity)};
  const auto degrees = static_cast<double>(data.rows()) - static_cast<double>(p);
  total += profiled ? degrees * logarithm(squares) : squares;
  return {total, squares};
}

/// How near to the minimum of −2 ln L a search ends.
constexpr double kOfFit = 1e-12, kOfProfile = 1e-7;

/// The function to be made small: of `count` variables that are 0 or more.
struct Objective {
  std::size_t count = 0;
  std::function<double(const Point<double>&)> value;
  std::function<Derivatives(const Point<double>&)> jet;
};

struct Minimum {
  Point<double> at{};
  double value = kInfinity;
};

/// Where the slope at 0 is not negative, that is a minimum over the variable.
bool held_at_zero(double x, double slope) {
  return x == 0.0 && slope >= 0.0;
}

/// A step of the variables that are free, in their logarithms, by the Hessian with the absolute values of its
/// eigenvalues, no longer than e³ in any of them.
Point<double> step_of(const Objective& objective, const Point<double>& at, const Derivatives& jet, double& slope) {
  Point<double> step{};
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < objective.count; ++i) {
    if (at[i] > 0.0) free.push_back(i);
  }
  slope = 0.0;
  if (free.empty()) return step;
  const auto n = static_cast<Index>(free.size());
  Vector gradient(n);
  Matrix hessian(n, n);
  for (Index i = 0; i < n; ++i) {
    const std::size_t a = free[static_cast<std::size_t>(i)];
    gradient[i] = at[a] * jet.gradient[a];
    for (Index k = 0; k < n; ++k) {
      const std::size_t b = free[static_cast<std::size_t>(k)];
      hessian(i, k) = at[a] * at[b] * jet.second(a, b) + (i == k ? gradient[i] : 0.0);
    }
  }
  const auto [values, vectors] = numeric::symmetric_eigen(hessian);
  const double largest = values.cwiseAbs().maxCoeff();
  Vector curvature = values.cwiseAbs().cwiseMax(1e-8 * largest).cwiseMax(1e-12);
  Vector move = -(vectors * (vectors.transpose() * gradient).cwiseQuotient(curvature));
  const double longest = move.cwiseAbs().maxCoeff();
  constexpr double kLongest = 3.0;
  if (longest > kLongest) move *= kLongest / longest;
  slope = gradient.dot(move);
  for (Index i = 0; i < n; ++i) step[free[static_cast<std::size_t>(i)]] = move[i];
  return step;
}

/// The best of a grid in which each variable is 0 or one of some powers of ten.
Minimum on_grid(const Objective& objective) {
  constexpr std::array kLevels = {0.0, 0.03, 0.3, 3.0, 30.0};
  Minimum best;
  std::size_t points = 1;
  for (std::size_t i = 0; i < objective.count; ++i) points *= kLevels.size();
  for (std::size_t index = 0; index < points; ++index) {
    Point<double> at{};
    std::size_t rest = index;
    for (std::size_t i = 0; i < objective.count; ++i) {
      at[i] = kLevels[rest % kLevels.size()];
      rest /= kLevels.size();
    }
    const double value = objective.value(at);
    if (value < best.value) best = {at, value};
  }
  return best;
}

/// Newton's method in the logarithms of the variables; a variable goes to 0 where that is better and the slope there
/// keeps it, and leaves it where the slope says so. It begins at `start`, or, where
/// that has no likelihood, at the best point of a grid, and ends
/// where a step promises less than `tolerance`.
Minimum minimum_from(const Objective& objective, const Point<double>& start, double tolerance) {
  Minimum best{start, objective.value(start)};
  if (!std::isfinite(best.value)) best = on_grid(objective);
  if (objective.count == 0 || !std::isfinite(best.value)) return best;
  constexpr int kIterations = 200;
  constexpr double kTiny = 1e-10;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Derivatives jet = objective.jet(best.at);
    bool moved = false;
    for (std::size_t i = 0; i < objective.count; ++i) {  // to 0, and from it
      auto at = best.at;
      if (at[i] > 0.0 && jet.gradient[i] > 0.0 &&
          (at[i] < kTiny || (jet.second(i, i) > 0.0 && at[i] < jet.gradient[i] / jet.second(i, i)))) {
        at[i] = 0.0;
      } else if (at[i] == 0.0 && !held_at_zero(at[i], jet.gradient[i])) {
        at[i] = jet.second(i, i) > 0.0 ? -jet.gradient[i] / jet.second(i, i) : 1e-2;
      } else {
        continue;
      }
      double value = objective.value(at);
      for (int halving = 0; halving < 40 && at[i] > 0.0 && !(value < best.value); ++halving) {
        at[i] *= 0.25;
        value = objective.value(at);
      }
      if (value < best.value) {
        best = {at, value};
        moved = true;
        break;
      }
    }
    if (moved) continue;
    double slope = 0.0;
    const auto step = step_of(objective, best.at, jet, slope);
    if (-slope < tolerance) break;
    double length = 1.0;
    for (int halving = 0; halving < 40; ++halving, length *= 0.5) {
      auto at = best.at;
      for (std::size_t i = 0; i < objective.count; ++i) at[i] *= std::exp(length * step[i]);
      const double value = objective.value(at);
      if (value < best.value) {
        best = {at, value};
        moved = true;
        break;
      }
    }
    if (!moved) break;
  }
  return best;
}

/// Value and derivatives of `function` by the first `Variables` entries of `at`; it depends on no others.
template <std::size_t Variables, class Function>
Derivatives derivatives(const Function& function, const Point<double>& at) {
  Point<Jet<Variables>> jets;
  for (std::size_t i = 0; i < Variables; ++i) jets[i] = Jet<Variables>::variable(at[i], i);
  const Jet<Variables> found = function(jets);
  Derivatives all(found.value);  // the triangle of a few variables begins that of all
  std::ranges::copy(found.gradient, all.gradient.begin());
  std::ranges::copy(found.hessian, all.hessian.begin());
  return all;
}

/// An objective from a template that takes doubles or jets.
template <class Function>
Objective objective_of(std::size_t count, const Function& function) {
  return {count, [function](const Point<double>& at) { return function(at); },
          [function, count](const Point<double>& at) {
            if (count == 1) return derivatives<1>(function, at);
            if (count == 2) return derivatives<2>(function, at);
            return derivatives<3>(function, at);
          }};
}

Result<void> check_shapes(const Measurements& m) {
  const Index rows = m.values.size();
  const auto as_many = [&](std::size_t count) { return static_cast<Index>(count) == rows; };
  if (!as_many(m.participants.size()) || !as_many(m.sessions.size()) || m.fixed.rows() != rows ||
      (m.known_variance.size() > 0 && m.known_variance.size() != rows)) {
    return bad_data(fmt::format("{} values, {} participants, {} sessions, {} rows of X and {} known variances", rows,
                                m.participants.size(), m.sessions.size(), m.fixed.rows(), m.known_variance.size()),
                    "give the same number of each; known variances may be omitted");
  }
  for (Index i = 0; i < rows; ++i) {
    if (std::isnan(m.values[i])) continue;
    if (!std::isfinite(m.values[i]))
      return bad_data(fmt::format("value {} is infinite", i + 1), "write NaN where it is missing");
    if (!m.fixed.row(i).allFinite()) {
      return bad_data(fmt::format("row {} of X is not finite", i + 1), "omit rows whose condition is unknown");
    }
    if (m.known_variance.size() > 0 && !(m.known_variance[i] >= 0.0 && std::isfinite(m.known_variance[i]))) {
      return bad_data(fmt::format("known variance {} is {:g}", i + 1, m.known_variance[i]),
                      "give a variance of 0 or more");
    }
  }
  return {};
}

/// Rows that are there, by participant and session.
std::vector<Index> sorted_rows(const Measurements& m) {
  std::vector<Index> rows;
  for (Index i = 0; i < m.values.size(); ++i) {
    if (!std::isnan(m.values[i])) rows.push_back(i);
  }
  const auto whose = [&](Index i) {
    const auto k = static_cast<std::size_t>(i);
    return std::pair(m.participants[k], m.sessions[k]);
  };
  if (!std::ranges::is_sorted(rows, {}, whose)) std::ranges::stable_sort(rows, {}, whose);
  return rows;
}

std::string name_of(const Measurements& m, Index column) {
  const auto k = static_cast<std::size_t>(column);
  return k < m.names.size() ? fmt::format("'{}'", m.names[k]) : fmt::format("column {}", column + 1);
}

/// X = Q R by modified Gram–Schmidt, twice, so that a column that depends on those before it is seen and named.
Result<Matrix> orthonormal(const Measurements& m, Matrix& X) {
  Matrix R = Matrix::Zero(X.cols(), X.cols());
  for (Index k = 0; k < X.cols(); ++k) {
    const double length = X.col(k).norm();
    for (int pass = 0; pass < 2; ++pass) {
      for (Index j = 0; j < k; ++j) {
        const double along = X.col(j).dot(X.col(k));
        R(j, k) += along;
        X.col(k) -= along * X.col(j);
      }
    }
    R(k, k) = X.col(k).norm();
    constexpr double kDependent = 1e-10;
    if (!(R(k, k) > kDependent * length)) {
      return bad_data(fmt::format("the fixed effect {} depends on those before it", name_of(m, k)),
                      "omit it: these data cannot distinguish it from them");
    }
    X.col(k) /= R(k, k);
  }
  return R;
}

Result<Prepared> prepare(const Measurements& m) {
  MBK_TRY(check_shapes(m));
  const std::vector<Index> rows = sorted_rows(m);
  const auto count = static_cast<Index>(rows.size());
  const Index p = m.fixed.cols();
  if (count <= p) {
    return bad_data(fmt::format("{} values are too few for {} fixed effects", count, p),
                    "measure more, or request fewer effects");
  }
  Prepared data;
  data.missing = static_cast<int>(m.values.size() - count);
  data.table.resize(count, p + 1);
  if (m.known_variance.size() > 0) data.known.resize(count);
  for (Index r = 0; r < count; ++r) {
    const Index i = rows[static_cast<std::size_t>(r)];
    const auto k = static_cast<std::size_t>(i);
    data.table.row(r) << m.fixed.row(i), m.values[i];
    if (data.known.size() > 0) data.known[r] = m.known_variance[i];
    const auto before = r > 0 ? static_cast<std::size_t>(rows[static_cast<std::size_t>(r - 1)]) : k;
    const bool new_person = r == 0 || m.participants[k] != m.participants[before];
    if (new_person) data.first_session.push_back(data.sessions.size());
    if (new_person || m.sessions[k] != m.sessions[before]) data.sessions.push_back({r, r});
    data.sessions.back().end = r + 1;
  }
  const std::size_t people = data.first_session.size();
  data.first_session.push_back(data.sessions.size());
  if (people < 2) return bad_data(fmt::format("only {} participant has values", people), "measure two or more");
  data.has_session = data.sessions.size() < rows.size() && people < data.sessions.size();
  data.has_participant = people < rows.size();

  Matrix X = data.table.leftCols(p);
  auto R = MBK_TRY(orthonormal(m, X));
  data.R = std::move(R);
  Vector y = data.table.col(p);
  data.least_squares = Vector::Zero(p);
  const double size = y.norm();
  for (int pass = 0; pass < 2; ++pass) {
    const Vector along = X.transpose() * y;
    data.least_squares += along;
    y -= X * along;
  }
  data.scale = y.norm() / std::sqrt(static_cast<double>(count - p));
  constexpr double kRounding = 1e-13;
  if (!(data.scale > kRounding * size / std::sqrt(static_cast<double>(count)))) {
    return bad_data("the values do not vary beyond what the fixed effects explain", "check that they were not copied");
  }
  data.least_squares /= data.scale;
  if (data.known.size() > 0) data.known /= data.scale * data.scale;
  data.table << X, y / data.scale;

  data.means.resize(static_cast<Index>(data.sessions.size()), p + 1);
  data.about.resize(count, p + 1);
  for (std::size_t s = 0; s < data.sessions.size(); ++s) {
    const auto [begin, end] = data.sessions[s];
    const auto block = data.table.middleRows(begin, end - begin);
    data.means.row(static_cast<Index>(s)) = block.colwise().mean();
    data.about.middleRows(begin, end - begin) = block.rowwise() - data.means.row(static_cast<Index>(s));
  }
  data.squares_about = data.about.transpose() * data.about;
  return data;
}

/// Which variances there are, in the order of the objective's variables: participant, session, and the residual where
/// it is not profiled.
struct Parameters {
  bool participant, session, residual;

  template <class Scalar>
  [[nodiscard]] std::array<Scalar, 3> variances(const Point<Scalar>& at) const {
    std::size_t next = 0;
    std::array<Scalar, 3> all = {Scalar(0.0), Scalar(0.0), Scalar(1.0)};
    if (participant) all[kParticipant] = at[next++];
    if (session) all[kSession] = at[next++];
    if (residual) all[kResidual] = at[next++];
    return all;
  }
  [[nodiscard]] std::size_t count() const {
    return (participant ? 1U : 0U) + (session ? 1U : 0U) + (residual ? 1U : 0U);
  }
};

bool profiled(const Prepared& data) {
  return data.known.size() == 0;
}

/// Variances [scaled] at the maximum of the likelihood, and −2 ln of it without constants.
struct Fitted {
  std::array<double, 3> variances{};
  double value = 0.0;
};

Result<Fitted> fitted(const Prepared& data) {
  const Parameters parameters{data.has_participant, data.has_session, !profiled(data)};
  const auto function = [&]<class Scalar>(const Point<Scalar>& at) {
    return criterion(data, parameters.variances(at), profiled(data)).value;
  };
  const Objective objective = objective_of(parameters.count(), function);
  const Minimum minimum = minimum_from(objective, on_grid(objective).at, kOfFit);
  Fitted result{parameters.variances(minimum.at), minimum.value};
  const auto degrees = static_cast<double>(data.rows()) - static_cast<double>(data.columns());
  if (profiled(data) && std::isfinite(minimum.value)) {
    const double residual = criterion(data, result.variances, true).squares / degrees;
    for (double& one : result.variances) one *= residual;
  }
  constexpr double kNoResidual = 1e-14;
  if (!std::isfinite(minimum.value) || (profiled(data) && result.variances[kResidual] < kNoResidual)) {
    return bad_data("nothing varies within sessions and people",
                    "check that values were not copied from one trial to the others");
  }
  return result;
}

/// The inverse of a triangle of jets that factor() has made L D Lᵀ of, its first `order` rows; full.
std::vector<std::vector<Derivatives>> inverse_of(const Triangle<Derivatives>& factors, std::size_t order) {
  std::vector<std::vector<Derivatives>> inverse(order, std::vector<Derivatives>(order));
  for (std::size_t column = 0; column < order; ++column) {
    std::vector<Derivatives>& x = inverse[column];
    x[column] = Derivatives(1.0);
    for (std::size_t i = 0; i < order; ++i) {
      for (std::size_t k = 0; k < i; ++k) x[i] -= factors(i, k) * x[k];
    }
    for (std::size_t i = 0; i < order; ++i) x[i] = x[i] / factors(i, i);
    for (std::size_t i = order; i-- > 0;) {
      for (std::size_t k = i + 1; k < order; ++k) x[i] -= factors(k, i) * x[k];
    }
  }
  return inverse;
}

/// Deviance, coefficients and all their derivatives at the fitted variances, unscaled.
MixedModel summarised(const Prepared& data, const Fitted& fit) {
  const std::size_t p = data.columns();
  const auto order = static_cast<Index>(p);
  const double scale2 = data.scale * data.scale;
  MixedModel model;
  model.participants = static_cast<int>(data.participants());
  model.sessions = static_cast<int>(data.sessions.size());
  model.rows = static_cast<int>(data.rows());
  model.missing = data.missing;
  if (data.known.size() > 0) model.typical_known_variance = scale2 * data.known.mean();
  const std::array<VarianceComponent*, 3> components = {&model.participant, &model.session, &model.residual};
  const std::array present = {data.has_participant, data.has_session, true};

  std::vector<std::size_t> free;
  std::array<Derivatives, 3> variances;
  for (std::size_t i = 0; i < 3; ++i) {
    components[i]->present = present[i];
    components[i]->value = scale2 * fit.variances[i];
    variances[i] = Derivatives::variable(fit.variances[i], i);
    if (fit.variances[i] > 0.0) free.push_back(i);
  }
  const Derivatives deviance = criterion(data, variances, false).value;
  Weighted<Derivatives> all = weighted(data, variances);
  factor(all.products, p);
  const double degrees = static_cast<double>(data.rows()) - static_cast<double>(p);
  model.deviance = deviance.value + degrees * std::log(2.0 * std::numbers::pi * scale2) +
                   2.0 * data.R.diagonal().array().abs().log().sum();

  const auto n = static_cast<Index>(free.size());
  Matrix information(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index k = 0; k < n; ++k) {
      information(i, k) = 0.5 * deviance.second(free[static_cast<std::size_t>(i)], free[static_cast<std::size_t>(k)]);
    }
  }
  const numeric::Cholesky cholesky(information);
  const bool informed = n > 0 && cholesky.positive_definite();
  if (informed) {
    model.variance_covariance = scale2 * scale2 * cholesky.solve(Matrix::Identity(n, n));
    for (Index i = 0; i < n; ++i) {
      components[free[static_cast<std::size_t>(i)]]->standard_error = std::sqrt(model.variance_covariance(i, i));
    }
  }

  // β = β_ols + (XᵀV⁻¹X)⁻¹XᵀV⁻¹y, in the columns of Q; back by R⁻¹
  Vector beta = Vector::Zero(order);
  for (std::size_t i = p; i-- > 0;) {
    beta[static_cast<Index>(i)] = all.products(p, i).value;
    for (std::size_t k = i + 1; k < p; ++k) {
      beta[static_cast<Index>(i)] -= all.products(k, i).value * beta[static_cast<Index>(k)];
    }
  }
  const auto R = data.R.triangularView<Eigen::Upper>();
  beta = R.solve(data.scale * (beta + data.least_squares));
  const auto inverse = inverse_of(all.products, p);
  const auto back = [&](const std::function<double(const Derivatives&)>& part, double factor) {
    Matrix one(order, order);
    for (Index i = 0; i < order; ++i) {
      for (Index k = 0; k < order; ++k) {
        one(i, k) = factor * part(inverse[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)]);
      }
    }
    const Matrix half = R.solve(one);
    return Matrix(R.solve(half.transpose()));
  };
  model.covariance = back([](const Derivatives& jet) { return jet.value; }, scale2);
  if (informed) {
    for (const std::size_t i : free) {
      model.covariance_gradient.push_back(back([i](const Derivatives& jet) { return jet.gradient[i]; }, 1.0));
    }
  }
  for (Index k = 0; k < order; ++k) {
    model.effects.emplace_back().value = beta[k];
  }
  for (Index k = 0; k < order; ++k) {
    model.effects[static_cast<std::size_t>(k)] = contrast(model, Vector::Unit(order, k));
  }
  return model;
}

/// −2 ln L_R over one function x ≥ 0 of the variances, its minimum over all others: near the one before, so that each
/// search begins where the last one ended.
class Profile {
 public:
  /// @param variances_at  the three variances of x and of the other variables
  /// @param estimate  x and the others where the likelihood has its maximum
  template <class VariancesAt>
  Profile(const Prepared& data, bool profiled, std::size_t others, const VariancesAt& variances_at, double estimate,
          const Point<double>& others_there)
      : estimate_(estimate), last_(others_there) {
    search_ = [&data, profiled, others, variances_at](double x, const Point<double>& start) {
      const auto function = [&]<class Scalar>(const Point<Scalar>& at) {
        return criterion(data, variances_at(x, at), profiled).value;
      };
      return minimum_from(objective_of(others, function), start, kOfProfile);
    };
    minimum_ = search_(estimate, last_).value;
  }

  /// Where it is less than χ² above its minimum.
  Interval interval95() { return {end(-1.0), end(1.0)}; }

 private:
  /// Signed root of what it is above the minimum, less that of χ²: nearly a straight line in ln x.
  double above(double x) {
    const Minimum found = search_(x, last_);
    if (!std::isfinite(found.value)) return kInfinity;
    last_ = found.at;
    return std::sqrt(std::max(found.value - minimum_, 0.0)) - numeric::kNormal95;
  }

  double end(double direction) {
    constexpr double kAlmostNothing = 1e-6, kFarthest = 40.0, kStep = 0.25;
    if (direction < 0.0 && (!(estimate_ > kAlmostNothing) || above(0.0) <= 0.0)) return 0.0;
    double inside = std::log(std::max(estimate_, kAlmostNothing)), f_inside = above(std::exp(inside));
    if (!(f_inside < 0.0)) return std::exp(inside);
    double step = direction * kStep, outside = inside + step, f_outside = above(std::exp(outside));
    while (f_outside < 0.0) {
      if (std::abs(outside) > kFarthest) return direction < 0.0 ? 0.0 : kInfinity;
      inside = outside;
      f_inside = f_outside;
      step *= 1.5;
      outside += step;
      f_outside = above(std::exp(outside));
    }
    // false position with Illinois's halving; by halves where the outer end has no likelihood
    constexpr int kSections = 60;
    constexpr double kNear = 1e-4;
    for (int i = 0; i < kSections && std::abs(outside - inside) > kNear; ++i) {
      const double share = std::isfinite(f_outside) ? f_inside / (f_inside - f_outside) : 0.5;
      const double middle = inside + share * (outside - inside), f = above(std::exp(middle));
      if (std::abs(f) < kNear) return std::exp(middle);
      if (f < 0.0) {
        inside = middle;
        f_inside = f;
        f_outside *= last_moved_ == 1 ? 0.5 : 1.0;
        last_moved_ = 1;
      } else {
        outside = middle;
        f_outside = f;
        f_inside *= last_moved_ == 2 ? 0.5 : 1.0;
        last_moved_ = 2;
      }
    }
    return std::exp(0.5 * (inside + outside));
  }

  std::function<Minimum(double, const Point<double>&)> search_;
  double estimate_ = 0.0, minimum_ = 0.0;
  Point<double> last_{};
  int last_moved_ = 0;  // 1: the inner end, 2: the outer one
};

/// The interval of σ_p²/(σ_p² + σ_s² + (σ_e² + v̄)/m), by its odds.
Interval icc_interval(const Prepared& data, const Fitted& fit, double trials) {
  const double typical = data.known.size() > 0 ? data.known.mean() : 0.0;
  const bool by_ratio = profiled(data);
  const Parameters parameters{false, data.has_session, !by_ratio};
  const auto variances_at = [=]<class Scalar>(double odds, const Point<Scalar>& at) {
    std::array<Scalar, 3> variances = parameters.variances(at);
    variances[kParticipant] = odds * (variances[kSession] + (variances[kResidual] + Scalar(typical)) * (1.0 / trials));
    return variances;
  };
  const double unit = by_ratio ? fit.variances[kResidual] : 1.0;
  const double between = fit.variances[kSession] + (fit.variances[kResidual] + typical) / trials;
  Point<double> others{};
  std::size_t next = 0;
  if (parameters.session) others[next++] = fit.variances[kSession] / unit;
  if (parameters.residual) others[next++] = fit.variances[kResidual] / unit;
  Profile profile(data, by_ratio, parameters.count(), variances_at, fit.variances[kParticipant] / between, others);
  const auto [low, high] = profile.interval95();
  return {low / (1.0 + low), std::isinf(high) ? 1.0 : high / (1.0 + high)};
}

/// The interval of σ_s² + σ_e²/m, without what is known.
Interval between_interval(const Prepared& data, const Fitted& fit, double trials) {
  const bool participant = data.has_participant, session = data.has_session;
  const auto variances_at = [=]<class Scalar>(double between, const Point<Scalar>& at) {
    std::array<Scalar, 3> variances = {Scalar(0.0), Scalar(0.0), Scalar(trials * between)};
    std::size_t next = 0;
    if (participant) variances[kParticipant] = at[next++];
    if (!session) return variances;
    const Scalar whole = Scalar(1.0) + at[next];  // the other one is the odds of the session's part
    variances[kSession] = Scalar(between) * at[next] / whole;
    variances[kResidual] = Scalar(trials * between) / whole;
    return variances;
  };
  Point<double> others{};
  std::size_t next = 0;
  if (participant) others[next++] = fit.variances[kParticipant];
  constexpr double kLargeOdds = 1e3;
  const double residual = fit.variances[kResidual] / trials;
  if (session) {
    others[next++] = std::min(kLargeOdds, fit.variances[kSession] / std::max(residual, 1e-300));
  }
  return Profile(data, false, next, variances_at, fit.variances[kSession] + residual, others).interval95();
}

/// The interval of σ_e², without what is known.
Interval residual_interval(const Prepared& data, const Fitted& fit) {
  const Parameters parameters{data.has_participant, data.has_session, false};
  const auto variances_at = [=]<class Scalar>(double residual, const Point<Scalar>& at) {
    std::array<Scalar, 3> variances = parameters.variances(at);
    variances[kResidual] = Scalar(residual);
    return variances;
  };
  Point<double> others{};
  std::size_t next = 0;
  if (parameters.participant) others[next++] = fit.variances[kParticipant];
  if (parameters.session) others[next++] = fit.variances[kSession];
  return Profile(data, false, parameters.count(), variances_at, fit.variances[kResidual], others).interval95();
}

ModelReliability without_numbers(Support support, int trials) {
  ModelReliability result;
  result.support = support;
  result.trials = trials;
  result.icc = result.sem_between = result.sem_within = result.mdc95_between = result.mdc95_within = kNaN;
  result.icc95 = {0.0, 1.0};
  result.sem_between95 = result.sem_within95 = {0.0, kInfinity};
  return result;
}

/// Of the mean of so many trials.   @param of_residual  the interval of σ_e²
ModelReliability reliability_of_mean(const Prepared& data, const Fitted& fit, const MixedModel& model,
                                     const Interval& of_residual, int trials) {
  const bool separable = separates_sessions_from_trials(model);
  if (!separable && trials > 1) return without_numbers(Support::too_few_trials, trials);
  ModelReliability result;
  result.trials = trials;
  const double m = trials;
  const double within = (model.residual.value + model.typical_known_variance) / m;
  const double between = model.session.value + within;
  result.icc = model.participant.value / (model.participant.value + between);
  result.sem_within = std::sqrt(within);
  result.sem_between = std::sqrt(between);
  result.mdc95_within = kPublishedNormal95 * std::numbers::sqrt2 * result.sem_within;
  result.mdc95_between = kPublishedNormal95 * std::numbers::sqrt2 * result.sem_between;
  const double scale2 = data.scale * data.scale;
  const auto root = [&](double variance) { return std::sqrt(scale2 * variance + model.typical_known_variance / m); };
  const Interval of_between = between_interval(data, fit, m);
  result.sem_between95 = widened_for_tails(result.sem_between, {root(of_between.first), root(of_between.second)});
  result.sem_within95 =
      widened_for_tails(result.sem_within, {root(of_residual.first / m), root(of_residual.second / m)});
  result.icc95 = icc_interval(data, fit, m);
  if (!separable) {
    result.sem_within = result.mdc95_within = kNaN;
    result.sem_within95 = {kNaN, kNaN};
  }
  return result;
}

}  // namespace

Result<MixedModel> fit_mixed_model(const Measurements& measurements) {
  const auto data = MBK_TRY(prepare(measurements));
  const auto fit = MBK_TRY(fitted(data));
  return summarised(data, fit);
}

bool separates_sessions_from_trials(const MixedModel& model) {
  return model.rows - model.sessions >= kMinPeople;
}

FixedEffect contrast(const MixedModel& model, const Vector& weights) {
  FixedEffect effect;
  for (Index k = 0; k < weights.size(); ++k)
    effect.value += weights[k] * model.effects[static_cast<std::size_t>(k)].value;
  const double variance = weights.dot(model.covariance * weights);
  effect.standard_error = std::sqrt(variance);
  const auto n = static_cast<Index>(model.covariance_gradient.size());
  Vector gradient(n);
  for (Index i = 0; i < n; ++i) {
    gradient[i] = weights.dot(model.covariance_gradient[static_cast<std::size_t>(i)] * weights);
  }
  const double of_variance = n > 0 ? gradient.dot(model.variance_covariance * gradient) : 0.0;
  const bool estimated = model.participant.value > 0.0 || model.session.value > 0.0 || model.residual.value > 0.0;
  // No information on the variances: as few degrees of freedom as the people leave.
  const double fewest = std::max<double>(1.0, model.participants - static_cast<double>(weights.size()));
  effect.degrees_of_freedom = of_variance > 0.0 ? 2.0 * variance * variance / of_variance
                              : estimated       ? fewest
                                                : kInfinity;
  const double reach = numeric::student_quantile(1.0 - kTail95, effect.degrees_of_freedom) * effect.standard_error;
  effect.interval95 = {effect.value - reach, effect.value + reach};
  effect.p = numeric::student_two_sided(effect.value / effect.standard_error, effect.degrees_of_freedom);
  return effect;
}

Result<ModelReliability> model_reliability(const Measurements& measurements, int trials) {
  auto fitted_once = MBK_TRY(fit_reliability(measurements, {&trials, 1}));
  return fitted_once.of_trials.front();
}

Result<FittedReliability> fit_reliability(const Measurements& measurements, std::span<const int> trials) {
  for (const int one : trials) {
    if (one < 1) return bad_usage(fmt::format("there is no mean of {} trials", one), "request at least 1");
  }
  const auto data = MBK_TRY(prepare(measurements));
  FittedReliability result;
  Support support = Support::enough;
  if (data.participants() < static_cast<std::size_t>(kMinPeople)) {
    support = Support::too_few_people;
  } else if (data.sessions.size() == data.participants()) {
    support = Support::too_few_sessions;
  }
  if (support != Support::enough) {
    for (const int one : trials) result.of_trials.push_back(without_numbers(support, one));
    return result;
  }
  const auto fit = MBK_TRY(fitted(data));
  result.model = summarised(data, fit);
  const Interval of_residual = residual_interval(data, fit);
  for (const int one : trials) {
    result.of_trials.push_back(reliability_of_mean(data, fit, *result.model, of_residual, one));
  }
  return result;
}

}  // namespace mbk::reliability
