#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/rests.h"
#include "mbk/base/core/result.h"
#include "mbk/files/contents/shared_matrix.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// The time stamps that the arrays of one stream, topic or tracking system share, in a file that has several of them.
struct Clock {
  std::string name;  ///< of the stream or topic: what --clock names
  Vector time;       ///< [s], on the common time of the file, after the corrections listed in Contents::notes
};

/// Numbers of a file under their name in the file.
struct Array {
  std::string name;  ///< CSV column, MAT variable or "struct.field", HDF5 path; "" for a column without a header
  SharedMatrix values;
  std::string unit = {};   ///< unit stated apart from the name: "mm"; "" if none
  bool signal = false;     ///< the file marks it as a signal, even with a single sample
  double rate_hz = 0.0;    ///< rate of its samples stated in the file; 0 if none
  int clock = -1;          ///< clock of the samples: index into Contents::clocks; -1 in a file without clocks
  std::string means = {};  ///< channel implied by the stored type ("force_x" of a wrench, "-force_x" if the robot
                           ///< exerts it); "" if only the name may imply it
  std::string joint = {};  ///< name of its joint: "elbow_joint"; "" if the file names none
  std::optional<Error> obstacle = {};  ///< why its numbers cannot be used, as for a column of words; `values` are empty
  std::vector<std::uint64_t> shape = {};  ///< for an array of more than two dimensions; otherwise empty. If more than
                                          ///< two of them are longer than 1, `values` are one column
  bool row_major = false;                 ///< of such a column: the last dimension varies fastest, not the first
  Rests rests = {};            ///< remainders of integers above 2^53 that `values` do not represent, in their order
  std::string unapplied = {};  ///< attribute that may scale the numbers in an undefined way: "gain = 4.448"; they are
                               ///< used only with a gain stated in the map

  /// Whether more than two dimensions are longer than 1; then only slices are signals.
  [[nodiscard]] bool is_block() const {
    return std::ranges::count_if(shape, [](std::uint64_t side) { return side != 1; }) > 2;
  }
};

/// Text of a file, in UTF-8 without control characters: the rows of a char array, or the entries of a cell array of
/// them.
struct Text {
  std::string name;  ///< MAT variable or "struct.field"
  std::vector<std::string> lines;
};

/// One record of a file or folder: a trial of an exam, a run of a data set.
struct TrialName {
  std::string name;         ///< name for --trial: "3", "sub-07_task-reach_run-1"
  std::string description;  ///< description for the user: "block 2, trial 1, repeat 1, 4.0 s"; may be empty
};

/// Contents of a file as decoded, before channels are assigned.
struct Contents {
  std::string format;  ///< "CSV", "C3D", "MAT v7", "HDF5", "XDF", …
  bool table = false;  ///< CSV, C3D: the arrays are columns, and a number in the channel map is a column number
  std::vector<Array> arrays;
  std::vector<std::string> units = {};  ///< units stated for the whole file: "deg" of angles, "mm" of lengths
  double rate_hz = 0.0;                 ///< rate stated for all arrays; 0 if none
  std::string rate_from = {};           ///< source of the rate, for messages: "line 1, 'Fs,1000'"
  std::vector<Clock> clocks;            ///< empty if all arrays share one time or rate
  std::vector<Text> texts;
  std::map<std::string, std::string> metadata;  ///< what `take_annotations` found
  std::vector<Event> events;                    ///< the same
  std::vector<std::string> notes;               ///< one sentence each: what was ignored and why
  std::map<std::string, std::string> damaged;   ///< names of arrays that could not be read, and why, as a sentence
};

/// One of the records of a file, decoded.
struct NamedContents {
  TrialName name;
  Contents contents;
};

}  // namespace mbk::recording
