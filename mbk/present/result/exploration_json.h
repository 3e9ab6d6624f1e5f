#pragma once

#include <string>

#include "mbk/model/trial/exploration.h"

namespace mbk::result {

/// Schema "mbk.explore/1": each part of an exploration that is there, under its own name.
[[nodiscard]] std::string to_json(const Exploration& found);

}  // namespace mbk::result
