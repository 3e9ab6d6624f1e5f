#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/files/contents/contents.h"

namespace mbk::recording {

/// A column, row or variable of a file, as a channel map can name it.
struct FileSignal {
  std::string source;  ///< the text after "=" in a map: "3", "force", "pos[1]"
  std::string name;    ///< its name in the file; "" if none
  Vector values;
};

/// Every signal of the file that a map can name.
[[nodiscard]] std::vector<FileSignal> signals_of(const Contents& contents);

/// One channel of a guess.
struct GuessedChannel {
  std::string entry;          ///< as a map writes it: "x=2:mm"
  std::string channel;        ///< "x"
  std::size_t signal = 0;     ///< index of its source
  std::string unit;           ///< "" if it is not known
  bool unit_by_size = false;  ///< the unit is assumed from the size of the numbers
  std::string why;            ///< what it was recognised by: "name", "steps"
};

/// A channel map suggested by names and numbers of a file.
struct ChannelGuess {
  std::string map;  ///< "time=1,x=2:mm,…"; contains the channels found, even if some are missing
  std::vector<GuessedChannel> channels;
  std::vector<std::string> missing;  ///< channels without which nothing is measured: "x", "F"
};

/// Time by its name, or as the only signal that increases in even steps; position, force, reference and acceleration by
/// the words in their names, in file order if no axis is named. Three axes where position and force are both named
/// along x, y and z. Units by the names or, if missing, by size: time whose steps are longer than 0.2 is in ms,
/// positions that reach more than 3 from their mean are in mm. This is a guess: the user, or a check of the data read
/// with it, must confirm it.
[[nodiscard]] ChannelGuess guess_channels(const std::vector<FileSignal>& signals);

}  // namespace mbk::recording
