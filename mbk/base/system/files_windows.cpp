#include <fcntl.h>
#include <io.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <random>

#include "mbk/base/system/files.h"
#include "mbk/base/system/windows_api.h"

namespace mbk::system {
namespace {

namespace fs = std::filesystem;

constexpr DWORD kShared = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;

int error_of(BOOL fine) {
  return fine != 0 ? 0 : error_number();
}

HANDLE handle_of(int descriptor) {
  return reinterpret_cast<HANDLE>(_get_osfhandle(descriptor));  // NOLINT(performance-no-int-to-ptr)
}

/// A descriptor of the C library for an open handle.
OpenFile descriptor_of(HANDLE handle, int flags) {
  if (handle == INVALID_HANDLE_VALUE) {
    errno = error_number();
    return {};
  }
  const int number = _open_osfhandle(reinterpret_cast<intptr_t>(handle), flags | _O_BINARY | _O_NOINHERIT);
  if (number < 0) CloseHandle(handle);
  return OpenFile(number);
}

OpenFile open_with(const fs::path& file, DWORD access, DWORD how, DWORD attributes, int flags) {
  return descriptor_of(CreateFileW(file.c_str(), access, kShared, nullptr, how, attributes, nullptr), flags);
}

/// Places of a file are given, so that its own place does not matter.
OVERLAPPED at(std::uint64_t place) {
  OVERLAPPED where{};
  where.Offset = static_cast<DWORD>(place);
  where.OffsetHigh = static_cast<DWORD>(place >> 32U);
  return where;
}

constexpr std::size_t kMaxPiece = std::size_t{1} << 30U;

DWORD piece(std::size_t count) {
  return static_cast<DWORD>(std::min(count, kMaxPiece));
}

std::optional<FileStatus> status_of(HANDLE handle) {
  FileStatus found;
  if (GetFileType(handle) != FILE_TYPE_DISK) return found;
  BY_HANDLE_FILE_INFORMATION status{};
  if (GetFileInformationByHandle(handle, &status) == 0) {
    errno = error_number();
    return std::nullopt;
  }
  const auto both = [](DWORD high, DWORD low) { return (std::uint64_t{high} << 32U) | low; };
  const bool folder = (status.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0;
  found.kind = folder ? FileStatus::Kind::folder : FileStatus::Kind::regular;
  found.size = folder ? 0 : both(status.nFileSizeHigh, status.nFileSizeLow);
  found.permissions = folder ? 0777 : 0666;
  found.number = both(status.nFileIndexHigh, status.nFileIndexLow);
  found.disk = status.dwVolumeSerialNumber;
  found.changed_ns = static_cast<std::int64_t>(
      100 * both(status.ftLastWriteTime.dwHighDateTime, status.ftLastWriteTime.dwLowDateTime));
  return found;
}

int move(const fs::path& from, const fs::path& to, DWORD how) {
  return error_of(MoveFileExW(from.c_str(), to.c_str(), how | MOVEFILE_WRITE_THROUGH));
}

/// Whether a name is one of a pattern with * ? [abc] [a-z] [!a], as Windows compares names: small like capital letters.
bool is_like(std::wstring_view name, std::wstring_view pattern) {
  const auto same = [](wchar_t a, wchar_t b) { return towlower(a) == towlower(b); };
  if (pattern.empty()) return name.empty();
  if (pattern.front() == L'*') {
    for (std::size_t k = 0; k <= name.size(); ++k) {
      if (is_like(name.substr(k), pattern.substr(1))) return true;
    }
    return false;
  }
  if (name.empty()) return false;
  const std::size_t end = pattern.front() == L'[' ? pattern.find(L']', 2) : std::wstring_view::npos;
  if (end != std::wstring_view::npos) {
    std::wstring_view set = pattern.substr(1, end - 1);
    const bool not_one = set.front() == L'!' || set.front() == L'^';
    if (not_one) set.remove_prefix(1);
    bool found = false;
    for (std::size_t k = 0; k < set.size(); ++k) {
      if (k + 2 < set.size() && set[k + 1] == L'-') {
        found = found || (towlower(set[k]) <= towlower(name.front()) && towlower(name.front()) <= towlower(set[k + 2]));
        k += 2;
      } else {
        found = found || same(set[k], name.front());
      }
    }
    return found != not_one && is_like(name.substr(1), pattern.substr(end + 1));
  }
  return (pattern.front() == L'?' || same(pattern.front(), name.front())) && is_like(name.substr(1), pattern.substr(1));
}

void add_matching(const fs::path& folder, fs::path::const_iterator part, const fs::path::const_iterator& end,
                  std::vector<fs::path>& found) {
  if (part == end) {
    found.push_back(folder);
    return;
  }
  const std::wstring pattern = part->native();
  const auto next = std::next(part);
  std::error_code code;
  if (pattern.find_first_of(L"*?[") == std::wstring::npos) {
    if (fs::exists(folder / *part, code)) add_matching(folder / *part, next, end, found);
    return;
  }
  const fs::path where = folder.empty() ? fs::path(".") : folder;
  for (fs::directory_iterator entry(where, code), last; !code && entry != last; entry.increment(code)) {
    const std::wstring name = entry->path().filename().native();
    const bool hidden = name.starts_with(L'.') && !pattern.starts_with(L'.');
    if (!hidden && is_like(name, pattern)) add_matching(folder / entry->path().filename(), next, end, found);
  }
}

}  // namespace

int OpenFile::close() {
  return number_ < 0 || ::_close(std::exchange(number_, -1)) == 0 ? 0 : errno;
}

OpenFile open_to_read(const fs::path& file) {
  // A folder opens only so, which is then found to be one.
  return open_with(file, GENERIC_READ, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, _O_RDONLY);
}

OpenFile create_new(const fs::path& file, unsigned /*permissions*/) {
  return open_with(file, GENERIC_READ | GENERIC_WRITE, CREATE_NEW, FILE_ATTRIBUTE_NORMAL, _O_RDWR);
}

OpenFile create_or_open(const fs::path& file) {
  return open_with(file, GENERIC_READ | GENERIC_WRITE, OPEN_ALWAYS, FILE_ATTRIBUTE_NORMAL, _O_RDWR);
}

OpenFile open_unnamed(const fs::path& /*folder*/) {
  errno = ENOSYS;  // it would be of no use: a view of a file cannot take the place of memory
  return {};
}

std::optional<FileStatus> status_of(const OpenFile& file) {
  return status_of(handle_of(file.number()));
}

std::optional<FileStatus> status_of(const fs::path& file) {
  const OpenFile opened = open_with(file, FILE_READ_ATTRIBUTES, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, _O_RDONLY);
  return opened ? status_of(opened) : std::nullopt;
}

std::int64_t read_some(int descriptor, void* to, std::size_t count) {
  return ::_read(descriptor, to, piece(count));
}

std::int64_t read_some_at(int descriptor, void* to, std::size_t count, std::uint64_t place) {
  OVERLAPPED where = at(place);
  DWORD got = 0;
  if (ReadFile(handle_of(descriptor), to, piece(count), &got, &where) != 0) return got;
  if (GetLastError() == ERROR_HANDLE_EOF) return 0;
  errno = error_number();
  return -1;
}

int write_all(int descriptor, std::span<const std::byte> bytes, std::size_t* wrote) {
  std::size_t unused = 0, &done = wrote != nullptr ? *wrote : unused;
  for (done = 0; done < bytes.size();) {
    const int more = ::_write(descriptor, bytes.data() + done, piece(bytes.size() - done));
    if (more <= 0) return more < 0 ? errno : ENOSPC;
    done += static_cast<std::size_t>(more);
  }
  return 0;
}

int write_all_at(int descriptor, std::span<const std::byte> bytes, std::uint64_t place) {
  for (std::size_t done = 0; done < bytes.size();) {
    OVERLAPPED where = at(place + done);
    DWORD more = 0;
    if (WriteFile(handle_of(descriptor), bytes.data() + done, piece(bytes.size() - done), &more, &where) == 0) {
      return error_number();
    }
    if (more == 0) return ENOSPC;
    done += more;
  }
  return 0;
}

int cut(const OpenFile& file, std::uint64_t bytes) {
  return _chsize_s(file.number(), static_cast<std::int64_t>(bytes));
}

int set_permissions(const OpenFile& /*file*/, unsigned /*permissions*/) {
  return 0;  // those of its folder hold
}

int flush(const OpenFile& file) {
  return error_of(FlushFileBuffers(handle_of(file.number())));
}

int flush_folder(const fs::path& /*folder*/) {
  return 0;  // it cannot say so; names are written through
}

int try_lock(const OpenFile& file, Lock lock) {
  OVERLAPPED where = at(std::uint64_t{1} << 62U);  // beyond what is read: Windows keeps others from what is locked
  const DWORD how = LOCKFILE_FAIL_IMMEDIATELY | (lock == Lock::alone ? LOCKFILE_EXCLUSIVE_LOCK : 0);
  if (LockFileEx(handle_of(file.number()), how, 0, 1, 0, &where) != 0) return 0;
  const DWORD code = GetLastError();
  return code == ERROR_IO_PENDING ? EWOULDBLOCK : error_number(code);
}

int rename_over(const fs::path& from, const fs::path& to) {
  return move(from, to, MOVEFILE_REPLACE_EXISTING);
}

int rename_new(const fs::path& from, const fs::path& to) {
  return move(from, to, 0);
}

int link(const fs::path& from, const fs::path& to) {
  return error_of(CreateHardLinkW(to.c_str(), from.c_str(), nullptr));
}

int remove_name(const fs::path& file) {
  return error_of(DeleteFileW(file.c_str()));
}

int make_folder(const fs::path& folder) {
  return error_of(CreateDirectoryW(folder.c_str(), nullptr));
}

fs::path make_temporary_folder(const fs::path& begin) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz0123456789";
  constexpr int kTries = 100, kCharacters = 6;
  std::random_device lot;
  for (int k = 0; k < kTries; ++k) {
    fs::path name = begin;
    name += "-";
    for (int c = 0; c < kCharacters; ++c) name += std::string(1, kLetters[lot() % kLetters.size()]);
    errno = make_folder(name);
    if (errno == 0) return name;
    if (errno != EEXIST) break;
  }
  return {};
}

bool is_full(int code) {
  return code == ENOSPC || code == EFBIG;
}

bool may_write(const fs::path& path) {
  const DWORD attributes = GetFileAttributesW(path.c_str());
  if (attributes == INVALID_FILE_ATTRIBUTES) return false;
  return (attributes & FILE_ATTRIBUTE_DIRECTORY) != 0 || (attributes & FILE_ATTRIBUTE_READONLY) == 0;
}

fs::path find_program(const std::string& name) {
  std::array<wchar_t, 32768> found{};
  const DWORD length =
      SearchPathW(nullptr, wide(name).c_str(), L".exe", static_cast<DWORD>(found.size()), found.data(), nullptr);
  return length > 0 && length < found.size() ? fs::path(std::wstring(found.data(), length)) : fs::path();
}

std::vector<fs::path> matching(const std::string& pattern) {
  std::vector<fs::path> found;
  const fs::path whole = pattern;
  const fs::path below = whole.relative_path();
  add_matching(whole.root_path(), below.begin(), below.end(), found);
  return found;
}

}  // namespace mbk::system
