#pragma once

#include <string>

#include "mbk/model/trial/reproduction.h"

namespace mbk::result {

/// Schema "mbk.reproduction/1": every exhibit with its tables, cell by cell, and the numbers of its charts.
[[nodiscard]] std::string to_json(const Reproduction& reproduction);

/// Schema "mbk.reproduced_table/1": one table of it.
[[nodiscard]] std::string to_json(const Exhibit& exhibit, const ReproducedTable& table);

/// The same table as CSV: a row for each cell, with its row, column, unit, the printed number, ours, their difference,
/// what ours is spread by or may be by rounding, and how both stand to each other.
[[nodiscard]] std::string to_csv(const ReproducedTable& table);

}  // namespace mbk::result
