// Each erratum's table shows what its text claims: the printed form violates the property, the right one meets it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "thesis/reproduce.h"
#include "thesis/source.h"

namespace mbk::thesis {
namespace {

constexpr double kExact = 1e-9;

Exhibit erratum_made(const std::string& id) {
  const auto source = read_source(source_text());
  EXPECT_TRUE(source) << source.error().line();
  ReproduceOptions options;
  options.only = {id};
  options.threads = 2;
  const auto reproduction = reproduce(*source, options);
  EXPECT_TRUE(reproduction) << reproduction.error().line();
  return reproduction->exhibits.at(0);
}

const ReproducedTable& table(const Exhibit& exhibit, const std::string& id) {
  return *std::ranges::find(exhibit.tables, id, &ReproducedTable::id);
}

double number(const ReproducedTable& table, std::size_t row, std::size_t column) {
  return table.rows.at(row).cells.at(column).ours.value();
}

const std::string& said(const ReproducedTable& table, std::size_t row, std::size_t column) {
  return table.rows.at(row).cells.at(column).words;
}

TEST(Errata, SayWhereWhatIsCorrectAndItsEffect) {
  std::set<std::string> ids;
  for (const ExhibitName& name : exhibit_names()) ids.insert(std::string(name.id));
  const std::set<int> withdrawn = {15, 16, 19};
  for (int k = 1; k <= 20; ++k) {
    const std::string number = "erratum-" + std::to_string(k);
    EXPECT_EQ(ids.contains(number), !withdrawn.contains(k)) << number;
    const std::string id = withdrawn.contains(k) ? "withdrawn-errata" : number;
    const Exhibit exhibit = erratum_made(id);
    EXPECT_EQ(exhibit.kind, Exhibit::Kind::erratum);
    ASSERT_EQ(exhibit.text.size(), 5u) << id;
    for (std::size_t i = 0; const char* begin : {"Where: ", "Correct: ", "Evidence: ", "Effect: ", "Tests: "}) {
      EXPECT_TRUE(exhibit.text[i++].starts_with(begin)) << id;
    }
    EXPECT_FALSE(exhibit.tables.empty()) << id;
    EXPECT_GE(exhibit.commands.size(), 2u) << id << ": one of its own beside that of the exhibit";
    for (const ReproducedTable& one : exhibit.tables) {
      for (const ReproducedRow& row : one.rows) EXPECT_EQ(row.cells.size(), one.columns.size()) << one.id;
    }
  }
}

TEST(Errata, ExcessIsTheIndexOfTheRationalMatrix) {
  const Exhibit exhibit = erratum_made("erratum-1");
  const ReproducedTable& rows = table(exhibit, "erratum-1");
  ASSERT_EQ(rows.rows.size(), 8u);
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    const double published = number(rows, i, 0), smallest = number(rows, i, 1);
    EXPECT_NEAR(number(rows, i, 2), smallest, kExact);
    EXPECT_NEAR(number(rows, i, 3), 2.0 * (smallest - published), kExact);
    EXPECT_GT(std::abs(published - smallest), 0.5);
  }
}

TEST(Errata, BoundaryOfTheTheoremIsNotPassive) {
  const Exhibit exhibit = erratum_made("erratum-2");
  const ReproducedTable& rows = table(exhibit, "erratum-2");
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(said(rows, i, 2), "passive");
    EXPECT_EQ(said(rows, i, 4), i < 3 ? "no" : "yes");
    EXPECT_EQ(number(rows, i, 3), i < 3 ? -1.0 : 1.0);
  }
}

TEST(Errata, PolesOfTheImpedanceAreNotWhatTheTheoremAsks) {
  const Exhibit exhibit = erratum_made("erratum-3");
  const ReproducedTable& rows = table(exhibit, "erratum-3");
  for (const char* const fact : {"P1", " 0", "infinity"})
    EXPECT_NE(rows.title.find(fact), std::string::npos) << rows.title;
  EXPECT_EQ(said(rows, 0, 3), "yes");
  for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(said(rows, i, 3), "no");
  EXPECT_GT(number(rows, 3, 1), 0.0) << "H alone calls −K passive";
}

