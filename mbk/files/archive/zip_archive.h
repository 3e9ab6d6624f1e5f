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
  std::uint64_t size = 0;  ///< [bytes] stated unpacked size
};

/// A zip archive in memory. Members are unpacked on request, from several threads if needed.
class ZipArchive {
 public:
  [[nodiscard]] static bool looks_like_zip(std::span<const std::byte> file);

  /// @param file  must outlive the archive
  /// @fails  data: not an archive, truncated, encrypted, or with stated member sizes above what a file of this size can
  /// unpack to (`largest_unpacked`) or above the available memory.
  [[nodiscard]] static Result<ZipArchive> open(std::span<const std::byte> file);

  [[nodiscard]] const std::vector<ZipMember>& members() const { return members_; }
  [[nodiscard]] bool has(std::string_view name) const;

  /// The bytes of a member. The checksum is checked.
  /// @fails  data: there is no such member; it is damaged, or its size differs from the archive's statement.
  [[nodiscard]] Result<Buffer> read(std::string_view name) const;
  /// At most its first `count` bytes. The checksum of the whole member is not checked.
  /// @fails  as read
  [[nodiscard]] Result<Buffer> read_begin(std::string_view name, std::uint64_t count) const;

 private:
  /// @param count  maximum number of bytes    @param whole  the end must be present and correct
  [[nodiscard]] Result<Buffer> read(std::string_view name, std::uint64_t count, bool whole) const;

  /// Position of a member according to the archive directory.
  struct Place {
    std::size_t member;              ///< in members_
    std::uint64_t entry, of_number;  ///< as minizip counts
  };

  std::span<const std::byte> file_;
  std::vector<ZipMember> members_;
  std::map<std::string_view, Place> places_;  ///< of members by name; the first of several equal names is used
};

}  // namespace mbk::recording
