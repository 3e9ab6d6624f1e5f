#include "mbk/study/store/trial_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "mbk/base/core/printable.h"
#include "mbk/base/core/trimmed.h"

namespace mbk::store {
namespace {

constexpr std::array<std::string_view, 5> kFields = {"participant", "session", "condition", "trial", "rater"};
constexpr std::string_view kBidsRater = "rater";  // an acquisition of a BIDS name begins so

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool is_ascii_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// Letters beyond ASCII too.
bool is_word(char c) {
  return is_digit(c) || is_ascii_letter(c) || c == '-' || static_cast<unsigned char>(c) >= 0x80;
}

std::optional<std::int64_t> whole_number(std::string_view text) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < 1) return std::nullopt;
  return number;
}

/// Sets the field of that name.   @returns  whether the text is one
bool set_field(KnownFacts& facts, std::string_view field, const std::string& text) {
  if (field == "condition") {
    facts.condition = text;
    return true;
  }
  if (field == "rater") {
    facts.rater = rater_code(text);
    return facts.rater.has_value();
  }
  auto& number = field == "participant" ? facts.participant : field == "session" ? facts.session : facts.trial;
  number = whole_number(text);
  return number.has_value();
}

/// The fields of one line of a sheet; what stands between quotes is one field.
class SheetReader {
 public:
  SheetReader(std::string_view text, char separator) : text_(text), separator_(separator) {}

  bool at_end() const { return at_ >= text_.size(); }

  std::vector<std::string> next_row() {
    std::vector<std::string> fields;
    while (true) {
      fields.push_back(next_field());
      if (at_end()) return fields;
      const char c = text_[at_++];
      if (c == separator_) continue;
      if (c == '\r' && !at_end() && text_[at_] == '\n') ++at_;
      return fields;
    }
  }

 private:
  bool ends_field(char c) const { return c == separator_ || c == '\n' || c == '\r'; }

  std::string next_field() {
    std::string field;
    if (!at_end() && text_[at_] == '"') {
      for (++at_; !at_end(); ++at_) {
        if (text_[at_] != '"') {
          field += text_[at_];
        } else if (at_ + 1 < text_.size() && text_[at_ + 1] == '"') {
          field += text_[at_++];
        } else {
          ++at_;
          break;
        }
      }
    }
    while (!at_end() && !ends_field(text_[at_])) field += text_[at_++];
    return std::string(trimmed(field));
  }

  std::string_view text_;
  char separator_;
  std::size_t at_ = 0;
};

}  // namespace

KnownFacts KnownFacts::or_else(const KnownFacts& other) const {
  KnownFacts facts = *this;
  if (!facts.participant) facts.participant = other.participant;
  if (!facts.session) facts.session = other.session;
  if (!facts.trial) facts.trial = other.trial;
  if (!facts.condition) facts.condition = other.condition;
  if (!facts.rater) facts.rater = other.rater;
  return facts;
}

Result<TrialFacts> KnownFacts::complete() const {
  if (!participant) {
    return bad_usage("the participant is unknown: the metadata name none",
                     "pass --participant N, or 'mbk study import' with --pattern or --sheet");
  }
  return TrialFacts{*participant, session.value_or(1), condition.value_or(""), trial, rater.value_or("")};
}

std::optional<std::string> rater_code(std::string_view text) {
  constexpr std::size_t kMaxLetters = 3;
  constexpr std::int64_t kLargest = 999999999;
  std::string code;
  while (!text.empty() && is_ascii_letter(text.front())) {
    code += static_cast<char>(text.front() >= 'a' ? text.front() - 'a' + 'A' : text.front());
    text.remove_prefix(1);
  }
  if (text.empty()) return code.size() == 1 ? std::optional(code) : std::nullopt;
  const auto number = whole_number(text);
  if (code.size() > kMaxLetters || !number || *number > kLargest) return std::nullopt;
  return code + std::to_string(*number);
}

Result<NamePattern> NamePattern::of(const std::string& pattern) {
  NamePattern made;
  made.pattern_ = pattern;
  const auto text = [&]() -> std::string& {
    if (made.pieces_.empty() || !made.pieces_.back().field.empty()) made.pieces_.emplace_back();
    return made.pieces_.back().text;
  };
  const auto known = [&](std::string_view field) {
    return std::ranges::any_of(made.pieces_, [&](const Piece& piece) { return piece.field == field; });
  };
  for (std::size_t at = 0; at < pattern.size(); ++at) {
    if (pattern[at] == '*') {
      made.pieces_.push_back({"*", ""});
    } else if (pattern[at] == '{') {
      const std::size_t end = pattern.find('}', at);
      const std::string field = pattern.substr(at + 1, end == std::string::npos ? end : end - at - 1);
      if (std::ranges::find(kFields, field) == kFields.end() || end == std::string::npos) {
        return bad_usage(fmt::format("--pattern: {{{}}} is not a placeholder", field),
                         "use {participant}, {session}, {condition}, {trial}, {rater} and *");
      }
      if (known(field)) return bad_usage(fmt::format("--pattern contains {{{}}} twice", field), "omit one");
      made.pieces_.push_back({field, ""});
      at = end;
    } else {
      text() += pattern[at];
    }
  }
  if (!known("participant")) {
    return bad_usage("--pattern contains no {participant}", "include it, as in p{participant}_*.h5");
  }
  return made;
}

