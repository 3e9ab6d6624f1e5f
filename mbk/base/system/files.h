#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

/// Calls of the operating system. Each header has one implementation for each system (name_posix.cpp,
/// name_windows.cpp); no other module names a system call, but for those that drive robots, which Windows does not
/// have.
///
/// A function that gives an int gives 0 or the number of an error, as errno has it, unless it says otherwise.
namespace mbk::system {

/// An open file, which is closed. Child processes do not have it.
class OpenFile {
 public:
  OpenFile() = default;
  explicit OpenFile(int number) : number_(number) {}
  OpenFile(OpenFile&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  OpenFile& operator=(OpenFile&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { close(); }

  [[nodiscard]] explicit operator bool() const { return number_ >= 0; }
  [[nodiscard]] int number() const { return number_; }  ///< the file's descriptor; -1: none
  int close();

 private:
  int number_ = -1;
};

/// The next four give none, with errno, where they fail.
/// @returns  the file, to be read; of a pipe it does not wait for the writer
[[nodiscard]] OpenFile open_to_read(const std::filesystem::path& file);
/// A file that was not there, to be read and written, with EEXIST where it was.
/// @param permissions  of owner, group and others, which the umask may restrict
[[nodiscard]] OpenFile create_new(const std::filesystem::path& file, unsigned permissions = 0600);
/// A file for the owner, to be read and written. A symbolic link is not followed.
[[nodiscard]] OpenFile create_or_open(const std::filesystem::path& file);
/// A file for the owner without a name, which goes with its last user.
[[nodiscard]] OpenFile open_unnamed(const std::filesystem::path& folder);

struct FileStatus {
  enum class Kind { regular, folder, other };
  Kind kind = Kind::other;
  std::uint64_t size = 0;
  unsigned permissions = 0;     ///< of owner, group and others; 0666 where the system has no such
  std::uint64_t group = 0;      ///< to whom the file belongs
  std::uint64_t number = 0;     ///< of the file on its disk
  std::uint64_t disk = 0;       ///< a number for it
  std::int64_t changed_ns = 0;  ///< when its contents did
  bool operator==(const FileStatus&) const = default;
};

/// Empty, with errno, where it fails.
[[nodiscard]] std::optional<FileStatus> status_of(const OpenFile& file);
[[nodiscard]] std::optional<FileStatus> status_of(const std::filesystem::path& file);

/// What is there, at most `count` bytes.   @returns  how many; 0 at the end; -1 with errno
[[nodiscard]] std::int64_t read_some(int descriptor, void* to, std::size_t count);
[[nodiscard]] std::int64_t read_some_at(int descriptor, void* to, std::size_t count, std::uint64_t place);

/// Writes all of it; ENOSPC where the disk takes none of it without saying why.
/// @returns  with `wrote`, how many bytes were written before the error
[[nodiscard]] int write_all(int descriptor, std::span<const std::byte> bytes, std::size_t* wrote = nullptr);
[[nodiscard]] int write_all_at(int descriptor, std::span<const std::byte> bytes, std::uint64_t place);

/// Changes the length of a file.
[[nodiscard]] int cut(const OpenFile& file, std::uint64_t bytes);
[[nodiscard]] int set_permissions(const OpenFile& file, unsigned permissions);

/// Until the disk has the file.
[[nodiscard]] int flush(const OpenFile& file);
/// Until the disk has the names in a folder; 0 where the file system cannot say so.
[[nodiscard]] int flush_folder(const std::filesystem::path& folder);

/// A lock that ends with the open file; EWOULDBLOCK where someone else has one that excludes it.
enum class Lock { shared, alone };
[[nodiscard]] int try_lock(const OpenFile& file, Lock lock);

/// Gives a file another name: in place of a file of that name, or (EEXIST) not.
[[nodiscard]] int rename_over(const std::filesystem::path& from, const std::filesystem::path& to);
[[nodiscard]] int rename_new(const std::filesystem::path& from, const std::filesystem::path& to);
/// A second name of a file; EEXIST where there is a file of that name.
[[nodiscard]] int link(const std::filesystem::path& from, const std::filesystem::path& to);
int remove_name(const std::filesystem::path& file);

/// A folder for the owner alone.
[[nodiscard]] int make_folder(const std::filesystem::path& folder);
/// A new folder for the owner alone, whose name is `begin`, a hyphen and six characters; "" with errno where it fails.
[[nodiscard]] std::filesystem::path make_temporary_folder(const std::filesystem::path& begin);

/// Whether an error says that there is no room for more.
[[nodiscard]] bool is_full(int code);

[[nodiscard]] bool may_write(const std::filesystem::path& path);
/// The program of this name in the folders of PATH; "" where there is none.
[[nodiscard]] std::filesystem::path find_program(const std::string& name);

/// What the pattern of a shell (* ? [) names, in no order.
[[nodiscard]] std::vector<std::filesystem::path> matching(const std::string& pattern);

}  // namespace mbk::system
