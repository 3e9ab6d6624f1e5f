#pragma once

#include <optional>
#include <string>

#include "mbk/trial/findings.h"
#include "mbk/trial/identification.h"
#include "mbk/trial/inspection.h"
#include "mbk/trial/recording.h"
#include "mbk/trial/summary.h"
#include "mbk/trial/validation_table.h"

namespace mbk::report {

/// A result for the terminal: what was measured and how, the model with 95 % intervals and units, the fit, the
/// ellipses with a picture where there are findings, and every warning with what to try.
[[nodiscard]] std::string result_text(const Identification& identification, const std::optional<Findings>& findings);

/// Mean and between-trial standard error of several results.
[[nodiscard]] std::string summary_text(const Summary& summary);

/// The ellipse table and picture alone.
[[nodiscard]] std::string ellipses_text(const Findings& findings);

/// What is in a recording, and what is wrong with it.
[[nodiscard]] std::string info_text(const Recording& recording, const Inspection& inspection);

/// A study against known truth, row by row, with what is wanted.
[[nodiscard]] std::string validation_text(const ValidationTable& table);

}  // namespace mbk::report
