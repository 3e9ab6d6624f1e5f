#include "apps/mbk/commands/explore_units.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>
#include <utility>

#include "apps/mbk/terminal/progress.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/files/contents/durable_files.h"
#include "mbk/files/contents/sha256.h"
#include "mbk/present/report/exploration_text.h"
#include "mbk/present/result/exploration_json.h"
#include "mbk/batch/value_bytes.h"
#include "mbk/study/store/store.h"

namespace mbk::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

ExploredRecord explored(const RecordingReader& reader, int k, const measurement::ExploreOptions& options, bool json) {
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
Result<RecordingReader> reader_of(const ExploringArguments& arguments, const Json& key) {
  const fs::path file = key.at("file").get<std::string>();
  if (sum_of(file) != key.at("sha256").get<std::string>()) {
    return bad_data("it has changed since the job was begun", "put it back, or begin again", file.string());
  }
  ReadRequest reading = arguments.reading;
  reading.files = {file};
  reading.trial = key.at("trial").get<std::string>();
  return RecordingReader::of(reading, arguments.sensor);
}

batch::UnitFunction units_of(const ExploringArguments& arguments, const measurement::ExploreOptions& options,
                             bool json) {
  return [=](std::int64_t /*number*/, const std::string& text) -> Result<std::string> {
    const Json key = Json::parse(text, nullptr, false);
    if (!key.is_object()) return bad_data("the job's list of recordings is damaged", "begin the job again");
    const auto reader = MBK_TRY(reader_of(arguments, key));
    batch::ValueWriter writer;
    writer.put(explored(reader, 0, options, json));
    return writer.take();
  };
}

/// What is read, in the order of the FILEs.   @fails  usage: a folder.
Result<std::vector<std::string>> keys_of(const RecordingReader& reader) {
  std::vector<std::string> keys;
  std::string sum;
  std::error_code ignored;
  for (int k = 0; k < reader.count(); ++k) {
    const fs::path& file = reader.file(k);
    if (fs::is_directory(file, ignored)) {
      return bad_usage(fmt::format("{} is a folder, and --engine takes files", file.string()), "leave out --engine");
    }
    if (k == 0 || file != reader.file(k - 1)) sum = sum_of(file);
    keys.push_back(written({{"file", file.string()}, {"trial", reader.trial(k)}, {"sha256", sum}}));
  }
  return keys;
}

/// The calibration of --sensor, which a result depends on; "" where there is none.
Result<std::string> sensor_sum(const ExploringArguments& arguments) {
  return arguments.sensor.file ? files::file_sha256(*arguments.sensor.file) : Result<std::string>("");
}

/// About how long each takes: as long as its file is large.
std::vector<double> weights_of(const RecordingReader& reader) {
  std::vector<double> weights;
  for (int k = 0; k < reader.count(); ++k) {
    std::error_code error;
    const auto bytes = fs::file_size(reader.file(k), error);
    weights.push_back(error ? 1.0 : 1.0 + static_cast<double>(bytes));
  }
  return weights;
}

}  // namespace

std::vector<std::string> exploring_words(Command command) {
  const Parser probe;
  ExploringArguments arguments;
  add_exploring_options(probe.command(), arguments);
  std::vector<std::string> words;
  for (const Option option : command.options()) {
    const std::string name = option.name();
    if (name == "FILE" || !option.is_given() || !probe.command().find_option(name)) continue;
    if (option.is_flag()) words.push_back(name);
    for (const std::string& value : option.values()) words.push_back(name + '=' + value);
  }
  return words;
}

Result<std::vector<ExploredRecord>> explored_here(const ExploringEach& each, unsigned threads) {
  ExploringArguments arguments = each.arguments;
  const auto options = MBK_TRY(exploring_options(arguments));
  const auto reader = MBK_TRY(RecordingReader::of(arguments.reading, arguments.sensor));
  std::vector<ExploredRecord> all(static_cast<std::size_t>(reader.count()));
  Progress progress(each.quiet);
  int done = 0;
  MBK_TRY(numeric::parallel_for(
      reader.count(), threads,
      [&](int k) -> Result<void> {
        all[static_cast<std::size_t>(k)] = explored(reader, k, options, each.json);
        return {};
      },
      [&](int k) { progress.count(++done, reader.count(), reader.file(k).string()); }));
  return all;
}

Result<std::vector<ExploredRecord>> explored_elsewhere(const ExploringEach& each, const EngineArguments& engine,
                                                       std::optional<int>& code) {
  ExploringArguments arguments = each.arguments;
  const auto options = MBK_TRY(exploring_options(arguments));
  const auto reader = MBK_TRY(RecordingReader::of(arguments.reading, arguments.sensor));
  auto keys = MBK_TRY(keys_of(reader));
  const auto sensor = MBK_TRY(sensor_sum(arguments));
  const std::string listed = fmt::format("{}", fmt::join(keys, "\n"));
  batch::JobRequest request;
  request.kind = kExploreKind;
  request.specification = written({{"words", each.words},
                                   {"json", each.json},
                                   {"sensor_sha256", sensor},
                                   {"recordings_sha256", recording::sha256(std::as_bytes(std::span(listed)))},
                                   {"folder", fs::current_path().string()}});
  request.title = fmt::format("mbk explore --each, {} recordings", keys.size());
  request.keys = std::move(keys);
  request.weights = weights_of(reader);
  request.compute = units_of(arguments, options, each.json);
  request.folder = job_folder_here(request.kind, request.specification);
  const auto carried = carry_out(engine, request, each.quiet);
  if (!carried) return tl::unexpected(carried.error());
  if (carried->code) {
    code = carried->code;
    return bad_data("some recordings are missing");
  }
  const auto results = MBK_TRY(batch::results_of(*carried->folder));
  std::vector<ExploredRecord> all(results.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    batch::ValueReader bytes(results[k]);
    bytes.get(all[k]);
    if (!bytes.complete()) return bad_data("a result in a shard cannot be read", "begin the job again");
  }
  MBK_TRY(batch::remove_job(*carried->folder, engine));
  return all;
}

Result<batch::UnitFunction> explore_units(const Json& specification) {
  std::error_code error;
  fs::current_path(specification.at("folder").get<std::string>(), error);
  if (error) return bad_data(error.message(), "every machine must see the folder in which the job was begun");
  ExploringArguments arguments;
  const Parser parser;
  add_exploring_options(parser.command(), arguments);
  parser.command().remove_option("FILE");
  if (auto ok = parser.parse(specification.at("words").get<std::vector<std::string>>()); !ok) {
    return bad_data(ok.error().what, "begin the job again");
  }
  const auto options = MBK_TRY(exploring_options(arguments));
  const auto sensor = MBK_TRY(sensor_sum(arguments));
  if (sensor != specification.at("sensor_sha256").get<std::string>()) {
    return bad_data("the calibration of --sensor has changed since the job was begun", "put it back, or begin again");
  }
  return units_of(arguments, options, specification.at("json").get<bool>());
}

}  // namespace mbk::app
