#include "mbk/base/numeric/definite_least_squares.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "mbk/base/numeric/dense.h"

namespace mbk::numeric {
namespace {

/// Added to the diagonal of a Newton matrix whose diagonal is 1: it changes the way to the minimum, and not that.
constexpr double kRounding = 1e-13;

/// A condition in units of its reference, P = L Lᵀ: S̃ = L⁻¹ S L⁻ᵀ, whose reference is I.
struct UnitCondition {
  Index n = 0;
  Matrix A;      ///< n²×v, symmetric columns
  Vector b;      ///< n²
  Vector trace;  ///< of the columns, v
  Matrix lower;  ///< L
};

/// L⁻¹ X L⁻ᵀ of a symmetric X.
Matrix congruent(const Matrix& lower, const Matrix& X) {
  const auto L = lower.triangularView<Eigen::Lower>();
  const Matrix half = L.solve(X);
  return L.solve(Matrix(half.transpose()));
}

/// (L Lᵀ)⁻¹.
Matrix inverse_of_product(const Matrix& lower) {
  const auto L = lower.triangularView<Eigen::Lower>();
  const Matrix inverse = L.solve(Matrix::Identity(lower.rows(), lower.cols()));
  return inverse.transpose() * inverse;
}

Matrix symmetric(const Matrix& X) {
  return 0.5 * (X + X.transpose());
}

Matrix symmetric_part(const Vector& columns, Index n) {
  return symmetric(columns.reshaped(n, n));
}

/// Where S and Z are the same diagonal matrix: G⁻¹ S G⁻ᵀ = Gᵀ Z G = D.
struct Scaling {
  Vector d;
  Matrix inverse;         ///< G⁻¹
  Matrix A;               ///< of the condition there, n²×v
  Matrix dS, dZ, change;  ///< of S and Z there, and what their sum is to be

  /// From S = L Lᵀ and Z:  Lᵀ Z L = V D² Vᵀ,  G⁻¹ = D^½ Vᵀ L⁻¹.
  Scaling(const Matrix& lower, const Matrix& Z) {
    const auto [values, vectors] = symmetric_eigen(symmetric(lower.transpose() * Z * lower));
    d = values.cwiseMax(0.0).cwiseSqrt();
    inverse = d.cwiseSqrt().asDiagonal() * vectors.transpose() *
              lower.triangularView<Eigen::Lower>().solve(Matrix::Identity(lower.rows(), lower.cols()));
  }
};

class DefiniteSolver {
 public:
  explicit DefiniteSolver(const DefiniteProgram& program) : program_(program), v_(program.start.size()) {}
  Result<DefiniteSolution> solve();

 private:
  Result<void> prepare();
  [[nodiscard]] double objective(const Vector& x) const {
    return 0.5 * x.head(program_.seen).squaredNorm() + program_.linear.dot(x);
  }
  /// The Cholesky factors of S̃ at x; nothing where a condition does not hold.
  [[nodiscard]] std::optional<std::vector<Matrix>> factors_at(const Vector& x) const;
  [[nodiscard]] bool step();
  [[nodiscard]] double complementarity() const;
  [[nodiscard]] double off_centre() const;
  [[nodiscard]] DefiniteSolution solution() const;

