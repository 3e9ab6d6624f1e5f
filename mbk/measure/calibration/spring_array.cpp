#include "mbk/measure/calibration/spring_array.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mbk/base/core/units.h"
#include "mbk/base/numeric/dense.h"

namespace mbk::calibration {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

/// The line from the screw eye to the disc, d_i.
Vector2d line_of(const Spring& spring, const Vector2d& hand, const Matrix2d& rotation) {
  return hand + rotation * spring.hole - spring.anchor;
}

Matrix2d rotation_by(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return (Matrix2d() << c, -s, s, c).finished();
}

}  // namespace

Result<SpringArray> SpringArray::create(std::vector<Spring> springs, Compression compression) {
  if (springs.empty()) return bad_data("no spring was given", "give at least two that pull in different directions");
  for (std::size_t i = 0; i < springs.size(); ++i) {
    const Spring& spring = springs[i];
    const std::string where = fmt::format("spring {}", i + 1);
    if (!(spring.stiffness > 0.0 && std::isfinite(spring.stiffness))) {
      return bad_data(fmt::format("the stiffness of {:g} N/m is not above 0", spring.stiffness),
                      "remove the spring if it does not exist", where);
    }
    if (!(spring.rest_length >= 0.0 && std::isfinite(spring.rest_length))) {
      return bad_data(fmt::format("the rest length of {:g} mm is not 0 or more", kMillimetres * spring.rest_length),
                      "give the length at which its force starts", where);
    }
    if (!spring.anchor.allFinite() || !spring.hole.allFinite()) {
      return bad_data("a position is not a finite number", "give x and y of the screw eye and of the hole", where);
    }
  }
  return SpringArray(std::move(springs), compression);
}

double SpringArray::tension_at(const Spring& spring, double length) const {
  const double extension = length - spring.rest_length;
  return extension < 0.0 && compression_ == Compression::slack ? 0.0 : spring.stiffness * extension;
}

Vector2d SpringArray::force(const Vector2d& hand, double disc_rotation) const {
  const Matrix2d rotation = rotation_by(disc_rotation);
  Vector2d sum = Vector2d::Zero();
  for (const Spring& spring : springs_) {
    const Vector2d d = line_of(spring, hand, rotation);
    const double length = d.norm();
    if (length > 0.0) sum -= tension_at(spring, length) / length * d;
  }
  return sum;
}

double SpringArray::moment(const Vector2d& hand, double disc_rotation) const {
  const Matrix2d rotation = rotation_by(disc_rotation);
  double sum = 0.0;
  for (const Spring& spring : springs_) {
    const Vector2d h = rotation * spring.hole;
    const Vector2d d = hand + h - spring.anchor;
    const double length = d.norm();
    if (length > 0.0) sum -= tension_at(spring, length) / length * (h.x() * d.y() - h.y() * d.x());
  }
  return sum;
}

double SpringArray::energy(const Vector2d& hand, double disc_rotation) const {
  const Matrix2d rotation = rotation_by(disc_rotation);
  double sum = 0.0;
  for (const Spring& spring : springs_) {
    const double tension = tension_at(spring, line_of(spring, hand, rotation).norm());
    sum += 0.5 * tension * tension / spring.stiffness;
  }
  return sum;
}

Matrix2d SpringArray::stiffness(const Vector2d& hand, double disc_rotation) const {
  const Matrix2d rotation = rotation_by(disc_rotation);
  Matrix2d K = Matrix2d::Zero();
  for (const Spring& spring : springs_) {
    const Vector2d d = line_of(spring, hand, rotation);
    const double length = d.norm();
    if (length < spring.rest_length && compression_ == Compression::slack) continue;
    if (spring.rest_length == 0.0) {  // a spring of rest length 0 has the same stiffness in all directions
      K += spring.stiffness * Matrix2d::Identity();
      continue;
    }
    const double across = 1.0 - spring.rest_length / length;  // −∞ where the ends coincide
    const Vector2d u = d / length;
    K += spring.stiffness * (across * Matrix2d::Identity() + (1.0 - across) * u * u.transpose());
  }
  K(1, 0) = K(0, 1);  // the last bit too
  return K;
}

double SpringArray::length(std::size_t i, const Vector2d& hand, double disc_rotation) const {
  return line_of(springs_[i], hand, rotation_by(disc_rotation)).norm();
}

double SpringArray::tension(std::size_t i, const Vector2d& hand, double disc_rotation) const {
  return tension_at(springs_[i], length(i, hand, disc_rotation));
}

