// quad_procedure LOG.mat: the published procedure in 113-bit arithmetic, as JSON on stdout.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "tests/reference/quad_procedure.h"
#include "tests/reference/read_log.h"

namespace {

template <class Numbers>
std::string as_text(const Numbers& numbers) {
  std::vector<std::string> texts;
  for (const double number : numbers) texts.push_back(fmt::format("{:.17g}", number));
  return fmt::format("[{}]", fmt::join(texts, ", "));
}

int report(const mbk::Error& error) {
  fmt::print(stderr, "quad_procedure: {}\n", error.line());
  return error.kind == mbk::ErrorKind::usage ? 2 : 3;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace mbk::reference;
  CLI::App app{
      "The published identification procedure in 113-bit arithmetic. Takes seconds to minutes.\n"
      "Example: quad_procedure trial.mat --protocol underdamped"};
  std::string path;
  Settings settings;
  bool all_samples = false;
  const std::map<std::string, Procedure> procedures{{"chapter3", Procedure::chapter3},
                                                    {"chapter5", Procedure::chapter5}};
  const std::map<std::string, Protocol> protocols{{"sinusoidal", Protocol::sinusoidal},
                                                  {"underdamped", Protocol::underdamped}};
  app.add_option("LOG", path, "MAT file with the 19-row matrix 'logs', 1 kHz")->required();
  app.add_option("--procedure", settings.procedure, "default chapter3")
      ->transform(CLI::CheckedTransformer(procedures))
      ->option_text("chapter3|chapter5");
  app.add_option("--protocol", settings.protocol, "default sinusoidal")
      ->transform(CLI::CheckedTransformer(protocols))
      ->option_text("sinusoidal|underdamped");
  app.add_option("--handle-mass", settings.handle_mass, "removed from the diagonal of M; chapter 5 needs it")
      ->option_text("KG");
  app.add_flag("--all", all_samples, "parameters from all samples, VAF from the split");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }

  const auto log = read_log(path);
  if (!log) return report(log.error());
  const auto answers = identify(*log, settings);
  if (!answers) return report(answers.error());
  const Answer& answer = all_samples ? answers->all : answers->split;
  fmt::print("{{\"M\": {}, \"B\": {}, \"K\": {}, \"x0\": {}, \"VAF\": {}}}\n", as_text(answer.M), as_text(answer.B),
             as_text(answer.K), as_text(answer.x0), as_text(answer.VAF));
  return 0;
}
