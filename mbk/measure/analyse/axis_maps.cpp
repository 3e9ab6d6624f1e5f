#include "mbk/measure/analyse/axis_maps.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "mbk/base/core/units.h"
#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/rotation.h"
#include "mbk/base/numeric/statistics.h"
#include "mbk/measure/analyse/channel_cure.h"
#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/trial/filtered_band.h"
#include "mbk/model/trial/quantity_channels.h"

namespace mbk::analyse {
namespace {

constexpr double kSure = numeric::kNormal95;  ///< standard errors from zero
constexpr double kClearly = 0.05;             ///< of the largest eigenvalue: what is below zero by less may be bias
constexpr double kNearly = 0.25;              ///< of the largest: so far below zero bias may draw the third matrix
constexpr double kAligned = 0.8;              ///< share of a matrix that a signed permutation must explain
constexpr double kSmallestMotion = 0.05;      ///< across the main direction: below, one axis tells nothing
constexpr double kBothMoved = 0.2;   ///< the same, for what no map explains: a guide that holds one axis does that too
constexpr double kTurned = 20.0;     ///< degrees from which a rotation is told
constexpr double kSameAngle = 10.0;  ///< degrees within which M, B and K must agree on it
constexpr double kAsymmetric = 4.4;  ///< standard errors of m_yx − m_xy: 10⁻⁵ by chance
constexpr double kAsymmetricInSpace = 25.9;  ///< χ² of the antisymmetric vector of M, 3 degrees of freedom: likewise
/// χ² of the antisymmetric parts of B and K, or of K alone, that one parameter leaves, 0.1 % by chance.
constexpr double kAgreeOfThree = 13.8, kAgreeOfTwo = 10.8;
constexpr double kAgreeOfThreeInSpace = 22.5, kAgreeOfTwoInSpace = 16.3;  ///< the same after a rotation in space
constexpr double kGainsOfThreeInSpace = 24.3, kGainsOfTwoInSpace = 18.5;  ///< the same after two gains

/// F = R·(F as read), R a signed permutation: row i takes `from[i]` with `sign[i]`.
struct AxisMap {
  std::array<int, 3> from{0, 1, 2};
  std::array<double, 3> sign{1.0, 1.0, 1.0};

  [[nodiscard]] Matrix matrix(Index axes) const {
    Matrix R = Matrix::Zero(axes, axes);
    for (Index i = 0; i < axes; ++i) R(i, from[static_cast<std::size_t>(i)]) = sign[static_cast<std::size_t>(i)];
    return R;
  }
  [[nodiscard]] AxisMap transposed() const {
    AxisMap result;
    for (std::size_t i = 0; i < from.size(); ++i) {
      const auto j = static_cast<std::size_t>(from[i]);
      result.from[j] = static_cast<int>(i);
      result.sign[j] = sign[i];
    }
    return result;
  }
  [[nodiscard]] bool exchanges() const { return !std::ranges::is_sorted(from); }
  [[nodiscard]] bool reverses_all(int axes) const {
    return !exchanges() && std::all_of(sign.begin(), sign.begin() + axes, [](double s) { return s < 0.0; });
  }
  friend bool operator==(const AxisMap&, const AxisMap&) = default;
};

std::vector<AxisMap> all_maps(int axes) {
  std::vector<AxisMap> maps;
  AxisMap map;
  do {
    for (unsigned signs = 0; signs < (1U << axes); ++signs) {
      for (int i = 0; i < axes; ++i) {
        map.sign[static_cast<std::size_t>(i)] = ((signs >> (axes - 1 - i)) & 1U) != 0 ? -1.0 : 1.0;
      }
      maps.push_back(map);
    }
  } while (std::next_permutation(map.from.begin(), map.from.begin() + axes));
  return maps;
}

/// What the symmetric part of a matrix is.
struct Sign {
  bool positive = false, negative = false;  ///< surely, in every direction | surely, in one
  bool nearly = true;                       ///< at most so far below zero as bias draws it
};

/// Of R Z, Z one of M, B, K; its smallest eigenvalue has the standard error of the delta method,
///   dλ = vᵀ R dZ v.
Sign sign_of(const Matrix& R, const Matrix& Z, const Identification& id, Index part) {
  const Index n = Z.rows();
  const auto [values, vectors] = numeric::symmetric_eigen(impedance::symmetric_part(Matrix(R * Z)));
  const Vector v = vectors.col(0), left = R.transpose() * v;
  Vector gradient(n * n);
  for (Index i = 0; i < n; ++i) gradient.segment(i * n, n) = left[i] * v;
  const double variance = gradient.dot(id.covariance.block(part * n * n, part * n * n, n * n, n * n) * gradient);
  const double error = kSure * std::sqrt(std::max(0.0, variance));
  const double largest = values.cwiseAbs().maxCoeff();
  Sign sign;
  sign.positive = values[0] > error;
  sign.negative = values[0] < -error && values[0] < -kClearly * largest;
  sign.nearly = values[0] > -error || values[0] > -kNearly * largest;
  return sign;
}

/// How many of M, B, K are surely positive, how many surely not, and whether the others nearly are.
struct Tally {
  int positive = 0, negative = 0;
  bool passable = true;
};

Tally tally(const AxisMap& map, const Identification& id) {
  Tally result;
  const Matrix R = map.matrix(id.axes);
  const std::array<const Matrix*, 3> parts = {&id.model.M, &id.model.B, &id.model.K};
  for (Index part = 0; part < 3; ++part) {
    if (part == 1 && id.structure == Structure::mass_spring) continue;
    const Sign sign = sign_of(R, *parts[static_cast<std::size_t>(part)], id, part);
    result.positive += sign.positive ? 1 : 0;
    result.negative += sign.negative ? 1 : 0;
    result.passable = result.passable && sign.nearly;
  }
  return result;
}

/// How far a matrix is turned [degrees] about each axis, and the standard error of that angle.
struct Turn {
  Vector angle;  ///< the rotation vector; in the plane one number
  double standard_error = 0;