namespace {

/// The step downhill: (K + μI) p = F with the smallest eigenvalue of K + μI at least a thousandth of the largest size.
Vector2d downhill_step(const Matrix2d& K, const Vector2d& force) {
  const numeric::SymmetricEigen eigen = numeric::symmetric_eigen(K);
  Vector2d lambda = eigen.values;
  const double least = 1e-3 * lambda.cwiseAbs().maxCoeff();
  lambda = lambda.cwiseAbs().cwiseMax(least);
  return eigen.vectors * (eigen.vectors.transpose() * force).cwiseQuotient(lambda);
}

/// What makes an equilibrium useless, if anything does.
Result<void> check_equilibrium(const SpringArray& array, const Vector2d& place, double rotation) {
  constexpr double kCoincide = 1e-9;  // [m]
  constexpr double kFlat = 1e-9;      // smallest over largest principal stiffness that is not rounding
  const std::vector<Spring>& springs = array.springs();
  for (std::size_t i = 0; i < springs.size(); ++i) {
    const double length = array.length(i, place, rotation);
    if (length < kCoincide) {
      return fail(ErrorKind::not_usable,
                  fmt::format("the two ends of spring {} coincide at the equilibrium, so it has no direction", i + 1),
                  springs.size() == 1 ? "add springs on other sides" : "move its screw eye");
    }
    if (length <= springs[i].rest_length && array.compression() == Compression::slack) {
      return fail(
          ErrorKind::not_usable,
          fmt::format("spring {} is slack at the equilibrium x {:.2f}, y {:.2f} mm: {:.2f} mm from eye to disc, "
                      "{:.2f} mm at rest",
                      i + 1, kMillimetres * place.x(), kMillimetres * place.y(), kMillimetres * length,
                      kMillimetres * springs[i].rest_length),
          "use a shorter spring or a screw eye that is further away");
    }
  }
  const Vector2d lambda = numeric::symmetric_eigenvalues(array.stiffness(place, rotation));
  if (!(lambda[0] > kFlat * lambda[1])) {
    return fail(ErrorKind::not_usable,
                fmt::format("the equilibrium x {:.2f}, y {:.2f} mm is not stable: its smallest stiffness is {:.3g} N/m",
                            kMillimetres * place.x(), kMillimetres * place.y(), lambda[0]),
                "pull from more directions, or start elsewhere");
  }
  return {};
}

}  // namespace

Result<Vector2d> equilibrium(const SpringArray& array, const Vector2d& start, double disc_rotation) {
  constexpr int kMaxSteps = 200, kMaxHalvings = 60;
  if (!start.allFinite()) return bad_usage("the start of the search is not a finite position");
  Vector2d place = start;
  Vector2d force = array.force(place, disc_rotation);
  for (int step = 0; step < kMaxSteps && !(force.norm() <= kEquilibriumForce); ++step) {
    const Matrix2d K = array.stiffness(place, disc_rotation);
    if (!K.allFinite() || K.isZero()) break;
    Vector2d move = downhill_step(K, force);
    const double energy = array.energy(place, disc_rotation);
    bool lower = false;
    for (int halving = 0; halving < kMaxHalvings && !lower; ++halving) {
      const Vector2d trial = place + move;
      const Vector2d force_there = array.force(trial, disc_rotation);
      // Near the end the energy is flat to its last digit, and the force decides.
      lower = array.energy(trial, disc_rotation) < energy - 1e-4 * move.dot(force) ||
              (array.energy(trial, disc_rotation) <= energy * (1.0 + 1e-14) && force_there.norm() < 0.5 * force.norm());
      if (lower) {
        place = trial;
        force = force_there;
      } else {
        move *= 0.5;
      }
    }
    if (!lower) break;
  }
  if (!(force.norm() <= kEquilibriumForce)) {
    return fail(ErrorKind::not_usable,
                fmt::format("no equilibrium was found: at x {:.2f}, y {:.2f} mm the force is still {:.3g} N",
                            kMillimetres * place.x(), kMillimetres * place.y(), force.norm()),
                "start nearer to the expected equilibrium");
  }
  MBK_TRY(check_equilibrium(array, place, disc_rotation));
  return place;
}

