#pragma once

#include <array>

#include "mbk/model/robot/drive_terms.h"

namespace mbk::robot {

/// A term of the drives and its name on the command line and in files.
struct DriveTermName {
  const char* word;
  bool DriveTerms::*requested;
};

/// In their order within each joint.
inline constexpr std::array<DriveTermName, 6> kDriveTermNames = {{{"motor_inertia", &DriveTerms::motor_inertia},
                                                                  {"viscous", &DriveTerms::viscous},
                                                                  {"coulomb", &DriveTerms::coulomb},
                                                                  {"stribeck", &DriveTerms::stribeck},
                                                                  {"cable", &DriveTerms::cable},
                                                                  {"offset", &DriveTerms::offset}}};

}  // namespace mbk::robot
