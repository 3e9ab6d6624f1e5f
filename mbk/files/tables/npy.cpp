#include "mbk/files/tables/npy.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/byte_view.h"
#include "mbk/files/contents/memory.h"
#include "mbk/files/contents/said_rates.h"
#include "mbk/files/contents/utf16.h"
#include "mbk/files/tables/npy_header.h"

namespace mbk::recording {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::string_view kEnd = ".npy";
constexpr std::size_t kMaxDimensions = 8;  ///< of an array that is read
constexpr std::string_view kAgain = "save it again with numpy.save";

/// The parts of a file: what its header says, and its numbers.
struct Npy {
  NpyHeader header;
  std::span<const std::byte> data;
};

Result<Npy> parse(std::span<const std::byte> file) {
  constexpr std::size_t kVersion = 6, kLength = 8;
  const ByteView view{file, std::endian::native == std::endian::big};
  if (file.size() < kLength + 2) return bad_data("the NumPy array is truncated in its header", std::string(kAgain));
  const int major = std::to_integer<int>(file[kVersion]);
  if (major < 1 || major > 3) {
    return bad_data(fmt::format("the NumPy array has format {}.{}; 1.0 to 3.0 are supported", major,
                                std::to_integer<int>(file[kVersion + 1])),
                    std::string(kAgain));
  }
  const std::size_t begin = kLength + (major == 1 ? 2 : 4);
  if (file.size() < begin) return bad_data("the NumPy array is truncated in its header", std::string(kAgain));
  const std::uint64_t length = major == 1 ? view.at<std::uint16_t>(kLength) : view.at<std::uint32_t>(kLength);
  if (!view.holds(begin, length)) return bad_data("the NumPy array is truncated in its header", std::string(kAgain));
  auto header = MBK_TRY(parse_npy_header(view.part(begin, static_cast<std::size_t>(length)).text()));
  return Npy{std::move(header), file.subspan(begin + static_cast<std::size_t>(length))};
}

/// Numbers of the stored type, one after the other.
using Read = double (*)(const ByteView&, std::size_t);

template <class Stored>
double read_as(const ByteView& view, std::size_t at) {
  return static_cast<double>(view.at<Stored>(at));
}

double read_half(const ByteView& view, std::size_t at) {
  return static_cast<double>(static_cast<float>(Eigen::numext::bit_cast<Eigen::half>(view.at<std::uint16_t>(at))));
}

double read_logical(const ByteView& view, std::size_t at) {
  return view.bytes[at] != std::byte{0} ? 1.0 : 0.0;
}

Read reader_of(const NpyField& field) {
  switch (field.kind) {
    case 'f':
      return field.size == 8   ? read_as<double>
             : field.size == 4 ? read_as<float>
             : field.size == 2 ? read_half
                               : Read(nullptr);
    case 'i':
      return field.size == 8   ? read_as<std::int64_t>
             : field.size == 4 ? read_as<std::int32_t>
             : field.size == 2 ? read_as<std::int16_t>
             : field.size == 1 ? read_as<std::int8_t>
                               : Read(nullptr);
    case 'u':
      return field.size == 8   ? read_as<std::uint64_t>
             : field.size == 4 ? read_as<std::uint32_t>
             : field.size == 2 ? read_as<std::uint16_t>
             : field.size == 1 ? read_as<std::uint8_t>
                               : Read(nullptr);
    case 'b':
      return field.size == 1 ? read_logical : Read(nullptr);
    default:
      return nullptr;
  }
}

/// The unit of dates and durations: "ns" of "<M8[ns]", and how many of them are one second; 0 where it is another.
struct TimeUnit {
  std::string name;
  double each_second = 0.0;
};
TimeUnit time_unit(std::string_view type) {
  const auto open = type.find('[');
  if (open == type.npos || !type.ends_with(']')) return {};
  const std::string name(type.substr(open + 1, type.size() - open - 2));
  const double each = name == "s" ? 1.0 : name == "ms" ? 1e3 : name == "us" ? 1e6 : name == "ns" ? 1e9 : 0.0;
  return {name, each};
}

Error object_error(const NpyField& field, const std::string& name) {
  const bool object = field.kind == 'O';
  return bad_data(object ? std::string("it contains Python objects, which are not supported")
                         : fmt::format("its numbers have the type '{}', which is not supported", field.type),
                  object ? "save each array of numbers separately, as in numpy.savez('trial.npz', time=time, x=x, F=F)"
                         : "save real numbers, as in numpy.savez('trial.npz', x=x.astype(float))",
                  fmt::format("array '{}'", name))
      .value();
}

class NpyDecoder {
 public:
  explicit NpyDecoder(Contents& contents) : contents_(contents) {}

