#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/study/store/store.h"
#include "mbk/study/store/trial_names.h"
#include "mbk/study/workflow/measuring.h"

namespace mbk::workflow {

/// How recordings are added.
struct AddOptions {
  bool strip = false;  ///< what may identify a person is left out of the stored copy; otherwise such a file is refused
  store::Role role = store::Role::analyst;
  std::function<void(const std::string& note)> note = [](const std::string&) {};     ///< what was left out
  std::function<void(const std::string& warning)> warn = [](const std::string&) {};  ///< what the user must know
};

/// Puts files into a study, one by one.
class Adder {
 public:
  /// @param study  outlives this    @param measuring  the study's default options, which say how files are read
  Adder(store::Store& study, std::shared_ptr<const Measuring> measuring, AddOptions options)
      : study_(study), measuring_(std::move(measuring)), options_(std::move(options)) {}

  /// @param facts  whose trial it is, as far as that was said; what is missing is taken from the recording's metadata
  /// @fails  as RecordingReader::read and Store::add; data: the person has withdrawn; metadata that may identify a
  /// person, where `strip` is not asked for; nobody says whose it is.
  [[nodiscard]] Result<std::vector<store::AddedRecording>> add(const std::filesystem::path& file,
                                                               const store::KnownFacts& facts);

 private:
  class File;
  store::Store& study_;
  std::shared_ptr<const Measuring> measuring_;
  AddOptions options_;
};

/// The recordings of a BIDS data set, by their names.
/// @fails  data: there is none; two are one trial; as store::facts_of_bids.
[[nodiscard]] Result<std::vector<store::SheetRow>> rows_of_bids(const std::filesystem::path& folder);

/// What files are to be imported, and what could not be told of some.
struct ImportRows {
  std::vector<store::SheetRow> rows;
  std::vector<Error> failed;
};

/// Files, or the folders of BIDS data sets, as rows with what their names say.
/// @param pattern  as NamePattern::of; "": names say nothing
/// @fails  as NamePattern::of and rows_of_bids
[[nodiscard]] Result<ImportRows> rows_of_files(const std::vector<std::filesystem::path>& files,
                                               const std::string& pattern);

}  // namespace mbk::workflow
