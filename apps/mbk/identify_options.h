#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>

#include "mbk/measure/identify/impedance_fit.h"

namespace mbk::app {

/// From a prepared trial to M, B, K and x0.
struct IdentifyArguments {
  Method method = Method::least_squares;
  Structure structure = Structure::full;
  std::optional<ParametersFrom> parameters_from;
  double handle_mass = 0.0;
  double hac_lag_s = 1.0;
  int bootstrap = 0;
  std::uint64_t seed = 1;
  bool decimate_check = false;
};

/// Adds --method, --structure, --parameters-from, --handle-mass, --hac-lag, --bootstrap, --seed, --decimate-check.
void add_identify_options(CLI::App& command, IdentifyArguments& arguments);

[[nodiscard]] identify::Options identify_options(const IdentifyArguments& arguments);

}  // namespace mbk::app
