#include "thesis/source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>

namespace mbk::thesis {
namespace {

using Json = nlohmann::ordered_json;

/// "4.0" is 4 ± 0.05; what is no number keeps its words.
PrintedNumber number_of(const std::string& text) {
  PrintedNumber number{text, std::numeric_limits<double>::quiet_NaN(), 0.0};
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != '\0') return number;
  const auto point = text.find('.');
  const auto decimals = point == std::string::npos ? 0.0 : static_cast<double>(text.size() - point - 1);
  number.value = value;
  number.rounding = 0.5 * std::pow(10.0, -decimals);
  return number;
}

PrintedTable table_of(const Json& json) {
  PrintedTable table;
  table.columns = json.at("columns").get<std::vector<std::string>>();
  for (const auto& [name, cells] : json.at("rows").items()) {
    std::vector<PrintedNumber>& row = table.rows[name];
    for (const Json& cell : cells) row.push_back(number_of(cell.get<std::string>()));
    if (row.size() != table.columns.size()) throw std::invalid_argument(fmt::format("row '{}' is too short", name));
  }
  return table;
}

std::vector<PrintedArm> arms_of(const Json& json) {
  const PrintedTable table = table_of(json);
  std::vector<PrintedArm> arms;
  for (const auto& [name, cells] : table.rows) {
    PrintedArm arm{name, {}};
    for (std::size_t k = 0; k < 3; ++k) arm.ellipses[k] = {cells.at(3 * k), cells.at(3 * k + 1), cells.at(3 * k + 2)};
    arms.push_back(std::move(arm));
  }
  return arms;
}

/// The first `count` columns of the theoretical table, and both methods' errors.
std::vector<PrintedRig> rigs_of(const Json& theoretical, const Json& errors, std::ptrdiff_t count) {
  const PrintedTable left = table_of(theoretical), right = table_of(errors);
  std::vector<PrintedRig> rigs;
  for (const auto& [name, cells] : left.rows) {
    const std::vector<PrintedNumber>& both = right.rows.at(name);
    rigs.push_back({name,
                    {cells.begin(), cells.begin() + count},
                    {both.begin(), both.begin() + count},
                    {both.begin() + count, both.begin() + 2 * count}});
  }
  return rigs;
}

/// Whether a printed number is among those that ours is computed from: it is given by the same name.
bool is_given(const Given& given, const std::string& id, const std::string& row, const std::string& column,
              const PrintedNumber& printed) {
  const auto table = given.tables.find(id);
  const PrintedNumber* const number = table == given.tables.end() ? nullptr : table->second.find(row, column);
  return number != nullptr && number->text == printed.text;
}

Agreement agreement_of(const ReproducedCell& cell, const ReproducedTable& table, bool given) {
  if (table.provenance != Provenance::recomputed || !cell.ours || !cell.printed_value) return Agreement::not_compared;
  // What is exactly on the border of the rounding was rounded one way or the other.
  const double tiny = 1e-9 * (1.0 + std::abs(*cell.printed_value));
  const auto [low, high] = cell.range.value_or(std::pair{*cell.ours, *cell.ours});
  const bool reached =
      low <= *cell.printed_value + cell.rounding + tiny && high >= *cell.printed_value - cell.rounding - tiny;
  if (reached) return given ? Agreement::round_trip : Agreement::within_rounding;
  return table.erratum.empty() ? Agreement::differs : Agreement::erratum;
}

}  // namespace

const PrintedNumber* PrintedTable::find(const std::string& row, const std::string& column) const {
  const auto found = rows.find(row);
  const auto at = std::ranges::find(columns, column);
  if (found == rows.end() || at == columns.end()) return nullptr;
  return &found->second[static_cast<std::size_t>(at - columns.begin())];
}

double Given::number(const std::string& table, const std::string& row) const {
  const auto found = tables.find(table);
  const PrintedNumber* const number = found == tables.end() ? nullptr : found->second.find(row, "value");
  return number == nullptr ? std::numeric_limits<double>::quiet_NaN() : number->value;
}

Result<Source> read_source(std::string_view text) {
  try {
    const Json json = Json::parse(text);
    const Json& given = json.at("given");
    Source source;
    source.name = json.at("source").get<std::string>();
    source.given = {arms_of(given.at("3.3")),
                    arms_of(given.at("3.5")),
                    rigs_of(given.at("5.1 stiffness"), given.at("5.4 stiffness"), 3),
                    rigs_of(given.at("5.1 mass"), given.at("5.4 mass"), 1),
                    {}};
    for (const auto& [id, table] : given.items()) source.given.tables[id] = table_of(table);
    if (json.contains("printed")) {
      for (const auto& [id, table] : json.at("printed").items()) source.printed[id] = table_of(table);
    }
    return source;
  } catch (const std::exception& error) {
    return bad_data(error.what(), "", "the numbers of the source");
  }
}

void compare(const Source& source, Exhibit& exhibit) {
  for (ReproducedTable& table : exhibit.tables) {
    const auto found = source.printed.find(table.id);
    if (found == source.printed.end()) continue;
    for (ReproducedRow& row : table.rows) {
      for (std::size_t k = 0; k < row.cells.size(); ++k) {
        const PrintedNumber* printed = found->second.find(row.name, table.columns[k].name);
        if (printed == nullptr) continue;
        ReproducedCell& cell = row.cells[k];
        cell.printed = printed->text;
        if (std::isfinite(printed->value)) cell.printed_value = printed->value;
        cell.rounding = printed->rounding;
        cell.agreement =
            agreement_of(cell, table, is_given(source.given, table.id, row.name, table.columns[k].name, *printed));
      }
    }
  }
}

}  // namespace mbk::thesis
