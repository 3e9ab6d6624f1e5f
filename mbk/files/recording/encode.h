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

/// Intel reals: every channel is analog, in its unit; a hand in the plane or in space is also the marker "hand" [mm].
/// Texts are UTF-8. The group EVENT holds the events; what C3D has no place for is in the group MBK (metadata, the
/// values of events, exact rate and first time). Numbers have single precision (relative error 6e-8), times of events 2
/// µs. Numbers that are not finite are NaN, and the marker is invalid there. (c3d.org, "The C3D File Format".)
/// @fails  data: times that are not even within 1 % of an interval, or fewer than two; numbers beyond single precision;
/// names of more than 127 bytes; more than 130 kB of names, events and metadata.
[[nodiscard]] Result<std::string> encode_c3d(const Recording& recording);
[[nodiscard]] std::vector<std::string> lost_in_c3d(const Recording& recording);

/// Appends the shortest digits that give the number back.
void append_number(std::string& text, double value);

/// /events of an HDF5 file: time, value, name.
[[nodiscard]] hdf5::Group hdf5_events(const std::vector<Event>& events);

/// The value of `format` and of the first line of a CSV file.
inline constexpr std::string_view kLayout = "mbk.recording/1";

}  // namespace mbk::recording
