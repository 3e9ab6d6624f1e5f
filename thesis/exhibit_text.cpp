#include "thesis/exhibit_text.h"

#include <fmt/args.h>
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "mbk/base/core/trimmed.h"

namespace mbk::thesis {
namespace {

using Names = std::set<std::string, std::less<>>;

/// "a: b" in two; b is empty where there is no colon.
std::pair<std::string, std::string> name_and_title(std::string_view heading) {
  const auto colon = heading.find(": ");
  if (colon == std::string_view::npos) return {std::string(heading), ""};
  return {std::string(heading.substr(0, colon)), std::string(heading.substr(colon + 2))};
}

/// "| a | b |" is a and b.
std::vector<std::string> cells_of(std::string_view line) {
  std::vector<std::string> cells;
  for (std::size_t at = 1, bar = 0; (bar = line.find('|', at)) != std::string_view::npos; at = bar + 1) {
    cells.emplace_back(trimmed(line.substr(at, bar - at)));
  }
  return cells;
}

/// Takes the lines of a file one by one.
class Reader {
 public:
  Result<void> take(std::string_view line) {
    if (line.empty() || line.starts_with("# ")) return {};
    if (line.starts_with("## ")) return begin_exhibit(line.substr(3));
    if (exhibits_.empty()) return misplaced(line);
    ExhibitText& exhibit = exhibits_.back();
    if (line.starts_with("### ")) {
      auto [id, caption] = name_and_title(line.substr(4));
      exhibit.tables.push_back({std::move(id), std::move(caption), {}, {}});
      into_ = Into::table;
    } else if (line.starts_with("#### ")) {
      exhibit.charts.push_back({std::string(line.substr(5)), {}});
      into_ = Into::chart;
    } else if (line.starts_with('|')) {
      return take_row(line);
    } else if (into_ == Into::table) {
      return misplaced(line);
    } else {
      (into_ == Into::chart ? exhibit.charts.back().notes : exhibit.paragraphs).emplace_back(line);
    }
    return {};
  }

  Result<std::vector<ExhibitText>> finish() {
    std::map<std::string, std::vector<std::string>, std::less<>> notes;
    for (ExhibitText& text : exhibits_) {
      if (text.title.empty()) notes[text.id] = std::move(text.paragraphs);
    }
    std::erase_if(exhibits_, [](const ExhibitText& text) { return text.title.empty(); });
    Names used;
    for (ExhibitText& text : exhibits_) {
      std::vector<std::string> paragraphs;
      for (std::string& paragraph : text.paragraphs) {
        if (!paragraph.starts_with('[') || !paragraph.ends_with(']')) {
          paragraphs.push_back(std::move(paragraph));
          continue;
        }
        const auto note = notes.find(std::string_view(paragraph).substr(1, paragraph.size() - 2));
        if (note == notes.end()) return bad_data(fmt::format("there is no note {}", paragraph), "", text.id);
        used.insert(note->first);
        paragraphs.insert(paragraphs.end(), note->second.begin(), note->second.end());
      }
      text.paragraphs = std::move(paragraphs);
    }
    for (const auto& [id, paragraphs] : notes) {
      if (!used.contains(id)) return bad_data("no exhibit has this note", "", id);
    }
    return std::move(exhibits_);
  }

 private:
  enum class Into { paragraphs, table, chart };

  Result<void> misplaced(std::string_view line) const {
    return bad_data(fmt::format("'{}' is not allowed here", line), "", exhibits_.empty() ? "" : exhibits_.back().id);
  }

  Result<void> begin_exhibit(std::string_view heading) {
    auto [id, title] = name_and_title(heading);
    if (std::ranges::find(exhibits_, id, &ExhibitText::id) != exhibits_.end()) {
      return bad_data("there are two texts of this id", "", id);
    }
    exhibits_.push_back({std::move(id), std::move(title), {}, {}, {}});
    into_ = Into::paragraphs;
    return {};
  }

  Result<void> take_row(std::string_view line) {
    if (into_ != Into::table) return misplaced(line);
    if (line.find_first_not_of("|- ") == std::string_view::npos) return {};  // the line below the columns' names
    TableText& table = exhibits_.back().tables.back();
    std::vector<std::string> cells = cells_of(line);
    if (table.columns.empty()) {
      table.columns = std::move(cells);
    } else if (cells.size() == table.columns.size()) {
      table.rows.push_back(std::move(cells));
    } else {
      return misplaced(line);
    }
    return {};
  }

