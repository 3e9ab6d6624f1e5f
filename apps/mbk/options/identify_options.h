#pragma once

#include "apps/mbk/terminal/command.h"
#include "mbk/measure/identify/impedance_fit.h"

namespace mbk::app {

/// Adds --method, --structure, --parameters-from, --handle-mass, --hac-lag, --bootstrap, --seed, --decimate-check.
void add_identify_options(Command command, identify::Options& options);

}  // namespace mbk::app
