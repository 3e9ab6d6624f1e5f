#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <string>

#include "mbk/model/robot/serial_chain.h"
#include "mbk/model/robot/test_chains.h"
#include "tests/physics/engine.h"

namespace mbk::robot {
namespace {

using physics::compiled;
using physics::EngineData;
using physics::EngineModel;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double kRelative = 1e-9;

/// The same URDF, read by both.
class Pair {
 public:
  Pair(const std::string& kinds, unsigned seed) : random(kinds, seed), engine_(compiled(random.urdf())) {
    SerialChain::Options options;
    options.hand_axes = {SerialChain::Axis::x, SerialChain::Axis::z};
    options.tool = tool = random.uniform3(0.2);
    chain = SerialChain::from_urdf(random.urdf(), options).value();
    engine_->opt.disableflags |= mjDSBL_CONSTRAINT;  // joints may pass their limits, links each other
    data_ = EngineData(mj_makeData(engine_.get()));
  }

  void set(const JointVector& q, const JointVector& v, const JointVector& a) {
    const Index n = random.joints();
    Eigen::Map<Vector>(data_->qpos, n) = q;
    Eigen::Map<Vector>(data_->qvel, n) = v;
    Eigen::Map<Vector>(data_->qacc, n) = a;
    mj_inverse(engine_.get(), data_.get());
  }
  [[nodiscard]] Vector torque() const { return Eigen::Map<Vector>(data_->qfrc_inverse, random.joints()); }
  [[nodiscard]] Matrix inertia() const {
    RowMatrix M(random.joints(), random.joints());
    mj_fullM(engine_.get(), M.data(), data_->qM);
    return M;
  }
  [[nodiscard]] Eigen::Vector3d hand() const {
    const int last = engine_->nbody - 1;
    return Eigen::Map<Eigen::Vector3d>(data_->xpos + 3 * last) +
           Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data_->xmat + 9 * last) * tool;
  }
  [[nodiscard]] RowMatrix jacobian() const {
    RowMatrix J(3, random.joints());
    const Eigen::Vector3d at = hand();
    mj_jac(engine_.get(), data_.get(), J.data(), nullptr, at.data(), engine_->nbody - 1);
    return J;
  }

  RandomChain random;
  std::shared_ptr<const SerialChain> chain;
  Eigen::Vector3d tool;

 private:
  EngineModel engine_;
  EngineData data_;
};

class SerialChainAgainstMujoco : public ::testing::TestWithParam<std::string> {};

TEST_P(SerialChainAgainstMujoco, HasTheSameTorquesInertiaGravityHandAndJacobian) {
  Pair pair(GetParam(), 21);
  const Index n = pair.random.joints();
  ASSERT_EQ(pair.chain->joints(), n);
  const Vector& phi = pair.chain->stated_coefficients();
  Matrix Y(n, phi.size());
  for (int i = 0; i < 200; ++i) {
    const JointVector q = pair.random.uniform_joints(3.0), v = pair.random.uniform_joints(5.0),
                      a = pair.random.uniform_joints(30.0), still = JointVector::Zero(n);
    const JointTerms terms = pair.chain->terms(q, v, phi);
    pair.set(q, still, still);
    ASSERT_LE((terms.gravity - pair.torque()).norm(), kRelative * (1.0 + pair.torque().norm())) << "state " << i;
    pair.set(q, v, a);
    pair.chain->regressor(q, v, a, Y);
    ASSERT_LE((Y * phi - pair.torque()).norm(), kRelative * pair.torque().norm()) << "state " << i;
    ASSERT_LE((terms.inertia - pair.inertia()).norm(), kRelative * pair.inertia().norm()) << "state " << i;
    const Eigen::Vector3d hand = pair.hand();
    ASSERT_LE((pair.chain->hand_position(q) - Eigen::Vector2d(hand[0], hand[2])).norm(), kRelative) << "state " << i;
    const RowMatrix J = pair.jacobian();
    ASSERT_LE((pair.chain->jacobian(q).row(0) - J.row(0)).norm(), kRelative) << "state " << i;
    ASSERT_LE((pair.chain->jacobian(q).row(1) - J.row(2)).norm(), kRelative) << "state " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Arms, SerialChainAgainstMujoco, ::testing::Values("RRR", "RPR", "RRRRRR", "RCPRRRR"));

}  // namespace
}  // namespace mbk::robot
