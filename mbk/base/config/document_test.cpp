#include "mbk/base/config/document.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "mbk/base/config/toml_tree.h"

namespace mbk::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Document parsed(std::string_view text) {
  return Document::parse(text, "x.toml").value();
}

std::string refusal(std::string_view text) {
  const auto document = Document::parse(text, "x.toml");
  if (document) return "it was parsed";
  EXPECT_EQ(document.error().kind, ErrorKind::data);
  return document.error().line();
}

std::string problem(const Document& document) {
  const auto finished = document.finish();
  if (finished) return "";
  EXPECT_EQ(finished.error().kind, ErrorKind::data);
  return finished.error().line();
}

enum class Kind { multisine, pulses };

// ---- values ----

TEST(Section, GivesNumbersInSiUnits) {
  const Document document = parsed("amplitude_mm = 5\ncutoff_hz = 7.5\ntilt_deg = -90.0\n");
  const Section s = document.root();
  EXPECT_EQ(s.number("amplitude_mm", 0.0, above(0)), 0.005);
  EXPECT_EQ(s.number("cutoff_hz", 0.0), 7.5);
  EXPECT_EQ(s.required_number("tilt_deg", between(-180, 180)), -std::numbers::pi / 2);
  EXPECT_EQ(problem(document), "");
}

TEST(Section, GivesSomeOfAFewWords) {
  const auto chosen = [](const std::string& text) {
    const Document document = parsed(text);
    const auto kinds = document.root().choices<Kind>(
        "kinds", {{"multisine", Kind::multisine}, {"pulses", Kind::pulses}}, {Kind::pulses});
    return std::pair(kinds, problem(document));
  };
  EXPECT_THAT(chosen("").first, ElementsAre(Kind::pulses));
  EXPECT_THAT(chosen("kinds = []").first, testing::IsEmpty());
  EXPECT_THAT(chosen("kinds = ['pulses', 'multisine']").first, ElementsAre(Kind::pulses, Kind::multisine));
  EXPECT_THAT(chosen("kinds = ['chirp']").second, AllOf(HasSubstr("'chirp'"), HasSubstr("multisine, pulses")));
  EXPECT_THAT(chosen("kinds = ['pulses', 'pulses']").second, HasSubstr("'pulses'"));
  EXPECT_THAT(chosen("kinds = ['pulses', 1]").second, HasSubstr("entry 2"));
  EXPECT_THAT(chosen("kinds = 'pulses'").second, HasSubstr("array"));
}

TEST(Section, GivesFallbacksInSiUnitsWhereNothingStands) {
  const Document document = parsed("");
  const Section s = document.root().section("perturbation");
  EXPECT_FALSE(s.given());
  EXPECT_FALSE(s.has("amplitude_mm"));
  EXPECT_EQ(s.number("amplitude_mm", 0.005, above(0)), 0.005);
  EXPECT_EQ(s.optional_number("cutoff_hz"), std::nullopt);
  EXPECT_EQ(s.integer("directions", 8, 1, 64), 8);
  EXPECT_EQ(s.integer("seed", ~std::uint64_t{0}, 0, ~std::uint64_t{0}), ~std::uint64_t{0});
  EXPECT_TRUE(s.flag("gravity", true));
  EXPECT_EQ(s.text("name", "anybody"), "anybody");
  EXPECT_EQ(s.choice("kind", {{"multisine", Kind::multisine}, {"pulses", Kind::pulses}}, Kind::pulses), Kind::pulses);
  EXPECT_THAT(s.numbers("masses_kg", {1.0, 2.0}), ElementsAre(1.0, 2.0));
  EXPECT_EQ(s.vector2("centre_mm", {0.1, 0.2}), Eigen::Vector2d(0.1, 0.2));
  EXPECT_EQ(s.matrix2("K_N_per_m", Eigen::Matrix2d::Identity()), Eigen::Matrix2d::Identity());
  EXPECT_TRUE(s.sections("link").empty());
  EXPECT_EQ(problem(document), "");
}

