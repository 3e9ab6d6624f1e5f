#include "mbk/files/tables/npy_header.h"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <utility>

#include "mbk/base/core/printable.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kMaxFields = 10'000;

/// A Python literal as used in such headers.
struct Literal {
  enum Kind { none, text, number, logical, list, dictionary };
  Kind kind = none;
  std::string words;
  std::uint64_t value = 0;
  std::vector<Literal> items;  ///< of a list or tuple; key, value, key, value, … of a dictionary

  [[nodiscard]] const Literal* at(std::string_view key) const {
    for (std::size_t k = 0; kind == dictionary && k + 1 < items.size(); k += 2) {
      if (items[k].kind == text && items[k].words == key) return &items[k + 1];
    }
    return nullptr;
  }
};

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  std::optional<Literal> whole() {
    auto found = literal(0);
    skip_blanks();
    if (!found || !text_.empty()) return std::nullopt;
    return found;
  }

 private:
  static constexpr int kDeepest = 32;

  void skip_blanks() { text_.remove_prefix(std::min(text_.find_first_not_of(" \t\r\n"), text_.size())); }
  bool take(std::string_view words) {
    if (!text_.starts_with(words)) return false;
    text_.remove_prefix(words.size());
    return true;
  }

  // NOLINTNEXTLINE(misc-no-recursion): as deep as kDeepest
  std::optional<Literal> literal(int depth) {
    skip_blanks();
    if (depth > kDeepest || text_.empty() || ++count_ > 20 * kMaxFields) return std::nullopt;
    if (take("True")) return Literal{Literal::logical, "", 1, {}};
    if (take("False")) return Literal{Literal::logical, "", 0, {}};
    if (take("None")) return Literal{};
    const char first = text_.front();
    if (first == '\'' || first == '"') return quoted(first);
    if (first >= '0' && first <= '9') return whole_number();
    text_.remove_prefix(1);
    if (first == '(') return items(')', depth);
    if (first == '[') return items(']', depth);
    if (first == '{') return items('}', depth);
    return std::nullopt;
  }

  std::optional<Literal> quoted(char mark) {
    Literal found{Literal::text, "", 0, {}};
    for (std::size_t k = 1; k < text_.size(); ++k) {
      if (text_[k] == mark) {
        text_.remove_prefix(k + 1);
        return found;
      }
      if (text_[k] == '\\' && k + 1 < text_.size()) ++k;
      found.words += text_[k];
    }
    return std::nullopt;
  }

  std::optional<Literal> whole_number() {
    Literal found{Literal::number, "", 0, {}};
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), found.value);
    if (error != std::errc()) return std::nullopt;
    text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
    take("L");  // Python 2
    return found;
  }

  // NOLINTNEXTLINE(misc-no-recursion): as deep as kDeepest
  std::optional<Literal> items(char end, int depth) {
    Literal found{end == '}' ? Literal::dictionary : Literal::list, "", 0, {}};
    for (;;) {
      skip_blanks();
      if (take(std::string_view(&end, 1))) return found;
      auto item = literal(depth + 1);
      if (!item) return std::nullopt;
      found.items.push_back(std::move(*item));
      skip_blanks();
      const bool key = end == '}' && found.items.size() % 2 == 1;
      if (take(key ? ":" : ",")) continue;
      if (key || !text_.starts_with(end)) return std::nullopt;
    }
  }

  std::string_view text_;
  std::size_t count_ = 0;
};

/// "<f8" as a field.
std::optional<NpyField> simple_field(std::string_view type) {
  NpyField field;
  field.type = printable(std::string(type));
  if (type.starts_with('<') || type.starts_with('>') || type.starts_with('|') || type.starts_with('=')) {
    field.big_endian = type.front() == '>';
    type.remove_prefix(1);
  }
  if (type.empty()) return std::nullopt;
  field.kind = type.front();
  type.remove_prefix(1);
  const auto [end, error] = std::from_chars(type.data(), type.data() + type.size(), field.size);
  if (error != std::errc()) {
    if (field.kind != 'O') return std::nullopt;
    field.size = sizeof(void*);  // it is not looked at
  }
  if (field.size > (std::size_t{1} << 30)) return std::nullopt;
  if (field.kind == 'U') field.size *= 4;
  return field;
}

/// The fields of a type, each behind `offset`; their bytes.
// NOLINTNEXTLINE(misc-no-recursion): a literal is as deep as the parser goes
std::optional<std::size_t> add_fields(const Literal& type, const std::string& prefix, std::size_t offset,
                                      std::vector<NpyField>& fields) {
  if (type.kind == Literal::text) {
    auto field = simple_field(type.words);
    if (!field || fields.size() >= kMaxFields) return std::nullopt;
    field->name = prefix;
    field->offset = offset;
    const std::size_t size = field->size;
    fields.push_back(std::move(*field));
    return size;
  }
  if (type.kind != Literal::list || type.items.empty()) return std::nullopt;
  std::size_t size = 0;
  for (const Literal& one : type.items) {
    if (one.kind != Literal::list || one.items.size() < 2 || one.items.size() > 3) return std::nullopt;
    // A title may accompany the name.
    const Literal& called = one.items[0];
    const std::string& name =
        called.kind == Literal::list && called.items.size() == 2 ? called.items[1].words : called.words;
    std::uint64_t count = 1;
    if (one.items.size() == 3) {
      const Literal& shape = one.items[2];
      const std::vector<Literal> alone = {shape};
      for (const Literal& length : shape.kind == Literal::number ? alone : shape.items) {
        if (length.kind != Literal::number || length.value > (1U << 20) || count > (1U << 20)) return std::nullopt;
        count *= length.value;
      }
    }
    const std::string whole = prefix.empty() || name.empty() ? prefix + name : prefix + "." + name;
    const std::size_t first = fields.size();
    const auto each = add_fields(one.items[1], printable(whole), offset + size, fields);
    if (!each || *each > (std::size_t{1} << 30) || count * *each > (std::uint64_t{1} << 40)) return std::nullopt;
    const bool padding = name.empty();
    if (padding) fields.resize(first);
    if (count != 1 && !padding) {
      // Of several structures in one element only their bytes are counted.
      if (fields.size() == first + 1 && one.items[1].kind == Literal::text) {
        fields.back().count = count;
      } else {
        for (std::size_t k = first; k < fields.size(); ++k) fields[k].kind = 'V';
      }
    }
    size += static_cast<std::size_t>(count * *each);
  }
  return size;
}

}  // namespace

Result<NpyHeader> parse_npy_header(std::string_view text) {
  const auto damaged = [](std::string_view what) {
    return bad_data(fmt::format("the header of the NumPy array is damaged: {}", what), "save it again with numpy.save");
  };
  const auto literal = Parser(text).whole();
  if (!literal) return damaged("it is not a Python literal");
  const Literal* const type = literal->at("descr");
  const Literal* const order = literal->at("fortran_order");
  const Literal* const shape = literal->at("shape");
  if (type == nullptr || order == nullptr || shape == nullptr)
    return damaged("'descr', 'fortran_order' or 'shape' is missing");
  if (order->kind != Literal::logical || shape->kind != Literal::list) return damaged("the shape is invalid");
  NpyHeader header;
  header.fortran_order = order->value != 0;
  header.structured = type->kind == Literal::list;
  for (const Literal& length : shape->items) {
    if (length.kind != Literal::number) return damaged("the shape is invalid");
    header.shape.push_back(length.value);
  }
  const auto element = add_fields(*type, "", 0, header.fields);
  if (!element) return damaged("its type is unknown");
  header.element = *element;
  return header;
}

}  // namespace mbk::recording
