#include "mbk/measure/identify/prediction_error.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "mbk/base/dsp/autoregression.h"
#include "mbk/base/dsp/difference_equation.h"
#include "mbk/base/numeric/column_products.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/base/numeric/polynomial_roots.h"
#include "mbk/base/numeric/row_triangle.h"
#include "mbk/measure/identify/srivc.h"

namespace mbk::identify {
namespace {

using dsp::difference_equation;

const Vector kOne = Vector::Ones(1);

/// 1, c₁ … c_n.
Vector monic(const Vector& c) {
  Vector whole(c.size() + 1);
  whole << 1.0, c;
  return whole;
}

/// Whether 1 + c₁ q⁻¹ + … has its roots inside the unit circle, by Levinson's recursion backwards (Schur & Cohn).
bool is_stable(Vector c) {
  for (Index n = c.size(); n > 0; --n) {
    const double reflection = c[n - 1];
    if (!(std::abs(reflection) < 1.0)) return false;
    c = ((c.head(n - 1) - reflection * c.head(n - 1).reverse()) / (1.0 - reflection * reflection)).eval();
  }
  return true;
}

Vector from_roots(const Eigen::VectorXcd& roots) {
  return numeric::monic_from_roots(roots).reverse();
}

/// Roots outside the unit circle are reflected into it.
Vector stabilised(const Vector& c) {
  if (!c.allFinite()) return Vector::Zero(c.size());
  if (is_stable(c)) return c;
  constexpr double kInside = 0.9999;
  Eigen::VectorXcd roots = numeric::polynomial_roots(monic(c).reverse());
  for (auto& root : roots) {
    if (std::abs(root) > kInside) root /= std::max(std::norm(root), std::abs(root) / kInside);
  }
  return from_roots(roots);
}

/// Roots near the unit circle are put to a damping ratio from where a search finds another way.
Vector moved_inside(const Vector& f) {
  constexpr double kNear = 0.999, kDamping = 0.1;
  Eigen::VectorXcd roots = numeric::polynomial_roots(monic(f).reverse());
  for (auto& root : roots) {
    if (std::abs(root) > kNear) root *= std::exp(-kDamping * std::abs(std::log(root))) / std::abs(root);
  }
  return from_roots(roots);
}

/// x[t − lag], from rest.
template <class Column>
void put_shifted(const Vector& x, Index lag, double sign, Column&& to) {
  to.head(lag).setZero();
  to.tail(x.size() - lag) = sign * x.head(x.size() - lag);
}

/// The noise model's inverse, C/D.
struct Whitening {
  Vector C, D;
  [[nodiscard]] Vector operator()(const Vector& x) const {
    return C.size() + D.size() == 2 ? x : difference_equation(C, D, x);
  }
};

/// What an initial state and an offset can do, behind a noise model: impulse responses of 1/F from the first samples
/// on, and a constant. Once the responses have died away the constant alone is left, for which the mean stands.
class FreeMotion {
 public:
  FreeMotion(const Vector& F, Index impulses, Index samples, const Whitening& whitened = {kOne, kOne})
      : samples_(samples) {
    const Vector response = whitened(difference_equation(kOne, F, Vector::Unit(samples, 0)));
    const Vector constant = whitened(Vector::Ones(samples));
    const double last = constant[samples - 1];
    const auto lasting = [samples](const auto& x) {
      constexpr double kNothing = 1e-20;  // of its greatest
      const double least = kNothing * x.abs().maxCoeff();
      Index count = samples;
      while (count > 0 && std::abs(x[count - 1]) <= least) --count;
      return count;
    };
    lasting_ = std::max(lasting(response.array()) + impulses, lasting((constant.array() - last).eval()));
    lasting_ = std::min(lasting_, samples);
    Matrix columns(lasting_ + 1, impulses + 1);
    for (Index j = 0; j < impulses; ++j) put_shifted(response.head(lasting_), j, 1.0, columns.col(j).head(lasting_));
    columns.col(impulses).head(lasting_) = constant.head(lasting_);
    columns.row(lasting_).setZero();
    columns(lasting_, impulses) = length_behind() * last;
    qr_.emplace(columns);
  }
  [[nodiscard]] Vector coefficients(const Vector& of) const { return qr_->solve(Vector(shortened(of))); }
  void take_out_of(Eigen::Ref<Matrix> of) const {
    if (of.cols() == 0) return;
    const Matrix all = shortened(of), left = qr_->rest(all);
    of.topRows(lasting_) = left.topRows(lasting_);
    if (const Index behind = samples_ - lasting_; behind > 0) {
      of.bottomRows(behind).rowwise() += (left.row(lasting_) - all.row(lasting_)) / length_behind();
    }
  }