TEST(Errata, AntisymmetryMakesTheArmActiveAtLowFrequencies) {
  const Exhibit exhibit = erratum_made("erratum-4");
  const ReproducedTable& rows = table(exhibit, "erratum-4");
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    EXPECT_NEAR(number(rows, i, 0), number(rows, i, 1), kExact);
    EXPECT_EQ(number(rows, i, 0) < 0.0, i < 2);
    EXPECT_GT(number(rows, i, 2), number(rows, i, 0));
  }
  EXPECT_NEAR(number(rows, 1, 0), -4.5, 0.05);
  EXPECT_EQ(exhibit.charts.at(0).series.size(), 2u);
}

TEST(Errata, PrintedHermitianPartIsNotHermitian) {
  const Exhibit exhibit = erratum_made("erratum-5");
  EXPECT_GT(number(table(exhibit, "erratum-5"), 0, 0), 1.0);
  EXPECT_NEAR(number(table(exhibit, "erratum-5"), 1, 0), 0.0, kExact);
  EXPECT_LT(number(table(exhibit, "erratum-5 lemma"), 0, 0), 0.0);
}

TEST(Errata, EveryLargerShortageHoldsToo) {
  const Exhibit exhibit = erratum_made("erratum-5");
  const ReproducedTable& rows = table(exhibit, "erratum-5 shortage");
  EXPECT_EQ(said(rows, 0, 1), "no");
  for (std::size_t i = 1; i < rows.rows.size(); ++i) EXPECT_EQ(said(rows, i, 1), "yes");
  EXPECT_NEAR(number(rows, 1, 0), 0.0, kExact);
}

TEST(Errata, OrientationIsThatOfTheAxis) {
  const Exhibit exhibit = erratum_made("erratum-6");
  const ReproducedTable& rows = table(exhibit, "erratum-6");
  EXPECT_NEAR(number(rows, 0, 1), 107.3, 0.05);
  EXPECT_NEAR(number(rows, 0, 0), 107.3 - 180.0, 0.05);
  EXPECT_EQ(said(rows, 1, 0), "0/0");
  EXPECT_NEAR(number(rows, 1, 1), 0.0, kExact);
  EXPECT_NEAR(number(table(exhibit, "erratum-6 all"), 0, 2), 0.0, kExact);
}

TEST(Errata, SchaferIsNearerToTheWeights) {
  const Exhibit exhibit = erratum_made("erratum-7");
  const ReproducedTable& rows = table(exhibit, "erratum-7");
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    EXPECT_LT(std::abs(number(rows, i, 1) - number(rows, i, 2)), std::abs(number(rows, i, 0) - number(rows, i, 2)));
  }
  const ReproducedTable& twice = table(exhibit, "erratum-7 low-pass");
  EXPECT_NEAR(number(twice, 3, 1), 0.5, kExact);
  EXPECT_NEAR(number(twice, 3, 0), std::sqrt(0.5), kExact);
}

TEST(Errata, JacobianIsThatOfTheKinematics) {
  const Exhibit exhibit = erratum_made("erratum-8");
  const ReproducedTable& rows = table(exhibit, "erratum-8");
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(number(rows, i, 0), number(rows, i, 1), kExact);
    EXPECT_GT(std::abs(number(rows, i, 2) - number(rows, i, 1)), 0.01);
  }
  EXPECT_NEAR(number(rows, 0, 1) + number(rows, 1, 1), number(rows, 0, 2), kExact) << "a sum of columns";
  EXPECT_NEAR(number(rows, 4, 0), number(rows, 4, 1), kExact);
}

