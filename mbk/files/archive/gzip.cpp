#include "mbk/files/archive/gzip.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>

#include "mbk/files/contents/byte_view.h"
#include "mbk/files/contents/memory.h"

namespace mbk::recording {
namespace {

constexpr std::string_view kCopyAgain = "copy the file again from where it was recorded";
constexpr std::size_t kShortest = 18;  ///< header and trailer
constexpr int kGzip = 16 + MAX_WBITS;  ///< windowBits that ask zlib for gzip's header and checksum

struct EndInflating {
  void operator()(z_stream* stream) const { inflateEnd(stream); }
};

tl::unexpected<Error> gzip_damaged(std::string_view what) {
  return bad_data(fmt::format("the gzip file cannot be unpacked: {}", what), std::string(kCopyAgain));
}

tl::unexpected<Error> too_large(std::uint64_t limit) {
  return bad_data(
      fmt::format("the gzip file unpacks to more than {} MB, which is implausible for a recording of this file size",
                  limit >> 20U),
      "unpack it with gunzip and check its contents");
}

/// Bytes that arrive in pieces.
class GrowingBytes {
 public:
  GrowingBytes(std::uint64_t expected, std::uint64_t limit)
      : buffer_(static_cast<std::size_t>(std::clamp<std::uint64_t>(expected, kMin, limit))), limit_(limit) {}

  [[nodiscard]] std::span<std::byte> room() const { return {buffer_.data.get() + used_, buffer_.size - used_}; }
  void add(std::size_t count) { used_ += count; }
  /// Makes room for as much again.
  Result<void> grow() {
    if (buffer_.size >= limit_) return too_large(limit_);
    const std::uint64_t size = std::min<std::uint64_t>(2 * std::uint64_t{buffer_.size}, limit_);
    MBK_TRY(check_memory(size));
    Buffer larger(static_cast<std::size_t>(size));
    std::memcpy(larger.data.get(), buffer_.data.get(), used_);
    buffer_ = std::move(larger);
    return {};
  }
  [[nodiscard]] Buffer take() {
    buffer_.size = used_;
    return std::move(buffer_);
  }
  [[nodiscard]] std::size_t size() const { return used_; }

 private:
  static constexpr std::uint64_t kMin = 4096;
  Buffer buffer_;
  std::size_t used_ = 0;
  std::uint64_t limit_;
};

}  // namespace

bool looks_like_gzip(std::span<const std::byte> file) {
  return file.size() >= kShortest && file[0] == std::byte{0x1F} && file[1] == std::byte{0x8B} &&
         file[2] == std::byte{8};
}

std::string gunzip_begin(std::span<const std::byte> file, std::size_t count) {
  z_stream stream{};
  if (!looks_like_gzip(file) || inflateInit2(&stream, kGzip) != Z_OK) return {};
  const std::unique_ptr<z_stream, EndInflating> end(&stream);
  std::string begin(count, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(file.data()));
  stream.avail_in = static_cast<uInt>(file.size());
  stream.next_out = reinterpret_cast<Bytef*>(begin.data());
  stream.avail_out = static_cast<uInt>(count);
  inflate(&stream, Z_NO_FLUSH);
  begin.resize(count - stream.avail_out);
  return begin;
}

Result<Buffer> gunzip(std::span<const std::byte> file) {
  if (!looks_like_gzip(file)) return gzip_damaged("it has no gzip signature");
  z_stream stream{};
  if (inflateInit2(&stream, kGzip) != Z_OK) return bad_data("there is not enough memory to unpack the gzip file");
  const std::unique_ptr<z_stream, EndInflating> end(&stream);
  // The trailer gives the size of the last member, modulo 2³². It is used up to the limit of such a file.
  const std::uint64_t limit = largest_unpacked(file.size());
  const std::uint64_t said = std::min<std::uint64_t>(ByteView{file}.at<std::uint32_t>(file.size() - 4), limit);
  MBK_TRY(check_memory(said));
  GrowingBytes bytes(said + 1, limit);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(file.data()));
  std::size_t left = file.size();
  for (;;) {
    if (bytes.room().empty()) {
      MBK_TRY(bytes.grow());
    }
    constexpr std::size_t kMax = std::numeric_limits<uInt>::max();
    const auto in = static_cast<uInt>(std::min(left, kMax)),
               out = static_cast<uInt>(std::min(bytes.room().size(), kMax));
    stream.avail_in = in;
    stream.next_out = reinterpret_cast<Bytef*>(bytes.room().data());
    stream.avail_out = out;
    const int state = inflate(&stream, Z_NO_FLUSH);
    bytes.add(out - stream.avail_out);
    left -= in - stream.avail_in;
    if (state == Z_STREAM_END) {
      if (left == 0) break;
      if (inflateReset(&stream) != Z_OK) return gzip_damaged("it is not a valid gzip stream");
      continue;
    }
    if (state == Z_MEM_ERROR) return bad_data("there is not enough memory to unpack the gzip file");
    if (state != Z_OK && state != Z_BUF_ERROR)
      return gzip_damaged(stream.msg != nullptr ? stream.msg : "it is damaged");
    if (left == 0 && stream.avail_out > 0) return gzip_damaged("it is truncated");
  }
  if (bytes.size() == 0) return gzip_damaged("it is empty");
  return bytes.take();
}

}  // namespace mbk::recording
