#include "mbk/files/hdf5/datatype.h"

#include <fmt/format.h>

#include <optional>

namespace mbk::hdf5 {
namespace {

// Classes of datatypes.
constexpr unsigned kFixedPoint = 0, kFloatingPoint = 1, kTime = 2, kString = 3, kBitField = 4, kOpaque = 5,
                   kCompound = 6, kReference = 7, kEnumeration = 8, kVariableLength = 9, kArray = 10;

/// The part of the message that all classes share.
struct Header {
  unsigned type_class;
  unsigned bits;  ///< what they mean depends on the class
  std::uint32_t size;
};

Header read_header(Cursor& in) {
  Header header{};
  header.type_class = in.byte() & 0x0Fu;
  header.bits = static_cast<unsigned>(in.number(3));
  header.size = in.dword();
  return header;
}

Datatype unread(const Header& header, std::string what) {
  Datatype type;
  type.size = header.size;
  type.what = std::move(what);
  return type;
}

Datatype number(const Header& header, std::optional<Stored> stored, std::string_view what) {
  Datatype type = unread(header, std::string(what));
  if (!stored) return type;
  type.kind = Datatype::Kind::number;
  type.stored = *stored;
  type.big_endian = (header.bits & 1u) != 0;
  return type;
}

std::optional<Stored> stored_integer(std::uint32_t size, bool is_signed) {
  switch (size) {
    case 1:
      return is_signed ? Stored::int8 : Stored::uint8;
    case 2:
      return is_signed ? Stored::int16 : Stored::uint16;
    case 4:
      return is_signed ? Stored::int32 : Stored::uint32;
    case 8:
      return is_signed ? Stored::int64 : Stored::uint64;
    default:
      return std::nullopt;
  }
}

Datatype fixed_point(const Header& header, Cursor& in) {
  const bool fills = in.word() == 0 && in.word() == 8 * header.size;  // no bits left unused
  return number(header, fills ? stored_integer(header.size, (header.bits & 8u) != 0) : std::nullopt,
                "of integers of an unusual size");
}

/// An IEEE 754 layout: sign, exponent, mantissa with a leading 1 that is not stored.
struct FloatLayout {
  std::uint32_t size, precision, exponent_at, exponent_bits, mantissa_bits, bias;
  bool operator==(const FloatLayout&) const = default;
};

Datatype floating_point(const Header& header, Cursor& in) {
  constexpr std::string_view kUnusual = "of floating-point numbers that are not IEEE 754";
  const unsigned offset = in.word();
  FloatLayout layout{header.size};
  layout.precision = in.word();
  layout.exponent_at = in.byte();
  layout.exponent_bits = in.byte();
  const unsigned mantissa_at = in.byte();
  layout.mantissa_bits = in.byte();
  layout.bias = in.dword();
  const bool vax = (header.bits & 0x40u) != 0;
  const bool leading_one = (header.bits >> 4u & 3u) == 2;
  const bool sign_first = (header.bits >> 8u & 0xFFu) + 1 == 8 * header.size;
  if (offset != 0 || mantissa_at != 0 || vax || !leading_one || !sign_first) {
    return unread(header, std::string(kUnusual));
  }
  if (layout == FloatLayout{8, 64, 52, 11, 52, 1023}) return number(header, Stored::float64, "");
  if (layout == FloatLayout{4, 32, 23, 8, 23, 127}) return number(header, Stored::float32, "");
  Datatype type = number(header, std::nullopt, kUnusual);
  if (layout == FloatLayout{2, 16, 10, 5, 10, 15}) {
    type = number(header, Stored::float32, "");
    type.kind = Datatype::Kind::half;
  }
  return type;
}

Datatype text(const Header& header, Datatype::Kind kind) {
  constexpr unsigned kBlanks = 2;
  Datatype type = unread(header, "");
  type.kind = kind;
  type.padded_with_blanks = (header.bits & 0x0Fu) == kBlanks;
  return type;
}

/// MATLAB and h5py write complex numbers as a structure of two members.
Datatype compound(const Header& header, Cursor& in) {
  const std::string first = in.text();
  const bool complex = (header.bits & 0xFFFFu) == 2 && (first == "real" || first == "r");
  return unread(header, complex ? "complex" : "of a compound type");
}

}  // namespace

Result<Datatype> read_datatype(Cursor in) {
  Header header = read_header(in);
  if (header.type_class == kEnumeration) {  // numbers of the type that stands inside
    const std::uint32_t size = header.size;
    header = read_header(in);
    if (header.type_class != kFixedPoint || header.size != size) return damaged("its datatype is broken");
  }
  Datatype type;
  switch (header.type_class) {
    case kFixedPoint:
      type = fixed_point(header, in);
      break;
    case kFloatingPoint:
      type = floating_point(header, in);
      break;
    case kString:
      type = text(header, Datatype::Kind::text);
      break;
    case kCompound:
      type = compound(header, in);
      break;
    case kReference:
      type = unread(header, "of references to regions");
      if ((header.bits & 0x0Fu) == 0) type.kind = Datatype::Kind::reference;
      break;
    case kVariableLength:
      type = (header.bits & 0x0Fu) == 1 ? text(header, Datatype::Kind::long_text)
                                        : unread(header, "of lists of varying length");
      break;
    case kTime:
      type = unread(header, "of a time type");
      break;
    case kBitField:
      type = unread(header, "of bit fields");
      break;
    case kOpaque:
      type = unread(header, "of an opaque type");
      break;
    case kArray:
      type = unread(header, "of an array type");
      break;
    default:
      type = unread(header, fmt::format("of datatype class {}", header.type_class));
  }
  if (!in.ok() || type.size == 0) return damaged("its datatype is broken");
  const bool heap = type.kind == Datatype::Kind::long_text;
  if (heap && type.size != 4 + in.sizes().address + 4) return damaged("its datatype is broken");
  if (type.kind == Datatype::Kind::reference && type.size != in.sizes().address) {
    return damaged("its datatype is broken");
  }
  return type;
}

}  // namespace mbk::hdf5
