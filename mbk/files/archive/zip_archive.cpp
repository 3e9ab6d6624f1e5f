#include "mbk/files/archive/zip_archive.h"

#include <fmt/format.h>
#include <minizip/unzip.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/memory.h"

namespace mbk::recording {
namespace {

constexpr unsigned long kEncrypted = 1;  // of the flags of a member

tl::unexpected<Error> damaged(std::string_view what) {
  return bad_data(fmt::format("the zip archive cannot be read: {}", what),
                  "copy the file again from where it was recorded");
}

/// The archive, as minizip reads it: a position in bytes in memory.
struct Cursor {
  std::span<const std::byte> file;
  std::uint64_t at = 0;
};

Cursor& cursor(void* stream) {
  return *static_cast<Cursor*>(stream);
}

uLong read_at(void* /*of*/, void* stream, void* out, uLong count) {
  Cursor& from = cursor(stream);
  const std::uint64_t left = from.at < from.file.size() ? from.file.size() - from.at : 0;
  const std::uint64_t n = std::min<std::uint64_t>(count, left);
  if (n > 0) std::memcpy(out, from.file.data() + from.at, n);
  from.at += n;
  return n;
}

long seek(void* /*of*/, void* stream, ZPOS64_T offset, int origin) {
  Cursor& in = cursor(stream);
  const std::uint64_t base = origin == ZLIB_FILEFUNC_SEEK_SET   ? 0
                             : origin == ZLIB_FILEFUNC_SEEK_CUR ? in.at
                                                                : in.file.size();
  if (offset > in.file.size() || base > in.file.size() - offset) return -1;
  in.at = base + offset;
  return 0;
}

struct Close {
  void operator()(void* archive) const { unzClose(archive); }
};
using Handle = std::unique_ptr<void, Close>;

/// minizip's view of the bytes.   @param place  must outlive it
Handle open_at(Cursor& place) {
  zlib_filefunc64_def functions{};
  functions.opaque = &place;
  functions.zopen64_file = [](void* of, const void* /*name*/, int /*mode*/) { return of; };
  functions.zread_file = read_at;
  functions.ztell64_file = [](void* /*of*/, void* stream) -> ZPOS64_T { return cursor(stream).at; };
  functions.zseek64_file = seek;
  functions.zclose_file = [](void* /*of*/, void* /*stream*/) { return 0; };
  functions.zerror_file = [](void* /*of*/, void* /*stream*/) { return 0; };
  return Handle(unzOpen2_64(nullptr, &functions));
}

std::string in_quotes(std::string_view name) {
  return fmt::format("'{}'", printable(std::string(name)));
}

}  // namespace

bool ZipArchive::looks_like_zip(std::span<const std::byte> file) {
  return file.size() >= 22 && std::memcmp(file.data(), "PK\x03\x04", 4) == 0;
}

Result<ZipArchive> ZipArchive::open(std::span<const std::byte> file) {
  Cursor place{file};
  const Handle opened = open_at(place);
  if (!opened) return damaged("its directory is missing; the file may be truncated");
  ZipArchive archive;
  archive.file_ = file;
  const std::uint64_t room = largest_unpacked(file.size());
  std::uint64_t total = 0;
  std::vector<Place> places;
  std::string text(std::numeric_limits<std::uint16_t>::max() + 1, '\0');  // the longest name, and its end
  int code = unzGoToFirstFile(opened.get());
  for (; code == UNZ_OK; code = unzGoToNextFile(opened.get())) {
    unz_file_info64 about{};
    unz64_file_pos position{};
    if (unzGetCurrentFileInfo64(opened.get(), &about, text.data(), text.size(), nullptr, 0, nullptr, 0) != UNZ_OK ||
        unzGetFilePos64(opened.get(), &position) != UNZ_OK) {
      return damaged("its directory is damaged");
    }
    std::string name(text.c_str());
    const std::uint64_t size = about.uncompressed_size;
    if (size > room || total + size > room) {
      return damaged(fmt::format(
          "the stated unpacked size of {}, {} bytes, is implausible: an archive of this size holds at most {} MB",
          in_quotes(name), size, room >> 20U));
    }
    total += size;
    if ((about.flag & kEncrypted) != 0) {
      return bad_data(fmt::format("{} in the zip archive is encrypted", in_quotes(name)),
                      "unpack it with its password and pack it again without encryption");
    }
    places.push_back({archive.members_.size(), position.pos_in_zip_directory, position.num_of_file});
    archive.members_.push_back({std::move(name), size});
  }
  if (code != UNZ_END_OF_LIST_OF_FILE) return damaged("its directory is damaged");
  for (const Place& one : places) archive.places_.try_emplace(archive.members_[one.member].name, one);
  return archive;
}

bool ZipArchive::has(std::string_view name) const {
  return places_.contains(name);
}

Result<Buffer> ZipArchive::read(std::string_view name) const {
  return read(name, std::numeric_limits<std::uint64_t>::max(), true);
}

Result<Buffer> ZipArchive::read_begin(std::string_view name, std::uint64_t count) const {
  return read(name, count, false);
}

Result<Buffer> ZipArchive::read(std::string_view name, std::uint64_t count, bool whole) const {
  const auto found = places_.find(name);
  if (found == places_.end()) return damaged(fmt::format("it does not contain {}", in_quotes(name)));
  const Place& place = found->second;
  const std::uint64_t size = std::min(members_[place.member].size, count);
  MBK_TRY(check_memory(size));
  Cursor at{file_};
  const Handle archive = open_at(at);
  const unz64_file_pos position{place.entry, place.of_number};
  if (!archive || unzGoToFilePos64(archive.get(), &position) != UNZ_OK || unzOpenCurrentFile(archive.get()) != UNZ_OK) {
    return damaged(fmt::format("{} is damaged or uses an unsupported compression method", in_quotes(name)));
  }
  Buffer bytes(size);
  std::size_t got = 0;
  while (got < bytes.size) {
    const auto want = static_cast<unsigned>(std::min<std::size_t>(bytes.size - got, std::size_t{1} << 30));
    const int n = unzReadCurrentFile(archive.get(), bytes.data.get() + got, want);
    if (n <= 0) return damaged(fmt::format("{} {}", in_quotes(name), n < 0 ? "is damaged" : "is truncated"));
    got += static_cast<std::size_t>(n);
  }
  if (!whole) return bytes;
  std::byte beyond;
  if (unzReadCurrentFile(archive.get(), &beyond, 1) != 0) {
    return damaged(fmt::format("{} is longer than its stated size", in_quotes(name)));
  }
  if (unzCloseCurrentFile(archive.get()) != UNZ_OK) {
    return damaged(fmt::format("{} is damaged: its checksum is wrong", in_quotes(name)));
  }
  return bytes;
}

}  // namespace mbk::recording
