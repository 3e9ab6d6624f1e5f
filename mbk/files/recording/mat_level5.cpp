#include "mbk/files/recording/mat_level5.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/byte_view.h"
#include "mbk/files/contents/lines.h"
#include "mbk/files/contents/memory.h"
#include "mbk/files/contents/said_rates.h"
#include "mbk/files/contents/utf16.h"
#include "mbk/files/recording/inflate.h"
#include "mbk/files/recording/mat_object.h"
#include "mbk/files/recording/without_ones.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kHeaderSize = 128;
constexpr std::size_t kMaxDimensions = 8;   ///< of an array that is read
constexpr int kDeepest = 16;                ///< structures within structures
constexpr std::size_t kMaxElements = 1024;  ///< of a structure or cell array that is still read
constexpr std::size_t kMaxLines = 100'000;  ///< of text in one variable

// Types of data elements.
constexpr std::uint32_t kInt8 = 1, kUint8 = 2, kInt16 = 3, kUint16 = 4, kInt32 = 5, kUint32 = 6, kSingle = 7,
                        kDouble = 9, kInt64 = 12, kUint64 = 13, kMatrix = 14, kCompressed = 15, kUtf8 = 16, kUtf16 = 17;
// Classes of arrays.
constexpr std::uint32_t kCellClass = 1, kStructClass = 2, kObjectClass = 3, kCharClass = 4, kSparseClass = 5,
                        kDoubleClass = 6, kInt8Class = 8, kUint8Class = 9, kUint64Class = 15, kFunctionClass = 16,
                        kOpaqueClass = 17;

tl::unexpected<Error> damaged(std::string what) {
  return bad_data(std::move(what), "the file is damaged or truncated: copy it again from where it was recorded");
}

struct Element {
  std::uint32_t type = 0;
  ByteView data;
};

/// The elements that follow each other in a segment of bytes.
struct Elements {
  ByteView bytes;
  std::size_t offset = 0;

  [[nodiscard]] bool at_end() const { return offset >= bytes.size(); }

  Result<Element> next(std::string_view what) {
    if (!bytes.holds(offset, 8)) return damaged(fmt::format("{} is missing at byte {}", what, offset));
    const auto word = bytes.at<std::uint32_t>(offset);
    Element element;
    if (const std::uint32_t small = word >> 16; small != 0) {  // a tag of 4 bytes with up to 4 bytes of data
      if (small > 4) return damaged(fmt::format("{} has a broken tag", what));
      element = {word & 0xFFFF, bytes.part(offset + 4, small)};
      offset += 8;
      return element;
    }
    const std::uint64_t size = bytes.at<std::uint32_t>(offset + 4);
    if (!bytes.holds(offset + 8, size)) {
      return damaged(fmt::format("{} claims {} bytes, but {} remain", what, size, bytes.size() - offset - 8));
    }
    element = {word, bytes.part(offset + 8, static_cast<std::size_t>(size))};
    const std::size_t padded = element.type == kCompressed ? size : (size + 7) / 8 * 8;
    offset = std::min(offset + 8 + padded, bytes.size());
    return element;
  }
};

std::size_t size_of(std::uint32_t type) {
  switch (type) {
    case kInt8:
    case kUint8:
      return 1;
    case kInt16:
    case kUint16:
      return 2;
    case kInt32:
    case kUint32:
    case kSingle:
      return 4;
    case kDouble:
    case kInt64:
    case kUint64:
      return 8;
    default:
      return 0;
  }
}

void copy_doubles(const Element& element, std::size_t count, double* out) {
  switch (element.type) {
    case kInt8:
      return element.data.copy_doubles<std::int8_t>(count, out);
    case kUint8:
      return element.data.copy_doubles<std::uint8_t>(count, out);
    case kInt16:
      return element.data.copy_doubles<std::int16_t>(count, out);
    case kUint16:
      return element.data.copy_doubles<std::uint16_t>(count, out);
    case kInt32:
      return element.data.copy_doubles<std::int32_t>(count, out);
    case kUint32:
      return element.data.copy_doubles<std::uint32_t>(count, out);
    case kSingle:
      return element.data.copy_doubles<float>(count, out);
    case kInt64:
      return element.data.copy_doubles<std::int64_t>(count, out);
    case kUint64:
      return element.data.copy_doubles<std::uint64_t>(count, out);
    default:
      return element.data.copy_doubles<double>(count, out);
  }
}

