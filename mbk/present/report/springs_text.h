#pragma once

#include <string>
#include <vector>

#include "mbk/model/trial/springs.h"

namespace mbk::report {

/// A spring array for the terminal: equilibrium, stiffness, how straight it is, each spring, and the grid where there
/// is one.
[[nodiscard]] std::string spring_field_text(const SpringField& field);

/// The same for springs that were looked for, and then as options of 'mbk springs field' and as TOML, with the digits
/// that give the expected stiffness back.
[[nodiscard]] std::string spring_design_text(const SpringDesign& design);

/// Spring constants from stretches, with how the straight part was chosen and what a line through everything would
/// have given.
[[nodiscard]] std::string spring_constants_text(const std::vector<SpringConstant>& constants);

/// "k=120.0000,l=90.0000mm,anchor=565.0000:183.0000" as --spring takes it.
[[nodiscard]] std::string spring_option(const Spring& spring);

}  // namespace mbk::report