 private:
  /// Of the constant 1 behind the responses.
  [[nodiscard]] double length_behind() const { return std::sqrt(static_cast<double>(samples_ - lasting_)); }
  /// What is behind the responses becomes one row, its share of the direction of the constant.
  [[nodiscard]] Matrix shortened(const Eigen::Ref<const Matrix>& all) const {
    Matrix rows(lasting_ + 1, all.cols());
    rows.topRows(lasting_) = all.topRows(lasting_);
    rows.row(lasting_).setZero();
    if (const Index behind = samples_ - lasting_; behind > 0) {
      rows.row(lasting_) = all.bottomRows(behind).colwise().sum() / length_behind();
    }
    return rows;
  }

  Index samples_, lasting_ = 0;
  std::optional<numeric::PivotedQr> qr_;
};

struct Model {
  Vector f, b, c, d;
};

bool is_stable(const Model& model) {
  return is_stable(model.f) && is_stable(model.c) && is_stable(model.d);
}

/// Coefficients that a search moves, in the order f, b, c, d.
struct Parts {
  bool denominator = false, numerator = false, noise = false;
};
constexpr Parts kDynamics{.denominator = true, .numerator = true};
constexpr Parts kNoise{.noise = true};
constexpr Parts kAll{.denominator = true, .numerator = true, .noise = true};

constexpr int kRefinements = 8;

/// One experiment at a model, free of its initial state and offset.
struct Local {
  Matrix rows;  ///< [∂ε/∂θ, ε]
  Vector residual, innovation;
};

/// Σε² to first order, |R δ + r|² + rest.
struct Linear {
  Matrix R;
  Vector r;
  double squares = std::numeric_limits<double>::infinity();

  /// The least of it and of damping·|s δ|², s the lengths of R's columns.
  [[nodiscard]] Vector step(double damping) const {
    const Index p = R.cols();
    Vector scale = R.colwise().norm();
    for (double& s : scale) s = s > 0.0 ? 1.0 / s : 0.0;
    Matrix scaled(2 * p, p);
    scaled << R * scale.asDiagonal(), std::sqrt(damping) * Matrix::Identity(p, p);
    Vector right = Vector::Zero(2 * p);
    right.head(p) = -r;
    return scale.cwiseProduct(numeric::PivotedQr(scaled).solve(right));
  }
  /// (RᵀR)⁻¹
  [[nodiscard]] Matrix inverse() const {
    const Vector scale = R.colwise().norm().cwiseMax(std::numeric_limits<double>::min()).cwiseInverse();
    const Matrix half = scale.asDiagonal() * numeric::PivotedQr(R * scale.asDiagonal()).inverse();
    return half * half.transpose();
  }
};

/// The least of |X θ − y|, of the triangle of [X, y].
Vector solution_of(const Matrix& triangle) {
  const Index p = triangle.cols() - 1;
  return Linear{triangle.topLeftCorner(p, p), -triangle.col(p).head(p)}.step(0.0);
}

class Fitter {
 public:
  Fitter(const std::vector<SignalPair>& experiments, const PredictionErrorOptions& options)
      : experiments_(experiments), options_(options), n_(options.poles), q_(options.zeros + 1) {}

  Result<PredictionErrorFit> run();

 private:
  struct Search {
    SearchStart start;
    Model at;
    double squares = std::numeric_limits<double>::infinity();
    Matrix R;  ///< of Linear, there
  };
  struct Start {
    std::string made_by;
    Vector f;
  };
  using Signals = std::vector<Vector>;

  [[nodiscard]] Local local(const Model& at, std::size_t experiment, std::optional<Parts> slopes) const;
  [[nodiscard]] Linear linear(const Model& at, Parts parts) const;
  [[nodiscard]] double squares(const Model& at) const;
  [[nodiscard]] Model moved(Model at, Parts parts, const Vector& step) const;
  [[nodiscard]] Vector coefficients(const Model& at, Parts parts) const;
  [[nodiscard]] bool is_apart_from_the_edge(const Vector& f) const;
  /// @param refinements  steps beyond the tolerance, as far as rounding lets them
  void descend(Search& search, Parts parts, int passes, int refinements) const;

  [[nodiscard]] Vector regress(const Vector& filter, const Signals& outputs, const Signals* instruments, Index poles,
                               Index zeros) const;
  [[nodiscard]] Vector long_regression(Index order) const;
  [[nodiscard]] Signals responses(const Vector& theta, Index poles) const;
  /// A model with the best numerator for its f, its Σε², and the f of the next pass.
  struct Sharpening {
    Model at;
    double squares = 0;
    Vector next;
  };
  [[nodiscard]] Sharpening sharpened_once(const Vector& f) const;
  [[nodiscard]] Search sharpened(const Start& start, int passes) const;
  template <class Make>
  [[nodiscard]] Result<std::vector<Search>> each_of(const std::vector<Start>& starts, Make&& make) const;
  [[nodiscard]] Search settled(const Start& start, const Search& sharp, const Vector& noise) const;
  [[nodiscard]] Result<std::vector<Search>> settled(const std::vector<Start>& starts, const std::vector<Search>& sharp,
                                                    const Vector& noise) const;
  [[nodiscard]] bool stand_together(const Search& a, const Search& b) const;
  template <class Same, class GoOn>
  [[nodiscard]] Result<void> go_on_as_one(std::vector<Search>& searches, Same&& are_same, GoOn&& go_on) const;
  [[nodiscard]] Result<std::vector<Search>> with_noise(std::vector<Search> searches, std::vector<Search> white) const;
  [[nodiscard]] ContinuousFitOptions continuous_options() const;
  [[nodiscard]] std::vector<Start> starts(const Vector& rich) const;
  [[nodiscard]] std::vector<Model> noise_models(const Model& at) const;
  void add_noise(Search& search) const;
  [[nodiscard]] static bool is_better(const Search& a, const Search& b);
  void take_covariance(const Model& at, PredictionErrorFit& made) const;
  [[nodiscard]] double fit_of(const Model& at) const;

