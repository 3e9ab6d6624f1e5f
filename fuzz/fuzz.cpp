#include "fuzz/fuzz.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "mbk/base/core/printable.h"
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/recording/annotations.h"
#include "mbk/files/recording/assemble.h"
#include "mbk/files/recording/inspect.h"

namespace mbk::fuzz {
namespace {

void check_recording(const Result<Recording>& recording) {
  if (!recording) return require_error(recording.error());
  require(recording->samples() > 0, "a recording has samples");
  require(!recording->channels.empty(), "a recording has channels");
  for (const Channel& channel : recording->channels) {
    require(channel.values.size() == recording->samples(), "every channel is as long as the time");
    require_line(channel.name, "the name of a channel");
  }
  for (const std::string& note : recording->notes) require_line(note, "a note");
  const Inspection facts = recording::inspect(*recording);
  require(facts.channels.size() == recording->channels.size(), "the inspection covers every channel");
}

}  // namespace

Recording small_recording() {
  Recording recording;
  recording.time = Vector::LinSpaced(6, 0.0, 0.005);
  for (const auto& [name, unit] : {std::pair{"hand_x", "m"}, {"hand_y", "m"}, {"force_x", "N"}, {"force_y", "N"}}) {
    recording.channels.push_back({name, unit, "base", Vector::LinSpaced(6, -1.0, 1.0)});
  }
  recording.metadata = {{"participant", "P01"}};
  recording.events = {{0.002, "onset", 1.0}};
  return recording;
}

void require(bool holds, std::string_view what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %.*s\n", static_cast<int>(what.size()), what.data());
  std::abort();
}

void require_line(std::string_view line, std::string_view what) {
  if (!line.empty() && printable(std::string(line)) == line) return;
  std::fprintf(stderr, "is not one line of text: %.*s: '%.*s'\n", static_cast<int>(what.size()), what.data(),
               static_cast<int>(line.size()), line.data());
  std::abort();
}

void require_error(const Error& error) {
  require(!error.message.empty(), "an error says what is wrong");
  require_line(error.line(), "an error");
}

void check_decoded(Result<recording::Contents> decoded, std::size_t input_size) {
  if (!decoded) return require_error(decoded.error());
  std::uint64_t claimed = 0;
  for (const recording::Array& array : decoded->arrays) {
    claimed += static_cast<std::uint64_t>(array.values.size()) * sizeof(double) + array.name.size();
    require(array.name.empty() || printable(array.name) == array.name, "a name is one line of text");
    require(printable(array.unit) == array.unit, "a unit is one line of text");
    require(array.rate_hz >= 0.0 && array.rate_hz < 1e300, "a rate is finite");
  }
  require(claimed <= recording::largest_claim(input_size), "contents are bounded by the input");
  recording::take_annotations(*decoded);
  for (const std::string& note : decoded->notes) require_line(note, "a note");
  check_recording(recording::assemble(*decoded, {}));
  recording::ReadOptions options;
  options.axes = 1;
  options.channels = {{"x", "1"}, {"F", "2"}};
  check_recording(recording::assemble(*decoded, options));
  options.rate = Hertz(1000.0);
  check_recording(recording::assemble(*decoded, options));
}

bool write_seeds(const std::string& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  std::size_t k = 0;
  for (const std::string& seed : seeds()) {
    std::ofstream file(std::filesystem::path(folder) / std::to_string(k++), std::ios::binary);
    file << seed;
    if (!file.flush()) return false;
  }
  return !failed;
}

}  // namespace mbk::fuzz
