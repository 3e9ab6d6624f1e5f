#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "mbk/study/store/store.h"

namespace mbk::store {

/// A folder that goes away, and what tests put into it.
class TestFolder {
 public:
  TestFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "mbk-store-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  ~TestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  [[nodiscard]] std::filesystem::path file(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

inline std::string text_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A new study in `folder`.
inline Store new_study(const std::filesystem::path& folder) {
  EXPECT_TRUE(Store::create(folder, {"A study", "{}"}, Role::investigator));
  return std::move(Store::open(folder).value());
}

/// Adds a file of that participant.
inline Result<std::vector<AddedRecording>> add(Store& study, const std::filesystem::path& file, TrialFacts facts) {
  auto incoming = MBK_TRY(study.bring_in(file));
  const std::string sha256 = incoming.sha256();
  const NewRecording one{0, std::move(facts), 62.0};
  return study.add(std::move(incoming), {&one, 1}, sha256, Role::experimenter);
}

/// A result of one axis.
inline UnitResult a_result(double stiffness, bool usable = true) {
  return {fmt::format(R"({{"schema":"mbk.result/2","axes":1,"units":{{"M":"kg","B":"N·s/m","K":"N/m","x0":"m"}},)"
                      R"("model":{{"M":[[1.5]],"B":[[7]],"K":[[{}]],"x0":[0.1]}},)"
                      R"("standard_error":{{"M":[[0.1]],"B":[[0.2]],"K":[[3]],"x0":[null]}}}})",
                      stiffness),
          usable, usable ? "" : "fit-poor"};
}

/// Stores a result for everything that has none.
inline Result<int> measure(Store& study, const std::string& options = "{}") {
  const auto units = study.pending(options, "1.0", false).value();
  std::vector<UnitResult> results;
  for (std::size_t k = 0; k < units.size(); ++k) results.push_back(a_result(100.0 + static_cast<double>(k)));
  return study.save(options, "1.0", units, results, Role::analyst);
}

}  // namespace mbk::store