  const std::vector<SignalPair>& experiments_;
  const PredictionErrorOptions& options_;
  Index n_, q_, samples_ = 0;
  double step_ = 0, output_squares_ = 0;
  Signals outputs_;
};

Local Fitter::local(const Model& at, std::size_t experiment, std::optional<Parts> slopes) const {
  const SignalPair& pair = experiments_[experiment];
  const Index total = pair.output.size();
  const Vector F = monic(at.f), D = monic(at.d);
  const Whitening whitened{monic(at.c), D};
  Vector response = difference_equation(at.b, F, pair.input);
  Local made;
  made.residual = pair.output - response;
  std::optional<FreeMotion> free;
  if (options_.free_start) {
    free.emplace(F, n_, total, whitened);
    const Vector motion = free->coefficients(whitened(made.residual));
    response += difference_equation(motion.head(n_), F, Vector::Unit(total, 0));
    made.residual = (pair.output - response).array() - motion[n_];
  }
  made.innovation = whitened(made.residual);
  if (!slopes) return made;
  const Index f = slopes->denominator ? n_ : 0, b = slopes->numerator ? q_ : 0;
  const Index c = slopes->noise ? at.c.size() : 0, d = slopes->noise ? at.d.size() : 0;
  made.rows.resize(total, f + b + c + d + 1);
  if (f > 0) response = whitened(difference_equation(kOne, F, response));
  for (Index k = 0; k < f; ++k) put_shifted(response, k + 1, 1.0, made.rows.col(k));
  const Vector input = b > 0 ? whitened(difference_equation(kOne, F, pair.input)) : Vector();
  for (Index k = 0; k < b; ++k) put_shifted(input, k, -1.0, made.rows.col(f + k));
  const Vector v = c > 0 ? difference_equation(kOne, D, made.residual) : Vector();
  const Vector e = d > 0 ? difference_equation(kOne, D, made.innovation) : Vector();
  for (Index k = 0; k < c; ++k) put_shifted(v, k + 1, 1.0, made.rows.col(f + b + k));
  for (Index k = 0; k < d; ++k) put_shifted(e, k + 1, -1.0, made.rows.col(f + b + c + k));
  if (free) free->take_out_of(made.rows.leftCols(f + b + c + d));
  made.rows.rightCols(1) = made.innovation;
  return made;
}

Linear Fitter::linear(const Model& at, Parts parts) const {
  const Index p = coefficients(at, parts).size();
  numeric::RowTriangle triangle(p + 1);
  double squares = 0.0;
  for (std::size_t k = 0; k < experiments_.size(); ++k) {
    const Local one = local(at, k, parts);
    squares += one.innovation.squaredNorm();
    triangle.add(one.rows);
  }
  return {triangle.R().topLeftCorner(p, p), triangle.R().col(p).head(p), squares};
}

double Fitter::squares(const Model& at) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < experiments_.size(); ++k) sum += local(at, k, std::nullopt).innovation.squaredNorm();
  return sum;
}

Model Fitter::moved(Model at, Parts parts, const Vector& step) const {
  Index begin = 0;
  const auto move = [&](Vector& some, bool moves) {
    if (!moves) return;
    some += step.segment(begin, some.size());
    begin += some.size();
  };
  move(at.f, parts.denominator);
  move(at.b, parts.numerator);
  move(at.c, parts.noise);
  move(at.d, parts.noise);
  return at;
}

Vector Fitter::coefficients(const Model& at, Parts parts) const {
  const Vector none;
  const Vector &f = parts.denominator ? at.f : none, &b = parts.numerator ? at.b : none;
  const Vector &c = parts.noise ? at.c : none, &d = parts.noise ? at.d : none;
  Vector theta(f.size() + b.size() + c.size() + d.size());
  theta << f, b, c, d;
  return theta;
}

/// Whether the slowest motion dies away at all over the record, as far as rounding can tell. At the edge of the stable
/// models it is the offset once more; steps mean nothing there.
bool Fitter::is_apart_from_the_edge(const Vector& f) const {
  constexpr double kMin = 1e-6;
  const double slowest = numeric::polynomial_roots(monic(f).reverse()).cwiseAbs().maxCoeff();
  return (1.0 - slowest) * static_cast<double>(samples_) > kMin;
}

