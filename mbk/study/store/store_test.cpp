#include "mbk/study/store/store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <csignal>
#include <map>

#include "mbk/files/contents/durable_files.h"
#include "mbk/study/store/store_files.h"
#include "mbk/study/store/study_list.h"
#include "mbk/study/store/test_study.h"

namespace mbk::store {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;
using testing::SizeIs;

TrialFacts of(std::int64_t participant, std::string condition = "relaxed") {
  return {participant, 1, std::move(condition), std::nullopt};
}

/// What somebody does who changes the database by hand.
void change_by_hand(const fs::path& folder, const char* sql) {
  sqlite3* connection = nullptr;
  ASSERT_EQ(sqlite3_open((folder / "study.sqlite").c_str(), &connection), SQLITE_OK);
  char* message = nullptr;
  EXPECT_EQ(sqlite3_exec(connection, sql, nullptr, nullptr, &message), SQLITE_OK) << message;
  sqlite3_free(message);
  sqlite3_close(connection);
}

CheckReport checked(Store& study) {
  return study.check(false, {}).value();
}

TEST(AStudy, KeepsARecordingUnderItsHashAndForItsOwnerAlone) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  const auto added = add(study, folder.file("Jane Doe.H5", "bytes"), of(7));
  ASSERT_TRUE(added) << added.error().line();
  const StoredRecording& one = added->front().recording;
  EXPECT_EQ(one.sha256, files::file_sha256(folder / "Jane Doe.H5").value());
  const fs::path stored = folder / "study" / stored_name(one.sha256, ".h5");
  EXPECT_EQ(text_of(stored), "bytes");
  struct stat status {};
  for (const auto& [path, mode] : std::vector<std::pair<fs::path, unsigned>>{
           {folder / "study", 0700}, {stored, 0600}, {folder / "study" / "study.sqlite", 0600}}) {
    ASSERT_EQ(::stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, mode) << path;
  }
  EXPECT_EQ(text_of(folder / "study" / "study.sqlite").find("Jane"), std::string::npos);
}

TEST(AStudy, IsNotMadeWhereThereIsSomething) {
  const TestFolder folder;
  std::ignore = new_study(folder / "study");
  EXPECT_EQ(Store::create(folder / "study", {}, Role::analyst).error().kind, ErrorKind::usage);
  fs::create_directory(folder / "full");
  std::ignore = folder.file("full/thesis.tex", "\\section");
  EXPECT_THAT(Store::create(folder / "full", {}, Role::analyst).error().message, HasSubstr("thesis.tex"));
  EXPECT_EQ(Store::open(folder / "full").error().kind, ErrorKind::usage);
}

TEST(AStudy, CountsTrialsWithinParticipantSessionAndCondition) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  std::vector<std::int64_t> trials;
  int n = 0;
  for (const TrialFacts& facts :
       {of(7), of(7), of(8), of(7, "stiff"), TrialFacts{7, 2, "relaxed", std::nullopt}, of(7)}) {
    trials.push_back(add(study, folder.file("f", std::to_string(n++)), facts)->front().recording.trial);
  }
  EXPECT_EQ(trials, (std::vector<std::int64_t>{1, 2, 1, 1, 1, 3}));
}

TEST(AStudy, StoresAFileOnceAndForOneParticipant) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  const fs::path file = folder.file("f.h5", "bytes");
  ASSERT_TRUE(add(study, file, of(7)));
  const auto again = add(study, file, of(7));
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_TRUE(again->front().there_before);
  EXPECT_THAT(study.recordings().value(), SizeIs(1));
  const auto other = add(study, file, of(8));
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("participant 7"));
  EXPECT_THAT(checked(study).problems, IsEmpty());
}

TEST(AStudy, RefusesFactsThatAreOutOfRange) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  const fs::path file = folder.file("f.h5", "bytes");
  for (const TrialFacts& facts : {TrialFacts{0, 1, "", std::nullopt}, TrialFacts{1, -1, "", std::nullopt},
                                  TrialFacts{1, 1, "two\nlines", std::nullopt}, TrialFacts{1, 1, "", 0}}) {
    const auto added = add(study, file, facts);
    ASSERT_FALSE(added);
    EXPECT_EQ(added.error().kind, ErrorKind::usage);
  }
  EXPECT_THAT(study.recordings().value(), IsEmpty());
  EXPECT_THAT(checked(study).notes, IsEmpty()) << "nothing is left of what was refused";
}

