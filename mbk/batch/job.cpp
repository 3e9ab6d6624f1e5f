#include "mbk/batch/job.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>
#include <sstream>
#include <system_error>

#include "mbk/base/core/vector4.h"
#include "mbk/base/core/version.h"
#include "mbk/base/system/files.h"
#include "mbk/base/system/process.h"
#include "mbk/batch/job_status.h"
#include "mbk/files/contents/durable_files.h"
#include "mbk/files/contents/sha256.h"

namespace mbk::batch {
namespace {

namespace fs = std::filesystem;

constexpr const char *kJob = "job.json", *kUnits = "units.txt", *kChunks = "chunks.txt";
// A line of chunks.txt has this many characters, so that a task reads its own alone.
constexpr std::size_t kChunkLine = 64;

/// Writes a file that appears whole or not at all.
Result<void> write_whole(const fs::path& file, std::string_view text) {
  const fs::path part = file.parent_path() / fmt::format(".{}.{}.part", file.filename().string(), system::process_id());
  system::remove_name(part);  // of a process of that number that went down
  system::OpenFile out = system::create_new(part);
  int code = out ? system::write_all(out.number(), std::as_bytes(std::span(text))) : errno;
  if (code == 0) code = system::flush(out);
  if (const int closed = out.close(); code == 0) code = closed;
  if (code != 0) {
    system::remove_name(part);
    return bad_data(fmt::format("cannot be written: {}", std::generic_category().message(code)),
                    system::is_full(code) ? "free space on the disk" : "check the permissions of the folder",
                    file.string());
  }
  return files::rename_on_disk(part, file);
}

Result<std::string> read_whole(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) return bad_data("cannot be read", "check its permissions", file.string());
  return text.str();
}

tl::unexpected<Error> damaged(const fs::path& file) {
  return bad_data("the file is damaged", "remove the job's folder, and start the job again", file.string());
}

Result<Job> job_from(const fs::path& file) {
  const auto text = MBK_TRY(read_whole(file));
  try {
    const auto json = nlohmann::json::parse(text);
    if (json.at("schema") != "mbk.job/1") {
      return bad_data("the job is from another version of mbk", "finish it with the version that started it",
                      file.string());
    }
    Job job;
    job.id = json.at("id");
    job.kind = json.at("kind");
    job.specification = json.at("specification").dump();
    job.program = json.at("program");
    job.simd = json.at("simd");
    job.title = json.at("title");
    job.units = json.at("units");
    job.chunks = json.at("chunks");
    job.memory_mb = json.at("memory_mb");
    return job;
  } catch (const nlohmann::json::exception&) {
    return damaged(file);
  }
}

}  // namespace

std::string program_identity() {
  static const std::string kIdentity = [] {
    const std::string build = system::build_identity();
    return fmt::format("{} {}", version(), build.empty() ? "without a build identity" : build);
  }();
  return kIdentity;
}

double chunk_length(double total_s, int tasks, const ChunkLengths& lengths) {
  constexpr double kChunksPerTask = 16.0, kLongest = 300.0;
  constexpr int kTasksOfCluster = 100;
  const double even_s = total_s / (kChunksPerTask * (tasks > 0 ? tasks : kTasksOfCluster));
  const double length_s = std::clamp(even_s, lengths.shortest_s, kLongest);
  if (tasks == 0) return length_s;
  const double rounds = std::max(std::ceil(total_s / (length_s * tasks)), 1.0);
  return std::max(total_s / (rounds * tasks), lengths.min_s);
}

std::vector<std::int64_t> cut_into_chunks(std::span<const double> costs, double target_s, std::int64_t max_chunks) {
  const double total = std::accumulate(costs.begin(), costs.end(), 0.0);
  // A chunk ends with the unit that brings it past its share, so that there are never more than were asked for.
  const double share = std::max(target_s, total / static_cast<double>(std::max<std::int64_t>(max_chunks, 1)));
  std::vector<std::int64_t> ends;
  double sum = 0.0;
  for (std::size_t k = 0; k < costs.size(); ++k) {
    sum += costs[k];
    const bool last = k + 1 == costs.size();
    if (last || (sum >= share * (1.0 - 1e-9) && std::ssize(ends) + 1 < max_chunks)) {
      ends.push_back(static_cast<std::int64_t>(k) + 1);
      sum = 0.0;
    }
  }
  return ends;
}

bool JobFolder::is_there(const fs::path& folder) {
  std::error_code ignored;
  return fs::exists(folder / kJob, ignored);
}

