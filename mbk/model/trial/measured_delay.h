#pragma once

#include <string>
#include <vector>

#include "mbk/model/trial/recording.h"

namespace mbk {

/// Delay of a force sensor, from the motion of a known mass.
struct MeasuredDelay {
  double delay = 0, delay_error = 0;  ///< τ and its standard error [s]; positive: the force is delayed
  double mass = 0, mass_error = 0;    ///< as found [kg]
  double stated_mass = 0;             ///< [kg]
  double vaf = 0;                     ///< VAF of the force by that mass alone, worse axis [%]
  double duration = 0;                ///< [s] of data
  std::vector<std::string> problems;  ///< why the delay must not be used; empty: it may be used
  std::vector<SourceFile> sources;

  [[nodiscard]] bool usable() const { return problems.empty(); }
};

}  // namespace mbk
