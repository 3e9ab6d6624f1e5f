#include "mbk/files/hdf5/write_messages.h"

#include <algorithm>

#include "mbk/files/hdf5/stored_numbers.h"

namespace mbk::hdf5 {
namespace {

/// Class and version, three bytes of flags, and the size of one value.
Output datatype(unsigned type_class, unsigned flags, unsigned more_flags, std::size_t size) {
  Output out;
  out.put_u8(0x10 | type_class);
  out.put_u8(flags);
  out.put_u8(more_flags);
  out.put_u8(0);
  out.put_u32(size);
  return out;
}

Output number_type(Stored stored) {
  const std::size_t size = size_of(stored);
  if (!is_float(stored)) {
    Output out = datatype(0, is_signed(stored) ? 0x08 : 0, 0, size);
    out.put_u16(0);
    out.put_u16(8 * size);
    return out;
  }
  const bool single = size == 4;
  Output out = datatype(1, 0x20, static_cast<unsigned>(8 * size - 1), size);  // IEEE 754; the place of the sign
  out.put_u16(0);
  out.put_u16(8 * size);
  out.put_u8(single ? 23 : 52);  // exponent: place and bits
  out.put_u8(single ? 8 : 11);
  out.put_u8(0);  // mantissa: place and bits
  out.put_u8(single ? 23 : 52);
  out.put_u32(single ? 127 : 1023);
  return out;
}

}  // namespace

void HeaderOutput::add(Says what, Output message) {
  message.align();
  messages_.put_u16(static_cast<std::size_t>(what));
  messages_.put_u16(message.bytes.size());
  messages_.put_zeros(4);
  messages_.append(std::move(message));
  ++count_;
}

Output HeaderOutput::bytes() && {
  Output out;
  out.put_u8(1);
  out.put_u8(0);
  out.put_u16(count_);
  out.put_u32(1);  // one link points to it
  out.put_u32(messages_.bytes.size());
  out.put_zeros(4);
  out.append(std::move(messages_));
  return out;
}

Stand stand_of(std::string_view attribute) {
  if (attribute == "MATLAB_fields") return Stand::letters;
  return attribute.starts_with("MATLAB_") ? Stand::fixed : Stand::variable;
}

bool is_ascii(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; });
}

std::size_t longest(const Texts& texts) {
  std::size_t length = 1;
  for (const std::string& text : texts) length = std::max(length, text.size());
  return length;
}

Output dataspace_message(const std::vector<std::uint64_t>& shape) {
  Output out;
  out.put_u8(1);
  out.put_u8(static_cast<unsigned>(shape.size()));
  out.put_zeros(6);
  for (const std::uint64_t length : shape) out.put_u64(length);
  return out;
}

Output datatype_message(const Value& value, Stand stand) {
  if (const auto* numbers = std::get_if<Numbers>(&value.data)) return number_type(numbers->stored);
  if (std::holds_alternative<References>(value.data)) return datatype(7, 0, 0, 8);
  const auto& texts = std::get<Texts>(value.data);
  if (stand == Stand::fixed) return datatype(3, std::ranges::all_of(texts, is_ascii) ? 0 : 0x10, 0, longest(texts));
  const bool letters = stand == Stand::letters;  // sequences of strings of one byte; otherwise strings in UTF-8
  Output type = datatype(9, letters ? 0 : 1, letters ? 0 : 1, 16);
  type.append(letters ? datatype(3, 0, 0, 1) : number_type(Stored::uint8));
  return type;
}

}  // namespace mbk::hdf5