  [[nodiscard]] double size() const { return angle.norm(); }
};

/// Of Z = R S with S symmetric and positive, the rotation R; nothing where it mirrors.
std::optional<Turn> turn_in_space(const Matrix& Z, const Matrix& error) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(Eigen::Matrix3d(Z), Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d R = svd.matrixU() * svd.matrixV().transpose();
  const Eigen::Vector3d s = svd.singularValues();
  if (!(R.determinant() > 0.0) || !(s[1] > 0.0)) return std::nullopt;
  const Eigen::AngleAxisd turn(R);
  return Turn{kDegrees * turn.angle() * turn.axis(), kDegrees * error.norm() / (s[1] + s[2])};
}

/// The same of a matrix of the plane.
std::optional<Turn> turn_of(const Matrix& Z, const Matrix& error) {
  if (Z.rows() == 3) return turn_in_space(Z, error);
  const double cosine = Z(0, 0) + Z(1, 1), sine = Z(1, 0) - Z(0, 1);
  const double mirror = std::hypot(Z(0, 0) - Z(1, 1), Z(0, 1) + Z(1, 0)), turn = std::hypot(cosine, sine);
  if (!(turn > mirror)) return std::nullopt;
  return Turn{Vector::Constant(1, kDegrees * std::atan2(sine, cosine)), kDegrees * error.norm() / turn};
}

/// Whether M and K are nearly symmetric by a map: columns of other things may become positive, but lopsided.
bool symmetric_by(const AxisMap& map, const Identification& id) {
  if (id.axes == 1) return true;
  const Matrix R = map.matrix(id.axes);
  for (const auto& [Z, error] :
       {std::pair{&id.model.M, &id.standard_error.M}, std::pair{&id.model.K, &id.standard_error.K}}) {
    const auto turn = turn_of(R * *Z, *error);
    if (!turn || turn->size() - kSure * turn->standard_error > kTurned) return false;
  }
  return true;
}

constexpr int kEnough = 2;  ///< of M, B and K: bias may draw one of them below zero

bool can_be_judged(const Identification& id) {
  if (!id.model.M.allFinite() || !id.model.K.allFinite() || !id.covariance.allFinite()) return false;
  if (std::ranges::any_of(id.preparations, cuts_into_band)) return false;
  return id.axes == 1 || !(id.excitation.motion_ratio < kSmallestMotion);
}

/// Whether the model cannot be a limb's as it was given.
bool contradicts(const Identification& id) {
  return can_be_judged(id) && tally(AxisMap{}, id).negative >= kEnough;
}

/// The map by which such a model becomes passive and symmetric.
std::optional<AxisMap> map_of(const Identification& id) {
  if (!contradicts(id)) return std::nullopt;
  for (const AxisMap& map : all_maps(id.axes)) {
    const Tally one = tally(map, id);
    if (one.positive >= kEnough && one.passable && symmetric_by(map, id)) return map;
  }
  return std::nullopt;
}

/// The signed permutation nearest to A, where one explains most of it.
std::optional<AxisMap> nearest_map(const Matrix& A) {
  if (!A.allFinite()) return std::nullopt;
  std::optional<AxisMap> best;
  double most = kAligned * numeric::singular_values(A).sum();
  for (const AxisMap& map : all_maps(static_cast<int>(A.rows()))) {
    const double explained = map.matrix(A.rows()).cwiseProduct(A).sum();
    if (!(explained > most)) continue;
    most = explained;
    best = map;
  }
  return best;
}

/// What the reference says of the motion's axes, where it is a position, or of the force's, where it is a force that
/// the hand opposes: A of y ≈ A r, each axis in standard deviations.
std::optional<AxisMap> map_by_reference(const std::vector<PreparedTrial>& trials) {
  const PreparedTrial& trial = trials.front();
  const bool position = trial.reference_quantity == ReferenceQuantity::position;
  if (trial.reference.size() == 0 || (!position && trial.reference_quantity != ReferenceQuantity::force)) {
    return std::nullopt;
  }
  // From all segments together: within one pulse the reference may be constant.
  std::vector<Index> rows;
  for (const Segment& segment : trial.segments) {
    for (Index i = segment.begin; i < segment.end; ++i) rows.push_back(i);
  }
  const auto centred = [&](const Matrix& all) {
    const Matrix those = all(rows, Eigen::all);
    return Matrix(those.rowwise() - those.colwise().mean());
  };
  const Matrix r = centred(trial.reference);
  const Matrix y = position ? centred(trial.position) : Matrix(-centred(trial.force_hand_on_robot));
  const Matrix rr = r.transpose() * r, yr = y.transpose() * r, yy = y.transpose() * y;
  const Vector scale_r = rr.diagonal().cwiseSqrt(), scale_y = yy.diagonal().cwiseSqrt();
  if (!(scale_r.minCoeff() > 0.0 && scale_y.minCoeff() > 0.0)) return std::nullopt;
  return nearest_map(scale_y.cwiseInverse().asDiagonal() * yr * scale_r.cwiseInverse().asDiagonal());
}

/// "with Fx and Fy exchanged", "with Fx, Fy and Fz read as Fy, Fz and Fx", "with the sign of Fy reversed".
std::string in_words(const AxisMap& map, const std::vector<std::string>& names) {
  const auto name_at = [&](int axis) { return names[static_cast<std::size_t>(axis)]; };
  std::vector<std::string> moved, takes;
  std::string signs;
  for (std::size_t axis = 0; axis < names.size(); ++axis) {
    const std::string from = name_at(map.from[axis]);
    if (from != names[axis]) {
      moved.push_back(names[axis]);
      takes.push_back(from);
    }
    if (map.sign[axis] < 0.0) signs += (signs.empty() ? "" : " and ") + from;
  }
  std::string text;
  if (moved.size() == 2) text = fmt::format("with {} and {} exchanged", moved[0], moved[1]);
  if (moved.size() == 3) text = fmt::format("with {} read as {}", fmt::join(moved, ", "), fmt::join(takes, ", "));
  if (!signs.empty()) text += (text.empty() ? "with the sign of " : " and the sign of ") + signs + " reversed";
  return text;
}

/// A map as it is said: of the force, or of the motion.
struct Reading {
  std::string words;  ///< "with Fx and Fy exchanged"
  std::string text;   ///< the same, and the options that do it

