#include "mbk/files/archive/zip_archive.h"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/memory.h"

namespace mbk::recording {
namespace {

constexpr std::string_view kAgain = "copy the file again from where it was recorded";

zip_t* as_zip(void* archive) {
  return static_cast<zip_t*>(archive);
}

tl::unexpected<Error> damaged(std::string_view what) {
  return bad_data(fmt::format("the zip archive cannot be read: {}", what), std::string(kAgain));
}

}  // namespace

void ZipArchive::Close::operator()(void* archive) const {
  zip_discard(as_zip(archive));
}

bool ZipArchive::looks_like_zip(std::span<const std::byte> file) {
  return file.size() >= 22 && std::memcmp(file.data(), "PK\x03\x04", 4) == 0;
}

Result<ZipArchive> ZipArchive::open(std::span<const std::byte> file) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* const source = zip_source_buffer_create(file.data(), file.size(), 0, &error);
  zip_t* const opened = source != nullptr ? zip_open_from_source(source, ZIP_RDONLY, &error) : nullptr;
  const std::string why = zip_error_strerror(&error);
  zip_error_fini(&error);
  if (opened == nullptr) {
    if (source != nullptr) zip_source_free(source);
    return damaged(why);
  }
  ZipArchive archive;
  archive.archive_.reset(opened);
  std::uint64_t total = 0;
  const zip_int64_t count = zip_get_num_entries(opened, 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    zip_stat_t about;
    if (zip_stat_index(opened, static_cast<zip_uint64_t>(i), 0, &about) != 0 || (about.valid & ZIP_STAT_NAME) == 0 ||
        (about.valid & ZIP_STAT_SIZE) == 0) {
      return damaged(zip_strerror(opened));
    }
    const std::uint64_t room = largest_claim(file.size());
    if (about.size > room || total + about.size > room) {
      return damaged(
          fmt::format("'{}' says that it unpacks to {} bytes, which it cannot", printable(about.name), about.size));
    }
    total += about.size;
    if ((about.valid & ZIP_STAT_ENCRYPTION_METHOD) != 0 && about.encryption_method != ZIP_EM_NONE) {
      return bad_data(fmt::format("'{}' in the zip archive is encrypted", printable(about.name)),
                      "unpack it with its password and pack it again without one");
    }
    archive.members_.push_back({about.name, about.size});
  }
  for (std::size_t k = 0; k < archive.members_.size(); ++k) archive.places_.try_emplace(archive.members_[k].name, k);
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
  const auto place = places_.find(name);
  if (place == places_.end()) return damaged(fmt::format("it holds no '{}'", printable(std::string(name))));
  const ZipMember* const member = &members_[place->second];
  const std::uint64_t size = std::min(member->size, count);
  if (auto ok = check_memory(size); !ok) return tl::unexpected(ok.error());
  zip_t* const archive = as_zip(archive_.get());
  const auto index = static_cast<zip_uint64_t>(place->second);
  const auto close = [](zip_file_t* file) { zip_fclose(file); };
  const std::unique_ptr<zip_file_t, decltype(close)> stream(zip_fopen_index(archive, index, 0), close);
  if (!stream) return damaged(fmt::format("'{}': {}", printable(std::string(name)), zip_strerror(archive)));
  Buffer bytes(size);
  std::size_t got = 0;
  while (got < bytes.size) {
    const zip_int64_t n = zip_fread(stream.get(), bytes.data.get() + got, bytes.size - got);
    if (n <= 0) {
      return damaged(fmt::format("'{}': {}", printable(std::string(name)),
                                 n < 0 ? zip_file_strerror(stream.get()) : "it ends early"));
    }
    got += static_cast<std::size_t>(n);
  }
  if (!whole) return bytes;
  std::byte beyond;
  if (const zip_int64_t more = zip_fread(stream.get(), &beyond, 1); more != 0) {
    return damaged(fmt::format("'{}': {}", printable(std::string(name)),
                               more < 0 ? zip_file_strerror(stream.get()) : "it is longer than it says"));
  }
  return bytes;
}

}  // namespace mbk::recording
