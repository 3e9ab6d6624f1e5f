#include "mbk/files/ros/forward_bytes.h"

#include <bzlib.h>
#include <fmt/format.h>
#include <libdeflate.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <vector>

namespace mbk::recording {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 18;

tl::unexpected<Error> broken(std::string_view packing, std::string_view why) {
  return bad_data(fmt::format("a chunk compressed with {} is damaged: {}", packing, why), std::string(kCopyAgain));
}

/// Unpacked bytes that were not yet taken, and the means to unpack more.
class Unpacking : public ForwardBytes {
 public:
  explicit Unpacking(ForwardBytes& packed) : packed_(&packed) {}

 protected:
  /// Unpacks to `out`, at least one byte where the end has not come. The number of bytes; 0 at the end.
  [[nodiscard]] virtual Result<std::size_t> unpack(std::span<std::byte> out) = 0;

  /// Whether there are packed bytes in `in_`; more are fetched where all were used.
  [[nodiscard]] Result<bool> has_input() {
    if (!in_.empty()) return true;
    in_ = MBK_TRY(packed_->take(kPiece));
    return !in_.empty();
  }
  std::span<const std::byte> in_;  // NOLINT: of the classes below

 private:
  Result<std::span<const std::byte>> next(std::size_t count) override {
    if (end_ - begin_ < count) {
      std::memmove(room_.data(), room_.data() + begin_, end_ - begin_);
      end_ -= begin_;
      begin_ = 0;
    }
    while (end_ - begin_ < count && !ended_) {
      if (room_.size() - end_ < kPiece) room_.resize(std::max(2 * room_.size(), end_ + kPiece));
      const auto made = MBK_TRY(unpack(std::span(room_).subspan(end_)));
      ended_ = made == 0;
      end_ += made;
    }
    const auto bytes = std::span<const std::byte>(room_).subspan(begin_, std::min(count, end_ - begin_));
    begin_ += bytes.size();
    return bytes;
  }

  ForwardBytes* packed_;
  std::vector<std::byte> room_;
  std::size_t begin_ = 0, end_ = 0;  ///< of the bytes in `room_`
  bool ended_ = false;
};

class Zstd : public Unpacking {
 public:
  explicit Zstd(ForwardBytes& packed) : Unpacking(packed), stream_(ZSTD_createDCtx()) {
    if (!stream_) throw std::bad_alloc();
  }

 private:
  Result<std::size_t> unpack(std::span<std::byte> out) override {
    ZSTD_outBuffer made{out.data(), out.size(), 0};
    for (;;) {
      const auto input = MBK_TRY(has_input());
      ZSTD_inBuffer used{in_.data(), in_.size(), 0};
      const std::size_t left = ZSTD_decompressStream(stream_.get(), &made, &used);
      if (ZSTD_isError(left) != 0) return broken("zstd", ZSTD_getErrorName(left));
      in_ = in_.subspan(used.pos);
      if (used.pos > 0 || made.pos > 0) within_ = left != 0;
      if (made.pos > 0) return made.pos;
      if (input) continue;
      if (within_) return broken("zstd", "it is truncated");
      return 0;
    }
  }

  struct Free {
    void operator()(ZSTD_DCtx* stream) const { ZSTD_freeDCtx(stream); }
  };
  std::unique_ptr<ZSTD_DCtx, Free> stream_;
  bool within_ = false;  ///< a frame
};

class Lz4 : public Unpacking {
 public:
  explicit Lz4(ForwardBytes& packed) : Unpacking(packed) {
    LZ4F_dctx* stream = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&stream, LZ4F_VERSION)) != 0) throw std::bad_alloc();
    stream_.reset(stream);
  }

 private:
  Result<std::size_t> unpack(std::span<std::byte> out) override {
    for (;;) {
      const auto input = MBK_TRY(has_input());
      std::size_t made = out.size(), used = in_.size();
      const std::size_t left = LZ4F_decompress(stream_.get(), out.data(), &made, in_.data(), &used, nullptr);
      if (LZ4F_isError(left) != 0) return broken("lz4", LZ4F_getErrorName(left));
      in_ = in_.subspan(used);
      if (used > 0 || made > 0) within_ = left != 0;
      if (made > 0) return made;
      if (input) continue;
      if (within_) return broken("lz4", "it is truncated");
      return 0;
    }
  }

  struct Free {
    void operator()(LZ4F_dctx* stream) const { LZ4F_freeDecompressionContext(stream); }
  };
  std::unique_ptr<LZ4F_dctx, Free> stream_;
  bool within_ = false;  ///< a frame
};

