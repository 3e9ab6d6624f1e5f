#pragma once

#include <map>
#include <string>
#include <vector>

#include "mbk/files/recording/shared_matrix.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// Numbers of a file under the name that they have there.
struct Array {
  std::string name;  ///< CSV column, MAT variable or "struct.field", HDF5 path; "" for a column without a header
  SharedMatrix values;
  std::string unit = {};  ///< what the file says of it beside its name: "mm"; "" where it says nothing
  bool signal = false;    ///< the file says that it is one, even with a single sample
  double rate_hz = 0.0;   ///< of its samples, as the file says it; 0 where it does not
};

/// Text of a file, in UTF-8 without control characters: the rows of a char array, or the entries of a cell array of
/// them.
struct Text {
  std::string name;  ///< MAT variable or "struct.field"
  std::vector<std::string> lines;
};

/// What a reader found in a file, before anything is said about channels.
struct Contents {
  std::string format;  ///< "CSV", "C3D", "MAT v4", "MAT v5", "MAT v7", "MAT v7.3", "HDF5"
  bool table = false;  ///< CSV, C3D: the arrays are columns, and a number in the channel map counts them
  std::vector<Array> arrays;
  std::vector<Text> texts;
  std::map<std::string, std::string> metadata;  ///< what `take_annotations` found
  std::vector<Event> events;                    ///< the same
  std::vector<std::string> notes;               ///< one sentence each: what was ignored and why
};

}  // namespace mbk::recording