TEST(AStudy, MeasuresWhatIsNewAndWhatHasOtherOptions) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  ASSERT_TRUE(add(study, folder.file("a", "1"), of(1)));
  ASSERT_TRUE(add(study, folder.file("b", "2"), of(2)));
  EXPECT_EQ(measure(study).value(), 2);
  EXPECT_EQ(measure(study).value(), 0);
  EXPECT_EQ(measure(study, R"({"--mode":["reference"]})").value(), 2);
  ASSERT_TRUE(add(study, folder.file("c", "3"), of(3)));
  EXPECT_EQ(measure(study).value(), 1);
  EXPECT_THAT(study.pending("{}", "1.1", false).value(), SizeIs(3)) << "another version measures all";
  EXPECT_THAT(study.analyses().value(), SizeIs(2));
  EXPECT_THAT(checked(study).problems, IsEmpty());
}

TEST(AStudy, KeepsTheResultThatCameFirst) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  ASSERT_TRUE(add(study, folder.file("a", "1"), of(1)));
  const auto units = study.pending("{}", "1.0", false).value();
  const std::vector<UnitResult> first = {a_result(100)}, second = {a_result(200)};
  EXPECT_EQ(study.save("{}", "1.0", units, first, Role::analyst).value(), 1);
  EXPECT_EQ(study.save("{}", "1.0", units, second, Role::analyst).value(), 0);
  EXPECT_EQ(study.document(units.front(), 1).value(), first.front().document);
}

TEST(AStudy, TriesAgainOnlyWhatFailedAndIsAskedFor) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  ASSERT_TRUE(add(study, folder.file("a", "1"), of(1)));
  const auto units = study.pending("{}", "1.0", false).value();
  const std::vector<UnitResult> failed = {{"", false, "no channel is recognised"}}, good = {a_result(100)};
  ASSERT_TRUE(study.save("{}", "1.0", units, failed, Role::analyst));
  EXPECT_THAT(study.pending("{}", "1.0", false).value(), IsEmpty());
  EXPECT_EQ(list_study(study, std::nullopt)->count(RecordingState::failed), 1);
  ASSERT_THAT(study.pending("{}", "1.0", true).value(), SizeIs(1));
  EXPECT_EQ(study.save("{}", "1.0", units, good, Role::analyst).value(), 1);
  EXPECT_EQ(list_study(study, std::nullopt)->count(RecordingState::usable), 1);
  EXPECT_THAT(study.pending("{}", "1.0", true).value(), IsEmpty());
  EXPECT_THAT(checked(study).problems, IsEmpty());
}

TEST(AStudy, ObservesOnlyWhatIsUsableAndNotExcluded) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  for (const char* name : {"a", "b", "c"}) ASSERT_TRUE(add(study, folder.file(name, name), of(1)));
  const auto units = study.pending("{}", "1.0", false).value();
  std::vector<UnitResult> results = {a_result(100), a_result(200, false), a_result(300)};
  ASSERT_TRUE(study.save("{}", "1.0", units, results, Role::analyst));
  const auto stiffness = [&] {
    const OutcomeColumns columns = study.columns(1).value();
    return std::ranges::find(columns.outcomes, "K", &OutcomeColumn::name)->values;
  };
  EXPECT_THAT(stiffness(), testing::UnorderedElementsAre(100, 300));
  const std::int64_t first = study.recordings_of(units[0].sha256)->front().number;
  ASSERT_TRUE(study.exclude(first, "slipped", Role::analyst));
  EXPECT_THAT(stiffness(), testing::ElementsAre(300));
  EXPECT_FALSE(study.exclude(first, "again", Role::analyst));
  ASSERT_TRUE(study.include(first, "it was another", Role::analyst));
  EXPECT_THAT(stiffness(), SizeIs(2));
  EXPECT_THAT(checked(study).problems, IsEmpty());
}

