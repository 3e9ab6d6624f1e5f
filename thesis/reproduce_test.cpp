#include "thesis/reproduce.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "mbk/present/result/reproduction_json.h"
#include "thesis/thesis_page.h"

namespace mbk::thesis {
namespace reproduce_test {

using ::testing::HasSubstr;

Source printed() {
  return *read_source(source_text());
}

/// Quick ones of both kinds.
const std::vector<std::string> kQuick = {"table-3.6", "table-5.3", "table-3.5", "figure-3.12", "figure-4.8"};

Reproduction made(const Source& source, std::vector<std::string> only, unsigned threads = 0, std::uint64_t seed = 1) {
  ReproduceOptions options;
  options.only = std::move(only);
  options.threads = threads;
  options.seed = seed;
  auto reproduction = reproduce(source, options);
  EXPECT_TRUE(reproduction) << reproduction.error().line();
  return *reproduction;
}

/// Ours alone, and nothing else.
std::vector<double> ours(const Reproduction& reproduction) {
  std::vector<double> all;
  for (const Exhibit& exhibit : reproduction.exhibits) {
    for (const ReproducedTable& table : exhibit.tables) {
      for (const ReproducedRow& row : table.rows) {
        for (const ReproducedCell& cell : row.cells) {
          if (cell.ours) all.push_back(*cell.ours);
          if (cell.spread) all.push_back(*cell.spread);
        }
      }
    }
    for (const Chart& chart : exhibit.charts) {
      for (const ChartSeries& series : chart.series) {
        for (const double y : series.y) {
          if (y == y) all.push_back(y);
        }
      }
    }
  }
  return all;
}

TEST(Reproduce, HasEachExhibitOnce) {
  std::set<std::string_view> ids;
  for (const auto& [id, title] : exhibit_names()) {
    EXPECT_TRUE(ids.insert(id).second) << id;
    EXPECT_FALSE(title.empty()) << id;
  }
  for (const char* id : {"table-3.2", "table-3.3", "table-3.4", "table-3.5", "table-3.6", "table-4.1", "table-4.2",
                         "table-4.3", "table-4.4", "table-4.5", "table-5.3"}) {
    EXPECT_TRUE(ids.contains(id)) << id;
  }
}

TEST(Reproduce, ComputesTheSameWithoutThePrintedNumbers) {
  Source without = printed();
  without.printed.clear();
  const Reproduction with = made(printed(), kQuick), alone = made(without, kQuick);
  EXPECT_EQ(ours(with), ours(alone));
  EXPECT_GT(with.count(Agreement::within_rounding), 0);
  EXPECT_GT(with.count(Agreement::round_trip), 0);
  for (const auto& [agreement, word] : word_table(Agreement())) EXPECT_EQ(alone.count(agreement), 0) << word;
}

// Each printed number is counted once: as agreeing, as a round trip, as an erratum, as differing, or as not compared.
TEST(Reproduce, CountsEachPrintedNumberOnce) {
  const Reproduction reproduction = made(printed(), {"table-3.5", "table-3.6", "figure-3.12"});
  int all = 0;
  for (const auto& [agreement, word] : word_table(Agreement())) all += reproduction.count(agreement);
  EXPECT_EQ(all, reproduction.printed());
  EXPECT_EQ(reproduction.count(Agreement::round_trip), 2 * 9) << "table 3.5, rebuilt from itself";
  EXPECT_EQ(reproduction.count(Agreement::not_compared), 2 * 9) << "table 3.5, simulated";
  EXPECT_EQ(reproduction.beside_simulated(), 2 * 9);
  EXPECT_EQ(reproduction.count(Agreement::within_rounding), 8) << "table 3.6, as published";
  EXPECT_EQ(reproduction.count(Agreement::erratum), 8) << "table 3.6, corrected";
}

TEST(Reproduce, ComputesTheSameOnAnyNumberOfThreads) {
  const std::vector<std::string> only = {"figure-3.17"};
  EXPECT_EQ(result::to_json(made(printed(), only, 1)), result::to_json(made(printed(), only, 2)));
}

TEST(Reproduce, SimulatesSomethingElseWithAnotherSeed) {
  const std::vector<std::string> only = {"table-3.5"};
  EXPECT_NE(ours(made(printed(), only, 0, 1)), ours(made(printed(), only, 0, 2)));
}

TEST(Reproduce, FindsThePublishedExcessInEveryCellAndTheCorrectedInNone) {
  const Reproduction reproduction = made(printed(), {"table-3.6"});
  const ReproducedTable& table = reproduction.exhibits.at(0).tables.at(0);
  ASSERT_EQ(table.rows.size(), 8U);
  for (const ReproducedRow& row : table.rows) {
    EXPECT_EQ(row.cells[0].agreement, Agreement::within_rounding) << row.name;
    EXPECT_EQ(row.cells[1].agreement, Agreement::erratum) << row.name;
  }
}

TEST(Reproduce, RefusesWhatIsNotThere) {
  ReproduceOptions options;
  options.only = {"table-9.9"};
  const auto nothing = reproduce(printed(), options);
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().kind, ErrorKind::usage);
  EXPECT_THAT(nothing.error().line(), HasSubstr("--list"));
}

TEST(Reproduce, TellsHowFarItIs) {
  ReproduceOptions options;
  options.only = {"table-3.6", "table-5.3"};
  std::vector<std::string> said;
  options.progress = [&](int done, int of, std::string_view id) {
    said.push_back(fmt::format("{} {} {}", done, of, id));
  };
  ASSERT_TRUE(reproduce(printed(), options));
  EXPECT_THAT(said, ::testing::ElementsAre("0 2 table-3.6", "1 2 table-5.3"));
}

TEST(ReproductionCsv, HasARowForEachCellAndQuotesCommas) {
  const Reproduction reproduction = made(printed(), {"table-3.6"});
  const std::string csv = result::to_csv(reproduction.exhibits[0].tables[0]);
  EXPECT_EQ(std::ranges::count(csv, '\n'), 1 + 8 * 2);
  EXPECT_THAT(csv, HasSubstr("\"P1, sinusoidal\",\"λ_max/2, as published\",N·s/m,5.7,5.68"));
}

#ifdef MBK_WEB
TEST(ReproductionPage, HoldsTheDocumentAndNothingOfItCanEndItsElement) {
  Reproduction reproduction = made(printed(), {"table-3.6"});
  reproduction.exhibits[0].title = "</script><b>";
  const auto html = page(reproduction);
  ASSERT_TRUE(html);
  EXPECT_THAT(*html, HasSubstr("\\u003c/script>"));
  EXPECT_EQ(html->find("</script><b>"), std::string::npos);
}
#endif

}  // namespace reproduce_test
}  // namespace mbk::thesis