TEST(Errata, CoriolisMatrixMakesInertiaRateSkew) {
  const Exhibit exhibit = erratum_made("erratum-9");
  const ReproducedTable& rows = table(exhibit, "erratum-9");
  EXPECT_GT(std::abs(number(rows, 0, 1)), 0.01);
  EXPECT_GT(std::abs(number(rows, 0, 3)), 0.01);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(number(rows, 1, k), 0.0, kExact);
  const ReproducedTable& payload = table(exhibit, "erratum-9 payload");
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(number(payload, i, 0), number(payload, i, 1), kExact);
}

TEST(Errata, StiffnessIsMinusTheGradient) {
  const Exhibit exhibit = erratum_made("erratum-10");
  constexpr double kDifferences = 1e-6;  // relative, of central differences by a micrometre
  for (const char* id : {"erratum-10", "erratum-10 arm"}) {
    const ReproducedTable& rows = table(exhibit, id);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(number(rows, i, 1) / number(rows, i, 0), 1.0, kDifferences);
      EXPECT_GT(std::abs(number(rows, i, 2) - number(rows, i, 0)), 10.0);
    }
  }
  const ReproducedTable& arm = table(exhibit, "erratum-10 arm");
  EXPECT_EQ(number(arm, 1, 2), number(arm, 2, 2)) << "the printed entries hide the antisymmetry";
  EXPECT_NEAR(number(arm, 1, 0) - number(arm, 2, 0), 2.0 * 7.72, 0.02);
}

TEST(Errata, ImmittanceFormHidesAShortage) {
  const Exhibit exhibit = erratum_made("erratum-11");
  EXPECT_EQ(said(table(exhibit, "erratum-11"), 0, 3), "stable");
  EXPECT_EQ(said(table(exhibit, "erratum-11"), 1, 3), "not stable");
  EXPECT_EQ(said(table(exhibit, "erratum-11 bound"), 0, 2), "no");
  EXPECT_NEAR(number(table(exhibit, "erratum-11 allowed"), 0, 0), number(table(exhibit, "erratum-11 allowed"), 0, 1),
              kExact);
}

TEST(Errata, ErrorsAreTheoreticalLessIdentified) {
  const Exhibit exhibit = erratum_made("erratum-12");
  const ReproducedTable& rows = table(exhibit, "erratum-12");
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    const std::string all = i < 2 ? "10" : "5";
    EXPECT_EQ(said(rows, i, 0), "0 of " + all);
    EXPECT_EQ(said(rows, i, 1), all + " of " + all);
  }
}

TEST(Errata, ProgramLosesACentreAtEachEnd) {
  const Exhibit exhibit = erratum_made("erratum-13");
  const ReproducedTable& rows = table(exhibit, "erratum-13");
  EXPECT_EQ(number(rows, 0, 0) - number(rows, 0, 1), 2.0);
  EXPECT_EQ(number(rows, 1, 1) - number(rows, 1, 0), 1.0);
}

TEST(Errata, FilteringBeforeTheCutSmears) {
  const Exhibit exhibit = erratum_made("erratum-13");
  const ReproducedTable& rows = table(exhibit, "erratum-13 pulses");
  EXPECT_GT(number(rows, 1, 3), 1e-5);
  EXPECT_LT(number(rows, 2, 3), 0.1 * number(rows, 1, 3));
}

TEST(Errata, VafDoesNotSeeAnOffset) {
  const Exhibit exhibit = erratum_made("erratum-14");
  const ReproducedTable& rows = table(exhibit, "erratum-14");
  EXPECT_NEAR(number(rows, 1, 0), 100.0, kExact);
  EXPECT_NEAR(number(rows, 1, 1), 10.0, kExact);
  EXPECT_NEAR(number(rows, 2, 0), 99.0, kExact);
  EXPECT_LT(number(rows, 3, 0), 0.0);
}