TEST(AStudy, GivesItsNumbersByParticipantAndSession) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  ASSERT_TRUE(add(study, folder.file("a", "a"), {8, 1, "tensed", {}}));
  ASSERT_TRUE(add(study, folder.file("b", "b"), {7, 2, "relaxed", {}}));
  ASSERT_TRUE(add(study, folder.file("c", "c"), {7, 1, "tensed", {}}));
  ASSERT_TRUE(measure(study));
  const OutcomeColumns columns = study.columns(1).value();
  EXPECT_THAT(columns.conditions, testing::ElementsAre("tensed", "relaxed")) << "as the recordings came";
  std::vector<std::int64_t> recordings;
  for (const TrialRow& trial : columns.trials) recordings.push_back(trial.recording);
  EXPECT_THAT(recordings, testing::ElementsAre(3, 2, 1));
  for (const OutcomeColumn& column : columns.outcomes) {
    ASSERT_EQ(column.values.size(), 3U);
    for (std::size_t k = 0; k < recordings.size(); ++k) {
      const auto result = study.results_of(recordings[k]).value().at(0).number;
      const auto stored = study.outcomes(result).value();
      const auto found = std::ranges::find(stored, column.name, &Outcome::name);
      ASSERT_NE(found, stored.end());
      EXPECT_EQ(column.values[k], found->value);
      EXPECT_EQ(column.unit, found->unit);
      if (!found->standard_error) continue;
      EXPECT_EQ(column.standard_errors.at(k), *found->standard_error);
    }
  }
}

TEST(AStudyOfTheTablesBefore, HasItsNumbersPacked) {
  const TestFolder folder;
  {
    Store study = new_study(folder / "study");
    ASSERT_TRUE(add(study, folder.file("a", "a"), of(1)));
    ASSERT_TRUE(measure(study));
  }
  change_by_hand(
      folder / "study",
      "ALTER TABLE recording DROP COLUMN rater; DROP TABLE packed; DROP TABLE layout; CREATE TABLE outcome(result "
      "INTEGER NOT NULL, position INTEGER NOT NULL, "
      "name TEXT NOT NULL, value REAL NOT NULL, standard_error REAL, unit TEXT NOT NULL, PRIMARY KEY (result, "
      "position)) STRICT, WITHOUT ROWID; INSERT INTO outcome VALUES (1, 0, 'K', 100, 3, 'N/m'); "
      "PRAGMA user_version = 1");
  auto study = Store::open(folder / "study");
  ASSERT_TRUE(study) << study.error().line();
  EXPECT_EQ(study->columns(1).value().trials.size(), 1U);
  EXPECT_FALSE(study->outcomes(1).value().empty());
  EXPECT_THAT(checked(*study).problems, IsEmpty());
}

TEST(AStudyOfTheTablesBefore, HasNoRatersAndTheDigestsOfBefore) {
  const TestFolder folder;
  {
    Store study = new_study(folder / "study");
    ASSERT_TRUE(add(study, folder.file("a", "a"), of(1)));
    ASSERT_TRUE(measure(study));
  }
  change_by_hand(folder / "study", "ALTER TABLE recording DROP COLUMN rater; PRAGMA user_version = 2");
  auto study = Store::open(folder / "study");
  ASSERT_TRUE(study) << study.error().line();
  EXPECT_EQ(study->recording(1)->rater, "");
  EXPECT_THAT(study->columns(1)->raters, IsEmpty());
  EXPECT_EQ(study->columns(1)->trials.at(0).rater, -1);
  EXPECT_THAT(checked(*study).problems, IsEmpty());
  ASSERT_TRUE(add(*study, folder.file("b", "b"), TrialFacts{1, 1, "relaxed", {}, "A"}));
  EXPECT_THAT(checked(*study).problems, IsEmpty());
}

TEST(AStudy, KeepsTheRaterAndNumbersTheTrialsOfEach) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  std::vector<std::int64_t> trials;
  int n = 0;
  for (const char* rater : {"B", "A", "B", "", "A"}) {
    const auto added = add(study, folder.file("f", std::to_string(n++)), TrialFacts{7, 1, "relaxed", {}, rater});
    ASSERT_TRUE(added) << added.error().line();
    EXPECT_EQ(added->front().recording.rater, rater);
    trials.push_back(added->front().recording.trial);
  }
  EXPECT_THAT(trials, testing::ElementsAre(1, 1, 2, 1, 2));
  ASSERT_TRUE(measure(study));
  const OutcomeColumns columns = study.columns(1).value();
  EXPECT_THAT(columns.raters, testing::ElementsAre("A", "B"));
  std::map<std::int64_t, int> raters;
  for (const TrialRow& trial : columns.trials) raters[trial.recording] = trial.rater;
  EXPECT_THAT(raters, testing::ElementsAre(Pair(1, 1), Pair(2, 0), Pair(3, 1), Pair(4, -1), Pair(5, 0)));
  const auto other = add(study, folder.file("f", "0"), TrialFacts{7, 1, "relaxed", {}, "C"});
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("rater B"));
  for (const char* name : {"Jane", "JD", "a", "R02", "0"}) {
    EXPECT_FALSE(add(study, folder.file("g", "g"), TrialFacts{7, 1, "relaxed", {}, name})) << name;
  }
}

