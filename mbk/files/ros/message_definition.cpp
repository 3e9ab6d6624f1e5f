#include "mbk/files/ros/message_definition.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/base/core/trimmed.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kMaxFields = 10000;  ///< of all types of a definition together
constexpr std::size_t kDeepestType = 32;   ///< types within types
constexpr std::uint64_t kMaxBytes = std::numeric_limits<std::uint32_t>::max();  ///< larger ones count as this one

struct Word {
  std::string_view name;
  FieldType type;
};

constexpr auto kWords = std::to_array<Word>({
    {"bool", FieldType::boolean},
    {"int8", FieldType::int8},
    {"uint8", FieldType::uint8},
    {"int16", FieldType::int16},
    {"uint16", FieldType::uint16},
    {"int32", FieldType::int32},
    {"uint32", FieldType::uint32},
    {"int64", FieldType::int64},
    {"uint64", FieldType::uint64},
    {"float32", FieldType::float32},
    {"float64", FieldType::float64},
    {"string", FieldType::text},
    {"wstring", FieldType::wide_text},
    {"char", FieldType::uint8},
});

constexpr std::string_view kHeader1 = "uint32 seq\ntime stamp\nstring frame_id\n";
constexpr std::string_view kHeader2 = "builtin_interfaces/Time stamp\nstring frame_id\n";

std::optional<FieldType> primitive(std::string_view name, Dialect dialect) {
  if (name == "byte") return dialect == Dialect::ros1 ? FieldType::int8 : FieldType::uint8;
  if (name == "builtin_interfaces/Time" || (dialect == Dialect::ros1 && name == "time")) return FieldType::time;
  if (name == "builtin_interfaces/Duration" || (dialect == Dialect::ros1 && name == "duration")) {
    return FieldType::duration;
  }
  const auto word = std::ranges::find(kWords, name, &Word::name);
  if (word == kWords.end() || (word->type == FieldType::wide_text && dialect == Dialect::ros1)) return std::nullopt;
  return word->type;
}

std::string_view bare(std::string_view text) {
  return trimmed(text, " \t\r");
}

bool is_separator(std::string_view line) {
  return line.size() >= 40 && line.find_first_not_of('=') == line.npos;
}

/// The next line of `text`, which is taken from it.
std::string_view next_line(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return bare(line);
}

/// The text of each type.
std::map<std::string, std::string_view, std::less<>> sections(std::string_view type, std::string_view text) {
  std::map<std::string, std::string_view, std::less<>> found;
  std::string name = plain_type(type);
  const char* begin = text.data();
  while (!text.empty()) {
    const char* const at = text.data();
    const std::string_view line = next_line(text);
    if (!is_separator(line) && !line.starts_with("MSG:")) continue;
    found.emplace(name, std::string_view(begin, static_cast<std::size_t>(at - begin)));
    if (line.starts_with("MSG:")) name = plain_type(bare(line.substr(4)));
    begin = text.data();
  }
  found.emplace(name, std::string_view(begin, static_cast<std::size_t>(text.data() - begin)));
  return found;
}

class Parser {
 public:
  Parser(std::string_view type, std::string_view text, Dialect dialect)
      : sections_(sections(type, text)), root_(plain_type(type)) {
    definition_.dialect = dialect;
  }

  Result<MessageDefinition> run() {
    MBK_TRY(parse(root_, ""));
    return std::move(definition_);
  }

 private:
  /// The index of a type; it and its members are parsed if they are not yet.
  Result<int> parse(const std::string& name, std::string_view package) {
    std::string full = name;
    auto section = sections_.find(full);
    if (section == sections_.end() && !package.empty() && name.find('/') == name.npos) {
      full = fmt::format("{}/{}", package, name);
      section = sections_.find(full);
    }
    const bool header = name == "Header" || name == "std_msgs/Header";
    if (section == sections_.end() && header) {
      full = "std_msgs/Header";
      section = sections_.try_emplace(full, definition_.dialect == Dialect::ros1 ? kHeader1 : kHeader2).first;
    }
    if (section == sections_.end()) {
      return bad_data(fmt::format("the type '{}' is not defined", name));
    }
    if (const auto known = known_.find(full); known != known_.end()) {
      if (known->second < 0) return bad_data(fmt::format("the type '{}' contains itself", full));
      return known->second;
    }
    if (depth_ >= kDeepestType) return bad_data("types are nested too deeply");
    known_[full] = -1;
    const std::size_t index = definition_.messages.size();
    definition_.messages.push_back({full, {}, 0});
    ++depth_;
    auto fields = parse_fields(section->second, full.substr(0, full.find('/')));
    --depth_;
    if (!fields) return tl::unexpected(fields.error());
    MessageType& type = definition_.messages[index];
    type.fields = std::move(*fields);
    for (const MessageField& field : type.fields) type.min_bytes += min_bytes_of(field);
    // A ROS 2 structure without members has one unnamed member.
    if (definition_.dialect == Dialect::ros2 && type.fields.empty()) {
      type.fields.push_back({"structure_needs_at_least_one_member", FieldType::uint8});
      type.min_bytes = 1;
    }
    type.min_bytes = std::min(type.min_bytes, kMaxBytes);
    known_[full] = static_cast<int>(index);
    return static_cast<int>(index);
  }

