#include "mbk/model/robot/observed_force.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace mbk::robot {
namespace {

Result<void> check_finite(const char* name, const Matrix& values) {
  for (Index joint = 0; joint < values.cols(); ++joint) {
    const Index bad = first_non_finite(values.col(joint));
    if (bad >= 0) {
      return bad_data(fmt::format("{}_{} is not a finite number at sample {}", name, joint + 1, bad),
                      "choose a window without it");
    }
  }
  return {};
}

}  // namespace

Result<ObservedForces> observe_force(const DynamicModel& model, const Matrix& position, const Matrix& torque,
                                     const EncoderMomentumObserver::Options& options, double sample_time) {
  const Index n = model.mechanism->joints();
  if (position.cols() != n || torque.cols() != n || position.rows() != torque.rows()) {
    return bad_data(fmt::format("positions of {} joints at {} samples and torques of {} joints at {} samples do not "
                                "match a robot of {} joint{}",
                                position.cols(), position.rows(), torque.cols(), torque.rows(), n, n == 1 ? "" : "s"),
                    "give joint and torque channels for every joint");
  }
  MBK_TRY(check_finite("joint", position));
  MBK_TRY(check_finite("torque", torque));
  auto observer = MBK_TRY(EncoderMomentumObserver::create(model, options, sample_time));

  ObservedForces all{Matrix(position.rows(), n), Matrix(position.rows(), model.mechanism->hand_axes()), observer.lag()};
  for (Index i = 0; i < position.rows(); ++i) {
    const ObservedForce& now = observer.step(position.row(i).transpose(), torque.row(i).transpose());
    if (!now.force_hand_on_robot.allFinite()) {
      const auto L = hand_from_joints(*model.mechanism, position.row(i).transpose());
      return tl::unexpected(
          (L ? Error{ErrorKind::data, "the observed force is not finite", "check the parameters of the model", ""}
             : L.error())
              .in(fmt::format("sample {}", i)));
    }
    all.joint_torque.row(i) = now.joint_torque.transpose();
    all.force_hand_on_robot.row(i) = now.force_hand_on_robot.transpose();
  }
  const double slowest = std::max(1.0 / options.gain, 1.0 / RadPerSec(options.velocity_cutoff).value);
  const double samples = std::ceil(std::log(100.0) * slowest / sample_time);
  all.settled = std::min(position.rows(), static_cast<Index>(samples));
  return all;
}

}  // namespace mbk::robot
