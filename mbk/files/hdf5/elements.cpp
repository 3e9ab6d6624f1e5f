#include "mbk/files/hdf5/elements.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace mbk::hdf5 {
namespace {

using Kind = Datatype::Kind;

template <class Number>
void copy_numbers(Bytes bytes, bool big_endian, double* out) {
  const bool swapped = big_endian != (std::endian::native == std::endian::big);
  if (std::is_same_v<Number, double> && !swapped) {
    std::memcpy(out, bytes.data(), bytes.size());
    return;
  }
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(Number)) {
    std::byte raw[sizeof(Number)];
    std::memcpy(raw, bytes.data() + at, sizeof raw);
    if (swapped) std::reverse(raw, raw + sizeof raw);
    Number number;
    std::memcpy(&number, raw, sizeof number);
    *out++ = static_cast<double>(number);
  }
}

/// Remainders of 64-bit integers after conversion to double.
template <class Number>
void put_rests(Bytes bytes, bool big_endian, std::size_t first, const Vector& numbers, Rests& rests) {
  const bool swapped = big_endian != (std::endian::native == std::endian::big);
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(Number), ++first) {
    if (std::abs(numbers[static_cast<Index>(first)]) < kExactWhole) continue;
    std::byte raw[sizeof(Number)];
    std::memcpy(raw, bytes.data() + at, sizeof raw);
    if (swapped) std::reverse(raw, raw + sizeof raw);
    Number number;
    std::memcpy(&number, raw, sizeof number);
    rests.put(first, rest_of(number), static_cast<std::size_t>(numbers.size()));
  }
}

/// IEEE 754 binary16.
double half(std::uint16_t bits) {
  const int exponent = bits >> 10u & 0x1F;
  const int mantissa = bits & 0x3FF;
  const double sign = (bits & 0x8000u) != 0 ? -1.0 : 1.0;
  if (exponent == 0) return sign * std::ldexp(mantissa, -24);
  if (exponent < 31) return sign * std::ldexp(1024 + mantissa, exponent - 25);
  return mantissa == 0 ? sign * std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
}

void copy_halves(Bytes bytes, bool big_endian, double* out) {
  for (std::size_t at = 0; at < bytes.size(); at += 2) {
    const auto low = std::to_integer<unsigned>(bytes[at + (big_endian ? 1 : 0)]);
    const auto high = std::to_integer<unsigned>(bytes[at + (big_endian ? 0 : 1)]);
    *out++ = half(static_cast<std::uint16_t>(high << 8u | low));
  }
}

void copy_stored(Bytes bytes, const Datatype& type, double* out) {
  if (bytes.empty()) return;
  if (type.kind == Kind::half) return copy_halves(bytes, type.big_endian, out);
  switch (type.stored) {
    case Stored::float64:
      return copy_numbers<double>(bytes, type.big_endian, out);
    case Stored::float32:
      return copy_numbers<float>(bytes, type.big_endian, out);
    case Stored::int8:
      return copy_numbers<std::int8_t>(bytes, type.big_endian, out);
    case Stored::uint8:
      return copy_numbers<std::uint8_t>(bytes, type.big_endian, out);
    case Stored::int16:
      return copy_numbers<std::int16_t>(bytes, type.big_endian, out);
    case Stored::uint16:
      return copy_numbers<std::uint16_t>(bytes, type.big_endian, out);
    case Stored::int32:
      return copy_numbers<std::int32_t>(bytes, type.big_endian, out);
    case Stored::uint32:
      return copy_numbers<std::uint32_t>(bytes, type.big_endian, out);
    case Stored::int64:
      return copy_numbers<std::int64_t>(bytes, type.big_endian, out);
    case Stored::uint64:
      return copy_numbers<std::uint64_t>(bytes, type.big_endian, out);
  }
}

/// Whether a member of a compound type is read.
bool is_column(const Datatype& type) {
  return type.kind != Kind::unread && type.kind != Kind::reference;
}

/// A text of fixed length without what fills it up.
std::string trimmed(Bytes element, bool blanks) {
  const auto end = std::ranges::find(element, std::byte{0});
  std::string text = text_of({element.begin(), end});
  if (blanks) text.resize(text.find_last_not_of(' ') + 1);
  return text;
}

}  // namespace

Elements::Elements(File& file, GlobalHeap& heap, const Datatype& type) : file_(file), heap_(heap), type_(type) {
  for (const Member& member : type.members) columns_.emplace_back(file, heap, member.type);
}

