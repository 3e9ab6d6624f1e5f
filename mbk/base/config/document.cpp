#include "mbk/base/config/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "mbk/base/config/key_unit.h"
#include "mbk/base/config/text_file.h"
#include "mbk/base/config/toml_tree.h"
#include "mbk/base/core/edit_distance.h"

namespace mbk::config {
namespace {

constexpr std::size_t kLongestShown = 60;  ///< bytes of a text from the file that a message quotes
constexpr std::string_view kTrialKey = "trial";
constexpr std::string_view kNameKey = "name";

/// A text from the file on one line of a message.
std::string shown(std::string_view text) {
  std::size_t size = std::min(text.size(), kLongestShown);
  while (size < text.size() && size > 0 && (static_cast<unsigned char>(text[size]) & 0xC0u) == 0x80u) --size;
  std::string line(text.substr(0, size));
  std::ranges::replace_if(
      line, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, '?');
  return size < text.size() ? line + "…" : line;
}

std::string in_quotes(std::string_view text) {
  return "'" + shown(text) + "'";
}

/// "a number": what a value is, in words.
std::string_view kind_of(const Node& node) {
  struct Words {
    std::string_view operator()(const Table&) const { return "a table"; }
    std::string_view operator()(const List& list) const {
      const bool tables = !list.empty() && std::ranges::all_of(list, [](const Node& entry) {
        return std::holds_alternative<Table>(entry.value);
      });
      return tables ? "an array of tables" : "an array";
    }
    std::string_view operator()(const std::string&) const { return "a text"; }
    std::string_view operator()(std::int64_t) const { return "a whole number"; }
    std::string_view operator()(double) const { return "a number"; }
    std::string_view operator()(bool) const { return "true or false"; }
    std::string_view operator()(const Date&) const { return "a date"; }
  };
  return std::visit(Words{}, node.value);
}

const Table* table_of(const Node* node) {
  return node == nullptr ? nullptr : std::get_if<Table>(&node->value);
}

const Node* entry_of(const Node* node, std::string_view key) {
  const Table* table = table_of(node);
  if (table == nullptr) return nullptr;
  const auto entry = table->find(key);
  return entry == table->end() ? nullptr : &entry->second;
}

std::string joined(std::string_view path, std::string_view key) {
  return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

/// The path of entry `i`, counted from 0, of an array of tables.
std::string element(std::string_view path, std::size_t i) {
  return fmt::format("{}[{}]", path, i + 1);
}

using Keys = std::set<std::string, std::less<>>;

struct UnknownKey {
  std::string section;
  std::string key;
  int line = 0;
  std::string meant;  // the nearest known key, or ""
};

}  // namespace

/// State shared by the sections of one document: the tree and the requested keys.
class Reading {
 public:
  struct Missing {
    std::string section;
    std::string key;
    Error error;
  };

  std::string file;
  std::shared_ptr<const Node> tree;
  const Node* overlay = nullptr;                   ///< table of a trial, in `tree`
  std::map<std::string, Keys, std::less<>> asked;  ///< section → keys
  Keys left_to_others;                             ///< tables whose keys are not checked here
  std::optional<Error> problem;                    ///< the first
  std::optional<Missing> missing;                  ///< the first required key that is not there
  std::vector<std::shared_ptr<Reading>> trials;

  void ask(const std::string& section, std::string_view key) { asked[section].emplace(key); }

  Result<void> finish() const {
    for (const Reading* reading : family()) {
      if (reading->problem) return tl::unexpected(*reading->problem);
    }
    const std::optional<UnknownKey> unknown = first_unknown();
    for (const Reading* reading : family()) {
      const auto& absent = reading->missing;
      if (absent && !(unknown && explains(*unknown, *absent))) return tl::unexpected(absent->error);
    }
    if (unknown) return tl::unexpected(describe(*unknown));
    return {};
  }

 private:
  /// This and its trials.
  [[nodiscard]] std::vector<const Reading*> family() const {
    std::vector<const Reading*> all = {this};
    for (const auto& trial : trials) all.push_back(trial.get());
    return all;
  }

  [[nodiscard]] Keys known_in(const std::string& section) const {
    Keys known;
    for (const Reading* reading : family()) {
      if (const auto keys = reading->asked.find(section); keys != reading->asked.end()) {
        known.insert(keys->second.begin(), keys->second.end());
      }
    }
    return known;
  }

