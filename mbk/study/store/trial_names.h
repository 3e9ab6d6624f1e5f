#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/study/store/store_values.h"

/// Whose trial a file is, from its name, from a sheet, from what `mbk run` wrote into it.
namespace mbk::store {

/// What is known of a trial before all of it is.
struct KnownFacts {
  std::optional<std::int64_t> participant, session, trial;
  std::optional<std::string> condition;
  std::optional<std::string> rater;  ///< as rater_code() writes it

  /// What is not known here is as there.
  [[nodiscard]] KnownFacts or_else(const KnownFacts& other) const;

  /// Session 1 and no condition where nobody says otherwise.   @fails  usage: the participant is not known.
  [[nodiscard]] Result<TrialFacts> complete() const;
};

/// The code of a rater: a whole number from 1, a letter, or up to three letters and a number. Letters become capitals,
/// leading zeros go: "r02" → "R2". Nothing for anything else, which may be a name or initials.
[[nodiscard]] std::optional<std::string> rater_code(std::string_view text);

/// What to do about a rater that is not a code.
inline constexpr std::string_view kRaterAdvice = "write a number, a letter or letters and a number: 2, A, R2; no name";

/// A pattern of file names: "p{participant}_s{session}_{condition}_{trial}.h5". {participant}, {session} and {trial}
/// stand for digits, {condition} for letters, digits and -, {rater} for letters and digits that are a code, `*` for
/// anything; all else for itself.
class NamePattern {
 public:
  /// @fails  usage: no {participant}, a placeholder that is none, or one twice.
  [[nodiscard]] static Result<NamePattern> of(const std::string& pattern);

  /// @fails  usage: the name is not of this pattern.
  [[nodiscard]] Result<KnownFacts> match(const std::string& name) const;

 private:
  struct Piece {
    std::string field;  ///< "participant", …, "*"; "" for text that stands for itself
    std::string text;
  };
  [[nodiscard]] bool matches(std::string_view name, std::size_t piece, std::map<std::string, std::string>& found) const;
  std::string pattern_;
  std::vector<Piece> pieces_;
};

/// A row of a sheet: a file and whose trial it is.
struct SheetRow {
  std::filesystem::path file;
  KnownFacts facts;
};

struct Sheet {
  std::vector<SheetRow> rows;
  std::vector<std::string> ignored;  ///< names of columns that are none of a study's
};

/// A CSV sheet with a line of names: file, participant, and where they are there session, condition, trial, rater;
/// separated by commas, semicolons or tabs. Other columns are ignored and nothing of them is kept.
/// @param folder  to which the names of files are relative
/// @fails  data: no such column, a row of another length, a number that is none; the row is named.
[[nodiscard]] Result<Sheet> read_sheet(std::string_view text, const std::filesystem::path& folder);

/// From the name of a recording in a BIDS data set, "sub-07_ses-2_task-reach_acq-fast_run-1": participant 7, session 2,
/// condition "reach-fast", trial 1. An acquisition "raterA" is rater A.
/// @fails  usage: the participant or session has a label that is not a number, and may be a name.
[[nodiscard]] Result<KnownFacts> facts_of_bids(std::string_view name);

/// Letters and digits of a condition, as BIDS wants them in a name: "stiff_100%" → "stiff100". "" → "unnamed".
[[nodiscard]] std::string bids_label(std::string_view condition);

/// Whether that is the label of a condition, or that and a number, since another condition has the same letters and
/// digits: "stiff100x2".
[[nodiscard]] bool is_bids_label(std::string_view label, std::string_view condition);

/// From the metadata of a recording: participant, session, condition, trial, rater.
[[nodiscard]] KnownFacts facts_of(const std::map<std::string, std::string>& metadata);

}  // namespace mbk::store
