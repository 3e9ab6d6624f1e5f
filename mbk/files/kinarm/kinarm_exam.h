#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/archive/zip_archive.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/kinarm/hand_geometry.h"

namespace mbk::recording {

/// Which trial of an exam, and which arm to analyse.
struct ExamChoice {
  std::string trial;       ///< as `KinarmExam::trials` names it; "": the only one
  std::optional<Arm> arm;  ///< nothing: the only one that was recorded
  bool needs_arm = true;   ///< true: both arms without a selection are an error; false: neither is used
};

/// An exam of a KINARM robot: a `.kinarm` file, or a `.zip` of C3D files, decided by the content. Opening it reads the
/// member names and the trial parameters; the samples of a trial are unpacked on request. May be used by several
/// threads.
///
/// A trial's arrays are its signals under their own names, in the units of the file, each sample being the stored
/// 32-bit real (for *_FS_Status its bits as an integer); a position LABEL as LABEL.x and LABEL.y. Beside them, for each
/// arm of which the joints were recorded (SIDE is Right or Left):
///   SIDE_hand_x, _y                [m] by the joint angles, from the axis of the first link (hand_x, hand_y)
///   SIDE_hand_velocity_x, _y       [m/s] by the joint velocities
///   SIDE_hand_acceleration_x, _y   [m/s²] by the joint accelerations (acceleration_x, acceleration_y)
///   SIDE_force_x, _y               [N] of the hand on the robot: FS_ForceX, FS_ForceY with the sign that was inferred
///                                  from at most kSignTrials trials of the exam (force_x, force_y)
///   SIDE_commanded_force_x, _y     [N] on the hand, of the commanded torques by J⁻ᵀ
/// In brackets: the channels that they become for the chosen arm, and joint_1, joint_2, torque_1, torque_2 likewise.
class KinarmExam {
 public:
  static constexpr std::size_t kSignTrials = 8;

  /// Whether the archive contains raw/common.c3d, or anything in raw/common/.
  [[nodiscard]] static bool is_exam(const ZipArchive& archive);

  /// @fails  data: not an exam; it is damaged; it contains no trial.
  [[nodiscard]] static Result<KinarmExam> open(std::shared_ptr<const Buffer> file);
  KinarmExam(KinarmExam&& other) noexcept;
  KinarmExam& operator=(KinarmExam&& other) noexcept;
  KinarmExam(const KinarmExam&) = delete;
  KinarmExam& operator=(const KinarmExam&) = delete;
  ~KinarmExam();

  /// In the order of TRIAL:TRIAL_NUM, their name; the parts of a split trial are joined.
  [[nodiscard]] const std::vector<TrialName>& trials() const;

  /// @fails  usage: there is no such trial, or several and none is named; both arms were recorded and none is named, or
  /// the named one was not.
  ///         data: the trial is damaged.
  [[nodiscard]] Result<Contents> decode(const ExamChoice& choice) const;

 private:
  struct Open;
  explicit KinarmExam(std::unique_ptr<Open> open);
  std::unique_ptr<Open> open_;
};

}  // namespace mbk::recording
