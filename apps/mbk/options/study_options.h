#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/measure_options.h"
#include "apps/mbk/terminal/command.h"
#include "mbk/study/store/store.h"

/// What the commands of `mbk study` share.
namespace mbk::app {

/// Which study, and who asks.
struct StudyArguments {
  std::optional<std::filesystem::path> folder;
  store::Role role = store::Role::analyst;
};

/// Adds --study.
void add_study_option(Command command, StudyArguments& arguments);
/// Adds --role.
void add_choice_of_role(Command command, StudyArguments& arguments);
/// Adds --study and --role, for commands that the log tells of.
void add_study_and_role(Command command, StudyArguments& arguments);

/// The study of --study, or the one that the current folder is in.
[[nodiscard]] Result<store::Store> open_study(const StudyArguments& arguments);

/// Options of measuring that were given, by their names; a flag has no values.
using GivenOptions = std::map<std::string, std::vector<std::string>>;

/// What the options of measuring set.
struct MeasuringArguments : MeasureArguments {
  AnalyseArguments analyse;
};

/// Adds the options of `mbk measure` that say how one recording is measured, and --threads.
void add_measuring_options(Command command, MeasuringArguments& arguments);

/// Those of them that were given to `command`.
[[nodiscard]] GivenOptions given_options(Command command);

/// As they are stored: a JSON object, sorted by name.
[[nodiscard]] std::string options_to_json(const GivenOptions& given);
[[nodiscard]] Result<GivenOptions> options_from_json(const std::string& text);
/// As they are typed: "--cutoff 5 --mode reference"; "" where none is given.
[[nodiscard]] std::string options_text(const GivenOptions& given);

/// One way of measuring.
struct Measuring {
  MeasuringArguments arguments;
  measurement::Options options;
  std::string key;  ///< `options_to_json` without what says a default, with numbers in one way of writing and hashes of
                    ///< files in place of their names: what a result depends on
};

/// @fails  usage: options that are none or do not belong together; a file that one of them names cannot be read.
[[nodiscard]] Result<std::shared_ptr<const Measuring>> measuring_of(const GivenOptions& given);

/// The key under which results of this version stand in the study: `key`, or one of before that says the same with
/// defaults beside it.
[[nodiscard]] Result<std::string> key_in(const store::Store& study, const Measuring& measuring);

/// Whether a key names files by their hashes, so that the options cannot be had back from it.
[[nodiscard]] bool names_files(const GivenOptions& key);

/// The options that a study stores.
[[nodiscard]] Result<GivenOptions> default_options(const store::Store& study);

/// The end of the name of a copy in HDF5 that 'add' made of a file.
inline constexpr const char* kCopyExtension = ".read.h5";

enum class Reading { whole, perturbation };

/// A recording of a study. Options that say how a file is read do not hold for copies, in which they were applied.
/// @param part  as store::Unit has it    @fails  as RecordingReader::read
[[nodiscard]] Result<Recording> read_stored(const Measuring& measuring, const std::filesystem::path& file,
                                            std::int64_t part, Reading what);

/// The result of a unit; it depends on the unit, the options and the version alone, and may be asked for from several
/// threads at once.
/// @fails  data: the file is gone or is no longer what was added. What is wrong with a recording itself is a result.
[[nodiscard]] Result<store::UnitResult> measure_unit(const Measuring& measuring, const std::filesystem::path& folder,
                                                     const store::Unit& unit);

/// "3 recordings", "1 recording".
[[nodiscard]] std::string counted(std::int64_t n, const char* one, const char* more);

}  // namespace mbk::app
