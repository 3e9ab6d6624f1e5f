#pragma once

#include <string>

#include "mbk/model/trial/exploration.h"

namespace mbk::report {

/// What recordings say of a limb without a model of it, part by part, for the terminal.
[[nodiscard]] std::string exploration_text(const Exploration& found);

}  // namespace mbk::report
