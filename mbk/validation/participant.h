#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "mbk/core/result.h"
#include "mbk/trial/validation_table.h"

namespace mbk::validation {

struct ParticipantOptions {
  int runs = 10;  ///< seeds for each arm and condition
  std::uint64_t seed = 1;
  unsigned threads = 0;                     ///< 0: as many as there are cores
  std::vector<int> arms = {1, 4, 5};        ///< participants of the thesis whose limbs are used
  std::function<void(int, int)> progress;   ///< called with the number of trials that are done, and of all
};

/// Does the simulated participant behave as people did (Dyck 2013, figs 4.3–4.5, tables 4.1–4.3 in form)? The ready
/// scenarios, each arm, seed after seed: does the energy that the limb absorbed rise, and how much of the force does a
/// fitted M, B, K explain (published procedure)? The same arm and controller face 2 N and 8 N pulses, which differ in
/// `amplitude_N` alone; between them the energy crosses zero at an amplitude that is found by interpolation and drawn.
/// Rows of energy: the share of runs with the expected sign [%]; rows of VAF: the lowest and the highest of the
/// runs, each the mean of both axes [%].
/// @fails  runs < 1; as the laboratory and the measurement.
[[nodiscard]] Result<ValidationTable> participant(const ParticipantOptions& options);

}  // namespace mbk::validation
