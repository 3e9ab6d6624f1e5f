#include "mbk/files/kinarm/force_sign.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mbk::recording {
namespace {

constexpr double kLargestMass = 5.0;      ///< [kg] of a robot at the hand
constexpr double kLargestFriction = 3.0;  ///< [N·s/m]
constexpr double kMinForce = 0.05;        ///< [N] rms; less is noise of the sensor
constexpr double kClear = 0.5;            ///< unexplained with the better sign, at most so much of that with the other
constexpr double kExplains = 0.5;         ///< share that the better sign may leave unexplained
constexpr double kMaxBlocks = 0.75;       ///< share of blocks that must agree
constexpr Index kBlocksOfTrial = 10;

Vector without_mean(const Vector& values, const std::vector<Index>& kept) {
  Vector result = Vector::Zero(static_cast<Index>(kept.size()));
  if (values.size() == 0) return result;
  for (std::size_t k = 0; k < kept.size(); ++k) result[static_cast<Index>(k)] = values[kept[k]];
  result.array() -= result.mean();
  return result;
}

}  // namespace

ForceSignTest::Moments& ForceSignTest::Moments::operator+=(const Moments& other) {
  sensor_sensor += other.sensor_sensor;
  sensor_commanded += other.sensor_commanded;
  commanded_commanded += other.commanded_commanded;
  sensor_a += other.sensor_a;
  commanded_a += other.commanded_a;
  sensor_v += other.sensor_v;
  commanded_v += other.commanded_v;
  aa += other.aa;
  av += other.av;
  vv += other.vv;
  return *this;
}

void ForceSignTest::add(const ForceEvidence& evidence) {
  const auto finite_at = [](const Vector& values, Index i) { return values.size() == 0 || std::isfinite(values[i]); };
  std::vector<Index> kept;
  for (Index i = 0; i < evidence.sensor_x.size(); ++i) {
    const bool finite = finite_at(evidence.sensor_x, i) && finite_at(evidence.sensor_y, i) &&
                        finite_at(evidence.commanded_x, i) && finite_at(evidence.commanded_y, i) &&
                        finite_at(evidence.velocity_x, i) && finite_at(evidence.velocity_y, i) &&
                        finite_at(evidence.acceleration_x, i) && finite_at(evidence.acceleration_y, i);
    if (finite) kept.push_back(i);
  }
  const auto samples = static_cast<Index>(kept.size());
  if (samples < 2 * kBlocksOfTrial) return;
  struct Axis {
    Vector sensor, commanded, v, a;
  };
  const Axis axes[] = {{without_mean(evidence.sensor_x, kept), without_mean(evidence.commanded_x, kept),
                        without_mean(evidence.velocity_x, kept), without_mean(evidence.acceleration_x, kept)},
                       {without_mean(evidence.sensor_y, kept), without_mean(evidence.commanded_y, kept),
                        without_mean(evidence.velocity_y, kept), without_mean(evidence.acceleration_y, kept)}};
  const double energy = axes[0].sensor.squaredNorm() + axes[1].sensor.squaredNorm();
  if (!(energy > kMinForce * kMinForce * static_cast<double>(samples))) return;
  ++trials_;
  for (Index block = 0; block < kBlocksOfTrial; ++block) {
    const Index begin = block * samples / kBlocksOfTrial;
    const Index count = (block + 1) * samples / kBlocksOfTrial - begin;
    Moments sums;
    for (const Axis& axis : axes) {
      const auto of = [&](const Vector& one, const Vector& other) {
        return one.segment(begin, count).dot(other.segment(begin, count));
      };
      sums += {of(axis.sensor, axis.sensor),
               of(axis.sensor, axis.commanded),
               of(axis.commanded, axis.commanded),
               of(axis.sensor, axis.a),
               of(axis.commanded, axis.a),
               of(axis.sensor, axis.v),
               of(axis.commanded, axis.v),
               of(axis.a, axis.a),
               of(axis.a, axis.v),
               of(axis.v, axis.v)};
    }
    blocks_.push_back(sums);
  }
}

/// Σ |F_c + s F_sensor − m a − b v|²
double ForceSignTest::residual(const Moments& sums, double sign, const Fit& fit) {
  const double forces = sums.commanded_commanded + 2.0 * sign * sums.sensor_commanded + sums.sensor_sensor;
  const double with_a = sums.commanded_a + sign * sums.sensor_a, with_v = sums.commanded_v + sign * sums.sensor_v;
  return forces - 2.0 * fit.mass * with_a - 2.0 * fit.friction * with_v + fit.mass * fit.mass * sums.aa +
         2.0 * fit.mass * fit.friction * sums.av + fit.friction * fit.friction * sums.vv;
}