TEST(Section, GivesEveryTypeOfValue) {
  const Document document = parsed(R"(
[perturbation]
directions = 16
seed = 9223372036854775807
gravity = false
name = "Anna"
note = 'calm'
kind = "multisine"
masses_g = [1000, 2000.0, 0.5e3]
centre_mm = [100, -200.0]
K_N_per_mm = [[1, 2.0], [3, 4]]
M_g = [[1, 2, 3], [4, 5, 6], [7, 8, 9]]
)");
  const Section s = document.root().section("perturbation");
  EXPECT_TRUE(s.given());
  EXPECT_TRUE(s.has("seed"));
  EXPECT_EQ(s.integer("directions", 8, 1, 64), 16);
  EXPECT_EQ(s.integer("seed", std::uint64_t{1}, 0, ~std::uint64_t{0}), 9223372036854775807u);
  EXPECT_FALSE(s.flag("gravity", true));
  EXPECT_EQ(s.required_text("name"), "Anna");
  EXPECT_EQ(s.text("note", ""), "calm");
  EXPECT_EQ(s.required_choice<Kind>("kind", {{"pulses", Kind::pulses}, {"multisine", Kind::multisine}}),
            Kind::multisine);
  EXPECT_THAT(s.numbers("masses_g", {}, above(0), 3), ElementsAre(1.0, 2.0, 0.5));
  EXPECT_EQ(s.required_vector2("centre_mm"), Eigen::Vector2d(0.1, -0.2));
  const Eigen::Matrix3d three = s.required_matrix3("M_g");
  EXPECT_EQ(three.row(0), Eigen::RowVector3d(1.0 / 1e3, 2.0 / 1e3, 3.0 / 1e3));
  EXPECT_EQ(three(2, 1), 8.0 / 1e3);
  EXPECT_EQ(s.matrix3("other_g", three), three);
  EXPECT_EQ(s.required_matrix2("K_N_per_mm"), (Eigen::Matrix2d() << 1e3, 2e3, 3e3, 4e3).finished());
  EXPECT_EQ(problem(document), "");
}

TEST(Section, GivesArraysOfTablesInOrder) {
  const Document document = parsed("[[robot.link]]\nmass_kg = 1\n[[robot.link]]\nmass_kg = 2\nlenght_m = 3\n");
  std::vector<double> masses;
  for (const Section& link : document.root().section("robot").sections("link")) {
    masses.push_back(link.number("mass_kg", 0.0));
    EXPECT_EQ(link.number("length_m", 0.5), 0.5);
  }
  EXPECT_THAT(masses, ElementsAre(1.0, 2.0));
  EXPECT_THAT(problem(document), AllOf(HasSubstr("x.toml"), HasSubstr("line 5"), HasSubstr("'lenght_m'"),
                                       HasSubstr("[robot.link[2]]"), HasSubstr("'length_m'")));
}

// ---- what is refused ----

TEST(Section, NamesFileLineKeyValueAndLimit) {
  const Document document = parsed("\n[perturbation]\n\namplitude_mm = -3\n");
  EXPECT_EQ(document.root().section("perturbation").number("amplitude_mm", 0.005, above(0)), 0.005);
  EXPECT_THAT(problem(document),
              AllOf(HasSubstr("x.toml"), HasSubstr("line 4"), HasSubstr("perturbation.amplitude_mm"), HasSubstr("-3")));
}

TEST(Section, HoldsEachRange) {
  const auto said = [](const char* value, Range range) {
    const Document document = parsed(fmt::format("a_mm = {}", value));
    (void)document.root().number("a_mm", 0.0, range);
    return problem(document);
  };
  EXPECT_EQ(said("0.001", above(0)), "");
  EXPECT_EQ(said("0", at_least(0)), "");
  EXPECT_EQ(said("1", between(0, 1)), "");
  EXPECT_EQ(said("0.5", within(0, 1)), "");
  EXPECT_THAT(said("0", above(0)), HasSubstr("a_mm"));
  EXPECT_THAT(said("-1", at_least(0)), AllOf(HasSubstr("a_mm"), HasSubstr("-1")));
  EXPECT_THAT(said("1.5", between(0, 1)), AllOf(HasSubstr("a_mm"), HasSubstr("1.5")));
  EXPECT_THAT(said("1", within(0, 1)), HasSubstr("a_mm"));
  EXPECT_THAT(said("nan", any()), AllOf(HasSubstr("a_mm"), HasSubstr("nan")));
  EXPECT_THAT(said("inf", above(0)), AllOf(HasSubstr("a_mm"), HasSubstr("inf")));
}

