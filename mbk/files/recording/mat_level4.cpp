#include "mbk/files/recording/mat_level4.h"

#include <fmt/format.h>

#include <bit>
#include <cctype>
#include <optional>

#include "mbk/files/contents/byte_view.h"
#include "mbk/files/contents/said_rates.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kHeaderSize = 20;
constexpr std::uint32_t kLongestNameInFile = 256;

/// type = 1000 M + 100 O + 10 P + T: byte order, always 0, number format, kind of matrix.
struct Header {
  std::uint32_t format = 0;
  std::uint32_t kind = 0;
  std::uint32_t rows = 0;
  std::uint32_t columns = 0;
  bool complex = false;
  std::string name;
  std::uint64_t data_offset = 0;
  std::uint64_t entries = 0;
};

constexpr std::uint64_t kBytesOf[] = {8, 4, 4, 2, 2, 1};

bool possible_type(std::uint32_t type, std::uint32_t byte_order) {
  return type / 1000 == byte_order && type % 1000 / 100 == 0 && type % 100 / 10 <= 5 && type % 10 <= 2;
}

/// Whether the file's byte order is not this processor's; nothing where the first header is of neither.
std::optional<bool> byte_order(std::span<const std::byte> file) {
  if (file.size() < kHeaderSize) return std::nullopt;
  constexpr bool kLittle = std::endian::native == std::endian::little;
  for (const bool swapped : {false, true}) {
    const bool big = kLittle == swapped;
    if (possible_type(ByteView{file, swapped}.at<std::uint32_t>(0), big ? 1 : 0)) return swapped;
  }
  return std::nullopt;
}

std::optional<Header> header_at(ByteView file, std::uint64_t offset) {
  if (!file.holds(offset, kHeaderSize)) return std::nullopt;
  const auto at = [&](std::size_t i) { return file.at<std::uint32_t>(static_cast<std::size_t>(offset) + 4 * i); };
  constexpr bool kLittle = std::endian::native == std::endian::little;
  if (!possible_type(at(0), kLittle == file.swapped ? 1 : 0) || at(3) > 1) return std::nullopt;
  Header header{at(0) % 100 / 10, at(0) % 10, at(1), at(2), at(3) == 1, "", 0, 0};
  const std::uint32_t name_size = at(4);
  if (name_size == 0 || name_size > kLongestNameInFile || !file.holds(offset + kHeaderSize, name_size))
    return std::nullopt;
  header.name = file.part(static_cast<std::size_t>(offset) + kHeaderSize, name_size).padded_text();
  if (header.name.empty()) return std::nullopt;
  for (const char c : header.name) {
    if (std::isprint(static_cast<unsigned char>(c)) == 0) return std::nullopt;
  }
  header.data_offset = offset + kHeaderSize + name_size;
  header.entries = std::uint64_t{header.rows} * header.columns;
  return header;
}

void copy_doubles(ByteView data, std::uint32_t format, std::size_t count, double* out) {
  switch (format) {
    case 0:
      return data.copy_doubles<double>(count, out);
    case 1:
      return data.copy_doubles<float>(count, out);
    case 2:
      return data.copy_doubles<std::int32_t>(count, out);
    case 3:
      return data.copy_doubles<std::int16_t>(count, out);
    case 4:
      return data.copy_doubles<std::uint16_t>(count, out);
    default:
      return data.copy_doubles<std::uint8_t>(count, out);
  }
}

}  // namespace

bool looks_like_mat_level4(std::span<const std::byte> file) {
  const auto swapped = byte_order(file);
  return swapped && header_at({file, *swapped}, 0).has_value();
}

Result<Contents> decode_mat_level4(std::span<const std::byte> bytes) {
  constexpr auto kRemedy = "the file is damaged or truncated: copy it again from where it was recorded";
  const ByteView file{bytes, byte_order(bytes).value_or(false)};
  Contents contents;
  contents.format = "MAT v4";
  for (std::uint64_t offset = 0; offset < file.size();) {
    const auto header = header_at(file, offset);
    if (!header) return bad_data(fmt::format("no variable begins at byte {}", offset), kRemedy);
    const std::string where = fmt::format("variable '{}'", header->name);
    const std::uint64_t left = file.size() - header->data_offset;
    const std::uint64_t each = kBytesOf[header->format] * (header->complex ? 2 : 1);
    if (header->entries > left / each) {
      return bad_data(
          fmt::format("dimensions {}×{} need more than the remaining {} bytes", header->rows, header->columns, left),
          kRemedy, where);
    }
    const std::uint64_t size = header->entries * each;
    if (header->complex || header->kind != 0) {
      contents.notes.push_back(fmt::format("variable '{}' is {} and was ignored", header->name,
                                           header->kind == 1   ? "text"
                                           : header->kind == 2 ? "a sparse matrix"
                                                               : "complex"));
    } else {
      Array& array = contents.arrays.emplace_back();
      array.name = header->name;
      array.values.resize(header->rows, header->columns);
      copy_doubles(file.part(static_cast<std::size_t>(header->data_offset), static_cast<std::size_t>(size)),
                   header->format, static_cast<std::size_t>(header->entries), array.values.data());
    }
    offset = header->data_offset + size;
  }
  give_rates(contents);
  return contents;
}

}  // namespace mbk::recording
