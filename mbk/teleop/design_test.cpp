#include "mbk/teleop/design.h"

#include <gmock/gmock.h>

#include "mbk/teleop/judge.h"

namespace mbk::teleop {
namespace {

using testing::HasSubstr;

std::string line_of(std::string_view text) {
  const auto design = parse_design(text, "design.toml");
  return design ? "" : design.error().line();
}

TEST(ReadDesign, ReadsEveryExample) {
  int read = 0;
  for (const auto& file : std::filesystem::directory_iterator(MBK_EXAMPLE_DESIGNS)) {
    const auto design = read_design(file.path());
    EXPECT_TRUE(design) << design.error().line();
    ++read;
  }
  EXPECT_GE(read, 5);
}

TEST(ParseDesign, NamesTheMalformedEntry) {
  const std::string start = "[two_port]\nform = \"z\"\nz11 = {numerator = [1]}\nz22 = {numerator = [1]}\n";
  EXPECT_EQ(line_of(start + "z12 = {numerator = [0]}\nz21 = {numerator = [0]}\n"), "");
  EXPECT_THAT(line_of(start + "z21 = {numerator = [0]}\n"), HasSubstr("two_port.z12"));
  EXPECT_THAT(line_of(start + "z12 = {numerator = [1], denominator = [0, 0]}\nz21 = {numerator = [0]}\n"),
              HasSubstr("two_port.z12.denominator"));
  EXPECT_THAT(line_of(start + "z12 = {numerator = []}\nz21 = {numerator = [0]}\n"),
              HasSubstr("two_port.z12.numerator"));
  EXPECT_THAT(line_of(start + "z12 = {numerator = [1, \"s\"]}\nz21 = {numerator = [0]}\n"),
              HasSubstr("two_port.z12.numerator"));
  EXPECT_THAT(line_of(start + "z12 = {numerator = [nan]}\nz21 = {numerator = [0]}\n"),
              HasSubstr("two_port.z12.numerator"));
  EXPECT_THAT(line_of(start + "z12 = {numerator = [0]}\nz21 = {numerator = [0]}\nh11 = {numerator = [0]}\n"),
              HasSubstr("h11"));
}

TEST(ParseDesign, TakesADecimalForTheFractionThatItIs) {
  const auto design = parse_design(
      "[two_port]\nform = \"z\"\nz11 = {numerator = [0.1]}\nz12 = {numerator = [0]}\nz21 = {numerator = [0]}\n"
      "z22 = {numerator = [0]}\n",
      "design.toml");
  ASSERT_TRUE(design) << design.error().line();
  EXPECT_EQ(std::get<TwoPort>(design->network).matrix(0, 0).numerator(), Polynomial({Rational(1, 10)}));
}

TEST(ParseDesign, AsksForWhatAnArchitectureNeedsAndNothingElse) {
  const std::string robots =
      "[master]\nmass_kg = 1\ndamping_N_s_per_m = 1\n[slave]\nmass_kg = 1\ndamping_N_s_per_m = 1\n"
      "controller_damping_N_s_per_m = 1\ncontroller_stiffness_N_per_m = 1\n";
  EXPECT_THAT(line_of("[architecture]\nkind = \"position-position\"\n" + robots),
              AllOf(HasSubstr("[master]"), HasSubstr("'controller_damping_N_s_per_m'")));
  EXPECT_THAT(line_of("[architecture]\nkind = \"position-force\"\n" + robots),
              AllOf(HasSubstr("[channels]"), HasSubstr("'force_to_master'")));
  const std::string force = "[channels]\nforce_to_master = 1\n";
  EXPECT_EQ(line_of("[architecture]\nkind = \"position-force\"\n" + robots + force), "");
  EXPECT_THAT(line_of("[architecture]\nkind = \"position-force\"\n" + robots + force + "force_to_slave = 1\n"),
              HasSubstr("force_to_slave"));
  EXPECT_THAT(line_of("[architecture]\nkind = \"wave\"\n" + robots), HasSubstr("wave"));
}

TEST(ParseDesign, RefusesNumbersWhoseExactAnswerTakesForEver) {
  const auto with = [](const std::string& k, const std::string& delay) {
    return "[architecture]\nkind = \"position-position\"\n[master]\nmass_kg = 1\ndamping_N_s_per_m = 1\n"
           "controller_damping_N_s_per_m = 1\ncontroller_stiffness_N_per_m = 1\n[slave]\nmass_kg = 1\n"
           "damping_N_s_per_m = 1\ncontroller_damping_N_s_per_m = 1\ncontroller_stiffness_N_per_m = " +
           k + "\n[delay]\nto_slave_ms = " + delay + "\n";
  };
  EXPECT_EQ(line_of(with("1e12", "0.001")), "");
  EXPECT_EQ(line_of(with("0", "0")), "");
  EXPECT_THAT(line_of(with("1", "1e-320")), HasSubstr("delay.to_slave_ms"));
  EXPECT_THAT(line_of(with("1", "1e-320")), HasSubstr("1e-06 s"));
  EXPECT_THAT(line_of(with("1e300", "1")), AllOf(HasSubstr("1e+300"), HasSubstr("1e+12")));
  EXPECT_THAT(line_of(with("-1e-300", "1")), HasSubstr("slave.controller_stiffness_N_per_m"));
  const std::string start = "[two_port]\nform = \"z\"\nz11 = {numerator = [1]}\nz22 = {numerator = [1]}\n";
  EXPECT_THAT(line_of(start + "z12 = {numerator = [1e300]}\nz21 = {numerator = [0]}\n"),
              HasSubstr("two_port.z12.numerator"));
  EXPECT_THAT(line_of(start + "z12 = {numerator = [0]}\nz21 = {numerator = [0]}\n[operator]\nport = 1\n"
                              "shortage_N_s_per_m = 1e-320\n"),
              HasSubstr("operator.shortage_N_s_per_m"));
}

TEST(ParseSweep, TakesANameAndARange) {
  const auto sweep = parse_sweep("slave.k=-0.5:1e3");
  ASSERT_TRUE(sweep);
  EXPECT_EQ(sweep->parameter, "slave.k");
  EXPECT_EQ(sweep->low, Rational(-1, 2));
  EXPECT_EQ(sweep->high, 1000);
  for (const char* wrong :
       {"", "slave.k", "slave.k=1", "=1:2", "slave.k=2:1", "slave.k=1:1", "slave.k=a:2", "slave.k=1:nan",
        "slave.k=1:2x", "slave.k=:", "slave.k=0:inf", "slave.k=0:1e300", "slave.k=1e-320:1"}) {
    const auto refused = parse_sweep(wrong);
    ASSERT_FALSE(refused) << wrong;
    EXPECT_EQ(refused.error().kind, ErrorKind::usage);
  }
}

}  // namespace
}  // namespace mbk::teleop
