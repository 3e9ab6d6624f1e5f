#include "mbk/study/workflow/measuring.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "mbk/base/core/version.h"
#include "mbk/files/contents/durable_files.h"
#include "mbk/files/contents/sha256.h"
#include "mbk/measure/measurement/explore.h"
#include "mbk/present/request/named_robot.h"
#include "mbk/present/request/open_recordings.h"
#include "mbk/present/result/exploration_json.h"
#include "mbk/present/result/json.h"

namespace mbk::workflow {
namespace {

using Json = nlohmann::json;
using request::MeasureRequest;

constexpr const char* kHashPrefix = "sha256:";

/// What the file of an option says, as far as a result depends on it.
Result<std::string> hash_of_file(const std::string& option, const std::filesystem::path& file) {
  auto sum = files::file_sha256(file);
  if (!sum || option != "--robot" || file.extension() == ".json") return sum;
  const auto robot = request::describe_robot(file);  // a description may name a URDF beside it
  if (!robot) return tl::unexpected(robot.error());
  const std::string text = *sum + robot->toml + '\0' + robot->urdf;
  return recording::sha256(std::as_bytes(std::span(text)));
}

/// Results depend on these options: without defaults, with hashes in place of files.
Result<OptionTexts> key_of(const OptionTexts& given, const MeasureRequest& request) {
  OptionTexts key = measuring_table().without_defaults(given, request);
  for (auto& [name, values] : key) {
    if (!measuring_table().find(name)->facts.names_file) continue;
    for (std::string& value : values) {
      const auto sum = MBK_TRY(hash_of_file(name, value));
      value = kHashPrefix + sum;
    }
  }
  return key;
}

/// "inertia-not-positive, fit-poor"
std::string codes_of(const std::vector<Warning>& warnings) {
  std::vector<std::string_view> codes;
  for (const Warning& warning : warnings) codes.push_back(word_of(warning.code));
  return fmt::format("{}", fmt::join(codes, ", "));
}

/// The same part as `mbk explore --only` finds it.
Result<store::UnitResult> explored_unit(const Measuring& measuring, Recording& recording, const store::Unit& unit) {
  for (SourceFile& source : recording.sources) source.path = unit.file;
  measurement::ExploreOptions options;
  options.only = measuring.request.explored;
  options.preprocess = measuring.options.preprocess;
  const auto found = measurement::explore({&recording, 1}, options);
  if (!found) return store::UnitResult{"", false, found.error().message};
  return store::UnitResult{result::to_json(*found), found->usable, found->usable ? "" : codes_of(found->warnings)};
}

Result<Measurement> measured(const Measuring& measuring, Recording& recording, const store::Unit& unit) {
  for (SourceFile& source : recording.sources) source.path = unit.file;  // a result does not say where the study stands
  request::add_arm(measuring.request.arm, recording);
  return measurement::measure({&recording, 1}, measuring.options);
}

}  // namespace

const OptionTable<MeasureRequest>& measuring_table() {
  static const auto kTable = [] {
    OptionTable<MeasureRequest> table;
    for (const auto* part : {&request::measure_table(), &request::arm_table()}) {
      for (const auto& row : part->rows()) {
        if (row.facts.name != "--parts" && row.facts.name != "--trial") table.add_row(row);
      }
    }
    table.group("Muscle tone and reflexes")
        .add({"--explore", "stretch|emg",
              "store the stretches or the EMG responses of each recording, as 'mbk explore --only' finds them, instead "
              "of M, B and K",
              one_of({"stretch", "emg"})},
             &MeasureRequest::explored);
    return table;
  }();
  return kTable;
}

std::string options_to_json(const OptionTexts& given) {
  return Json(given).dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<OptionTexts> options_from_json(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  OptionTexts given;
  const auto wrong = [] { return bad_data("the stored options cannot be read", "restore the study from a backup"); };
  if (!json.is_object()) return wrong();
  for (const auto& [name, values] : json.items()) {
    if (!values.is_array()) return wrong();
    std::vector<std::string>& list = given[name];
    for (const Json& value : values) {
      if (!value.is_string()) return wrong();
      list.push_back(value.get<std::string>());
    }
  }
  return given;
}

Result<std::shared_ptr<const Measuring>> measuring_of(const OptionTexts& given) {
  auto measuring = std::make_shared<Measuring>();
  auto request = measuring_table().read(given);
  if (!request) return bad_usage(request.error().message, "see 'mbk study measure --help'");
  measuring->request = std::move(*request);
  measuring->options = MBK_TRY(request::measurement_options(measuring->request));
  const auto key = MBK_TRY(key_of(given, measuring->request));
  measuring->key = options_to_json(key);
  return std::shared_ptr<const Measuring>(std::move(measuring));
}

Result<std::string> key_in(const store::Store& study, const Measuring& measuring) {
  const auto analyses = MBK_TRY(study.analyses());
  std::optional<std::string> alike;
  for (const store::Analysis& analysis : analyses) {
    if (analysis.version != version()) continue;
    if (analysis.options == measuring.key) return measuring.key;
    const auto options = MBK_TRY(options_from_json(analysis.options));
    const auto request = measuring_table().read(options);
    const OptionTexts plain = request ? measuring_table().without_defaults(options, *request) : options;
    if (!alike && options_to_json(plain) == measuring.key) alike = analysis.options;
  }
  return alike.value_or(measuring.key);
}

bool names_files(const OptionTexts& given) {
  return std::ranges::any_of(given, [](const auto& one) {
    const auto* const row = measuring_table().find(one.first);
    return row != nullptr && row->facts.names_file;
  });
}

Result<OptionTexts> default_options(const store::Store& study) {
  const auto facts = MBK_TRY(study.facts());
  return options_from_json(facts.options);
}

Result<Recording> read_stored(const Measuring& measuring, const std::filesystem::path& file, std::int64_t part,
                              Reading what) {
  request::ReadRequest reading = request::reading_for(measuring.request.reading, measuring.options);
  if (file.filename().string().ends_with(kCopyExtension)) {  // maps and rates were applied when it was made
    reading.channels.clear();
    reading.options.variable.clear();
    reading.options.clock.clear();
    reading.options.arm.clear();
    reading.options.rate.reset();
  }
  if (measuring.request.explored) reading.options.emg = recording::EmgReading::all;
  reading.files = {file};
  const auto reader = MBK_TRY(request::open_recordings(reading, measuring.request.sensor));
  const int which = part == 0 ? 0 : static_cast<int>(part) - 1;
  if (which >= reader.count()) return bad_data(fmt::format("it has no record {}", part), "", file.string());
  return what == Reading::perturbation ? reader.read_perturbation(which) : reader.read(which);
}

Result<store::UnitResult> measure_unit(const Measuring& measuring, const std::filesystem::path& folder,
                                       const store::Unit& unit) {
  const std::filesystem::path file = folder / unit.file;
  const auto damaged = [&] {
    return bad_data("its content differs from what was added", "restore it from a backup; 'mbk study check' names all",
                    file.string());
  };
  auto recording = read_stored(measuring, file, unit.part, Reading::perturbation);
  if (!recording) {
    const auto sum = MBK_TRY(files::file_sha256(file));
    if (sum != unit.sha256) return damaged();
    // A disk may fail for a moment; what cannot be read a second time, with the right bytes, is wrong with the
    // recording.
    recording = read_stored(measuring, file, unit.part, Reading::perturbation);
    if (!recording) return store::UnitResult{"", false, recording.error().message};
  }
  if (recording->sources.size() != 1 || recording->sources.front().sha256 != unit.sha256) return damaged();
  if (measuring.request.explored) return explored_unit(measuring, *recording, unit);
  const auto found = measured(measuring, *recording, unit);
  if (!found) return store::UnitResult{"", false, found.error().message};
  const Identification& identification = found->identification;
  return store::UnitResult{result::to_compact_json(*found), identification.usable,
                           identification.usable ? "" : codes_of(identification.warnings)};
}

}  // namespace mbk::workflow
