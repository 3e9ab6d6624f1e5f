#include "mbk/journal/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

namespace mbk::journal {
namespace {

using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little);

constexpr std::string_view kMagic = "MBKJRNL1";
constexpr std::uint32_t kHeader = 1, kTicks = 2, kEnding = 3;  // kinds of blocks
constexpr std::uint32_t kLargestBlock = 1U << 24U;

struct BlockHead {
  std::uint32_t kind, bytes, checksum, zero;
};
static_assert(sizeof(BlockHead) == 16);

std::uint32_t checksum(const BlockHead& head, std::span<const std::byte> payload) {
  auto sum = crc32(0, reinterpret_cast<const Bytef*>(&head), 2 * sizeof(std::uint32_t));
  sum = crc32(sum, reinterpret_cast<const Bytef*>(payload.data()), static_cast<uInt>(payload.size()));
  return static_cast<std::uint32_t>(sum);
}

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::string text_of(const Header& header) {
  Json events = Json::array();
  for (const Event& event : header.events) {
    events.push_back({{"time", event.time}, {"name", event.name}, {"value", event.value}});
  }
  return Json{{"metadata", header.metadata},
              {"d1_m", header.geometry.d1},
              {"d2_m", header.geometry.d2},
              {"rate_hz", header.rate},
              {"reference_unit", header.reference_unit},
              {"has_force", header.has_force},
              {"has_acceleration", header.has_acceleration},
              {"force_latency_ticks", header.force_latency},
              {"tick_bytes", sizeof(Tick)},
              {"events", events}}
      .dump();
}

Header header_of(const Json& json) {
  Header header;
  header.metadata = json.at("metadata").get<std::map<std::string, std::string>>();
  header.geometry.d1 = json.at("d1_m").get<double>();
  header.geometry.d2 = json.at("d2_m").get<double>();
  header.rate = json.at("rate_hz").get<double>();
  header.reference_unit = json.at("reference_unit").get<std::string>();
  header.has_force = json.at("has_force").get<bool>();
  header.has_acceleration = json.at("has_acceleration").get<bool>();
  header.force_latency = json.at("force_latency_ticks").get<int>();
  if (json.at("tick_bytes").get<std::size_t>() != sizeof(Tick)) throw std::runtime_error("ticks of another version");
  if (header.force_latency < 0) throw std::runtime_error("a force latency below zero");
  for (const Json& event : json.at("events")) {
    header.events.push_back(
        {event.at("time").get<double>(), event.at("name").get<std::string>(), event.at("value").get<double>()});
  }
  return header;
}

std::string text_of(const Ending& ending) {
  return Json{{"how", ending.how},           {"detail", ending.detail}, {"dropped", ending.dropped},
              {"overruns", ending.overruns}, {"trip", ending.trip},     {"motors", ending.motors}}
      .dump();
}

Ending ending_of(const Json& json) {
  return {json.at("how").get<std::string>(),
          json.at("detail").get<std::string>(),
          json.at("dropped").get<std::uint64_t>(),
          json.at("overruns").get<std::uint64_t>(),
          json.value("trip", ""),
          json.value("motors", "")};
}

/// Takes the payload of one block.   @throws  what JSON throws at a text that is none
void take(Journal& journal, std::uint32_t kind, std::span<const char> payload) {
  if (kind == kHeader) journal.header = header_of(Json::parse(payload.begin(), payload.end()));
  if (kind == kEnding) journal.ending = ending_of(Json::parse(payload.begin(), payload.end()));
  if (kind == kTicks) {
    const std::size_t count = payload.size() / sizeof(Tick), before = journal.ticks.size();
    journal.ticks.resize(before + count);
    std::memcpy(journal.ticks.data() + before, payload.data(), count * sizeof(Tick));
  }
}

/// The file's name is on the disk too.
Result<void> sync_folder(const std::filesystem::path& file) {
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool fine = descriptor >= 0 && fsync(descriptor) == 0;
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  if (fine || error == EINVAL) return {};  // file systems that cannot say so
  return bad_data(fmt::format("the folder does not reach the disk: {}", std::strerror(error)), "look at the disk",
                  folder.string());
}

}  // namespace

Error Writer::failure(const char* what) const {
  return {ErrorKind::data, fmt::format("{}: {}", what, std::strerror(errno)),
          "look at the disk and its free space; what is already in the file stays", file_.string()};
}

