#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/present/result/reproduction_json.h"
#include "tests/support/schemas.h"
#include "thesis/reproduce.h"

/// Exhibits as tests look at them.
namespace mbk::thesis {

inline Source the_source() {
  auto source = read_source(source_text());
  EXPECT_TRUE(source) << source.error().line();
  return *source;
}

inline Reproduction made(const std::vector<std::string>& only, unsigned threads = 0, bool printed = true) {
  Source source = the_source();
  if (!printed) source.printed.clear();
  ReproduceOptions options;
  options.only = only;
  options.threads = threads;
  auto reproduction = reproduce(source, options);
  EXPECT_TRUE(reproduction) << reproduction.error().line();
  EXPECT_TRUE(schemas::fits_its_schema(result::to_json(*reproduction)));
  for (const Exhibit& exhibit : reproduction->exhibits) {
    for (const ReproducedTable& table : exhibit.tables) {
      EXPECT_TRUE(schemas::fits_its_schema(result::to_json(exhibit, table)));
    }
  }
  return *reproduction;
}

inline const Exhibit& exhibit_of(const Reproduction& reproduction, std::string_view id) {
  for (const Exhibit& exhibit : reproduction.exhibits) {
    if (exhibit.id == id) return exhibit;
  }
  ADD_FAILURE() << "no exhibit " << id;
  return reproduction.exhibits.front();
}

inline const ReproducedTable& table_of(const Exhibit& exhibit, std::string_view id) {
  for (const ReproducedTable& table : exhibit.tables) {
    if (table.id == id) return table;
  }
  ADD_FAILURE() << exhibit.id << " has no table " << id;
  return exhibit.tables.front();
}

inline const ReproducedCell& cell_of(const ReproducedTable& table, std::string_view row, std::string_view column) {
  for (const ReproducedRow& one : table.rows) {
    for (std::size_t k = 0; k < table.columns.size(); ++k) {
      if (one.name == row && table.columns[k].name == column) return one.cells.at(k);
    }
  }
  ADD_FAILURE() << table.id << " has no cell " << row << ", " << column;
  return table.rows.front().cells.front();
}

inline double value_of(const ReproducedTable& table, std::string_view row, std::string_view column) {
  return cell_of(table, row, column).ours.value_or(NAN);
}

/// Every cell that the source prints stands beside one of ours that is a number.
inline void expect_all_found(const Exhibit& exhibit, std::string_view id) {
  const Source source = the_source();
  const PrintedTable& printed = source.printed.at(std::string(id));
  const ReproducedTable& ours = table_of(exhibit, id);
  for (const auto& [row, cells] : printed.rows) {
    for (std::size_t k = 0; k < cells.size(); ++k) {
      const ReproducedCell& cell = cell_of(ours, row, printed.columns[k]);
      EXPECT_EQ(cell.printed, cells[k].text) << row << ", " << printed.columns[k];
      EXPECT_TRUE(cell.ours && std::isfinite(*cell.ours)) << row << ", " << printed.columns[k];
      EXPECT_EQ(cell.agreement, Agreement::not_compared);  // simulated
    }
  }
}

inline void expect_charts(const Exhibit& exhibit, std::size_t count) {
  EXPECT_EQ(exhibit.charts.size(), count);
  constexpr std::size_t kPoints = 600;
  for (const Chart& chart : exhibit.charts) {
    EXPECT_FALSE(chart.x.unit.empty()) << chart.title;
    EXPECT_FALSE(chart.y.unit.empty()) << chart.title;
    for (const ChartSeries& series : chart.series) {
      EXPECT_EQ(series.x.size(), series.y.size()) << series.name;
      EXPECT_GT(series.x.size(), 0u) << series.name;
      EXPECT_LE(series.x.size(), kPoints) << series.name;
    }
  }
}

inline constexpr const char* kElements[] = {"k_xx", "k_yy", "k_s"};

}  // namespace mbk::thesis
