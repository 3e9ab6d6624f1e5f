// The numbers of results: each result's in one row, and those of all as columns.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>
#include <tuple>
#include <unordered_map>

#include "mbk/study/store/store.h"
#include "mbk/study/store/store_database.h"

namespace mbk::store {
namespace packed_numbers {

static_assert(std::endian::native == std::endian::little, "a study is the same on every machine that opens it");

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

struct NamedUnit {
  std::string name, unit;
};

/// [["K_xx", "N/m"], …]; nothing where the text is another one.
std::vector<NamedUnit> layout_of(const std::string& text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  std::vector<NamedUnit> layout;
  if (!json.is_array()) return layout;
  for (const auto& one : json) {
    if (!one.is_array() || one.size() != 2 || !one[0].is_string() || !one[1].is_string()) return {};
    layout.push_back({one[0].get<std::string>(), one[1].get<std::string>()});
  }
  return layout;
}

/// Values and then standard errors of `count` outcomes; empty where the bytes are not that many.
std::span<const std::byte> numbers_at(const SQLite::Column& column, std::size_t count) {
  const auto bytes = static_cast<std::size_t>(column.getBytes());
  if (bytes != 2 * count * sizeof(double)) return {};
  return {static_cast<const std::byte*>(column.getBlob()), bytes};
}

double number_in(std::span<const std::byte> numbers, std::size_t k) {
  double value = 0.0;
  std::memcpy(&value, numbers.subspan(k * sizeof(double), sizeof(double)).data(), sizeof(double));
  return value;
}

/// Whose the usable results are, by the numbers of the results.
struct UsableResults {
  std::vector<std::int64_t> numbers;
  std::vector<TrialRow> trials;
  std::vector<std::string> conditions, raters;
};

/// Gives each trial the place of its rater among the sorted codes.
/// @param codes  of each trial; "": not recorded
void set_raters(UsableResults& results, const std::vector<std::string>& codes) {
  for (const std::string& code : codes) {
    if (!code.empty()) results.raters.push_back(code);
  }
  std::ranges::sort(results.raters);
  results.raters.erase(std::unique(results.raters.begin(), results.raters.end()), results.raters.end());
  for (std::size_t k = 0; k < codes.size(); ++k) {
    if (codes[k].empty()) continue;
    const auto found = std::ranges::lower_bound(results.raters, codes[k]);
    results.trials[k].rater = static_cast<int>(found - results.raters.begin());
  }
}

UsableResults usable_results(const SQLite::Database& connection, std::int64_t analysis) {
  UsableResults results;
  std::map<std::string, int, std::less<>> known;
  std::vector<std::int64_t> first_recording;
  std::vector<std::string> codes;
  auto rows = query(connection,
                    "SELECT result.number, recording.number, participant, session, trial, condition, rater FROM result "
                    "JOIN recording ON recording.number = recording WHERE analysis = ? AND usable = 1 AND "
                    "excluded_why IS NULL ORDER BY result.number",
                    analysis);
  while (rows.executeStep()) {
    const char* const condition = rows.getColumn(5).getText();
    auto found = known.find(std::string_view(condition));
    if (found == known.end()) {
      found = known.emplace(condition, static_cast<int>(results.conditions.size())).first;
      results.conditions.emplace_back(condition);
      first_recording.push_back(std::numeric_limits<std::int64_t>::max());
    }
    results.numbers.push_back(number_at(rows, 0));
    results.trials.push_back(
        {number_at(rows, 1), number_at(rows, 2), number_at(rows, 3), number_at(rows, 4), found->second});
    std::int64_t& first = first_recording[static_cast<std::size_t>(found->second)];
    first = std::min(first, results.trials.back().recording);
    codes.push_back(text_at(rows, 6));
  }
  // conditions in the order of the recordings
  std::vector<std::size_t> order(results.conditions.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) { return first_recording[k]; });
  std::vector<int> place(order.size());
  std::vector<std::string> conditions;
  for (std::size_t k = 0; k < order.size(); ++k) {
    place[order[k]] = static_cast<int>(k);
    conditions.push_back(results.conditions[order[k]]);
  }
  results.conditions = std::move(conditions);
  for (TrialRow& trial : results.trials) trial.condition = place[static_cast<std::size_t>(trial.condition)];
  set_raters(results, codes);
  return results;
}

/// For each result, in the order of their numbers, where it stands by participant, session, trial and recording.
std::vector<std::size_t> places_of(std::vector<TrialRow>& trials) {
  std::vector<std::size_t> order(trials.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t k) {
    const TrialRow& row = trials[k];
    return std::tuple(row.participant, row.session, row.trial, row.recording);
  });
  std::vector<std::size_t> place(trials.size());
  std::vector<TrialRow> sorted;
  sorted.reserve(trials.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    place[order[k]] = k;
    sorted.push_back(trials[order[k]]);
  }
  trials = std::move(sorted);
  return place;
}

/// The columns of each layout.
class ColumnsOfLayouts {
 public:
  ColumnsOfLayouts(const SQLite::Database& connection, OutcomeColumns& columns)
      : connection_(connection), columns_(columns) {}

