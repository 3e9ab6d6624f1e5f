#include "mbk/measure/identify/transmission_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "mbk/base/numeric/dense.h"
#include "mbk/base/numeric/least_squares.h"
#include "mbk/base/numeric/statistics.h"

namespace mbk::identify {
namespace {

constexpr double kApart = 1e-7;  ///< of the length of a column, from the span of the others
constexpr Index kEdge = 10;      ///< rows at each end of a segment that what lies beyond it reaches into

/// Second derivative by five points, of a signal sampled well above its band; zero at the two rows at each end.
Vector second_derivative(const Eigen::Ref<const Vector>& x, double T) {
  Vector result = Vector::Zero(x.size());
  for (Index i = 2; i + 2 < x.size(); ++i) {
    result[i] = (-x[i - 2] + 16.0 * x[i - 1] - 30.0 * x[i] + 16.0 * x[i + 1] - x[i + 2]) / (12.0 * T * T);
  }
  return result;
}

/// d/dt of the impulse response of the zero-phase low-pass, h(t) = 2 ∫ cos(2πft)/(1 + (f/f_c)¹⁰) df, at t = x/f_c, in
/// f_c² (Butterworth of order five, forward and backward).
class PulseShape {
 public:
  PulseShape() {
    constexpr int kSteps = 800;
    constexpr double kTop = 3.0;
    for (std::size_t i = 0; i < values_.size(); ++i) {
      const double x = kStep * static_cast<double>(i);
      double sum = 0.0;
      for (int k = 0; k < kSteps; ++k) {
        const double f = kTop * (k + 0.5) / kSteps;
        sum -= 2.0 * std::numbers::pi * f * std::sin(2.0 * std::numbers::pi * f * x) / (1.0 + std::pow(f, 10));
      }
      values_[i] = 2.0 * sum * kTop / kSteps;
    }
  }
  [[nodiscard]] double operator()(double x) const {
    const double at = std::abs(x) / kStep;
    const auto i = static_cast<std::size_t>(at);
    if (i + 1 >= values_.size()) return 0.0;
    const double value = values_[i] + (at - static_cast<double>(i)) * (values_[i + 1] - values_[i]);
    return x < 0.0 ? -value : value;
  }
  static constexpr double kReach = 2.5;

 private:
  static constexpr double kStep = 0.01;
  std::array<double, static_cast<std::size_t>(kReach / kStep) + 1> values_{};
};

/// Where a torque changes its sign and goes beyond a twentieth of its root mean square on both sides.
struct Reversal {
  double time;   ///< [s]
  double slope;  ///< [N·m/s]
};

std::vector<Reversal> reversals(const Eigen::Ref<const Vector>& s, double T, double level) {
  std::vector<Reversal> all;
  double last = 0.0;    // the sign of what was last beyond the level
  Index crossing = -1;  // the last change of sign since
  for (Index i = 0; i < s.size(); ++i) {
    if (i > 0 && (s[i - 1] < 0.0) != (s[i] < 0.0)) crossing = i - 1;
    if (!(std::abs(s[i]) > level)) continue;
    const double sign = s[i] < 0.0 ? -1.0 : 1.0;
    if (last != 0.0 && sign != last && crossing >= 0) {
      const double rise = s[crossing + 1] - s[crossing];
      all.push_back({T * (static_cast<double>(crossing) - s[crossing] / rise), rise / T});
    }
    last = sign;
  }
  return all;
}

/// Rows of one joint, all segments under each other without their edges.
struct JointRows {
  Vector torque, by_motion, by_torque;  ///< τ, and s̈ of what the bodies take and of what the drive leaves of τ
  Matrix others;                        ///< all that a rigid drive has
  Matrix pulses;                        ///< d²/dt² sgn(s) for each time that the gap may take
  Matrix pulses_by_torque;              ///< the same of what the drive leaves of τ
  std::vector<numeric::RowRange> ranges;
  int reversals = 0;
};

constexpr std::array kTimes = {0.0, 0.1, 0.2, 0.35, 0.5};  ///< that a gap takes, at the usual slope [1/f_c]

class TransmissionTester {
 public:
  TransmissionTester(const std::vector<PreparedDynamics>& trials, const RobotIdentification& found)
      : trials_(trials), found_(found), T_(trials.front().sample_time) {
    // Without a low-pass pulses are as short as the rows show them.
    constexpr double kOfRate = 0.2;
    cutoff_ = kOfRate / T_;
    if (const auto cutoff = trials.front().preparation.cutoff) cutoff_ = std::min(cutoff_, cutoff->value);
    lags_ = static_cast<Index>(std::llround(found.hac_lag_s / T_));
  }

