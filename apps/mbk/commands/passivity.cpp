#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/measure_options.h"
#include "mbk/base/core/option_checks.h"
#include "mbk/base/numeric/parallel.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/present/report/draw_chart.h"
#include "mbk/present/report/passivity_text.h"
#include "mbk/present/report/text.h"
#include "mbk/present/request/stored_result.h"
#include "mbk/present/result/json.h"

namespace mbk::app {
namespace {

using request::AskedBand;

struct PassivityArguments : MeasureArguments {
  std::string band;
};

/// LOW:HIGH in Hz.
Result<AskedBand> band_of(const std::string& text) {
  if (text.empty()) return std::nullopt;
  double low = 0.0, high = 0.0;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, low);
  const bool colon = first.ec == std::errc() && first.ptr != end && *first.ptr == ':';
  const auto second = colon ? std::from_chars(first.ptr + 1, end, high) : first;
  if (!colon || second.ec != std::errc() || second.ptr != end || !(low > 0.0) || !(high > low) ||
      !std::isfinite(high)) {
    return bad_usage(fmt::format("--band {} is not LOW:HIGH in Hz with 0 < LOW < HIGH", quoted(text)),
                     "write it as --band 0.3:3");
  }
  return std::pair{Hertz(low), Hertz(high)};
}

/// One limb's answer, ready to be written.
struct LimbAnswer {
  std::vector<SourceFile> sources;
  Passivity passivity;
  std::vector<Energy> energies;
  std::optional<ConsistentFit> consistent;
  Motion motion = Motion::translation;
};

/// Answers and failures; each error names its file.
struct PassivityAnswers {
  std::vector<LimbAnswer> found;
  std::vector<Error> failed;
};

Result<PassivityAnswers> from_recordings(const PassivityArguments& arguments, const AskedBand& band) {
  auto options = MBK_TRY(measurement_options(arguments));
  options.band = band;
  const auto answer = [&](std::span<const Recording> recordings) -> Result<LimbAnswer> {
    const bool leaves_out = options.preprocess.mode == Mode::default_mode;
    for (const Recording& recording : recordings) say_exclusions(recording, leaves_out);
    auto measured = measurement::measure(recordings, options);
    if (!measured) return tl::unexpected(measured.error());
    const Identification& id = measured->identification;
    return LimbAnswer{id.sources, std::move(*measured->passivity), std::move(measured->energies),
                      std::move(measured->consistent), id.motion};
  };
  PassivityAnswers answers;
  if (arguments.pool) {
    const auto recordings = MBK_TRY(read_perturbations(reading_for(arguments.reading, options), arguments.sensor));
    auto pooled = MBK_TRY(answer(recordings));
    answers.found.push_back(std::move(pooled));
    return answers;
  }
  const auto reader = MBK_TRY(open_recordings(reading_for(arguments.reading, options), arguments.sensor));
  const int count = reader.count();
  std::vector<Result<LimbAnswer>> each(static_cast<std::size_t>(count), bad_data("not measured"));
  std::ignore = numeric::parallel_for(count, arguments.threads, [&](int i) -> Result<void> {
    const auto recording = reader.read_perturbation(i);
    each[static_cast<std::size_t>(i)] = recording ? answer({&*recording, 1}) : tl::unexpected(recording.error());
    return {};
  });  // a failure is kept with its file
  for (Result<LimbAnswer>& one : each) {
    if (one) {
      answers.found.push_back(std::move(*one));
    } else {
      answers.failed.push_back(one.error());
    }
  }
  return answers;
}

/// All results of a file.
Result<std::vector<LimbAnswer>> from_file(const std::filesystem::path& file, const AskedBand& band) {
  const auto results = MBK_TRY(request::stored_results(file));
  std::vector<LimbAnswer> answers;
  for (const result::StoredResult& stored : results) {
    auto passivity = request::passivity_of(stored, band);
    if (!passivity) return tl::unexpected(passivity.error().in(file.string()));
    const Identification& id = stored.identification;
    answers.push_back({id.sources, std::move(*passivity), {}, std::nullopt, id.motion});
  }
  return answers;
}

PassivityAnswers from_results(const PassivityArguments& arguments, const AskedBand& band) {
  PassivityAnswers answers;
  for (const std::filesystem::path& file : arguments.reading.files) {
    auto found = from_file(file, band);
    if (found) {
      std::ranges::move(*found, std::back_inserter(answers.found));
    } else {
      answers.failed.push_back(found.error());
    }
  }
  return answers;
}

std::string text_of(const LimbAnswer& answer) {
  std::string text;
  for (const SourceFile& source : answer.sources) text += source.label() + "\n";
  text += report::passivity_text(answer.passivity, answer.motion);
  if (answer.consistent) text += "\n" + report::consistent_text(*answer.consistent, answer.motion);
  for (const Energy& energy : answer.energies) text += "\n" + report::chart_text(report::energy_chart(energy));
  return text;
}

int run(const PassivityArguments& arguments) {
  if (auto ok = check_files(arguments.reading.files, arguments.output.to); !ok) return report_error(ok.error());
  const auto band = band_of(arguments.band);
  if (!band) return report_error(band.error());
  const bool stored = arguments.reading.files.front().extension() == ".json";
  if (stored && arguments.sensor.file) {
    return report_error({ErrorKind::usage,
                         "--sensor needs the voltages of a recording, which a stored result does not contain",
                         "omit --sensor, or name the recording", ""});
  }
  const Result<PassivityAnswers> answers = stored ? from_results(arguments, *band) : from_recordings(arguments, *band);
  if (!answers) return report_error(answers.error());
  int code = kFine;
  for (const Error& error : answers->failed) code = std::max(code, report_error(error));
  if (answers->found.empty()) return code;
  std::string shown;
  if (arguments.output.json) {
    std::vector<result::PassivityDocument> documents;
    for (const LimbAnswer& one : answers->found) documents.push_back({one.sources, one.passivity, one.energies});
    shown = result::to_json(documents);
  } else {
    for (const LimbAnswer& one : answers->found) shown += (shown.empty() ? "" : "\n") + text_of(one);
  }
  if (auto ok = arguments.output.write(shown, arguments.reading.files); !ok) return report_error(ok.error());
  return code;
}

}  // namespace

Action add_passivity(Command app) {
  auto arguments = std::make_shared<PassivityArguments>();
  const Command command = app.add_command(
      "passivity", "report the energy that the limb absorbed and the passivity that its model predicts");
  command.footer(
      "Examples:\n"
      "  mbk passivity log.mat\n"
      "      the energy of the trial with its interval, the passivity conditions of the model, energy over time\n"
      "  mbk passivity log.mat --band 0.5:3\n"
      "      the model's prediction in a band of your choice; beyond the data it is an extrapolation\n"
      "  mbk passivity result.json\n"
      "      from the model and the energy stored by 'mbk measure --json'\n\n"
      "It makes two statements. The energy of the trial: passive if the hand absorbed energy, active if\n"
      "it delivered energy, undecided if the 95 % interval contains zero. The prediction of the model, in\n"
      "the band in which the perturbation moves all axes and explains force and motion: passive, active,\n"
      "undecided, or none if no model is usable. Neither statement guarantees that a robot coupled to\n"
      "this person is stable.");
  add_measure_options(command, *arguments);
  command
      .add_option("--band", arguments->band,
                  "frequency band of the prediction, in Hz (default: the band in which the perturbation explains "
                  "position and force)")
      .type_name("LOW:HIGH")
      .check(not_empty())
      .group("Analysed interval");
  add_output_options(command, arguments->output, "mbk.passivity/2");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