bool NamePattern::matches(std::string_view name, std::size_t piece, std::map<std::string, std::string>& found) const {
  if (piece == pieces_.size()) return name.empty();
  const auto& [field, text] = pieces_[piece];
  if (field.empty()) return name.starts_with(text) && matches(name.substr(text.size()), piece + 1, found);
  std::size_t longest = 0;
  const auto belongs = [&field = field](char c) {
    return field == "*" ||
           (field == "condition" ? is_word(c) : is_digit(c) || (field == "rater" && is_ascii_letter(c)));
  };
  while (longest < name.size() && belongs(name[longest])) ++longest;
  for (std::size_t length = longest + 1; length-- > (field == "*" ? 0U : 1U);) {
    if (!matches(name.substr(length), piece + 1, found)) continue;
    if (field != "*") found[field] = std::string(name.substr(0, length));
    return true;
  }
  return false;
}

Result<KnownFacts> NamePattern::match(const std::string& name) const {
  const auto other = [&] {
    return fail(ErrorKind::usage, fmt::format("the name does not match the pattern {}", pattern_),
                "correct the pattern, or omit the file", name);
  };
  constexpr std::size_t kLongest = 255;  // of a name on a disk; a pattern of many * takes long to refuse a longer one
  std::map<std::string, std::string> found;
  if (name.size() > kLongest || !matches(name, 0, found)) return other();
  KnownFacts facts;
  for (const auto& [field, text] : found) {
    if (!set_field(facts, field, text)) return other();
  }
  return facts;
}

Result<Sheet> read_sheet(std::string_view text, const std::filesystem::path& folder) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  const std::string_view first = text.substr(0, text.find('\n'));
  char separator = ',';
  for (const char candidate : {';', '\t'}) {
    if (std::ranges::count(first, candidate) > std::ranges::count(first, separator)) separator = candidate;
  }
  SheetReader reader(text, separator);
  if (reader.at_end()) return bad_data("the sheet is empty", "name the columns in its first line: file,participant");
  std::vector<std::string> names = reader.next_row();
  Sheet sheet;
  for (std::string& name : names) {
    for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (name != "file" && std::ranges::find(kFields, name) == kFields.end()) sheet.ignored.push_back(printable(name));
  }
  for (const char* needed : {"file", "participant"}) {
    if (std::ranges::count(names, needed) != 1) {
      return bad_data(fmt::format("the sheet needs one column '{}'", needed), "name the columns in its first line");
    }
  }
  for (int line = 2; !reader.at_end(); ++line) {
    const std::vector<std::string> fields = reader.next_row();
    if (fields == std::vector<std::string>{""}) continue;
    const std::string where = fmt::format("row {}", line);
    if (fields.size() != names.size()) {
      return fail(ErrorKind::data,
                  fmt::format("the line has {} fields, but the first line has {}", fields.size(), names.size()),
                  "correct the sheet", where);
    }
    SheetRow row;
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (names[k] == "file") row.file = folder / fields[k];
      if (std::ranges::find(kFields, names[k]) == kFields.end() || fields[k].empty()) continue;
      if (!set_field(row.facts, names[k], fields[k])) {
        if (names[k] == "rater") {  // may be a name, which no message repeats
          return fail(ErrorKind::data, "the rater is neither a number nor a short code", std::string(kRaterAdvice),
                      where);
        }
        return fail(ErrorKind::data, fmt::format("'{}' is not a whole number from 1", fields[k]),
                    "number participants, sessions and trials", where + ", " + names[k]);
      }
    }
    if (row.file == folder / "") return fail(ErrorKind::data, "no file is named", "correct the sheet", where);
    sheet.rows.push_back(std::move(row));
  }
  return sheet;
}

std::string bids_label(std::string_view condition) {
  constexpr std::string_view kUnnamed = "unnamed", kOther = "other";
  std::string label;
  for (const char c : condition) {
    if (is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z')) label += c;
  }
  if (label.empty()) label = condition.empty() ? kUnnamed : kOther;
  return label;
}

bool is_bids_label(std::string_view label, std::string_view condition) {
  const std::string own = bids_label(condition);
  if (!label.starts_with(own)) return false;
  label.remove_prefix(own.size());
  return label.empty() || (label.starts_with('x') && whole_number(label.substr(1)));
}

Result<KnownFacts> facts_of_bids(std::string_view name) {
  KnownFacts facts;
  std::string task, acquisition;
  for (std::string_view rest = name; !rest.empty();) {
    const std::size_t end = std::min(rest.find('_'), rest.size());
    const std::string_view part = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::size_t dash = std::min(part.find('-'), part.size());
    const std::string_view entity = part.substr(0, dash);
    const std::string_view label = part.substr(std::min(dash + 1, part.size()));
    if (entity == "task") task = label;
    if (entity == "acq") acquisition = label;
    if (entity != "sub" && entity != "ses" && entity != "run") continue;
    const auto number = whole_number(label);
    if (!number) {
      return bad_usage(fmt::format("the label {}-{} is not a number, and may be a name", entity, label),
                       "import its motion.tsv with a sheet (--sheet) that gives participant, session and trial");
    }
    (entity == "sub" ? facts.participant : entity == "ses" ? facts.session : facts.trial) = number;
  }
  if (acquisition.starts_with(kBidsRater)) {
    facts.rater = rater_code(std::string_view(acquisition).substr(kBidsRater.size()));
    if (facts.rater) acquisition.clear();
  }
  if (!acquisition.empty()) task += '-' + acquisition;
  if (!task.empty()) facts.condition = task == bids_label("") ? "" : task;
  return facts;
}

KnownFacts facts_of(const std::map<std::string, std::string>& metadata) {
  KnownFacts facts;
  for (const std::string_view field : kFields) {
    const auto found = metadata.find(std::string(field));
    if (found != metadata.end() && !found->second.empty()) set_field(facts, field, found->second);
  }
  return facts;
}

}  // namespace mbk::store
