#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/files/contents/contents.h"
#include "mbk/files/recording/channel_map.h"
#include "mbk/model/trial/file_contents.h"
#include "mbk/model/trial/recording.h"

namespace mbk::recording {

/// A file or folder that was opened once for a command: its bytes, its hash, its format, its trials. Reading from it
/// does not open it again. May be used by several threads.
class RecordingFile;

/// Codes of `read`'s errors: an intact file in which no channel, or only the time, is recognised; a time that cannot be
/// in seconds.
inline constexpr std::string_view kNothingRecognised = "nothing-recognised", kUnbelievableTime = "unbelievable-time";

/// Which columns are read as EMG, if their names contain the word EMG; those that a map names are read in any case.
enum class EmgReading {
  none,
  same_clock,  ///< that were sampled with the other channels
  all,         ///< if at another rate, the other channels are interpolated linearly to the clock of the EMG
};

/// How a file is to be read. Every default is right for a file that names its channels, holds one trial and has a time
/// for each sample; then
///
///   const auto recording = mbk::recording::read("log.mat", {});
///   if (!recording) std::fputs(recording.error().line().c_str(), stderr);
///
/// is all that is needed.
struct ReadOptions {
  /// Which column or variable of the file is which channel, in which unit and with which sign: as in --channels (parsed
  /// by channel_map.h). Empty: the file is recognised by its names.
  std::vector<ChannelSource> channels;

  /// Channels that are used under their name in the file, in addition to `channels`. Empty: all that are
  /// recognised if there is no map, and none if there is one.
  std::vector<std::string> requested;

  /// Sample rate. Needed if the file holds neither time nor rate; there is no default. If the file holds a time, the
  /// rate must agree with it to 0.1 %.
  std::optional<Hertz> rate;

  /// What the short names x and xr mean: 1 for position and reference of one axis, 2 or 3 for hand_x and reference_x of
  /// a plane or of space. 0: as the channels of the file show. A third axis (z, Fz, zr, az) is read with 3, if the map
  /// or `requested` names it, or if the file has hand_z and force_z under these names; otherwise such columns are
  /// ignored, whatever they contain.
  int axes = 0;

  /// Use a measured channel that is held, or that lacks samples, at its own samples (`at_own_samples`), for
  /// computations; false keeps every value as recorded.
  bool own_samples = false;

  /// Channels that may be commands, beside torques and `input`. A held command is exact, so it is not treated as a
  /// measurement with too low an update rate.
  std::vector<std::string> commands;

  /// Accept rows without time and rate and count them, as for loads on a force sensor. false: that is an error.
  bool untimed = false;

  /// The variable of a MAT file, if there are several candidates. "": the only one.
  std::string variable;

  /// The stream or topic whose time stamps the recording has, if channels come from several; the others are
  /// interpolated linearly. "": all channels must come from one, and nothing is converted to another clock.
  std::string clock;

  EmgReading emg = EmgReading::none;

  /// The record, if a file or folder holds several (`trials_of` lists them). "": its only one.
  std::string trial;

  /// Names of the robot's joints, in the order of its chain: a file that names joints then gives these as joint_1,
  /// torque_1, … Empty: in the order of the file.
  std::vector<std::string> joints;

  /// "right" or "left": which arm to analyse, if a file holds two. "": the only one.
  std::string arm;
};

/// Opens a recording: any format of `file_formats()`, detected by content, never by file name.
/// @fails  data: the file cannot be read or its format is unknown.
[[nodiscard]] Result<std::shared_ptr<const RecordingFile>> open(const std::filesystem::path& file);

/// The records of a file or folder that can hold several: a KINARM exam, a BIDS data set. None if the format holds only
/// one.
[[nodiscard]] const std::vector<TrialName>& trials_of(const RecordingFile& file);

/// The same for a channel map, which may leave one array dimension free (slices.h): each index of it is a trial.
[[nodiscard]] std::vector<TrialName> trials_of(const RecordingFile& file, const ReadOptions& options);

/// Closes the file until it is read: for callers with hundreds of files.
void rest(const RecordingFile& file);

/// Reads one record of a file as a recording.
///
/// Without a channel map these are recognised: a 19-row `logs` matrix (or the only matrix of 19 rows), and columns or
/// variables that carry the names of the channel table ("hand_x", "Fx", "hand_x_mm", "time [ms]"). With a map, a number
/// is a column of a table or tall matrix, or a row of a wide one (the signals run along the longer side); anything else
/// is a column or variable name or "structure.field". A matrix is never transposed silently.
/// If a map omits the time, it is found by its name, or in row 1 of a logs matrix. Rows of `logs` that are NaN
/// throughout were not recorded and do not become channels. Recording::notes lists ignored data.
///
/// @fails  data: the file cannot be read, is damaged or of another format; nothing is recognised (the message lists the
/// contents); no time and no rate; a named source does not exist; lengths differ.
///         usage: a rate that contradicts the time by more than 0.1 %; several matrices are candidates; axes is not 0
///         to 3.
[[nodiscard]] Result<Recording> read(const RecordingFile& file, const ReadOptions& options);
/// The same for a file that is not used otherwise.
[[nodiscard]] Result<Recording> read(const std::filesystem::path& file, const ReadOptions& options);

/// The contents of the file under its own names, whether or not they are recognised as channels.
/// @param options  only `trial` and `arm` are used
/// @fails  data: the file is damaged.
[[nodiscard]] Result<FileContents> list_contents(const RecordingFile& file, const ReadOptions& options = {});

/// The same with all numbers unchanged: for copying a file in which nothing is recognised.
/// @param options  as of list_contents
/// @fails  as list_contents
[[nodiscard]] Result<Contents> read_contents(const RecordingFile& file, const ReadOptions& options = {});

/// Reads the numbered parts of one record (log_1.mat, log_2.mat, …, log_10.mat), in the order of their numbers, and
/// joins them. A pause between two parts is kept: inspect reports it as a gap.
/// @fails  usage: no parts, or a name without a number at its end. data: names of different records; a missing or
/// repeated number; different channels or units; time that is not continuous across parts.
[[nodiscard]] Result<Recording> read_parts(std::vector<std::filesystem::path> parts, const ReadOptions& options);

}  // namespace mbk::recording