Result<JobFolder> JobFolder::create(const fs::path& folder, Job job, std::span<const std::string> keys,
                                    std::span<const std::int64_t> ends, std::span<const double> costs) {
  if (is_there(folder)) return bad_usage("the folder already contains a job", "name another folder");
  std::error_code error;
  if (folder.has_parent_path()) fs::create_directories(folder.parent_path(), error);
  JobFolder made;
  made.folder_ = folder;
  for (const fs::path& one : {folder, made.shards(), made.logs()}) {
    MBK_TRY(files::make_folder(one));
  }
  job.program = program_identity();
  job.simd = word_of(simd());
  job.units = std::ssize(keys);
  job.chunks = std::ssize(ends);
  std::string units, chunks;
  std::int64_t first = 0;
  for (const std::int64_t end : ends) {
    const auto offset = units.size();
    double cost = 0.0;
    for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(end); ++k) {
      units += keys[k] + '\n';
      cost += costs[k];
    }
    const std::string line = fmt::format("{} {} {} {} {:.6g}", first, end - first, offset, units.size() - offset, cost);
    if (line.size() >= kChunkLine) return bad_data("there are too many units", "split the work into several jobs");
    chunks += fmt::format("{:<{}}\n", line, kChunkLine - 1);
    first = end;
  }
  recording::Sha256 sum;
  const auto add = [&](std::string_view text) {
    sum.add(std::as_bytes(std::span(text)));
    sum.add(std::as_bytes(std::span("\0", 1)));
  };
  for (const std::string* const text : {&job.kind, &job.specification, &job.program, &job.simd, &units, &chunks})
    add(*text);
  job.id = sum.hex();
  MBK_TRY(write_whole(folder / kUnits, units));
  MBK_TRY(write_whole(folder / kChunks, chunks));
  if (!document::Json::accept(job.specification)) return bad_data("the job's specification is not JSON");
  // The job is there once this file is.
  MBK_TRY(write_whole(folder / kJob, document::document(job)));
  made.job_ = std::move(job);
  return made;
}

Result<JobFolder> JobFolder::open(const fs::path& folder) {
  if (!is_there(folder)) {
    return fail(ErrorKind::usage, "there is no job in this folder", "name the folder of a job", folder.string());
  }
  JobFolder opened;
  std::error_code error;
  opened.folder_ = fs::absolute(folder, error);
  opened.job_ = MBK_TRY(job_from(folder / kJob));
  return opened;
}

Result<void> JobFolder::check_program() const {
  const std::string here = program_identity();
  if (here == job_.program) return {};
  return bad_data(fmt::format("the job was started by mbk {}, but this is mbk {}", job_.program, here),
                  "use the same program on every computer; results of different programs are never mixed",
                  folder_.string());
}

Result<Chunk> JobFolder::chunk(std::int64_t number) const {
  if (number < 0 || number >= job_.chunks) {
    return bad_usage(fmt::format("there is no chunk {}", number),
                     fmt::format("the job's chunks are 0 to {}", job_.chunks - 1));
  }
  const fs::path file = folder_ / kChunks;
  std::ifstream stream(file, std::ios::binary);
  std::string line(kChunkLine, '\0');
  stream.seekg(static_cast<std::streamoff>(number) * static_cast<std::streamoff>(kChunkLine));
  stream.read(line.data(), static_cast<std::streamsize>(kChunkLine));
  std::istringstream fields(line);
  Chunk chunk{number};
  std::int64_t offset = 0, bytes = 0;
  if (!stream || !(fields >> chunk.first >> chunk.count >> offset >> bytes >> chunk.expected_s)) return damaged(file);
  return chunk;
}

Result<std::vector<Chunk>> JobFolder::chunks() const {
  const fs::path file = folder_ / kChunks;
  std::ifstream stream(file, std::ios::binary);
  std::vector<Chunk> all;
  std::int64_t offset = 0, bytes = 0, units = 0;
  Chunk chunk;
  while (stream >> chunk.first >> chunk.count >> offset >> bytes >> chunk.expected_s) {
    chunk.number = std::ssize(all);
    units += chunk.count;
    all.push_back(chunk);
  }
  if (std::ssize(all) != job_.chunks || units != job_.units) return damaged(file);
  return all;
}

Result<std::vector<std::string>> JobFolder::keys(const Chunk& chunk) const {
  const fs::path table = folder_ / kChunks, file = folder_ / kUnits;
  std::ifstream lines(table, std::ios::binary);
  lines.seekg(static_cast<std::streamoff>(chunk.number) * static_cast<std::streamoff>(kChunkLine));
  std::int64_t first = 0, count = 0, offset = 0, bytes = 0;
  if (!(lines >> first >> count >> offset >> bytes) || first != chunk.first || count != chunk.count) {
    return damaged(table);
  }
  std::ifstream stream(file, std::ios::binary);
  stream.seekg(offset);
  std::vector<std::string> keys;
  std::string key;
  while (std::ssize(keys) < count && std::getline(stream, key)) keys.push_back(key);
  if (std::ssize(keys) != count) return damaged(file);
  return keys;
}

Result<void> JobFolder::remove() const {
  std::error_code error;
  // Its name goes first: what is left of a folder without it is no job.
  MBK_TRY(files::remove_file(folder_ / kJob));
  fs::remove_all(folder_, error);
  if (error) return bad_data(fmt::format("cannot be removed: {}", error.message()), "remove it", folder_.string());
  return {};
}

}  // namespace mbk::batch
