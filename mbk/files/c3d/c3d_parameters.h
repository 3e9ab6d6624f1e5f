#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/byte_view.h"

namespace mbk::recording {

/// C3D files count in blocks of 512 bytes, from 1.
inline constexpr std::size_t kC3dBlock = 512;

/// Offset of word k of the header, counted from 1 as the format does.
constexpr std::size_t c3d_header_word(std::size_t k) {
  return 2 * (k - 1);
}

/// Remedy for contradictory bytes.
inline constexpr std::string_view kC3dRemedy =
    "the file is damaged or truncated: copy it again from where it was recorded";
/// Remedy for a file that its program wrote incorrectly.
inline constexpr std::string_view kC3dWriteAgain = "write the file again with the program that recorded it";

/// The processor that wrote the numbers of a C3D file; values as in the fourth parameter byte.
enum class C3dProcessor : std::uint8_t { intel = 84, dec = 85, sgi = 86 };

/// Bytes of a C3D file and their number format: little-endian IEEE (Intel), little-endian words with VAX
/// F-floats (DEC), big-endian IEEE (SGI). The caller checks offsets.
struct C3dBytes {
  ByteView view;
  C3dProcessor processor = C3dProcessor::intel;

  C3dBytes(std::span<const std::byte> bytes, C3dProcessor made_by);

  [[nodiscard]] std::uint16_t word(std::size_t offset) const { return view.at<std::uint16_t>(offset); }
  [[nodiscard]] std::int16_t signed_word(std::size_t offset) const { return view.at<std::int16_t>(offset); }
  /// A 4-byte real. A VAX F-float is (−1)^s · 0.1f₂ · 2^(e−128); its reserved operand (s = 1, e = 0) is NaN.
  [[nodiscard]] double real(std::size_t offset) const;
  [[nodiscard]] C3dBytes part(std::size_t offset, std::size_t count) const;
};

/// The array behind a GROUP:NAME.
struct C3dParameter {
  enum class Type : std::int8_t { text = -1, byte = 1, word = 2, real = 4 };

  Type type = Type::byte;
  std::vector<std::uint8_t> dimensions;  ///< the first varies fastest; none for a single value
  C3dBytes data;                         ///< length according to type and dimensions
};

/// The parameter section of a C3D file. Its parameters refer to the file's bytes.
class C3dParameters {
 public:
  /// Names of groups and parameters are in capitals; the first of several equal names is used. Reads the records of the
  /// section at `begin` up to the terminator, the last record, or `end`.
  /// @fails  data: a record extends beyond the file or does not point forward; an unknown type; too many dimensions.
  [[nodiscard]] static Result<C3dParameters> read(const C3dBytes& file, std::size_t begin, std::size_t end);

  /// Position of the section in the file [bytes].
  [[nodiscard]] std::size_t begin() const { return begin_; }
  [[nodiscard]] std::size_t end() const { return end_; }
  /// Whether the records ended before `end`.
  [[nodiscard]] bool terminated() const { return terminated_; }

  [[nodiscard]] const C3dParameter* find(std::string_view group, std::string_view name) const;

  /// The first value; nothing if there is none or it is text. Words are 0 to 65535.
  [[nodiscard]] std::optional<double> number(std::string_view group, std::string_view name) const;
  /// The values of NAME, then of NAME2, NAME3, … while they exist; empty if NAME is missing or text.
  [[nodiscard]] std::vector<double> numbers(std::string_view group, std::string_view name,
                                            bool unsigned_words = false) const;
  /// The texts of NAME, NAME2, … as numbers; empty if one is none. More digits than a real has, NaN included.
  [[nodiscard]] std::vector<double> numbers_in_digits(std::string_view group, std::string_view name) const;
  /// The texts of NAME, NAME2, NAME3, … in printable UTF-8 without spaces around them.
  [[nodiscard]] std::vector<std::string> texts(std::string_view group, std::string_view name) const;

  /// The names of the groups, sorted.
  [[nodiscard]] std::vector<std::string_view> groups() const;
  /// The names of a group's parameters, sorted.
  [[nodiscard]] std::vector<std::string_view> names(std::string_view group) const;

 private:
  template <class Use>
  void for_each_part(std::string_view group, std::string_view name, const Use& use) const;

  std::map<std::string, std::map<std::string, C3dParameter, std::less<>>, std::less<>> groups_;
  std::size_t begin_ = 0, end_ = 0;
  bool terminated_ = false;
};

}  // namespace mbk::recording