TEST(Section, RefusesOtherTypes) {
  const auto said = [](const char* value, const auto& ask) {
    const Document document = parsed(fmt::format("k = {}", value));
    ask(document.root());
    return problem(document);
  };
  const auto number = [](const Section& s) { (void)s.number("k", 0.0); };
  const auto integer = [](const Section& s) { (void)s.integer("k", 0, 0, 9); };
  const auto text = [](const Section& s) { (void)s.text("k", ""); };
  const auto flag = [](const Section& s) { (void)s.flag("k", true); };
  const auto numbers = [](const Section& s) { (void)s.numbers("k", {}); };
  const auto vector = [](const Section& s) { (void)s.vector2("k", Eigen::Vector2d::Zero()); };
  const auto matrix = [](const Section& s) { (void)s.matrix2("k", Eigen::Matrix2d::Zero()); };
  const auto section = [](const Section& s) { (void)s.section("k"); };
  const auto sections = [](const Section& s) { (void)s.sections("k"); };
  const auto choice = [](const Section& s) { (void)s.choice("k", {{"a", 1}, {"b", 2}}, 1); };
  EXPECT_THAT(said("'fast'", number), AllOf(HasSubstr("number"), HasSubstr("'fast'")));
  EXPECT_THAT(said("2.5", integer), HasSubstr("number"));
  EXPECT_THAT(said("10", integer), HasSubstr("10"));
  EXPECT_THAT(said("1", text), HasSubstr("text"));
  EXPECT_THAT(said("1", flag), AllOf(HasSubstr("true"), HasSubstr("false")));
  EXPECT_THAT(said("2026-01-01", number), HasSubstr("number"));
  EXPECT_THAT(said("{}", number), HasSubstr("number"));
  EXPECT_THAT(said("true", numbers), HasSubstr("array"));
  EXPECT_THAT(said("[1, 'a']", numbers), HasSubstr("entry 2"));
  EXPECT_THAT(said("[1]", vector), HasSubstr("number"));
  EXPECT_THAT(said("[1, 2]", matrix), HasSubstr("row 1"));
  EXPECT_THAT(said("[[1, 2]]", matrix), HasSubstr("[[a, b], [c, d]]"));
  EXPECT_THAT(said("[[1, 2], [3, 4, 5]]", matrix), HasSubstr("row 2"));
  EXPECT_THAT(said("1", section), HasSubstr("table"));
  EXPECT_THAT(said("{}", sections), HasSubstr("[[k]]"));
  EXPECT_THAT(said("'c'", choice), AllOf(HasSubstr("'c'"), HasSubstr("a, b")));
}

TEST(Section, ReaderCanRefuseAValueByItself) {
  const Document document = parsed("[filter]\nrate_hz = 100\ncutoff_hz = 60\n");
  const Section s = document.root().section("filter");
  (void)s.number("rate_hz", 0.0);
  (void)s.number("cutoff_hz", 0.0);
  s.reject("cutoff_hz", "60 Hz is not below Nyquist 50 Hz", "lower it");
  s.reject("rate_hz", "a later problem");
  EXPECT_THAT(problem(document), AllOf(HasSubstr("x.toml"), HasSubstr("line 3"), HasSubstr("filter.cutoff_hz"),
                                       HasSubstr("60 Hz is not below Nyquist 50 Hz"), HasSubstr("lower it")));
  EXPECT_THAT(s.error("absent", "is needed here").line(),
              AllOf(HasSubstr("line 1"), HasSubstr("filter.absent"), HasSubstr("is needed here")));
}

TEST(Section, ShowsTextsOfTheFileOnOneLineAndCutShort) {
  const Document document = parsed(fmt::format("k = \"a\\nb\\u001B{}\"", std::string(5000, 'x')));
  (void)document.root().choice("k", {{"a", 1}}, 1);
  const std::string said = problem(document);
  EXPECT_LT(said.size(), 200u);
  EXPECT_EQ(said.find_first_of("\n\x1B"), std::string::npos);
}

// ---- finish ----

