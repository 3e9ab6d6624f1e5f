#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mbk/validate/study.h"

namespace mbk::validation {

inline constexpr int kLinkTicks = 3;  ///< of a link on one machine, until the last command of the ramp acts

struct UdpFaultsOptions {
  StudyOptions study;               ///< threads: trials side by side, 0: four
  std::filesystem::path program;    ///< mbk itself; mbk_misbehaving_robot stands beside it
  std::vector<std::string> faults;  ///< names of udp_fault_kinds; empty: all, and running without a fault
};

/// The faults of a robot behind UDP, from outside: `mbk run` and a robot that misbehaves (MisbehavingRobot) are
/// processes on the loopback, in real time. A run is one moment of each kind, in turn in a trial of positions and one
/// of forces, and three minutes without a fault. What the motors truly did the robot records; a fault counts as
/// recognised in time where they were off, or the robot was told so, within the documented ticks and the ramp.
/// Expected: recognised in time for a right reason, and never a wrong word about the motors. What a recorded stall of
/// the loop or of the robot's program explains is counted apart and tried again, with another moment, up to five times.
/// @fails  usage: runs < 1; a fault that there is not. data: a program cannot be begun, or says something else.
[[nodiscard]] Result<ValidationTable> udp_faults_study(const UdpFaultsOptions& options);

/// docs/guide/safety.md, from the tables of both links that the tests run.
[[nodiscard]] std::string safety_page();

}  // namespace mbk::validation