template <class Stored>
void put_rests(const Element& element, Array& array) {
  const auto count = static_cast<std::size_t>(array.values.size());
  for (std::size_t k = 0; k < count; ++k) {
    if (std::abs(array.values.data()[k]) < kExactWhole) continue;
    array.rests.put(k, rest_of(element.data.at<Stored>(k * sizeof(Stored))), count);
  }
}

/// The part of a matrix element before its data.
struct Header {
  std::uint32_t array_class = 0;
  bool complex = false;
  std::vector<std::uint64_t> dimensions;
  std::string name;

  /// Number of entries, or nothing where it overflows.
  [[nodiscard]] std::optional<std::uint64_t> count() const {
    std::uint64_t product = 1;
    for (const std::uint64_t d : dimensions) {
      if (__builtin_mul_overflow(product, d, &product)) return std::nullopt;
    }
    return product;
  }
};

class Decoder {
 public:
  /// @param bytes  of the file, if matrices may refer to them
  explicit Decoder(std::shared_ptr<Buffer> bytes) : bytes_(std::move(bytes)) {}
  Contents contents;

  Result<void> top_level(Elements elements) {
    while (!elements.at_end()) {
      const std::size_t offset = elements.offset;
      const auto element = MBK_TRY(elements.next(fmt::format("the variable at byte {}", offset)));
      if (auto done = variable(element); !done) {
        return tl::unexpected(done.error().in(name_.empty() ? fmt::format("variable at byte {}", offset)
                                                            : fmt::format("variable '{}'", name_)));
      }
    }
    return {};
  }

 private:
  Result<void> variable(const Element& element) {
    name_.clear();
    if (element.type == kMatrix) return matrix(element.data, "", 0);
    if (element.type != kCompressed) return damaged(fmt::format("element type {} is not a variable", element.type));
    contents.format = "MAT v7";
    const bool swapped = element.data.swapped;
    auto inflated = MBK_TRY(
        inflate_exactly(element.data.bytes, [swapped](std::span<const std::byte, 8> tag) -> Result<std::uint64_t> {
          const ByteView view{tag, swapped};
          if (view.at<std::uint32_t>(0) != kMatrix) return damaged("compressed data does not hold a variable");
          return std::uint64_t{view.at<std::uint32_t>(4)} + 8;
        }));
    const std::shared_ptr<Buffer> file = std::exchange(bytes_, std::make_shared<Buffer>(std::move(inflated)));
    auto done = matrix({bytes_->bytes().subspan(8), swapped}, "", 0);
    bytes_ = file;
    return done;
  }

  /// One matrix element; `outer` is the name of a field, or empty for a variable.
  Result<void> matrix(ByteView body, const std::string& outer, int depth) {
    if (body.size() == 0) return {};  // an empty field
    if (depth > kDeepest) return damaged("structures are nested too deeply");
    Elements elements{body};
    const auto header = MBK_TRY(read_header(elements, outer));
    if (depth == 0) name_ = header.name;
    if (header.name.empty()) return {};  // where MATLAB keeps the insides of its objects
    return data(header, elements, depth);
  }

  static Result<Header> read_header(Elements& elements, const std::string& outer) {
    const auto flags = MBK_TRY(elements.next("its array flags"));
    if (flags.type != kUint32 || flags.data.size() != 8) return damaged("its array flags are broken");
    Header header;
    header.array_class = flags.data.at<std::uint32_t>(0) & 0xFF;
    header.complex = (flags.data.at<std::uint32_t>(0) & 0x0800) != 0;

    if (header.array_class != kOpaqueClass) {
      const auto dimensions = MBK_TRY(elements.next("its dimensions"));
      const bool whole = dimensions.type == kInt32 || dimensions.type == kUint32;  // some programs write the other
      if (!whole || dimensions.data.size() < 8 || dimensions.data.size() % 4 != 0) {
        return damaged("its dimensions are broken");
      }
      for (std::size_t i = 0; i < dimensions.data.size(); i += 4) {
        const auto d = dimensions.data.at<std::int32_t>(i);
        if (d < 0) return damaged(fmt::format("dimension {} is negative", d));
        header.dimensions.push_back(static_cast<std::uint64_t>(d));
      }
    }
    const auto name = MBK_TRY(elements.next("its name"));
    if (size_of(name.type) != 1 && name.type != kUtf8) return damaged("its name is broken");
    header.name = outer.empty() ? printable(name.data.padded_text()) : outer;
    return header;
  }

