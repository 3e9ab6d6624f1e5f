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
  unsigned version;
  unsigned bits;  ///< what they mean depends on the class
  std::uint32_t size;
};

Header read_header(Cursor& in) {
  Header header{};
  const unsigned first = in.byte();
  header.type_class = first & 0x0Fu;
  header.version = first >> 4u;
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
                "of integers with an unsupported layout");
}

/// An IEEE 754 layout: sign, exponent, mantissa with a leading 1 that is not stored.
struct FloatLayout {
  std::uint32_t size, precision, exponent_at, exponent_bits, mantissa_bits, bias;
  bool operator==(const FloatLayout&) const = default;
};

Datatype floating_point(const Header& header, Cursor& in) {
  constexpr std::string_view kUnusual = "of floating-point numbers in a format other than IEEE 754";
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

constexpr int kDeepest = 8;                 ///< types within types
constexpr std::size_t kMaxMembers = 4096;   ///< of a compound
constexpr std::size_t kMaxDimensions = 32;  ///< of an array in an element

Result<Datatype> any_type(Cursor& in, int depth);

/// A name in a compound or an enumeration, filled up to eight bytes before version 3.
std::string name_of(Cursor& in, unsigned version) {
  const std::size_t begin = in.at();
  std::string name = in.text();
  if (version < 3) in.skip((8 - (in.at() - begin) % 8) % 8);
  return name;
}

/// Numbers of the inner type; their names are discarded.
Result<Datatype> enumeration(const Header& header, Cursor& in, int depth) {
  auto type = any_type(in, depth + 1);
  if (!type) return type;
  if (type->kind != Datatype::Kind::number || type->size != header.size) return damaged("its datatype is broken");
  const unsigned count = header.bits & 0xFFFFu;
  for (unsigned i = 0; i < count && in.ok(); ++i) name_of(in, header.version);
  in.skip(std::uint64_t{count} * header.size);
  return type;
}

/// An array in every element (IV.A.2.d, class 10).
Result<Datatype> array(const Header& header, Cursor& in, int depth) {
  const std::size_t rank = in.byte();
  if (header.version < 3) in.skip(3);
  std::vector<std::uint64_t> shape;
  std::uint64_t count = 1;
  bool sound = rank >= 1 && rank <= kMaxDimensions;
  for (std::size_t i = 0; sound && i < rank; ++i) {
    shape.push_back(in.dword());
    sound = shape.back() > 0 && multiply(count, shape.back(), count);
  }
  if (header.version < 3) in.skip(4 * rank);
  if (!sound || !in.ok()) return damaged("its datatype is broken");
  auto type = any_type(in, depth + 1);
  if (!type) return type;
  std::uint64_t size = 0;
  if (!multiply(count, type->size, size) || size != header.size) return damaged("its datatype is broken");
  if (type->kind == Datatype::Kind::compound) return unread(header, "of arrays of a compound type");
  type->size = header.size;
  type->values *= static_cast<std::uint32_t>(count);  // no more than bytes
  type->array.insert(type->array.begin(), shape.begin(), shape.end());
  if (type->array.size() > kMaxDimensions) return damaged("its datatype is broken");
  return type;
}

/// One member of a compound, in the versions 1 to 3.
Result<Member> member(const Header& header, Cursor& in, int depth) {
  constexpr unsigned kPadded = 2;
  Member one;
  one.name = name_of(in, header.version);
  one.offset = header.version <= kPadded ? in.dword() : in.number(bytes_for(header.size));
  std::vector<std::uint64_t> shape;
  std::uint64_t count = 1;
  if (header.version == 1) {  // arrays were said here
    const std::size_t rank = in.byte();
    in.skip(3 + 4 + 4);
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint64_t side = in.dword();
      if (i >= rank) continue;
      shape.push_back(side);
      if (side == 0 || !multiply(count, side, count)) return damaged("its datatype is broken");
    }
    if (rank > 4) return damaged("its datatype is broken");
  }
  auto type = MBK_TRY(any_type(in, depth + 1));
  std::uint64_t size = 0;
  if (!multiply(count, type.size, size) || size > header.size || one.offset > header.size - size) {
    return damaged("a member of its datatype lies outside of the element");
  }
  one.type = std::move(type);
  if (!shape.empty() && one.type.kind == Datatype::Kind::compound) {
    one.type = Datatype{};
    one.type.what = "of arrays of a compound type";
  }
  one.type.size = static_cast<std::uint32_t>(size);
  one.type.values *= static_cast<std::uint32_t>(count);
  one.type.array.insert(one.type.array.begin(), shape.begin(), shape.end());
  return one;
}