TEST(AForgottenParticipant, LeavesOnlyTheFact) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  ASSERT_TRUE(add(study, folder.file("a", "of seven"), of(7, "seldom-condition")));
  ASSERT_TRUE(add(study, folder.file("b", "of eight"), of(8)));
  const StoredRecording seven = study.recording(1).value();
  ASSERT_TRUE(measure(study));
  const auto forgotten = study.forget(7, "consent withdrawn", Role::data_manager);
  ASSERT_TRUE(forgotten) << forgotten.error().line();
  EXPECT_EQ(forgotten->recordings, 1);
  EXPECT_EQ(forgotten->results, 1);
  EXPECT_EQ(forgotten->files, 1);
  EXPECT_TRUE(forgotten->log_of_changes_emptied);
  EXPECT_FALSE(fs::exists(folder / "study" / stored_name(seven.sha256, seven.extension)));
  for (const char* name : {"study.sqlite", "study.sqlite-wal"}) {
    const std::string bytes = text_of(folder / "study" / name);
    EXPECT_EQ(bytes.find(seven.sha256), std::string::npos) << name;
    EXPECT_EQ(bytes.find("seldom-condition"), std::string::npos) << name;
  }
  const auto log = study.log().value();
  EXPECT_EQ(log[log.size() - 2].participant, 7);
  EXPECT_EQ(log[log.size() - 2].why, "consent withdrawn");
  EXPECT_THAT(checked(study).problems, IsEmpty());
  EXPECT_FALSE(study.forget(7, "again", Role::data_manager));
  ASSERT_TRUE(add(study, folder.file("c", "new"), of(9)));
  EXPECT_EQ(study.recordings()->back().number, 3) << "a number is never given twice";
}

TEST(AForgottenParticipant, IsErasedToTheEndByTheNextCommand) {
  const TestFolder folder;
  std::string name;
  {
    Store study = new_study(folder / "study");
    ASSERT_TRUE(add(study, folder.file("a", "of seven"), of(7)));
    const StoredRecording seven = study.recording(1).value();
    name = stored_name(seven.sha256, seven.extension);
  }
  // As a process leaves it that ends between what the database and what the folder says.
  change_by_hand(
      folder / "study",
      ("PRAGMA foreign_keys = ON; DELETE FROM recording; INSERT INTO erasure VALUES ('" + name + "')").c_str());
  EXPECT_TRUE(fs::exists(folder / "study" / name));
  ASSERT_TRUE(Store::open(folder / "study"));
  EXPECT_FALSE(fs::exists(folder / "study" / name));
}

struct Change {
  const char* name;
  const char* sql;
  const char* says;
};

class ACheck : public testing::TestWithParam<Change> {};

TEST_P(ACheck, FindsAChangeByHand) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  ASSERT_TRUE(add(study, folder.file("a", "1"), of(7)));
  ASSERT_TRUE(add(study, folder.file("b", "2"), of(8)));
  ASSERT_TRUE(measure(study));
  ASSERT_TRUE(study.exclude(2, "slipped", Role::analyst));
  ASSERT_THAT(checked(study).problems, IsEmpty());
  change_by_hand(folder / "study", GetParam().sql);
  EXPECT_THAT(checked(study).problems, Contains(HasSubstr(GetParam().says)));
}

