#include "mbk/measure/identify/robot_consistency.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "mbk/base/numeric/dense.h"
#include "mbk/model/robot/rigid_body.h"

namespace mbk::identify {
namespace {

using numeric::DefiniteCondition;
using numeric::DefiniteProgram;

/// Σ of the conditions' sizes times the weight of the divergence at the end, in the residual's variance: a hundredth of
/// what one more observation would weigh.
constexpr double kWeight = 0.01;

/// In units in which its diagonal is 1, since the entries of a pseudo-inertia differ in theirs.
bool well_inside(const Matrix& S) {
  constexpr double kInside = 1e-8;
  if (!S.allFinite() || !(S.diagonal().array() > 0.0).all()) return false;
  const Vector unit = S.diagonal().cwiseSqrt().cwiseInverse();
  return numeric::symmetric_eigenvalues(unit.asDiagonal() * S * unit.asDiagonal())[0] > kInside;
}

Matrix matrix_of(const robot::PhysicalCondition& condition, const Vector& theta) {
  const auto n = static_cast<Index>(std::llround(std::sqrt(static_cast<double>(condition.A.rows()))));
  return (condition.A * theta).reshaped(n, n);
}

/// Coefficients that the condition is about.
std::vector<Index> members(const robot::PhysicalCondition& condition) {
  std::vector<Index> all;
  for (Index k = 0; k < condition.A.cols(); ++k) {
    if (!condition.A.col(k).isZero(0.0)) all.push_back(k);
  }
  return all;
}

/// θ whose matrix is S; the other coefficients stay.
void set_matrix(const robot::PhysicalCondition& condition, const Matrix& S, Vector& theta) {
  const std::vector<Index> which = members(condition);
  theta(which) = numeric::CompleteOrthogonal(Matrix(condition.A(Eigen::all, which))).solve(Vector(S.reshaped()));
}

/// A body with the mass and the centre of one that cannot exist.
Matrix possible_body(const Eigen::Matrix4d& stated) {
  constexpr double kThinnest = 0.05;         // of the longest second moment
  constexpr double kBall = 0.1 * 0.1 / 5.0;  // second moment of a ball of 0.1 m, by its mass [m²]
  robot::RigidBody body = robot::body_of(stated);
  if (!body.inertia.allFinite() || !body.centre.allFinite()) body = {body.mass, Eigen::Vector3d::Zero(), {}};
  const Eigen::Vector3d h = body.mass * body.centre;
  const Eigen::Matrix3d moments = stated.topLeftCorner<3, 3>() - h * body.centre.transpose();
  const auto [values, vectors] = numeric::symmetric_eigen(0.5 * (moments + moments.transpose()));
  const double largest = values[2];
  const Vector possible = values.cwiseMax(largest > 1e-9 * body.mass ? kThinnest * largest : kBall * body.mass);
  Eigen::Matrix4d J;
  J << vectors * possible.asDiagonal() * vectors.transpose() + h * body.centre.transpose(), h, h.transpose(), body.mass;
  return J;
}

class NearestRobot {
 public:
  explicit NearestRobot(const FreeFit& free)
      : free_(free), p_(free.model.parameters.size()), conditions_(free.model.physical_conditions()) {}
  Result<ConsistentParameters> find();

 private:
  void take_stated();
  void weigh_massless(const std::vector<std::size_t>& massless);
  void take_drives();
  void take_coordinates();
  [[nodiscard]] std::vector<DefiniteCondition> conditions_of(const std::vector<std::size_t>& which) const;
  [[nodiscard]] Vector coordinates_of(const Vector& theta) const;
  [[nodiscard]] Result<Vector> inside(const DefiniteProgram& program) const;
  [[nodiscard]] bool is_fixed(Index k) const { return std::ranges::find(free_.fixed, k) != free_.fixed.end(); }