/// The residual is convex: either the free minimum lies within the bounds, or the minimum is on one of their edges.
ForceSignTest::Fit ForceSignTest::best(const Moments& sums, double sign) {
  const double with_a = sums.commanded_a + sign * sums.sensor_a, with_v = sums.commanded_v + sign * sums.sensor_v;
  const auto within = [](double value, double largest) { return std::clamp(value, 0.0, largest); };
  const double determinant = sums.aa * sums.vv - sums.av * sums.av;
  if (determinant > 1e-9 * sums.aa * sums.vv) {
    const Fit free{(with_a * sums.vv - with_v * sums.av) / determinant,
                   (with_v * sums.aa - with_a * sums.av) / determinant};
    if (free.mass >= 0.0 && free.mass <= kLargestMass && free.friction >= 0.0 && free.friction <= kLargestFriction) {
      return free;
    }
  }
  std::vector<Fit> edges;
  for (const double mass : {0.0, kLargestMass}) {
    edges.push_back({mass, sums.vv > 0.0 ? within((with_v - mass * sums.av) / sums.vv, kLargestFriction) : 0.0});
  }
  for (const double friction : {0.0, kLargestFriction}) {
    edges.push_back({sums.aa > 0.0 ? within((with_a - friction * sums.av) / sums.aa, kLargestMass) : 0.0, friction});
  }
  return *std::ranges::min_element(edges, {}, [&](const Fit& fit) { return residual(sums, sign, fit); });
}

ForceSign ForceSignTest::result() const {
  ForceSign found;
  found.trials = trials_;
  if (blocks_.empty()) return found;
  Moments all;
  for (const Moments& block : blocks_) all += block;
  const double scale = all.sensor_sensor;
  found.commanded = all.commanded_commanded > 1e-6 * scale;
  constexpr double kSigns[] = {1.0, -1.0};
  Fit fits[2];
  double left[2];
  for (int k = 0; k < 2; ++k) {
    fits[k] = best(all, kSigns[k]);
    left[k] = std::max(residual(all, kSigns[k], fits[k]), 0.0);
    found.unexplained[k] = left[k] / scale;
    found.mass[k] = fits[k].mass;
  }
  const int better = left[0] <= left[1] ? 0 : 1, other = 1 - better;
  int agree = 0, counted = 0;
  for (const Moments& block : blocks_) {
    if (block.sensor_sensor < 0.05 * scale / static_cast<double>(blocks_.size())) continue;  // hardly any force
    ++counted;
    agree += residual(block, kSigns[better], fits[better]) < residual(block, kSigns[other], fits[other]) ? 1 : 0;
  }
  found.blocks_for = counted > 0 ? static_cast<double>(agree) / counted : 0.0;
  const bool clear =
      left[better] <= kClear * left[other] && found.unexplained[better] <= kExplains && found.blocks_for >= kMaxBlocks;
  if (clear) found.verdict = better == 0 ? ForceSign::Verdict::as_stored : ForceSign::Verdict::turned;
  return found;
}

std::string force_sign_note(const ForceSign& sign, const std::string& sensor) {
  const std::string turn = "--channels Fx=-force_x,Fy=-force_y,x=hand_x,y=hand_y reverses it";
  if (sign.trials == 0) {
    return fmt::format(
        "the sign of {} is not documented and cannot be inferred here, because there is no force or no motion; the "
        "force is used as stored; {}",
        sensor, turn);
  }
  const std::string trials = sign.trials == 1 ? "1 trial" : fmt::format("{} trials", sign.trials);
  const auto share = [](double part) {
    return part < 1e-5 ? std::string("less than 0.001") : fmt::format("{:.3g}", 100.0 * part);
  };
  const std::string how = fmt::format(
      "{}, the mass of the robot times its acceleration must equal the {}measured force; this leaves {} % of the "
      "measured force unexplained with the sign as stored (robot mass {:.3g} kg) and {} % with the sign reversed "
      "({:.3g} kg)",
      trials, sign.commanded ? "commanded force of the motors plus the " : "", share(sign.unexplained[0]), sign.mass[0],
      share(sign.unexplained[1]), sign.mass[1]);
  switch (sign.verdict) {
    case ForceSign::Verdict::as_stored:
      return fmt::format(
          "the sign of {} is not documented; inferred: it is the force of the hand on the robot, as "
          "stored. Evidence: in {}. {}",
          sensor, how, turn);
    case ForceSign::Verdict::turned:
      return fmt::format(
          "the sign of {} is not documented; inferred: it is the force of the robot on the hand, so force_x and "
          "force_y have the opposite sign. Evidence: in {}. {}",
          sensor, how, turn);
    default:
      return fmt::format(
          "! the sign of {} is not documented, and the evidence is inconclusive: the force is used as stored, which "
          "may be wrong. In {}. {}",
          sensor, how, turn);
  }
}

}  // namespace mbk::recording
