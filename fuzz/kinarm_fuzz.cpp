#include "fuzz/fuzz.h"
#include "mbk/files/kinarm/kinarm_exam.h"
#include "mbk/files/kinarm/test_exam.h"

// Checksums protect the bytes of an archive, so every change would be rejected. An input therefore consists of the
// members of an archive, each as number of its name, length in two bytes and bytes; an input that begins like an
// archive is read as one.

namespace mbk::fuzz {
namespace {

constexpr const char* kNames[] = {"raw/common/parameters.bin",
                                  "raw/02_01_01/header.bin",
                                  "raw/02_01_01/parameters.bin",
                                  "raw/02_01_01/Right_L1Ang.kinematics",
                                  "raw/02_01_01/Right_L2Ang.kinematics",
                                  "raw/02_01_01/Right_L1Vel.kinematics",
                                  "raw/02_01_01/Right_L2Vel.kinematics",
                                  "raw/02_01_01/Right_L1Acc.kinematics",
                                  "raw/02_01_01/Right_L2Acc.kinematics",
                                  "raw/02_01_01/Right_M1TorCMD.kinematics",
                                  "raw/02_01_01/Right_M2TorCMD.kinematics",
                                  "raw/02_01_01/Right_FS_ForceX.kinematics",
                                  "raw/02_01_01/Right_FS_ForceY.kinematics",
                                  "raw/02_01_01/Right_Hand.position",
                                  "raw/02_01_01/examevents.bin",
                                  "raw/02_01_01/videoack.bin",
                                  "raw/02_01_02/header.bin",
                                  "raw/02_01_02/parameters.bin",
                                  "raw/02_01_02/Right_L1Ang.kinematics",
                                  "raw/02_01_02/Right_L2Ang.kinematics",
                                  "raw/common.c3d",
                                  "raw/01_01_01.c3d"};

std::string container_of(const std::vector<std::pair<std::string, std::string>>& members) {
  std::string bytes;
  for (const auto& [name, content] : members) {
    for (std::size_t k = 0; k < std::size(kNames); ++k) {
      if (name != kNames[k]) continue;
      bytes += static_cast<char>(k);
      bytes += recording::test::raw(static_cast<std::uint16_t>(content.size())) + content;
    }
  }
  return bytes;
}

std::string archive_of(std::string_view container) {
  std::vector<std::pair<std::string, std::string>> members;
  for (std::size_t at = 0; at + 3 <= container.size();) {
    const auto byte = [&](std::size_t k) { return static_cast<std::size_t>(static_cast<unsigned char>(container[k])); };
    const char* const name = kNames[byte(at) % std::size(kNames)];
    const std::size_t length = std::min(byte(at + 1) + 256 * byte(at + 2), container.size() - at - 3);
    members.emplace_back(name, container.substr(at + 3, length));
    at += 3 + length;
  }
  return recording::test::zip_of(members);
}

}  // namespace

std::vector<std::string> seeds() {
  using recording::test::small_exam;
  auto exam = small_exam({}, 1, 30);
  exam.trials.front().folder = "02_01_01";
  std::vector<std::string> all = {container_of(exam.members()), exam.bytes()};
  auto split = small_exam({}, 2, 20);
  for (std::int32_t k = 0; k < 2; ++k) {
    auto& trial = split.trials[static_cast<std::size_t>(k)];
    trial.folder = k == 0 ? "02_01_01" : "02_01_02";
    trial.break_id = k + 1;
  }
  all.push_back(container_of(split.members()));
  const std::string c3d = recording::test::small_c3d().bytes();
  all.push_back(container_of({{"raw/common.c3d", c3d}, {"raw/01_01_01.c3d", c3d}}));
  return all;
}

}  // namespace mbk::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mbk;
  const std::string_view input = fuzz::text_of(data, size);
  const bool archive = recording::ZipArchive::looks_like_zip(fuzz::bytes_of(data, size));
  const std::string bytes = archive ? std::string(input) : fuzz::archive_of(input);
  if (!recording::ZipArchive::looks_like_zip(std::as_bytes(std::span(bytes)))) return 0;
  const auto exam = recording::KinarmExam::open(recording::test::buffer_of(bytes));
  if (!exam) {
    fuzz::require_error(exam.error());
    return 0;
  }
  fuzz::require(!exam->trials().empty(), "an exam contains trials");
  for (const recording::TrialName& trial : exam->trials()) {
    fuzz::require_line(trial.name, "the name of a trial");
    fuzz::require_line(trial.description, "the description of a trial");
    fuzz::check_decoded(exam->decode({trial.name, std::nullopt, false}), bytes.size());
    fuzz::check_decoded(exam->decode({trial.name, recording::Arm::right, false}), bytes.size());
  }
  return 0;
}
