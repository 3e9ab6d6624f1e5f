#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/recording/channel_map.h"
#include "mbk/model/trial/file_contents.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// A file of several trials that was opened once, so that reading one of them opens nothing anew. May be used by
/// several threads.
class OpenTrials;

struct ReadOptions {
  std::vector<ChannelSource> channels;  ///< empty: the file is recognised automatically
  std::vector<std::string> requested;   ///< channels that are taken by name, beside those of the map; empty: without a
                                        ///< map all, and with one none
  std::optional<Hertz> rate;            ///< needed where the file holds no time; must agree with the time where it does
  int axes = 0;          ///< what x and xr mean: 1 position, reference; 2 hand_x, reference_x; 0 by the channels found
  bool untimed = false;  ///< rows without a time and a rate are taken as they are; otherwise that is an error
  std::string variable;  ///< the MAT variable that is meant, where several could be
  std::string clock;     ///< the stream or topic whose time stamps the recording has, where channels come from several;
                         ///< "": they must come from one
  std::string trial;     ///< which record of a file or folder that holds several (`list_trials`); "": its only one
  std::string arm;       ///< "right" or "left": whose hand is the hand in a file of two arms; "": the only one
  std::shared_ptr<const OpenTrials> open;  ///< the file, as `open_trials` gave it; nullptr: it is opened anew
};

/// Reads MAT (v4, v5, v6, v7, v7.3), HDF5, CSV and other tables, C3D, XDF, MCAP, bags of ROS 1, NumPy, OpenSim, KINARM
/// exams and BIDS data sets; the format is decided by the content, never by the name of the file.
///
/// Without a channel map these are recognised: a 19-row `logs` matrix (or the only matrix of 19 rows), and columns or
/// variables that carry the names of the channel table ("hand_x", "Fx", "hand_x_mm", "time [ms]"). With a map, a number
/// is a column of a table or tall matrix, or a row of a wide one (the signals run along the longer side); anything else
/// is a column or variable name or "structure.field". A matrix is never transposed silently.
/// A map that leaves out the time leaves it to its own name, or to row 1 of a logs matrix.
/// Rows of `logs` that are NaN throughout were not recorded and are no channels.
/// Recording::notes says what was ignored.
///
/// @fails  data: the file cannot be read, is damaged or of another format; nothing is recognised (the message lists
/// what there is); no time and no rate; a named source is not there; lengths differ.
///         usage: a rate that contradicts the time by more than 0.1 %; several matrices could be
///         meant; axes is not 0, 1 or 2.
[[nodiscard]] Result<Recording> read(const std::filesystem::path& file, const ReadOptions& options);

/// The records of a file or folder that can hold several: a KINARM exam, a BIDS data set. Nothing where it is of a
/// format that holds one.
/// @fails  data: the file cannot be read or is damaged.
[[nodiscard]] Result<std::vector<TrialName>> list_trials(const std::filesystem::path& file);

/// The file, for `ReadOptions::open`; nullptr where it is of a format that holds one record, or is a folder.
/// @fails  as list_trials
[[nodiscard]] Result<std::shared_ptr<const OpenTrials>> open_trials(const std::filesystem::path& file);
[[nodiscard]] const std::vector<TrialName>& trials_of(const OpenTrials& open);

/// What the file holds under its own names, whether or not any of it is recognised as a channel.
/// @param options  of which `trial`, `arm` and `open` count
/// @fails  data: the file cannot be read, is damaged or of another format.
[[nodiscard]] Result<FileContents> list_contents(const std::filesystem::path& file, const ReadOptions& options = {});

/// The same with all numbers, as they stand: for a file of which nothing is recognised, and which is to be copied.
/// @param options  as of list_contents
/// @fails  as list_contents
[[nodiscard]] Result<Contents> read_contents(const std::filesystem::path& file, const ReadOptions& options = {});

/// Whether `read` refused a sound file for this alone, that no channel of it is recognised.
[[nodiscard]] bool nothing_is_recognised(const Error& error);

/// Reads the numbered parts of one record (log_1.mat, log_2.mat, …, log_10.mat), in the order of their numbers, and
/// joins them. A pause between two parts is kept: inspect reports it as a gap.
/// @fails  usage: no parts, or a name without a number at its end. data: names of different records; a number missing
/// or twice; different channels or units; time that does not run on from part to part.
[[nodiscard]] Result<Recording> read_parts(std::vector<std::filesystem::path> parts, const ReadOptions& options);

}  // namespace mbk::recording
