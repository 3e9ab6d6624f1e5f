#include "mbk/model/impedance/joint_impedance.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "mbk/model/impedance/ellipse.h"
#include "mbk/model/impedance/passivity_index.h"

namespace mbk::impedance {
namespace joint_impedance_test {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr double kRounding = 1e-12;  ///< relative: tens of operations on numbers near one
const Vector2d kShoulder(0.30, -0.57);

/// Shoulder, elbow and hand for joint angles.
struct Links {
  double upper_arm = 0.31, forearm = 0.34;
  ElbowAngle angle = ElbowAngle::first_link;

  [[nodiscard]] Vector2d elbow(const Vector2d& q) const {
    return kShoulder + upper_arm * Vector2d(std::cos(q[0]), std::sin(q[0]));
  }
  [[nodiscard]] Vector2d hand(const Vector2d& q) const {
    const double forward = angle == ElbowAngle::first_link ? q[0] + q[1] : q[1];
    return elbow(q) + forearm * Vector2d(std::cos(forward), std::sin(forward));
  }
  [[nodiscard]] JointMap map(const Vector2d& q) const { return two_link_map(kShoulder, elbow(q), hand(q), angle); }
};

class Random {
 public:
  double operator()(double low, double high) {
    return low + (high - low) * static_cast<double>(random_()) / 4294967296.0;
  }
  Matrix matrix(double scale) {
    return Matrix(2, 2).unaryExpr([&](double /*none*/) { return (*this)(-scale, scale); });
  }
  Vector2d angles() { return {(*this)(-3.0, 3.0), (*this)(0.2, 2.8)}; }