  const std::vector<std::size_t>& at(std::int64_t layout) {
    const auto there = known_.find(layout);
    if (there != known_.end()) return there->second;
    auto row = query(connection_, "SELECT names FROM layout WHERE number = ?", layout);
    std::vector<std::size_t>& indices = known_[layout];
    if (!row.executeStep()) return indices;
    for (NamedUnit& one : layout_of(text_at(row, 0))) {
      const auto [found, added] = by_name_.emplace(one.name, columns_.outcomes.size());
      if (added) {
        columns_.outcomes.push_back(
            {std::move(one.name), std::move(one.unit), std::vector<double>(columns_.trials.size(), kNothing), {}});
      }
      indices.push_back(found->second);
    }
    return indices;
  }

 private:
  const SQLite::Database& connection_;
  OutcomeColumns& columns_;
  std::unordered_map<std::int64_t, std::vector<std::size_t>> known_;
  std::unordered_map<std::string, std::size_t> by_name_;
};

}  // namespace packed_numbers

void pack_outcomes(SQLite::Database& connection, std::int64_t result, const std::vector<Outcome>& outcomes) {
  nlohmann::json names = nlohmann::json::array();
  std::vector<double> numbers;
  for (const Outcome& one : outcomes) {
    names.push_back({one.name, one.unit});
    numbers.push_back(one.value);
  }
  for (const Outcome& one : outcomes) numbers.push_back(one.standard_error.value_or(packed_numbers::kNothing));
  const std::string text = names.dump();
  execute(connection, "INSERT OR IGNORE INTO layout(names) VALUES (?)", text);
  auto layout = query(connection, "SELECT number FROM layout WHERE names = ?", text);
  layout.executeStep();
  SQLite::Statement insert(connection, "INSERT INTO packed VALUES (?, ?, ?)");
  insert.bind(1, result);
  insert.bind(2, number_at(layout, 0));
  insert.bind(3, numbers.data(), static_cast<int>(numbers.size() * sizeof(double)));
  insert.exec();
}

Result<void> pack_all_outcomes(SQLite::Database& connection) {
  SQLite::Statement documents(connection, "SELECT result, text FROM document");
  while (documents.executeStep()) {
    const auto outcomes = MBK_TRY(outcomes_of(text_at(documents, 1)));
    if (!outcomes.empty()) pack_outcomes(connection, number_at(documents, 0), outcomes);
  }
  return {};
}

std::vector<Outcome> unpacked_outcomes(const SQLite::Database& connection, std::int64_t result) {
  using namespace packed_numbers;
  std::vector<Outcome> outcomes;
  auto row = query(connection,
                   "SELECT names, numbers FROM packed JOIN layout ON layout.number = layout WHERE result = ?", result);
  if (!row.executeStep()) return outcomes;
  std::vector<NamedUnit> layout = layout_of(text_at(row, 0));
  const SQLite::Column column = row.getColumn(1);
  const auto numbers = numbers_at(column, layout.size());
  if (numbers.empty()) return outcomes;
  for (std::size_t k = 0; k < layout.size(); ++k) {
    Outcome& one = outcomes.emplace_back();
    one.name = std::move(layout[k].name);
    one.unit = std::move(layout[k].unit);
    one.value = number_in(numbers, k);
    const double error = number_in(numbers, layout.size() + k);
    if (!std::isnan(error)) one.standard_error = error;
  }
  return outcomes;
}

Result<OutcomeColumns> Store::columns(std::int64_t analysis) const {
  using namespace packed_numbers;
  return guarded(folder(), [&]() -> Result<OutcomeColumns> {
    const SQLite::Database& connection = database_->connection;
    // What both statements see is the same, whatever another process writes in between.
    const SQLite::Transaction snapshot(database_->connection);
    UsableResults results = usable_results(connection, analysis);
    OutcomeColumns columns;
    columns.conditions = std::move(results.conditions);
    columns.raters = std::move(results.raters);
    columns.trials = std::move(results.trials);
    const std::vector<std::size_t> places = places_of(columns.trials);
    ColumnsOfLayouts layouts(connection, columns);
    if (results.numbers.empty()) return columns;
    // Both are in the order of the results' numbers.
    auto rows =
        query(connection, "SELECT result, layout, numbers FROM packed WHERE result BETWEEN ? AND ? ORDER BY result",
              results.numbers.front(), results.numbers.back());
    std::size_t next = 0;
    while (rows.executeStep()) {
      const std::int64_t number = number_at(rows, 0);
      while (next < results.numbers.size() && results.numbers[next] < number) ++next;
      if (next == results.numbers.size()) break;
      if (results.numbers[next] != number) continue;
      const std::vector<std::size_t>& indices = layouts.at(number_at(rows, 1));
      const SQLite::Column column = rows.getColumn(2);
      const auto numbers = numbers_at(column, indices.size());
      if (numbers.empty()) {
        return bad_data(fmt::format("the numbers of result {} are damaged", number),
                        "'mbk study check' names all; restore the folder from a backup",
                        (folder() / kDatabaseName).string());
      }
      for (std::size_t k = 0; k < indices.size(); ++k) {
        OutcomeColumn& outcome = columns.outcomes[indices[k]];
        outcome.values[places[next]] = number_in(numbers, k);
        const double error = number_in(numbers, indices.size() + k);
        if (std::isnan(error)) continue;
        if (outcome.standard_errors.empty()) outcome.standard_errors.assign(columns.trials.size(), kNothing);
        outcome.standard_errors[places[next]] = error;
      }
    }
    return columns;
  });
}

}  // namespace mbk::store
