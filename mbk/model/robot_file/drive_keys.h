#pragma once

#include <string>
#include <vector>

#include "mbk/base/config/document.h"
#include "mbk/model/robot/drive_terms.h"

namespace mbk::robot_file {

/// A drive term, its name in `terms`, and the keys of its values.
struct DriveTerm {
  const char* word;
  bool robot::DriveTerms::*requested;
  const char* turning_key;  ///< one value for each joint that turns
  const char* sliding_key;  ///< one value for each joint that slides
};

/// In the order of DriveTerms::coefficients.
[[nodiscard]] const std::vector<DriveTerm>& drive_terms();

/// ψ during reading: joint by joint, term by term.
struct DriveValues {
  robot::DriveTerms terms;
  Vector values;             ///< ψ; 0 if not stated
  std::vector<bool> stated;  ///< for each of ψ

  DriveValues(const robot::DriveTerms& requested, int joints);

  /// Does nothing if the term is not requested.
  void set(bool robot::DriveTerms::*term, int joint, double value);
};

/// [drive] terms = ["viscous", …]; by default viscous, coulomb, offset.
[[nodiscard]] robot::DriveTerms read_terms(const config::Section& drive);

/// smoothing_… and stribeck_velocity_… in rad_per_s, or in m_per_s where all joints slide.
void read_velocities(const config::Section& drive, const robot::Mechanism& mechanism, robot::DriveTerms& terms);

/// The values of the drives by the keys of [drive]. A value of a term that is not requested is refused.
/// @param except  terms whose values are elsewhere
void read_values(const config::Section& drive, const robot::Mechanism& mechanism,
                 const std::vector<std::string>& except, DriveValues& into);

}  // namespace mbk::robot_file