/// Levenberg (1944) & Marquardt (1963), until a full step of Gauss & Newton would hardly move a coefficient, and then
/// on to rounding. Output error, whose starts are sharpened, begins with a full step.
void Fitter::descend(Search& search, Parts parts, int passes, int refinements) const {
  constexpr double kFirstDamping = 1e-3, kMinDamping = 1e-9, kMaxDamping = 1e12, kLess = 0.1, kMore = 3.0;
  constexpr double kRounding = 1e-11;
  constexpr double kExact = 1e-22;  // of the output's squares: nothing is left but rounding
  const bool white = !parts.noise && search.at.c.size() == 0 && search.at.d.size() == 0;
  double damping = white ? 0.0 : kFirstDamping;
  SearchStart& start = search.start;
  start.converged = false;
  start.stable = true;
  Linear now = linear(search.at, parts);
  const auto stand = [&] {
    search.squares = now.squares;
    search.R = now.R;
  };
  stand();
  for (int pass = 0; pass < passes; ++pass, ++start.iterations) {
    const Vector full = now.step(0.0), theta = coefficients(search.at, parts);
    const double variance = now.squares / static_cast<double>(std::max<Index>(samples_ - theta.size(), 1));
    const Vector error = (variance * now.inverse().diagonal()).cwiseSqrt();
    const double change = (full.array().abs() / theta.array().abs().max(error.array())).maxCoeff();
    const bool exact = now.squares < kExact * output_squares_;
    if (!exact && !std::isfinite(change)) return;
    start.converged = exact || change < options_.tolerance;
    start.stable = start.converged ? is_apart_from_the_edge(search.at.f) : is_stable(moved(search.at, parts, full));
    if (start.converged && !start.stable) {
      start.converged = false;
      return;
    }
    if (start.converged) {
      if (change < kRounding || refinements-- == 0) return;
      damping = 0.0;
    }
    bool moves = false;
    while (!moves && damping < kMaxDamping) {
      Model trial = moved(search.at, parts, now.step(damping));
      Linear reached = is_stable(trial) ? linear(trial, parts) : Linear();
      moves = reached.squares < now.squares;
      if (moves) {
        search.at = std::move(trial);
        now = std::move(reached);
        damping = damping < kMinDamping ? 0.0 : kLess * damping;
      } else {
        if (start.converged) return;  // what is left is rounding
        damping = std::max(kMore * damping, pass == 0 ? kFirstDamping : kMinDamping);
      }
    }
    if (!moves) return;
    stand();
  }
}

/// f and b of an equation-error model of the outputs through 1/filter, by least squares or by instruments.
Vector Fitter::regress(const Vector& filter, const Signals& outputs, const Signals* instruments, Index poles,
                       Index zeros) const {
  const Index p = poles + zeros + 1;
  const Vector F = monic(filter);
  numeric::RowTriangle triangle(p + 1);
  Matrix ZX = Matrix::Zero(p, p);
  Vector Zy = Vector::Zero(p);
  for (std::size_t k = 0; k < experiments_.size(); ++k) {
    const Index total = outputs[k].size();
    const auto filtered = [&](const Vector& x) { return difference_equation(kOne, F, x); };
    const Vector y = filtered(outputs[k]), u = filtered(experiments_[k].input);
    const Vector x = instruments != nullptr ? filtered((*instruments)[k]) : Vector();
    Matrix columns(total, instruments != nullptr ? p + poles + 1 : p + 1);
    for (Index j = 0; j < poles; ++j) put_shifted(y, j + 1, -1.0, columns.col(j));
    for (Index j = 0; j <= zeros; ++j) put_shifted(u, j, 1.0, columns.col(poles + j));
    columns.col(p) = y;
    for (Index j = 0; j < poles && instruments != nullptr; ++j) put_shifted(x, j + 1, -1.0, columns.col(p + 1 + j));
    if (options_.free_start) FreeMotion(F, poles, total).take_out_of(columns);
    if (instruments == nullptr) {
      triangle.add(columns);
      continue;
    }
    Matrix Z(total, p);
    Z << columns.rightCols(poles), columns.middleCols(poles, zeros + 1);
    ZX += Z.transpose() * columns.leftCols(p);
    Zy += Z.transpose() * columns.col(p);
  }
  if (instruments != nullptr) return numeric::PivotedQr(ZX).solve(Zy);
  return solution_of(triangle.R());
}

