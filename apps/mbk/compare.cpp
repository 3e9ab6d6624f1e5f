#include <fmt/format.h>

#include <memory>
#include <span>
#include <vector>

#include "apps/mbk/commands.h"
#include "apps/mbk/measure_options.h"
#include "mbk/measure/analyse/analyse_width.h"
#include "mbk/measure/measurement/measure.h"
#include "mbk/present/report/text.h"
#include "mbk/present/report/width_text.h"
#include "mbk/present/result/json.h"
#include "mbk/present/result/width_json.h"

namespace mbk::app {
namespace {

Result<Identification> stored(const std::filesystem::path& file) {
  const auto text = read_text(file);
  if (!text) return tl::unexpected(text.error());
  auto identifications = result::identifications_from_json(*text);
  if (!identifications) return tl::unexpected(identifications.error().in(file.string()));
  if (identifications->size() != 1) {
    return bad_data(fmt::format("holds {} results, and a width is that of one to another", identifications->size()),
                    "give each a file of its own", file.string());
  }
  return std::move(identifications->front());
}

Result<Identification> measured(MeasureArguments arguments, const std::filesystem::path& file) {
  arguments.reading.files = {file};
  auto options = measurement_options(arguments);
  if (!options) return tl::unexpected(options.error());
  options->passivity = false;
  const auto recordings = read_perturbations(arguments.reading, arguments.sensor);
  if (!recordings) return tl::unexpected(recordings.error());
  auto found = measurement::measure(std::span(*recordings), *options);
  if (!found) return tl::unexpected(found.error());
  return std::move(found->identification);
}

std::string source_line(const Identification& id, const char* which) {
  std::string text;
  for (const SourceFile& source : id.sources) text += fmt::format("{:<7} {}\n", which, source.label());
  text += fmt::format("        by {}\n", method_name(id.method));
  if (!id.usable) text += fmt::format("  ! the {} result is not usable: 'mbk measure' says why\n", which);
  return text;
}

int run(const MeasureArguments& arguments) {
  if (auto ok = check_files(arguments.reading.files, arguments.output.to); !ok) return report_error(ok.error());
  std::vector<Identification> both;
  for (const std::filesystem::path& file : arguments.reading.files) {
    auto one = file.extension() == ".json" ? stored(file) : measured(arguments, file);
    if (!one) return report_error(one.error());
    both.push_back(std::move(*one));
  }
  const auto widths = analyse::analyse_width(both[0], both[1]);
  if (!widths) return report_error(widths.error());
  const bool usable = both[0].usable && both[1].usable;
  std::string shown = result::width_to_json(both[0].sources, both[1].sources, *widths);
  if (!arguments.output.json) {
    shown = source_line(both[0], "first") + source_line(both[1], "second");
    shown += usable ? report::width_text(*widths) : "  no width is shown; --json holds the numbers\n";
  }
  if (auto ok = arguments.output.write(shown); !ok) return report_error(ok.error());
  return widths->complete() && usable ? kFine : kNotUsable;
}

}  // namespace

Action add_compare(CLI::App& app) {
  auto arguments = std::make_shared<MeasureArguments>();
  CLI::App* command = add_command(app, "compare", "what changed between two results: how far M, B and K are apart");
  command->footer(
      "Examples:\n"
      "  mbk compare relaxed.json rigid.json\n"
      "      what 'mbk measure --json --out relaxed.json' and so on wrote\n"
      "  mbk compare relaxed.mat rigid.mat --method iv\n"
      "      both recordings measured alike first\n\n"
      "√(Σ ln² λ) over the eigenvalues of Z₁⁻¹Z₂, symmetric parts of M, B and K each: 0 where both are\n"
      "equal, √2 ln 7 = 2.75 where the second is seven times the first in every direction; the same in\n"
      "whatever axes and units, at hand or joints. Beside it how many times the second is the first, least\n"
      "and most, and along which direction from x. A matrix that is not positive definite has no width\n"
      "(exit code 4).");
  add_measure_options(*command, *arguments);
  command->get_option("FILE")->expected(2)->description("two results of 'mbk measure --json', or recordings");
  // They join files or add what a width does not show.
  for (const char* name : {"--parts", "--pool", "--bootstrap", "--seed", "--decimate-check", "--threads"}) {
    command->remove_option(command->get_option(name));
  }
  add_output_options(*command, arguments->output, "mbk.compare/1");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
