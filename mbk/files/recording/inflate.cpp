#include "mbk/files/recording/inflate.h"

#include <fmt/format.h>
#include <libdeflate.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>

#include "mbk/files/contents/memory.h"

namespace mbk::recording {
namespace {

/// Initial allocation: streams of numbers seldom compress further; beyond it memory follows the output.
constexpr std::uint64_t kUsualRatio = 16;
constexpr std::size_t kFirstGuess = std::size_t{4} << 20;
constexpr std::size_t kLargestStep = std::size_t{1} << 30;  // zlib counts in 32 bits

struct Inflater {
  z_stream stream{};
  int status = Z_OK;

  explicit Inflater(std::span<const std::byte> input) {
    // zlib's interface is not const-correct; it does not write to its input.
    stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(input.data()));
    stream.avail_in = static_cast<uInt>(input.size());
    status = inflateInit(&stream);
  }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() { inflateEnd(&stream); }

  /// Fills [out, out + size) as far as the stream goes; the number of bytes written.
  std::size_t fill(std::byte* out, std::size_t size) {
    std::size_t done = 0;
    while (done < size && status == Z_OK) {
      const std::size_t step = std::min(size - done, kLargestStep);
      stream.next_out = reinterpret_cast<Bytef*>(out + done);
      stream.avail_out = static_cast<uInt>(step);
      status = inflate(&stream, Z_NO_FLUSH);
      const std::size_t got = step - stream.avail_out;
      done += got;
      if (status == Z_OK && got == 0) status = Z_BUF_ERROR;
    }
    return done;
  }
};

constexpr auto kRemedy = "the file is damaged: copy it again from where it was recorded";

tl::unexpected<Error> wrong_size(bool more, std::size_t size) {
  return bad_data(fmt::format("compressed data contains {} {} bytes that its tag states",
                              more ? "more than the" : "fewer than the", size),
                  kRemedy);
}

tl::unexpected<Error> left_over(std::size_t bytes) {
  return bad_data(fmt::format("{} bytes follow the end of compressed data", bytes), kRemedy);
}

tl::unexpected<Error> damaged(const Inflater& inflater) {
  const std::string_view why = inflater.status == Z_DATA_ERROR && inflater.stream.msg != nullptr ? inflater.stream.msg
                               : inflater.status == Z_MEM_ERROR                                  ? "not enough memory"
                                                                                                 : "it is truncated";
  return bad_data(fmt::format("compressed data is damaged ({})", why),
                  "copy the file again from where it was recorded");
}

/// By libdeflate, which takes a little more than half of the time of zlib and wants to know the size.
Result<Buffer> inflate_at_once(std::span<const std::byte> stream, std::size_t size) {
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  if (!decompressor) throw std::bad_alloc();
  Buffer buffer(size);
  std::size_t read = 0, written = 0;
  switch (libdeflate_zlib_decompress_ex(decompressor.get(), stream.data(), stream.size(), buffer.data.get(), size,
                                        &read, &written)) {
    case LIBDEFLATE_SUCCESS:
      if (written != size) return wrong_size(false, size);
      if (read != stream.size()) return left_over(stream.size() - read);
      return buffer;
    case LIBDEFLATE_INSUFFICIENT_SPACE:
      return wrong_size(true, size);
    default:
      return bad_data("compressed data is damaged (its stream or its checksum is broken)",
                      "copy the file again from where it was recorded");
  }
}

}  // namespace

Result<Buffer> inflate_exactly(
    std::span<const std::byte> stream,
    const std::function<Result<std::uint64_t>(std::span<const std::byte, 8>)>& claimed_size) {
  Inflater inflater(stream);
  std::byte first[8];
  if (inflater.fill(first, sizeof first) != sizeof first) return damaged(inflater);
  const auto claimed = MBK_TRY(claimed_size(first));
  if (claimed > largest_claim(stream.size())) {
    return bad_data(fmt::format("{} compressed bytes claim to contain {} bytes", stream.size(), claimed), kRemedy);
  }

  const auto size = static_cast<std::size_t>(claimed);
  // The output and the numbers made from it are in memory together.
  MBK_TRY(check_memory(2 * claimed));
  if (size <= kFirstGuess + kUsualRatio * stream.size()) return inflate_at_once(stream, size);
  Buffer buffer(std::min(size, std::max(kFirstGuess, 4 * stream.size())));
  std::memcpy(buffer.data.get(), first, sizeof first);
  std::size_t done = sizeof first;
  for (;;) {
    done += inflater.fill(buffer.data.get() + done, buffer.size - done);
    if (done < buffer.size || done == size) break;
    Buffer larger(std::min(size, 2 * buffer.size));
    std::memcpy(larger.data.get(), buffer.data.get(), done);
    buffer = std::move(larger);
  }
  // One more byte of room: the checksum is read only when more output is requested.
  std::byte beyond;
  const bool more = inflater.status == Z_OK && inflater.fill(&beyond, 1) != 0;
  if (!more && inflater.status != Z_STREAM_END) return damaged(inflater);
  if (more || done != size) return wrong_size(more, size);
  if (inflater.stream.avail_in != 0) return left_over(inflater.stream.avail_in);
  return buffer;
}

}  // namespace mbk::recording