/// The regression without a filter of so many poles and zeros, by normal equations, as it is but where others begin.
/// Its columns are two signals, each a sample later than the one before, so that nothing has to be written for them.
Vector Fitter::long_regression(Index order) const {
  constexpr double kSmall = 1e-13;
  const Index each = order + 1;
  Matrix gram = Matrix::Zero(2 * each, 2 * each);  // y[t − order] … y[t], u[t − order] … u[t]
  for (const SignalPair& pair : experiments_) {
    const Index total = pair.output.size(), rest = options_.free_start ? 0 : order, count = total + rest - order;
    if (count <= 0) continue;
    Vector y = Vector::Zero(rest + total), u = y;
    y.tail(total) = pair.output;
    u.tail(total) = pair.input;
    if (options_.free_start) {
      y.array() -= y.mean();
      u.array() -= u.mean();
    }
    using Lags = Eigen::Map<const Matrix, 0, Eigen::OuterStride<>>;
    const Lags outputs(y.data(), count, each, Eigen::OuterStride<>(1));
    const Lags inputs(u.data(), count, each, Eigen::OuterStride<>(1));
    gram += numeric::gram_of({outputs, inputs});
    if (!options_.free_start) continue;
    Vector sums(2 * each);
    sums << outputs.colwise().sum().transpose(), inputs.colwise().sum().transpose();
    gram -= sums * sums.transpose() / static_cast<double>(count);
  }
  std::vector<Index> regressors;
  for (Index lag = 1; lag <= order; ++lag) regressors.push_back(order - lag);
  for (Index lag = 0; lag <= order; ++lag) regressors.push_back(each + order - lag);
  const Matrix XX = gram(regressors, regressors);
  const Vector scale = XX.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const auto [values, vectors] = numeric::symmetric_eigen(scale.asDiagonal() * XX * scale.asDiagonal());
  Vector inverse = values;
  for (double& value : inverse) value = value > kSmall * values.maxCoeff() ? 1.0 / value : 0.0;
  const Vector right = vectors.transpose() * scale.cwiseProduct(gram(regressors, order));
  Vector theta = scale.cwiseProduct(vectors * inverse.cwiseProduct(right));
  theta.head(order) *= -1.0;
  return theta;
}

/// Of an equation-error model, from rest and stable.
Fitter::Signals Fitter::responses(const Vector& theta, Index poles) const {
  Signals all;
  const Vector F = monic(stabilised(theta.head(poles)));
  for (const SignalPair& pair : experiments_) {
    all.push_back(difference_equation(theta.tail(theta.size() - poles), F, pair.input));
  }
  return all;
}

/// Columns [u_f[t] …, y, −y_f[t − 1] …, y_f], all free of motion: the best numerator is from the first, the model of
/// equation error from all but y.
Fitter::Sharpening Fitter::sharpened_once(const Vector& f) const {
  const Vector F = monic(f);
  numeric::RowTriangle triangle(q_ + n_ + 2);
  for (const SignalPair& pair : experiments_) {
    const Index total = pair.output.size();
    const Vector y = difference_equation(kOne, F, pair.output), u = difference_equation(kOne, F, pair.input);
    Matrix columns(total, q_ + n_ + 2);
    for (Index j = 0; j < q_; ++j) put_shifted(u, j, 1.0, columns.col(j));
    columns.col(q_) = pair.output;
    for (Index j = 0; j < n_; ++j) put_shifted(y, j + 1, -1.0, columns.col(q_ + 1 + j));
    columns.col(q_ + 1 + n_) = y;
    if (options_.free_start) FreeMotion(F, n_, total).take_out_of(columns);
    triangle.add(columns);
  }
  const Matrix all = triangle.R().topLeftCorner(q_ + 1, q_ + 1);
  Sharpening made;
  made.at = {f, solution_of(all), {}, {}};
  made.squares = (all.leftCols(q_) * made.at.b - all.col(q_)).squaredNorm();
  Matrix behind(q_ + n_ + 2, n_ + q_ + 1);
  behind << triangle.R().middleCols(q_ + 1, n_), triangle.R().leftCols(q_), triangle.R().rightCols(1);
  made.next = solution_of(numeric::householder_triangle(std::move(behind))).head(n_);
  return made;
}

/// Steiglitz & McBride (1965): least squares behind 1/F of the last pass, until that leaves no less; the best of the
/// passes is kept.   @param passes 1: the start as it is, with its best numerator
Fitter::Search Fitter::sharpened(const Start& start, int passes) const {
  constexpr double kLess = 1e-4;
  Search search;
  search.start.made_by = start.made_by;
  double modulus = 0.0;
  for (const auto& z : numeric::polynomial_roots(monic(start.f).reverse()))
    modulus += std::log(std::abs(std::log(z)) / step_);
  search.start.pole = std::exp(modulus / static_cast<double>(n_));
  Vector now = start.f;
  double last = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < passes; ++pass) {
    const Sharpening made = sharpened_once(now);
    const double sum = made.at.b.allFinite() ? made.squares : std::numeric_limits<double>::infinity();
    if (sum < search.squares || pass == 0) {
      search.at = made.at;
      search.squares = sum;
    }
    if (pass + 1 == passes || std::abs(last - sum) <= kLess * sum) break;
    last = sum;
    now = stabilised(made.next);
  }
  return search;
}

bool Fitter::is_better(const Search& a, const Search& b) {
  return a.start.converged != b.start.converged ? a.start.converged : a.squares < b.squares;
}

