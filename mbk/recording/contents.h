#pragma once

#include <string>
#include <vector>

#include "mbk/core/linear_algebra.h"

namespace mbk::recording {

/// Numbers of a file under the name that they have there.
struct Array {
  std::string name;  ///< CSV column, MAT variable or "struct.field"; "" for a column without a header
  Matrix values;
};

/// What a reader found in a file, before anything is said about channels.
struct Contents {
  std::string format;  ///< "CSV", "MAT v4", "MAT v5", "MAT v7", "MAT v7.3"
  bool table = false;  ///< CSV: the arrays are columns, and a number in the channel map counts them
  std::vector<Array> arrays;
  std::vector<std::string> notes;  ///< one sentence each: what was left aside and why
};

}  // namespace mbk::recording
