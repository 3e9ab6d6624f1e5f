#include "fuzz/fuzz.h"
#include "mbk/files/archive/zip_archive.h"
#include "mbk/files/tables/npy.h"
#include "mbk/files/tables/test_npy.h"

namespace mbk::fuzz {

std::vector<std::string> seeds() {
  using recording::test::npy, recording::test::raw;
  const std::string reals = raw(0.0) + raw(0.5) + raw(1.0) + raw(1.5) + raw(2.0) + raw(2.5);
  std::vector<std::string> files = {
      npy("'<f8'", "(3, 2)", reals),
      npy("'<f8'", "(3, 2)", reals, true, 2),
      npy("'>i2'", "(6,)", std::string("\0\1\0\2\0\3\0\4\0\5\0\6", 12)),
      npy("'<f2'", "(2, 1, 1)", std::string("\0\x3c\0\x40", 4), false, 3),
      npy("[('time', '<f8'), ('x', '>f4', (2,)), ('who', '<U2')]", "(1,)", reals.substr(0, 24)),
      npy("'<M8[ns]'", "(2,)", raw(std::int64_t{1709337599500000000}) + raw(std::int64_t{1709337600500000000})),
      npy("'<i8'", "(3, 1, 2)", reals),
      npy("'<f4'", "(3, 2, 2)", reals, true),
      npy("'|O'", "(2,)", "\x80\x03]q"),
  };
  files.push_back(recording::test::npz({{"time.npy", files[2]}, {"x.npy", files[2]}, {"read.me", "text"}}));
  return files;
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mbk::recording;  // NOLINT(google-build-using-namespace): this is under test
  const auto bytes = mbk::fuzz::bytes_of(data, size);
  if (looks_like_npy(bytes)) mbk::fuzz::check_decoded(decode_npy(bytes), size);
  if (!ZipArchive::looks_like_zip(bytes)) return 0;
  const auto archive = ZipArchive::open(bytes);
  if (!archive) {
    mbk::fuzz::require_error(archive.error());
  } else if (looks_like_npz(*archive)) {
    mbk::fuzz::check_decoded(decode_npz(*archive), size);
  }
  return 0;
}
