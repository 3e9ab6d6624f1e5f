#include "fuzz/fuzz.h"
#include "mbk/files/c3d/c3d.h"
#include "mbk/files/c3d/test_c3d.h"

namespace mbk::fuzz {

std::vector<std::string> seeds() {
  using recording::test::C3d, recording::test::small_c3d;
  std::vector<std::string> files;
  for (const int processor : {84, 85, 86}) {
    for (const bool real : {true, false}) files.push_back(small_c3d(processor, real).bytes());
  }
  C3d full = small_c3d();
  const auto n = full.numbers();
  full.first = 301;
  full.points = {"*", "*"};
  full.records = n.reals(C3d::kPoint, "LONG_FRAMES", {6}) + n.texts(C3d::kPoint, "ANGLES", {"*"}) +
                 n.texts(C3d::kPoint, "ANGLE_UNITS", {"deg"}) + n.words(C3d::kTrial, "ACTUAL_START_FIELD", {301, 0}) +
                 n.words(C3d::kTrial, "ACTUAL_END_FIELD", {306, 0}) + n.words(C3d::kEvent, "USED", {1}) +
                 n.texts(C3d::kEvent, "LABELS", {"GO"}) + n.texts(C3d::kEvent, "CONTEXTS", {"Left"}) +
                 n.parameter(C3d::kEvent, "TIMES", 4, {2, 1}, n.real(0) + n.real(3.25));
  files.push_back(full.bytes());
  C3d contradictory = small_c3d(84, false);  // resolved by the size of the file
  contradictory.format = "UNSIGNED";
  contradictory.analog_offset = {40000, -3, 32768};
  contradictory.records = n.words(C3d::kPoint, "DATA_START", {2}) + n.words(C3d::kPoint, "FRAMES", {65535}) +
                          n.reals(C3d::kPoint, "RATE", {50.0});
  files.push_back(contradictory.bytes());
  return files;
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = mbk::fuzz::bytes_of(data, size);
  if (mbk::recording::looks_like_c3d(bytes)) mbk::fuzz::check_decoded(mbk::recording::decode_c3d(bytes), size);
  return 0;
}
