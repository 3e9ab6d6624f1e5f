#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mbk/base/core/result.h"
#include "mbk/files/contents/file_bytes.h"

namespace mbk::recording {

/// A member of a zip archive.
struct ZipMember {
  std::string name;        ///< with '/' between folders, as it is stored, in UTF-8
  std::uint64_t size = 0;  ///< [bytes] that it says it has when it is unpacked
};

/// A zip archive that stands in memory. Nothing is unpacked but what is asked for, by several threads at once if need
/// be.
class ZipArchive {
 public:
  [[nodiscard]] static bool looks_like_zip(std::span<const std::byte> file);

  /// @param file  must outlive the archive
  /// @fails  data: no archive, cut short, encrypted, or its members say that they are larger than a file of this length
  ///         can unpack to (`largest_unpacked`) or than memory.
  [[nodiscard]] static Result<ZipArchive> open(std::span<const std::byte> file);

  [[nodiscard]] const std::vector<ZipMember>& members() const { return members_; }
  [[nodiscard]] bool has(std::string_view name) const;

  /// The bytes of a member, whose checksum is checked.
  /// @fails  data: there is no such member; it is damaged, or not as large as the archive says.
  [[nodiscard]] Result<Buffer> read(std::string_view name) const;
  /// Its first bytes, `count` where it has as many. The checksum, which is that of all of them, is not checked.
  /// @fails  as read
  [[nodiscard]] Result<Buffer> read_begin(std::string_view name, std::uint64_t count) const;

 private:
  /// @param count  of bytes, or all of them where it has fewer    @param whole  the end must be there, and right
  [[nodiscard]] Result<Buffer> read(std::string_view name, std::uint64_t count, bool whole) const;

  /// Where the directory of the archive says that a member stands.
  struct Place {
    std::size_t member;              ///< in members_
    std::uint64_t entry, of_number;  ///< as minizip counts
  };

  std::span<const std::byte> file_;
  std::vector<ZipMember> members_;
  std::map<std::string_view, Place> places_;  ///< of members by their names; the first of a name counts
};

}  // namespace mbk::recording
