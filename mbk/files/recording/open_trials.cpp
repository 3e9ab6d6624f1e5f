#include "mbk/files/recording/open_trials.h"

#include <fmt/format.h>

#include <mutex>
#include <span>
#include <string>
#include <utility>

#include "mbk/files/archive/zip_archive.h"
#include "mbk/files/bids/read_run.h"
#include "mbk/files/kinarm/kinarm_exam.h"

namespace mbk::recording {
namespace {

class ExamTrials : public OpenTrials {
 public:
  ExamTrials(KinarmExam exam, std::string sha256) : exam_(std::move(exam)), sha256_(std::move(sha256)) {}

  [[nodiscard]] const std::vector<TrialName>& trials() const override { return exam_.trials(); }

  [[nodiscard]] Result<Decoded> decode(const std::filesystem::path& file, const ReadOptions& options,
                                       bool needs_arm) const override {
    ExamChoice choice{options.trial, std::nullopt, needs_arm};
    if (!options.arm.empty()) choice.arm = options.arm == "left" ? Arm::left : Arm::right;
    auto contents = MBK_TRY(exam_.decode(choice));
    SourceFile source{file.string(), contents.format, sha256_};
    if (trials().size() > 1) source.trial = options.trial;
    return Decoded{std::move(contents), std::move(source)};
  }

 private:
  KinarmExam exam_;
  std::string sha256_;  ///< of the file
};

class DecodedTrials : public OpenTrials {
 public:
  DecodedTrials(std::vector<NamedContents> records, std::string sha256)
      : records_(std::move(records)), sha256_(std::move(sha256)) {
    if (records_.size() < 2) return;
    for (const NamedContents& record : records_) names_.push_back(record.name);
  }

  [[nodiscard]] const std::vector<TrialName>& trials() const override { return names_; }

  [[nodiscard]] Result<Decoded> decode(const std::filesystem::path& file, const ReadOptions& options,
                                       bool /*needs_arm*/) const override {
    if (!options.arm.empty()) {
      return bad_usage(fmt::format("--side {}: the file does not distinguish left and right arm", options.arm),
                       "omit --side");
    }
    const auto record = MBK_TRY(this->record(options.trial));
    SourceFile source{file.string(), record->contents.format, sha256_};
    if (records_.size() > 1) source.trial = options.trial;
    return Decoded{record->contents, std::move(source)};
  }

 private:
  [[nodiscard]] Result<const NamedContents*> record(const std::string& trial) const {
    if (records_.size() == 1 && trial.empty()) return &records_.front();
    for (const NamedContents& one : records_) {
      if (records_.size() > 1 && one.name.name == trial) return &one;
    }
    if (!trial.empty()) return bad_usage(fmt::format("trial '{}' does not exist", trial), "'mbk info' lists them");
    return bad_usage(fmt::format("the file contains {} recordings", records_.size()),
                     fmt::format("select one, as in --trial {}", records_.front().name.name));
  }

  std::vector<NamedContents> records_;
  std::string sha256_;  ///< of the file
  std::vector<TrialName> names_;
};

class BidsTrials : public OpenTrials {
 public:
  explicit BidsTrials(std::vector<BidsRun> runs) : runs_(std::move(runs)) {
    for (const BidsRun& run : runs_) names_.push_back(run.name);
  }

  [[nodiscard]] const std::vector<TrialName>& trials() const override { return names_; }

  [[nodiscard]] Result<Decoded> decode(const std::filesystem::path& /*file*/, const ReadOptions& options,
                                       bool /*needs_arm*/) const override {
    if (!options.arm.empty()) {
      return bad_usage(fmt::format("--side {}: the data set does not distinguish left and right arm", options.arm),
                       "omit --side");
    }
    const auto run = MBK_TRY(this->run(options.trial));
    auto recording = MBK_TRY(read_bids_run(run->motion));
    SourceFile source{run->motion.string(), recording.contents.format, std::move(recording.sha256)};
    return Decoded{std::move(recording.contents), std::move(source)};
  }

 private:
  [[nodiscard]] Result<const BidsRun*> run(const std::string& trial) const {
    if (runs_.empty()) {
      return bad_data("the folder contains no BIDS recording (…_motion.tsv)",
                      "name a file, or the folder of a data set with motion data");
    }
    if (runs_.size() == 1 && trial.empty()) return &runs_.front();
    for (const BidsRun& one : runs_) {
      if (one.name.name == trial) return &one;
    }
    if (!trial.empty()) return bad_usage(fmt::format("recording '{}' does not exist", trial), "'mbk info' lists them");
    return bad_usage(fmt::format("the folder contains {} recordings", runs_.size()),
                     fmt::format("select one, as in --trial {}", runs_.front().name.name));
  }

  std::vector<BidsRun> runs_;
  std::vector<TrialName> names_;
};

}  // namespace

Result<std::shared_ptr<const OpenTrials>> exam_trials(std::shared_ptr<const Buffer> file, std::string sha256) {
  auto exam = MBK_TRY(KinarmExam::open(std::move(file)));
  return std::make_shared<const ExamTrials>(std::move(exam), std::move(sha256));
}

std::shared_ptr<const OpenTrials> decoded_trials(std::vector<NamedContents> records, std::string sha256) {
  return std::make_shared<const DecodedTrials>(std::move(records), std::move(sha256));
}

Result<std::shared_ptr<const OpenTrials>> bids_trials(const std::filesystem::path& folder) {
  auto runs = MBK_TRY(find_bids_runs(folder));
  return std::make_shared<const BidsTrials>(std::move(runs));
}

}  // namespace mbk::recording