  /// @param name  of the array; fields are "name.field", or "field" where it is ""
  Result<void> add(std::span<const std::byte> file, const std::string& name) {
    const auto npy = parse(file);
    if (!npy) return tl::unexpected(npy.error().in(place(name)));
    const NpyHeader& header = npy->header;
    std::uint64_t elements = 1;
    for (const std::uint64_t length : header.shape) {
      if (length != 0 && elements > std::numeric_limits<std::uint64_t>::max() / length) return cut(name, header, *npy);
      elements *= length;
    }
    if (header.element == 0 || elements > npy->data.size() / header.element) {
      const bool object = header.fields.size() == 1 && header.fields.front().kind == 'O';
      if (header.element > 0 && !object) return cut(name, header, *npy);
    }
    std::vector<std::uint64_t> sizes = header.shape;
    if (sizes.size() > 2) std::erase(sizes, std::uint64_t{1});
    for (const NpyField& field : header.fields) {
      MBK_TRY(take(field, header, sizes, elements, npy->data, name));
    }
    return {};
  }

 private:
  static std::string place(const std::string& name) { return fmt::format("array '{}'", name.empty() ? "array" : name); }

  static tl::unexpected<Error> cut(const std::string& name, const NpyHeader& header, const Npy& npy) {
    return bad_data(fmt::format("it is truncated: {} elements of {} bytes need more than the {} bytes present",
                                fmt::join(header.shape, "×"), header.element, npy.data.size()),
                    "copy it again from where it was recorded", place(name));
  }

  Result<void> take(const NpyField& field, const NpyHeader& header, const std::vector<std::uint64_t>& sizes,
                    std::uint64_t elements, std::span<const std::byte> data, const std::string& prefix) {
    std::string name = prefix.empty() ? field.name : field.name.empty() ? prefix : prefix + "." + field.name;
    if (name.empty()) name = "array";
    if ((field.kind == 'U' || field.kind == 'S') && sizes.size() < 2 && field.count == 1) {
      take_texts(field, header, elements, data, std::move(name));
      return {};
    }
    const bool time = field.kind == 'M' || field.kind == 'm';
    const TimeUnit unit = time ? time_unit(field.type) : TimeUnit{};
    const Read read = time && unit.each_second > 0.0 && field.size == 8 ? read_as<std::int64_t> : reader_of(field);
    const std::size_t dimensions = sizes.size() + (field.count > 1 ? 1 : 0);
    const bool block = dimensions > 2 && !header.structured && !time && field.size > 1 && dimensions <= kMaxDimensions;
    if (read != nullptr && block) return take_block(field, header, elements, data, read, std::move(name));
    if (read == nullptr || dimensions > 2) {
      Array& array = contents_.arrays.emplace_back();
      array.name = name;
      array.obstacle = read == nullptr ? object_error(field, name)
                                       : bad_data(fmt::format("it has {} dimensions", dimensions),
                                                  "save arrays of one or two dimensions", place(name))
                                             .value();
      contents_.notes.push_back(fmt::format("array '{}' was ignored: {}", name, array.obstacle->message));
      return {};
    }
    const std::uint64_t rows = sizes.empty() ? 1 : sizes[0];
    const std::uint64_t columns = sizes.size() == 2 ? sizes[1] : field.count;
    if (rows > (std::uint64_t{1} << 40) || columns > (std::uint64_t{1} << 40)) {
      return bad_data(fmt::format("its stated shape is {}×{}", rows, columns), std::string(kAgain), place(name));
    }
    MBK_TRY(check_memory(8 * rows * columns));
    const ByteView view{data, field.big_endian != (std::endian::native == std::endian::big)};
    Matrix values(static_cast<Index>(rows), static_cast<Index>(columns));
    if (time) {
      take_times(field, header, view, unit, name, values);
    } else if (field.kind == 'f' && field.size == 8 && !header.structured && (header.fortran_order || columns == 1)) {
      view.copy_doubles<double>(static_cast<std::size_t>(values.size()), values.data());
    } else {
      for (Index r = 0; r < values.rows(); ++r) {
        for (Index c = 0; c < values.cols(); ++c) values(r, c) = read(view, offset(field, header, values, r, c));
      }
    }
    Array& array = contents_.arrays.emplace_back();
    array.name = std::move(name);
    if (field.kind == 'i' && field.size == 8) put_rests<std::int64_t>(field, header, view, values, array.rests);
    if (field.kind == 'u' && field.size == 8) put_rests<std::uint64_t>(field, header, view, values, array.rests);
    array.unit = field.kind == 'M' ? "s" : unit.name;
    if (header.shape.size() > 2) array.shape = header.shape;
    array.values =
        values.cols() == 1 ? SharedMatrix::of_column(Vector(values.reshaped())) : SharedMatrix(std::move(values));
    return {};
  }