INSTANTIATE_TEST_SUITE_P(
    Of, ACheck,
    testing::Values(
        Change{"Participant", "UPDATE recording SET participant = 9 WHERE number = 1", "recording 1"},
        Change{"Condition", "UPDATE recording SET condition = 'stiff' WHERE number = 1", "recording 1"},
        Change{"Rater", "UPDATE recording SET rater = 'A' WHERE number = 1", "recording 1"},
        Change{"Exclusion", "UPDATE recording SET excluded_why = NULL", "recording 2"},
        Change{"Reason", "UPDATE recording SET excluded_why = 'tired' WHERE number = 2", "recording 2"},
        Change{"Recording", "PRAGMA foreign_keys = ON; DELETE FROM recording WHERE number = 1", "recording 1"},
        Change{"Result", "PRAGMA foreign_keys = ON; DELETE FROM result WHERE recording = 1", "recording 1"},
        Change{"Usable", "UPDATE result SET usable = 0 WHERE recording = 1", "recording 1"},
        Change{"Document", "UPDATE document SET text = replace(text, '1.5', '1.6')", "recording 1"},
        Change{"Number", "UPDATE packed SET numbers = zeroblob(length(numbers))", "numbers"},
        Change{"NumberCutOff", "UPDATE packed SET numbers = substr(numbers, 1, 16)", "numbers"},
        Change{"MissingNumbers", "DELETE FROM packed", "numbers"},
        Change{"NameOfNumber", "UPDATE layout SET names = replace(names, '\"K\"', '\"k\"')", "numbers"},
        Change{"Options", "UPDATE analysis SET options = '{\"--cutoff\":[\"5\"]}'", "recording 1"},
        Change{"Defaults", "UPDATE fact SET value = '[]' WHERE name = 'options'", "options"},
        Change{"LogLine", "DROP TRIGGER log_is_never_changed; UPDATE log SET role = 'monitor' WHERE number = 2",
               "line 2"},
        Change{"LogTime", "DROP TRIGGER log_is_never_changed; UPDATE log SET time = '2020' WHERE number = 1", "line 1"},
        Change{"LogLineTakenOut", "DROP TRIGGER log_is_never_shortened; DELETE FROM log WHERE number = 3", "line 3"},
        Change{"LogEnd", "DROP TRIGGER log_is_never_shortened; DELETE FROM log WHERE number = 6", "recording 2"}),
    [](const auto& change) { return change.param.name; });

TEST(TheLog, RefusesToBeChanged) {
  const TestFolder folder;
  std::ignore = new_study(folder / "study");
  sqlite3* connection = nullptr;
  ASSERT_EQ(sqlite3_open((folder / "study" / "study.sqlite").c_str(), &connection), SQLITE_OK);
  EXPECT_NE(sqlite3_exec(connection, "UPDATE log SET why = 'x'", nullptr, nullptr, nullptr), SQLITE_OK);
  EXPECT_NE(sqlite3_exec(connection, "DELETE FROM log", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(connection);
}

TEST(TheLog, ShowsByANotedHeadThatItsEndWasCut) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  ASSERT_TRUE(add(study, folder.file("a", "1"), of(7)));
  const std::string head = study.verify_log("")->head;
  EXPECT_THAT(study.verify_log(head)->problems, IsEmpty());
  change_by_hand(folder / "study",
                 "DROP TRIGGER log_is_never_shortened; DELETE FROM log WHERE number = 2; DELETE FROM recording");
  EXPECT_THAT(study.verify_log("")->problems, IsEmpty()) << "the end alone does not show";
  EXPECT_THAT(study.verify_log(head)->problems, SizeIs(1));
}

TEST(ACheckOfFiles, FindsOneThatChangedAndOneThatIsGone) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  ASSERT_TRUE(add(study, folder.file("a", "1"), of(7)));
  ASSERT_TRUE(add(study, folder.file("b", "2"), of(8)));
  const auto path = [&](std::int64_t number) {
    const StoredRecording one = study.recording(number).value();
    return folder / "study" / stored_name(one.sha256, one.extension);
  };
  std::ofstream(path(1)) << "x";
  fs::remove(path(2));
  const CheckReport report = checked(study);
  EXPECT_THAT(report.problems, SizeIs(2));
  EXPECT_EQ(report.files, 0);
}

TEST(ACheckOfFiles, TidiesUpWhatWasLeftAndOnlyThat) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  ASSERT_TRUE(add(study, folder.file("a", "1"), of(7)));
  const fs::path recordings = folder / "study" / "recordings";
  std::ignore = folder.file("study/recordings/.1.2.3.part", "half");
  fs::create_directory(recordings / "00");
  const fs::path whole = recordings / "00" / (std::string(64, '0') + ".h5");
  std::ofstream(whole) << "whole";
  std::ofstream(recordings / "notes.txt") << "mine";
  EXPECT_THAT(checked(study).notes, SizeIs(3));
  EXPECT_FALSE(fs::exists(recordings / ".1.2.3.part"));
  EXPECT_TRUE(fs::exists(whole));
  EXPECT_THAT(study.check(true, {})->problems, IsEmpty());
  EXPECT_FALSE(fs::exists(whole));
  EXPECT_TRUE(fs::exists(recordings / "notes.txt"));
  EXPECT_EQ(checked(study).files, 1);
}