TEST(Section, ReadsAFormerNameWhereTheNewOneIsMissing) {
  const Document old = parsed("frozen_ms = 300\n");
  Section s = old.root();
  s.rename("frozen_ms", "frozen_sensor_ms");
  EXPECT_EQ(s.number("frozen_sensor_ms", 0.0), 0.3);
  EXPECT_EQ(problem(old), "");
  // Beside the new name the old one is no key.
  const Document both = parsed("frozen_ms = 300\nfrozen_sensor_ms = 200\n");
  Section t = both.root();
  t.rename("frozen_ms", "frozen_sensor_ms");
  EXPECT_EQ(t.number("frozen_sensor_ms", 0.0), 0.2);
  EXPECT_THAT(problem(both), HasSubstr("'frozen_ms'"));
}

TEST(Document, NamesTheFirstUnknownKeyAndTheNearestOne) {
  const Document document = parsed("[perturbation]\namplitude_mm = 5\n\nzeta = 1\namplitud_mm = 3\n");
  const Section s = document.root().section("perturbation");
  (void)s.number("amplitude_mm", 0.0);
  (void)s.number("duration_s", 0.0);
  EXPECT_THAT(problem(document), AllOf(HasSubstr("line 4"), HasSubstr("'zeta'"), HasSubstr("[perturbation]"),
                                       HasSubstr("amplitude_mm"), HasSubstr("duration_s")));
  (void)s.number("zeta", 0.0);
  EXPECT_THAT(problem(document), AllOf(HasSubstr("line 5"), HasSubstr("'amplitud_mm'"), HasSubstr("'amplitude_mm'")));
}

TEST(Document, NamesUnknownTables) {
  const Document document = parsed("[perturbatoin]\namplitude_mm = 5\n");
  (void)document.root().section("perturbation").number("amplitude_mm", 0.0);
  EXPECT_THAT(problem(document), AllOf(HasSubstr("line 1"), HasSubstr("'perturbatoin'"), HasSubstr("'perturbation'")));
}

TEST(Document, NamesWhatIsMissing) {
  const Document document = parsed("\n[limb]\nx = 1\n");
  const Section s = document.root().section("limb");
  (void)s.number("x", 0.0);
  EXPECT_EQ(s.required_number("mass_kg", above(0)), 0.0);
  EXPECT_THAT(problem(document), AllOf(HasSubstr("line 2"), HasSubstr("[limb]"), HasSubstr("'mass_kg'")));

  const Document empty = parsed("");
  (void)empty.root().section("limb").required_text("name");
  EXPECT_THAT(problem(empty), AllOf(HasSubstr("x.toml"), HasSubstr("[limb]"), HasSubstr("'name'")));
}

TEST(Document, SaysMisspeltRatherThanMissing) {
  const Document document = parsed("[limb]\nmas_kg = 1\n");
  (void)document.root().section("limb").required_number("mass_kg");
  EXPECT_THAT(problem(document), AllOf(HasSubstr("line 2"), HasSubstr("'mas_kg'"), HasSubstr("'mass_kg'")));
  const Document table = parsed("a = 1\n[participent]\nkind = 'arm'\n[participant.arm]\nx = 1\n");
  (void)table.root().number("a", 0.0);
  const Section person = table.root().section("participant");
  (void)person.required_text("kind");
  (void)person.section("arm").number("x", 0.0);
  EXPECT_THAT(problem(table), AllOf(HasSubstr("line 2"), HasSubstr("'participent'"), HasSubstr("'participant'")));
}

TEST(Document, NamesAWrongValueBeforeAnUnknownKey) {
  const Document document = parsed("typo = 1\nb = 'x'\n");
  (void)document.root().number("b", 0.0);
  EXPECT_THAT(problem(document), AllOf(HasSubstr("line 2"), HasSubstr("number")));
}

// ---- trials ----

constexpr auto kTrials = R"([perturbation]
kind = "pulses"
amplitude_mm = 5
cutoff_hz = 7
centres_mm = [1, 2, 3]

[participant]
name = "Anna"

[[trial]]
name = "small"
perturbation.amplitude_mm = 2

[[trial]]
name = "sine-1"
[trial.perturbation]
kind = "multisine"
centres_mm = [4]
[trial.control]
rate_hz = 500
)";

struct Experiment {
  std::string name, kind, participant;
  double amplitude, cutoff, rate;
  std::size_t centres;
};