/// A table's row. MATLAB and h5py write complex numbers as a structure of two members.
Result<Datatype> compound(const Header& header, Cursor& in, int depth) {
  Datatype type = unread(header, "");
  type.kind = Datatype::Kind::compound;
  const unsigned count = header.bits & 0xFFFFu;
  std::uint64_t taken = 0;
  for (unsigned i = 0; i < count; ++i) {
    auto one = MBK_TRY(member(header, in, depth));
    taken += one.type.size;
    if (taken > header.size) return damaged("members of its datatype overlap");
    for (const Member& other : type.members) {
      if (other.name == one.name) return damaged(fmt::format("its datatype has two members '{}'", one.name));
    }
    type.members.push_back(std::move(one));
    if (type.members.size() > kMaxMembers)
      return unread(header, fmt::format("a table of more than {} columns", kMaxMembers));
  }
  if (count == 0) return damaged("its datatype is broken");
  const std::string& first = type.members.front().name;
  if (count == 2 && (first == "real" || first == "r")) return unread(header, "complex");
  return type;
}

Result<Datatype> reference(const Header& header, Cursor& in) {
  Datatype type = unread(header, "of region references");
  if ((header.bits & 0x0Fu) == 0) {
    type.kind = Datatype::Kind::reference;
    if (type.size != in.sizes().address) return damaged("its datatype is broken");
  }
  return type;
}

Result<Datatype> variable_length(const Header& header, Cursor& in, int depth) {
  constexpr unsigned kText = 1;
  const auto inner = any_type(in, depth + 1);  // only its end is used
  if (!inner) return inner;
  if ((header.bits & 0x0Fu) != kText) return unread(header, "of variable-length lists");
  if (header.size != 4 + in.sizes().address + 4) return damaged("its datatype is broken");
  return text(header, Datatype::Kind::long_text);
}

/// An unsupported type whose description has `bytes` bytes.
Datatype passed_over(const Header& header, Cursor& in, std::uint64_t bytes, std::string what) {
  in.skip(bytes);
  return unread(header, std::move(what));
}

Result<Datatype> type_of(const Header& header, Cursor& in, int depth) {
  switch (header.type_class) {
    case kFixedPoint:
      return fixed_point(header, in);
    case kFloatingPoint:
      return floating_point(header, in);
    case kString:
      return text(header, Datatype::Kind::text);
    case kCompound:
      return compound(header, in, depth);
    case kReference:
      return reference(header, in);
    case kEnumeration:
      return enumeration(header, in, depth);
    case kVariableLength:
      return variable_length(header, in, depth);
    case kArray:
      return array(header, in, depth);
    case kTime:
      return passed_over(header, in, 2, "of a time type");
    case kBitField:
      return passed_over(header, in, 4, "of bit fields");
    case kOpaque:
      return passed_over(header, in, ((header.bits & 0xFFu) + 7) / 8 * 8, "of an opaque type");
    default:
      if (depth > 0) return damaged(fmt::format("datatype class {} is unknown", header.type_class));
      return unread(header, fmt::format("of datatype class {}", header.type_class));
  }
}

Result<Datatype> any_type(Cursor& in, int depth) {
  if (depth > kDeepest) return damaged("its datatype is nested too deeply");
  const Header header = read_header(in);
  auto type = type_of(header, in, depth);
  if (type && (!in.ok() || type->size == 0)) return damaged("its datatype is broken");
  return type;
}

}  // namespace

Result<Datatype> read_datatype(Cursor in) {
  return any_type(in, 0);
}

}  // namespace mbk::hdf5
