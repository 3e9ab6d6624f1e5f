#include "mbk/files/contents/durable_files.h"

#include <fmt/format.h>

#include <cerrno>
#include <optional>
#include <system_error>
#include <vector>

#include "mbk/base/system/files.h"
#include "mbk/files/contents/sha256.h"

namespace mbk::files {
namespace {

namespace fs = std::filesystem;

}  // namespace

tl::unexpected<Error> cannot(const char* what, const fs::path& file, int code) {
  const char* const remedy = system::is_full(code) ? "free space on the disk; no file was partially changed"
                             : code == ENOENT      ? "check the name"
                             : code == EACCES      ? "check its permissions"
                                                   : "check the disk and the permissions of the folder";
  return bad_data(fmt::format("{}: {}", what, std::generic_category().message(code)), remedy, file.string());
}

Result<void> make_folder(const fs::path& folder) {
  if (const int code = system::make_folder(folder); code != 0) {
    std::error_code ignored;
    if (code != EEXIST || !fs::is_directory(folder, ignored))
      return cannot("the folder cannot be created", folder, code);
    // Whoever made it may not have waited for the disk yet, or failed to.
  }
  return flush_folder(folder.has_parent_path() ? folder.parent_path() : fs::path("."));
}

Result<void> read_pieces(const fs::path& file, const std::function<Result<void>(std::span<const std::byte>)>& take) {
  const system::OpenFile in = system::open_to_read(file);
  const auto status = in ? system::status_of(in) : std::nullopt;
  if (!status) return cannot("cannot be read", file, errno);
  if (status->kind != system::FileStatus::Kind::regular) {
    return bad_data("this is not a file", "name a recording", file.string());
  }
  constexpr std::size_t kPiece = std::size_t{1} << 18;
  std::vector<std::byte> piece(kPiece);
  while (true) {
    const std::int64_t got = system::read_some(in.number(), piece.data(), piece.size());
    if (got < 0) return cannot("cannot be read", file, errno);
    if (got == 0) return {};
    MBK_TRY(take(std::span(piece).first(static_cast<std::size_t>(got))));
  }
}

Result<CopiedFile> copy_hashed(const fs::path& from, const fs::path& to) {
  system::OpenFile out = system::create_new(to);
  if (!out) return cannot("cannot be written", to, errno);
  CopiedFile copied;
  recording::Sha256 sum;
  auto done = read_pieces(from, [&](std::span<const std::byte> piece) -> Result<void> {
    sum.add(piece);
    copied.bytes += std::ssize(piece);
    if (const int code = system::write_all(out.number(), piece); code != 0)
      return cannot("cannot be written", to, code);
    return {};
  });
  if (done) {
    if (const int code = system::flush(out); code != 0) done = cannot("cannot be written", to, code);
  }
  const int closed = out.close();
  if (done && closed != 0) done = cannot("cannot be written", to, closed);
  if (!done) {
    system::remove_name(to);
    return tl::unexpected(done.error());
  }
  copied.sha256 = sum.hex();
  return copied;
}

Result<void> rename_on_disk(const fs::path& from, const fs::path& to) {
  if (const int code = system::rename_over(from, to); code != 0) return cannot("cannot be written", to, code);
  return flush_folder(to.parent_path());
}

Result<void> flush_folder(const fs::path& folder) {
  if (const int code = system::flush_folder(folder); code != 0) return cannot("cannot be written", folder, code);
  return {};
}

Result<bool> remove_file(const fs::path& file) {
  const int code = system::remove_name(file);
  if (code == 0) return true;
  if (code == ENOENT) return false;
  return cannot("cannot be removed", file, code);
}

Result<std::string> file_sha256(const fs::path& file) {
  recording::Sha256 sum;
  MBK_TRY(read_pieces(file, [&](std::span<const std::byte> piece) -> Result<void> {
    sum.add(piece);
    return {};
  }));
  return sum.hex();
}

}  // namespace mbk::files
