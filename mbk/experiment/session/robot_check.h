#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/words.h"
#include "mbk/experiment/protocol/experiment.h"

namespace mbk::session {

/// What a file says of a planar robot, its wires and its limits.
struct RobotSetup {
  protocol::Trial trial;    ///< of an experiment, its first; of a description, one with its robot and device
  bool has_device = false;  ///< there is something to connect to
  bool has_home = false;    ///< an experiment says where the hand is at home; a description does not
};

/// An experiment, its first trial, or the description of a robot, by what stands in it: [control] or [perturbation].
/// @param file  how messages call it, and where the names of libraries begin
/// @fails  data: as read_experiment, as robot_file::parse_robot_description; the robot is no planar one.
/// @param simulation  as of protocol::read_experiment
[[nodiscard]] Result<RobotSetup> read_robot_setup(std::string_view text, const std::filesystem::path& file,
                                                  const protocol::ReadSimulation& simulation = {});

/// One thing that was looked at.
struct Finding {
  enum class Verdict { fine, doubtful, wrong };
  Verdict verdict = Verdict::fine;
  std::string text;  ///< a sentence with numbers and units, and what to do where it is not fine
};

[[nodiscard]] constexpr auto word_table(Finding::Verdict) {
  using enum Finding::Verdict;
  return std::to_array<Word<Finding::Verdict>>({{fine, "fine"}, {doubtful, "doubtful"}, {wrong, "wrong"}});
}

/// The worst of them; fine where there are none.
[[nodiscard]] Finding::Verdict worst(const std::vector<Finding>& findings);

/// Whether lengths, inertia, workspace, home, limits, resolutions and units can be meant:
///   at the hand a count is worth σ₁(J diag(∂θ/∂count)) [m], σ₁ the largest singular value.
[[nodiscard]] std::vector<Finding> check_setup(const RobotSetup& setup);

/// Geometry, limits, wiring and device, as they were understood, for people.
[[nodiscard]] std::string setup_text(const RobotSetup& setup);

}  // namespace mbk::session