Result<void> Elements::allocate(std::uint64_t count) {
  if (type_.kind == Kind::compound) {
    for (Elements& column : columns_) {
      if (!is_column(column.type_)) continue;
      MBK_TRY(column.allocate(count));
    }
    return {};
  }
  if (!multiply(count, type_.values, count)) return damaged("it claims more data than a file of this size can contain");
  const bool are_texts = type_.kind == Kind::text || type_.kind == Kind::long_text;
  const bool may_leave_rests = type_.stored == Stored::int64 || type_.stored == Stored::uint64;
  const std::size_t number = sizeof(double) + (may_leave_rests ? sizeof(std::int16_t) : 0);
  MBK_TRY(file_.budget.keep(count, are_texts ? sizeof(std::string) : number));
  if (are_texts) {
    texts_.resize(static_cast<std::size_t>(count));
  } else if (type_.kind == Kind::reference) {
    MBK_TRY(file_.budget.keep(count, sizeof(std::string)));  // paths are inserted later
    addresses_.resize(static_cast<std::size_t>(count));
  } else {
    numbers_.resize(static_cast<Index>(count));
  }
  return {};
}

Result<void> Elements::put(std::uint64_t first, Bytes bytes) {
  if (type_.kind == Kind::compound) return put_columns(first, bytes);
  const auto at = static_cast<std::size_t>(first) * type_.values;
  if (type_.kind == Kind::text || type_.kind == Kind::long_text) return put_texts(at, bytes);
  if (type_.kind == Kind::reference) {
    Cursor in = file_.cursor(bytes);
    for (std::size_t i = 0; i < bytes.size() / type_.size * type_.values; ++i) addresses_[at + i] = in.address();
    return {};
  }
  copy_stored(bytes, type_, numbers_.data() + at);
  if (type_.kind != Kind::number) return {};
  if (type_.stored == Stored::int64) put_rests<std::int64_t>(bytes, type_.big_endian, at, numbers_, rests_);
  if (type_.stored == Stored::uint64) put_rests<std::uint64_t>(bytes, type_.big_endian, at, numbers_, rests_);
  return {};
}

/// Gathers the bytes of each column from the rows.
Result<void> Elements::put_columns(std::uint64_t first, Bytes bytes) {
  const std::size_t rows = bytes.size() / type_.size;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const Member& member = type_.members[k];
    if (!is_column(member.type)) continue;
    const std::size_t size = member.type.size;
    gathered_.resize(rows * size);
    const std::byte* from = bytes.data() + member.offset;
    for (std::size_t row = 0; row < rows; ++row, from += type_.size) {
      std::memcpy(gathered_.data() + row * size, from, size);
    }
    MBK_TRY(columns_[k].put(first, gathered_));
  }
  return {};
}

Result<void> Elements::put_texts(std::size_t first, Bytes bytes) {
  const std::size_t each = type_.size / type_.values;
  for (std::size_t i = 0; i < bytes.size() / each; ++i) {
    const Bytes element = bytes.subspan(i * each, each);
    std::string& text = texts_[first + i];
    if (type_.kind == Kind::text) {
      text = trimmed(element, type_.padded_with_blanks);
    } else {
      text = MBK_TRY(long_text(element));
    }
    MBK_TRY(file_.budget.keep(1, text.size()));
  }
  return {};
}

Result<std::string> Elements::long_text(Bytes element) {
  Cursor in = file_.cursor(element);
  const std::uint64_t length = in.dword();
  const std::uint64_t collection = in.address();
  const std::uint64_t number = in.dword();
  if (length == 0 || collection == 0 || collection == kUndefined) return std::string();
  const auto object = MBK_TRY(heap_.object(file_, collection, number));
  if (length > object.size()) return damaged("a text is longer than its object in the global heap");
  return trimmed(object.first(static_cast<std::size_t>(length)), false);
}

Value Elements::value(std::vector<std::uint64_t> shape) {
  shape.insert(shape.end(), type_.array.begin(), type_.array.end());
  Value value{std::move(shape), {}};
  if (type_.kind == Kind::text || type_.kind == Kind::long_text) {
    value.data = std::move(texts_);
  } else if (type_.kind == Kind::reference) {
    value.data = References{Texts(addresses_.size())};
  } else {
    value.data = Numbers{std::move(numbers_), type_.stored, std::move(rests_)};
  }
  return value;
}

Group Elements::table(const std::vector<std::uint64_t>& shape) {
  Group table;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const Member& member = type_.members[k];
    table.columns.push_back(member.name);
    if (member.type.kind == Kind::compound) {
      table.groups[member.name] = columns_[k].table(shape);
    } else if (is_column(member.type)) {
      table.datasets[member.name].value = columns_[k].value(shape);
    } else {
      table.datasets[member.name].value = {
          shape, Unread{member.type.kind == Kind::reference ? "of references" : member.type.what}};
    }
  }
  return table;
}

}  // namespace mbk::hdf5