 private:
  std::mt19937 random_{1};
};

TEST(TwoLinkMap, HasTheDerivativesOfTheHandsPlace) {
  Random random;
  const double step = 1e-4, kTruncation = 1e-7;  // central differences of second order: step²/12 of a fourth derivative
  for (const ElbowAngle angle : {ElbowAngle::first_link, ElbowAngle::base}) {
    const Links links{0.31, 0.34, angle};
    for (int trial = 0; trial < 20; ++trial) {
      const Vector2d q = random.angles();
      const JointMap map = links.map(q);
      for (Index i = 0; i < 2; ++i) {
        const Vector2d di = step * Vector2d::Unit(i);
        const Vector2d slope = (links.hand(q + di) - links.hand(q - di)) / (2.0 * step);
        EXPECT_LT((map.jacobian.col(i) - slope).norm(), kTruncation) << q.transpose();
        for (Index j = 0; j < 2; ++j) {
          const Vector2d dj = step * Vector2d::Unit(j);
          const Vector2d bend =
              (links.hand(q + di + dj) - links.hand(q + di - dj) - links.hand(q - di + dj) + links.hand(q - di - dj)) /
              (4.0 * step * step);
          EXPECT_NEAR(map.curvature[0](i, j), bend.x(), kTruncation) << q.transpose();
          EXPECT_NEAR(map.curvature[1](i, j), bend.y(), kTruncation) << q.transpose();
        }
      }
    }
  }
}

/// An arm with springs at its joints, torque −K_q (q − q₀) on the robot side: its hand's force and stiffness by
/// differences, without any formula for what the force does to the stiffness.
TEST(JointImpedance, GivesBackTheSpringsAtTheJointsOfAnArmThatPushes) {
  const Links links;
  const Matrix2d K_q = (Matrix2d() << 11.0, 3.5, 2.3, 4.8).finished();
  const Vector2d q0(0.7, 1.3), q(0.9, 1.1);
  const auto force_at = [&](const Vector2d& joints) {  // F_h = −J⁻ᵀ K_q (q − q₀)
    return Vector2d(-links.map(joints).jacobian.transpose().inverse() * (K_q * (joints - q0)));
  };
  const double step = 1e-5;
  Matrix2d by_joints;
  for (Index i = 0; i < 2; ++i) {
    const Vector2d di = step * Vector2d::Unit(i);
    by_joints.col(i) = -(force_at(q + di) - force_at(q - di)) / (2.0 * step);
  }
  const JointMap map = links.map(q);
  const Matrix2d K = by_joints * map.jacobian.inverse();  // −∂F/∂x
  const Vector2d hand = links.hand(q), force = force_at(q);
  ASSERT_GT(force.norm(), 5.0) << "the last term of K_q must matter";
  const Vector2d x0 = hand + K.inverse() * force;  // F = −K (x − x₀)
  const Model model{Matrix::Identity(2, 2), Matrix::Identity(2, 2), K, x0};
  const JointImpedance at_joints = joint_impedance(model, map, hand);
  const double kDifferences = 1e-6;  // [N·m/rad]: step² times a third derivative
  EXPECT_LT((at_joints.bias_force - force).norm(), kDifferences);
  EXPECT_LT((at_joints.K - K_q).norm(), kDifferences) << at_joints.K;
  EXPECT_GT((Matrix2d(map.jacobian.transpose() * K * map.jacobian) - K_q).norm(), 1.0);
}

TEST(JointImpedance, CarriesAntisymmetryOverByTheDeterminantWhateverTheForce) {
  Random random;
  for (int trial = 0; trial < 50; ++trial) {
    const Links links;
    const Vector2d q = random.angles();
    const JointMap map = links.map(q);
    const Model hand{random.matrix(2.0), random.matrix(20.0), random.matrix(200.0), random.matrix(0.5).col(0)};
    const JointImpedance at_joints = joint_impedance(hand, map, links.hand(q));
    const double det = map.jacobian.determinant();
    EXPECT_NEAR(det, links.upper_arm * links.forearm * std::sin(q[1]), kRounding);
    EXPECT_NEAR(antisymmetric_part(at_joints.K), det * antisymmetric_part(hand.K), 200.0 * kRounding);
    EXPECT_NEAR(antisymmetric_part(at_joints.M), det * antisymmetric_part(hand.M), 200.0 * kRounding);
  }
}

/// Passivity: M, B, K by their symmetric parts, and |ω m_a − k_a/ω| < √det B_s.
TEST(JointImpedance, IsPassiveWithoutABiasForceExactlyWhereTheHandIs) {
  Random random;
  int passive = 0, active = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Links links;
    const Vector2d q = random.angles();
    const Vector2d place = links.hand(q);
    const auto near_positive = [&](double scale) {
      return Matrix(scale * (Matrix::Identity(2, 2) + random.matrix(0.6)));
    };
    const Model hand{near_positive(2.0), near_positive(10.0), near_positive(100.0), place};
    const JointImpedance q_domain = joint_impedance(hand, links.map(q), place);
    const Model joints{q_domain.M, q_domain.B, q_domain.K, Vector::Zero(2)};
    const double omega = random(2.0, 20.0);
    const auto is_passive = [&](const Model& model) {
      bool all = passivity_index(model, omega).value > 0.0;
      for (int matrix = 0; matrix < 3; ++matrix) all = all && smallest_eigenvalue(model, matrix).value > 0.0;
      return all;
    };
    EXPECT_EQ(is_passive(joints), is_passive(hand)) << "trial " << trial << ", q " << q.transpose();
    (is_passive(hand) ? passive : active) += 1;
  }
  EXPECT_GT(passive, 40);
  EXPECT_GT(active, 40);
}

TEST(JointImpedance, GradientAgreesWithFiniteDifferences) {
  Random random;
  const Links links;
  const Vector2d q(0.4, 1.2);
  const Vector2d place = links.hand(q);
  const Model hand{random.matrix(2.0), random.matrix(20.0), random.matrix(200.0), place + Vector2d(0.02, -0.03)};
  const JointMap map = links.map(q);
  const auto all = [&](const Vector& numbers) {
    const JointImpedance at = joint_impedance(unstacked(numbers, 2), map, place);
    Vector values(14);
    values << Vector(at.M.transpose().reshaped()), Vector(at.B.transpose().reshaped()),
        Vector(at.K.transpose().reshaped()), at.bias_force;
    return values;
  };
  const Vector numbers = stacked(hand);
  const Matrix gradient = joint_impedance(hand, map, place).gradient;
  const double step = 1e-4, kQuadratic = 1e-8;  // quadratic in the numbers: central differences err by rounding only
  for (Index k = 0; k < 14; ++k) {
    const Vector change = step * Vector::Unit(14, k);
    const Vector slope = (all(numbers + change) - all(numbers - change)) / (2.0 * step);
    EXPECT_LT((gradient.col(k) - slope).cwiseAbs().maxCoeff(), kQuadratic) << "number " << k;
  }
}

TEST(JointImpedance, WithoutAnEquilibriumHasNoStiffness) {
  const Links links;
  const Vector2d q(0.4, 1.2);
  const Model hand{Matrix::Identity(2, 2), Matrix::Identity(2, 2), Matrix::Zero(2, 2),
                   Vector::Constant(2, std::nan(""))};
  const JointImpedance at = joint_impedance(hand, links.map(q), links.hand(q));
  EXPECT_TRUE(at.M.allFinite());
  EXPECT_TRUE(std::isnan(at.K(0, 0)));
}

}  // namespace joint_impedance_test
}  // namespace mbk::impedance
