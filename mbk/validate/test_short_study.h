#pragma once

#include <gtest/gtest.h>

#include "mbk/model/trial/validation_table.h"

namespace mbk::validation {

/// So few runs show little: rows may be not shown, and the estimate of a share outside by chance. But no interval lies
/// beyond what is expected, and what is no estimate is met.
inline void expect_nothing_refuted(const ValidationTable& table) {
  EXPECT_FALSE(table.rows.empty());
  for (const ValidationRow& row : table.rows) {
    if (!row.judged()) continue;
    const auto [low, high] = row.interval95.value_or(std::pair(row.value, row.value));
    EXPECT_TRUE(high >= row.expected->first && low <= row.expected->second)
        << row.what << ": " << row.value << ", 95 % interval " << low << " to " << high << ", expected "
        << row.expected->first << " to " << row.expected->second;
  }
}

}  // namespace mbk::validation