class Bz2 : public Unpacking {
 public:
  explicit Bz2(ForwardBytes& packed) : Unpacking(packed) {
    if (BZ2_bzDecompressInit(&stream_, 0, 0) != BZ_OK) throw std::bad_alloc();
  }
  Bz2(const Bz2&) = delete;
  Bz2& operator=(const Bz2&) = delete;
  ~Bz2() override { BZ2_bzDecompressEnd(&stream_); }

 private:
  Result<std::size_t> unpack(std::span<std::byte> out) override {
    if (ended_) return 0;
    stream_.next_out = reinterpret_cast<char*>(out.data());
    stream_.avail_out = static_cast<unsigned>(std::min<std::size_t>(out.size(), 1U << 30));
    const unsigned room = stream_.avail_out;
    while (stream_.avail_out == room) {
      const auto input = MBK_TRY(has_input());
      // The library takes its input as text that it could change, and does not.
      stream_.next_in = const_cast<char*>(reinterpret_cast<const char*>(in_.data()));  // NOLINT
      stream_.avail_in = static_cast<unsigned>(in_.size());
      const int state = BZ2_bzDecompress(&stream_);
      in_ = in_.last(stream_.avail_in);
      ended_ = state == BZ_STREAM_END;
      if (ended_) break;
      if (state != BZ_OK) return broken("bz2", fmt::format("error {}", state));
      if (!input && stream_.avail_out == room) return broken("bz2", "it is truncated");
    }
    return room - stream_.avail_out;
  }

  bz_stream stream_{};
  bool ended_ = false;
};

}  // namespace

Result<std::span<const std::byte>> ForwardBytes::take(std::size_t count) {
  auto bytes = next(count);
  if (!bytes) return bytes;
  position_ += bytes->size();
  crc_ = libdeflate_crc32(crc_, bytes->data(), bytes->size());
  return bytes;
}

Result<bool> ForwardBytes::skip(std::uint64_t count) {
  while (count > 0) {
    const auto bytes = MBK_TRY(take(static_cast<std::size_t>(std::min<std::uint64_t>(count, kPiece))));
    if (bytes.empty()) return false;
    count -= bytes.size();
  }
  return true;
}

Result<std::span<const std::byte>> GivenBytes::next(std::size_t count) {
  const auto begin = static_cast<std::size_t>(position());
  return bytes_.subspan(begin, std::min(count, bytes_.size() - begin));
}

Result<std::span<const std::byte>> PassingBytes::next(std::size_t count) {
  const auto begin = static_cast<std::size_t>(position());
  file_->forget(begin);
  count = std::min(count, file_->size() - begin);
  while (file_->text().size() - begin < count) {
    MBK_TRY(file_->read_on());
  }
  return std::as_bytes(std::span(file_->text().substr(begin, count)));
}

Result<std::span<const std::byte>> PartOfBytes::next(std::size_t count) {
  const auto bytes = whole_->take(static_cast<std::size_t>(std::min<std::uint64_t>(count, left_)));
  if (bytes) left_ -= bytes->size();
  return bytes;
}

std::unique_ptr<ForwardBytes> unpacked(Packing packing, ForwardBytes& packed) {
  switch (packing) {
    case Packing::zstd:
      return std::make_unique<Zstd>(packed);
    case Packing::lz4:
      return std::make_unique<Lz4>(packed);
    case Packing::bz2:
      return std::make_unique<Bz2>(packed);
    case Packing::none:
      break;
  }
  return std::make_unique<PartOfBytes>(packed, ~std::uint64_t{0});
}

}  // namespace mbk::recording