  Reading(const Recording& recording, const QuantityChannels& quantity, const AxisMap& map, int axes)
      : words(in_words(map, names_of(recording, quantity, axes))) {
    const bool motion = quantity.one_axis == kPositionChannels.one_axis;
    ChannelCure cure;
    for (std::size_t i = 0; i < map.from.size(); ++i) {
      (motion ? cure.position : cure.force)[i] = {map.from[i], map.sign[i] < 0.0, "", 1.0};
    }
    const auto option = cured_channels(recording, axes, cure);
    text = words + (option ? ": " + *option : ", using --channels, where a minus reverses the sign: Fx=-10");
  }

 private:
  static std::vector<std::string> names_of(const Recording& recording, const QuantityChannels& quantity, int axes) {
    std::vector<std::string> names;
    for (int axis = 0; axis < axes; ++axis) names.push_back(name_of(recording, quantity, axes, axis));
    return names;
  }
};

/// By how many degrees the force is turned against the motion, where M, B and K say the same.
std::optional<Vector> turned(const Identification& id) {
  if (id.axes < 2 || id.structure != Structure::full || !can_be_judged(id)) return std::nullopt;
  std::vector<Turn> turns;
  for (const auto& [Z, error] :
       {std::pair{&id.model.M, &id.standard_error.M}, std::pair{&id.model.B, &id.standard_error.B},
        std::pair{&id.model.K, &id.standard_error.K}}) {
    const auto turn = turn_of(*Z, *error);
    if (!turn || !(turn->standard_error < kSameAngle)) return std::nullopt;
    turns.push_back(*turn);
  }
  Vector sum = Vector::Zero(turns.front().angle.size());
  double weight = 0.0;
  for (const Turn& one : turns) {
    if (one.size() < kTurned) return std::nullopt;
    for (const Turn& other : turns) {
      if ((one.angle - other.angle).norm() > 2.0 * kSameAngle) return std::nullopt;
    }
    sum += one.angle / (one.standard_error * one.standard_error);
    weight += 1.0 / (one.standard_error * one.standard_error);
  }
  return Vector(sum / weight);
}

/// "by 12°", "by 12° about [0.10, −0.20, 0.97]"
std::string rotation_text(const Vector& angle, const std::string& size) {
  if (angle.size() == 1) return "by " + size;
  const Vector axis = angle.normalized();
  return fmt::format("by {} about [{:.2f}, {:.2f}, {:.2f}]", size, axis[0], axis[1], axis[2]);
}

/// What to do about a force that is turned by so many degrees.
std::string turn_back(const Vector& angle) {
  return fmt::format(
      "if the force sensor is mounted at that angle, correct it with --force-rotation-deg {:.1f}; if instead the frame "
      "of the position is rotated, M, B and K are in that frame",
      fmt::join(Vector(-angle), ","));
}

/// Parameters that make M, B and K symmetric: a rotation or a gain.
struct Symmetric {
  Vector value, standard_error;
  double misfit = 0;  ///< χ² of the antisymmetric parts that are left

