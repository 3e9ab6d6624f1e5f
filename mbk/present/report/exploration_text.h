#pragma once

#include <string>

#include "mbk/model/trial/exploration.h"

namespace mbk::report {

/// An exploration of recordings without a model, part by part, for the terminal.
[[nodiscard]] std::string exploration_text(const Exploration& found);

}  // namespace mbk::report