  [[nodiscard]] TransmissionTest test(Index joint) const;

 private:
  [[nodiscard]] JointRows rows(Index joint) const;
  [[nodiscard]] std::optional<Index> column(const char* name, Index joint) const {
    const auto& all = found_.coefficients;
    const auto requested = fmt::format("{}_{}", name, joint + 1);
    const auto at = std::ranges::find(all, requested, [](const auto& one) { return one.coefficient.name; });
    if (at == all.end()) return {};
    return at - all.begin();
  }
  [[nodiscard]] Matrix beyond_rigid(const Matrix& W, Index joint) const;
  [[nodiscard]] bool biases(const JointRows& rows, const Vector& column, double coefficient) const;

  const std::vector<PreparedDynamics>& trials_;
  const RobotIdentification& found_;
  double T_, cutoff_ = 0.0;
  Index lags_ = 0;
};

/// Friction that the model may lack: with the square of the velocity, and near standstill.
Matrix TransmissionTester::beyond_rigid(const Matrix& W, Index joint) const {
  const auto viscous = column("viscous", joint);
  if (!viscous) return Matrix(W.rows(), 0);
  const Vector v = W.col(*viscous);
  const double speed = std::sqrt(2.0 * v.squaredNorm() / static_cast<double>(std::max<Index>(v.size(), 1)));
  if (!(speed > 0.0)) return Matrix(W.rows(), 0);
  constexpr std::array kSlow = {0.25, 0.0625};
  Matrix more(W.rows(), 1 + std::ssize(kSlow));
  more.col(0) = v.cwiseProduct(v.cwiseAbs());
  for (std::size_t k = 0; k < kSlow.size(); ++k) {
    more.col(1 + static_cast<Index>(k)) =
        (v.array() / (kSlow[k] * speed)).tanh() * (-(v.array() / (2.0 * kSlow[k] * speed)).square()).exp();
  }
  return more;
}

JointRows TransmissionTester::rows(Index joint) const {
  static const PulseShape kPulse;
  const auto j = static_cast<std::size_t>(joint);
  const Vector& theta = found_.model.parameters;
  const auto bodies = static_cast<Index>(found_.model.mechanism->coefficients().size());
  JointRows made;
  Index total = 0;
  for (const PreparedDynamics& trial : trials_) {
    for (const Segment& segment : trial.segments) total += std::max<Index>(0, segment.size() - 2 * kEdge);
  }
  const Index p = theta.size();
  constexpr Index kMore = 7;  // τ̇, a constant, friction
  made.torque.resize(total);
  made.by_motion.resize(total);
  made.by_torque.resize(total);
  made.others.setZero(total, p + kMore);
  made.pulses.setZero(total, std::ssize(kTimes));
  made.pulses_by_torque = made.pulses;
  // The level and slope of reversals are those of all rows together.
  double squares = 0.0, count = 0.0;
  for (const PreparedDynamics& trial : trials_) {
    squares += (trial.regressors[j].leftCols(bodies) * theta.head(bodies)).squaredNorm();
    count += static_cast<double>(trial.torque.rows());
  }
  const double usual = std::sqrt(squares / std::max(count, 1.0));
  constexpr double kLevel = 0.05;
  const auto viscous = column("viscous", joint);
  double velocity_squares = 0.0;
  for (const PreparedDynamics& trial : trials_) {
    if (viscous) velocity_squares += trial.regressors[j].col(*viscous).squaredNorm();
  }
  const double speed = std::sqrt(velocity_squares / std::max(count, 1.0));
  struct Placed {
    Index row, rows;
    std::vector<Reversal> of_torque, of_velocity, of_driven;
  };
  std::vector<Placed> placed;
  std::vector<double> slopes, accelerations;
  Index row = 0;
  for (const PreparedDynamics& trial : trials_) {
    const Matrix& W = trial.regressors[j];
    const Vector s = W.leftCols(bodies) * theta.head(bodies);
    const Vector driven = trial.torque.col(joint) - W.rightCols(p - bodies) * theta.tail(p - bodies);
    const Matrix more = beyond_rigid(W, joint);
    for (const Segment& segment : trial.segments) {
      const Index n = segment.size() - 2 * kEdge, begin = segment.begin + kEdge;
      if (n <= 0) continue;
      made.torque.segment(row, n) = trial.torque.col(joint).segment(begin, n);
      made.by_motion.segment(row, n) =
          second_derivative(s.segment(segment.begin, segment.size()), T_).segment(kEdge, n);
      made.by_torque.segment(row, n) =
          second_derivative(driven.segment(segment.begin, segment.size()), T_).segment(kEdge, n);
      made.others.block(row, 0, n, p) = W.middleRows(begin, n);
      made.others.col(p).segment(row, n) = trial.torque_rate.col(joint).segment(begin, n);
      made.others.col(p + 1).segment(row, n).setOnes();
      made.others.block(row, p + 2, n, more.cols()) = more.middleRows(begin, n);
      Placed one{row,
                 n,
                 reversals(s.segment(segment.begin, segment.size()), T_, kLevel * usual),
                 {},
                 reversals(driven.segment(segment.begin, segment.size()), T_, kLevel * usual)};
      if (viscous) {
        one.of_velocity = reversals(W.col(*viscous).segment(segment.begin, segment.size()), T_, kLevel * speed);
      }
      for (auto* const list : {&one.of_torque, &one.of_velocity, &one.of_driven}) {
        for (Reversal& reversal : *list) reversal.time -= T_ * static_cast<double>(kEdge);
      }
      for (const Reversal& reversal : one.of_torque) slopes.push_back(std::abs(reversal.slope));
      for (const Reversal& reversal : one.of_velocity) accelerations.push_back(std::abs(reversal.slope));
      made.reversals += static_cast<int>(one.of_torque.size());
      placed.push_back(std::move(one));
      made.ranges.push_back({row, row + n});
      row += n;
    }
  }
  // The usual slope over that of a reversal: how much longer it lasts.
  constexpr double kLongest = 3.0;
  const auto longer = [](double usual_slope, const Reversal& one) {
    return usual_slope / std::max(std::abs(one.slope), usual_slope / (kLongest * kLongest * kLongest));
  };
  const auto put_pulse = [&](const Placed& segment, double at, double weight, auto&& to) {
    const double reach = PulseShape::kReach / cutoff_;
    const Index from = std::max<Index>(0, static_cast<Index>(std::ceil((at - reach) / T_)));
    const Index end = std::min<Index>(segment.rows - 1, static_cast<Index>(std::floor((at + reach) / T_)));
    for (Index i = from; i <= end; ++i) {
      to[segment.row + i] += weight * cutoff_ * cutoff_ * kPulse((T_ * static_cast<double>(i) - at) * cutoff_);
    }
  };
  const double slope = numeric::median(slopes), acceleration = numeric::median(accelerations);
  for (const Placed& one : placed) {
    for (const bool by_torque : {false, true}) {
      for (const Reversal& reversal : by_torque ? one.of_driven : one.of_torque) {
        const double direction = reversal.slope < 0.0 ? -2.0 : 2.0, slower = std::cbrt(longer(slope, reversal));
        for (std::size_t k = 0; k < kTimes.size(); ++k) {
          put_pulse(one, reversal.time + kTimes[k] * slower / cutoff_, direction,
                    (by_torque ? made.pulses_by_torque : made.pulses).col(static_cast<Index>(k)));
        }
      }
    }
    // What friction does while the velocity is near 0, an odd pulse too short for the band: its first moment goes with
    // the square of its length.
    for (const Reversal& reversal : one.of_velocity) {
      const double direction = reversal.slope < 0.0 ? -1.0 : 1.0;
      const double length = std::min(longer(acceleration, reversal), kLongest);
      put_pulse(one, reversal.time, direction * length, made.others.col(p + 5));
      put_pulse(one, reversal.time, direction * length * length, made.others.col(p + 6));
    }
  }
  return made;
}

/// Coefficients of columns that have lost what others explain, each over its Newey–West standard error.
struct Tested {
  Vector coefficients, errors;
  double explained = 0;
};

Tested tested(const Matrix& columns, const Vector& residual, const std::vector<numeric::RowRange>& ranges, Index lags) {
  const Index k = columns.cols();
  Tested made{Vector::Zero(k), Vector::Zero(k)};
  const Vector lengths = columns.colwise().norm();
  if (!(lengths.minCoeff() > 0.0)) return made;
  const Matrix unit = columns * lengths.cwiseInverse().asDiagonal();
  const Matrix inverse = numeric::inverse(unit.transpose() * unit);
  const Vector weights = inverse * (unit.transpose() * residual);
  if (!inverse.allFinite()) return made;
  const Vector left = residual - unit * weights;
  const Matrix middle = numeric::long_run_covariance(k, ranges, lags, [&](const numeric::RowRange& range) {
    return Matrix(left.segment(range.begin, range.size()).asDiagonal() * unit.middleRows(range.begin, range.size()));
  });
  const double widening = numeric::newey_west_widening(
      std::min(1.0, static_cast<double>(lags) / static_cast<double>(std::max<Index>(residual.size(), 1))));
  const Vector deviation = widening * (inverse * middle * inverse).diagonal().cwiseMax(0.0).cwiseSqrt();
  // What is explained to rounding says nothing about noise.
  const double least = 1e-12 * residual.norm();
  for (Index i = 0; i < k; ++i) made.errors[i] = weights[i] / std::max(deviation[i], std::max(least, 1e-300));
  made.coefficients = weights.cwiseQuotient(lengths);
  const double all = residual.squaredNorm();
  made.explained = all > 0.0 ? 1.0 - left.squaredNorm() / all : 0.0;
  return made;
}

/// Whether the fit without a column moves one of its own coefficients by more than that one's interval.
bool TransmissionTester::biases(const JointRows& rows, const Vector& column, double coefficient) const {
  std::vector<Index> kept;
  for (Index k = 0; k < std::ssize(found_.coefficients); ++k) {
    const RobotCoefficient& one = found_.coefficients[static_cast<std::size_t>(k)];
    const double length = rows.others.col(k).norm();
    if (one.identified && !one.fixed && one.standard_error > 0.0 && length > 0.0) kept.push_back(k);
  }
  std::vector<Index> all = kept;
  if (found_.delay_standard_error) all.push_back(std::ssize(found_.coefficients));  // the rate stands behind them
  if (kept.empty()) return false;
  const Matrix fitted = rows.others(Eigen::all, all);
  const Vector scale = fitted.colwise().norm().cwiseMax(1e-300).cwiseInverse();
  const Vector share = scale.cwiseProduct(numeric::PivotedQr(fitted * scale.asDiagonal(), kApart).solve(column));
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const double error = found_.coefficients[static_cast<std::size_t>(kept[i])].standard_error;
    if (std::abs(coefficient * share[static_cast<Index>(i)]) > numeric::kNormal95 * error) return true;
  }
  return false;
}

TransmissionTest TransmissionTester::test(Index joint) const {
  TransmissionTest made;
  const JointRows rows = this->rows(joint);
  made.reversals = rows.reversals;
  if (rows.torque.size() < 4 * rows.others.cols()) return made;
  Vector scale = rows.others.colwise().norm();
  for (double& one : scale) one = one > 0.0 ? 1.0 / one : 0.0;
  const numeric::PivotedQr rigid(rows.others * scale.asDiagonal(), kApart);
  Matrix columns(rows.torque.size(), 3 + rows.pulses.cols());
  columns << rows.torque, rows.by_motion, rows.by_torque, rows.pulses;
  columns = rigid.rest(std::move(columns));
  const Vector residual = columns.col(0);
  const Tested motion = tested(columns.col(1), residual, rows.ranges, lags_);
  const auto share_of = [&](const Vector& column, double coefficient) {
    return std::abs(coefficient) * column.norm() / std::max(rows.torque.norm(), 1e-300);
  };
  made.elastic = {motion.coefficients[0],
                  motion.errors[0],
                  motion.errors[0],
                  motion.explained,
                  share_of(rows.by_motion, motion.coefficients[0]),
                  biases(rows, rows.by_motion, motion.coefficients[0]),
                  false};
  made.elastic_by_torque = tested(columns.col(2), residual, rows.ranges, lags_).errors[0];
  Index best = 3;
  constexpr int kMin = 10;
  if (rows.reversals >= kMin) {
    double most = -1.0;
    for (Index k = 3; k < columns.cols(); ++k) {
      const Tested gap = tested(columns.col(k), residual, rows.ranges, lags_);
      if (gap.explained <= most) continue;
      most = gap.explained;
      best = k;
      made.backlash = {gap.coefficients[0], gap.errors[0], gap.errors[0], gap.explained, 0.0, false, false};
    }
    made.backlash_by_torque =
        tested(rigid.rest(rows.pulses_by_torque.col(best - 3)), residual, rows.ranges, lags_).errors[0];
    made.backlash.of_torque = share_of(rows.pulses.col(best - 3), made.backlash.coefficient);
    made.backlash.biases = biases(rows, rows.pulses.col(best - 3), made.backlash.coefficient);
    Matrix both(columns.rows(), 2);
    both << columns.col(1), columns.col(best);
    const Tested together = tested(both, residual, rows.ranges, lags_);
    made.elastic.errors_beside = together.errors[0];
    made.backlash.errors_beside = together.errors[1];
  }
  return made;
}

/// Mean of the inertia about a joint over the robot's postures, with the rotor's where that is a term [kg·m² or kg].
double inertia_about(int joint, const robot::DynamicModel& model) {
  const robot::Mechanism& mechanism = *model.mechanism;
  const Vector phi = model.parameters.head(std::ssize(mechanism.coefficients()));
  const std::vector<robot::JointVector> postures = mechanism.postures(mechanism.joints() <= 2 ? 5 : 3);
  double sum = 0.0;
  for (const robot::JointVector& q : postures) {
    sum += mechanism.terms(q, robot::JointVector::Zero(mechanism.joints()), phi).inertia(joint, joint);
  }
  return sum / static_cast<double>(std::max<std::size_t>(postures.size(), 1));
}

constexpr double kBeyondChance = 4.5;  ///< standard errors
constexpr double kBeyondPulses = 6.0;  ///< the same of pulses
constexpr double kExplains = 0.36;     ///< of the residual's squares: a fifth of its root mean square

bool matters(const TransmissionColumn& one) {
  return std::abs(one.errors) > kBeyondChance && (one.explained > kExplains || one.biases);
}

/// Whether a column is needed beside one that explains more.
bool adds(const TransmissionColumn& one, const TransmissionColumn& other) {
  constexpr double kAlike = 0.75;
  return std::abs(one.errors_beside) > kBeyondChance && one.explained > kAlike * other.explained;
}

constexpr double kNegligible = 1e-3;  ///< of the torque: no robot is known better

const char* side_of(double coefficient) {
  return coefficient < 0.0 ? "on the motor side of it" : "on the link side of it";
}

}  // namespace