  const FreeFit& free_;
  Index p_, seen_ = 0, v_ = 0;
  std::vector<robot::PhysicalCondition> conditions_;
  std::vector<Index> names_;   ///< of the coefficients that are not fixed
  std::vector<Index> hidden_;  ///< of these, by their place among them, those that are not base parameters
  Vector stated_;              ///< θ of the robot to be near to
  Matrix see_;                 ///< |see_ (β − β̂)| = |R (β − β̂)|
  Matrix map_;                 ///< θ = origin_ + map_ x with x = [see_ (β − β̂); θ of the hidden]
  Vector origin_;
  std::vector<std::string> replaced_;
};

/// The bodies of the stated robot.
void NearestRobot::take_stated() {
  stated_ = free_.model.parameters;
  const Vector& of_mechanism = free_.model.mechanism->stated_coefficients();
  std::vector<std::size_t> massless;
  for (std::size_t k = 0; k < conditions_.size(); ++k) {
    const robot::PhysicalCondition& one = conditions_[k];
    const std::vector<Index> which = members(one);
    const bool of_body =
        !which.empty() && which.back() < static_cast<Index>(free_.model.mechanism->coefficients().size());
    if (!of_body || well_inside(matrix_of(one, stated_))) continue;
    if (of_mechanism.size() > 0) {
      Vector other = stated_;
      other(which) = of_mechanism(which);
      stated_ = other;
      if (well_inside(matrix_of(one, other))) continue;
    }
    if (one.pseudo_inertia) replaced_.push_back(one.name);
    const Matrix S = matrix_of(one, stated_);
    if (one.pseudo_inertia && S(3, 3) > 0.0 && S.allFinite()) {
      set_matrix(one, possible_body(S), stated_);
    } else if (one.pseudo_inertia) {
      set_matrix(
          one,
          pseudo_inertia(robot::RigidBody{1.0, Eigen::Vector3d::Zero(), 0.4 * 0.1 * 0.1 * Eigen::Matrix3d::Identity()}),
          stated_);
      massless.push_back(k);
    } else {
      set_matrix(one, Matrix::Identity(S.rows(), S.cols()), stated_);
      massless.push_back(k);
    }
  }
  if (!massless.empty()) weigh_massless(massless);
}

/// One factor for all bodies that nobody stated: the one with which, beside any drives, they explain the torques best.
void NearestRobot::weigh_massless(const std::vector<std::size_t>& massless) {
  const auto bodies = static_cast<Index>(free_.model.mechanism->coefficients().size());
  Vector unit = Vector::Zero(p_), known = stated_;
  for (const std::size_t k : massless) {
    const std::vector<Index> which = members(conditions_[k]);
    unit(which) = stated_(which);
    known(which).setZero();
  }
  known.tail(p_ - bodies).setZero();
  std::vector<Index> of_drives;
  for (std::size_t k = 0; k < names_.size(); ++k) {
    if (names_[k] >= bodies) of_drives.push_back(static_cast<Index>(k));
  }
  const Matrix torque = free_.triangle * free_.columns.combination;
  Matrix Z(torque.rows(), 1 + static_cast<Index>(of_drives.size()));
  Z << torque * unit(names_), torque(Eigen::all, of_drives);
  const Vector y = free_.triangle * free_.base - torque * known(names_);
  const Vector length = Z.colwise().norm().cwiseMax(1e-300);
  const Vector found = numeric::CompleteOrthogonal(Matrix(Z * length.cwiseInverse().asDiagonal())).solve(y);
  const double factor = found[0] / length[0];
  if (!(factor > 0.0 && std::isfinite(factor))) return;
  for (const std::size_t k : massless) {
    const std::vector<Index> which = members(conditions_[k]);
    stated_(which) *= factor;
  }
}

/// The drives of the stated robot.
void NearestRobot::take_drives() {
  constexpr double kSmall = 0.01;
  for (const robot::PhysicalCondition& one : conditions_) {
    if (one.A.rows() != 1) continue;
    const std::vector<Index> which = members(one);
    const Index last = which.back();
    if (is_fixed(last) || (one.A * stated_)[0] > 0.0) continue;
    stated_[last] = 0.0;
    stated_[last] = kSmall * free_.typical[last] - (one.A * stated_)[0];
  }
}

void NearestRobot::take_coordinates() {
  const auto& [kept, combination] = free_.columns;
  seen_ = static_cast<Index>(kept.size());
  for (Index k = 0; k < static_cast<Index>(names_.size()); ++k) {
    if (std::ranges::find(kept, k) == kept.end()) hidden_.push_back(k);
  }
  v_ = static_cast<Index>(names_.size());
  origin_ = Vector::Zero(p_);
  for (const Index k : free_.fixed) origin_[k] = free_.model.parameters[k];
  map_ = Matrix::Zero(p_, v_);
  // x = T Vᵀ D (β − β̂) has the length of R (β − β̂), and what the data hardly see stands in coordinates of its own.
  const Vector lengths = free_.triangle.colwise().norm();
  const Matrix scaled = free_.triangle * lengths.cwiseInverse().asDiagonal();
  const Matrix V = numeric::symmetric_eigen(scaled.transpose() * scaled).vectors;
  const Matrix T = numeric::householder_triangle(scaled * V);
  see_ = T * V.transpose() * lengths.asDiagonal();
  const Matrix inverse =
      lengths.cwiseInverse().asDiagonal() * V * T.triangularView<Eigen::Upper>().solve(Matrix::Identity(seen_, seen_));
  for (Index row = 0; row < seen_; ++row) {
    const Index k = names_[static_cast<std::size_t>(kept[static_cast<std::size_t>(row)])];
    origin_[k] = free_.base[row];
    map_.row(k).head(seen_) = inverse.row(row);
    map_.row(k).tail(v_ - seen_) = -combination(row, hidden_);
  }
  for (std::size_t h = 0; h < hidden_.size(); ++h) {
    map_(names_[static_cast<std::size_t>(hidden_[h])], seen_ + static_cast<Index>(h)) = 1.0;
  }
}

Vector NearestRobot::coordinates_of(const Vector& theta) const {
  const Vector of_free = theta(names_);
  Vector x(v_);
  x << see_ * (free_.columns.combination * of_free - free_.base), of_free(hidden_);
  return x;
}

std::vector<DefiniteCondition> NearestRobot::conditions_of(const std::vector<std::size_t>& which) const {
  std::vector<DefiniteCondition> all;
  for (const std::size_t k : which) {
    const robot::PhysicalCondition& one = conditions_[k];
    all.push_back({one.A * map_, one.A * origin_, matrix_of(one, stated_)});
  }
  return all;
}

/// The start moved until it meets every condition: s falls below 0 in  S + s P > 0.
Result<Vector> NearestRobot::inside(const DefiniteProgram& program) const {
  constexpr double kInside = 1e-3;
  double start = 0.0;
  bool meets = true;
  for (const DefiniteCondition& one : program.conditions) {
    const Index n = one.reference.rows();
    const Matrix S = (one.A * program.start + one.b).reshaped(n, n);
    const double smallest = numeric::generalized_symmetric_eigen(S, one.reference).values[0];
    meets = meets && well_inside(S);
    start = std::max(start, -smallest);
  }
  if (meets) return program.start;
  DefiniteProgram wider;
  wider.seen = 0;
  wider.linear = Vector::Unit(v_ + 1, v_);
  wider.tether = Vector::Zero(v_ + 1);
  wider.tether.head(v_) = program.tether;
  wider.tether.head(seen_).setConstant(1.0 / (1.0 + program.start.head(seen_).squaredNorm()));
  wider.start = Vector::Constant(v_ + 1, start + 1.0);
  wider.start.head(v_) = program.start;
  wider.gap = 0.1 * kInside;
  wider.enough = -kInside;
  for (const DefiniteCondition& one : program.conditions) {
    wider.conditions.push_back(one);
    Matrix& A = wider.conditions.back().A;
    A.conservativeResize(Eigen::NoChange, v_ + 1);
    A.col(v_) = one.reference.reshaped();
  }
  const auto found = MBK_TRY(numeric::solve_definite_program(wider));
  if (!(found.value < 0.0)) {
    return bad_data("the values that --fix keeps are physically inconsistent",
                    "omit --fix, or correct those values in the description of the robot");
  }
  return Vector(found.x.head(v_));
}

Result<ConsistentParameters> NearestRobot::find() {
  if (conditions_.empty()) return bad_usage("this robot has no conditions for physical consistency");
  for (Index k = 0; k < p_; ++k) {
    if (!is_fixed(k)) names_.push_back(k);
  }
  std::vector<std::size_t> pressing;  // conditions that something may still change
  const std::vector<robot::Coefficient> coefficients = free_.model.coefficients();
  for (std::size_t k = 0; k < conditions_.size(); ++k) {
    const std::vector<Index> which = members(conditions_[k]);
    if (!std::ranges::all_of(which, [&](Index i) { return is_fixed(i); })) {
      pressing.push_back(k);
      continue;
    }
    const Matrix S = matrix_of(conditions_[k], free_.model.parameters);
    // Friction and rotors may be nothing at all.
    const bool possible = conditions_[k].A.rows() == 1 ? S(0, 0) >= 0.0 : well_inside(S);
    if (possible) continue;
    return bad_usage(fmt::format("the fixed value of {} is physically impossible", conditions_[k].name),
                     "correct it in the description of the robot, or remove it from --fix");
  }
  take_stated();
  take_drives();
  take_coordinates();

  DefiniteProgram program;
  program.seen = seen_;
  program.linear = Vector::Zero(v_);
  program.conditions = conditions_of(pressing);
  program.tether = Vector::Zero(v_);
  for (std::size_t h = 0; h < hidden_.size(); ++h) {
    const Index k = names_[static_cast<std::size_t>(hidden_[h])];
    const bool held = std::ranges::any_of(conditions_, [k](const auto& one) { return !one.A.col(k).isZero(0.0); });
    if (!held) program.tether[seen_ + static_cast<Index>(h)] = 1.0 / (free_.typical[k] * free_.typical[k]);
  }
  program.start = coordinates_of(stated_);
  program.gap = kWeight;
  if (!free_.fixed.empty()) {
    auto start = inside(program);
    if (!start) return tl::unexpected(start.error());
    program.start = *std::move(start);
  }
  auto solution = numeric::solve_definite_program(program);
  if (!solution) return tl::unexpected(solution.error());
  ConsistentParameters made;
  made.parameters = origin_ + map_ * solution->x;
  for (const std::size_t k : pressing) made.conditions.push_back(conditions_[k]);
  made.solution = *std::move(solution);
  made.replaced = replaced_;
  return made;
}

}  // namespace

Result<ConsistentParameters> nearest_robot(const FreeFit& free) {
  return NearestRobot(free).find();
}

}  // namespace mbk::identify