  std::vector<ExhibitText> exhibits_;
  Into into_ = Into::paragraphs;
};

/// Calls `visit` with every text of an exhibit that may have placeholders: all but ids.
template <class Text, class Visit>
void each_text(Text& text, const Visit& visit) {
  visit(text.title);
  for (auto& paragraph : text.paragraphs) visit(paragraph);
  for (auto& table : text.tables) {
    visit(table.caption);
    for (auto& row : table.rows) {
      for (auto& cell : row) visit(cell);
    }
  }
  for (auto& chart : text.charts) {
    visit(chart.caption);
    for (auto& note : chart.notes) visit(note);
  }
}

/// The text with its placeholders filled.
Result<ExhibitText> filled(ExhibitText text, const TextValues& common, const TextValues& own) {
  const Names asked = placeholders(text);
  for (const auto& [name, value] : own) {
    if (!asked.contains(name)) return bad_data(fmt::format("no text has a place for the value '{}'", name));
  }
  fmt::dynamic_format_arg_store<fmt::format_context> store;
  for (const TextValues* values : {&common, &own}) {
    for (const auto& [name, value] : *values) {
      std::visit([&](const auto& of_type) { store.push_back(fmt::arg(name.c_str(), of_type)); }, value);
    }
  }
  for (const std::string& name : asked) {
    if (!common.contains(name) && !own.contains(name)) return bad_data(fmt::format("'{}' has no value", name));
  }
  std::string problem;
  each_text(text, [&](std::string& one) {
    try {
      one = fmt::vformat(one, store);
    } catch (const fmt::format_error& error) {
      problem = fmt::format("'{}': {}", one, error.what());
    }
  });
  if (!problem.empty()) return bad_data(problem);
  return text;
}

/// Puts the columns of words into a table that names them and has no cells for them. Where it has no rows either, these
/// are the text's.
Result<void> put_columns(const TableText& text, ReproducedTable& table) {
  if (table.rows.empty()) {
    for (const auto& row : text.rows) table.rows.push_back({row.front(), {}});
  }
  if (!std::ranges::equal(
          text.rows, table.rows, {}, [](const auto& row) { return row.front(); }, &ReproducedRow::name)) {
    return bad_data("the text has other rows", "", table.id);
  }
  for (std::size_t k = 1; k < text.columns.size(); ++k) {
    const auto column = std::ranges::find(table.columns, text.columns[k], &ReproducedColumn::name);
    if (column == table.columns.end()) return bad_data("no column is named " + text.columns[k], "", table.id);
    const auto at = column - table.columns.begin();
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
      std::vector<ReproducedCell>& cells = table.rows[row].cells;
      if (std::ssize(cells) < at) return bad_data("a cell is missing", "", table.id);
      ReproducedCell words;
      words.words = text.rows[row][k];
      cells.insert(cells.begin() + at, std::move(words));
    }
  }
  return {};
}

}  // namespace

Result<std::vector<ExhibitText>> read_text(std::span<const std::string_view> files) {
  Reader reader;
  for (std::string_view file : files) {
    while (!file.empty()) {
      const auto end = std::min(file.find('\n'), file.size());
      MBK_TRY(reader.take(file.substr(0, end)));
      file.remove_prefix(std::min(end + 1, file.size()));
    }
  }
  return reader.finish();
}

Names placeholders(std::string_view text) {
  Names names;
  for (std::size_t at = 0; (at = text.find('{', at)) != std::string_view::npos; ++at) {
    if (text.substr(at).starts_with("{{")) {
      ++at;
      continue;
    }
    const auto begin = at + 1;
    names.emplace(text.substr(begin, text.find_first_of(":}", begin) - begin));
  }
  return names;
}

Names placeholders(const ExhibitText& text) {
  Names names;
  each_text(text, [&](const std::string& one) { names.merge(placeholders(one)); });
  return names;
}

Result<void> put_text(const ExhibitText& text, const TextValues& common, Draft& draft) {
  auto words = MBK_TRY(filled(text, common, draft.values));
  draft.title = std::move(words.title);
  draft.text = std::move(words.paragraphs);
  if (!std::ranges::equal(words.tables, draft.tables, {}, &TableText::id, &ReproducedTable::id)) {
    return bad_data("the text has other tables");
  }
  for (std::size_t k = 0; k < draft.tables.size(); ++k) {
    TableText& table = words.tables[k];
    draft.tables[k].title = std::move(table.caption);
    if (table.columns.empty()) continue;
    MBK_TRY(put_columns(table, draft.tables[k]));
  }
  auto chart_text = words.charts.begin();
  for (Chart& chart : draft.charts) {
    if (!chart.title.empty()) continue;
    if (chart_text == words.charts.end()) return bad_data("a chart has no caption");
    chart.title = std::move(chart_text->caption);
    chart.notes = std::move(chart_text->notes);
    ++chart_text;
  }
  if (chart_text != words.charts.end()) return bad_data(fmt::format("there is no chart '{}'", chart_text->caption));
  return {};
}

}  // namespace mbk::thesis