  const DefiniteProgram& program_;
  Index v_, order_ = 0;
  std::vector<UnitCondition> conditions_;
  Vector x_;
  std::vector<Matrix> factors_;      ///< L of S̃ = L Lᵀ at x
  std::vector<Matrix> multipliers_;  ///< Z, positive definite; μ S̃⁻¹ at the minimum of this weight
  double weight_ = 1.0;              ///< μ
  double length_ = 1.0;              ///< of the last step
  double newton_ = 0.0;              ///< squared length of the last Newton step by its own Hessian, over μ
};

Result<void> DefiniteSolver::prepare() {
  const bool shapes = program_.seen >= 0 && program_.seen <= v_ && program_.linear.size() == v_ &&
                      program_.tether.size() == v_ && program_.gap > 0.0;
  if (!shapes) return bad_usage("the parts of a definite program have inconsistent sizes");
  if (!program_.start.allFinite() || !program_.linear.allFinite() || !program_.tether.allFinite()) {
    return bad_usage("a number of a definite program is not finite");
  }
  for (const DefiniteCondition& one : program_.conditions) {
    UnitCondition unit;
    unit.n = one.reference.rows();
    const Index n = unit.n;
    if (n == 0 || one.reference.cols() != n || one.A.rows() != n * n || one.A.cols() != v_ || one.b.size() != n * n) {
      return bad_usage("the parts of a definite program have inconsistent sizes");
    }
    if (!one.A.allFinite() || !one.b.allFinite() || !one.reference.allFinite()) {
      return bad_usage("a number of a definite program is not finite");
    }
    const Cholesky reference(one.reference);
    if (!reference.positive_definite()) return bad_usage("a reference is not positive definite");
    unit.lower = reference.upper().transpose();
    unit.A.resize(n * n, v_);
    unit.trace.resize(v_);
    for (Index i = 0; i < v_; ++i) {
      const Matrix column = congruent(unit.lower, symmetric_part(one.A.col(i), n));
      unit.A.col(i) = column.reshaped();
      unit.trace[i] = column.trace();
    }
    unit.b = congruent(unit.lower, symmetric_part(one.b, n)).reshaped();
    order_ += n;
    conditions_.push_back(std::move(unit));
  }
  x_ = program_.start;
  auto factors = factors_at(x_);
  if (!factors) return bad_usage("the start of a definite program violates a condition");
  factors_ = *std::move(factors);
  return {};
}

std::optional<std::vector<Matrix>> DefiniteSolver::factors_at(const Vector& x) const {
  std::vector<Matrix> all;
  for (const UnitCondition& one : conditions_) {
    const Eigen::LLT<Matrix> factor(symmetric_part(one.A * x + one.b, one.n));
    if (factor.info() != Eigen::Success) return std::nullopt;
    all.emplace_back(factor.matrixL());
    if (!all.back().allFinite()) return std::nullopt;
  }
  return all;
}

/// One step towards the minimum at this weight: Newton's on the gradient with Z for μ S⁻¹ and on S Z = μ I, both scaled
/// by the G with G⁻¹ S G⁻ᵀ = Gᵀ Z G = D (Nesterov & Todd 1997), and once more with what the product of the two changes
/// adds (Mehrotra 1992); as far as nine tenths of the way to where S or Z ceases to be definite.
bool DefiniteSolver::step() {
  std::vector<Scaling> scalings;
  Matrix H = (weight_ * program_.tether).asDiagonal();
  H.diagonal().head(program_.seen).array() += 1.0;
  Vector known = program_.linear + weight_ * program_.tether.cwiseProduct(x_ - program_.start);
  known.head(program_.seen) += x_.head(program_.seen);
  for (std::size_t k = 0; k < conditions_.size(); ++k) {
    const UnitCondition& one = conditions_[k];
    Scaling scaling(factors_[k], multipliers_[k]);
    if (!(scaling.d.minCoeff() > 0.0) || !scaling.inverse.allFinite()) return false;
    scaling.A.resize(one.n * one.n, v_);
    for (Index i = 0; i < v_; ++i) {
      const Matrix half = scaling.inverse * one.A.col(i).reshaped(one.n, one.n);
      scaling.A.col(i) = Matrix(half * scaling.inverse.transpose()).reshaped();
    }
    H.noalias() += scaling.A.transpose() * scaling.A;
    known += weight_ * one.trace;
    scalings.push_back(std::move(scaling));
  }
  const Vector unit = H.diagonal().cwiseSqrt().cwiseInverse();
  if (!unit.allFinite()) return false;
  Matrix scaled = unit.asDiagonal() * H * unit.asDiagonal();
  scaled.diagonal().array() += kRounding;
  const Cholesky factor(scaled);
  if (!factor.positive_definite()) return false;

  Vector direction;
  for (const bool corrected : {false, true}) {
    Vector right = -known;
    for (Scaling& one : scalings) {
      Matrix R = Matrix::Identity(one.d.size(), one.d.size()) * weight_;
      R.diagonal() -= one.d.cwiseAbs2();
      if (corrected) R -= symmetric(one.dS * one.dZ);
      for (Index i = 0; i < R.rows(); ++i) {
        for (Index j = 0; j < R.cols(); ++j) R(i, j) *= 2.0 / (one.d[i] + one.d[j]);
      }
      one.change = R;
      R.diagonal() += one.d;
      right += one.A.transpose() * R.reshaped();
    }
    direction = unit.cwiseProduct(factor.solve(Vector(unit.cwiseProduct(right))));
    if (!direction.allFinite()) return false;
    if (!corrected) newton_ = right.dot(direction) / weight_;
    for (Scaling& one : scalings) {
      const Index n = one.d.size();
      one.dS = symmetric_part(one.A * direction, n);
      one.dZ = one.change - one.dS;
    }
  }

  constexpr double kOfTheWay = 0.9;
  double length = 1.0;
  for (const Scaling& one : scalings) {
    const Matrix root = one.d.cwiseSqrt().cwiseInverse().asDiagonal();
    for (const Matrix* change : {&one.dS, &one.dZ}) {
      const double least = symmetric_eigenvalues(root * symmetric(*change) * root)[0];
      if (least < 0.0) length = std::min(length, -kOfTheWay / least);
    }
  }
  std::optional<std::vector<Matrix>> factors = factors_at(x_ + length * direction);
  for (int halving = 0; !factors && halving < 30; ++halving) {  // rounding at the edge
    length *= 0.5;
    factors = factors_at(x_ + length * direction);
  }
  if (!factors) return false;
  x_ += length * direction;
  factors_ = *std::move(factors);
  for (std::size_t k = 0; k < conditions_.size(); ++k) {
    const Matrix& inverse = scalings[k].inverse;
    multipliers_[k] += length * symmetric(inverse.transpose() * scalings[k].dZ * inverse);
  }
  length_ = length;
  return true;
}

/// Mean eigenvalue of S Z: the weight at which x would be the minimum.
double DefiniteSolver::complementarity() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < conditions_.size(); ++k) {
    sum += (factors_[k].transpose() * multipliers_[k] * factors_[k]).trace();
  }
  return sum / static_cast<double>(std::max<Index>(order_, 1));
}

