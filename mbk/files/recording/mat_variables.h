#pragma once

#include <string>
#include <variant>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

inline constexpr std::size_t kMatHeaderText = 116;  ///< bytes with which a MAT-file of level 5 or 7.3 says what it is

/// A variable of MATLAB, or a field of a structure.
struct MatVariable {
  using Structure = std::vector<MatVariable>;
  using Cells = std::vector<std::string>;  ///< a column of texts

  std::string name;
  std::variant<Matrix, std::string, Cells, Structure> value;
};

/// `events` of a MAT file: time, name, value.
[[nodiscard]] MatVariable::Structure structure_of(const std::vector<Event>& events);

/// What a MAT file holds of a recording, whatever its version: the 19×N matrix `logs` where every channel has a row in
/// it, and otherwise (one axis) one column for each channel, and `time`. Rows of `logs` that have no channel are NaN,
/// so that nobody takes them for measured zeros; a channel that is NaN throughout would be taken for such a row, and
/// makes columns of all. Metadata and events stand beside it as structures (annotations.h), where there are any.
/// @fails  what metadata_to_write refuses; a channel whose name cannot be that of a variable.
[[nodiscard]] Result<std::vector<MatVariable>> mat_variables(const Recording& recording);

}  // namespace mbk::recording
