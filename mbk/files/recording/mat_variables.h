#pragma once

#include <string>
#include <variant>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/result.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

inline constexpr std::size_t kMatHeaderText = 116;  ///< bytes of the header text of a MAT-file of level 5 or 7.3

/// A variable of MATLAB, or a field of a structure.
struct MatVariable {
  using Structure = std::vector<MatVariable>;
  using Cells = std::vector<std::string>;  ///< a column of texts

  std::string name;
  std::variant<Matrix, std::string, Cells, Structure> value;
};

/// `events` of a MAT file: time, name, value.
[[nodiscard]] MatVariable::Structure structure_of(const std::vector<Event>& events);

/// The variables of a recording in a MAT file of any version: the 19×N matrix `logs` if every channel has a row in it,
/// otherwise (one axis) one column per channel, and `time`. Rows of `logs` without a channel are NaN, so that they are
/// not mistaken for measured zeros; a channel that is NaN throughout would look like such a row, so all channels are
/// then written as columns. Metadata and events, if any, are added as structures (annotations.h).
/// @fails  as metadata_to_write; a channel name that is not a valid variable name.
[[nodiscard]] Result<std::vector<MatVariable>> mat_variables(const Recording& recording);

}  // namespace mbk::recording
