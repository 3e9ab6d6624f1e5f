#include "mbk/teleop/architectures.h"

#include <gmock/gmock.h>

#include <cmath>

#include "mbk/teleop/llewellyn.h"
#include "mbk/teleop/sampled.h"
#include "mbk/teleop/test_networks.h"

namespace mbk::teleop {
namespace {

using lti::RationalFunction;

RationalFunction over_s(const Rational& constant, const Rational& slope, const Rational& square = 0) {
  return RationalFunction::of({constant, slope, square}, {0, 1}).value();
}

Teleoperator delayed(int pade_order) {
  Teleoperator t = position_position(3, 5, 10, 100, 20, 200);
  t.values.insert_or_assign("master.m", Rational(1, 2));
  t.values.insert_or_assign("slave.m", Rational(4, 5));
  t.values.insert({{"delay.to_slave", {1, 100}}, {"delay.to_master", {1, 50}}});
  t.pade_order = pade_order;
  return t;
}

TEST(Teleoperator, OfPositionPositionHasTheDocumentedImpedance) {
  Teleoperator t = delayed(2);
  t.values.erase("delay.to_slave");
  t.values.erase("delay.to_master");
  const auto z = t.equations().at(0);
  ASSERT_EQ(z->form, Form::z);
  EXPECT_EQ(z->matrix(0, 0), over_s(100, 13, {1, 2}));
  EXPECT_EQ(z->matrix(0, 1), over_s(-100, -10));
  EXPECT_EQ(z->matrix(1, 0), over_s(-200, -20));
  EXPECT_EQ(z->matrix(1, 1), over_s(200, 25, {4, 5}));
}

TEST(Teleoperator, OfPositionForceHasTheDocumentedHybridMatrix) {
  const auto h = convert(*position_force({1, 2}).equations().at(0), Form::h);
  ASSERT_TRUE(h);
  const RationalFunction slave = over_s(400, 43, {4, 5});
  EXPECT_EQ(h->matrix(0, 0), RationalFunction({2, {1, 2}}));
  EXPECT_EQ(h->matrix(0, 1), RationalFunction({Rational(-1, 2)}));
  EXPECT_EQ(h->matrix(1, 0), over_s(400, 40) / slave);
  EXPECT_EQ(h->matrix(1, 1), RationalFunction({1}) / slave);
}

TEST(Teleoperator, OfFourChannelsIsTransparentWithLawrencesLaws) {
  Teleoperator t = position_position(1, 2, 10, 100, 20, 200);
  t.architecture = Architecture::four_channel;
  t.values.insert({{"master.local_force_gain", {1, 2}},
                   {"slave.local_force_gain", 2},
                   {"channels.force_to_master", {3, 2}},
                   {"channels.force_to_slave", 3},
                   {"channels.to_slave_d", 22},
                   {"channels.to_slave_k", 200},
                   {"channels.to_master_d", 11},
                   {"channels.to_master_k", 100}});
  const auto h = t.equations().at(0);
  ASSERT_TRUE(h);
  EXPECT_EQ(h->form, Form::h);
  EXPECT_EQ(h->matrix, two_port(Form::h, {{{{0}, {1}}, {{-1}, {1}}, {{1}, {1}}, {{0}, {1}}}}).matrix);
}

TEST(Teleoperator, OfFourChannelsIsAnyOtherWithItsChannels) {
  Teleoperator t = position_position(1, 2, 10, 100, 20, 200);
  const auto plain = t.equations().at(0);
  t.architecture = Architecture::four_channel;
  EXPECT_EQ(t.equations().at(0)->matrix, plain->matrix);
}

TEST(Teleoperator, PadeApproachesTheExactDelay) {
  for (const auto& [order, tolerance] : {std::pair{1, 2e-2}, {2, 2e-4}, {4, 1e-9}}) {
    const Teleoperator t = delayed(order);
    const RadPerSec omega(20.0);  // ωT = 0.4
    const Eigen::Matrix2cd exact = immittance(t.with_exact_delay(omega), Form::z);
    const Eigen::Matrix2cd approximate = convert(*t.equations().at(0), Form::z)->matrix(omega);
    EXPECT_LT((exact - approximate).norm(), tolerance * exact.norm()) << order;
    EXPECT_NEAR(std::abs(approximate(0, 1)), std::abs(exact(0, 1)), 1e-12 * exact.norm());  // all-pass
  }
}

TEST(OnGrid, AgreesWithPadeWhereBothHold) {
  const FrequencyGrid grid{RadPerSec(0.01), RadPerSec(300.0), 3000};
  const Teleoperator t = delayed(4);
  for (const Port port : {Port::one, Port::two}) {
    for (const int a : {-20, 0, 20}) {
      const auto sampled = llewellyn_on_grid(t, grid, port, a);
      ASSERT_TRUE(sampled) << sampled.error().line();
      const AbsoluteStability exact = llewellyn(*t.equations().with_shortage(port, Polynomial{a}).at(0));
      EXPECT_EQ(sampled->holds(), exact.holds()) << a;
    }
    const auto largest = largest_shortage_on_grid(t, grid, port);
    ASSERT_TRUE(largest);
    EXPECT_TRUE(llewellyn_on_grid(t, grid, port, lti::exact(largest->value() - 1e-6).value())->holds());
    EXPECT_FALSE(llewellyn_on_grid(t, grid, port, lti::exact(largest->value() + 1e-6).value())->holds());
  }
}

TEST(OnGrid, RefusesForcesThatFeedThemselves) {
  Teleoperator t = delayed(2);
  t.architecture = Architecture::four_channel;
  t.values.insert({{"channels.force_to_master", 1}, {"channels.force_to_slave", 1}});
  EXPECT_FALSE(llewellyn_on_grid(t, {RadPerSec(1.0), RadPerSec(10.0), 10}));
}

}  // namespace
}  // namespace mbk::teleop
