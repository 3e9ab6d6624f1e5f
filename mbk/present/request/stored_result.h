#pragma once

#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/base/core/units.h"
#include "mbk/model/trial/measurement.h"
#include "mbk/model/trial/passivity.h"
#include "mbk/present/result/json.h"

namespace mbk::request {

/// A band that an option asks for.
using AskedBand = std::optional<std::pair<Hertz, Hertz>>;

/// All results of a file that `measure --json` wrote.
/// @fails  as read_text and results_from_json, with the file
[[nodiscard]] Result<std::vector<result::StoredResult>> stored_results(const std::filesystem::path& file);

/// Both statements from what a result holds: its models, and the energy that it was written with.
/// @fails  usage: no band is asked for, and the result holds neither one in which its models were judged nor energy.
[[nodiscard]] Result<Passivity> passivity_of(const result::StoredResult& stored, const AskedBand& asked);

/// As `measure` made it, as far as it was stored.   @fails  as passivity_of and analyse::add_ellipses
[[nodiscard]] Result<Measurement> restored(result::StoredResult stored);

}  // namespace mbk::request
