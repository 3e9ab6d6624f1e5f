#pragma once

#include <string>
#include <vector>

#include "mbk/model/robot/dynamic_model.h"

namespace mbk::robot {

/// A robot with the texts that it was read from, so that a result can carry them and the robot be made anew.
struct RobotDescription {
  DynamicModel model;                   ///< what `unstated` names is 0 in its parameters
  std::string toml;                     ///< the text of its TOML file
  std::string urdf;                     ///< the text of its URDF; empty where it has none
  std::string source;                   ///< the file it came from, or what else it is called
  std::vector<std::string> unstated;    ///< names of coefficients whose values the files leave open
  std::vector<std::string> impossible;  ///< of what the files state: what no robot can have, a sentence for each
  bool usable = true;                   ///< false: what identified it said that its numbers must not be used
  std::vector<std::string> warnings;    ///< of what identified it, their codes
};

}  // namespace mbk::robot
