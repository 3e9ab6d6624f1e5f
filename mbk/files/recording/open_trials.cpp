#include "mbk/files/recording/open_trials.h"

#include <fmt/format.h>

#include <mutex>
#include <span>
#include <string>
#include <utility>

#include "mbk/files/archive/zip_archive.h"
#include "mbk/files/bids/read_run.h"
#include "mbk/files/contents/file_bytes.h"
#include "mbk/files/contents/sha256.h"
#include "mbk/files/kinarm/kinarm_exam.h"

namespace mbk::recording {
namespace {

class ExamTrials : public OpenTrials {
 public:
  ExamTrials(KinarmExam exam, std::shared_ptr<const Buffer> file) : exam_(std::move(exam)), file_(std::move(file)) {}

  [[nodiscard]] const std::vector<TrialName>& trials() const override { return exam_.trials(); }

  [[nodiscard]] Result<Decoded> decode(const std::filesystem::path& file, const ReadOptions& options,
                                       bool needs_arm) const override {
    ExamChoice choice{options.trial, std::nullopt, needs_arm};
    if (!options.arm.empty()) choice.arm = options.arm == "left" ? Arm::left : Arm::right;
    auto contents = exam_.decode(choice);
    if (!contents) return tl::unexpected(contents.error());
    SourceFile source{file.string(), contents->format, sum()};
    if (trials().size() > 1) source.trial = options.trial;
    return Decoded{std::move(*contents), std::move(source)};
  }

 private:
  /// Of the file; computed when it is asked for first.
  [[nodiscard]] std::string sum() const {
    std::call_once(once_, [&] { sum_ = sha256(file_->bytes()); });
    return sum_;
  }

  KinarmExam exam_;
  std::shared_ptr<const Buffer> file_;
  mutable std::once_flag once_;
  mutable std::string sum_;
};

/// The recordings of a BIDS data set.
class BidsTrials : public OpenTrials {
 public:
  explicit BidsTrials(std::vector<BidsRun> runs) : runs_(std::move(runs)) {
    for (const BidsRun& run : runs_) names_.push_back(run.name);
  }

  [[nodiscard]] const std::vector<TrialName>& trials() const override { return names_; }

  [[nodiscard]] Result<Decoded> decode(const std::filesystem::path& /*file*/, const ReadOptions& options,
                                       bool /*needs_arm*/) const override {
    if (!options.arm.empty()) {
      return bad_usage(fmt::format("--side {}: a data set tells no arms apart", options.arm), "leave --side out");
    }
    const auto run = this->run(options.trial);
    if (!run) return tl::unexpected(run.error());
    auto contents = read_bids_run((*run)->motion);
    if (!contents) return tl::unexpected(contents.error());
    const auto bytes = read_file((*run)->motion);
    if (!bytes) return tl::unexpected(bytes.error());
    SourceFile source{(*run)->motion.string(), contents->format, sha256(bytes->bytes())};
    return Decoded{std::move(*contents), std::move(source)};
  }

 private:
  [[nodiscard]] Result<const BidsRun*> run(const std::string& trial) const {
    if (runs_.empty()) {
      return bad_data("it is a folder without a BIDS recording (…_motion.tsv)",
                      "name a file, or the folder of a data set with motion data");
    }
    if (runs_.size() == 1 && trial.empty()) return &runs_.front();
    for (const BidsRun& one : runs_) {
      if (one.name.name == trial) return &one;
    }
    if (!trial.empty()) return bad_usage(fmt::format("there is no recording '{}'", trial), "'mbk info' lists them");
    return bad_usage(fmt::format("the folder holds {} recordings", runs_.size()),
                     fmt::format("say which, as in --trial {}", runs_.front().name.name));
  }

  std::vector<BidsRun> runs_;
  std::vector<TrialName> names_;
};

}  // namespace

Result<std::shared_ptr<const OpenTrials>> open_as_trials(const std::filesystem::path& file) {
  if (may_be_bids(file)) {
    auto runs = find_bids_runs(file);
    if (!runs) return tl::unexpected(runs.error());
    return std::make_shared<const BidsTrials>(std::move(*runs));
  }
  const std::string begin = begin_of(file, 64);
  if (!ZipArchive::looks_like_zip(std::as_bytes(std::span(begin)))) return std::shared_ptr<const OpenTrials>();
  auto bytes = read_file(file);
  if (!bytes) return tl::unexpected(bytes.error());
  const auto shared = std::make_shared<const Buffer>(std::move(*bytes));
  const auto archive = ZipArchive::open(shared->bytes());
  if (!archive) return tl::unexpected(archive.error());
  if (!KinarmExam::is_exam(*archive)) return std::shared_ptr<const OpenTrials>();
  auto exam = KinarmExam::open(shared);
  if (!exam) return tl::unexpected(exam.error());
  return std::make_shared<const ExamTrials>(std::move(*exam), shared);
}

}  // namespace mbk::recording