  [[nodiscard]] std::uint64_t min_bytes_of(const MessageField& field) const {
    if (field.count == MessageField::Count::counted) return 4;
    const std::uint64_t one = min_bytes(definition_, field);
    return one > 0 && field.elements > kMaxBytes / one ? kMaxBytes : one * field.elements;
  }

  Result<std::vector<MessageField>> parse_fields(std::string_view text, const std::string& package) {
    std::vector<MessageField> fields;
    while (!text.empty()) {
      std::string_view line = next_line(text);
      // A constant of text may hold a #, which is of no matter here.
      line = bare(line.substr(0, line.find('#')));
      if (line.empty()) continue;
      auto field = MBK_TRY(parse_field(line, package));
      if (!field) continue;
      if (++fields_ > kMaxFields) return bad_data(fmt::format("there are more than {} fields", kMaxFields));
      fields.push_back(std::move(*field));
    }
    return fields;
  }

  /// Nothing where the line defines a constant.
  Result<std::optional<MessageField>> parse_field(std::string_view line, const std::string& package) {
    const auto odd = [&] { return bad_data(fmt::format("'{}' defines no fields", line.substr(0, 80))); };
    const std::size_t space = line.find_first_of(" \t");
    if (space == line.npos) return odd();
    std::string_view type = line.substr(0, space);
    const std::string_view rest = bare(line.substr(space));
    const std::size_t end = rest.find_first_of(" \t=");
    const std::string_view name = rest.substr(0, end);
    if (name.empty()) return odd();
    const std::string_view behind = end == rest.npos ? std::string_view() : bare(rest.substr(end));
    if (behind.starts_with('=')) return std::nullopt;
    if (definition_.dialect == Dialect::ros1 && !behind.empty()) return odd();  // ROS 2: a default value

    MessageField field;
    field.name = printable(std::string(name));
    if (type.ends_with(']')) {
      const std::size_t open = type.rfind('[');
      if (open == type.npos) return odd();
      const std::string_view count = type.substr(open + 1, type.size() - open - 2);
      type = type.substr(0, open);
      field.count =
          count.empty() || count.starts_with("<=") ? MessageField::Count::counted : MessageField::Count::fixed;
      if (field.count == MessageField::Count::fixed) {
        const char* const last = count.data() + count.size();
        const auto [stop, error] = std::from_chars(count.data(), last, field.elements);
        if (error != std::errc() || stop != last) return odd();
      }
    }
    const bool bounded = type.find("<=") != type.npos;
    type = type.substr(0, type.find("<="));
    const std::string plain = plain_type(type);
    if (const auto known = primitive(plain, definition_.dialect)) {
      field.type = *known;
      definition_.wide_texts |= *known == FieldType::wide_text;
      return field;
    }
    if (bounded) return odd();
    const auto message = MBK_TRY(parse(plain, package));
    field.type = FieldType::message;
    field.message = message;
    return field;
  }

  std::map<std::string, std::string_view, std::less<>> sections_;
  std::string root_;
  std::map<std::string, int, std::less<>> known_;  ///< −1: is being parsed
  std::size_t depth_ = 0, fields_ = 0;
  MessageDefinition definition_;
};

}  // namespace

std::size_t number_size(FieldType type) {
  switch (type) {
    case FieldType::boolean:
    case FieldType::int8:
    case FieldType::uint8:
      return 1;
    case FieldType::int16:
    case FieldType::uint16:
      return 2;
    case FieldType::int32:
    case FieldType::uint32:
    case FieldType::float32:
      return 4;
    case FieldType::int64:
    case FieldType::uint64:
    case FieldType::float64:
      return 8;
    default:
      return 0;
  }
}

std::uint64_t min_bytes(const MessageDefinition& definition, const MessageField& field) {
  switch (field.type) {
    case FieldType::text:
    case FieldType::wide_text:
      return 4;
    case FieldType::time:
    case FieldType::duration:
      return 8;
    case FieldType::message:
      return definition.messages[static_cast<std::size_t>(field.message)].min_bytes;
    default:
      return number_size(field.type);
  }
}

std::string plain_type(std::string_view type) {
  std::string plain(type);
  if (const std::size_t middle = plain.find("/msg/"); middle != plain.npos) plain.erase(middle, 4);
  return plain;
}

Result<MessageDefinition> parse_definition(std::string_view type, std::string_view text, Dialect dialect) {
  return Parser(type, text, dialect).run();
}

}  // namespace mbk::recording
