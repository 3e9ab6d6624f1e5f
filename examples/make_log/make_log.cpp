// make_log --out FILE.mat: a recording whose M, B, K and x0 are known, to try mbk on.
#include <fmt/format.h>
#include <matio.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "mbk/laboratory/prescribed_motion.h"

namespace {

using namespace mbk;

constexpr Hertz kRate{1000.0};  // of the published logs
constexpr char kHelp[] =
    "Writes a synthetic trial at 1 kHz as a MAT file and prints the truth behind it.\n"
    "Two axes: the 19-row matrix 'logs' (row 1 time, 2-3 hand, 10-11 force of the hand on the robot, 12-13 reference,\n"
    "18-19 acceleration; every other row is 0). One axis: columns time, position, reaction, reference, acceleration.\n"
    "Example: make_log --protocol underdamped --seed 3 --out trial.mat";

using File = std::unique_ptr<mat_t, decltype(&Mat_Close)>;

/// One real matrix; `Matrix` and MAT files both keep columns contiguous.
bool write(mat_t* file, const char* name, const Matrix& values) {
  Matrix copy = values;
  std::array<size_t, 2> shape = {static_cast<size_t>(values.rows()), static_cast<size_t>(values.cols())};
  const std::unique_ptr<matvar_t, decltype(&Mat_VarFree)> variable(
      Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, shape.data(), copy.data(), 0), &Mat_VarFree);
  return variable && Mat_VarWrite(file, variable.get(), MAT_COMPRESSION_ZLIB) == 0;
}

bool write_one_axis(mat_t* file, const Recording& recording) {
  bool written = write(file, "time", recording.time);
  for (const Channel& channel : recording.channels) {
    written = written && write(file, channel.name.c_str(), channel.values);
  }
  return written;
}

bool write_logs(mat_t* file, const Recording& recording) {
  constexpr std::pair<const char*, Index> kRows[] = {{"hand_x", 2},          {"hand_y", 3},         {"force_x", 10},
                                                     {"force_y", 11},        {"reference_x", 12},   {"reference_y", 13},
                                                     {"acceleration_x", 18}, {"acceleration_y", 19}};
  Matrix logs = Matrix::Zero(19, recording.samples());
  logs.row(0) = recording.time.transpose();
  for (const auto& [name, row] : kRows) logs.row(row - 1) = recording.find(name)->values.transpose();
  return write(file, "logs", logs);
}

/// The whole file under a temporary name first, so that `path` is never half written.
Result<void> save(const Recording& recording, bool one_axis, const std::string& path) {
  const std::string part = path + ".part";
  // A fixed header instead of one with the date: the same seed gives the same bytes.
  File file(Mat_CreateVer(part.c_str(), "MATLAB 5.0 MAT-file, written by make_log of mbk", MAT_FT_MAT5), &Mat_Close);
  if (!file) return bad_data("cannot be created", "check the folder and its permissions", path);
  bool written = one_axis ? write_one_axis(file.get(), recording) : write_logs(file.get(), recording);
  written = Mat_Close(file.release()) == 0 && written;
  std::error_code error;
  if (written) std::filesystem::rename(part, path, error);
  if (written && !error) return {};
  std::filesystem::remove(part, error);
  return bad_data("cannot be written", "check the space on the disk", path);
}

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
  using laboratory::Protocol;
  laboratory::PrescribedMotionOptions options;
  const std::map<std::string, Protocol> protocols{{"sinusoidal", Protocol::sinusoidal},
                                                  {"underdamped", Protocol::underdamped}};
  std::string path;
  bool one_axis = false, overwrite = false;
  CLI::App app{kHelp};
  app.add_option("--protocol", options.protocol, "how the hand is moved")
      ->transform(CLI::CheckedTransformer(protocols))
      ->option_text("sinusoidal|underdamped")
      ->required();
  app.add_option("--seed", options.seed, "of phases, pulses and noise")->option_text("N [1]");
  app.add_option("--force-noise", options.sensors.force_noise, "white, standard deviation")->option_text("N [0.02]");
  app.add_option("--coloured-force-noise", options.sensors.coloured_force_noise,
                 "below 1.5 Hz, standard deviation: what a person adds")
      ->option_text("N [0]");
  app.add_option("--position-quantum", options.sensors.position_quantum, "resolution of the position")
      ->option_text("M [2e-6]");
  app.add_flag("--one-axis", one_axis, "one axis instead of two");
  app.add_option("--out", path, "MAT file to write")->option_text("FILE.mat")->required();
  app.add_flag("--overwrite", overwrite, "replace FILE.mat if it exists");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (one_axis) {
    options.limb = laboratory::relaxed_arm_one_axis();
    options.home = Vector(options.home.tail(1));
  }

  if (!overwrite && std::filesystem::exists(path)) {
    return report(Error{ErrorKind::usage, "exists already", "--overwrite replaces it", path});
  }
  const auto recording = laboratory::record_prescribed_motion(options, kRate);
  if (!recording) return report(recording.error());
  if (const auto saved = save(*recording, one_axis, path); !saved) return report(saved.error());
  fmt::print("{}: {}, seed {}, {:.3f} s; the truth:\n", path, recording->metadata.at("protocol"), options.seed,
             recording->time[recording->samples() - 1]);
  print_truth(options.limb);
  return 0;
}