Experiment read_experiment(const std::string& name, const Document& document) {
  const Section s = document.root().section("perturbation");
  Experiment experiment{.name = name};
  experiment.kind = s.text("kind", "");
  experiment.amplitude = s.number("amplitude_mm", 0.0, above(0));
  experiment.cutoff = experiment.kind == "pulses" ? s.number("cutoff_hz", 0.0) : 0.0;
  experiment.centres = s.numbers("centres_mm", {}).size();
  experiment.participant = document.root().section("participant").text("name", "");
  experiment.rate = document.root().section("control").number("rate_hz", 1000.0);
  return experiment;
}

TEST(Trials, LayTheirKeysOverThoseOfTheFile) {
  const Document document = parsed(kTrials);
  const auto trials = document.trials();
  ASSERT_TRUE(trials) << trials.error().line();
  ASSERT_EQ(trials->size(), 2u);
  const Experiment small = read_experiment((*trials)[0].name, (*trials)[0].document);
  const Experiment sine = read_experiment((*trials)[1].name, (*trials)[1].document);
  EXPECT_EQ(small.name, "small");
  EXPECT_EQ(small.kind, "pulses");
  EXPECT_EQ(small.amplitude, 0.002);
  EXPECT_EQ(small.centres, 3u);
  EXPECT_EQ(small.rate, 1000.0);
  EXPECT_EQ(sine.name, "sine-1");
  EXPECT_EQ(sine.kind, "multisine");
  EXPECT_EQ(sine.amplitude, 0.005);
  EXPECT_EQ(sine.centres, 1u);
  EXPECT_EQ(sine.participant, "Anna");
  EXPECT_EQ(sine.rate, 500.0);
  EXPECT_EQ(problem((*trials)[0].document), "");
  EXPECT_EQ(problem((*trials)[1].document), "");  // cutoff_hz of the file is the other one's
  EXPECT_EQ(problem(document), "");
}

TEST(Trials, AreTheFileItselfWhereItHasNone) {
  const Document document = parsed("[perturbation]\namplitude_mm = 3\ntypo = 1\n");
  const auto trials = document.trials().value();
  ASSERT_EQ(trials.size(), 1u);
  EXPECT_EQ(trials[0].name, "");
  EXPECT_EQ(read_experiment("", trials[0].document).amplitude, 0.003);
  EXPECT_THAT(problem(trials[0].document), AllOf(HasSubstr("line 3"), HasSubstr("'typo'")));
  EXPECT_THAT(problem(document), AllOf(HasSubstr("line 3"), HasSubstr("'typo'")));
}

TEST(Trials, PointTheirProblemsIntoTheFile) {
  const Document document = parsed(
      "[perturbation]\namplitude_mm = 5\nshared_typo = 1\n[[trial]]\nname = 'a'\nperturbation.amplitude_mm = -1\n"
      "[[trial]]\nname = 'b'\nperturbation.amplitud_mm = 1\n");
  const auto trials = document.trials().value();
  for (const Trial& trial : trials) (void)read_experiment(trial.name, trial.document);
  EXPECT_THAT(problem(trials[0].document),
              AllOf(HasSubstr("line 6"), HasSubstr("perturbation.amplitude_mm"), HasSubstr("-1")));
  EXPECT_THAT(problem(trials[1].document),
              AllOf(HasSubstr("line 9"), HasSubstr("'amplitud_mm'"), HasSubstr("'amplitude_mm'")));
  EXPECT_THAT(problem(document), AllOf(HasSubstr("line 6"), HasSubstr("perturbation.amplitude_mm"), HasSubstr("-1")));
}

TEST(Trials, LeaveKeysOfTheFileThatNoneAsksForToTheFile) {
  const Document document = parsed("[perturbation]\nshared_typo = 1\n[[trial]]\nname = 'a'\n");
  const auto trials = document.trials().value();
  (void)read_experiment(trials[0].name, trials[0].document);
  EXPECT_EQ(problem(trials[0].document), "");
  EXPECT_THAT(problem(document), AllOf(HasSubstr("line 2"), HasSubstr("'shared_typo'")));
}

