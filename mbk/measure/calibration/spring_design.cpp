#include "mbk/measure/calibration/spring_design.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/units.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/quadratic_program.h"
#include "mbk/measure/calibration/spring_array.h"

namespace mbk::calibration {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kStiffnessUnit = 100.0;  // [N/m], k_i of a program in this unit is about 1
constexpr double kForceUnit = 10.0;       // [N], m_i likewise
constexpr Index kEquations = 5;           // f_x, f_y, k_xx, k_yy, k_xy

/// A screw eye that some spring can be hung in, seen from the equilibrium.
struct Place {
  int eye = 0;  ///< from 1
  Vector2d anchor, hole;
  double length = 0.0;                       ///< L
  double longest = 0.0;                      ///< upper bound of the rest length
  Eigen::Matrix<double, kEquations, 2> row;  ///< of [F; K] by k and m, in the units of the program
  Vector deviation;                          ///< F(δ) + K δ for m = 1 unit at every sample δ, x and y in turn [N]
};

Matrix2d across(const Vector2d& u) {
  return Matrix2d::Identity() - u * u.transpose();
}

Place place_of(const SpringRequest& request, std::size_t i) {
  constexpr int kRings = 3, kAngles = 16;
  Place place;
  place.eye = static_cast<int>(i) + 1;
  place.anchor = request.eyes[i];
  place.hole = request.holes.empty() ? Vector2d(0.0, 0.0) : request.holes[i];
  const Vector2d d = request.equilibrium + place.hole - place.anchor;
  place.length = d.norm();
  place.longest = std::min(request.rest_length.second, place.length - request.travel - request.min_extension);
  const Vector2d u = d / place.length;
  const Matrix2d turn = across(u) / place.length;
  place.row.topRows<2>() << -kStiffnessUnit * d, kForceUnit * u;
  place.row.bottomRows<3>() << kStiffnessUnit, -kForceUnit * turn(0, 0),  //
      kStiffnessUnit, -kForceUnit * turn(1, 1),                           //
      0.0, -kForceUnit * turn(0, 1);
  place.deviation.resize(2 * kRings * kAngles);
  Index at = 0;
  for (int ring = 1; ring <= kRings; ++ring) {
    for (int k = 0; k < kAngles; ++k, at += 2) {
      const double angle = 2.0 * std::numbers::pi * k / kAngles;
      const Vector2d delta = request.travel * ring / kRings * Vector2d(std::cos(angle), std::sin(angle));
      const Vector2d moved = (d + delta).normalized();
      place.deviation.segment<2>(at) = kForceUnit * (moved - u - turn * delta);
    }
  }
  return place;
}

using Places = std::vector<const Place*>;

/// The program of a choice of screw eyes: variables k_1 … k_n, m_1 … m_n.
numeric::QuadraticProgram program_of(const Places& places, const SpringRequest& request, const Vector& target) {
  constexpr double kRidge = 1e-6;  // decides where the deviation leaves it open, since it knows nothing of k
  const auto n = static_cast<Index>(places.size());
  Matrix deviation(places.front()->deviation.size(), n);
  numeric::QuadraticProgram program;
  program.C.resize(kEquations, 2 * n);
  program.b = target;
  program.G = Matrix::Zero(4 * n, 2 * n);
  program.h = Vector::Zero(4 * n);
  const double unit_length = kForceUnit / kStiffnessUnit;
  for (Index i = 0; i < n; ++i) {
    const Place& place = *places[static_cast<std::size_t>(i)];
    deviation.col(i) = place.deviation;
    program.C.col(i) = place.row.col(0);
    program.C.col(n + i) = place.row.col(1);
    program.G(4 * i, i) = 1.0;
    program.h[4 * i] = request.stiffness.second / kStiffnessUnit;
    program.G(4 * i + 1, i) = -1.0;
    program.h[4 * i + 1] = -request.stiffness.first / kStiffnessUnit;
    program.G(4 * i + 2, n + i) = 1.0;  // m ≤ l_max k
    program.G(4 * i + 2, i) = -place.longest / unit_length;
    program.G(4 * i + 3, n + i) = -1.0;  // m ≥ l_min k
    program.G(4 * i + 3, i) = request.rest_length.first / unit_length;
  }
  // Equations in the size of their largest number, so that each counts alike.
  for (Index row = 0; row < kEquations; ++row) {
    const double scale = program.C.row(row).cwiseAbs().maxCoeff();
    program.C.row(row) /= scale;
    program.b[row] /= scale;
  }
  program.H = kRidge * Matrix::Identity(2 * n, 2 * n);
  program.H.bottomRightCorner(n, n) += deviation.transpose() * deviation / static_cast<double>(deviation.rows());
  program.g = Vector::Zero(2 * n);
  return program;
}

/// The same bounds, with the equations met as nearly as they can be.
numeric::QuadraticProgram nearest(const numeric::QuadraticProgram& program) {
  constexpr double kRidge = 1e-9;
  numeric::QuadraticProgram relaxed = program;
  const Index n = program.g.size();
  relaxed.H = program.C.transpose() * program.C + kRidge * Matrix::Identity(n, n);
  relaxed.g = -program.C.transpose() * program.b;
  relaxed.C.resize(0, n);
  relaxed.b.resize(0);
  return relaxed;
}

std::vector<Spring> springs_of(const Places& places, const Vector& z) {
  std::vector<Spring> springs;
  const auto n = static_cast<Index>(places.size());
  for (Index i = 0; i < n; ++i) {
    const Place& place = *places[static_cast<std::size_t>(i)];
    const double k = kStiffnessUnit * z[i];
    springs.push_back({k, kForceUnit * z[n + i] / k, place.anchor, place.hole});
  }
  return springs;
}

Result<void> check(const SpringRequest& request) {
  constexpr std::size_t kMinEyes = 3, kMaxEyes = 12;
  const Matrix2d& K = request.K;
  const Vector2d lambda = numeric::symmetric_eigenvalues(K);
  if (!K.allFinite() || K(0, 1) != K(1, 0)) return bad_usage("the target stiffness is not symmetric");
  if (!(lambda[0] > 0.0)) {
    return bad_usage(
        fmt::format("the principal values of the target stiffness are {:g} and {:g} N/m, but both must be above 0",
                    lambda[0], lambda[1]),
        "choose a stiffness that is positive in every direction");
  }
  const auto empty = [](const std::pair<double, double>& range) {
    return !(range.first > 0.0 && range.first < range.second && std::isfinite(range.second));
  };
  if (empty(request.stiffness)) {
    return bad_usage(fmt::format("the stiffness range of the springs from {:g} to {:g} N/m is empty",
                                 request.stiffness.first, request.stiffness.second));
  }
  if (empty(request.rest_length)) {
    return bad_usage(fmt::format("the length range of the springs from {:g} to {:g} mm is empty",
                                 kMillimetres * request.rest_length.first, kMillimetres * request.rest_length.second));
  }
  if (request.eyes.size() < kMinEyes || request.eyes.size() > kMaxEyes) {
    return bad_usage(fmt::format("{} screw eyes are not between {} and {}", request.eyes.size(), kMinEyes, kMaxEyes));
  }
  if (!request.holes.empty() && request.holes.size() != request.eyes.size()) {
    return bad_usage(fmt::format("{} holes were given for {} screw eyes", request.holes.size(), request.eyes.size()));
  }
  if (!(request.travel > 0.0 && request.min_extension >= 0.0)) {
    return bad_usage(
        fmt::format("the travel of {:g} mm is not above 0, or the minimum extension of {:g} mm is below it",
                    kMillimetres * request.travel, kMillimetres * request.min_extension));
  }
  if (request.payload && !(*request.payload > 0.0)) {
    return bad_usage(fmt::format("the payload of {:g} kg is not above 0", *request.payload));
  }
  return {};
}

/// What comes nearest to the target stiffness, in words.
tl::unexpected<Error> out_of_reach(const SpringRequest& request, const Places& all, const std::vector<Places>& choices,
                                   const Vector& target) {
  constexpr double kNoForce = 1e-3;  // [N]
  double best = std::numeric_limits<double>::infinity();
  std::string nearest_words = "no spring of these lengths stays in tension";
  for (const Places& places : choices) {
    const numeric::QuadraticProgram program = program_of(places, request, target);
    const auto solution = numeric::solve_quadratic_program(nearest(program));
    if (!solution) continue;
    Eigen::Matrix<double, kEquations, 1> reached = Eigen::Matrix<double, kEquations, 1>::Zero();
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto at = static_cast<Index>(i), n = static_cast<Index>(places.size());
      reached += places[i]->row * Vector2d(solution->z[at], solution->z[n + at]);
    }
    const double force = reached.head<2>().norm();
    const double miss = (reached - target).tail<3>().norm() + force / request.travel;  // [N/m]
    if (miss >= best) continue;
    best = miss;
    nearest_words =
        fmt::format("the nearest has kxx {:.1f}, kyy {:.1f}, ks {:.1f} N/m", reached[2], reached[3], reached[4]);
    if (force > kNoForce) {
      nearest_words += fmt::format(" and pulls with {:.2g} N", force);
    }
  }
  return fail(
      ErrorKind::not_usable,
      fmt::format("no springs of {:g} to {:g} N/m and {:g} to {:g} mm in {} of {} screw eyes give this stiffness "
                  "at x {:g}, y {:g} mm; {}",
                  request.stiffness.first, request.stiffness.second, kMillimetres * request.rest_length.first,
                  kMillimetres * request.rest_length.second, all.size(), request.eyes.size(),
                  kMillimetres * request.equilibrium.x(), kMillimetres * request.equilibrium.y(), nearest_words),
      "allow shorter or different springs or less travel, or move the frame");
}

