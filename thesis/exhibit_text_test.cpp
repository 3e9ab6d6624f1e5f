#include "thesis/exhibit_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "thesis/exhibits.h"
#include "thesis/reproduce.h"

namespace mbk::thesis {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Result<std::vector<ExhibitText>> read(std::string_view markdown) {
  return read_text({&markdown, 1});
}

constexpr std::string_view kExample = R"(# Chapter 1

## table-1: A title: with a colon

It weighs {mass_kg:.2f} kg.

[tuned]

### 1: Of {people} people

| person | how |
|---|---|
| P1 | well |
| P2 | {how} |

#### Drawn

Not to scale.

## tuned

Gains of {who}.
)";

/// What the example is about, as code would make it.
Draft example() {
  Draft draft;
  ReproducedTable table;
  table.id = "1";
  table.columns = {{"mass", "kg", 1}, {"how", "", 0}, {"age", "", 0}};
  table.rows = {{"P1", {cell(1.0), cell(20.0)}}, {"P2", {cell(2.0), cell(30.0)}}};
  draft.tables = {table};
  draft.charts.resize(2);
  draft.charts[0].title = "P1";
  draft.values = {{"mass_kg", 0.194}, {"people", 2}, {"how", "badly"}};
  return draft;
}

const TextValues kCommon = {{"who", "us"}, {"unused", 1}};

/// What is wrong with an example once it has been changed.
std::string fault(const std::function<void(ExhibitText&, Draft&)>& change) {
  auto texts = read(kExample);
  EXPECT_TRUE(texts);
  Draft draft = example();
  change(texts->front(), draft);
  const auto put = put_text(texts->front(), kCommon, draft);
  return put ? "" : put.error().line();
}

TEST(ExhibitText, IsPutWithItsValuesWhereItBelongs) {
  const auto texts = read(kExample);
  ASSERT_TRUE(texts) << texts.error().line();
  ASSERT_EQ(texts->size(), 1u) << "a note is no exhibit";
  EXPECT_EQ(texts->front().id, "table-1");
  Draft draft = example();
  const auto put = put_text(texts->front(), kCommon, draft);
  ASSERT_TRUE(put) << put.error().line();
  EXPECT_EQ(draft.title, "A title: with a colon");
  EXPECT_THAT(draft.text, ElementsAre("It weighs 0.19 kg.", "Gains of us."));
  EXPECT_EQ(draft.tables[0].title, "Of 2 people");
  ASSERT_EQ(draft.tables[0].rows[1].cells.size(), 3u);
  EXPECT_EQ(draft.tables[0].rows[1].cells[1].words, "badly");
  EXPECT_EQ(draft.tables[0].rows[1].cells[2].ours, 30.0);
  EXPECT_EQ(draft.charts[0].title, "P1") << "named by its data";
  EXPECT_EQ(draft.charts[1].title, "Drawn");
  EXPECT_THAT(draft.charts[1].notes, ElementsAre("Not to scale."));
}

TEST(ExhibitText, MakesTheRowsOfATableOfWords) {
  const auto texts = read("## lost: Lost\n\n### lost: What\n\n| what | why |\n|---|---|\n| data | not published |\n");
  ASSERT_TRUE(texts);
  Draft draft;
  draft.tables.resize(1);
  draft.tables[0].id = "lost";
  draft.tables[0].columns = {{"why", "", 0}};
  ASSERT_TRUE(put_text(texts->front(), {}, draft));
  ASSERT_EQ(draft.tables[0].rows.size(), 1u);
  EXPECT_EQ(draft.tables[0].rows[0].name, "data");
  EXPECT_EQ(draft.tables[0].rows[0].cells.at(0).words, "not published");
}

TEST(ExhibitText, RefusesAValueThatIsMissingUnusedOrOfAnotherKind) {
  EXPECT_EQ(fault([](ExhibitText&, Draft&) {}), "");
  EXPECT_THAT(fault([](ExhibitText&, Draft& draft) { draft.values.erase("mass_kg"); }), HasSubstr("'mass_kg'"));
  EXPECT_THAT(fault([](ExhibitText&, Draft& draft) { draft.values["age"] = 1; }), HasSubstr("'age'"));
  EXPECT_THAT(fault([](ExhibitText&, Draft& draft) { draft.values["mass_kg"] = "heavy"; }), HasSubstr("It weighs"));
}

TEST(ExhibitText, RefusesOtherTablesRowsOrCharts) {
  EXPECT_THAT(fault([](ExhibitText&, Draft& draft) { draft.tables[0].id = "2"; }), HasSubstr("tables"));
  EXPECT_THAT(fault([](ExhibitText&, Draft& draft) { draft.tables.pop_back(); }), HasSubstr("tables"));
  EXPECT_THAT(fault([](ExhibitText&, Draft& draft) { draft.tables[0].rows[0].name = "P3"; }), HasSubstr("rows"));
  EXPECT_THAT(fault([](ExhibitText&, Draft& draft) { draft.tables[0].columns[1].name = "why"; }), HasSubstr("how"));
  EXPECT_THAT(fault([](ExhibitText&, Draft& draft) { draft.charts.resize(3); }), HasSubstr("caption"));
  EXPECT_THAT(fault([](ExhibitText&, Draft& draft) { draft.charts.pop_back(); }), HasSubstr("Drawn"));
}

TEST(ExhibitText, RefusesLinesThatBelongNowhere) {
  for (const std::string_view markdown :
       {"A paragraph of nothing.\n", "## a: A\n\n| a | b |\n", "## a: A\n\n### b: B\n\nA paragraph below a table.\n",
        "## a: A\n\n### b: B\n\n| a | b |\n|---|---|\n| one |\n", "## a: A\n\n## a: B\n", "## a: A\n\n[b]\n",
        "## a: A\n\n## note\n\nNowhere used.\n"}) {
    const auto texts = read(markdown);
    ASSERT_FALSE(texts) << markdown;
    EXPECT_EQ(texts.error().kind, ErrorKind::data);
  }
}

TEST(ExhibitText, IsThereForEachExhibitAndForNothingElse) {
  const auto texts = read_text(text_files());
  ASSERT_TRUE(texts) << texts.error().line();
  std::vector<std::string_view> exhibits, written;
  for (const ExhibitName& name : exhibit_names()) exhibits.push_back(name.id);
  for (const ExhibitText& text : *texts) {
    written.emplace_back(text.id);
    EXPECT_FALSE(text.paragraphs.empty()) << text.id;
    for (const TableText& table : text.tables) EXPECT_FALSE(table.caption.empty()) << table.id;
  }
  EXPECT_THAT(written, ::testing::UnorderedElementsAreArray(exhibits));
}

}  // namespace
}  // namespace mbk::thesis
