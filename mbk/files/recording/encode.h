#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/hdf5/tree.h"
#include "mbk/files/recording/mat_variables.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

// A recording as the bytes of a file. `write` has made sure that there are samples, that all channels have as many, and
// that texts are single lines of UTF-8. Equal recordings give equal bytes, whatever the order of their channels: they
// contain no date, and channels are in the order of the channel table.

/// A MAT file of level 5 whose variables (mat_variables.h) are compressed. (MathWorks, "MAT-File Format", R2023b.)
/// @fails  as mat_variables does; more than 2³¹ bytes of matrix.
[[nodiscard]] Result<std::string> encode_mat_level5(const Recording& recording);

/// The same variables in MATLAB's HDF5 format, v7.3: dimensions in reverse order, texts as numbers of UTF-16,
/// cells as references into `#refs#`, classes as attributes.
/// @fails  as mat_variables does.
[[nodiscard]] Result<std::string> encode_mat_hdf5(const Recording& recording);

/// Variables unchanged, in either version. Each name occurs once.
/// @fails  more than 2³¹ bytes of a matrix, in v5.
[[nodiscard]] Result<std::string> encode_mat_level5(const std::vector<MatVariable>& variables);
[[nodiscard]] Result<std::string> encode_mat_hdf5(const std::vector<MatVariable>& variables);

/// /time and `/channels/<name>`, one-dimensional, with the attributes `unit` and `frame`; /events/time, value and name;
/// metadata, `format` and `software` as attributes of the root.
/// @fails  a name that HDF5 does not allow; metadata named `format`.
[[nodiscard]] Result<std::string> encode_hdf5(const Recording& recording);

/// A header such as "time_s,hand_x_m,force_x_N", and numbers with all required digits. Metadata and events are comments
/// before it: "# key: value", "# event TIME VALUE NAME".
/// @fails  a name or key that could not be read back.
[[nodiscard]] Result<std::string> encode_csv(const Recording& recording);

/// Appends the shortest digits that give the number back.
void append_number(std::string& text, double value);

/// /events of an HDF5 file: time, value, name.
[[nodiscard]] hdf5::Group hdf5_events(const std::vector<Event>& events);

/// The value of `format` and of the first line of a CSV file.
inline constexpr std::string_view kLayout = "mbk.recording/1";

}  // namespace mbk::recording