/// Every choice of at least 3 of the places.
std::vector<Places> choices_of(const std::vector<Place>& places, int most) {
  constexpr int kMin = 3;  // five equations, two unknowns each
  std::vector<Places> choices;
  for (unsigned set = 0; set < (1u << places.size()); ++set) {
    const int size = std::popcount(set);
    if (size < kMin || size > most) continue;
    Places chosen;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if ((set >> i) & 1u) chosen.push_back(&places[i]);
    }
    choices.push_back(std::move(chosen));
  }
  return choices;
}

}  // namespace

std::vector<Vector2d> frame_eyes(const Vector2d& centre) {
  constexpr double kHalfX = 0.175, kHalfY = 0.183;  // [m]
  std::vector<Vector2d> eyes;
  for (const auto& [x, y] : {std::pair{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}) {
    eyes.push_back(centre + Vector2d(kHalfX * x, kHalfY * y));
  }
  return eyes;
}

Vector2d facing_hole(const Vector2d& eye, const Vector2d& frame_centre) {
  const Vector2d towards = eye - frame_centre;
  const double eighth = std::numbers::pi / 4.0;
  const double angle = eighth * std::round(std::atan2(towards.y(), towards.x()) / eighth);
  return kDiscRadius * Vector2d(std::cos(angle), std::sin(angle));
}

Result<SpringDesign> design_springs(const SpringRequest& request) {
  MBK_TRY(check(request));
  std::vector<Place> places;
  for (std::size_t i = 0; i < request.eyes.size(); ++i) {
    Place place = place_of(request, i);
    if (place.longest > request.rest_length.first) places.push_back(std::move(place));
  }
  Places all;
  for (const Place& place : places) all.push_back(&place);
  const Vector target{{0.0, 0.0, request.K(0, 0), request.K(1, 1), request.K(0, 1)}};
  const std::vector<Places> choices = choices_of(places, request.max_springs);
  double least = std::numeric_limits<double>::infinity();
  const Places* best = nullptr;
  Vector best_z;
  for (const Places& chosen : choices) {
    const auto solution = numeric::solve_quadratic_program(program_of(chosen, request, target));
    if (!solution || solution->value >= least) continue;
    least = solution->value;
    best = &chosen;
    best_z = solution->z;
  }
  if (best == nullptr) return out_of_reach(request, all, choices, target);
  const auto array = MBK_TRY(SpringArray::create(springs_of(*best, best_z)));
  auto field = MBK_TRY(spring_field(array, request.equilibrium, request.travel));
  SpringDesign design;
  design.field = std::move(field);
  for (const Place* place : *best) design.eyes.push_back(place->eye);
  design.target_K = request.K;
  design.target_equilibrium = request.equilibrium;
  design.payload = request.payload;
  if (request.payload) {
    const Vector2d lambda = numeric::symmetric_eigenvalues(design.field.K);
    design.natural_frequency = (lambda / *request.payload).cwiseSqrt() / (2.0 * std::numbers::pi);
  }
  return design;
}

}  // namespace mbk::calibration
