#pragma once

#include <string>

#include "mbk/model/trial/chart.h"
#include "mbk/model/trial/consistent_fit.h"
#include "mbk/model/trial/passivity.h"

namespace mbk::report {

/// Both statements in full for the terminal: the energy of the trial; each model with all its conditions.
[[nodiscard]] std::string passivity_text(const Passivity& passivity, Motion motion);

/// The nearest model that a passive limb can have, and its loss of fit.
[[nodiscard]] std::string consistent_text(const ConsistentFit& fit, Motion motion);

/// Both statements, each in a sentence.
[[nodiscard]] std::string passivity_lines(const Passivity& passivity);

/// Energy over time (Dyck 2013, figs 3.15, 3.17, 4.3, 4.4).
[[nodiscard]] Chart energy_chart(const Energy& energy);

}  // namespace mbk::report
