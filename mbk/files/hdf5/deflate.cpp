#include "mbk/files/hdf5/deflate.h"

#include <libdeflate.h>
#include <zlib.h>

#include <memory>
#include <new>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace mbk::hdf5 {
namespace {

using Compressor = std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)>;

Compressor compressor_of(int level) {
  Compressor compressor(libdeflate_alloc_compressor(level), libdeflate_free_compressor);
  if (compressor == nullptr) throw std::bad_alloc();
  return compressor;
}

/// Whether bytes are fewer by a tenth once they are packed.
class WorthPacking {
 public:
  [[nodiscard]] bool operator()(std::string_view bytes) {
    constexpr std::size_t kTenths = 9;
    room_.resize(kTenths * bytes.size() / 10);
    return libdeflate_deflate_compress(quick_.get(), bytes.data(), bytes.size(), room_.data(), room_.size()) > 0;
  }

 private:
  Compressor quick_ = compressor_of(1);
  std::string room_;
};

/// A stream of zlib whose level can change on the way.
class Stream {
 public:
  /// @param parts  between which the level may change
  Stream(std::size_t bytes, std::size_t parts) {
    // More memory than usual makes its blocks long.
    constexpr int kWindow = 15, kMemory = 9;
    if (deflateInit2(&stream_, level_, Z_DEFLATED, kWindow, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
      throw std::bad_alloc();
    out_.resize(deflateBound(&stream_, bytes) + kForChange * parts);
    stream_.next_out = reinterpret_cast<Bytef*>(out_.data());
    stream_.avail_out = static_cast<uInt>(out_.size());
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() { deflateEnd(&stream_); }

  void add(std::string_view bytes, int level) {
    if (level != level_) check(deflateParams(&stream_, level, Z_DEFAULT_STRATEGY), Z_OK);
    level_ = level;
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // which zlib does not change
    stream_.avail_in = static_cast<uInt>(bytes.size());
    check(deflate(&stream_, Z_NO_FLUSH), Z_OK);
  }

  [[nodiscard]] std::string take() {
    check(deflate(&stream_, Z_FINISH), Z_STREAM_END);
    out_.resize(stream_.total_out);
    return std::move(out_);
  }

 private:
  static constexpr std::size_t kForChange = 64;  // bytes

  static void check(int code, int expected) {
    if (code != expected) throw std::logic_error("zlib: the output buffer is too small");
  }

  int level_ = kDeflateLevel;
  std::string out_;
  z_stream stream_{};
};

}  // namespace

std::string deflated(const std::string& bytes) {
  const Compressor compressor = compressor_of(kDeflateLevel);
  std::string out(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()), '\0');
  out.resize(libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), out.data(), out.size()));
  return out;
}

std::string deflated_planes(std::string_view bytes, std::size_t plane) {
  WorthPacking worth_packing;
  Stream stream(bytes.size(), bytes.size() / plane);
  for (std::size_t begin = 0; begin < bytes.size(); begin += plane) {
    const std::string_view one = bytes.substr(begin, plane);
    stream.add(one, worth_packing(one) ? kDeflateLevel : Z_NO_COMPRESSION);
  }
  return stream.take();
}

}  // namespace mbk::hdf5