  /// Akaike's: smaller is better.
  [[nodiscard]] double criterion() const { return misfit + 2.0 * static_cast<double>(value.size()); }
};

/// D(p) Z symmetric for each Z of M, B and K: minimises aᵀ V⁻¹ a over p, a of the antisymmetric parts and V their
/// covariance, by Gauss–Newton.
/// @param map  D of p, and its derivatives    @param moved  p after a step
template <class Map, class Moved>
std::optional<Symmetric> made_symmetric(const Identification& id, std::span<const Index> parts, const Vector& start,
                                        const Map& map, const Moved& moved) {
  Matrix M = id.model.M;
  M.diagonal().array() += id.handle_mass;  // the sensor carries the handle too
  const std::array<const Matrix*, 3> all = {&M, &id.model.B, &id.model.K};
  const Index n = id.axes, pairs = n * (n - 1) / 2, count = pairs * std::ssize(parts);
  Vector left(count);
  Matrix slope(count, start.size()), to_parts = Matrix::Zero(count, id.covariance.rows());
  Symmetric result{start, {}, 0.0};
  constexpr int kSteps = 20;
  for (int step = 0; step < kSteps; ++step) {
    const auto [D, derivatives] = map(result.value);
    Index row = 0;
    for (const Index part : parts) {
      const Matrix& Z = *all[static_cast<std::size_t>(part)];
      const Matrix turned = D * Z;
      for (Index i = 1; i < n; ++i) {
        for (Index j = 0; j < i; ++j, ++row) {
          left[row] = turned(i, j) - turned(j, i);
          for (Index p = 0; p < start.size(); ++p) {
            const Matrix change = derivatives[static_cast<std::size_t>(p)] * Z;
            slope(row, p) = change(i, j) - change(j, i);
          }
          for (Index k = 0; k < n; ++k) {
            to_parts(row, part * n * n + k * n + j) = D(i, k);
            to_parts(row, part * n * n + k * n + i) = -D(j, k);
          }
        }
      }
    }
    const numeric::PivotedCholesky weight(Matrix(to_parts * id.covariance * to_parts.transpose()));
    const Matrix gain = weight.solve(slope), information = slope.transpose() * gain;
    if (!(numeric::symmetric_eigenvalues(information).minCoeff() > 0.0)) return std::nullopt;
    const Matrix spread = numeric::inverse(information);
    result.standard_error = spread.diagonal().cwiseSqrt();
    result.misfit = left.dot(Vector(weight.solve(left)));
    const Vector move = -spread * gain.transpose() * left;
    if (!move.allFinite()) return std::nullopt;
    if (((move.cwiseAbs() - 1e-3 * result.standard_error).array() < 0.0).all()) return result;
    result.value = moved(result.value, move);
  }
  return std::nullopt;
}

/// R(−θ) F instead of F; in space θ is a rotation vector.
std::optional<Symmetric> turned_by(const Identification& id, std::span<const Index> parts) {
  if (id.axes == 3) {
    return made_symmetric(
        id, parts, Vector::Zero(3),
        [](const Vector& turn) {
          const Eigen::Matrix3d D = numeric::rotation_matrix(turn).transpose();
          std::vector<Matrix> derivatives;
          for (Index k = 0; k < 3; ++k) {
            derivatives.emplace_back(-numeric::cross_matrix(Eigen::Vector3d::Unit(k)) * D);
          }
          return std::pair(Matrix(D), derivatives);
        },
        [](const Vector& turn, const Vector& move) {
          const Eigen::AngleAxisd both(
              Eigen::Matrix3d(numeric::rotation_matrix(turn) * numeric::rotation_matrix(move)));
          return Vector(both.angle() * both.axis());
        });
  }
  return made_symmetric(
      id, parts, Vector::Zero(1),
      [](const Vector& angle) {
        const double c = std::cos(angle[0]), s = std::sin(angle[0]);
        Matrix turn(2, 2), derivative(2, 2);
        turn << c, s, -s, c;
        derivative << -s, c, -c, -s;
        return std::pair(turn, std::vector{derivative});
      },
      [](const Vector& angle, const Vector& move) { return Vector(angle + move); });
}

/// F_y/g_y instead of F_y, and so on: gains relative to that of F_x.
std::optional<Symmetric> scaled_by(const Identification& id, std::span<const Index> parts) {
  const Index n = id.axes;
  return made_symmetric(
      id, parts, Vector::Ones(n - 1),
      [n](const Vector& gain) {
        Matrix scale = Matrix::Identity(n, n);
        std::vector<Matrix> derivatives;
        for (Index axis = 1; axis < n; ++axis) {
          const double one = gain[axis - 1];
          scale(axis, axis) = 1.0 / one;
          derivatives.emplace_back(Matrix::Zero(n, n)).coeffRef(axis, axis) = -1.0 / (one * one);
        }
        return std::pair(scale, derivatives);
      },
      [](const Vector& gain, const Vector& move) { return Vector(gain + move); });
}

/// "Fy were 1.2 ± 0.1 times too large relative to Fx"
std::string gains_text(const Symmetric& scale) {
  std::string text;
  for (Index axis = 0; axis < scale.value.size(); ++axis) {
    text += fmt::format("{}F{} were {:.3g} ± {:.2g}", axis > 0 ? " and " : "", "yz"[axis], scale.value[axis],
                        numeric::kNormal95 * scale.standard_error[axis]);
  }
  return text + " times too large relative to Fx";
}

/// Whether a limb that is no M, B and K biases the inertia, too.
bool biased(const Identification& id) {
  constexpr std::array kBiasing = {WarningCode::missing_dynamics,  WarningCode::nonlinear_stiffness,
                                   WarningCode::dry_friction,      WarningCode::stiffness_changes,
                                   WarningCode::damping_changes,   WarningCode::memory,
                                   WarningCode::even_nonlinearity, WarningCode::unmodelled_response};
  return std::ranges::any_of(id.warnings,
                             [&](const Warning& one) { return std::ranges::count(kBiasing, one.code) > 0; });
}

/// How far the inertia is from symmetric.
struct Asymmetry {
  Vector difference;      ///< m_yx − m_xy, and so on [kg]; empty where it is not known
  double errors = 0;      ///< its size in standard errors, or √χ² in space
  bool is_clear = false;  ///< beyond chance

