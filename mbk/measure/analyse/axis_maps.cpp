#include "mbk/measure/analyse/axis_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "mbk/base/core/units.h"
#include "mbk/base/numeric/dense.h"
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
constexpr double kAgreeOfThree = 13.8, kAgreeOfTwo = 10.8;  ///< χ² of 2 and 1 degrees of freedom, 0.1 % by chance

/// F = R·(F as read), R a signed permutation: row i takes `from[i]` with `sign[i]`.
struct AxisMap {
  std::array<int, 2> from{0, 1};
  std::array<double, 2> sign{1.0, 1.0};

  [[nodiscard]] Matrix matrix(Index axes) const {
    Matrix R = Matrix::Zero(axes, axes);
    for (Index i = 0; i < axes; ++i) R(i, from[static_cast<std::size_t>(i)]) = sign[static_cast<std::size_t>(i)];
    return R;
  }
  [[nodiscard]] AxisMap transposed() const {
    AxisMap result;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto j = static_cast<std::size_t>(from[i]);
      result.from[j] = static_cast<int>(i);
      result.sign[j] = sign[i];
    }
    return result;
  }
  [[nodiscard]] bool exchanges() const { return from[0] != 0; }
  friend bool operator==(const AxisMap&, const AxisMap&) = default;
};

std::vector<AxisMap> all_maps(int axes) {
  if (axes == 1) return {{{0, 1}, {1.0, 1.0}}, {{0, 1}, {-1.0, 1.0}}};
  std::vector<AxisMap> maps;
  for (const std::array<int, 2> from : {std::array{0, 1}, std::array{1, 0}}) {
    for (const double first : {1.0, -1.0}) {
      for (const double second : {1.0, -1.0}) maps.push_back({from, {first, second}});
    }
  }
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

/// How far a matrix is turned [degrees] and that angle's standard error; nothing where it mirrors.
std::optional<std::pair<double, double>> turn_of(const Matrix& Z, const Matrix& error) {
  const double cosine = Z(0, 0) + Z(1, 1), sine = Z(1, 0) - Z(0, 1);
  const double mirror = std::hypot(Z(0, 0) - Z(1, 1), Z(0, 1) + Z(1, 0)), turn = std::hypot(cosine, sine);
  if (!(turn > mirror)) return std::nullopt;
  return std::pair(kDegrees * std::atan2(sine, cosine), kDegrees * error.norm() / turn);
}

/// Whether M and K are nearly symmetric by a map: columns of other things may become positive, but lopsided.
bool symmetric_by(const AxisMap& map, const Identification& id) {
  if (id.axes == 1) return true;
  const Matrix R = map.matrix(id.axes);
  for (const auto& [Z, error] :
       {std::pair{&id.model.M, &id.standard_error.M}, std::pair{&id.model.K, &id.standard_error.K}}) {
    const auto turn = turn_of(R * *Z, *error);
    if (!turn || std::abs(turn->first) - kSure * turn->second > kTurned) return false;
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

/// "with Fx and Fy exchanged", "with the sign of Fy reversed".
std::string in_words(const AxisMap& map, const std::string& first, const std::string& second, int axes) {
  std::string text;
  if (map.exchanges()) text = fmt::format("with {} and {} exchanged", first, second);
  std::string signs;
  for (int axis = 0; axis < axes; ++axis) {
    if (map.sign[static_cast<std::size_t>(axis)] > 0.0) continue;
    signs += (signs.empty() ? "" : " and ") + (map.from[static_cast<std::size_t>(axis)] == 0 ? first : second);
  }
  if (!signs.empty()) text += (text.empty() ? "with the sign of " : " and the sign of ") + signs + " reversed";
  return text;
}

/// A map as it is said: of the force, or of the motion.
struct Reading {
  std::string words;  ///< "with Fx and Fy exchanged"
  std::string text;   ///< the same, and the options that do it

  Reading(const Recording& recording, const QuantityChannels& quantity, const AxisMap& map, int axes)
      : words(in_words(map, name_of(recording, quantity, axes, 0),
                       axes == 2 ? name_of(recording, quantity, axes, 1) : "", axes)) {
    const bool motion = quantity.one_axis == kPositionChannels.one_axis;
    ChannelCure cure;
    for (std::size_t i = 0; i < 2; ++i) {
      (motion ? cure.position : cure.force)[i] = {map.from[i], map.sign[i] < 0.0, "", 1.0};
    }
    const auto option = cured_channels(recording, axes, cure);
    text = words + (option ? ": " + *option : ", using --channels, where a minus reverses the sign: Fx=-10");
  }
};

/// By how many degrees the force is turned against the motion, where M, B and K say the same.
std::optional<double> turned(const Identification& id) {
  if (id.axes != 2 || id.structure != Structure::full || !can_be_judged(id)) return std::nullopt;
  double sum = 0.0, weight = 0.0, least = 360.0, most = -360.0;
  for (const auto& [Z, error] :
       {std::pair{&id.model.M, &id.standard_error.M}, std::pair{&id.model.B, &id.standard_error.B},
        std::pair{&id.model.K, &id.standard_error.K}}) {
    const auto turn = turn_of(*Z, *error);
    if (!turn || !(turn->second < kSameAngle)) return std::nullopt;
    least = std::min(least, turn->first);
    most = std::max(most, turn->first);
    sum += turn->first / (turn->second * turn->second);
    weight += 1.0 / (turn->second * turn->second);
  }
  const double angle = sum / weight;
  if (most - least > 2.0 * kSameAngle || std::min(std::abs(least), std::abs(most)) < kTurned || least * most < 0.0) {
    return std::nullopt;
  }
  return angle;
}

/// What to do about a force that is turned by so many degrees.
std::string turn_back(double angle) {
  return fmt::format(
      "if the force sensor is mounted at that angle, correct it with --force-rotation-deg {:.1f}; if instead the frame "
      "of the position is rotated, M, B and K are in that frame",
      -angle);
}

/// One parameter that makes M, B and K symmetric.
struct Symmetric {
  double value = 0, standard_error = 0;
  double misfit = 0;  ///< χ² of the antisymmetric parts that are left, of one degree less than there are matrices
};

/// D(p) Z symmetric for each Z of M, B and K: minimises aᵀ V⁻¹ a over p, a of the antisymmetric parts and V their
/// covariance, by Gauss–Newton.
/// @param map  D of p, and its derivative
template <class Map>
std::optional<Symmetric> made_symmetric(const Identification& id, std::span<const Index> parts, double start,
                                        const Map& map) {
  Matrix M = id.model.M;
  M.diagonal().array() += id.handle_mass;  // the sensor carries the handle too
  const std::array<const Matrix*, 3> all = {&M, &id.model.B, &id.model.K};
  const auto count = static_cast<Index>(parts.size());
  Vector left(count), slope(count), gain;
  Matrix to_parts = Matrix::Zero(count, id.covariance.rows());
  Symmetric result{start};
  constexpr int kSteps = 20;
  for (int step = 0; step < kSteps; ++step) {
    const auto [D, derivative] = map(result.value);
    for (Index k = 0; k < count; ++k) {
      const Index part = parts[static_cast<std::size_t>(k)];
      const Matrix &Z = *all[static_cast<std::size_t>(part)], turned = D * Z, change = derivative * Z;
      left[k] = turned(1, 0) - turned(0, 1);
      slope[k] = change(1, 0) - change(0, 1);
      to_parts.row(k).segment(4 * part, 4) << D(1, 0), -D(0, 0), D(1, 1), -D(0, 1);
    }
    const Matrix V = to_parts * id.covariance * to_parts.transpose();
    const numeric::PivotedCholesky weight(V);
    gain = weight.solve(slope);
    const double information = gain.dot(slope);
    if (!(information > 0.0)) return std::nullopt;
    result.standard_error = 1.0 / std::sqrt(information);
    result.misfit = left.dot(weight.solve(left));
    const double move = -gain.dot(left) / information;
    if (!std::isfinite(move)) return std::nullopt;
    if (std::abs(move) < 1e-3 * result.standard_error) return result;
    result.value += move;
  }
  return std::nullopt;
}

/// In place of F, R(−θ) F.
std::optional<Symmetric> turned_by(const Identification& id, std::span<const Index> parts) {
  return made_symmetric(id, parts, 0.0, [](double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    Matrix turn(2, 2), derivative(2, 2);
    turn << c, s, -s, c;
    derivative << -s, c, -c, -s;
    return std::pair(turn, derivative);
  });
}

/// In place of F_y, F_y/g.
std::optional<Symmetric> scaled_by(const Identification& id, std::span<const Index> parts) {
  return made_symmetric(id, parts, 1.0, [](double gain) {
    Matrix scale = Matrix::Identity(2, 2), derivative = Matrix::Zero(2, 2);
    scale(1, 1) = 1.0 / gain;
    derivative(1, 1) = -1.0 / (gain * gain);
    return std::pair(scale, derivative);
  });
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

/// m_yx − m_xy in standard errors; 0 where it is not known.
double asymmetry_of(const Identification& id) {
  if (id.axes != 2 || id.structure == Structure::symmetric || !can_be_judged(id)) return 0.0;
  const Matrix& C = id.covariance;
  const double variance = C(1, 1) + C(2, 2) - 2.0 * C(1, 2);
  return variance > 0.0 ? (id.model.M(1, 0) - id.model.M(0, 1)) / std::sqrt(variance) : 0.0;
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
    const bool both_axes_moved = axes == 2 && id.excitation.motion_ratio > kBothMoved;
    if (!angle && both_axes_moved && contradicts(id) && (!measured.alternative || contradicts(*measured.alternative))) {
      return Warning{WarningCode::axes_mismatched,
                     "force and motion are inconsistent for a limb, with any sign and order of the axes",
                     "check with 'mbk info' that --channels names the columns of the hand's force and position, all in "
                     "the same frame"};
    }
    if (!angle) return std::nullopt;
    return Warning{WarningCode::axes_mismatched,
                   fmt::format("the force is rotated by {:.0f}° relative to the motion: inertia, damping and stiffness "
                               "are all asymmetric by that angle, which is impossible for a limb",
                               *angle),
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
  const bool all_reversed = !map->exchanges() && map->sign[0] < 0.0 && (axes == 1 || map->sign[1] < 0.0);
  if (all_reversed) {
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
  const double asymmetry = asymmetry_of(id);
  if (!(std::abs(asymmetry) > kAsymmetric)) return std::nullopt;
  if (measured.alternative && measured.alternative->usable &&
      !(asymmetry_of(*measured.alternative) * asymmetry > kAsymmetric * kAsymmetric)) {
    return std::nullopt;
  }
  constexpr std::array<Index, 3> kAll = {0, 1, 2};
  constexpr std::array<Index, 2> kUndamped = {0, 2};
  constexpr std::array<Index, 1> kInertia = {0};
  const bool damped = id.structure == Structure::full;
  const std::span<const Index> parts = damped ? std::span<const Index>(kAll) : std::span<const Index>(kUndamped);
  const double agree = damped ? kAgreeOfThree : kAgreeOfTwo;
  std::optional<Symmetric> turn = turned_by(id, parts);
  const auto scale = scaled_by(id, parts);
  const bool turn_fits = turn && turn->misfit < agree;
  const std::string what =
      fmt::format("the inertia is not symmetric, which is impossible for a limb: m_yx − m_xy is {:.2g} ± {:.1g} kg",
                  id.model.M(1, 0) - id.model.M(0, 1),
                  numeric::kNormal95 * std::abs((id.model.M(1, 0) - id.model.M(0, 1)) / asymmetry));
  if (!turn_fits && scale && scale->misfit < agree && scale->value > 0.0) {
    return Warning{
        WarningCode::inertia_not_symmetric,
        fmt::format("{}; M, B and K would be symmetric if Fy were {:.3g} ± {:.2g} times too large relative to Fx", what,
                    scale->value, numeric::kNormal95 * scale->standard_error),
        "check the gain of both force axes with 'mbk sensor calibrate'"};
  }
  if (!turn_fits && biased(id)) return std::nullopt;  // the cause of the bias is reported already
  if (!turn_fits) turn = turned_by(id, kInertia);
  if (!turn) {
    return Warning{WarningCode::inertia_not_symmetric, what,
                   "check the frames, gains and crosstalk of force and position"};
  }
  const double angle = kDegrees * turn->value, half = kDegrees * numeric::kNormal95 * turn->standard_error;
  return Warning{
      WarningCode::inertia_not_symmetric,
      turn_fits ? fmt::format("{}: the force is rotated by {:.1f}° ± {:.1f}° relative to the motion, or has crosstalk",
                              what, angle, half)
                : fmt::format("{}: according to M alone the force is rotated by {:.1f}° ± {:.1f}° relative to the "
                              "motion, but B and K contradict this: gains, crosstalk or reflexes may be the cause",
                              what, angle, half),
      turn_back(angle)};
}

}  // namespace mbk::analyse