/// The dynamics behind a noise model that is held, from a start sharpened; where that leads out of the stable models,
/// from the start as it is, as the sharpened one may stand in the valley of another minimum, or of none; and then from
/// where the first search was held up, with its poles moved away from the unit circle.
Fitter::Search Fitter::settled(const Start& start, const Search& sharp, const Vector& noise) const {
  const auto descended = [&](Search search) {
    if (std::isfinite(search.squares)) {
      search.at.c = noise;
      descend(search, kDynamics, options_.max_iterations, 1);
    }
    return search;
  };
  Search first = descended(sharp);
  if (first.start.converged || !first.at.f.allFinite()) return first;
  for (const Vector& f : {start.f, moved_inside(first.at.f)}) {
    Search next = descended(sharpened({start.made_by, f}, 1));
    next.start.pole = first.start.pole;
    if (next.start.converged) return next;
  }
  return first;
}

/// Of searches that are the same the first goes on, and the others share what it finds.
template <class Same, class GoOn>
Result<void> Fitter::go_on_as_one(std::vector<Search>& searches, Same&& are_same, GoOn&& go_on) const {
  std::vector<std::size_t> leader(searches.size()), leaders;
  for (std::size_t k = 0; k < searches.size(); ++k) {
    const auto known = std::ranges::find_if(leaders, [&](std::size_t i) { return are_same(searches[k], searches[i]); });
    leader[k] = known == leaders.end() ? k : *known;
    if (leader[k] == k && std::isfinite(searches[k].squares)) leaders.push_back(k);
  }
  const auto ran =
      numeric::parallel_for(static_cast<int>(leaders.size()), options_.threads, [&](int i) -> Result<void> {
        go_on(searches[leaders[static_cast<std::size_t>(i)]]);
        return {};
      });
  for (std::size_t k = 0; k < searches.size(); ++k) {
    if (leader[k] == k) continue;
    const SearchStart own = searches[k].start;
    searches[k] = searches[leader[k]];
    searches[k].start.made_by = own.made_by;
    searches[k].start.pole = own.pole;
    searches[k].start.iterations = own.iterations;
  }
  return ran;
}

/// Whether both have settled, within a small part of the standard errors of each other.
bool Fitter::stand_together(const Search& a, const Search& b) const {
  constexpr double kSmall = 1e-3;
  if (!a.start.converged || !b.start.converged) return false;
  const Vector apart = b.R * (coefficients(a.at, kDynamics) - coefficients(b.at, kDynamics));
  const double variance = b.squares / static_cast<double>(samples_);
  return apart.squaredNorm() <= kSmall * kSmall * variance;
}

template <class Make>
Result<std::vector<Fitter::Search>> Fitter::each_of(const std::vector<Start>& starts, Make&& make) const {
  std::vector<Search> searches(starts.size());
  MBK_TRY(numeric::parallel_for(static_cast<int>(starts.size()), options_.threads, [&](int i) -> Result<void> {
    const auto k = static_cast<std::size_t>(i);
    searches[k] = make(k);
    return {};
  }));
  return searches;
}

/// From all starts to the tolerance, and from there to rounding once for each minimum.
Result<std::vector<Fitter::Search>> Fitter::settled(const std::vector<Start>& starts, const std::vector<Search>& sharp,
                                                    const Vector& noise) const {
  auto searches = each_of(starts, [&](std::size_t k) { return settled(starts[k], sharp[k], noise); });
  if (!searches) return searches;
  MBK_TRY(go_on_as_one(
      *searches, [this](const Search& a, const Search& b) { return stand_together(a, b); },
      [this](Search& search) {
        if (search.start.converged) descend(search, kDynamics, options_.max_iterations, kRefinements);
      }));
  return searches;
}

/// From those behind the noise that is held, and from the best of those without a noise model.
Result<std::vector<Fitter::Search>> Fitter::with_noise(std::vector<Search> searches, std::vector<Search> white) const {
  Search& best = *std::ranges::min_element(white, is_better);
  best.start.made_by = "output error";
  searches.push_back(std::move(best));
  constexpr double kSame = 1e-6;
  const auto are_same = [](const Search& a, const Search& b) {
    return a.start.converged == b.start.converged && std::abs(a.squares - b.squares) <= kSame * b.squares;
  };
  MBK_TRY(go_on_as_one(searches, are_same, [this](Search& search) { add_noise(search); }));
  return searches;
}

ContinuousFitOptions Fitter::continuous_options() const {
  ContinuousFitOptions options;
  options.poles = n_;
  options.zeros = options_.zeros;
  options.start_poles = options_.start_poles;
  options.free_start = options_.free_start;
  options.refine = false;
  options.threads = options_.threads;
  return options;
}

