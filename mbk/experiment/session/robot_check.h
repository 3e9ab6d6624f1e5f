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

/// A planar robot, its wiring and its limits, as in a file.
struct RobotSetup {
  protocol::Trial trial;    ///< of an experiment, its first; of a description, one with its robot and device
  bool has_device = false;  ///< a device is named
  bool has_home = false;    ///< experiments give a home position; descriptions do not
};

/// Reads the first trial of an experiment (it has [control] or [perturbation]), or the description of a robot.
/// @param file  its name in messages; libraries are named relative to its folder
/// @fails  data: as read_experiment, as robot_file::parse_robot_description; the robot is not planar.
/// @param simulation  as of protocol::read_experiment
[[nodiscard]] Result<RobotSetup> read_robot_setup(std::string_view text, const std::filesystem::path& file,
                                                  const protocol::ReadSimulation& simulation = {});

/// Result of one check.
struct Finding {
  enum class Verdict { fine, doubtful, wrong };
  Verdict verdict = Verdict::fine;
  std::string text;  ///< a sentence with numbers and units, and what to do if it is not fine
};

[[nodiscard]] constexpr auto word_table(Finding::Verdict) {
  using enum Finding::Verdict;
  return std::to_array<Word<Finding::Verdict>>({{fine, "fine"}, {doubtful, "doubtful"}, {wrong, "wrong"}});
}

/// The worst of them; fine where there are none.
[[nodiscard]] Finding::Verdict worst(const std::vector<Finding>& findings);

/// Whether lengths, inertia, workspace, home, limits, resolutions and units are plausible. A count at the hand is
/// σ₁(J diag(∂θ/∂count)) [m], σ₁ the largest singular value.
[[nodiscard]] std::vector<Finding> check_setup(const RobotSetup& setup);

/// Geometry, limits, wiring and device as read, for people.
[[nodiscard]] std::string setup_text(const RobotSetup& setup);

}  // namespace mbk::session