/// Largest distance of an eigenvalue of S Z/μ from 1.
double DefiniteSolver::off_centre() const {
  double most = 0.0;
  for (std::size_t k = 0; k < conditions_.size(); ++k) {
    const Matrix SZ = factors_[k].transpose() * multipliers_[k] * factors_[k] / weight_;
    most = std::max(most, (symmetric_eigenvalues(SZ).array() - 1.0).abs().maxCoeff());
  }
  return most;
}

DefiniteSolution DefiniteSolver::solution() const {
  DefiniteSolution made;
  made.x = x_;
  made.value = objective(x_);
  for (const UnitCondition& one : conditions_) {
    const Matrix S = symmetric_part(one.A * x_ + one.b, one.n);
    double pressure = 0.0;
    for (const double value : symmetric_eigenvalues(S)) pressure += std::max(0.0, weight_ * (1.0 / value - 1.0));
    made.pressure.push_back(pressure);
    made.matrices.emplace_back(one.lower * S * one.lower.transpose());
  }
  made.weight = weight_;
  return made;
}

Result<DefiniteSolution> DefiniteSolver::solve() {
  constexpr int kMaxSteps = 500;
  constexpr double kCentred = 0.01, kSettled = 1e-3, kFollows = 0.8;
  MBK_TRY(prepare());
  const double last = program_.gap / static_cast<double>(std::max<Index>(order_, 1));
  weight_ = std::max(last, std::abs(objective(x_)));
  for (const Matrix& factor : factors_) {
    multipliers_.emplace_back(weight_ * inverse_of_product(factor));
  }
  double decade = 0.0;  // the objective when the weight was ten times the last
  int steps = 0;
  bool done = false;
  for (; steps < kMaxSteps && !done; ++steps) {
    if (!step()) break;
    done = program_.enough && objective(x_) < *program_.enough;
    const double now = complementarity();
    if (now >= 10.0 * last) decade = objective(x_);
    if (weight_ <= last) {
      done = done || (off_centre() < kCentred && newton_ < kSettled);
      continue;
    }
    // After a long step the next one reduces the weight more.
    const double fall = length_ > 0.9 ? 0.1 : 0.3;
    if (off_centre() < kFollows) weight_ = std::max(last, std::min(weight_, fall * now));
  }
  if (!done) {
    return fail(ErrorKind::not_usable,
                fmt::format("the program of definite matrices did not converge: after {} steps the weight of the "
                            "divergence is {:.3g}, target {:.3g}, and the length of the last step {:.3g}",
                            steps, weight_, last, length_),
                "use a description that is closer to the true robot, or record more motion");
  }
  DefiniteSolution made = solution();
  made.steps = steps;
  made.last_change = decade - made.value;
  return made;
}

}  // namespace

Result<DefiniteSolution> solve_definite_program(const DefiniteProgram& program) {
  return DefiniteSolver(program).solve();
}

}  // namespace mbk::numeric