  Result<void> data(const Header& header, Elements& elements, int depth) {
    switch (header.array_class) {
      case kStructClass:
        return structure(header, elements, depth);
      case kOpaqueClass: {
        const auto system = elements.next("its type system");
        const auto type = MBK_TRY(system ? elements.next("its class name") : system);
        const std::string name = printable(type.data.padded_text());
        if (name == "function_handle") return aside(header, "a function handle");
        list_object(contents, header.name, name);
        return {};
      }
      case kObjectClass: {  // of a class of before 2008: a structure with a name
        const auto type = MBK_TRY(elements.next("its class name"));
        contents.notes.push_back(fmt::format("variable '{}' is an object of class '{}' and was read as a structure",
                                             header.name, printable(type.data.padded_text())));
        return structure(header, elements, depth);
      }
      case kCellClass:
        return cells(header, elements, depth);
      case kCharClass: {
        auto lines = MBK_TRY(lines_of_text(header, elements));
        return text(header, std::move(lines), "text in an unsupported encoding");
      }
      case kSparseClass:
        return aside(header, "a sparse matrix");
      case kFunctionClass:
        return aside(header, "a function handle");
      default:
        if (header.array_class < kDoubleClass || header.array_class > kUint64Class) {
          return damaged(fmt::format("array class {} is unknown", header.array_class));
        }
        return numbers(header, elements);
    }
  }

  Result<void> aside(const Header& header, std::string_view what) {
    contents.notes.push_back(fmt::format("variable '{}' is {} and was ignored", header.name, what));
    return {};
  }

  Result<void> text(const Header& header, std::optional<std::vector<std::string>> lines, std::string_view otherwise) {
    if (!lines) return aside(header, otherwise);
    Text& text = contents.texts.emplace_back();
    text.name = header.name;
    for (const std::string& row : *lines) {
      for (std::string& line : printable_lines(row)) text.lines.push_back(std::move(line));
    }
    return {};
  }

  /// The rows of a char array, without the blanks that make them equally long; nothing where they are not read.
  static Result<std::optional<std::vector<std::string>>> lines_of_text(const Header& header, Elements& elements) {
    using Lines = std::optional<std::vector<std::string>>;
    const auto units = MBK_TRY(elements.next("its text"));
    const bool wide = units.type == kUint16 || units.type == kUtf16;
    const std::size_t each = wide ? 2 : 1;
    const std::size_t stored = units.data.size() / each;
    const auto count = header.count();
    if (!wide && units.type != kInt8 && units.type != kUint8 && units.type != kUtf8) return Lines();
    if (header.dimensions.size() != 2 || header.dimensions[0] > kMaxLines) return Lines();
    if (stored == 0 && count && *count > 0) {  // some programs leave blanks out
      if (*count > kMaxLines) return Lines();
      const bool single = header.dimensions[0] == 1;
      return Lines(std::vector<std::string>(static_cast<std::size_t>(header.dimensions[0]),
                                            std::string(single ? static_cast<std::size_t>(*count) : 0, ' ')));
    }
    // In UTF-8 a character may have several bytes, and only a single row says where it ends.
    const bool fits = units.data.size() % each == 0 && count == stored;
    if (!fits && !(units.type == kUtf8 && header.dimensions[0] == 1 && count < stored)) {
      return damaged(fmt::format("dimensions {} do not match {} stored bytes of text",
                                 fmt::join(header.dimensions, "×"), units.data.size()));
    }
    if (stored == 0) return Lines({std::string()});
    const auto rows = static_cast<std::size_t>(header.dimensions[0]);
    std::vector<std::string> lines;
    for (std::size_t row = 0; row < rows; ++row) {
      std::u16string line16;
      std::string line8;
      for (std::size_t i = row; i < stored; i += rows) {
        if (wide) {
          line16 += units.data.at<char16_t>(2 * i);
        } else {
          line8 += units.data.at<char>(i);
        }
      }
      std::string line = wide ? utf8_from_utf16(line16) : std::move(line8);
      if (rows > 1) line.resize(line.find_last_not_of(' ') + 1);
      lines.push_back(std::move(line));
    }
    return Lines(std::move(lines));
  }