Result<GridField> grid_field(const SpringArray& array, const Vector2d& centre, double reach, double step,
                             double disc_rotation) {
  constexpr double kMin = 3, kMax = 4000;
  const Eigen::Array2d first = ((centre.array() - reach) / step).ceil(),
                       last = ((centre.array() + reach) / step).floor();
  const Eigen::Array2d count = last - first + 1.0;
  if (!(step > 0.0 && count.minCoeff() >= kMin && count.maxCoeff() <= kMax)) {
    return bad_usage(fmt::format("a grid of {:g} mm over {:g} mm does not have 3 to 4000 points per side",
                                 kMillimetres * step, 2.0 * kMillimetres * reach),
                     "choose another step");
  }
  const auto rows = static_cast<Index>(count[0]), columns = static_cast<Index>(count[1]);
  Matrix Fx(rows, columns), Fy(rows, columns);
  const auto place = [&](Index i, Index j) -> Vector2d {
    return {step * (first[0] + static_cast<double>(i)), step * (first[1] + static_cast<double>(j))};
  };
  for (Index j = 0; j < columns; ++j) {
    for (Index i = 0; i < rows; ++i) {
      const Vector2d force = array.force(place(i, j), disc_rotation);
      Fx(i, j) = force.x();
      Fy(i, j) = force.y();
    }
  }
  GridField grid;
  grid.step = step;
  Index i = 0, j = 0;
  grid.residual = std::sqrt((Fx.cwiseAbs2() + Fy.cwiseAbs2()).minCoeff(&i, &j));
  grid.equilibrium = place(i, j);
  grid.at_border = i == 0 || j == 0 || i == rows - 1 || j == columns - 1;
  const Index i0 = std::max<Index>(i - 1, 0), i1 = std::min(i + 1, rows - 1);
  const Index j0 = std::max<Index>(j - 1, 0), j1 = std::min(j + 1, columns - 1);
  const double along_x = step * static_cast<double>(i1 - i0), along_y = step * static_cast<double>(j1 - j0);
  grid.K << -(Fx(i1, j) - Fx(i0, j)) / along_x, -(Fx(i, j1) - Fx(i, j0)) / along_y,  //
      -(Fy(i1, j) - Fy(i0, j)) / along_x, -(Fy(i, j1) - Fy(i, j0)) / along_y;
  return grid;
}

Linearisation linearisation(const SpringArray& array, const Vector2d& equilibrium, double radius,
                            double disc_rotation) {
  constexpr int kRings = 12, kAngles = 120;
  Linearisation result;
  result.radius = radius;
  const Matrix2d K = array.stiffness(equilibrium, disc_rotation);
  for (int ring = 1; ring <= kRings; ++ring) {
    for (int k = 0; k < kAngles; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / kAngles;
      const Vector2d delta = radius * ring / kRings * Vector2d(std::cos(angle), std::sin(angle));
      const Vector2d force = array.force(equilibrium + delta, disc_rotation);
      result.largest_error = std::max(result.largest_error, (force + K * delta).norm());
      result.largest_force = std::max(result.largest_force, force.norm());
    }
  }
  result.smallest_extension = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < array.springs().size(); ++i) {
    const double shortest = array.length(i, equilibrium, disc_rotation) - radius;
    result.smallest_extension = std::min(result.smallest_extension, shortest - array.springs()[i].rest_length);
  }
  return result;
}

Result<SpringField> spring_field(const SpringArray& array, const Vector2d& start, double radius, double disc_rotation) {
  if (!(radius > 0.0 && std::isfinite(radius))) {
    return bad_usage(fmt::format("the radius of {:g} mm is not above 0", kMillimetres * radius));
  }
  const auto place = MBK_TRY(equilibrium(array, start, disc_rotation));
  SpringField field;
  field.springs = array.springs();
  field.disc_rotation = disc_rotation;
  field.equilibrium = place;
  field.residual = array.force(place, disc_rotation).norm();
  field.moment = array.moment(place, disc_rotation);
  field.K = array.stiffness(place, disc_rotation);
  for (std::size_t i = 0; i < field.springs.size(); ++i) {
    field.lengths.push_back(array.length(i, place, disc_rotation));
    field.tensions.push_back(array.tension(i, place, disc_rotation));
  }
  field.linearisation = linearisation(array, place, radius, disc_rotation);
  return field;
}

Vector2d centre_of_anchors(const std::vector<Spring>& springs) {
  Vector2d sum = Vector2d::Zero();
  double total = 0.0;
  for (const Spring& spring : springs) {
    sum += spring.stiffness * (spring.anchor - spring.hole);
    total += spring.stiffness;
  }
  return total > 0.0 ? Vector2d(sum / total) : sum;
}

}  // namespace mbk::calibration
