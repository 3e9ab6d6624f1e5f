// make_log --out FILE: writes a recording with known M, B, K and x0, for trying mbk.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <map>
#include <string>

#include "mbk/files/recording/write.h"
#include "mbk/simulate/laboratory/prescribed_motion.h"

namespace {

using namespace mbk;

constexpr Hertz kRate{1000.0};  // of the published logs
constexpr char kHelp[] =
    "Writes a synthetic trial at 1 kHz as .mat, .h5 or .csv, and prints the true values.\n"
    "A MAT file of two axes contains the 19-row matrix 'logs': row 1 time, 2-3 hand, 10-11 force of the hand on the "
    "robot,\n"
    "12-13 reference, 18-19 acceleration; every other row is NaN. One axis: time, position, reaction, reference, "
    "acceleration.\n"
    "Example: make_log --protocol underdamped --seed 3 --out trial.mat";

void print_row(const char* name, const char* unit, const Vector& row) {
  fmt::print("  {:<3} {:<7}", name, unit);
  for (const double value : row) fmt::print(" {:10.4f}", value);
  fmt::print("\n");
}

void print_truth(const impedance::Model& limb) {
  const std::tuple<const char*, const char*, const Matrix*> matrices[] = {
      {"M", "kg", &limb.M}, {"B", "N.s/m", &limb.B}, {"K", "N/m", &limb.K}};
  for (const auto& [name, unit, matrix] : matrices) {
    for (Index i = 0; i < matrix->rows(); ++i) {
      print_row(i == 0 ? name : "", i == 0 ? unit : "", Vector(matrix->row(i).transpose()));
    }
  }
  print_row("x0", "m", limb.x0);
}

int report(const Error& error) {
  fmt::print(stderr, "make_log: {}\n", error.line());
  return error.kind == ErrorKind::usage ? 2 : 3;
}

}  // namespace

int main(int argc, char** argv) {
  laboratory::PrescribedMotionOptions options;
  const std::map<std::string, Protocol> protocols{{"sinusoidal", Protocol::sinusoidal},
                                                  {"underdamped", Protocol::underdamped}};
  std::string path;
  bool one_axis = false, overwrite = false;
  CLI::App app{kHelp};
  app.add_option("--protocol", options.protocol, "motion of the hand")
      ->transform(CLI::CheckedTransformer(protocols))
      ->option_text("sinusoidal|underdamped")
      ->required();
  app.add_option("--seed", options.seed, "random seed of phases, pulses and noise")->option_text("N [1]");
  app.add_option("--force-noise", options.sensors.force_noise, "standard deviation of the white force noise")
      ->option_text("N [0.02]");
  app.add_option("--coloured-force-noise", options.sensors.coloured_force_noise,
                 "standard deviation of the force noise below 1.5 Hz, as of a person")
      ->option_text("N [0]");
  app.add_option("--position-quantum", options.sensors.position_quantum, "resolution of the position")
      ->option_text("M [2e-6]");
  app.add_flag("--one-axis", one_axis, "one axis instead of two");
  app.add_option("--out", path, "recording to write: .mat, .h5 or .csv")->option_text("FILE")->required();
  app.add_flag("--overwrite", overwrite, "replace FILE if it exists");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (one_axis) {
    options.limb = laboratory::relaxed_arm_one_axis();
    options.home = Vector(options.home.tail(1));
  }

  const auto format = recording::format_of(path);
  if (!format) return report(format.error());
  const auto made = laboratory::record_prescribed_motion(options, kRate);
  if (!made) return report(made.error());
  if (const auto saved = recording::write(*made, path, *format, overwrite); !saved) return report(saved.error());
  fmt::print("{}: {}, seed {}, {:.3f} s; true values:\n", path, made->metadata.at("protocol"), options.seed,
             made->time[made->samples() - 1]);
  print_truth(options.limb);
  return 0;
}