  /// The first in the file. A trial answers for its own table only, the file for itself and its trials.
  [[nodiscard]] std::optional<UnknownKey> first_unknown() const {
    std::optional<UnknownKey> first;
    search(overlay != nullptr ? *overlay : *tree, "", first);
    for (const auto& trial : trials) trial->search(*trial->overlay, "", first);
    return first;
  }

  void search(const Node& node, const std::string& section, std::optional<UnknownKey>& first) const {
    const Table* table = table_of(&node);
    if (table == nullptr) return;
    const Keys known = known_in(section);
    for (const auto& [key, value] : *table) {
      const std::string path = joined(section, key);
      if (path == kTrialKey && !trials.empty()) continue;
      if (std::ranges::any_of(family(), [&](const Reading* r) { return r->left_to_others.contains(path); })) continue;
      if (!known.contains(key)) {
        if (!first || value.line < first->line)
          first = UnknownKey{section, key, value.line,
                             meant_word(key, std::vector<std::string>(known.begin(), known.end()))};
      } else if (const List* list = std::get_if<List>(&value.value)) {
        for (std::size_t i = 0; i < list->size(); ++i) search((*list)[i], element(path, i), first);
      } else {
        search(value, path, first);
      }
    }
  }

  /// A misspelt key, or table around it, is reported instead of the missing one.
  static bool explains(const UnknownKey& unknown, const Missing& absent) {
    if (unknown.meant.empty()) return false;
    const std::string meant = joined(unknown.section, unknown.meant), path = joined(absent.section, absent.key);
    return path == meant || path.starts_with(meant + ".") || path.starts_with(meant + "[");
  }