TEST(ABackup, IsTheStudyAgain) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  ASSERT_TRUE(add(study, folder.file("a.h5", "1"), of(7)));
  ASSERT_TRUE(measure(study));
  for (const bool link : {false, true}) {
    const fs::path to = folder / (link ? "linked" : "copied");
    const auto made = study.backup(to, link);
    ASSERT_TRUE(made) << made.error().line();
    EXPECT_EQ(made->head, study.verify_log("")->head);
    Store copy = std::move(Store::open(to).value());
    EXPECT_THAT(checked(copy).problems, IsEmpty());
    EXPECT_EQ(to_json(list_study(copy, std::nullopt).value()), to_json(list_study(study, std::nullopt).value()));
    EXPECT_EQ(study.backup(to, link).error().kind, ErrorKind::usage);
  }
}

TEST(ABackup, OfAStudyThatIsNotSoundIsNone) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  ASSERT_TRUE(add(study, folder.file("a.h5", "1"), of(7)));
  const StoredRecording one = study.recording(1).value();
  std::ofstream(folder / "study" / stored_name(one.sha256, one.extension)) << "x";
  EXPECT_FALSE(study.backup(folder / "copy", false));
  EXPECT_FALSE(fs::exists(folder / "copy"));
}

TEST(ADatabase, OfANewerVersionOrAnotherProgramIsRefused) {
  const TestFolder folder;
  std::ignore = new_study(folder / "study");
  change_by_hand(folder / "study", "PRAGMA user_version = 99");
  EXPECT_THAT(Store::open(folder / "study").error().message, HasSubstr("99"));
  change_by_hand(folder / "study", "PRAGMA application_id = 5");
  EXPECT_THAT(Store::open(folder / "study").error().message, HasSubstr("program"));
  std::ofstream(folder / "study" / "study.sqlite", std::ios::trunc) << std::string(5000, 'x');
  EXPECT_THAT(Store::open(folder / "study").error().message, HasSubstr("database"));
}

/// What `work` gives in a process of its own: its exit code.
template <class Work>
int in_process(const Work& work) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(work());
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(TwoProcesses, AddAndMeasureAtOnceAndLoseNothing) {
  const TestFolder folder;
  std::ignore = new_study(folder / "study");
  constexpr int kEach = 12;
  std::vector<pid_t> children;
  for (int who = 1; who <= 3; ++who) {
    const pid_t child = ::fork();
    if (child == 0) {
      auto study = Store::open(folder / "study");
      for (int k = 0; study && k < kEach; ++k) {
        const auto file = folder.file(fmt::format("{}-{}", who, k), fmt::format("{} {}", who == 3 ? 2 : who, k));
        if (!add(*study, file, of(who == 3 ? 2 : who)) || !measure(*study)) ::_exit(1);
      }
      ::_exit(study ? 0 : 1);
    }
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_EQ(status, 0);
  }
  Store study = std::move(Store::open(folder / "study").value());
  EXPECT_THAT(study.recordings().value(), SizeIs(2 * kEach));
  EXPECT_THAT(study.results(1).value(), SizeIs(2 * kEach));
  EXPECT_THAT(checked(study).problems, IsEmpty());
  EXPECT_THAT(checked(study).notes, IsEmpty());
}

/// No file of this process may grow beyond this.
void limit_files_to(rlim_t bytes) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{bytes, bytes};
  ::setrlimit(RLIMIT_FSIZE, &limit);
}

TEST(AFullDisk, LosesNothingAndLeavesNothingByHalf) {
  const TestFolder folder;
  Store study = new_study(folder / "study");
  ASSERT_TRUE(add(study, folder.file("a", "1"), of(7)));
  const fs::path large = folder.file("large", std::string(400000, 'x'));
  EXPECT_EQ(in_process([&] {
              limit_files_to(200000);
              auto full = Store::open(folder / "study");
              if (!full) return 1;
              const auto added = add(*full, large, of(8));
              return !added && added.error().remedy.find("space") != std::string::npos ? 0 : 2;
            }),
            0);
  // Where the database cannot grow: each size at which one of its files may stop.
  int failed = 0;
  for (rlim_t bytes = 4096; bytes < 160000; bytes += 9000) {
    const int ended = in_process([&] {
      limit_files_to(bytes);
      auto full = Store::open(folder / "study");
      if (!full) return 3;
      return measure(*full) ? 0 : 3;
    });
    EXPECT_THAT(ended, testing::AnyOf(0, 3)) << bytes;
    failed += ended == 3 ? 1 : 0;
    Store after = std::move(Store::open(folder / "study").value());
    EXPECT_THAT(checked(after).problems, IsEmpty()) << bytes;
    EXPECT_THAT(after.recordings().value(), SizeIs(1));
  }
  EXPECT_GT(failed, 3);
}

}  // namespace
}  // namespace mbk::store
