#include "mbk/present/result/reproduction_json.h"

#include <fmt/format.h>

#include <cmath>

#include "mbk/base/core/table_text.h"
#include "mbk/present/result/described.h"
#include "mbk/present/result/schemas.h"

namespace mbk {
namespace {

using document::Fields;
using document::Json;
using document::kDigits;
using document::through;

/// The text, or null where it is empty.
template <class T>
auto or_null(std::string T::*text) {
  return [text](const T& from) { return (from.*text).empty() ? std::nullopt : std::optional(from.*text); };
}

Vector vector(const std::vector<double>& values) {
  return Eigen::Map<const Vector>(values.data(), std::ssize(values));
}

}  // namespace

void describe(Fields<ReproducedCell>& fields) {
  using From = const ReproducedCell&;
  fields.type("Cell");
  fields.add_or_null("printed", or_null(&ReproducedCell::printed), "as printed");
  fields.add_or_null("printed_value", &ReproducedCell::printed_value);
  fields.add("rounding", &ReproducedCell::rounding, "half a unit of the last printed digit");
  fields.add_as(
      "ours", {{"type", {"number", "string", "null"}}},
      [](From cell) { return cell.words.empty() ? document::written(cell.ours) : Json(cell.words); },
      "a number, or text, or null if not available");
  fields.add_or_null("difference", &ReproducedCell::difference, "ours minus printed");
  fields.add_or_null("spread", &ReproducedCell::spread);
  fields.add_or_null("range", &ReproducedCell::range, "range of ours due to the rounding of the inputs");
  fields.add("agreement", &ReproducedCell::agreement, "round trip: ours was computed from the printed number itself");
  fields.add_unless_empty(
      "was", [](From cell) { return former_word_of(cell.agreement); },
      "name of this agreement in schema 1 if it changed; for one version");
}

void describe(Fields<ReproducedColumn>& fields) {
  fields.type("Column");
  fields.add("name", &ReproducedColumn::name);
  fields.add("unit", &ReproducedColumn::unit);
  fields.add("decimals", &ReproducedColumn::decimals);
}

void describe(Fields<ReproducedRow>& fields) {
  fields.type("TableRow");
  fields.add("name", &ReproducedRow::name);
  fields.add("cells", &ReproducedRow::cells, "one for each column");
}

void describe(Fields<ReproducedTable>& fields) {
  fields.type("Table");
  fields.add("id", &ReproducedTable::id, "\"3.6\"");
  fields.add("title", &ReproducedTable::title);
  fields.add("provenance", &ReproducedTable::provenance);
  fields.add("what_rows_are", &ReproducedTable::what_rows_are);
  fields.add("spread_is", &ReproducedTable::spread_is, "empty: no cell has one");
  fields.add_or_null("erratum", or_null(&ReproducedTable::erratum),
                     "id of the erratum that explains cells that differ");
  fields.add_or_null("slip", or_null(&ReproducedTable::erratum), "the same, by its old name, for one version");
  fields.add("columns", &ReproducedTable::columns);
  fields.add("rows", &ReproducedTable::rows);
}

namespace result {
namespace {

// Charts as a reproduction holds them: whole, where a validation leaves out what is not used.
struct ExhibitAxis {
  const ChartAxis* axis;
};

struct ExhibitSeries {
  const ChartSeries* series;
};

struct ExhibitChart {
  const Chart* chart;
};

/// A view of each.
template <class View, class T>
std::vector<View> each(const std::vector<T>& all) {
  std::vector<View> views;
  for (const T& one : all) views.push_back({&one});
  return views;
}

void describe(Fields<ExhibitAxis>& fields) {
  fields.type("Axis");
  fields.add("label", through(&ExhibitAxis::axis, &ChartAxis::label));
  fields.add("unit", through(&ExhibitAxis::axis, &ChartAxis::unit));
  fields.add("logarithmic", through(&ExhibitAxis::axis, &ChartAxis::logarithmic));
}

void describe(Fields<ExhibitSeries>& fields) {
  using From = const ExhibitSeries&;
  fields.type("ChartSeries");
  fields.add("name", through(&ExhibitSeries::series, &ChartSeries::name));
  fields.add("drawn", through(&ExhibitSeries::series, &ChartSeries::drawn));
  fields.add_rounded(
      "x", [](From one) { return vector(one.series->x); }, kDigits);
  fields.add_rounded(
      "y", [](From one) { return vector(one.series->y); }, kDigits);
  fields.add_form<std::vector<std::pair<double, double>>>(
      "intervals",
      [](From one) {
        Json all = Json::array();
        for (const auto& [low, high] : one.series->intervals) {
          all.push_back({document::rounded(low, kDigits), document::rounded(high, kDigits)});
        }
        return all;
      },
      "of y; none, or one for each point");
}

void describe(Fields<ExhibitChart>& fields) {
  using From = const ExhibitChart&;
  fields.type("Chart");
  fields.add("title", through(&ExhibitChart::chart, &Chart::title));
  fields.add("x", [](From one) { return ExhibitAxis{&one.chart->x}; });
  fields.add("y", [](From one) { return ExhibitAxis{&one.chart->y}; });
  fields.add("equal_scale", [](From one) { return one.chart->equal_scale || one.chart->identity; });
  fields.add("identity", through(&ExhibitChart::chart, &Chart::identity), "identity line");
  fields.add("horizontal", through(&ExhibitChart::chart, &Chart::horizontal));
  fields.add("vertical", through(&ExhibitChart::chart, &Chart::vertical));
  fields.add("notes", through(&ExhibitChart::chart, &Chart::notes));
  fields.add("series", [](From one) { return each<ExhibitSeries>(one.chart->series); });
}

struct TableDocument {
  const Exhibit& exhibit;
  const ReproducedTable& table;
};

void describe(Fields<TableDocument>& fields) {
  fields.type("ReproducedTable", "Output of `mbk reproduce --out` for each table.");
  fields.header("mbk.reproduced_table/2");
  fields.add(
      "exhibit", [](const TableDocument& one) { return one.exhibit.id; }, "its id");
  fields.with([](const TableDocument& one) -> const ReproducedTable& { return one.table; });
}

/// With every digit; empty where there is none.
std::string field(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? fmt::format("{}", *value) : "";
}

}  // namespace
}  // namespace result

void describe(Fields<Exhibit>& fields) {
  using From = const Exhibit&;
  fields.type("Exhibit");
  fields.add("id", &Exhibit::id, "\"table-3.6\"");
  fields.add("kind", &Exhibit::kind);
  fields.add("chapter", &Exhibit::chapter, "0: an appendix");
  fields.add("title", &Exhibit::title);
  fields.add("provenance", &Exhibit::provenance);
  fields.add("text", &Exhibit::text, "paragraphs");
  fields.add("commands", &Exhibit::commands, "commands that compute our numbers");
  fields.add("related", &Exhibit::related, "ids of other exhibits");
  fields.add("tables", &Exhibit::tables);
  fields.add("charts", [](From one) { return result::each<result::ExhibitChart>(one.charts); });
  fields.add(
      "was",
      [](From one) -> std::optional<std::string> {
        constexpr std::string_view kErratum = "erratum";
        if (one.kind != Exhibit::Kind::erratum || !one.id.starts_with("erratum-")) return std::nullopt;
        return "slip" + one.id.substr(kErratum.size());
      },
      "its id in schema 1, where it changed; for one version");
}

void describe(Fields<Reproduction>& fields) {
  fields.type("Reproduction",
              "What `mbk reproduce --json` writes: every exhibit with its tables, cell by cell, and the numbers of its "
              "charts.");
  fields.header("mbk.reproduction/2");
  fields.add("source", &Reproduction::source, "what was reproduced");
  fields.group(
      "agreement",
      [](Fields<Reproduction>& part) {
        const auto count = [&part](std::string_view word, Agreement agreement, std::string meaning = "") {
          part.add(
              std::string(word), [agreement](const Reproduction& of) { return of.count(agreement); },
              std::move(meaning));
        };
        for (const auto& [agreement, word] : kWords<Agreement>) count(word, agreement);
        count("slip", Agreement::erratum, "erratum by its old name, for one version");
      },
      "number of printed numbers by agreement with ours; each is counted once");
  fields.add("exhibits", &Reproduction::exhibits);
}

namespace result {
namespace {

struct Page {
  const Reproduction& reproduction;
  const Drawings& drawings;
};

void describe(Fields<Page>& fields) {
  fields.type("ReproductionPage", "Data of the page that `mbk reproduce --out` writes.");
  fields.add("reproduction", [](const Page& page) -> const Reproduction& { return page.reproduction; });
  fields.add(
      "drawings", [](const Page& page) -> const Drawings& { return page.drawings; },
      "one SVG for each chart, by the id of the exhibit");
}

}  // namespace

std::string to_json(const Reproduction& reproduction) {
  return document::document(reproduction);
}

std::string to_json(const Exhibit& exhibit, const ReproducedTable& table) {
  return document::document(TableDocument{exhibit, table});
}

std::string page_json(const Reproduction& reproduction, const Drawings& drawings) {
  return document::compact(document::written(Page{reproduction, drawings}));
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

void add_reproduction_schemas(document::Schemas& schemas) {
  schemas["reproduction"] = document::schema_of<Reproduction>();
  schemas["reproduced_table"] = document::schema_of<TableDocument>();
  schemas["reproduction_page"] = document::schema_of<Page>();
}

}  // namespace result
}  // namespace mbk
