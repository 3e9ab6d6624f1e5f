#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <nlohmann/json.hpp>
#include <utility>

#include "mbk/files/journal/blocks.h"
#include "mbk/files/journal/journal.h"

namespace mbk::journal {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::uint32_t kHeaderEvery = 64;  // blocks: a header is a third of a block of ticks, 3.2 s apart

static_assert(Writer::kLongest * sizeof(Tick) <= kLargestBlock);

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

/// Invalid UTF-8 is replaced: an invalid text must not end a trial.
std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string text_of(const Header& header) {
  Json events = Json::array();
  for (const Event& event : header.events) {
    events.push_back({{"time", event.time}, {"name", event.name}, {"value", event.value}});
  }
  return dump({{"metadata", header.metadata},
               {"d1_m", header.geometry.d1},
               {"d2_m", header.geometry.d2},
               {"rate_hz", header.rate},
               {"reference_unit", header.reference_unit},
               {"has_force", header.has_force},
               {"has_acceleration", header.has_acceleration},
               {"force_latency_ticks", header.force_latency},
               {"tick_bytes", sizeof(Tick)},
               {"readable_by", word_of(header.readers)},
               {"events", events}});
}

std::string text_of(const Ending& ending) {
  return dump({{"how", ending.word()},
               {"detail", ending.detail},
               {"dropped", ending.dropped},
               {"overruns", ending.overruns},
               {"ticks", ending.ticks},
               {"trip", ending.trip},
               {"motors", ending.motors}});
}

/// Not to be met twice, and no secret.
std::uint64_t drawn_by_lot() {
  std::uint64_t number = 0;
  if (getrandom(&number, sizeof(number), GRND_NONBLOCK) == sizeof(number)) return number;
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return static_cast<std::uint64_t>(now.tv_sec) * 1'000'000'000U + static_cast<std::uint64_t>(now.tv_nsec) +
         (static_cast<std::uint64_t>(getpid()) << 40U);
}

/// The file's name is on the disk too.
Result<void> sync_folder(const fs::path& file) {
  const auto folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool fine = descriptor >= 0 && fsync(descriptor) == 0;
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  if (fine || error == EINVAL) return {};  // file systems that cannot say so
  return bad_data(fmt::format("the folder cannot be flushed to the disk: {}", std::strerror(error)), "check the disk",
                  folder.string());
}

/// Writes all of it at a place; false with errno where the disk does not take it.
bool write_at(int descriptor, std::span<const std::byte> bytes, std::int64_t place) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t wrote =
        pwrite(descriptor, bytes.data() + done, bytes.size() - done, place + static_cast<off_t>(done));
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote == 0) errno = ENOSPC;
    if (wrote <= 0) return false;
    done += static_cast<std::size_t>(wrote);
  }
  return true;
}

bool copy(int from, int to, std::int64_t length) {
  std::vector<std::byte> buffer(std::size_t{1} << 20U);
  for (std::int64_t at = 0; at < length;) {
    const auto want = std::min(buffer.size(), static_cast<std::size_t>(length - at));
    const ssize_t got = pread(from, buffer.data(), want, at);
    if (got < 0 && errno == EINTR) continue;
    if (got == 0) errno = EIO;
    if (got <= 0 || !write_at(to, std::span(buffer).first(static_cast<std::size_t>(got)), at)) return false;
    at += got;
  }
  return true;
}

/// The file's folder, those above it, and that of temporary files.
std::vector<fs::path> refuges(const fs::path& file) {
  std::error_code ignored;
  std::vector<fs::path> folders = {file.parent_path()};
  fs::path above = fs::absolute(file, ignored).parent_path();
  while (!ignored && above.has_relative_path()) folders.push_back(above = above.parent_path());
  if (fs::path temporary = fs::temp_directory_path(ignored); !ignored) folders.push_back(std::move(temporary));
  return folders;
}

/// trial.h5.journal → trial_saved.h5.journal, which `mbk recover` makes trial_saved.h5 of; then trial_saved_2 …
fs::path saved_name(const fs::path& file, int k) {
  const bool journal = file.extension() == ".journal";
  const fs::path recording = journal ? file.stem() : file.filename();
  return fmt::format("{}_saved{}{}{}", recording.stem().string(), k > 1 ? fmt::format("_{}", k) : "",
                     recording.extension().string(), journal ? ".journal" : "");
}

}  // namespace

Error Writer::failure(const char* what) const {
  return {ErrorKind::data, fmt::format("{}: {}", what, std::strerror(errno)),
          "check the disk and its free space; data already in the file is kept", file_.string()};
}

Writer::Writer(Writer&& other) noexcept : descriptor_(-1) {
  *this = std::move(other);
}

Writer& Writer::operator=(Writer&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(end_, other.end_);
  std::swap(trial_, other.trial_);
  std::swap(next_tick_, other.next_tick_);
  std::swap(blocks_, other.blocks_);
  std::swap(header_, other.header_);
  std::swap(readers_, other.readers_);
  std::swap(block_, other.block_);
  return *this;
}

Writer::~Writer() {
  if (descriptor_ >= 0) close(descriptor_);
}