  [[nodiscard]] bool agrees(const Asymmetry& other) const {
    return is_clear && other.is_clear && difference.dot(other.difference) > 0.0;
  }
};

Asymmetry asymmetry_of(const Identification& id) {
  const Index n = id.axes;
  if (n == 1 || id.structure == Structure::symmetric || !can_be_judged(id)) return {};
  Asymmetry found{Vector(n * (n - 1) / 2)};
  Matrix to_difference = Matrix::Zero(found.difference.size(), n * n);
  Index row = 0;
  for (Index i = 1; i < n; ++i) {
    for (Index j = 0; j < i; ++j, ++row) {
      found.difference[row] = id.model.M(i, j) - id.model.M(j, i);
      to_difference(row, n * i + j) = 1.0;
      to_difference(row, n * j + i) = -1.0;
    }
  }
  const Matrix spread = to_difference * id.covariance.topLeftCorner(n * n, n * n) * to_difference.transpose();
  if (!(numeric::symmetric_eigenvalues(spread).minCoeff() > 0.0)) return {};
  found.errors = std::sqrt(found.difference.dot(Vector(numeric::PivotedCholesky(spread).solve(found.difference))));
  found.is_clear = found.errors > (n == 2 ? kAsymmetric : std::sqrt(kAsymmetricInSpace));
  return found;
}

/// "the inertia is not symmetric, …: m_yx − m_xy is −0.3 ± 0.05 kg"
std::string asymmetry_text(const Asymmetry& found, const Matrix& M) {
  const std::string what = "the inertia is not symmetric, which is impossible for a limb: ";
  if (found.difference.size() == 1) {
    const double difference = found.difference[0];
    return what + fmt::format("m_yx − m_xy is {:.2g} ± {:.1g} kg", difference,
                              numeric::kNormal95 * std::abs(difference / found.errors));
  }
  return what + fmt::format("m_yx − m_xy is {:.2g}, m_zx − m_xz {:.2g} and m_zy − m_yz {:.2g} kg", M(1, 0) - M(0, 1),
                            M(2, 0) - M(0, 2), M(2, 1) - M(1, 2));
}

/// Whether the reference moves the limb along all axes. Along one that it does not move, least squares finds the
/// negative robot, whose sign says nothing of how the axes were read.
bool moved_by_reference(const Measurement& measured) {
  constexpr double kMoves = 10.0;  // first-stage F (Staiger & Stock 1997, Econometrica 65:557)
  for (const Identification* id : {&measured.identification, measured.alternative ? &*measured.alternative : nullptr}) {
    if (id != nullptr && id->instrument) return id->instrument->weakest() > kMoves;
  }
  return true;
}

}  // namespace

std::optional<Warning> check_axes(const std::vector<const Recording*>& recordings,
                                  const std::vector<PreparedTrial>& trials, const Measurement& measured) {
  const Recording& recording = *recordings.front();
  const Identification& id = measured.identification;
  const int axes = id.axes;
  // So few data have no sign that could be trusted.
  if (std::ranges::find(id.warnings, WarningCode::too_little_data, &Warning::code) != id.warnings.end()) {
    return std::nullopt;
  }
  if (!moved_by_reference(measured)) return std::nullopt;
  std::optional<AxisMap> map = map_of(id);
  if (!map && measured.alternative) map = map_of(*measured.alternative);
  if (!map) {
    const auto angle = turned(id);
    const bool both_axes_moved = axes > 1 && id.excitation.motion_ratio > kBothMoved;
    if (!angle && both_axes_moved && contradicts(id) && (!measured.alternative || contradicts(*measured.alternative))) {
      return Warning{WarningCode::axes_mismatched,
                     "force and motion are inconsistent for a limb, with any sign and order of the axes",
                     "check with 'mbk info' that --channels names the columns of the hand's force and position, all in "
                     "the same frame"};
    }
    if (!angle) return std::nullopt;
    return Warning{WarningCode::axes_mismatched,
                   fmt::format("the force is rotated {} relative to the motion: inertia, damping and stiffness "
                               "are all asymmetric by that angle, which is impossible for a limb",
                               rotation_text(*angle, fmt::format("{:.0f}°", axes == 2 ? (*angle)[0] : angle->norm()))),
                   turn_back(*angle)};
  }
  // Either the force as read is Rᵀ F, or the motion as read is R x. In the second case the reference, which moves x,
  // reveals R.
  const bool by_position = trials.front().reference_quantity == ReferenceQuantity::position;
  const auto seen = map_by_reference(trials);
  const AxisMap identity;
  const bool motion = seen && *seen == (by_position ? *map : identity);
  const bool force = seen && *seen == (by_position ? identity : map->transposed());
  const Reading of_force(recording, kForceChannels, *map, axes),
      of_motion(recording, kPositionChannels, map->transposed(), axes);
  const Reading& likelier = motion ? of_motion : of_force;
  std::string remedy =
      "F must be the force of the limb on the machine, in the frame of the position: read it " + likelier.text;
  if (!motion && !force) remedy += "; or, if the motion was read wrongly, " + of_motion.text;
  if (map->reverses_all(axes)) {
    return Warning{
        WarningCode::force_sign_reversed,
        "inertia, damping and stiffness have the wrong sign for a limb: the force was probably recorded with the "
        "opposite sign",
        remedy};
  }
  return Warning{
      WarningCode::axes_mismatched,
      fmt::format("force and motion are inconsistent for a limb as given, but consistent {}", likelier.words), remedy};
}

std::optional<Warning> check_symmetry(const Measurement& measured) {
  const Identification& id = measured.identification;
  if (std::ranges::find(id.warnings, WarningCode::too_little_data, &Warning::code) != id.warnings.end() ||
      !moved_by_reference(measured)) {
    return std::nullopt;
  }
  const Asymmetry asymmetry = asymmetry_of(id);
  if (!asymmetry.is_clear) return std::nullopt;
  if (measured.alternative && measured.alternative->usable && !asymmetry_of(*measured.alternative).agrees(asymmetry)) {
    return std::nullopt;
  }
  constexpr std::array<Index, 3> kAll = {0, 1, 2};
  constexpr std::array<Index, 2> kUndamped = {0, 2};
  constexpr std::array<Index, 1> kInertia = {0};
  const bool damped = id.structure == Structure::full;
  const std::span<const Index> parts = damped ? std::span<const Index>(kAll) : std::span<const Index>(kUndamped);
  const bool in_space = id.axes == 3;
  const double agree =
      damped ? (in_space ? kAgreeOfThreeInSpace : kAgreeOfThree) : (in_space ? kAgreeOfTwoInSpace : kAgreeOfTwo);
  std::optional<Symmetric> turn = turned_by(id, parts);
  const auto scale = scaled_by(id, parts);
  const bool turn_fits = turn && turn->misfit < agree;
  const double agree_scaled = !in_space ? agree : damped ? kGainsOfThreeInSpace : kGainsOfTwoInSpace;
  const std::string what = asymmetry_text(asymmetry, id.model.M);
  const bool scale_fits = scale && scale->misfit < agree_scaled && scale->value.minCoeff() > 0.0;
  if (scale_fits && (!turn_fits || scale->criterion() < turn->criterion())) {
    return Warning{
        WarningCode::inertia_not_symmetric,
        fmt::format("{}; M, B and K would be symmetric if {}", what, gains_text(*scale)),
        fmt::format("check the gain of {} force axes with 'mbk sensor calibrate'", in_space ? "all" : "both")};
  }
  if (!turn_fits && biased(id)) return std::nullopt;  // the cause of the bias is reported already
  if (!turn_fits) turn = turned_by(id, kInertia);
  if (!turn) {
    return Warning{WarningCode::inertia_not_symmetric, what,
                   "check the frames, gains and crosstalk of force and position"};
  }
  const Vector angle = kDegrees * turn->value;
  const double half = kDegrees * numeric::kNormal95 * turn->standard_error.maxCoeff();
  const std::string rotated =
      rotation_text(angle, fmt::format("{:.1f}° ± {:.1f}°", in_space ? angle.norm() : angle[0], half));
  return Warning{
      WarningCode::inertia_not_symmetric,
      turn_fits ? fmt::format("{}: the force is rotated {} relative to the motion, or has crosstalk", what, rotated)
                : fmt::format("{}: according to M alone the force is rotated {} relative to the motion, but B and K "
                              "contradict this: gains, crosstalk or reflexes may be the cause",
                              what, rotated),
      (turn_fits ? "" : "check the gains and the crosstalk of the force with 'mbk sensor calibrate'; ") +
          turn_back(angle)};
}

}  // namespace mbk::analyse
