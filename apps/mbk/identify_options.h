#pragma once

#include <CLI/CLI.hpp>

#include "mbk/measure/identify/impedance_fit.h"

namespace mbk::app {

/// Adds --method, --structure, --parameters-from, --handle-mass, --hac-lag, --bootstrap, --seed, --decimate-check.
void add_identify_options(CLI::App& command, identify::Options& options);

}  // namespace mbk::app