TEST(Trials, NeedNamesThatCanBePartsOfFileNames) {
  const auto said = [](std::string_view text) {
    const auto trials = parsed(text).trials();
    return trials ? "" : trials.error().line();
  };
  EXPECT_EQ(said("[[trial]]\nname = 'Az_09-'\n"), "");
  EXPECT_THAT(said("\n[[trial]]\nx = 1\n"), AllOf(HasSubstr("x.toml"), HasSubstr("line 2"), HasSubstr("name")));
  EXPECT_THAT(said("[[trial]]\nname = ''\n"), AllOf(HasSubstr("line 2"), HasSubstr("''")));
  EXPECT_THAT(said("[[trial]]\nname = '../a'\n"), AllOf(HasSubstr("line 2"), HasSubstr("'../a'")));
  EXPECT_THAT(said("[[trial]]\nname = 'é'\n"), AllOf(HasSubstr("line 2"), HasSubstr("'é'")));
  EXPECT_THAT(said("[[trial]]\nname = 1\n"), AllOf(HasSubstr("line 2"), HasSubstr("text")));
  EXPECT_THAT(said("[[trial]]\nname = 'a'\n[[trial]]\nname = 'a'\n"), AllOf(HasSubstr("line 4"), HasSubstr("'a'")));
  EXPECT_THAT(said("trial = 3\n"), HasSubstr("[[trial]]"));
}

TEST(Trials, AreUnknownToAReaderThatDoesNotAskForThem) {
  const Document document = parsed("[[trial]]\nname = 'a'\n");
  EXPECT_THAT(problem(document), HasSubstr("'trial'"));
}

// ---- what the parser refuses ----

TEST(ParseToml, NamesLineAndColumn) {
  EXPECT_THAT(refusal("a = 1\nb = = 2\n"), AllOf(HasSubstr("x.toml"), HasSubstr("line 2"), HasSubstr("column 5")));
  EXPECT_THAT(refusal("a = 1\na = 2\n"), HasSubstr("line 2"));
  EXPECT_THAT(refusal("a = 1é\n"), HasSubstr("line 1"));  // é, where white space may stand
  EXPECT_THAT(refusal("é = 1\n"), HasSubstr("line 1"));
  EXPECT_THAT(refusal("a = \"\xff\"\n"), AllOf(HasSubstr("line 1"), HasSubstr("not UTF-8 text")));
}