TEST(Errata, NetworksMeetTheTheoremAndAreNotStable) {
  const Exhibit exhibit = erratum_made("erratum-17");
  const ReproducedTable& rows = table(exhibit, "erratum-17");
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_GE(number(rows, i, k), 0.0) << rows.rows[i].name;
    EXPECT_EQ(said(rows, i, 3), "no");
    EXPECT_NE(said(rows, i, 4), "none");
  }
}

TEST(Errata, PrintedSignsTurnEnergyAndForce) {
  const Exhibit exhibit = erratum_made("erratum-18");
  const ReproducedTable& energy = table(exhibit, "erratum-18");
  EXPECT_LT(number(energy, 0, 0), 0.0);
  EXPECT_NEAR(number(energy, 0, 1), number(energy, 0, 2), kExact);
  const ReproducedTable& force = table(exhibit, "erratum-18 robot");
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(number(force, i, 1), number(force, i, 0), kExact);
    EXPECT_NEAR(number(force, i, 2), -number(force, i, 0), kExact);
  }
}

TEST(Errata, FortyDegreesAreAPartOfTheWorkspace) {
  const Exhibit exhibit = erratum_made("erratum-20");
  const ReproducedTable& rows = table(exhibit, "erratum-20");
  EXPECT_LT(number(rows, 1, 1), 25.0);
  EXPECT_NEAR(number(rows, 2, 1), 50.0, kExact);
}

// What these show was once charged to the source. While they hold, it may not be charged again.

// (E.3) scales slope and intercept alike: exact at any lever arm where no force reads zero, and off by a constant where
// it does not.
TEST(WithdrawnErrata, ScaledForceIsExactWhereNoForceReadsZero) {
  const Exhibit exhibit = erratum_made("withdrawn-errata");
  const ReproducedTable& rows = table(exhibit, "withdrawn-errata 15");
  for (std::size_t i = 0; const double force : {0.0, 5.0, -5.0}) EXPECT_NEAR(number(rows, i++, 1), force, kExact);
}

TEST(WithdrawnErrata, ConverterRoundsToThePrintedNoise) {
  const Exhibit exhibit = erratum_made("withdrawn-errata");
  const ReproducedTable& rows = table(exhibit, "withdrawn-errata 15 noise");
  EXPECT_NEAR(number(rows, 0, 0), 0.0418, 5e-5);
  EXPECT_NEAR(number(rows, 1, 0), 0.0418 / std::sqrt(12.0), 5e-5);
  EXPECT_EQ(std::round(100.0 * number(rows, 1, 0)) / 100.0, number(rows, 2, 0));
  EXPECT_EQ(said(rows, 3, 0), "yes");
}

TEST(WithdrawnErrata, FourPolesAndThreeZerosFollowAnImpedance) {
  const Exhibit exhibit = erratum_made("withdrawn-errata");
  const ReproducedTable& rows = table(exhibit, "withdrawn-errata 16");
  EXPECT_NEAR(number(rows, 0, 0), 6.0 * std::pow(10.0 / 1e3, 2), 1e-5) << "6 |s/p|² at 10 Hz, by expansion";
  EXPECT_LT(number(rows, 0, 0), 1e-3);
  EXPECT_LT(number(rows, 2, 0), 3e-9);
}

TEST(WithdrawnErrata, RelativeDiscrepancyIsLargestForKxx) {
  const Exhibit exhibit = erratum_made("withdrawn-errata");
  const ReproducedTable& rows = table(exhibit, "withdrawn-errata 19");
  constexpr std::size_t kMin = 0, kLargest = 1, kRelative = 3;
  for (const std::size_t other : {1u, 2u}) EXPECT_GT(number(rows, 0, kRelative), number(rows, other, kRelative));
  for (const std::size_t row : {0u, 1u, 2u}) EXPECT_GT(number(rows, row, kMin), 0.0);
  EXPECT_LT(number(rows, 3, kMin), 0.0) << "k_s crosses zero";
  EXPECT_GT(number(rows, 3, kLargest), 0.0) << "k_s crosses zero";
}

}  // namespace
}  // namespace mbk::thesis
