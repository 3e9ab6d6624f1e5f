#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/model/trial/recording.h"

namespace mbk {

/// Numbers of a file under their name in it: a column of a table, a variable, a field of a structure.
struct StoredArray {
  std::string name;  ///< "" for a column without a heading
  Index rows = 0, columns = 0;
  double minimum = 0, maximum = 0;        ///< of the finite values; NaN where there is none
  std::string unit;                       ///< as stated in the file; "" if not stated
  double rate_hz = 0;                     ///< as stated in the file; 0 if not stated
  std::vector<std::uint64_t> shape = {};  ///< of more than two dimensions; empty of any other
};

/// Contents of a file, before channels are assigned.
struct FileContents {
  SourceFile source;
  bool table = false;  ///< the arrays are columns, counted from 1
  std::vector<StoredArray> arrays;
  std::vector<std::string> notes;  ///< what was ignored, and why
};

}  // namespace mbk
