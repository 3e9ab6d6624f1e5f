#include <fmt/format.h>

#include <memory>

#include "apps/mbk/commands.h"
#include "apps/mbk/output.h"
#include "mbk/analyse/ellipses.h"
#include "mbk/report/text.h"
#include "mbk/result/json.h"

namespace mbk::app {
namespace {

struct Arguments {
  std::filesystem::path file;
  bool json = false;
  Output output;
};

int run(const Arguments& arguments) {
  const auto text = read_text(arguments.file);
  if (!text) return report_error(text.error());
  auto identifications = result::identifications_from_json(*text);
  if (!identifications) return report_error(identifications.error().in(arguments.file.string()));
  std::string shown;
  for (const Identification& identification : *identifications) {
    const auto findings = analyse::analyse_ellipses(identification);
    if (!findings) return report_error(findings.error().in(arguments.file.string()));
    if (arguments.json) {
      shown += result::to_json(*findings);
    } else {
      for (const SourceFile& source : identification.sources) shown += source.path + "\n";
      shown += report::ellipses_text(*findings);
    }
  }
  if (auto ok = arguments.output.write(shown); !ok) return report_error(ok.error());
  return kFine;
}

}  // namespace

Action add_ellipse(CLI::App& app) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("ellipse", "impedance ellipses of a stored result, with 95 % intervals");
  command->footer(
      "Example:\n"
      "  mbk measure log.mat --json --out result.json && mbk ellipse result.json\n\n"
      "Area π λ_max λ_min, shape λ_max/λ_min, orientation of the major axis from x; symmetric parts only.");
  command->add_option("RESULT.json", arguments->file, "a file that 'mbk measure --json' wrote")->required();
  command->add_flag("--json", arguments->json, "for machines: schema mbk.ellipse/1, one object per result");
  command->add_option("--out", arguments->output.file, "write to this file instead of standard output")
      ->type_name("FILE");
  command->add_flag("--overwrite", arguments->output.overwrite, "replace that file where it is there");
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
