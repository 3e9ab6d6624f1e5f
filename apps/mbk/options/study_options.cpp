#include "apps/mbk/options/study_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <tuple>

#include "apps/mbk/options/robot_file.h"
#include "apps/mbk/options/word_options.h"
#include "apps/mbk/terminal/messages.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/core/printable.h"
#include "mbk/base/core/version.h"
#include "mbk/files/contents/durable_files.h"
#include "mbk/files/contents/sha256.h"
#include "mbk/measure/preprocess/perturbation_only.h"
#include "mbk/present/result/json.h"

namespace mbk::app {
namespace {

using Json = nlohmann::json;

constexpr const char* kHashPrefix = "sha256:";
const std::vector<std::string>& options_with_files() {
  static const std::vector<std::string> kNames = {"--robot", "--sensor"};
  return kNames;
}

/// The names of all options of measuring.
const std::vector<std::string>& measuring_names() {
  static const std::vector<std::string> kNames = [] {
    const Parser probe;
    MeasuringArguments arguments;
    add_measuring_options(probe.command(), arguments);
    std::vector<std::string> names;
    for (const Option option : probe.command().options()) {
      const std::string name = option.name();
      if (name != "--help" && name != "--ranges" && name != "--threads") names.push_back(name);
    }
    return names;
  }();
  return kNames;
}

void say_waiting() {
  say("mbk: waiting for another process that is using the study, for half a minute at most\n");
}

/// What the file of an option says, as far as a result depends on it.
Result<std::string> hash_of_file(const std::string& option, const std::filesystem::path& file) {
  auto sum = files::file_sha256(file);
  if (!sum || option != "--robot" || file.extension() == ".json") return sum;
  const auto robot = describe_robot(file);  // a description may name a URDF beside it
  if (!robot) return tl::unexpected(robot.error());
  const std::string text = *sum + robot->toml + '\0' + robot->urdf;
  return recording::sha256(std::as_bytes(std::span(text)));
}

/// A number in the shortest way that says it: 5 for 5.0 and 05, so that a way of measuring has one key. Anything else
/// as it is.
std::string canonical(const std::string& value) {
  const std::string_view digits = std::string_view(value).substr(value.starts_with('+') ? 1 : 0);
  double number = 0.0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const bool whole = code == std::errc() && end == digits.data() + digits.size() && std::isfinite(number);
  return whole ? fmt::format("{}", number) : value;
}

GivenOptions canonical(GivenOptions given) {
  for (auto& [name, values] : given) {
    if (std::ranges::find(options_with_files(), name) != options_with_files().end()) continue;
    for (std::string& value : values) value = canonical(value);
  }
  return given;
}

/// @fails  usage: what the parser says
Result<void> parse(const GivenOptions& given, MeasuringArguments& arguments) {
  const Parser parser;
  add_measuring_options(parser.command(), arguments);
  std::vector<std::string> words;
  for (const auto& [name, values] : given) {
    if (values.empty()) words.push_back(name);
    for (const std::string& value : values) words.push_back(name + '=' + value);
  }
  if (auto ok = parser.parse(std::move(words)); !ok) {
    return bad_usage(ok.error().what, "see 'mbk study measure --help'");
  }
  return {};
}

/// Every member; with one more the compiler asks for it.
auto members(const identify::Options& options) {
  const auto& [method, structure, parameters_from, handle_mass, hac_lag, decimate, bootstrap, block, seed, threads] =
      options;
  return std::tie(method, structure, parameters_from, handle_mass, hac_lag, decimate, bootstrap, block, seed, threads);
}

/// In everything that a result depends on.
bool measure_alike(const MeasuringArguments& a, const MeasuringArguments& b) {
  const auto procedure = [](const MeasuringArguments& c) {
    return c.preprocess.procedure.value_or(Procedure::chapter3);
  };
  PreprocessArguments preprocess = a.preprocess;
  preprocess.procedure = b.preprocess.procedure;
  return procedure(a) == procedure(b) && preprocess == b.preprocess && a.reading == b.reading && a.sensor == b.sensor &&
         members(a.identify) == members(b.identify) && a.ignored_ranges == b.ignored_ranges && a.analyse == b.analyse;
}

/// Without those that say what holds without them: --mode default, --padding 15.
GivenOptions without_defaults(GivenOptions given) {
  MeasuringArguments all;
  if (!parse(given, all)) return given;
  for (auto it = given.begin(); it != given.end();) {
    GivenOptions others = given;
    others.erase(it->first);
    MeasuringArguments fewer;
    it = parse(others, fewer) && measure_alike(all, fewer) ? given.erase(it) : std::next(it);
  }
  return given;
}

/// "inertia-not-positive, fit-poor"
std::string codes_of(const std::vector<Warning>& warnings) {
  std::vector<std::string_view> codes;
  for (const Warning& warning : warnings) codes.push_back(word_of(warning.code));
  return fmt::format("{}", fmt::join(codes, ", "));
}

Result<Measurement> measured(const Measuring& measuring, Recording& recording, const store::Unit& unit) {
  for (SourceFile& source : recording.sources) source.path = unit.file;  // a result does not say where the study stands
  add_arm(measuring.arguments.analyse, recording);
  return measurement::measure({&recording, 1}, measuring.options);
}

}  // namespace

void add_study_option(Command command, StudyArguments& arguments) {
  command.add_option("--study", arguments.folder, "the study; otherwise the one that the current folder is in")
      .type_name("FOLDER")
      .check(not_empty());
}

void add_choice_of_role(Command command, StudyArguments& arguments) {
  add_choice(command, "--role", arguments.role, "who does this, as the log says it: a role, never a name (analyst)");
}

void add_study_and_role(Command command, StudyArguments& arguments) {
  add_study_option(command, arguments);
  add_choice_of_role(command, arguments);
}

Result<store::Store> open_study(const StudyArguments& arguments) {
  if (arguments.folder) return store::Store::open(*arguments.folder, say_waiting);
  const auto folder = store::find_study(".");
  if (!folder) {
    return bad_usage("there is no study in this folder, nor above it",
                     "name one with --study FOLDER; 'mbk study init FOLDER' makes one");
  }
  return store::Store::open(*folder, say_waiting);
}

void add_measuring_options(Command command, MeasuringArguments& arguments) {
  add_measure_options(command, arguments);
  add_analyse_options(command, arguments.analyse);
  for (const char* name : {"FILE", "--parts", "--trial", "--pool"}) {
    command.remove_option(name);
  }
}

GivenOptions given_options(Command command) {
  GivenOptions given;
  for (const Option option : command.options()) {
    const std::string name = option.name();
    if (!option.is_given() || std::ranges::find(measuring_names(), name) == measuring_names().end()) continue;
    given[name] = option.values();
  }
  return given;
}

std::string options_to_json(const GivenOptions& given) {
  return Json(given).dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<GivenOptions> options_from_json(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  GivenOptions given;
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

std::string options_text(const GivenOptions& given) {
  std::vector<std::string> words;
  for (const auto& [name, values] : given) {
    if (values.empty()) words.push_back(name);
    for (const std::string& value : values) words.push_back(name + ' ' + value);
  }
  return printable(fmt::format("{}", fmt::join(words, " ")));
}

Result<std::shared_ptr<const Measuring>> measuring_of(const GivenOptions& given) {
  auto measuring = std::make_shared<Measuring>();
  MBK_TRY(parse(given, measuring->arguments));
  auto options = MBK_TRY(measurement_options(measuring->arguments, measuring->arguments.analyse));
  measuring->options = std::move(options);
  GivenOptions key = without_defaults(canonical(given));
  for (const std::string& name : options_with_files()) {
    const auto found = key.find(name);
    if (found == key.end()) continue;
    for (std::string& value : found->second) {
      auto sum = MBK_TRY(hash_of_file(name, value));
      value = kHashPrefix + sum;
    }
  }
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
    if (!alike && options_to_json(without_defaults(options)) == measuring.key) alike = analysis.options;
  }
  return alike.value_or(measuring.key);
}

bool names_files(const GivenOptions& key) {
  return std::ranges::any_of(options_with_files(), [&](const std::string& name) { return key.contains(name); });
}

Result<GivenOptions> default_options(const store::Store& study) {
  const auto facts = MBK_TRY(study.facts());
  return options_from_json(facts.options);
}

Result<Recording> read_stored(const Measuring& measuring, const std::filesystem::path& file, std::int64_t part,
                              Reading what) {
  ReadingArguments reading = reading_for(measuring.arguments.reading, measuring.options);
  if (file.filename().string().ends_with(kCopyExtension)) {  // maps and rates were applied when it was made
    const ReadingArguments plain;
    reading.channels = plain.channels;
    reading.variable = plain.variable;
    reading.clock = plain.clock;
    reading.arm = plain.arm;
    reading.rate_hz = plain.rate_hz;
  }
  reading.files = {file};
  const auto reader = MBK_TRY(RecordingReader::of(reading, measuring.arguments.sensor));
  const int which = part == 0 ? 0 : static_cast<int>(part) - 1;
  if (which >= reader.count()) return bad_data(fmt::format("there is no record {} in it", part), "", file.string());
  return what == Reading::perturbation ? reader.read_perturbation(which) : reader.read(which);
}

Result<store::UnitResult> measure_unit(const Measuring& measuring, const std::filesystem::path& folder,
                                       const store::Unit& unit) {
  const std::filesystem::path file = folder / unit.file;
  const auto damaged = [&] {
    return bad_data("its bytes are not those that were added", "restore it from a backup; 'mbk study check' names all",
                    file.string());
  };
  auto recording = read_stored(measuring, file, unit.part, Reading::perturbation);
  if (!recording) {
    const auto sum = MBK_TRY(files::file_sha256(file));
    if (sum != unit.sha256) return damaged();
    // What is wrong with a recording is a result; that the disk failed for a moment is none.
    auto again = read_stored(measuring, file, unit.part, Reading::perturbation);
    if (!again && again.error().message == recording.error().message) {
      return store::UnitResult{"", false, recording.error().message};
    }
    if (!again) return tl::unexpected(again.error());
    recording = std::move(again);
  }
  if (recording->sources.size() != 1 || recording->sources.front().sha256 != unit.sha256) return damaged();
  const auto found = measured(measuring, *recording, unit);
  if (!found) return store::UnitResult{"", false, found.error().message};
  const Identification& identification = found->identification;
  return store::UnitResult{result::to_compact_json(*found), identification.usable,
                           identification.usable ? "" : codes_of(identification.warnings)};
}

std::string counted(std::int64_t n, const char* one, const char* more) {
  return fmt::format("{} {}", n, n == 1 ? one : more);
}

}  // namespace mbk::app
