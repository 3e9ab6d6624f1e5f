// Damaged shards of jobs: read in bounded memory, up to an error or the end; and a second time with corrected
// checksums. The same bytes are also read as the values that a process returns.

#include <unistd.h>
#include <zlib.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "fuzz/fuzz.h"
#include "mbk/batch/shard.h"
#include "mbk/batch/value_bytes.h"

namespace mbk::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMagicBytes = 8, kHeadBytes = 24, kChecksumAt = 16;

fs::path file() {
  return fs::temp_directory_path() / ("mbk_shard_fuzz_" + std::to_string(::getpid()));
}

/// One record after another, as far as their lengths allow.
std::string with_right_checksums(std::string bytes) {
  for (std::size_t at = kMagicBytes; at + kHeadBytes <= bytes.size();) {
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + at + 4, sizeof size);
    if (size > bytes.size() - at - kHeadBytes) break;
    auto sum = crc32(0, reinterpret_cast<const Bytef*>(bytes.data() + at), kChecksumAt);
    sum = crc32(sum, reinterpret_cast<const Bytef*>(bytes.data() + at + kHeadBytes), size);
    const auto checksum = static_cast<std::uint32_t>(sum);
    std::memcpy(bytes.data() + at + kChecksumAt, &checksum, sizeof checksum);
    at += kHeadBytes + size;
  }
  return bytes;
}

void check(std::string_view bytes) {
  std::ofstream(file(), std::ios::binary | std::ios::trunc) << bytes;
  auto reader = batch::ShardReader::open(file());
  if (!reader) return require_error(reader.error());
  std::size_t read = 0;
  while (true) {
    const auto record = reader->next();
    if (!record) return require_error(record.error());
    if (!*record) break;
    read += kHeadBytes + (*record)->payload.size();
    require(read + kMagicBytes <= bytes.size(), "not more is read than exists");
    if ((*record)->kind == batch::RecordKind::header) {
      if (const auto header = batch::shard_header_from((*record)->payload); !header) require_error(header.error());
    }
  }
}

struct Values {
  std::optional<double> perhaps;
  std::vector<std::pair<std::string, bool>> named;
  std::map<std::string, std::vector<double>> lists;
  Eigen::MatrixXd matrix;
};

void check_values(std::string_view bytes) {
  Values values;
  const bool whole = batch::from_bytes(bytes, values);
  require(values.named.size() <= bytes.size() && values.matrix.size() <= std::ssize(bytes), "not more than exists");
  if (!whole) return;
  Values again;
  require(batch::from_bytes(batch::to_bytes(values), again), "what is read can be written and read again");
}

}  // namespace

std::vector<std::string> seeds() {
  const fs::path folder = fs::temp_directory_path() / ("mbk_shard_fuzz_folder_" + std::to_string(::getpid()));
  fs::create_directory(folder);
  auto writer = batch::ShardWriter::create(folder, {"job", "program", 3, "host", 7, "0123456789abcdef"}).value();
  for (const auto kind : {batch::RecordKind::began, batch::RecordKind::result, batch::RecordKind::failure}) {
    require(writer->add(kind, 5, "payload").has_value(), "a record is written");
  }
  require(writer->finish("{\"units\":1}").has_value(), "a shard is ended");
  std::ifstream in(folder / "000003.0123456789abcdef.shard", std::ios::binary);
  std::string shard{std::istreambuf_iterator<char>(in), {}};
  fs::remove_all(folder);
  return {shard, batch::to_bytes(Values{1.5, {{"a", true}}, {{"b", {1.0, 2.0}}}, Eigen::MatrixXd::Ones(2, 3)})};
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(mbk::fuzz::text_of(data, size));
  mbk::fuzz::check(bytes);
  mbk::fuzz::check(mbk::fuzz::with_right_checksums(bytes));
  mbk::fuzz::check_values(bytes);
  std::filesystem::remove(mbk::fuzz::file());
  return 0;
}
