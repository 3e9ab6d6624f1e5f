#include "mbk/measure/analyse/summarise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace mbk::analyse {
namespace {

Identification trial(double m, double b, double k, double x0) {
  Identification id;
  id.axes = 1;
  id.model = {Matrix::Constant(1, 1, m), Matrix::Constant(1, 1, b), Matrix::Constant(1, 1, k), Vector::Constant(1, x0)};
  return id;
}

TEST(Summarise, IsTheMeanAndTheDeviationOverTheRootOfTheCount) {
  const Summary summary =
      summarise({trial(1.0, 5.0, 100.0, 0.1), trial(2.0, 5.0, 110.0, 0.1), trial(4.5, 5.0, 150.0, 0.4)}).value();
  EXPECT_EQ(summary.trials, 3);
  EXPECT_DOUBLE_EQ(summary.mean.M(0, 0), 2.5);
  EXPECT_DOUBLE_EQ(summary.mean.K(0, 0), 120.0);
  EXPECT_DOUBLE_EQ(summary.mean.x0[0], 0.2);
  // (2.25 + 0.25 + 4)/2 = 3.25;  (400 + 100 + 900)/2 = 700;  (0.01 + 0.01 + 0.04)/2 = 0.03
  EXPECT_DOUBLE_EQ(summary.between_trial_standard_error.M(0, 0), std::sqrt(3.25 / 3.0));
  EXPECT_DOUBLE_EQ(summary.between_trial_standard_error.K(0, 0), std::sqrt(700.0 / 3.0));
  EXPECT_NEAR(summary.between_trial_standard_error.x0[0], 0.1, 1e-15);
  EXPECT_LE(summary.between_trial_standard_error.B(0, 0), 1e-15);
}

TEST(Summarise, TheIntervalOfTheMeanIsStudents) {
  const Summary summary = summarise({trial(1.0, 5.0, 100.0, 0.1), trial(2.0, 5.0, 110.0, 0.1)}).value();
  EXPECT_NEAR(summary.half_width95.K(0, 0), 12.7062047 * 5.0, 1e-5);  // one degree of freedom
}

Identification from_file(const char* file, const char* hash, double k = 100.0) {
  Identification id = trial(1.0, 5.0, k, 0.1);
  id.sources = {{file, "CSV", hash}};
  return id;
}

TEST(Summarise, LeavesOutWhatIsNotUsableAndWhatIsThereTwice) {
  Identification bad = from_file("bad.csv", "3", 900.0);
  bad.usable = false;
  const Summary summary = summarise({from_file("a.csv", "1"), bad, from_file("b.csv", "2", 110.0),
                                     from_file("twin.csv", "1"), from_file("c.csv", "", 120.0)})
                              .value();
  EXPECT_EQ(summary.trials, 3);
  EXPECT_DOUBLE_EQ(summary.mean.K(0, 0), 110.0);
  ASSERT_EQ(summary.omitted.size(), 2u);
  EXPECT_EQ(summary.omitted[0].file, "bad.csv");
  EXPECT_EQ(summary.omitted[0].why, "not usable");
  EXPECT_EQ(summary.omitted[1].file, "twin.csv");
  EXPECT_NE(summary.omitted[1].why.find("a.csv"), std::string::npos) << summary.omitted[1].why;
  EXPECT_FALSE(summarise({from_file("a.csv", "1"), bad}));
  EXPECT_FALSE(summarise({from_file("a.csv", "1"), from_file("twin.csv", "1")}));
}

TEST(Summarise, RefusesWhatDoesNotBelongTogetherAndNamesIt) {
  const auto differ = [](auto change) {
    Identification first = from_file("a.csv", "1"), second = from_file("b.csv", "2");
    for (Identification* one : {&first, &second}) {
      one->preparations.emplace_back();
      one->conditions.push_back({"7", "relaxed", "1"});
    }
    change(second);
    const auto mean = summarise({first, second});
    return mean ? std::string() : mean.error().message;
  };
  EXPECT_EQ(differ([](Identification&) {}), "");
  EXPECT_EQ(differ([](Identification& id) { id.conditions[0] = {}; }), "");  // it does not say
  for (const auto& [change, name] : std::vector<std::pair<void (*)(Identification&), const char*>>{
           {[](Identification& id) { id.conditions[0].condition = "rigid"; }, "condition"},
           {[](Identification& id) { id.conditions[0].participant = "8"; }, "participant"},
           {[](Identification& id) { id.conditions[0].posture = "2"; }, "posture"},
           {[](Identification& id) { id.preparations[0].protocol = Protocol::underdamped; }, "protocol"},
           {[](Identification& id) { id.preparations[0].mode = Mode::reference; }, "mode"},
           {[](Identification& id) { id.method = Method::instrumental_variables; }, "method"},
           {[](Identification& id) { id.handle_mass = 0.2; }, "handle mass"}}) {
    const std::string message = differ(change);
    EXPECT_NE(message.find(name), std::string::npos) << name << ": " << message;
    EXPECT_NE(message.find("b.csv"), std::string::npos);
  }
}

TEST(Summarise, RefusesNoneAndOneTrial) {
  EXPECT_FALSE(summarise({}));
  EXPECT_FALSE(summarise({trial(1.0, 5.0, 100.0, 0.1)}));
}

TEST(Summarise, RefusesTrialsOfDifferentAxesOrUnits) {
  Identification two = trial(1.0, 5.0, 100.0, 0.1);
  two.axes = 2;
  EXPECT_FALSE(summarise({trial(1.0, 5.0, 100.0, 0.1), two}));
  Identification rotation = trial(1.0, 5.0, 100.0, 0.1);
  rotation.motion = Motion::rotation;
  EXPECT_FALSE(summarise({trial(1.0, 5.0, 100.0, 0.1), rotation}));
}

TEST(Summarise, AnUndefinedEquilibriumStaysUndefined) {
  const Summary summary = summarise({trial(1.0, 5.0, 100.0, 0.1), trial(1.0, 5.0, 0.0, std::nan(""))}).value();
  EXPECT_TRUE(std::isnan(summary.mean.x0[0]));
  EXPECT_DOUBLE_EQ(summary.mean.K(0, 0), 50.0);
}

}  // namespace
}  // namespace mbk::analyse
