#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/model/robot/workspace.h"
#include "mbk/model/trial/file_contents.h"
#include "mbk/model/trial/findings.h"
#include "mbk/model/trial/identification.h"
#include "mbk/model/trial/inspection.h"
#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/passivity.h"
#include "mbk/model/trial/recording.h"
#include "mbk/model/trial/summary.h"
#include "mbk/model/trial/validation_table.h"

namespace mbk::result {

/// Schema "mbk.result/2". SI units; numbers carry every digit; absent = not computed, null = undefined.
[[nodiscard]] std::string to_json(const Measurement& measured);
/// The same without blanks, as a study stores it.
[[nodiscard]] std::string to_compact_json(const Measurement& measured);

/// Schema "mbk.results/1": several results and, where there is one, their summary.
[[nodiscard]] std::string to_json(const std::vector<Measurement>& results, const SeveralTrials& together);

/// Schema "mbk.ellipse/1": the ellipses and antisymmetry of a result, with three axes its ellipsoids and antisymmetry
/// vectors; "mbk.ellipses/1" with `results` for several.
[[nodiscard]] std::string ellipses_json(std::span<const Measurement> measured);

/// What happened in a trial and what the model predicts, in full: `passivity` as in a result, and for each recording
/// the energy over time and part by part.
struct PassivityDocument {
  std::vector<SourceFile> inputs;
  Passivity passivity;
  std::vector<Energy> recordings;
};

/// Schema "mbk.passivity/2"; "mbk.passivities/1" with `results` for several.
[[nodiscard]] std::string to_json(std::span<const PassivityDocument> all);

/// Schema "mbk.info/1": what is in a recording; "mbk.infos/1" with `results` for several.
[[nodiscard]] std::string to_json(const std::vector<Recording>& recordings, const std::vector<Inspection>& inspections);

/// Schema "mbk.contents/1": what a file holds where nothing in it is recognised as a recording, and why.
[[nodiscard]] std::string to_json(const FileContents& contents, const Error& unrecognised);

/// Schema "mbk.validation/2": a study against known truth. A row that is informative has null for `expected` and `met`.
[[nodiscard]] std::string to_json(const ValidationTable& table);

/// Schema "mbk.workspace/1": where the hand can be, and the robot at one place where one is given. Metres, except that
/// angles are in degrees and say so.
[[nodiscard]] std::string to_json(const robot::Workspace& workspace, const std::optional<robot::Posture>& posture);

/// Reads back what `to_json` wrote, schema mbk.result/2, mbk.result/1 or mbk.results/1: model, covariance (from the
/// standard errors where a file holds no covariance; NaN where it holds neither), fit, warnings, units, notes and
/// inputs; not the preparation: written again, it says nothing of mode and protocol.
/// @fails not JSON (the byte is named); another schema; no result; a matrix of the wrong shape (its name is reported).
[[nodiscard]] Result<std::vector<Identification>> identifications_from_json(std::string_view text);

/// What a stored result says of passivity beside its models.
struct StoredPassivity {
  std::optional<PassivityBand> band;    ///< in which the data show how the limb answers
  std::optional<PassivityBand> judged;  ///< in which its models were judged
  std::optional<EnergyAccount> energy;  ///< of the trial; its verdict is made of the interval anew
  std::vector<EnergyLine> lines;
  std::optional<Method> predicts;  ///< whose model makes the prediction
};

/// A result with all that a statement on its passivity needs.
struct StoredResult {
  Identification identification;
  std::optional<Identification> alternative;  ///< covariance from the standard errors in schema mbk.result/1
  StoredPassivity passivity;
};

/// @fails as identifications_from_json
[[nodiscard]] Result<std::vector<StoredResult>> results_from_json(std::string_view text);

}  // namespace mbk::result