Writer::Writer(Writer&& other) noexcept
    : file_(std::move(other.file_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      end_(other.end_),
      block_(std::move(other.block_)) {}

Writer& Writer::operator=(Writer&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(end_, other.end_);
  std::swap(block_, other.block_);
  return *this;
}

Writer::~Writer() {
  if (descriptor_ >= 0) close(descriptor_);
}

Result<Writer> Writer::create(const std::filesystem::path& file, const Header& header, std::uint64_t expected) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor < 0 && errno == EEXIST) {
    return fail(ErrorKind::usage, "there is a journal already",
                "'mbk recover' makes a recording of it; then move it away", file.string());
  }
  Writer writer(file, descriptor);
  if (descriptor < 0) return tl::unexpected(writer.failure("cannot be made"));
  const auto size = static_cast<off_t>(expected * sizeof(Tick) * 11 / 10);
  if (size > 0 && fallocate(descriptor, FALLOC_FL_KEEP_SIZE, 0, size) != 0 && errno != EOPNOTSUPP) {
    const Error error = writer.failure("no space for the trial");
    unlink(file.c_str());
    return tl::unexpected(error);
  }
  auto begun = [&]() -> Result<void> {
    if (write(descriptor, kMagic.data(), kMagic.size()) != static_cast<ssize_t>(kMagic.size())) {
      return tl::unexpected(writer.failure("cannot be written"));
    }
    writer.end_ = static_cast<std::int64_t>(kMagic.size());
    if (auto ok = writer.write_block(kHeader, bytes_of(text_of(header))); !ok) return ok;
    if (auto ok = writer.sync(); !ok) return ok;
    return sync_folder(file);
  }();
  if (!begun) {
    unlink(file.c_str());
    return tl::unexpected(begun.error());
  }
  return writer;
}

Result<void> Writer::write_block(std::uint32_t kind, std::span<const std::byte> payload) {
  BlockHead head{kind, static_cast<std::uint32_t>(payload.size()), 0, 0};
  head.checksum = checksum(head, payload);
  block_.resize(sizeof(head) + payload.size());
  std::memcpy(block_.data(), &head, sizeof(head));
  std::memcpy(block_.data() + sizeof(head), payload.data(), payload.size());
  std::size_t done = 0;
  while (done < block_.size()) {
    const ssize_t wrote = write(descriptor_, block_.data() + done, block_.size() - done);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) {
      const Error error = failure("cannot be written");
      if (ftruncate(descriptor_, end_) == 0) lseek(descriptor_, end_, SEEK_SET);
      return tl::unexpected(error);
    }
    done += static_cast<std::size_t>(wrote);
  }
  end_ += static_cast<std::int64_t>(block_.size());
  return {};
}

Result<void> Writer::append(std::span<const Tick> ticks) {
  return write_block(kTicks, std::as_bytes(ticks));
}

Result<void> Writer::end(const Ending& ending) {
  if (auto ok = write_block(kEnding, bytes_of(text_of(ending))); !ok) return ok;
  if (ftruncate(descriptor_, end_) != 0) return tl::unexpected(failure("cannot be closed"));  // gives the rest back
  return sync();
}

Result<void> Writer::sync() const {
  if (fdatasync(descriptor_) != 0) return tl::unexpected(failure("does not reach the disk"));
  return {};
}

bool is_journal(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::array<char, kMagic.size()> begin{};
  return in.read(begin.data(), begin.size()) && std::string_view(begin.data(), begin.size()) == kMagic;
}

Result<Journal> read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return bad_data(fmt::format("cannot be read: {}", std::strerror(errno)), "", file.string());
  if (!is_journal(file)) {
    return bad_data("is no journal of mbk", "a journal stands beside the recording that it becomes: NAME.h5.journal",
                    file.string());
  }
  in.seekg(0, std::ios::end);
  const auto size = static_cast<std::uint64_t>(in.tellg());
  std::uint64_t at = kMagic.size();
  in.seekg(static_cast<std::streamoff>(at));
  Journal journal;
  journal.ticks.reserve(size / sizeof(Tick));  // grown step by step, an hour would take twice as much
  bool begun = false;
  std::vector<char> payload;
  for (BlockHead head{}; in.read(reinterpret_cast<char*>(&head), sizeof(head));) {
    if (head.kind < kHeader || head.kind > kEnding || head.bytes > kLargestBlock || head.bytes > size - at) break;
    payload.resize(head.bytes);
    if (!in.read(payload.data(), static_cast<std::streamsize>(payload.size()))) break;
    if (checksum(head, std::as_bytes(std::span(payload))) != head.checksum) break;
    if ((head.kind == kHeader) == begun) break;  // the header comes first, and once
    try {
      take(journal, head.kind, payload);
    } catch (const std::exception& error) {
      return bad_data(fmt::format("the journal cannot be understood: {}", error.what()),
                      "it may have been written by another version of mbk", file.string());
    }
    begun = true;
    at += sizeof(head) + head.bytes;
    if (head.kind == kEnding) break;
  }
  if (!begun) return bad_data("the journal's header is not whole", "nothing was recorded yet", file.string());
  journal.bytes_lost = size - at;
  return journal;
}

}  // namespace mbk::journal
