// Each slip's table shows what its text claims: the printed form violates the property, the right one meets it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "mbk/thesis/reproduce.h"
#include "mbk/thesis/source.h"

namespace mbk::thesis {
namespace slips_test {

constexpr double kExact = 1e-9;

Exhibit made(const std::string& id) {
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

TEST(Slips, SayWhereWhatAndWhatMoves) {
  std::set<std::string> ids;
  for (const ExhibitName& name : exhibit_names()) ids.insert(std::string(name.id));
  for (int k = 1; k <= 20; ++k) {
    const std::string id = "slip-" + std::to_string(k);
    ASSERT_TRUE(ids.contains(id));
    const Exhibit exhibit = made(id);
    EXPECT_EQ(exhibit.kind, Exhibit::Kind::slip);
    ASSERT_EQ(exhibit.text.size(), 5u) << id;
    for (std::size_t i = 0; const char* begin : {"Where: ", "Right: ", "What shows it: ", "What moves: ", "Tests: "}) {
      EXPECT_TRUE(exhibit.text[i++].starts_with(begin)) << id;
    }
    EXPECT_FALSE(exhibit.tables.empty()) << id;
    EXPECT_GE(exhibit.commands.size(), 2u) << id << ": one of its own beside that of the exhibit";
    for (const ReproducedTable& one : exhibit.tables) {
      for (const ReproducedRow& row : one.rows) EXPECT_EQ(row.cells.size(), one.columns.size()) << one.id;
    }
  }
}

TEST(Slips, ExcessIsTheIndexOfTheRationalMatrix) {
  const Exhibit exhibit = made("slip-1");
  const ReproducedTable& rows = table(exhibit, "slip-1");
  ASSERT_EQ(rows.rows.size(), 8u);
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    const double published = number(rows, i, 0), smallest = number(rows, i, 1);
    EXPECT_NEAR(number(rows, i, 2), smallest, kExact);
    EXPECT_NEAR(number(rows, i, 3), 2.0 * (smallest - published), kExact);
    EXPECT_GT(std::abs(published - smallest), 0.5);
  }
}

TEST(Slips, BoundaryOfTheTheoremIsNotPassive) {
  const Exhibit exhibit = made("slip-2");
  const ReproducedTable& rows = table(exhibit, "slip-2");
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(said(rows, i, 2), "passive");
    EXPECT_EQ(said(rows, i, 4), i < 3 ? "no" : "yes");
    EXPECT_EQ(number(rows, i, 3), i < 3 ? -1.0 : 1.0);
  }
}

TEST(Slips, PolesOfTheImpedanceAreNotWhatTheTheoremAsks) {
  const Exhibit exhibit = made("slip-3");
  const ReproducedTable& rows = table(exhibit, "slip-3");
  EXPECT_EQ(rows.title, "Z of P1: finite poles at 0; one at infinity");
  EXPECT_EQ(said(rows, 0, 3), "yes");
  for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(said(rows, i, 3), "no");
  EXPECT_GT(number(rows, 3, 1), 0.0) << "H alone calls −K passive";
}

TEST(Slips, AntisymmetryMakesTheArmActiveAtLowFrequencies) {
  const Exhibit exhibit = made("slip-4");
  const ReproducedTable& rows = table(exhibit, "slip-4");
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    EXPECT_NEAR(number(rows, i, 0), number(rows, i, 1), kExact);
    EXPECT_EQ(number(rows, i, 0) < 0.0, i < 2);
    EXPECT_GT(number(rows, i, 2), number(rows, i, 0));
  }
  EXPECT_NEAR(number(rows, 1, 0), -4.5, 0.05);
  EXPECT_EQ(exhibit.charts.at(0).series.size(), 2u);
}

TEST(Slips, PrintedHermitianPartIsNotHermitian) {
  const Exhibit exhibit = made("slip-5");
  EXPECT_GT(number(table(exhibit, "slip-5"), 0, 0), 1.0);
  EXPECT_NEAR(number(table(exhibit, "slip-5"), 1, 0), 0.0, kExact);
  EXPECT_LT(number(table(exhibit, "slip-5 lemma"), 0, 0), 0.0);
}

TEST(Slips, EveryLargerShortageHoldsToo) {
  const Exhibit exhibit = made("slip-5");
  const ReproducedTable& rows = table(exhibit, "slip-5 shortage");
  EXPECT_EQ(said(rows, 0, 1), "no");
  for (std::size_t i = 1; i < rows.rows.size(); ++i) EXPECT_EQ(said(rows, i, 1), "yes");
  EXPECT_NEAR(number(rows, 1, 0), 0.0, kExact);
}

