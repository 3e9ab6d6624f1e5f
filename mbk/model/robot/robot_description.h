#pragma once

#include <string>
#include <vector>

#include "mbk/model/robot/dynamic_model.h"

namespace mbk::robot {

/// A robot with its source texts, so that a result can store them and the robot can be recreated.
struct RobotDescription {
  DynamicModel model;                   ///< coefficients listed in `unstated` are 0 in its parameters
  std::string toml;                     ///< the text of its TOML file
  std::string urdf;                     ///< the text of its URDF; empty without one
  std::string source;                   ///< its file, or another name
  std::vector<std::string> unstated;    ///< names of coefficients without a value in the files
  std::vector<std::string> impossible;  ///< physically impossible values in the files, one sentence each
  bool usable = true;                   ///< false: its identification reported that the numbers must not be used
  std::vector<std::string> warnings;    ///< warning codes of its identification
};

}  // namespace mbk::robot