  /// A cell array whose cells all are one line of text is read as these lines, any other one as 'name{1}', 'name{2}', …
  Result<void> cells(const Header& header, const Elements& elements, int depth) {
    const auto count = header.count();
    if (!count || *count > kMaxLines) return aside(header, "a large cell array");
    auto lines = MBK_TRY(lines_of_cells(header, elements, *count));
    if (lines) return text(header, lines->empty() ? std::nullopt : std::move(lines), "an empty cell array");
    if (*count > kMaxElements) return aside(header, "a large cell array");
    const std::size_t texts = contents.texts.size();
    Elements rest = elements;
    for (std::uint64_t k = 0; k < *count; ++k) {
      const auto cell = MBK_TRY(rest.next("a cell"));
      if (cell.type != kMatrix) return damaged(fmt::format("cell {} is not an array", k + 1));
      MBK_TRY(matrix(cell.data, fmt::format("{}{{{}}}", header.name, k + 1), depth + 1));
    }
    if (contents.texts.size() > texts) {
      contents.notes.push_back(fmt::format("texts in the cell array '{}' were ignored", header.name));
      contents.texts.resize(texts);
    }
    return {};
  }

  /// The lines of cells that all are one line of text; nothing where they are not.
  static Result<std::optional<std::vector<std::string>>> lines_of_cells(const Header& header, Elements elements,
                                                                        std::uint64_t count) {
    using Lines = std::optional<std::vector<std::string>>;
    std::vector<std::string> lines;
    for (std::uint64_t k = 0; k < count; ++k) {
      const auto cell = MBK_TRY(elements.next("a cell"));
      if (cell.type != kMatrix || cell.data.size() == 0) return Lines();
      Elements inner{cell.data};
      const auto inner_header = MBK_TRY(read_header(inner, header.name));
      if (inner_header.array_class != kCharClass) return Lines();
      auto line = MBK_TRY(lines_of_text(inner_header, inner));
      if (!line || line->size() != 1) return Lines();
      lines.push_back(in_one_line(line->front()));
    }
    return Lines(std::move(lines));
  }

  Result<void> numbers(const Header& header, Elements& elements) {
    const auto real = MBK_TRY(elements.next("its data"));
    const std::size_t each = size_of(real.type);
    const auto count = header.count();
    if (each == 0) return damaged(fmt::format("data type {} is not numeric", real.type));
    if (!count || real.data.size() % each != 0 || real.data.size() / each != *count) {
      return damaged(fmt::format("dimensions {} do not match {} stored bytes of {} each",
                                 fmt::join(header.dimensions, "×"), real.data.size(), each));
    }
    if (header.complex) return aside(header, "complex");
    const auto squeezed = without_ones(header.dimensions);
    const bool block = header.dimensions.size() != 2 && !squeezed;
    const bool bytes = header.array_class == kInt8Class || header.array_class == kUint8Class;  // images
    if (block && (bytes || header.dimensions.size() > kMaxDimensions || !check_memory(8 * *count))) {
      return aside(header, fmt::format("an array of {} dimensions", header.dimensions.size()));
    }
    const std::vector<std::uint64_t> column = {*count, 1};
    const std::vector<std::uint64_t>& size = block ? column : squeezed ? *squeezed : header.dimensions;
    if (squeezed) {
      contents.notes.push_back(fmt::format("variable '{}' ({}) was read as {}×{}", header.name,
                                           fmt::join(header.dimensions, "×"), size[0], size[1]));
    }
    Array& array = contents.arrays.emplace_back();
    array.name = header.name;
    if (header.dimensions.size() > 2) array.shape = header.dimensions;
    const auto rows = static_cast<Index>(size[0]), columns = static_cast<Index>(size[1]);
    if (double* const at = where_they_stand(real); at != nullptr) {
      array.values = SharedMatrix(at, rows, columns, bytes_);
      return {};
    }
    array.values.resize(rows, columns);
    copy_doubles(real, static_cast<std::size_t>(*count), array.values.data());
    if (real.type == kInt64) put_rests<std::int64_t>(real, array);
    if (real.type == kUint64) put_rests<std::uint64_t>(real, array);
    return {};
  }

