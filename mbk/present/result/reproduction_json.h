#pragma once

#include <map>
#include <string>
#include <vector>

#include "mbk/model/trial/reproduction.h"

namespace mbk::result {

/// Schema "mbk.reproduction/2": every exhibit with its tables, cell by cell, and the numbers of its charts. What schema
/// 1 called a slip is an erratum; for one version the old name stands beside the new one: `slip` of a table and of the
/// counts, `was` of a cell and of an exhibit.
[[nodiscard]] std::string to_json(const Reproduction& reproduction);

/// Schema "mbk.reproduced_table/2": one table of it.
[[nodiscard]] std::string to_json(const Exhibit& exhibit, const ReproducedTable& table);

/// The SVG of each chart, by the id of its exhibit.
using Drawings = std::map<std::string, std::vector<std::string>>;

/// What stands in the page that shows it.
[[nodiscard]] std::string page_json(const Reproduction& reproduction, const Drawings& drawings);

/// The same table as CSV: a row for each cell, with its row, column, unit, the printed number, ours, their difference,
/// what ours is spread by or may be by rounding, and how both stand to each other.
[[nodiscard]] std::string to_csv(const ReproducedTable& table);

}  // namespace mbk::result
