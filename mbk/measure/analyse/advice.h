#pragma once

#include <vector>

#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/prepared_trial.h"
#include "mbk/model/trial/recording.h"

namespace mbk::analyse {

/// Adapts the advice of the warnings to their cause if the measurement shows it: use the other method if it gives a
/// valid model, change the filter if it cuts into the band, or measure only the axis that moved.
void advise(const std::vector<const Recording*>& recordings, const std::vector<PreparedTrial>& trials,
            Measurement& measured);

}  // namespace mbk::analyse
