#include "mbk/files/recording/table_columns.h"

#include <gtest/gtest.h>

#include "mbk/files/contents/test_pages.h"

namespace mbk::recording {
namespace table_columns_test {

constexpr Index kColumns = 3;

double number(Index row, Index column) {
  return 0.5 * static_cast<double>(row) - static_cast<double>(column);
}

Vector numbers(Index rows, Index column) {
  return Vector::NullaryExpr(rows, [&](Index row) { return number(row, column); });
}

void fill(TableColumns& table, Index rows) {
  while (table.rows() < rows) {
    for (Index c = 0; c < kColumns; ++c) table[static_cast<std::size_t>(c)] = number(table.rows(), c);
    table.next_row();
  }
}

void expect_columns(TableColumns& table, Index rows) {
  for (Index c = 0; c < kColumns; ++c) {
    EXPECT_EQ(table.column(static_cast<std::size_t>(c)), numbers(rows, c)) << rows;
  }
}

TEST(TableColumns, HoldAsManyRowsAsCome) {
  for (const Index expected : {Index{1}, Index{1000}, kLong - 1, kLong + 1, kLong + kLong / 2}) {
    TableColumns table;
    table.expect(kColumns, expected);
    expect_columns(table, 0);
    for (const Index rows : {Index{1}, Index{700}, kLong - 1, kLong, kLong + 100'000}) {
      fill(table, rows);
      expect_columns(table, rows);
    }
    for (Index c = 0; c < kColumns; ++c) {
      EXPECT_EQ(table.take(static_cast<std::size_t>(c)), numbers(kLong + 100'000, c)) << expected;
    }
  }
}

TEST(TableColumns, OfALongTableTakeNoMemoryButAtTheirEnds) {
  TableColumns table;
  table.expect(kColumns, 2 * kLong);
  fill(table, kLong);
  for (std::size_t c = 0; c < kColumns; ++c) {
    const Vector column = table.take(c);
    const auto pages = test::pages_in_memory(column);
    if (!pages) GTEST_SKIP() << "the kernel does not say what is in memory";
    EXPECT_LE(*pages, 3);
  }
}

}  // namespace table_columns_test
}  // namespace mbk::recording
