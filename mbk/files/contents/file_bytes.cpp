#include "mbk/files/contents/file_bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <new>
#include <system_error>
#include <utility>

#include "mbk/base/system/files.h"
#include "mbk/base/system/mapping.h"
#include "mbk/files/contents/memory.h"

namespace mbk::recording {
namespace {

std::string reason(int code) {
  return std::generic_category().message(code);
}

struct Opened {
  system::OpenFile file;
  std::size_t size;
};

Result<Opened> open_file(const std::filesystem::path& file) {
  system::OpenFile opened = system::open_to_read(file);  // of a pipe it must not wait for the writer
  if (!opened) {
    if (errno == ENOENT) return bad_data("there is no such file", "check the name and the folder");
    return bad_data(fmt::format("cannot be opened: {}", reason(errno)), "check its permissions");
  }
  const auto status = system::status_of(opened);
  using Kind = system::FileStatus::Kind;
  if (!status) return bad_data(fmt::format("cannot be read: {}", reason(errno)));
  if (status->kind == Kind::folder) return bad_data("this is a folder, not a file", "name the recording in it");
  if (status->kind != Kind::regular) {
    return bad_data("this is not a regular file", "copy the recording to a file first");
  }
  if (status->size == 0) return bad_data("the file is empty", "copy it again");
  if (status->size > kLargestFile) {
    return bad_data(fmt::format("the file has {} bytes; the limit is {}", status->size, kLargestFile),
                    "split the recording into numbered parts");
  }
  return Opened{std::move(opened), static_cast<std::size_t>(status->size)};
}

/// Reads until all of it is there.
Result<void> read_bytes(int descriptor, std::size_t from, void* to, std::size_t count) {
  for (std::size_t done = 0; done < count;) {
    const auto got = system::read_some_at(descriptor, static_cast<std::byte*>(to) + done, count - done, from + done);
    if (got < 0) return bad_data(fmt::format("cannot be read: {}", reason(errno)));
    if (got == 0) return bad_data("the file became shorter while it was being read", "wait until writing has finished");
    done += static_cast<std::size_t>(got);
  }
  return {};
}

using Bytes = std::unique_ptr<std::byte[], Buffer::Free>;

/// In large pages if the system has them, except at the end: unused parts take no memory.
Bytes mapped_bytes(std::size_t n) {
  constexpr std::size_t kPage = std::size_t{2} << 20;
  const std::size_t whole = (n + kPage - 1) / kPage * kPage;  // which a system aligns
  void* const room = system::map_memory(whole);
  if (room == nullptr) throw std::bad_alloc();
  return Bytes(static_cast<std::byte*>(room), Buffer::Free{whole});
}

Bytes bytes_of_heap(std::size_t n) {
  return Bytes(static_cast<std::byte*>(::operator new(n)), Buffer::Free{});
}

}  // namespace

void FreeBytes::operator()(std::byte* bytes) const {
  if (mapped > 0) {
    system::unmap_memory(bytes, mapped);
  } else {
    ::operator delete(bytes);
  }
}

Buffer::Buffer(std::size_t n) : data(n >= std::size_t{16} << 20 ? mapped_bytes(n) : bytes_of_heap(n)), size(n) {}

namespace {

Result<Buffer> read_whole(int descriptor, std::size_t size) {
  // The numbers in it take at least as much again, before its bytes can go.
  MBK_TRY(check_memory(2 * std::uint64_t{size}));
  Buffer buffer(size);
  MBK_TRY(read_bytes(descriptor, 0, buffer.data.get(), size));
  return buffer;
}

}  // namespace

Result<Buffer> read_file(const std::filesystem::path& file) {
  const auto open = MBK_TRY(open_file(file));
  return read_whole(open.file.number(), open.size);
}

Result<OpenFile> OpenFile::open(const std::filesystem::path& file) {
  OpenFile made;
  made.path_ = file;
  MBK_TRY(made.wake());
  made.begin_.resize(std::min(kBegin, made.size_));
  MBK_TRY(read_bytes(made.file_.number(), 0, made.begin_.data(), made.begin_.size()));
  return made;
}

OpenFile::OpenFile(OpenFile&& other) noexcept
    : path_(std::move(other.path_)),
      file_(std::move(other.file_)),
      size_(other.size_),
      begin_(std::move(other.begin_)),
      bytes_(std::move(other.bytes_)),
      passing_sum_(std::move(other.passing_sum_)),
      sum_(std::move(other.sum_)) {}

OpenFile::~OpenFile() {
  rest();
}

void OpenFile::rest() {
  file_.close();
}

Result<void> OpenFile::wake() {
  if (file_) return {};
  auto opened = MBK_TRY(open_file(path_));
  file_ = std::move(opened.file);
  size_ = opened.size;
  return {};
}

Result<std::shared_ptr<Buffer>> OpenFile::bytes() {
  if (bytes_ != nullptr) return bytes_;
  MBK_TRY(wake());
  auto all = MBK_TRY(read_whole(file_.number(), size_));
  sum_ = recording::sha256(all.bytes());
  bytes_ = std::make_shared<Buffer>(std::move(all));
  return bytes_;
}

Result<std::shared_ptr<Buffer>> OpenFile::take() {
  auto all = bytes();
  bytes_.reset();
  return all;
}

Result<FileInPassing> OpenFile::in_passing() {
  MBK_TRY(wake());
  void* const room = system::reserve_memory(size_);
  if (room == nullptr) throw std::bad_alloc();
  passing_sum_ = std::make_shared<Sha256>();
  return FileInPassing(file_.number(), size_, static_cast<char*>(room), passing_sum_);
}

const std::string& OpenFile::sha256() {
  if (sum_.empty() && passing_sum_ != nullptr) sum_ = passing_sum_->hex();
  return sum_;
}

FileInPassing::FileInPassing(FileInPassing&& other) noexcept
    : descriptor_(other.descriptor_),
      size_(other.size_),
      read_(other.read_),
      forgotten_(other.forgotten_),
      data_(std::exchange(other.data_, nullptr)),
      spare_(other.spare_),
      sum_(std::move(other.sum_)),
      ahead_(std::move(other.ahead_)) {}

FileInPassing::~FileInPassing() {
  if (ahead_.valid()) ahead_.wait();
  if (data_ != nullptr) system::unmap_memory(data_, size_);
}

void FileInPassing::read_ahead() {
  use_spare();
  const auto read = [descriptor = descriptor_, from = read_, to = data_ + read_,
                     count = std::min(kPiece, size_ - read_), sum = sum_.get()]() -> Result<void> {
    MBK_TRY(read_bytes(descriptor, from, to, count));
    sum->add(std::as_bytes(std::span(to, count)));
    return {};
  };
  // With both flags, a system without a free thread runs it on demand.
  const bool several = size_ > kPiece;
  ahead_ = std::async(several ? std::launch::async | std::launch::deferred : std::launch::deferred, read);
}

Result<void> FileInPassing::read_on() {
  if (!ahead_.valid()) read_ahead();
  MBK_TRY(ahead_.get());
  read_ += std::min(kPiece, size_ - read_);
  if (read_ < size_) read_ahead();
  return {};
}

void FileInPassing::forget(std::size_t before) {
  const std::size_t end = before / kPiece * kPiece;
  if (end <= forgotten_) return;
  // The memory of the last one serves the next that is read: it need not be cleared again.
  char* const from = spare_ != nullptr ? spare_ : data_ + forgotten_;
  spare_ = data_ + end - kPiece;
  system::forget_memory(from, static_cast<std::size_t>(spare_ - from));
  forgotten_ = end;
}

void FileInPassing::use_spare() {
  if (spare_ == nullptr || size_ - read_ < kPiece) return;
  if (system::move_memory(spare_, data_ + read_, kPiece)) spare_ = nullptr;
}

}  // namespace mbk::recording
