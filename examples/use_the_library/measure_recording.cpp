// Reads a recording, measures it and prints M, B and K.   usage: measure_recording FILE
#include <cstdio>
#include <vector>

#include "mbk/files/recording/read.h"
#include "mbk/measure/measurement/measure.h"

namespace {

/// Prints every digit, so that the numbers can be compared.
void print(const char* name, const mbk::Matrix& matrix) {
  std::printf("%s", name);
  for (mbk::Index row = 0; row < matrix.rows(); ++row) {
    for (mbk::Index column = 0; column < matrix.cols(); ++column) std::printf(" %.17g", matrix(row, column));
  }
  std::printf("\n");
}

int report(const mbk::Error& error) {
  std::fprintf(stderr, "%s\n", error.line().c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: measure_recording FILE\n");
    return 2;
  }
  const auto recording = mbk::recording::read(argv[1], {});
  if (!recording) return report(recording.error());  // an error is returned, not thrown
  const auto measured = mbk::measurement::measure(std::vector{*recording}, {});
  if (!measured) return report(measured.error());
  const mbk::Identification& identification = measured->identification;
  print("M", identification.model.M);
  print("B", identification.model.B);
  print("K", identification.model.K);
  for (const mbk::Warning& warning : identification.warnings) std::printf("warning %s\n", warning.message.c_str());
  return identification.usable ? 0 : 1;
}
