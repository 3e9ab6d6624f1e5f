#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/words.h"

/// A study: many recordings of many people, what was measured on them, and who did what to it.
namespace mbk::store {

/// Who does something to a study. Never a name.
enum class Role { analyst, experimenter, investigator, data_manager, monitor };

[[nodiscard]] constexpr auto word_table(Role) {
  using enum Role;
  return std::to_array<Word<Role>>({{analyst, "analyst"},
                                    {experimenter, "experimenter"},
                                    {investigator, "investigator"},
                                    {data_manager, "data-manager"},
                                    {monitor, "monitor"}});
}

/// What a line of the log says was done.
enum class LoggedAction { init, defaults, add, measure, exclude, include, forget, erase };

[[nodiscard]] constexpr auto word_table(LoggedAction) {
  using enum LoggedAction;
  return std::to_array<Word<LoggedAction>>({{init, "init"},
                                            {defaults, "defaults"},
                                            {add, "add"},
                                            {measure, "measure"},
                                            {exclude, "exclude"},
                                            {include, "include"},
                                            {forget, "forget"},
                                            {erase, "erase"}});
}

/// Facts about a study as a whole.
struct StudyFacts {
  std::string title;           ///< may be empty
  std::string options = "{}";  ///< how its recordings are measured unless asked otherwise, as a JSON object
};

/// Whose trial a recording is.
struct TrialFacts {
  std::int64_t participant = 0;  ///< > 0
  std::int64_t session = 1;      ///< > 0
  std::string condition;         ///< "relaxed"; may be empty
  /// > 0; absent: the next one of this participant, session, condition and rater
  std::optional<std::int64_t> trial;
  std::string rater = {};  ///< who measured, as rater_code() writes it; "": not recorded
};

/// A recording to be stored: one of those that a file holds.
struct NewRecording {
  std::int64_t part = 0;  ///< which one of the file, from 1; 0: its only one
  TrialFacts trial;
  double duration_s = 0.0;
  std::string excluded_why = {};  ///< by whoever recorded it; "": it counts
};

/// A recording of a study.
struct StoredRecording {
  std::int64_t number = 0;  ///< its name in this study; never given twice
  std::string sha256;       ///< of the stored file
  std::int64_t part = 0;    ///< as in NewRecording
  std::string extension;    ///< of the stored file, with its dot; may be empty
  std::int64_t bytes = 0;
  std::int64_t participant = 0, session = 0, trial = 0;
  std::string condition;
  double duration_s = 0.0;
  std::string added;                        ///< UTC: "2026-05-04T09:30:12Z"
  std::string origin_sha256;                ///< of the file that the stored one was made of; equal where it is a copy
  std::optional<std::string> excluded_why;  ///< present where it is excluded
  std::string rater;                        ///< a code; "": not recorded
};

/// One way of measuring: results that may be compared.
struct Analysis {
  std::int64_t number = 0;
  std::string options_sha256, options;  ///< a JSON object: the options that were given, by name
  std::string version;                  ///< of mbk
};

/// What is to be measured: a recording, by what it is and not by when it came.
struct Unit {
  std::string sha256;
  std::int64_t part = 0;
  std::string file;  ///< below the study's folder: "recordings/ab/ab12….h5"

  [[nodiscard]] friend bool operator<(const Unit& one, const Unit& other) {
    return one.sha256 != other.sha256 ? one.sha256 < other.sha256 : one.part < other.part;
  }
};

/// What measuring a unit gave. It depends on the file, the options and the version alone.
struct UnitResult {
  std::string document;  ///< a result as JSON (mbk.result/2); empty where it could not be measured
  bool usable = false;
  std::string reason;  ///< why it is not usable, or could not be measured; empty where it is
};

/// One number of a result.
struct Outcome {
  std::string name;  ///< "K_xx", "stiffness_area", …
  double value = 0.0;
  std::optional<double> standard_error;
  std::string unit;  ///< "" for a ratio

  [[nodiscard]] friend bool operator==(const Outcome&, const Outcome&) = default;
};

/// A result beside its numbers.
struct StoredResult {
  std::int64_t number = 0, recording = 0, analysis = 0;
  bool usable = false, failed = false;  ///< failed: there is no document
  std::string reason;
};

/// Whose a usable result is.
struct TrialRow {
  std::int64_t recording = 0, participant = 0, session = 0, trial = 0;
  int condition = 0;  ///< index into OutcomeColumns::conditions
  int rater = -1;     ///< index into OutcomeColumns::raters; −1: not recorded
};

/// One outcome of every trial.
struct OutcomeColumn {
  std::string name, unit;
  std::vector<double> values;           ///< as long as OutcomeColumns::trials; NaN: the trial has none
  std::vector<double> standard_errors;  ///< the same; NaN: it is not known. Empty: of no trial
};

/// Every usable number of one analysis, a column for each outcome: what statistics are computed from.
struct OutcomeColumns {
  std::vector<std::string> conditions;  ///< in the order of the recordings' numbers
  std::vector<TrialRow> trials;         ///< by participant, session, trial and recording
  std::vector<OutcomeColumn> outcomes;
  std::vector<std::string> raters = {};  ///< codes, sorted; empty where no rater is recorded
};

/// A line of the log.
struct LogLine {
  std::int64_t number = 0;  ///< from 1, without gaps
  std::string time;         ///< UTC
  Role role = Role::analyst;
  LoggedAction action = LoggedAction::init;
  std::optional<std::int64_t> recording, analysis, participant;
  std::string digest;  ///< SHA-256 of what was stored, with a salt that goes when it is forgotten; "" where nothing was
  std::string why;
  std::string hash;  ///< SHA-256 over this line and the hash of the one before
};

}  // namespace mbk::store