void test_transmission(const std::vector<PreparedDynamics>& trials, RobotIdentification& found) {
  // Friction near standstill and coarse encoders make pulses that fall together with those of a gap now and then.
  constexpr double kPulses = 0.3;
  const TransmissionTester tester(trials, found);
  found.transmission.clear();
  for (Index joint = 0; joint < trials.front().torque.cols(); ++joint) {
    TransmissionTest test = tester.test(joint);
    TransmissionColumn &bends = test.elastic, &gap = test.backlash;
    const bool both_ways = test.elastic_by_torque * bends.errors > 0.0 &&  //
                           std::abs(test.elastic_by_torque) > kBeyondChance;
    const bool elastic = matters(bends) && both_ways && bends.of_torque > kNegligible,
               backlash = matters(gap) && gap.explained > kPulses && std::abs(gap.errors) > kBeyondPulses &&
                          test.backlash_by_torque * gap.errors > 0.0 &&
                          std::abs(test.backlash_by_torque) > kBeyondPulses;
    bends.found = elastic && (!backlash || bends.explained >= gap.explained || adds(bends, gap));
    gap.found = backlash && (!elastic || gap.explained > bends.explained || adds(gap, bends));
    found.transmission.push_back(test);
  }
}

void warn_of_transmission(RobotIdentification& found) {
  constexpr double kEnough = 0.5;    // of the limit, so that it is surely below it
  constexpr double kSlowest = 0.1;   // [Hz] at which a robot can be identified
  constexpr double kExplained = 80;  // [%] of the torque, for its residual to be that of a drive
  double top = 0.0;
  for (const Preparation& how : found.preparations) top = std::max(top, how.band_high.value);
  for (std::size_t joint = 0; joint < found.transmission.size(); ++joint) {
    const TransmissionTest& test = found.transmission[joint];
    const TransmissionColumn &bends = test.elastic, &gap = test.backlash;
    const bool slides = found.model.mechanism->slides(static_cast<int>(joint));
    if (joint < found.fit.size() && found.fit[joint].vaf < kExplained) continue;
    const double resonance = 0.5 / (std::numbers::pi * std::sqrt(std::abs(bends.coefficient)));
    // The column is the first term of a series in (f/f_r)².
    if (bends.found && resonance > top) {
      const double slower = top * std::sqrt(std::min(kEnough * kNegligible / bends.of_torque, 1.0));
      found.warnings.push_back(
          {WarningCode::elastic_drive,
           fmt::format(
               "the torque of joint {} is correlated with its own second derivative, which indicates an elastic drive "
               "with a resonance at about {:.2g} Hz; the encoder is {}; inertia and friction are biased",
               joint + 1, resonance, side_of(bends.coefficient)),
           slower > kSlowest ? fmt::format("move more slowly, below {:.2g} Hz, or stiffen the drive", slower)
                             : "stiffen the drive, or record the angle of the link (slower motion does not help)"});
    }
    if (gap.found) {
      std::string size;
      const double inertia = inertia_about(static_cast<int>(joint), found.model);
      if (gap.coefficient < 0.0 && inertia > 0.0) {
        const double travel = -2.0 * gap.coefficient / inertia;
        size = slides ? fmt::format(" of {:.2g} mm or more", 1e3 * travel)
                      : fmt::format(" of {:.2g}° or more", travel * 180.0 / std::numbers::pi);
      }
      found.warnings.push_back(
          {WarningCode::backlash,
           fmt::format("the residual of joint {} has a pulse at each reversal of its torque ({} times), which "
                       "indicates backlash{}; the encoder is {}; inertia and friction are biased",
                       joint + 1, test.reversals, size, side_of(gap.coefficient)),
           "remove the play from the drive, or preload it so that its torque does not change sign"});
    }
  }
}

}  // namespace mbk::identify
