// Added to a target that libFuzzer drives: PROGRAM --write-seeds=FOLDER writes the seeds instead of fuzzing.

#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "fuzz/fuzz.h"

extern "C" int LLVMFuzzerInitialize(int* count, char*** arguments) {
  constexpr std::string_view kOption = "--write-seeds=";
  for (int i = 1; i < *count; ++i) {
    const std::string_view argument = (*arguments)[i];
    if (!argument.starts_with(kOption)) continue;
    const bool written = mbk::fuzz::write_seeds(std::string(argument.substr(kOption.size())));
    if (!written) std::fputs("the seeds cannot be written\n", stderr);
    std::exit(written ? EXIT_SUCCESS : EXIT_FAILURE);
  }
  return 0;
}