  /// An array of more than two dimensions, in the order of the file.
  Result<void> take_block(const NpyField& field, const NpyHeader& header, std::uint64_t elements,
                          std::span<const std::byte> data, Read read, std::string name) {
    MBK_TRY(check_memory(8 * elements));
    const ByteView view{data, field.big_endian != (std::endian::native == std::endian::big)};
    Matrix values(static_cast<Index>(elements), 1);
    for (Index k = 0; k < values.rows(); ++k) {
      values(k, 0) = read(view, static_cast<std::size_t>(k) * header.element + field.offset);
    }
    Array& array = contents_.arrays.emplace_back();
    array.name = std::move(name);
    array.shape = header.shape;
    array.row_major = !header.fortran_order;
    if (field.kind == 'i' && field.size == 8) put_rests<std::int64_t>(field, header, view, values, array.rests);
    if (field.kind == 'u' && field.size == 8) put_rests<std::uint64_t>(field, header, view, values, array.rests);
    array.values = SharedMatrix(std::move(values));
    return {};
  }

  template <class Stored>
  static void put_rests(const NpyField& field, const NpyHeader& header, const ByteView& view, const Matrix& values,
                        Rests& rests) {
    for (Index c = 0; c < values.cols(); ++c) {
      for (Index r = 0; r < values.rows(); ++r) {
        if (std::abs(values(r, c)) < kExactWhole) continue;
        const auto stored = view.at<Stored>(offset(field, header, values, r, c));
        rests.put(static_cast<std::size_t>(c * values.rows() + r), rest_of(stored),
                  static_cast<std::size_t>(values.size()));
      }
    }
  }

  /// Position of the number of a row and column.
  static std::size_t offset(const NpyField& field, const NpyHeader& header, const Matrix& values, Index row,
                            Index column) {
    if (field.count > 1) {  // each element contains all columns
      return static_cast<std::size_t>(row) * header.element + field.offset +
             static_cast<std::size_t>(column) * field.size;
    }
    const Index element = header.fortran_order ? row + column * values.rows() : row * values.cols() + column;
    return static_cast<std::size_t>(element) * header.element + field.offset;
  }

  /// Durations in their unit; dates in seconds since the midnight before the first, so that no digit is lost.
  void take_times(const NpyField& field, const NpyHeader& header, const ByteView& view, const TimeUnit& unit,
                  const std::string& name, Matrix& values) {
    constexpr std::int64_t kNotATime = std::numeric_limits<std::int64_t>::min();
    const auto day = static_cast<std::int64_t>(86'400.0 * unit.each_second);
    std::optional<std::int64_t> midnight;
    for (Index r = 0; r < values.rows(); ++r) {
      for (Index c = 0; c < values.cols(); ++c) {
        const auto stored = view.at<std::int64_t>(offset(field, header, values, r, c));
        if (stored == kNotATime) {
          values(r, c) = std::numeric_limits<double>::quiet_NaN();
        } else if (field.kind == 'm') {
          values(r, c) = static_cast<double>(stored);
        } else {
          if (!midnight) midnight = stored - ((stored % day) + day) % day;
          values(r, c) = (static_cast<double>(stored) - static_cast<double>(*midnight)) / unit.each_second;
          if (std::abs(stored / 2 - *midnight / 2) < (std::int64_t{1} << 61)) {
            values(r, c) = static_cast<double>(stored - *midnight) / unit.each_second;
          }
        }
      }
    }
    if (!midnight) return;
    const std::chrono::sys_days days{std::chrono::days(*midnight / day)};
    const std::chrono::year_month_day date{days};
    contents_.notes.push_back(fmt::format(
        "'{}' contains dates and times, which were read as seconds since {:04}-{:02}-{:02} 00:00", name,
        static_cast<int>(date.year()), static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day())));
  }

