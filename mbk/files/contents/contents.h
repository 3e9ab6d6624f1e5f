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
  Vector time;       ///< [s], on the one time of the file; after what Contents::notes say was corrected
};

/// Numbers of a file under the name that they have there.
struct Array {
  std::string name;  ///< CSV column, MAT variable or "struct.field", HDF5 path; "" for a column without a header
  SharedMatrix values;
  std::string unit = {};   ///< what the file says of it beside its name: "mm"; "" where it says nothing
  bool signal = false;     ///< the file says that it is one, even with a single sample
  double rate_hz = 0.0;    ///< of its samples, as the file says it; 0 where it does not
  int clock = -1;          ///< whose samples these are: an index into Contents::clocks; -1 in a file without clocks
  std::string means = {};  ///< channel that the type of what was stored says it is ("force_x" of a wrench, "-force_x"
                           ///< of one that the robot exerts); "" where the name alone may say it
  std::string joint = {};  ///< name of the joint that it belongs to: "elbow_joint"; "" where the file names none
  std::optional<Error> obstacle = {};  ///< why its numbers cannot be used, for whoever asks for it: a column of words;
                                       ///< `values` then are empty
  std::vector<std::uint64_t> shape = {};  ///< of an array of more than two dimensions; empty of any other. Where more
                                          ///< than two of them are longer than 1, `values` are one column
  bool row_major = false;                 ///< of such a column: the last dimension runs fastest, not the first
  Rests rests = {};                       ///< what `values` leave of whole numbers above 2^53, in their order
  std::string unapplied = {};  ///< what the file says that may scale its numbers, and not how: "gain = 4.448"; they are
                               ///< taken only with a gain that the map states

  /// Whether it has more than two dimensions that are longer than 1: of such, only slices are signals.
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

/// One of the records that a file or folder holds: a trial of an exam, a run of a data set.
struct TrialName {
  std::string name;         ///< what --trial names: "3", "sub-07_task-reach_run-1"
  std::string description;  ///< what the file says of it, for people: "block 2, trial 1, repeat 1, 4.0 s"; may be empty
};

/// What a reader found in a file, before anything is said about channels.
struct Contents {
  std::string format;  ///< "CSV", "C3D", "MAT v7", "HDF5", "XDF", …
  bool table = false;  ///< CSV, C3D: the arrays are columns, and a number in the channel map counts them
  std::vector<Array> arrays;
  std::vector<std::string> units = {};  ///< that the file says once for all: "deg" of angles, "mm" of lengths
  double rate_hz = 0.0;                 ///< that it says once for all arrays; 0 where it does not
  std::string rate_from = {};           ///< where it says so, for messages: "line 1, 'Fs,1000'"
  std::vector<Clock> clocks;            ///< empty where one time, or one rate, is that of all arrays
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