TEST(Slips, OrientationIsThatOfTheAxis) {
  const Exhibit exhibit = made("slip-6");
  const ReproducedTable& rows = table(exhibit, "slip-6");
  EXPECT_NEAR(number(rows, 0, 1), 107.3, 0.05);
  EXPECT_NEAR(number(rows, 0, 0), 107.3 - 180.0, 0.05);
  EXPECT_EQ(said(rows, 1, 0), "0/0");
  EXPECT_NEAR(number(rows, 1, 1), 0.0, kExact);
  EXPECT_NEAR(number(table(exhibit, "slip-6 all"), 0, 2), 0.0, kExact);
}

TEST(Slips, SchaferIsNearerToTheWeights) {
  const Exhibit exhibit = made("slip-7");
  const ReproducedTable& rows = table(exhibit, "slip-7");
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    EXPECT_LT(std::abs(number(rows, i, 1) - number(rows, i, 2)), std::abs(number(rows, i, 0) - number(rows, i, 2)));
  }
  const ReproducedTable& twice = table(exhibit, "slip-7 low-pass");
  EXPECT_NEAR(number(twice, 3, 1), 0.5, kExact);
  EXPECT_NEAR(number(twice, 3, 0), std::sqrt(0.5), kExact);
}

TEST(Slips, JacobianIsThatOfTheKinematics) {
  const Exhibit exhibit = made("slip-8");
  const ReproducedTable& rows = table(exhibit, "slip-8");
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(number(rows, i, 0), number(rows, i, 1), kExact);
    EXPECT_GT(std::abs(number(rows, i, 2) - number(rows, i, 1)), 0.01);
  }
  EXPECT_NEAR(number(rows, 0, 1) + number(rows, 1, 1), number(rows, 0, 2), kExact) << "a sum of columns";
  EXPECT_NEAR(number(rows, 4, 0), number(rows, 4, 1), kExact);
}

TEST(Slips, CoriolisMatrixMakesInertiaRateSkew) {
  const Exhibit exhibit = made("slip-9");
  const ReproducedTable& rows = table(exhibit, "slip-9");
  EXPECT_GT(std::abs(number(rows, 0, 1)), 0.01);
  EXPECT_GT(std::abs(number(rows, 0, 3)), 0.01);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(number(rows, 1, k), 0.0, kExact);
  const ReproducedTable& payload = table(exhibit, "slip-9 payload");
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(number(payload, i, 0), number(payload, i, 1), kExact);
}

TEST(Slips, StiffnessIsMinusTheGradient) {
  const Exhibit exhibit = made("slip-10");
  constexpr double kDifferences = 1e-6;  // relative, of central differences by a micrometre
  for (const char* id : {"slip-10", "slip-10 arm"}) {
    const ReproducedTable& rows = table(exhibit, id);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(number(rows, i, 1) / number(rows, i, 0), 1.0, kDifferences);
      EXPECT_GT(std::abs(number(rows, i, 2) - number(rows, i, 0)), 10.0);
    }
  }
  const ReproducedTable& arm = table(exhibit, "slip-10 arm");
  EXPECT_EQ(number(arm, 1, 2), number(arm, 2, 2)) << "the printed entries hide the antisymmetry";
  EXPECT_NEAR(number(arm, 1, 0) - number(arm, 2, 0), 2.0 * 7.72, 0.02);
}

TEST(Slips, ImmittanceFormHidesAShortage) {
  const Exhibit exhibit = made("slip-11");
  EXPECT_EQ(said(table(exhibit, "slip-11"), 0, 3), "stable");
  EXPECT_EQ(said(table(exhibit, "slip-11"), 1, 3), "not stable");
  EXPECT_EQ(said(table(exhibit, "slip-11 bound"), 0, 2), "no");
  EXPECT_NEAR(number(table(exhibit, "slip-11 allowed"), 0, 0), number(table(exhibit, "slip-11 allowed"), 0, 1), kExact);
}

TEST(Slips, ErrorsAreTheoreticalLessIdentified) {
  const Exhibit exhibit = made("slip-12");
  const ReproducedTable& rows = table(exhibit, "slip-12");
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    const std::string all = i < 2 ? "10" : "5";
    EXPECT_EQ(said(rows, i, 0), "0 of " + all);
    EXPECT_EQ(said(rows, i, 1), all + " of " + all);
  }
}

TEST(Slips, ProgramLosesACentreAtEachEnd) {
  const Exhibit exhibit = made("slip-13");
  const ReproducedTable& rows = table(exhibit, "slip-13");
  EXPECT_EQ(number(rows, 0, 0) - number(rows, 0, 1), 2.0);
  EXPECT_EQ(number(rows, 1, 1) - number(rows, 1, 0), 1.0);
}