  [[nodiscard]] Error describe(const UnknownKey& unknown) const {
    Keys known = known_in(unknown.section);
    std::string remedy;
    if (!unknown.meant.empty()) {
      remedy = fmt::format("did you mean '{}'?", unknown.meant);
    } else if (known.empty()) {
      remedy = "remove it; no key is read here";
    } else {
      remedy = fmt::format("use one of {}", fmt::join(known, ", "));
    }
    const std::string owner = unknown.section.empty() ? "this file" : fmt::format("[{}]", shown(unknown.section));
    return {ErrorKind::data, fmt::format("unknown key {} in {}", in_quotes(unknown.key), owner), std::move(remedy),
            fmt::format("{}, line {}", file, unknown.line)};
  }
};

Result<Document> Document::parse(std::string_view text, std::string_view file) {
  auto tree = parse_toml(text);
  if (!tree) return tl::unexpected(tree.error().in(file));
  auto reading = std::make_shared<Reading>();
  reading->file = file;
  reading->tree = std::make_shared<const Node>(std::move(*tree));
  return Document(std::move(reading));
}

Result<Document> Document::read(const std::filesystem::path& file) {
  const auto text = MBK_TRY(read_text_file(file, kLargestText));
  return parse(text, file.string());
}

Section Document::root() const {
  return {reading_, "", reading_->overlay, reading_->tree.get()};
}

Result<std::vector<Trial>> Document::trials() const {
  const Section top = root();
  const std::vector<Section> tables = top.sections(kTrialKey);
  if (reading_->problem) return tl::unexpected(*reading_->problem);
  if (tables.empty()) return std::vector<Trial>{{"", *this}};
  if (tables.size() > kMaxTrials) {
    return tl::unexpected(top.error(
        kTrialKey, fmt::format("the file has {} trials, more than the maximum of {}", tables.size(), kMaxTrials)));
  }
  reading_->trials.clear();
  std::vector<Trial> trials;
  for (const Section& table : tables) {
    auto reading = std::make_shared<Reading>();
    reading->file = reading_->file;
    reading->tree = reading_->tree;
    reading->overlay = table.base_;
    Trial trial{"", Document(reading)};
    const Section own(reading, "", reading->overlay, nullptr);
    trial.name = own.required_text(kNameKey);
    const auto allowed = [](unsigned char c) { return (c < 0x80 && std::isalnum(c) != 0) || c == '_' || c == '-'; };
    if (!reading->problem && !reading->missing && (trial.name.empty() || !std::ranges::all_of(trial.name, allowed))) {
      own.reject(kNameKey, fmt::format("{} is not a valid name of a trial", in_quotes(trial.name)),
                 "use letters, digits, _ and -, since it becomes part of file names");
    }
    if (std::ranges::find(trials, trial.name, &Trial::name) != trials.end()) {
      own.reject(kNameKey, fmt::format("two trials are named {}", in_quotes(trial.name)), "give each its own name");
    }
    if (reading->problem) return tl::unexpected(*reading->problem);
    if (reading->missing) {
      return tl::unexpected(own.error_at("", reading->overlay->line, "a trial has no name", "add name = \"...\""));
    }
    reading_->trials.push_back(std::move(reading));
    trials.push_back(std::move(trial));
  }
  return trials;
}

Result<void> Document::finish() const {
  return reading_->finish();
}

// ---- contents of a section ----

bool Section::given() const {
  return over_ != nullptr || base_ != nullptr;
}

void Section::rename(std::string_view former, std::string_view now) {
  former_.insert_or_assign(std::string(now), std::string(former));
}

bool Section::has(std::string_view key) const {
  return find(key, Need::optional) != nullptr;
}

const Node* Section::find(std::string_view key, Need need) const {
  reading_->ask(path_, key);
  const Node* node = entry_of(over_, key);
  if (node == nullptr) node = entry_of(base_, key);
  if (const auto former = former_.find(key); node == nullptr && former != former_.end()) {
    return find(former->second, need);
  }
  if (node == nullptr && need == Need::required && !reading_->missing) {
    const Node* table = over_ != nullptr && reading_->overlay != over_ ? over_ : base_;
    const int line = path_.empty() || table == nullptr ? 0 : table->line;
    const std::string owner = path_.empty() ? "this file" : fmt::format("[{}]", shown(path_));
    reading_->missing = {path_, std::string(key),
                         error_at("", line, fmt::format("'{}' is missing in {}", key, owner), "add it")};
  }
  return node;
}

Section Section::section(std::string_view key) const {
  reading_->ask(path_, key);
  const Node* over = entry_of(over_, key);
  const Node* base = entry_of(base_, key);
  if (const Node* visible = over != nullptr ? over : base; visible != nullptr && table_of(visible) == nullptr) {
    wrong_type(key, *visible, "a table");
  }
  return {reading_, joined(path_, key), table_of(over) != nullptr ? over : nullptr,
          table_of(base) != nullptr ? base : nullptr};
}

void Section::leave_to_others(std::string_view key) const {
  reading_->ask(path_, key);
  reading_->left_to_others.emplace(joined(path_, key));
}

std::vector<Section> Section::sections(std::string_view key) const {
  std::vector<Section> found;
  const Node* node = find(key, Need::optional);
  if (node == nullptr) return found;
  const List* list = std::get_if<List>(&node->value);
  if (list == nullptr || std::ranges::any_of(*list, [](const Node& entry) { return table_of(&entry) == nullptr; })) {
    wrong_type(key, *node, fmt::format("an array of tables ([[{}]])", joined(path_, key)));
    return found;
  }
  const std::string path = joined(path_, key);
  for (std::size_t i = 0; i < list->size(); ++i) found.push_back({reading_, element(path, i), nullptr, &(*list)[i]});
  return found;
}

// ---- values ----

std::optional<double> Section::checked(std::string_view key, const Node& node, Range allowed,
                                       std::string_view place) const {
  double value = 0.0;
  if (const auto* integer = std::get_if<std::int64_t>(&node.value)) {
    value = static_cast<double>(*integer);
  } else if (const auto* number = std::get_if<double>(&node.value)) {
    value = *number;
  } else {
    wrong_type(key, node, "a number", place);
    return std::nullopt;
  }
  if (!std::isfinite(value)) {
    reject(key, fmt::format("{}{} is not finite", place, value));
    return std::nullopt;
  }
  if (!allowed.holds(value)) {
    reject(key, fmt::format("{}{} is out of range", place, value), allowed.remedy());
    return std::nullopt;
  }
  return unit_of_key(key).to_si(value);
}

std::optional<std::vector<double>> Section::checked_list(std::string_view key, const Node& node, Range allowed,
                                                         std::size_t count, std::string_view place) const {
  const List* list = std::get_if<List>(&node.value);
  if (list == nullptr) {
    wrong_type(key, node, "an array of numbers", place);
    return std::nullopt;
  }
  if (count != kAnyCount && list->size() != count) {
    reject(key, fmt::format("{}expected {} numbers, found {}", place, count, list->size()));
    return std::nullopt;
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const auto value = checked(key, (*list)[i], allowed, fmt::format("{}entry {}: ", place, i + 1));
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

std::optional<double> Section::find_number(std::string_view key, Range allowed, Need need) const {
  const Node* node = find(key, need);
  return node == nullptr ? std::nullopt : checked(key, *node, allowed, "");
}

std::optional<std::int64_t> Section::find_integer(std::string_view key, std::int64_t low, std::int64_t high,
                                                  Need need) const {
  const Node* node = find(key, need);
  if (node == nullptr) return std::nullopt;
  const auto* value = std::get_if<std::int64_t>(&node->value);
  if (value == nullptr) {
    wrong_type(key, *node, "a whole number");
    return std::nullopt;
  }
  if (*value < low || *value > high) {
    reject(key, fmt::format("{} is out of range", *value), fmt::format("choose {} to {}", low, high));
    return std::nullopt;
  }
  return *value;
}

std::optional<std::string> Section::find_text(std::string_view key, Need need) const {
  const Node* node = find(key, need);
  if (node == nullptr) return std::nullopt;
  const auto* text = std::get_if<std::string>(&node->value);
  if (text == nullptr) {
    wrong_type(key, *node, "a text");
    return std::nullopt;
  }
  return *text;
}

std::optional<std::ptrdiff_t> Section::find_word(std::string_view key, std::span<const std::string_view> words,
                                                 Need need) const {
  const auto text = find_text(key, need);
  if (!text) return std::nullopt;
  const auto word = std::ranges::find(words, *text);
  if (word != words.end()) return word - words.begin();
  reject(key, fmt::format("{} is not a valid value", in_quotes(*text)),
         fmt::format("use one of {}", fmt::join(words, ", ")));
  return std::nullopt;
}

std::optional<std::vector<std::ptrdiff_t>> Section::find_words(std::string_view key,
                                                               std::span<const std::string_view> words) const {
  const Node* node = find(key, Need::optional);
  if (node == nullptr) return std::nullopt;
  const List* list = std::get_if<List>(&node->value);
  if (list == nullptr) {
    wrong_type(key, *node, "an array of words");
    return std::nullopt;
  }
  std::vector<std::ptrdiff_t> indices;
  for (const Node& entry : *list) {
    const auto* text = std::get_if<std::string>(&entry.value);
    if (text == nullptr) {
      wrong_type(key, entry, "a text", fmt::format("entry {}: ", indices.size() + 1));
      return std::nullopt;
    }
    const std::ptrdiff_t index = std::ranges::find(words, *text) - words.begin();
    if (index == std::ssize(words)) {
      reject(key, fmt::format("{} is not a valid value", in_quotes(*text)),
             fmt::format("use one of {}", fmt::join(words, ", ")));
      return std::nullopt;
    }
    if (std::ranges::find(indices, index) != indices.end()) {
      reject(key, fmt::format("{} occurs twice", in_quotes(*text)), "remove one");
      return std::nullopt;
    }
    indices.push_back(index);
  }
  return indices;
}

std::optional<std::vector<double>> Section::find_numbers(std::string_view key, Range allowed, std::size_t count,
                                                         Need need) const {
  const Node* node = find(key, need);
  return node == nullptr ? std::nullopt : checked_list(key, *node, allowed, count, "");
}

std::optional<Eigen::Vector2d> Section::find_vector2(std::string_view key, Range allowed, Need need) const {
  const auto values = find_numbers(key, allowed, 2, need);
  return values ? std::optional(Eigen::Vector2d((*values)[0], (*values)[1])) : std::nullopt;
}

template <int N>
std::optional<Eigen::Matrix<double, N, N>> Section::find_matrix(std::string_view key, Range allowed, Need need) const {
  const Node* node = find(key, need);
  if (node == nullptr) return std::nullopt;
  const List* rows = std::get_if<List>(&node->value);
  if (rows == nullptr || rows->size() != N) {
    reject(key, fmt::format("this is not a matrix with {} rows", N == 2 ? "two" : "three"),
           N == 2 ? "write [[a, b], [c, d]]" : "write [[a, b, c], [d, e, f], [g, h, i]]");
    return std::nullopt;
  }
  Eigen::Matrix<double, N, N> matrix;
  for (std::size_t i = 0; i < N; ++i) {
    const auto row = checked_list(key, (*rows)[i], allowed, N, fmt::format("row {}: ", i + 1));
    if (!row) return std::nullopt;
    matrix.row(static_cast<Eigen::Index>(i)) = Eigen::Map<const Eigen::Matrix<double, 1, N>>(row->data());
  }
  return matrix;
}

double Section::number(std::string_view key, double fallback, Range allowed) const {
  return find_number(key, allowed, Need::optional).value_or(fallback);
}

double Section::required_number(std::string_view key, Range allowed) const {
  return find_number(key, allowed, Need::required).value_or(allowed.low);
}

std::optional<double> Section::optional_number(std::string_view key, Range allowed) const {
  return find_number(key, allowed, Need::optional);
}

bool Section::flag(std::string_view key, bool fallback) const {
  const Node* node = find(key, Need::optional);
  if (node == nullptr) return fallback;
  if (const bool* value = std::get_if<bool>(&node->value)) return *value;
  wrong_type(key, *node, "true or false");
  return fallback;
}

std::string Section::text(std::string_view key, std::string_view fallback) const {
  return find_text(key, Need::optional).value_or(std::string(fallback));
}

std::string Section::required_text(std::string_view key) const {
  return find_text(key, Need::required).value_or("");
}

std::vector<double> Section::numbers(std::string_view key, std::vector<double> fallback, Range allowed,
                                     std::size_t count) const {
  return find_numbers(key, allowed, count, Need::optional).value_or(std::move(fallback));
}

Eigen::Vector2d Section::vector2(std::string_view key, const Eigen::Vector2d& fallback, Range allowed) const {
  return find_vector2(key, allowed, Need::optional).value_or(fallback);
}

Eigen::Vector2d Section::required_vector2(std::string_view key, Range allowed) const {
  return find_vector2(key, allowed, Need::required).value_or(Eigen::Vector2d::Zero());
}

Eigen::Matrix2d Section::matrix2(std::string_view key, const Eigen::Matrix2d& fallback, Range allowed) const {
  return find_matrix<2>(key, allowed, Need::optional).value_or(fallback);
}

Eigen::Matrix2d Section::required_matrix2(std::string_view key, Range allowed) const {
  return find_matrix<2>(key, allowed, Need::required).value_or(Eigen::Matrix2d::Zero());
}

Eigen::Matrix3d Section::matrix3(std::string_view key, const Eigen::Matrix3d& fallback) const {
  return find_matrix<3>(key, any(), Need::optional).value_or(fallback);
}

Eigen::Matrix3d Section::required_matrix3(std::string_view key) const {
  return find_matrix<3>(key, any(), Need::required).value_or(Eigen::Matrix3d::Zero());
}

// ---- problems ----

std::string Section::full_name(std::string_view key) const {
  return shown(key.empty() ? path_ : joined(path_, key));
}

Error Section::error_at(std::string_view key, int line, std::string message, std::string remedy) const {
  std::string where = reading_->file;
  if (line > 0) where += fmt::format(", line {}", line);
  if (!key.empty()) where += ", " + full_name(key);
  return fail(ErrorKind::data, std::move(message), std::move(remedy), std::move(where)).value();
}

Error Section::error(std::string_view key, std::string message, std::string remedy) const {
  const Node* node = entry_of(over_, key);
  if (node == nullptr) node = entry_of(base_, key);
  if (node == nullptr && !path_.empty()) node = over_ != nullptr ? over_ : base_;
  return error_at(key, node == nullptr ? 0 : node->line, std::move(message), std::move(remedy));
}

void Section::reject(std::string_view key, std::string message, std::string remedy) const {
  if (!reading_->problem) reading_->problem = error(key, std::move(message), std::move(remedy));
}

void Section::wrong_type(std::string_view key, const Node& node, std::string_view requested,
                         std::string_view place) const {
  const auto* text = std::get_if<std::string>(&node.value);
  const std::string found = text == nullptr ? std::string(kind_of(node)) : "the text " + in_quotes(*text);
  reject(key, fmt::format("{}expected {}, found {}", place, requested, found));
}

}  // namespace mbk::config