/// @param rich  a long regression
std::vector<Fitter::Start> Fitter::starts(const Vector& rich) const {
  if (options_.start_denominator.size() > 0) return {{"given", stabilised(options_.start_denominator)}};
  std::vector<Start> all;
  const auto add = [&](std::string made_by, const Vector& f) {
    if (f.allFinite()) all.push_back({std::move(made_by), stabilised(f)});
  };
  const auto continuous = fit_continuous(experiments_, continuous_options());
  if (continuous && continuous->a.size() == n_ && continuous->a.allFinite()) {
    Vector A(n_ + 1);
    A << continuous->a, 1.0;
    add("continuous time", from_roots((numeric::polynomial_roots(A) * step_).array().exp()));
  }
  const Vector none;
  add("reduced", regress(none, responses(rich, rich.size() / 2), nullptr, n_, options_.zeros).head(n_));
  const Vector plain = regress(none, outputs_, nullptr, n_, options_.zeros);
  if (plain.allFinite()) {
    add("equation error", plain.head(n_));
    const Signals clean = responses(plain, n_);
    add("instruments", regress(stabilised(plain.head(n_)), outputs_, &clean, n_, options_.zeros).head(n_));
  }
  std::vector<double> poles = options_.start_poles;
  constexpr double kNyquistShares[] = {0.3, 0.05, 0.008};
  for (const double share : kNyquistShares) poles.push_back(share * std::numbers::pi / step_);
  for (const double pole : poles) {
    add("real poles", from_roots(Eigen::VectorXcd::Constant(n_, std::exp(-pole * step_))));
  }
  return all;
}

/// The dynamics with no c and d, with 1, 2 … of each, and with c alone, the least BIC first. The first values are those
/// of Hannan & Rissanen (1982), least squares on the innovations of a long autoregression, and a few steps from them
/// tell the orders apart.
std::vector<Model> Fitter::noise_models(const Model& at) const {
  constexpr Index kLong = 50;
  constexpr int kSteps = 3, kPatience = 2;
  const auto count = static_cast<double>(samples_);
  const Model white{at.f, at.b, {}, {}};
  Signals left;
  for (std::size_t k = 0; k < experiments_.size(); ++k) left.push_back(local(white, k, std::nullopt).residual);
  std::vector<std::pair<double, Model>> all;
  const auto add = [&](Model model, double sum) {
    const auto coefficients = static_cast<double>(model.c.size() + model.d.size());
    all.emplace_back(count * std::log(sum) + coefficients * std::log(count), std::move(model));
    return all.back().first;
  };
  double least = add(white, squares(white));
  const Vector longest = dsp::autoregression(left, std::min(kLong, samples_ / 20));
  const Index most = options_.max_noise_order;
  numeric::RowTriangle triangle(2 * most + 1);
  for (const Vector& v : left) {
    const Vector e = difference_equation(longest, kOne, v);
    Matrix columns(v.size(), 2 * most + 1);
    for (Index j = 0; j < most; ++j) {
      put_shifted(v, j + 1, -1.0, columns.col(2 * j));
      put_shifted(e, j + 1, 1.0, columns.col(2 * j + 1));
    }
    columns.col(2 * most) = v;
    triangle.add(columns);
  }
  for (Index order = 1, rises = 0; order <= most && rises < kPatience; ++order, ++rises) {
    const Matrix& R = triangle.R();
    const Vector theta = Linear{R.topLeftCorner(2 * order, 2 * order), -R.col(2 * most).head(2 * order)}.step(0.0);
    Search search;
    search.at = {at.f, at.b, stabilised(theta(Eigen::seqN(0, order, 2))), stabilised(theta(Eigen::seqN(1, order, 2)))};
    descend(search, kNoise, kSteps, kRefinements);
    if (add(search.at, search.squares) >= least) continue;
    least = all.back().first;
    rises = -1;
  }
  const Vector c = dsp::autoregression(left, most);
  if (c.size() > 1) {
    Model autoregressive = white;
    autoregressive.c = c.tail(c.size() - 1);
    add(autoregressive, squares(autoregressive));
  }
  std::ranges::stable_sort(all, {}, &std::pair<double, Model>::first);
  std::vector<Model> models;
  for (auto& [bic, model] : all) models.push_back(std::move(model));
  return models;
}

/// All coefficients at once, with the noise model of least BIC that settles inside the stable ones. One zero of D at
/// z = 1, where the offset took all there was, is no model, and another order does without.
void Fitter::add_noise(Search& search) const {
  constexpr std::size_t kMax = 6;
  Search best;
  const std::vector<Model> models = noise_models(search.at);
  for (std::size_t k = 0; k < std::min(kMax, models.size()) && !best.start.converged; ++k) {
    Search one{search.start, models[k], search.squares};
    descend(one, kAll, options_.max_iterations, kRefinements);
    if (k == 0 || is_better(one, best)) best = std::move(one);
  }
  search = std::move(best);
}

double Fitter::fit_of(const Model& at) const {
  double sum = 0.0;
  for (std::size_t k = 0; k < experiments_.size(); ++k) sum += local(at, k, std::nullopt).residual.squaredNorm();
  return 1.0 - sum / output_squares_;
}

