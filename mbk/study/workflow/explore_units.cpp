#include "mbk/study/workflow/explore_units.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <utility>

#include "mbk/base/numeric/parallel.h"
#include "mbk/batch/value_bytes.h"
#include "mbk/files/contents/durable_files.h"
#include "mbk/files/contents/sha256.h"
#include "mbk/present/report/exploration_text.h"
#include "mbk/present/request/open_recordings.h"
#include "mbk/present/result/exploration_json.h"

namespace mbk::workflow {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

ExploredRecord explored(const measurement::RecordingReader& reader, int k, const measurement::ExploreOptions& options,
                        bool json) {
  const auto recording = reader.read_perturbation(k);
  if (!recording) return {true, false, "", recording.error()};
  const auto found = measurement::explore({&*recording, 1}, options);
  if (!found) return {true, false, "", found.error()};
  return {false, found->usable, json ? result::to_json(*found) : report::exploration_text(*found), {}};
}

std::string written(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// "" where it cannot be read: what is wrong with a file is said where it is explored.
std::string sum_of(const fs::path& file) {
  return files::file_sha256(file).value_or("");
}

/// The reader of what a key names. The sum of its file stands in the key, so that nothing else is explored in its
/// place.
Result<measurement::RecordingReader> reader_of(const request::ExploreRequest& asked, const Json& key) {
  const fs::path file = key.at("file").get<std::string>();
  if (sum_of(file) != key.at("sha256").get<std::string>()) {
    return bad_data("it has changed since the job was started", "restore it, or start the job again", file.string());
  }
  request::ReadRequest reading = asked.reading;
  reading.files = {file};
  reading.options.trial = key.at("trial").get<std::string>();
  return request::open_recordings(reading, asked.sensor);
}

batch::UnitFunction units_of(const request::ExploreRequest& asked, const measurement::ExploreOptions& options,
                             bool json) {
  return [=](std::int64_t /*number*/, const std::string& text) -> Result<std::string> {
    const Json key = Json::parse(text, nullptr, false);
    if (!key.is_object()) return bad_data("the job's list of recordings is damaged", "start the job again");
    const auto reader = MBK_TRY(reader_of(asked, key));
    return batch::to_bytes(explored(reader, 0, options, json));
  };
}

/// What is read, in the order of the FILEs.   @fails  usage: a folder.
Result<std::vector<std::string>> keys_of(const measurement::RecordingReader& reader) {
  std::vector<std::string> keys;
  std::string sum;
  std::error_code ignored;
  for (int k = 0; k < reader.count(); ++k) {
    const fs::path& file = reader.file(k);
    if (fs::is_directory(file, ignored)) {
      return bad_usage(fmt::format("{} is a folder, but --engine needs files", file.string()), "omit --engine");
    }
    if (k == 0 || file != reader.file(k - 1)) sum = sum_of(file);
    keys.push_back(written({{"file", file.string()}, {"trial", reader.trial(k)}, {"sha256", sum}}));
  }
  return keys;
}

/// The calibration of --sensor, which a result depends on; "" where there is none.
Result<std::string> sensor_sum(const request::ExploreRequest& asked) {
  return asked.sensor.file ? files::file_sha256(*asked.sensor.file) : Result<std::string>("");
}

/// About how long each takes: as long as its file is large.
std::vector<double> weights_of(const measurement::RecordingReader& reader) {
  std::vector<double> weights;
  for (int k = 0; k < reader.count(); ++k) {
    std::error_code error;
    const auto bytes = fs::file_size(reader.file(k), error);
    weights.push_back(error ? 1.0 : 1.0 + static_cast<double>(bytes));
  }
  return weights;
}

}  // namespace

Result<std::vector<ExploredRecord>> explored_here(
    const ExploringEach& each, unsigned threads,
    const std::function<void(int done, int of, const std::string& file)>& progress) {
  request::ExploreRequest asked = each.request;
  const auto options = MBK_TRY(request::explore_options(asked));
  const auto reader = MBK_TRY(request::open_recordings(asked.reading, asked.sensor));
  std::vector<ExploredRecord> all(static_cast<std::size_t>(reader.count()));
  int done = 0;
  MBK_TRY(numeric::parallel_for(
      reader.count(), threads,
      [&](int k) -> Result<void> {
        all[static_cast<std::size_t>(k)] = explored(reader, k, options, each.json);
        return {};
      },
      [&](int k) { progress(++done, reader.count(), reader.file(k).string()); }));
  return all;
}

Result<batch::JobRequest> explore_request(const ExploringEach& each) {
  request::ExploreRequest asked = each.request;
  const auto options = MBK_TRY(request::explore_options(asked));
  const auto reader = MBK_TRY(request::open_recordings(asked.reading, asked.sensor));
  auto keys = MBK_TRY(keys_of(reader));
  const auto sensor = MBK_TRY(sensor_sum(asked));
  const std::string listed = fmt::format("{}", fmt::join(keys, "\n"));
  batch::JobRequest job;
  job.kind = kExploreKind;
  job.specification = written({{"options", each.given},
                               {"json", each.json},
                               {"sensor_sha256", sensor},
                               {"recordings_sha256", recording::sha256(std::as_bytes(std::span(listed)))},
                               {"folder", fs::current_path().string()}});
  job.title = fmt::format("mbk explore --each, {} recordings", keys.size());
  job.keys = std::move(keys);
  job.weights = weights_of(reader);
  job.compute = units_of(asked, options, each.json);
  return job;
}

Result<std::vector<ExploredRecord>> explored_of(const batch::JobFolder& job) {
  const auto results = MBK_TRY(batch::results_of(job));
  std::vector<ExploredRecord> all(results.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!batch::from_bytes(results[k], all[k]))
      return bad_data("a result in a shard cannot be read", "start the job again");
  }
  return all;
}

Result<batch::UnitFunction> explore_units(const Json& specification) {
  std::error_code error;
  fs::current_path(specification.at("folder").get<std::string>(), error);
  if (error) return bad_data(error.message(), "make the folder in which the job was started visible to every computer");
  auto asked = request::explore_table().read(specification.at("options").get<OptionTexts>());
  if (!asked) return bad_data(asked.error().message, "start the job again");
  const auto options = MBK_TRY(request::explore_options(*asked));
  const auto sensor = MBK_TRY(sensor_sum(*asked));
  if (sensor != specification.at("sensor_sha256").get<std::string>()) {
    return bad_data("the calibration of --sensor has changed since the job was started",
                    "restore it, or start the job again");
  }
  return units_of(*asked, options, specification.at("json").get<bool>());
}

}  // namespace mbk::workflow
