#pragma once

#include <vector>

#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::analyse {

/// Turns the advice of a measurement's warnings to their cause, as far as the measurement shows it: the other method,
/// where that finds what this one cannot; the filter, where it cuts into the band; the axis that moved.
void advise(const std::vector<const Recording*>& recordings, const std::vector<PreparedTrial>& trials,
            Measurement& measured);

}  // namespace mbk::analyse
