#pragma once

#include <string>
#include <vector>

#include "mbk/model/trial/recording.h"

namespace mbk {

/// By how much a force sensor is late, from the motion of a known mass.
struct MeasuredDelay {
  double delay = 0, delay_error = 0;  ///< τ and its standard error [s]; above 0: the force is read late
  double mass = 0, mass_error = 0;    ///< as found [kg]
  double stated_mass = 0;             ///< [kg]
  double vaf = 0;                     ///< of the force by that mass alone, the worse axis [%]
  double duration = 0;                ///< [s] of data
  std::vector<std::string> problems;  ///< why the delay is not to be used; empty: it may
  std::vector<SourceFile> sources;

  [[nodiscard]] bool usable() const { return problems.empty(); }
};

}  // namespace mbk