  /// Doubles in native byte order, numerous enough to keep few other bytes in memory;
  /// nullptr where they have to be copied.
  [[nodiscard]] double* where_they_stand(const Element& real) const {
    if (!bytes_ || real.type != kDouble || real.data.swapped || 2 * real.data.size() < bytes_->size) return nullptr;
    std::byte* const at = bytes_->data.get() + (real.data.bytes.data() - bytes_->data.get());
    return reinterpret_cast<std::uintptr_t>(at) % alignof(double) == 0 ? reinterpret_cast<double*>(at) : nullptr;
  }

  Result<void> structure(const Header& header, Elements& elements, int depth) {
    const auto width_element = elements.next("its field name length");
    const auto names = MBK_TRY(width_element ? elements.next("its field names") : width_element);
    if (width_element->data.size() != 4) return damaged("its field name length is broken");
    const auto width = width_element->data.at<std::int32_t>(0);
    if (width <= 0 || names.data.size() % static_cast<std::size_t>(width) != 0) {
      return damaged("its field names are broken");
    }
    std::vector<std::string> fields, originals;
    for (std::size_t i = 0; i < names.data.size(); i += static_cast<std::size_t>(width)) {
      std::string field = printable(names.data.part(i, static_cast<std::size_t>(width)).padded_text());
      const auto same = std::ranges::count(originals, field);
      originals.push_back(field);
      if (same > 0) {
        fields.push_back(fmt::format("{}#{}", field, same + 1));
        contents.notes.push_back(fmt::format("structure '{}' has several fields '{}'; one was renamed '{}'",
                                             header.name, field, fields.back()));
      } else {
        fields.push_back(std::move(field));
      }
    }
    const auto count = header.count();
    if (!count || *count > kMaxElements) return aside(header, "a large structure array");
    for (std::uint64_t k = 0; k < *count; ++k) {
      for (const std::string& field : fields) {
        const auto element = MBK_TRY(elements.next("a field"));
        if (element.type != kMatrix) return damaged(fmt::format("field '{}' is not an array", field));
        const std::string full = *count == 1 ? fmt::format("{}.{}", header.name, field)
                                             : fmt::format("{}({}).{}", header.name, k + 1, field);
        MBK_TRY(matrix(element.data, full, depth + 1));
      }
    }
    return {};
  }

  std::string name_;               ///< of the variable at hand, for messages
  std::shared_ptr<Buffer> bytes_;  ///< its source: the file, or inflated
};

Result<Contents> decoded(std::span<const std::byte> file, std::shared_ptr<Buffer> bytes) {
  if (file.size() < kHeaderSize) {
    return damaged(fmt::format("the MAT header has {} of {} bytes", file.size(), kHeaderSize));
  }
  const bool little = file[126] == std::byte{'I'};
  const ByteView view{file, little != (std::endian::native == std::endian::little)};
  Decoder decoder(std::move(bytes));
  decoder.contents.format = "MAT v5";
  MBK_TRY(decoder.top_level({view, kHeaderSize}));
  give_rates(decoder.contents);
  return std::move(decoder.contents);
}

}  // namespace

Result<Contents> decode_mat_level5(std::span<const std::byte> file) {
  return decoded(file, nullptr);
}

Result<Contents> decode_mat_level5(std::shared_ptr<Buffer> file) {
  const std::span<const std::byte> bytes = file->bytes();
  return decoded(bytes, std::move(file));
}

}  // namespace mbk::recording
