#include <fmt/format.h>

#include <memory>
#include <utility>
#include <vector>

#include "apps/mbk/commands/commands.h"
#include "apps/mbk/options/output.h"
#include "mbk/files/contents/read_text.h"
#include "mbk/measure/analyse/ellipses.h"
#include "mbk/present/report/text.h"
#include "mbk/present/result/json.h"

namespace mbk::app {
namespace {

struct EllipseArguments {
  std::filesystem::path file;
  bool json = false;
  Output output;
};

int run(const EllipseArguments& arguments) {
  if (auto ok = arguments.output.check({arguments.file}); !ok) return report_error(ok.error());
  const auto text = read_text(arguments.file);
  if (!text) return report_error(text.error());
  auto identifications = result::identifications_from_json(*text);
  if (!identifications) return report_error(identifications.error().in(arguments.file.string()));
  std::vector<Measurement> all;
  std::string shown;
  int code = kFine;
  for (Identification& stored : *identifications) {
    Measurement& one = all.emplace_back();
    one.identification = std::move(stored);
    if (auto ok = analyse::add_ellipses(one); !ok) return report_error(ok.error().in(arguments.file.string()));
    const Identification& identification = one.identification;
    if (!shown.empty()) shown += "\n";
    for (const SourceFile& source : identification.sources) shown += source.label() + "\n";
    shown += fmt::format("  by {}\n", method_name(identification.method));
    if (identification.usable) {
      shown += one.findings ? report::ellipses_text(*one.findings) : report::ellipsoids_text(*one.spatial);
    } else {
      shown += "  NOT USABLE: no ellipse is shown; 'mbk measure' reports the reason. --json contains the numbers.\n";
      code = kNotUsable;
    }
  }
  if (arguments.json) shown = result::ellipses_json(all);
  if (auto ok = arguments.output.write(shown, {arguments.file}); !ok) return report_error(ok.error());
  return code;
}

}  // namespace

Action add_ellipse(Command app) {
  auto arguments = std::make_shared<EllipseArguments>();
  const Command command =
      app.add_command("ellipse", "compute the impedance ellipses of a stored result, with 95 % intervals");
  command.footer(
      "Examples:\n"
      "  mbk ellipse result.json\n"
      "      a result written by 'mbk measure log.mat --json --out result.json'\n\n"
      "Area π λ_max λ_min, shape λ_max/λ_min, orientation of the major axis from x, each of the symmetric\n"
      "part. With three axes: principal values and directions, volume 4/3 π λ₁ λ₂ λ₃, shape λ₁/λ₃.");
  command.add_option("RESULT.json", arguments->file, "a result written by 'mbk measure --json'").required();
  command.add_flag("--json", arguments->json, "print JSON: schema mbk.ellipse/1");
  arguments->output.add_options(command);
  return [arguments] { return run(*arguments); };
}

}  // namespace mbk::app