TEST(Slips, FilteringBeforeTheCutSmears) {
  const Exhibit exhibit = made("slip-13");
  const ReproducedTable& rows = table(exhibit, "slip-13 pulses");
  EXPECT_GT(number(rows, 1, 3), 1e-5);
  EXPECT_LT(number(rows, 2, 3), 0.1 * number(rows, 1, 3));
}

TEST(Slips, VafDoesNotSeeAnOffset) {
  const Exhibit exhibit = made("slip-14");
  const ReproducedTable& rows = table(exhibit, "slip-14");
  EXPECT_NEAR(number(rows, 1, 0), 100.0, kExact);
  EXPECT_NEAR(number(rows, 1, 1), 10.0, kExact);
  EXPECT_NEAR(number(rows, 2, 0), 99.0, kExact);
  EXPECT_LT(number(rows, 3, 0), 0.0);
}

TEST(Slips, LeverArmScalesTheSlopeAlone) {
  const Exhibit exhibit = made("slip-15");
  const ReproducedTable& rows = table(exhibit, "slip-15");
  const ReproducedTable& gauge = table(exhibit, "slip-15 gauge");
  for (std::size_t i = 0; const double force : {0.0, 5.0, -5.0}) {
    EXPECT_NEAR(number(rows, i, 1), force, kExact);
    EXPECT_NEAR(number(rows, i, 2), force, kExact);
    EXPECT_GT(std::abs(number(rows, i, 3) - force), 0.05);
    EXPECT_GT(std::abs(number(rows, i, 4) - force), 0.05);
    EXPECT_NEAR(number(gauge, i++, 0), force, kExact);
  }
}

TEST(Slips, ConverterIsCoarserThanTheNoise) {
  const Exhibit exhibit = made("slip-15");
  const ReproducedTable& rows = table(exhibit, "slip-15 converter");
  EXPECT_GT(number(rows, 1, 0), 4.0 * 0.01);
  EXPECT_NEAR(number(rows, 3, 0) / number(rows, 2, 0), 1.0, 0.01);
}

TEST(Slips, InvertedAdmittanceIsTheImpedanceAndTheProperOneIsNot) {
  const Exhibit exhibit = made("slip-16");
  const ReproducedTable& numbers = table(exhibit, "slip-16");
  constexpr double kNoise = 0.01;  // relative: 0.02 N of noise on some newtons
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(number(numbers, 1, k) / number(numbers, 0, k), 1.0, kNoise);
  const ReproducedTable& size = table(exhibit, "slip-16 size");
  for (std::size_t i = 0; i < size.rows.size(); ++i) {
    EXPECT_NEAR(number(size, i, 1) / number(size, i, 0), 1.0, kNoise);
  }
  const std::size_t last = size.rows.size() - 1;
  EXPECT_LT(number(size, last, 2), 0.01 * number(size, last, 0));
}

TEST(Slips, NetworksMeetTheTheoremAndAreNotStable) {
  const Exhibit exhibit = made("slip-17");
  const ReproducedTable& rows = table(exhibit, "slip-17");
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) EXPECT_GE(number(rows, i, k), 0.0) << rows.rows[i].name;
    EXPECT_EQ(said(rows, i, 3), "no");
    EXPECT_NE(said(rows, i, 4), "none");
  }
}

TEST(Slips, PrintedSignsTurnEnergyAndForce) {
  const Exhibit exhibit = made("slip-18");
  const ReproducedTable& energy = table(exhibit, "slip-18");
  EXPECT_LT(number(energy, 0, 0), 0.0);
  EXPECT_NEAR(number(energy, 0, 1), number(energy, 0, 2), kExact);
  const ReproducedTable& force = table(exhibit, "slip-18 robot");
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(number(force, i, 1), number(force, i, 0), kExact);
    EXPECT_NEAR(number(force, i, 2), -number(force, i, 0), kExact);
  }
}

TEST(Slips, RelativeDiscrepancyIsLargestForTheOffDiagonal) {
  const Exhibit exhibit = made("slip-19");
  const ReproducedTable& rows = table(exhibit, "slip-19");
  for (const std::size_t other : {1u, 2u, 3u}) EXPECT_GT(number(rows, 0, 0), number(rows, other, 0));
  for (const std::size_t other : {0u, 1u, 3u}) {
    EXPECT_GT(number(rows, 2, 1), number(rows, other, 1));
    EXPECT_GT(number(rows, 2, 2), number(rows, other, 2));
  }
}

TEST(Slips, FortyDegreesAreAPartOfTheWorkspace) {
  const Exhibit exhibit = made("slip-20");
  const ReproducedTable& rows = table(exhibit, "slip-20");
  EXPECT_LT(number(rows, 1, 1), 25.0);
  EXPECT_NEAR(number(rows, 2, 1), 50.0, kExact);
}

}  // namespace slips_test
}  // namespace mbk::thesis