Result<Writer> Writer::create(const fs::path& file, const Header& header, std::uint64_t expected) {
  const int descriptor = open(file.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (descriptor < 0 && errno == EEXIST) {
    return tl::unexpected(already_there(file));
  }
  Writer writer(file, descriptor);
  if (descriptor < 0) return tl::unexpected(writer.failure("cannot be created"));
  writer.lock();
  writer.trial_ = drawn_by_lot();
  writer.header_ = text_of(header);
  writer.readers_ = header.readers;
  writer.block_.reserve(sizeof(BlockHead) + kLongest * sizeof(Tick));  // no block waits for memory
  const auto size = static_cast<off_t>(expected * sizeof(Tick) * 11 / 10);
  if (size > 0 && fallocate(descriptor, FALLOC_FL_KEEP_SIZE, 0, size) != 0 && errno != EOPNOTSUPP) {
    const Error error = writer.failure("the disk has no space for the trial");
    unlink(file.c_str());
    return tl::unexpected(error);
  }
  auto begun = [&]() -> Result<void> {
    if (fchmod(descriptor, permissions(header.readers)) != 0 || !write_at(descriptor, bytes_of(kMagic), 0)) {
      return tl::unexpected(writer.failure("cannot be written"));
    }
    writer.end_ = static_cast<std::int64_t>(kMagic.size());
    MBK_TRY(writer.write_block(kHeader, bytes_of(writer.header_)));
    MBK_TRY(writer.sync());
    return sync_folder(file);
  }();
  if (!begun) {
    unlink(file.c_str());
    return tl::unexpected(begun.error());
  }
  return writer;
}

Error Writer::already_there(const fs::path& file) {
  if (const int process = recorded_by(file); process != 0) {
    return {ErrorKind::usage, fmt::format("is being recorded by process {}", process), "choose another name",
            file.string()};
  }
  return {ErrorKind::usage, "a journal already exists", "convert it with 'mbk recover', then move it away",
          file.string()};
}

/// Held by the process until it closes the file; file systems that know no locks have none.
void Writer::lock() const {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  fcntl(descriptor_, F_SETLK, &whole);
}

int recorded_by(const fs::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return 0;
  struct flock whole {};
  whole.l_type = F_WRLCK;
  const bool held = fcntl(descriptor, F_GETLK, &whole) == 0 && whole.l_type != F_UNLCK;
  close(descriptor);
  return held ? static_cast<int>(whole.l_pid) : 0;
}

Result<void> Writer::write_block(std::uint32_t kind, std::span<const std::byte> payload) {
  BlockHead head;
  head.trial = trial_;
  head.next_tick = next_tick_;
  head.kind = kind;
  head.bytes = static_cast<std::uint32_t>(payload.size());
  head.number = blocks_;
  auto sum = crc32(0, reinterpret_cast<const Bytef*>(&head), offsetof(BlockHead, checksum));
  sum = crc32(sum, reinterpret_cast<const Bytef*>(payload.data()), static_cast<uInt>(payload.size()));
  head.checksum = static_cast<std::uint32_t>(sum);
  block_.resize(sizeof(head) + payload.size());
  std::memcpy(block_.data(), &head, sizeof(head));
  std::memcpy(block_.data() + sizeof(head), payload.data(), payload.size());
  if (!write_at(descriptor_, block_, end_)) {
    const Error error = failure("cannot be written");
    if (ftruncate(descriptor_, end_) != 0) return tl::unexpected(error);  // existing data is overwritten
    return tl::unexpected(error);
  }
  end_ += static_cast<std::int64_t>(block_.size());
  ++blocks_;
  return {};
}

Result<void> Writer::append(std::span<const Tick> ticks) {
  if (blocks_ % kHeaderEvery == 0) {
    MBK_TRY(write_block(kHeader, bytes_of(header_)));
  }
  next_tick_ = ticks.front().number;
  MBK_TRY(write_block(kTicks, std::as_bytes(ticks)));
  next_tick_ = ticks.back().number + 1;
  return {};
}

Result<void> Writer::end(const Ending& ending) {
  next_tick_ = std::max(next_tick_, ending.ticks);
  MBK_TRY(write_block(kHeader, bytes_of(header_)));
  MBK_TRY(write_block(kEnding, bytes_of(text_of(ending))));
  if (ftruncate(descriptor_, end_) != 0) return tl::unexpected(failure("cannot be closed"));  // gives the rest back
  return sync();
}

Result<void> Writer::sync() const {
  if (!reaches_disk()) return tl::unexpected(failure("cannot be flushed to the disk"));
  return {};
}

bool Writer::reaches_disk() const noexcept {
  return fdatasync(descriptor_) == 0;
}

Writer::Place Writer::place() const {
  struct stat open_file {
  }, named{};
  if (fstat(descriptor_, &open_file) != 0) return Place::here;  // nobody can say
  if (stat(file_.c_str(), &named) != 0) return errno == ENOENT || errno == ENOTDIR ? Place::gone : Place::here;
  if (named.st_ino != open_file.st_ino || named.st_dev != open_file.st_dev) return Place::gone;
  return open_file.st_size < end_ ? Place::cut : Place::here;
}

Result<void> Writer::save_elsewhere() {
  constexpr int kMaxTries = 1000;
  fs::path name;
  int saved = -1;
  for (const fs::path& folder : refuges(file_)) {
    for (int k = 1; k <= kMaxTries && saved < 0; ++k) {
      name = folder / saved_name(file_, k);
      saved = open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
      if (saved < 0 && errno != EEXIST) break;
    }
    if (saved >= 0) break;
  }
  if (saved < 0) return tl::unexpected(failure("cannot be saved under another name"));
  const bool fine = fchmod(saved, permissions(readers_)) == 0 && copy(descriptor_, saved, end_) &&
                    fdatasync(saved) == 0 && dup3(saved, descriptor_, O_CLOEXEC) >= 0;
  const Error error = failure("cannot be saved under another name");
  close(saved);
  if (!fine) {
    unlink(name.c_str());
    return tl::unexpected(error);
  }
  file_ = name;
  lock();
  return sync_folder(name);
}

}  // namespace mbk::journal
