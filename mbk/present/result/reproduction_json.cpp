#include "mbk/present/result/reproduction_json.h"

#include "mbk/base/core/table_text.h"
#include "mbk/present/result/json_parts.h"

namespace mbk::result {
namespace {

Json optional(const std::optional<double>& value) {
  return value ? number(*value) : Json(nullptr);
}

Json cell_json(const ReproducedCell& cell) {
  Json json = {{"printed", cell.printed.empty() ? Json(nullptr) : Json(cell.printed)},
               {"printed_value", optional(cell.printed_value)},
               {"rounding", cell.rounding},
               {"ours", cell.words.empty() ? optional(cell.ours) : Json(cell.words)},
               {"difference", optional(cell.difference())},
               {"spread", optional(cell.spread)},
               {"range", cell.range ? interval(*cell.range) : Json(nullptr)},
               {"agreement", word_of(cell.agreement)}};
  if (const auto was = former_word_of(cell.agreement); !was.empty()) json["was"] = was;
  return json;
}

Json table_json(const ReproducedTable& table) {
  Json json = {{"id", table.id},
               {"title", table.title},
               {"provenance", word_of(table.provenance)},
               {"what_rows_are", table.what_rows_are},
               {"spread_is", table.spread_is},
               {"erratum", table.erratum.empty() ? Json(nullptr) : Json(table.erratum)},
               {"slip", table.erratum.empty() ? Json(nullptr) : Json(table.erratum)},
               {"columns", Json::array()},
               {"rows", Json::array()}};
  for (const ReproducedColumn& column : table.columns) {
    json["columns"].push_back({{"name", column.name}, {"unit", column.unit}, {"decimals", column.decimals}});
  }
  for (const ReproducedRow& row : table.rows) {
    Json cells = Json::array();
    for (const ReproducedCell& cell : row.cells) cells.push_back(cell_json(cell));
    json["rows"].push_back({{"name", row.name}, {"cells", std::move(cells)}});
  }
  return json;
}

Json axis_json(const ChartAxis& axis) {
  return {{"label", axis.label}, {"unit", axis.unit}, {"logarithmic", axis.logarithmic}};
}

Json rounded_list(const std::vector<double>& values) {
  Json array = Json::array();
  for (const double value : values) array.push_back(rounded(value, kDigits));
  return array;
}

Json exhibit_chart_json(const Chart& chart) {
  Json json = {{"title", chart.title},
               {"x", axis_json(chart.x)},
               {"y", axis_json(chart.y)},
               {"equal_scale", chart.equal_scale || chart.identity},
               {"identity", chart.identity},
               {"horizontal", references_json(chart.horizontal)},
               {"vertical", references_json(chart.vertical)},
               {"notes", chart.notes},
               {"series", Json::array()}};
  for (const ChartSeries& series : chart.series) {
    Json one = {{"name", series.name},
                {"drawn", word_of(series.drawn)},
                {"x", rounded_list(series.x)},
                {"y", rounded_list(series.y)},
                {"intervals", Json::array()}};
    for (const auto& [low, high] : series.intervals) {
      one["intervals"].push_back(Json::array({rounded(low, kDigits), rounded(high, kDigits)}));
    }
    json["series"].push_back(std::move(one));
  }
  return json;
}

/// With every digit; empty where there is none.
std::string field(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? fmt::format("{}", *value) : "";
}

}  // namespace

std::string to_json(const Reproduction& reproduction) {
  Json json = header("mbk.reproduction/2");
  json["source"] = reproduction.source;
  json["agreement"] = Json::object();
  for (const auto& [agreement, word] : word_table(Agreement())) {
    json["agreement"][std::string(word)] = reproduction.count(agreement);
  }
  json["agreement"]["slip"] = reproduction.count(Agreement::erratum);
  json["exhibits"] = Json::array();
  for (const Exhibit& exhibit : reproduction.exhibits) {
    Json one = {{"id", exhibit.id},
                {"kind", word_of(exhibit.kind)},
                {"chapter", exhibit.chapter},
                {"title", exhibit.title},
                {"provenance", word_of(exhibit.provenance)},
                {"text", exhibit.text},
                {"commands", exhibit.commands},
                {"related", exhibit.related},
                {"tables", Json::array()},
                {"charts", Json::array()}};
    if (exhibit.kind == Exhibit::Kind::erratum && exhibit.id.starts_with("erratum-")) {
      one["was"] = "slip" + exhibit.id.substr(std::string_view("erratum").size());
    }
    for (const ReproducedTable& table : exhibit.tables) one["tables"].push_back(table_json(table));
    for (const Chart& chart : exhibit.charts) one["charts"].push_back(exhibit_chart_json(chart));
    json["exhibits"].push_back(std::move(one));
  }
  return dumped(json);
}

std::string to_json(const Exhibit& exhibit, const ReproducedTable& table) {
  Json json = header("mbk.reproduced_table/2");
  json["exhibit"] = exhibit.id;
  json.update(table_json(table));
  return dumped(json);
}

std::string to_csv(const ReproducedTable& table) {
  std::string csv = "row,column,unit,printed,ours,difference,spread,range_low,range_high,agreement\n";
  for (const ReproducedRow& row : table.rows) {
    for (std::size_t k = 0; k < row.cells.size(); ++k) {
      const ReproducedCell& cell = row.cells[k];
      const auto low = cell.range ? std::optional(cell.range->first) : std::nullopt;
      const auto high = cell.range ? std::optional(cell.range->second) : std::nullopt;
      csv += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", csv_field(row.name), csv_field(table.columns[k].name),
                         csv_field(table.columns[k].unit), csv_field(cell.printed),
                         cell.words.empty() ? field(cell.ours) : csv_field(cell.words), field(cell.difference()),
                         field(cell.spread), field(low), field(high), word_of(cell.agreement));
    }
  }
  return csv;
}

}  // namespace mbk::result
