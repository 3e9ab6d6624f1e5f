#pragma once

#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// A column, row or variable of a file, as a channel map can name it.
struct FileSignal {
  std::string source;  ///< what stands behind the "=" of a map: "3", "force", "pos[1]"
  std::string name;    ///< what the file calls it; "" where it says nothing
  Vector values;
};

/// Every one of the file whose source can stand in a map.
[[nodiscard]] std::vector<FileSignal> signals_of(const Contents& contents);

/// A channel map that names and numbers of a file suggest.
struct ChannelGuess {
  std::string map;                   ///< "time=1,x=2:mm,…"; holds what was found, even where something is missing
  std::vector<std::string> reasons;  ///< one for each entry: "Fx = 4: named 'force_x (N)'"
  std::vector<std::string> missing;  ///< channels without which nothing is measured: "x", "F"
};

/// Time by its name, or as the only signal that rises by even steps; position, force, reference and acceleration by the
/// words in their names, in the order of the file where no axis is named. Units by the names, and where these say none
/// by size: time whose steps are longer than 0.2 is in ms, positions that reach more than 3 from their mean are in mm.
/// A guess: a person, or the check of what is read with it, has to confirm it.
[[nodiscard]] ChannelGuess guess_channels(const std::vector<FileSignal>& signals);

}  // namespace mbk::recording
