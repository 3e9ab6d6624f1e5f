// What no program that measures a MAT v7 file can do without: its bytes read, inflated and hashed, into memory that is
// there before. For whole_command.py; prints the median processor times of so many turns as one line of JSON.
//   bench_floor LOG.mat TURNS
#include <libdeflate.h>
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "mbk/files/contents/sha256.h"

namespace {

/// Of this process: what else the machine does leaves it alone.
double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

bool read(const char* path, std::vector<std::byte>& bytes) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return false;
  bytes.resize(static_cast<std::size_t>(file.tellg()));
  file.seekg(0);
  return static_cast<bool>(
      file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())));
}

/// The zlib streams of a MAT file of level 5: its elements of type miCOMPRESSED behind the header of 128 bytes.
std::vector<std::span<const std::byte>> streams(std::span<const std::byte> bytes) {
  constexpr std::size_t kHeader = 128, kTag = 8;
  constexpr std::uint32_t kCompressed = 15;
  std::vector<std::span<const std::byte>> found;
  for (std::size_t at = kHeader; at + kTag <= bytes.size();) {
    std::uint32_t type = 0, size = 0;
    std::memcpy(&type, &bytes[at], sizeof(type));
    std::memcpy(&size, &bytes[at + sizeof(type)], sizeof(size));
    if (at + kTag + size > bytes.size()) break;
    if (type == kCompressed) found.push_back(bytes.subspan(at + kTag, size));
    at += kTag + size;
  }
  return found;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::byte> bytes;
  const int turns = argc == 3 ? std::atoi(argv[2]) : 0;
  if (turns < 1 || !read(argv[1], bytes)) {
    std::fputs("usage: bench_floor LOG.mat TURNS; see whole_command.py\n", stderr);
    return 2;
  }
  const auto compressed = streams(bytes);
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> decompressor(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  std::vector<std::byte> out(1 << 20);
  const auto inflate = [&](std::span<const std::byte> stream) {
    std::size_t size = 0;
    return libdeflate_zlib_decompress(decompressor.get(), stream.data(), stream.size(), out.data(), out.size(), &size);
  };
  for (const auto& stream : compressed) {
    libdeflate_result result = LIBDEFLATE_SUCCESS;
    while ((result = inflate(stream)) == LIBDEFLATE_INSUFFICIENT_SPACE) out.resize(2 * out.size());
    if (result != LIBDEFLATE_SUCCESS) {
      std::fputs("bench_floor: a stream of the file is broken\n", stderr);
      return 3;
    }
  }
  std::vector<double> reading, inflating, hashing;
  for (int turn = 0; turn < turns; ++turn) {
    const double begin = cpu_seconds();
    if (!read(argv[1], bytes)) return 3;
    const double there = cpu_seconds();
    for (const auto& stream : compressed) {
      if (inflate(stream) != LIBDEFLATE_SUCCESS) return 3;
    }
    const double inflated = cpu_seconds();
    const std::string hash = mbk::recording::sha256(bytes);
    const double hashed = cpu_seconds();
    if (hash.size() != 64) return 3;
    reading.push_back(there - begin);
    inflating.push_back(inflated - there);
    hashing.push_back(hashed - inflated);
  }
  std::puts(nlohmann::json{{"streams", compressed.size()},
                           {"read_s", median(reading)},
                           {"inflate_s", median(inflating)},
                           {"sha256_s", median(hashing)}}
                .dump()
                .c_str());
  return 0;
}