  void take_texts(const NpyField& field, const NpyHeader& header, std::uint64_t elements,
                  std::span<const std::byte> data, std::string name) {
    Text text{std::move(name), {}};
    const ByteView view{data, field.big_endian != (std::endian::native == std::endian::big)};
    for (std::uint64_t k = 0; k < elements; ++k) {
      const ByteView one = view.part(static_cast<std::size_t>(k) * header.element + field.offset, field.size);
      text.lines.push_back(printable(field.kind == 'S' ? one.padded_text() : from_utf32(one)));
    }
    contents_.texts.push_back(std::move(text));
  }

  static std::string from_utf32(const ByteView& view) {
    constexpr std::uint32_t kFirstPair = 0x10000, kLast = 0x10FFFF;
    std::u16string text;
    for (std::size_t k = 0; k + 4 <= view.size(); k += 4) {
      const auto code = view.at<std::uint32_t>(k);
      if (code == 0) break;
      if (code < kFirstPair) {
        text += static_cast<char16_t>(code);
      } else if (code <= kLast) {
        text += static_cast<char16_t>(0xD800 + ((code - kFirstPair) >> 10U));
        text += static_cast<char16_t>(0xDC00 + ((code - kFirstPair) & 0x3FFU));
      } else {
        text += u'\uFFFD';
      }
    }
    return utf8_from_utf16(text);
  }

  Contents& contents_;
};

bool is_array(const ZipMember& member) {
  return member.name.ends_with(kEnd);
}

}  // namespace

bool looks_like_npy(std::span<const std::byte> file) {
  return file.size() >= kMagic.size() && std::memcmp(file.data(), kMagic.data(), kMagic.size()) == 0;
}

bool looks_like_npz(const ZipArchive& archive) {
  return std::ranges::any_of(archive.members(), is_array);
}

Result<Contents> decode_npy(std::span<const std::byte> file) {
  Contents contents;
  contents.format = "NumPy";
  MBK_TRY(NpyDecoder(contents).add(file, ""));
  const auto usable = [](const Array& array) { return !array.obstacle; };
  if (std::ranges::none_of(contents.arrays, usable)) {
    if (!contents.arrays.empty()) return tl::unexpected(*contents.arrays.front().obstacle);
    return bad_data("the file contains no numbers", "save arrays of numbers");
  }
  // The fields of a list of records are the columns of a table.
  const Index rows = std::ranges::find_if(contents.arrays, usable)->values.rows();
  const bool columns = std::ranges::all_of(contents.arrays, [rows](const Array& array) {
    return array.obstacle || (array.values.cols() == 1 && array.values.rows() == rows);
  });
  contents.table = columns && contents.texts.empty() && contents.arrays.front().name != "array";
  return contents;
}

Result<Contents> decode_npz(const ZipArchive& archive) {
  Contents contents;
  contents.format = "NumPy archive";
  for (const ZipMember& member : archive.members()) {
    if (!is_array(member)) {
      contents.notes.push_back(
          fmt::format("'{}' in the archive is not a NumPy array and was ignored", printable(member.name)));
      continue;
    }
    const auto bytes = MBK_TRY(archive.read(member.name));
    const std::string name = printable(member.name.substr(0, member.name.size() - kEnd.size()));
    if (!looks_like_npy(bytes.bytes())) {
      return bad_data("it has no NumPy signature", std::string(kAgain), fmt::format("array '{}'", name));
    }
    MBK_TRY(NpyDecoder(contents).add(bytes.bytes(), name.empty() ? "array" : name));
  }
  give_rates(contents);
  return contents;
}

}  // namespace mbk::recording
