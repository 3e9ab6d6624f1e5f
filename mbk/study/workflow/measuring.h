#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "mbk/base/core/option_table.h"
#include "mbk/base/core/result.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/model/trial/recording.h"
#include "mbk/present/request/measure_request.h"
#include "mbk/study/store/store.h"

/// From a study's recordings to its results.
namespace mbk::workflow {

/// The options that say how one recording is measured, in the order of --help.
[[nodiscard]] const OptionTable<request::MeasureRequest>& measuring_table();

/// Options as a study stores them: a JSON object, sorted by name.
[[nodiscard]] std::string options_to_json(const OptionTexts& given);
/// @fails  data: not such a document.
[[nodiscard]] Result<OptionTexts> options_from_json(const std::string& text);

/// One way of measuring.
struct Measuring {
  request::MeasureRequest request;
  measurement::Options options;
  std::string key;  ///< `options_to_json` without what says a default, with numbers in one way of writing and hashes of
                    ///< files in place of their names: what a result depends on
};

/// @fails  usage: options that are none or do not belong together; a file that one of them names cannot be read.
[[nodiscard]] Result<std::shared_ptr<const Measuring>> measuring_of(const OptionTexts& given);

/// The key under which results of this version stand in the study: `key`, or one of before that says the same with
/// defaults beside it.
[[nodiscard]] Result<std::string> key_in(const store::Store& study, const Measuring& measuring);

/// Whether options name files, which a study does not keep; their key then holds hashes, so that the options cannot be
/// had back from it.
[[nodiscard]] bool names_files(const OptionTexts& given);

/// The options that a study stores.
[[nodiscard]] Result<OptionTexts> default_options(const store::Store& study);

/// The end of the name of a copy in HDF5 that `Adder` made of a file.
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

}  // namespace mbk::workflow
