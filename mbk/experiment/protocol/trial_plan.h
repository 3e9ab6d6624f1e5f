#pragma once

#include <cstdint>
#include <string>

#include "mbk/base/core/units.h"
#include "mbk/model/perturbation/schedule_plan.h"
#include "mbk/model/trial/readers.h"

namespace mbk::protocol {

/// What a trial is, whatever robot it runs on, real or simulated.
struct TrialPlan {
  std::string name;       ///< of the [[trial]]; empty where the file has none
  std::string protocol;   ///< name of the file without folder and ending
  std::string condition;  ///< in words
  perturbation::Plan perturbation;
  Hertz rate{1000.0};                ///< of control and recording
  std::uint64_t seed = 1;            ///< of the schedule's phases and order, and of what is simulated
  Readers readers = Readers::owner;  ///< of the recording
};

}  // namespace mbk::protocol