void Fitter::take_covariance(const Model& at, PredictionErrorFit& made) const {
  const Matrix bread = linear(at, kAll).inverse();
  Matrix covariance = made.variance * bread;
  const Index p = n_ + q_, all = bread.rows();
  made.white_covariance = covariance.topLeftCorner(p, p);
  if (options_.hac_lag_s > 0.0) {
    Matrix scores(all, samples_);
    std::vector<numeric::RowRange> ranges;
    Index begin = 0;
    for (std::size_t k = 0; k < experiments_.size(); ++k) {
      const Local one = local(at, k, kAll);
      const Index count = one.innovation.size();
      scores.middleCols(begin, count) = one.rows.leftCols(all).transpose() * one.innovation.asDiagonal();
      ranges.push_back({begin, begin + count});
      begin += count;
    }
    const Index lags = std::min(static_cast<Index>(std::llround(options_.hac_lag_s / step_)), samples_ / 10);
    const Matrix middle = numeric::long_run_covariance(all, ranges, lags, [&](const numeric::RowRange& range) {
      return Matrix(scores.middleCols(range.begin, range.size()).transpose());
    });
    const double widening = numeric::newey_west_widening(static_cast<double>(lags) / static_cast<double>(samples_));
    covariance = widening * widening * bread * middle * bread.transpose();
  }
  made.covariance = covariance.topLeftCorner(p, p);
}

Result<PredictionErrorFit> Fitter::run() {
  step_ = MBK_TRY(common_step(experiments_));
  for (const SignalPair& pair : experiments_) samples_ += pair.output.size();
  MBK_TRY(check_experiments(experiments_, continuous_options()));
  const Vector& given = options_.start_denominator;
  if (given.size() > 0 && given.size() != n_) {
    return bad_usage(fmt::format("the start has {} poles, but the model has {}", given.size(), n_));
  }
  if (!given.allFinite()) return bad_usage("a coefficient of the start is not a finite number");
  for (const SignalPair& pair : experiments_) {
    output_squares_ += (pair.output.array() - pair.output.mean()).square().sum();
    outputs_.push_back(pair.output);
  }
  constexpr Index kRich = 40, kSamplesEach = 30;
  const Index high = std::clamp(samples_ / kSamplesEach / std::ssize(experiments_), n_, kRich);
  const bool needed = given.size() == 0 || options_.noise_model;
  Vector rich = needed ? long_regression(high) : Vector();
  if (!rich.allFinite()) rich.setZero();
  const std::vector<Start> first = starts(rich);
  constexpr int kSharpened = 12;
  const auto sharp = MBK_TRY(each_of(first, [&](std::size_t k) { return sharpened(first[k], kSharpened); }));
  auto found = settled(first, sharp, Vector());
  if (found && options_.noise_model) {
    auto coloured = settled(first, sharp, stabilised(rich.head(high)));
    if (coloured) coloured = with_noise(std::move(*coloured), std::move(*found));
    found = std::move(coloured);
  }
  if (!found) return tl::unexpected(found.error());
  std::vector<Search>& searches = *found;
  for (Search& one : searches) one.start.fit = fit_of(one.at);
  const Search& best = *std::ranges::min_element(searches, is_better);
  PredictionErrorFit made;
  made.samples = samples_;
  for (const Search& one : searches) made.starts.push_back(one.start);
  made.converged = best.start.converged;
  made.stable = best.start.stable;
  made.fit = best.start.fit;
  made.f = best.at.f;
  made.b = best.at.b;
  made.noise_denominator = monic(best.at.c);
  made.noise_numerator = monic(best.at.d);
  const Index parameters = coefficients(best.at, kAll).size();
  made.variance = best.squares / static_cast<double>(std::max<Index>(samples_ - parameters, 1));
  if (!std::isfinite(made.variance)) return made;
  take_covariance(best.at, made);
  for (std::size_t k = 0; k < experiments_.size(); ++k) {
    Local one = local(best.at, k, std::nullopt);
    made.residuals.push_back(std::move(one.residual));
    made.innovations.push_back(std::move(one.innovation));
  }
  return made;
}

}  // namespace

Result<PredictionErrorFit> fit_prediction_error(const std::vector<SignalPair>& experiments,
                                                const PredictionErrorOptions& options) {
  return Fitter(experiments, options).run();
}

Result<double> common_step(const std::vector<SignalPair>& experiments, const std::vector<SignalPair>& held_out) {
  double step = 0.0;
  constexpr double kSame = 1e-4;
  for (const auto* pairs : {&experiments, &held_out}) {
    for (const SignalPair& pair : *pairs) {
      if (!pair.step) {
        return bad_usage("a discrete-time model needs uniform sampling",
                         "use --method srivc, or resample with --resample");
      }
      if (step == 0.0) step = *pair.step;
      if (std::abs(*pair.step - step) <= kSame * step) continue;
      return bad_usage(
          fmt::format(
              "the sample intervals {:.6g} ms and {:.6g} ms differ, but a discrete-time model needs a single one",
              1e3 * step, 1e3 * *pair.step),
          "use --method srivc, or resample all to one rate with --resample");
    }
  }
  return step;
}

Vector without_discrete_free_motion(const Vector& f, const Vector& residual) {
  Vector rest = residual;
  FreeMotion(monic(f), f.size(), residual.size()).take_out_of(rest);
  return rest;
}

}  // namespace mbk::identify