TEST(ParseToml, BoundsSizeAndDepth) {
  EXPECT_THAT(refusal(std::string(kLargestText + 1, '\n')), AllOf(HasSubstr("1000001 bytes"), HasSubstr("1000000")));
  const auto nested = [](int depth, char open, std::string_view close, std::string_view inner) {
    std::string text = "k = ";
    for (int i = 0; i < depth; ++i) text += open == '{' ? "{a=" : "[";
    text += inner;
    for (int i = 0; i < depth; ++i) text += close;
    return text;
  };
  EXPECT_TRUE(Document::parse(nested(32, '[', "]", ""), "x"));
  EXPECT_THAT(refusal(nested(33, '[', "]", "")), AllOf(HasSubstr("line 1"), HasSubstr("32")));
  EXPECT_THAT(refusal(nested(200'000, '[', "]", "")), AllOf(HasSubstr("line 1"), HasSubstr("32")));
  EXPECT_THAT(refusal(nested(200'000, '{', "}", "1")), AllOf(HasSubstr("line 1"), HasSubstr("32")));
  const auto dotted = [](int parts, std::string_view part) {
    std::string text = "\n\n";
    for (int i = 0; i < parts; ++i) text += (i > 0 ? "." : "") + std::string(part);
    return text;
  };
  EXPECT_TRUE(Document::parse(dotted(32, "a") + " = 1", "x"));
  EXPECT_THAT(refusal(dotted(33, "a") + " = 1"), AllOf(HasSubstr("line 3"), HasSubstr("32")));
  EXPECT_THAT(refusal(dotted(400'000, "a") + " = 1"), AllOf(HasSubstr("line 3"), HasSubstr("32")));
  EXPECT_THAT(refusal(dotted(100'000, "\"=,#\\\"\"") + " = 1"), AllOf(HasSubstr("line 3"), HasSubstr("32")));
  EXPECT_THAT(refusal("[" + dotted(100'000, "'='").substr(2) + "]"), AllOf(HasSubstr("key"), HasSubstr("32")));
}

TEST(ParseToml, DoesNotTakeTextsAndCommentsForNesting) {
  const std::string brackets(100, '[');
  const std::string dots(100, '.');
  const Document document =
      parsed("# " + brackets + dots + " \" '\na = '" + brackets + "'\nb = \"" + dots + "\\\"" + brackets +
             "\"\nc = \"\"\"\n\"\"" + brackets + "\\\n\"\"\"\"\"\nd = '''\n'" + dots + "'''''\ne = 1\nf = ''\n");
  const Section s = document.root();
  for (const char* key : {"a", "b", "c", "d", "f"}) (void)s.required_text(key);
  (void)s.required_integer("e", 1, 1);
  EXPECT_EQ(problem(document), "");
}

/// Asks for everything in every way, so that all of the code meets the damaged tree.
void ask_everything(const Section& s, int depth) {
  if (depth > 3) return;
  for (const char* key : {"kind", "amplitude_mm", "centres_mm", "K", "name", "rate_hz", "perturbation"}) {
    (void)s.number(key, 0.0, above(0));
    (void)s.integer(key, 0, -5, 5);
    (void)s.choice(key, {{"pulses", 1}}, 1);
    (void)s.numbers(key, {});
    (void)s.matrix2(key, Eigen::Matrix2d::Zero());
    ask_everything(s.section(key), depth + 1);
    for (const Section& each : s.sections(key)) ask_everything(each, depth + 1);
  }
}

TEST(Document, SurvivesDamagedTexts) {
  constexpr std::string_view kPieces[] = {"[",  "]",  "{",    "}",     "\"", "'",   "\"\"\"", "'''",  ".",     "=",
                                          ",",  "\n", "#",    "\\u",   "\\", "inf", "nan",    "0x",   "1e999", "[[a]]",
                                          "-0", "+_", "\xff", "\xc3(", "\r", "é",   "12:00",  "true", "\x01",  "[a.a]"};
  const std::string seed_text = std::string(kTrials) + "K = [[1.0, 2], [3, 4]]\nnote = \"\"\"a\nb\"\"\"\nt = {a = 1}\n";
  std::mt19937 random(20240601);
  int accepted = 0;
  for (int run = 0; run < 5000; ++run) {
    std::string text = seed_text;
    for (auto damage = random() % 4; damage < 4; ++damage) {
      const std::size_t at = random() % (text.size() + 1);
      switch (random() % 4) {
        case 0:
          text.insert(at, kPieces[random() % std::size(kPieces)]);
          break;
        case 1:
          text.erase(at, random() % 8);
          break;
        case 2:
          if (at < text.size()) text[at] = static_cast<char>(random());
          break;
        default:
          text.insert(at, text.substr(random() % text.size(), random() % 40));
      }
    }
    SCOPED_TRACE(text);
    const auto document = Document::parse(text, "x.toml");
    if (!document) {
      EXPECT_EQ(document.error().kind, ErrorKind::data);
      continue;
    }
    ++accepted;
    const auto trials = document->trials();
    if (trials) {
      for (const Trial& trial : *trials) ask_everything(trial.document.root(), 2);
    }
    ask_everything(document->root(), 2);
    if (const auto finished = document->finish(); !finished) {
      EXPECT_EQ(finished.error().line().find('\n'), std::string::npos);
    }
  }
  EXPECT_GT(accepted, 200);  // the damage is mild enough that both ends are met
  EXPECT_LT(accepted, 4800);
}

TEST(Document, RefusesFilesThatCannotBeRead) {
  for (const char* name : {"/nowhere/x.toml", "/tmp"}) {
    const auto document = Document::read(name);
    ASSERT_FALSE(document);
    EXPECT_THAT(document.error().line(), HasSubstr(name));
  }
}

TEST(Document, QuotesADamagedTextOnOneLine) {
  const auto document = Document::parse("a = 1\non = t\nue\n", "file.toml");
  ASSERT_FALSE(document);
  EXPECT_EQ(document.error().line().find('\n'), std::string::npos) << document.error().line();
}

TEST(Document, ATableLeftToOthersIsNotJudged) {
  const auto document = Document::parse("[mine]\nknown = 1\n[theirs]\nanything = 2\n[theirs.inner]\nmore = 3\n", "f");
  const Section root = document->root();
  EXPECT_EQ(root.section("mine").number("known", 0.0), 1.0);
  EXPECT_FALSE(document->finish());
  root.leave_to_others("theirs");
  EXPECT_TRUE(document->finish());
}

}  // namespace
}  // namespace mbk::config
